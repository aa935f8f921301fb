// Runs the importer as a child process and takes its answer from a pipe.
#include <fcntl.h>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "measure/scene/import.h"

extern char** environ;

namespace gnomon::importing {
namespace {

constexpr std::size_t max_answer_bytes = std::size_t{8} << 30;

/// Both ends of a pipe, closed on exec and at the end of the scope.
struct Pipe {
  int ends[2] = {-1, -1};
  explicit Pipe(const std::string& what) {
    if (pipe2(ends, O_CLOEXEC) != 0) throw Error("{}: no pipe for the importer: {}", what, std::strerror(errno));
  }
  ~Pipe() {
    close_end(0);
    close_end(1);
  }
  void close_end(int i) {
    if (ends[i] >= 0) close(ends[i]);
    ends[i] = -1;
  }
};

/// Reads to the end of the pipe, then judges how the child ended.
std::vector<std::byte> collect(const std::string& what, pid_t child, Pipe& pipe) {
  pipe.close_end(1);
  std::vector<std::byte> answer;
  std::size_t size = 0;
  while (size <= max_answer_bytes) {
    if (answer.size() - size < (1u << 16)) answer.resize(std::max<std::size_t>(1u << 20, 2 * answer.size()));
    const ssize_t count = ::read(pipe.ends[0], answer.data() + size, answer.size() - size);
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) break;
    size += static_cast<std::size_t>(count);
  }
  if (size > max_answer_bytes) kill(child, SIGKILL);
  int status = 0;
  while (waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  if (size > max_answer_bytes) throw Error("{}: holds more than {} bytes of geometry", what, max_answer_bytes);
  if (WIFSIGNALED(status)) {
    const int signal = WTERMSIG(status);
    if (signal == SIGXCPU || signal == SIGALRM)
      throw Error("{}: the importer did not finish within its limit of {} s, and {} s for each megabyte of the file", what,
                  least_import_seconds, import_seconds_per_megabyte);
    if (signal == SIGKILL) throw Error("{}: the importer was killed; the machine ran out of memory, most likely", what);
    throw Error("{}: the importer crashed (signal {}, {}); the file is damaged", what, signal, strsignal(signal));
  }
  if (WEXITSTATUS(status) != 0) throw Error("{}: the importer ended with status {}", what, WEXITSTATUS(status));
  answer.resize(size);
  return answer;
}

}  // namespace

std::vector<std::byte> output_of_fork(const std::string& what, const std::function<int(int out_fd)>& body) {
  Pipe pipe(what);
  const pid_t child = fork();
  if (child < 0) throw Error("{}: no process for the importer: {}", what, std::strerror(errno));
  if (child == 0) {
    if (const int nowhere = open("/dev/null", O_RDWR); nowhere >= 0) dup2(nowhere, 2);  // the parent words the error
    for (const int signal : {SIGABRT, SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGALRM, SIGPIPE, SIGXCPU}) ::signal(signal, SIG_DFL);
    _exit(body(pipe.ends[1]));
  }
  return collect(what, child, pipe);
}

std::vector<std::byte> output_of_program(const std::string& what, const std::filesystem::path& program,
                                         const std::filesystem::path& file) {
  Pipe pipe(what);
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_adddup2(&actions, pipe.ends[1], 3);
  posix_spawn_file_actions_addopen(&actions, 0, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_addopen(&actions, 1, "/dev/null", O_WRONLY, 0);
  posix_spawn_file_actions_addopen(&actions, 2, "/dev/null", O_WRONLY, 0);
  const std::string name = file.string();  // as it is written: errors name it so
  std::string words[] = {program.string(), "import-mesh", name.starts_with('-') ? "./" + name : name, "3"};
  char* arguments[] = {words[0].data(), words[1].data(), words[2].data(), words[3].data(), nullptr};
  pid_t child = -1;
  const int failure = posix_spawn(&child, program.c_str(), &actions, nullptr, arguments, environ);
  posix_spawn_file_actions_destroy(&actions);
  if (failure != 0) throw Error("{}: cannot start the importer {}: {}", what, program.string(), std::strerror(failure));
  return collect(what, child, pipe);
}

}  // namespace gnomon::importing
