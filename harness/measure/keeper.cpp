// A process between the program and one that it starts. As a subreaper it becomes the parent of all that lose theirs, so that
// nothing escapes it by a session of its own or an empty environment. It is a fork without exec: plain system calls alone,
// which are bound when the program starts (-fno-plt): the memory by which others are found later is gone.
#include "measure/keeper.h"

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/signalfd.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <mutex>
#include <set>

namespace gnomon {
namespace {

// Descriptors of a keeper; 0 to 2 lead nowhere.
constexpr int words_in = 3, words_file = 4, signals_in = 5, first_other = 6;

char words[2 * most_last_words];  // the end of the standard error
std::size_t word_count = 0;

/// Gives back the program's memory: a keeper that kept its copy would cost as much again when the program writes to its own.
void forget_memory() {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  return;  // sanitizers use theirs at every call
#endif
  const int maps = open("/proc/self/maps", O_RDONLY);
  if (maps < 0) return;
  constexpr std::uintptr_t large = 1 << 20;
  static char text[1 << 16];
  const std::uintptr_t ours[] = {reinterpret_cast<std::uintptr_t>(&maps), reinterpret_cast<std::uintptr_t>(&errno),
                                 reinterpret_cast<std::uintptr_t>(text)};
  std::size_t held = 0;
  for (;;) {
    const ssize_t count = read(maps, text + held, sizeof text - held);
    if (count <= 0) break;
    held += static_cast<std::size_t>(count);
    std::size_t at = 0;
    for (char* end = nullptr; (end = static_cast<char*>(memchr(text + at, '\n', held - at)));) {
      // 7f0000000000-7f0000100000 rw-p 00000000 00:00 0   [name]
      std::uintptr_t ends[2] = {};
      char* c = text + at;
      for (std::uintptr_t& one : ends) {
        for (; c < end && *c != '-' && *c != ' '; ++c)
          one = one * 16 + static_cast<std::uintptr_t>(*c <= '9' ? *c - '0' : *c - 'a' + 10);
        ++c;
      }
      const bool is_private = end - c > 22 && c[0] == 'r' && c[1] == 'w' && c[3] == 'p' && memcmp(c + 14, "00:00 0", 7) == 0;
      bool is_ours = false;  // stack, thread and this text
      for (const std::uintptr_t place : ours) is_ours = is_ours || (place >= ends[0] && place < ends[1]);
      if (is_private && ends[1] - ends[0] >= large && !is_ours)
        madvise(reinterpret_cast<void*>(ends[0]), ends[1] - ends[0], MADV_DONTNEED);
      at = static_cast<std::size_t>(end - text) + 1;
    }
    memmove(text, text + at, held - at);
    held -= at;
  }
  close(maps);
}

/// Reads the words since the last call; false at their end.
bool listen() {
  const ssize_t count = read(words_in, words + word_count, sizeof words - word_count);
  if (count <= 0) return count < 0 && (errno == EAGAIN || errno == EINTR);
  word_count += static_cast<std::size_t>(count);
  if (word_count > most_last_words) {
    memmove(words, words + word_count - most_last_words, most_last_words);
    word_count = most_last_words;
  }
  return true;
}

void keep_words() {
  while (listen())
    if (pollfd more{words_in, POLLIN, 0}; poll(&more, 1, 0) <= 0) break;
  if (ftruncate(words_file, 0) == 0 && pwrite(words_file, words, word_count, 0) < 0) return;
}

/// Kills the children until there are none: those of a child that is gone become children.
void end_children() {
  for (;;) {
    static char list[1 << 16];
    const int file = open("/proc/thread-self/children", O_RDONLY);  // a keeper has one thread
    const ssize_t size = file < 0 ? -1 : read(file, list, sizeof list);
    if (file >= 0) close(file);
    long number = 0;
    for (ssize_t k = 0; k < size; ++k) {
      if (list[k] >= '0' && list[k] <= '9') {
        number = number * 10 + (list[k] - '0');
      } else if (number > 0) {
        kill(static_cast<pid_t>(number), SIGKILL);
        number = 0;
      }
    }
    if (size < 0) return;
    const pid_t gone = waitpid(-1, nullptr, size > 0 ? 0 : WNOHANG);
    if (gone < 0 && errno == ECHILD) return;
    if (gone == 0) usleep(200);  // the list may leave one out for a moment
  }
}

void end_as(int status) {
  end_children();
  keep_words();
  if (WIFSIGNALED(status)) {
    const rlimit no_core{0, 0};
    setrlimit(RLIMIT_CORE, &no_core);
    signal(WTERMSIG(status), SIG_DFL);
    sigset_t all;
    sigfillset(&all);
    sigprocmask(SIG_UNBLOCK, &all, nullptr);
    kill(getpid(), WTERMSIG(status));
  }
  _exit(WIFEXITED(status) ? WEXITSTATUS(status) : 0);
}

/// Waits for the end of the process, or for the signal to end it.
void keep(pid_t process) {
  forget_memory();
  bool is_heard = true;
  for (;;) {
    pollfd wait[2] = {{signals_in, POLLIN, 0}, {is_heard ? words_in : -1, POLLIN, 0}};
    if (poll(wait, 2, -1) < 0 && errno != EINTR) _exit(125);
    if (wait[1].revents != 0) is_heard = listen();
    signalfd_siginfo signal{};
    if (!(wait[0].revents & POLLIN) || read(signals_in, &signal, sizeof signal) != sizeof signal) continue;
    if (signal.ssi_signo != SIGCHLD) end_as(0);
    int status = 0;
    for (pid_t gone = 0; (gone = waitpid(-1, &status, WNOHANG)) > 0;)
      if (gone == process) end_as(status);
  }
}

// Of the program: the present keepers of its workers.
std::mutex of_keepers;
std::set<pid_t> keepers;
bool ends_orphans = false;

/// Kills the children that a killed keeper left, and theirs, which become children then, until there are none.
void end_orphans() {
  constexpr int most_rounds = 1000;
  bool is_found = ends_orphans;
  for (int round = 0; is_found && round < most_rounds; ++round) {
    is_found = false;
    std::error_code code;
    for (const auto& thread : std::filesystem::directory_iterator("/proc/self/task", code)) {
      std::ifstream list(thread.path() / "children");
      for (pid_t child = 0; list >> child;) {
        if (keepers.contains(child) || getsid(child) == getsid(0)) continue;
        kill(child, SIGKILL);
        waitpid(child, nullptr, 0);
        is_found = true;
      }
    }
  }
}

/// `high` as `low`, whatever was there.
void put_at(int high, int low) {
  if (high == low)
    fcntl(low, F_SETFD, 0);
  else
    dup2(high, low);
}

}  // namespace

pid_t fork_kept(const std::function<void()>& body, int last_words) {
  int pipe_ends[2] = {-1, -1};
  if (pipe2(pipe_ends, O_CLOEXEC) != 0) return -1;
  const int nothing = open("/dev/null", O_RDWR | O_CLOEXEC);
  // Blocked before the fork: the keeper inherits the program's handlers, and one may write to a pipe that both share.
  sigset_t told, before;
  sigemptyset(&told);
  for (const int signal : {SIGCHLD, SIGTERM, SIGINT, SIGHUP, SIGQUIT}) sigaddset(&told, signal);
  pthread_sigmask(SIG_BLOCK, &told, &before);
  std::unique_lock lock(of_keepers);
  const pid_t owner = getpid(), keeper = fork();
  if (keeper != 0) {
    pthread_sigmask(SIG_SETMASK, &before, nullptr);
    if (keeper > 0) keepers.insert(keeper);
    lock.unlock();
    for (const int descriptor : {pipe_ends[0], pipe_ends[1], nothing}) close(descriptor);
    return keeper;
  }
  setsid();
  prctl(PR_SET_NAME, "gnomon-keeper");
  prctl(PR_SET_CHILD_SUBREAPER, 1);
  prctl(PR_SET_PDEATHSIG, SIGTERM);
  if (getppid() != owner) _exit(0);  // it died before it could be watched
  const pid_t self = getpid(), process = fork();
  if (process < 0) _exit(125);
  if (process == 0) {
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    if (getppid() != self) _exit(0);
    sigprocmask(SIG_SETMASK, &before, nullptr);
    dup2(last_words >= 0 ? pipe_ends[1] : nothing, STDERR_FILENO);
    body();
    _exit(126);
  }
  // Once all needed descriptors are above the lowest numbers, those are free.
  const auto above = [](int descriptor) { return fcntl(descriptor, F_DUPFD, first_other); };
  const int in = above(pipe_ends[0]), file = above(last_words >= 0 ? last_words : nothing);
  const int high = above(signalfd(-1, &told, SFD_NONBLOCK)), dark = above(nothing);
  if (in < 0 || file < 0 || high < 0 || dark < 0) {  // too few may be open: the low numbers are not ours
    kill(process, SIGKILL);
    constexpr char why[] = "too many files are open to keep a process";
    _exit(last_words >= 0 && pwrite(last_words, why, sizeof why - 1, 0) < 0 ? 124 : 125);
  }
  for (const int low : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) put_at(dark, low);
  put_at(in, words_in);
  put_at(file, words_file);
  put_at(high, signals_in);
  fcntl(words_in, F_SETFL, O_NONBLOCK);
  if (syscall(SYS_close_range, first_other, ~0U, 0) != 0)
    for (int other = first_other; other < 4096; ++other) close(other);
  keep(process);
  _exit(125);
}

void end_kept(pid_t keeper) {
  kill(keeper, SIGTERM);
  constexpr int most_waits = 10'000;  // milliseconds
  int status = 0;
  for (int wait = 0; wait < most_waits; ++wait) {
    if (has_ended(keeper, status)) return;
    usleep(wait < 20 ? 200 : 1000);
  }
  kill(keeper, SIGKILL);
  while (!has_ended(keeper, status)) usleep(1000);
}

bool has_ended(pid_t keeper, int& status) {
  const pid_t found = waitpid(keeper, &status, WNOHANG);
  if (found == 0 || (found < 0 && errno == EINTR)) return false;
  const std::scoped_lock lock(of_keepers);
  keepers.erase(keeper);
  end_orphans();
  return true;
}

void end_orphans_of_keepers() { ends_orphans = prctl(PR_SET_CHILD_SUBREAPER, 1) == 0; }

}  // namespace gnomon
