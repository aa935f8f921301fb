#include "measure/worker/worker_process.h"

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/sysinfo.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <cstring>

#include "measure/child_process.h"
#include "measure/keeper.h"
#include "measure/paths.h"
#include "measure/program/program_files.h"
#include "measure/worker/machine_context.h"

namespace gnomon {

namespace {

using Clock = std::chrono::steady_clock;

constexpr std::size_t most_line_bytes = 4 << 20;

/// The file that the workers run. Throws WorkerFailure when it cannot be started: here, because a failed exec reports nothing
/// but an exit status.
std::string program_to_start(const WorkerOptions& options) {
  constexpr std::string_view advice = "start again when it is in place; rows that are done are safe";
  std::string program = options.program.empty() ? program_path().string() : options.program;
  constexpr std::string_view gone = " (deleted)";  // as Linux marks the file of a running program that was removed or replaced
  if (options.program.empty() && program.ends_with(gone) && access(program.c_str(), F_OK) != 0) {
    program.erase(program.size() - gone.size());
    throw WorkerFailure(
        fmt::format("no worker could be started: program {} was removed or replaced while it ran (is it being "
                    "built?): {}",
                    program, advice));
  }
  if (access(program.c_str(), X_OK) != 0)
    throw WorkerFailure(fmt::format("no worker could be started: program {}: {}: {}", program, std::strerror(errno), advice));
  return program;
}

/// The variables of a worker's environment that differ from its owner's.
Launch::Variables set_here(const WorkerOptions& options) {
  Launch::Variables variables{{"LP_NUM_THREADS", options.threads > 0 ? std::to_string(options.threads) : ""}};
  if (!options.keeps_shaders && !environment_keeps_shaders()) {  // the drivers of Mesa and NVIDIA
    variables.emplace_back("MESA_SHADER_CACHE_DISABLE", "true");
    variables.emplace_back("__GL_SHADER_DISK_CACHE", "0");
  }
  if (!options.program_folder.empty()) variables.emplace_back(program_folder_variable, options.program_folder);
  return variables;
}

std::vector<std::string> command_of(const WorkerOptions& options, int socket) {
  std::vector<std::string> words = {program_to_start(options)};
  for (const std::string& plugin : options.plugins) words.insert(words.end(), {load_option(plugin), plugin});
  words.insert(words.end(), {options.command, std::to_string(socket), std::to_string(options.threads)});
  return words;
}

void enter_worker(int threads) {
  setsid();  // no terminal
  const int nothing = open("/dev/null", O_RDWR);
  for (const int standard : {STDIN_FILENO, STDOUT_FILENO}) dup2(nothing, standard);
  if (threads > 0) {
    // The first of the cores that this process may use: a shard or a batch system may allow it only a few.
    cpu_set_t allowed, cores;
    CPU_ZERO(&cores);
    bool pinned = sched_getaffinity(0, sizeof allowed, &allowed) == 0;
    for (int k = 0; k < CPU_SETSIZE && pinned && CPU_COUNT(&cores) < threads; ++k)
      if (CPU_ISSET(k, &allowed)) CPU_SET(k, &cores);
    pinned = pinned && CPU_COUNT(&cores) == threads && sched_setaffinity(0, sizeof cores, &cores) == 0;
    if (!pinned) {
      dprintf(STDERR_FILENO, "this process may not use %d cores\n", threads);
      _exit(126);
    }
  }
#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)  // their shadow memory alone is over any limit
  // A technique that exhausts memory gets an exception in its own process, and the machine keeps running. The limit counts what
  // may be written, not addresses: drivers of GPUs reserve far more addresses than there is memory.
  struct sysinfo memory {};
  sysinfo(&memory);
  const rlim_t most = static_cast<rlim_t>(memory.totalram) * memory.mem_unit / 10 * 9;
  const rlimit limit{most, most};
  setrlimit(RLIMIT_DATA, &limit);
#endif
  const rlimit no_core{0, 0};
  setrlimit(RLIMIT_CORE, &no_core);
}

}  // namespace

std::string load_option(const std::string& path) { return path.ends_with(".toml") ? "--program" : "--plugin"; }

WorkerProcess::WorkerProcess(const WorkerOptions& options) : options_(options) {
  int sockets[2];
  if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, sockets) != 0)
    throw Error("no socket for a worker: {}", std::strerror(errno));
  socket_ = sockets[0];
  errors_ = memfd_create("worker-stderr", MFD_CLOEXEC);
  try {
    const Launch launch(command_of(options, sockets[1]), set_here(options));
    const auto body = [&] {
      enter_worker(options.threads);
      fcntl(sockets[1], F_SETFD, 0);
      execve(launch.argv[0], launch.argv.data(), launch.envp.data());
      dprintf(STDERR_FILENO, "program %s cannot be started: %s\n", launch.argv[0], std::strerror(errno));
      _exit(127);
    };
    process_ = fork_kept(body, errors_);
    const int code = errno;
    if (process_ < 0) throw Error("no process for a worker: {}", std::strerror(code));
  } catch (...) {
    for (const int descriptor : {sockets[1], socket_, errors_}) close(descriptor);
    throw;
  }
  close(sockets[1]);
}

WorkerProcess::~WorkerProcess() {
  end_process();
  close(socket_);
  close(errors_);
}

void WorkerProcess::end_process() {
  if (process_ <= 0) return;
  end_kept(process_);
  process_ = -1;
}

void WorkerProcess::interrupt() {
  is_interrupted_ = true;
  shutdown(socket_, SHUT_RDWR);
}

void WorkerProcess::send(const Json& request) {
  doing_ = plain_text(request[request.contains("stage") ? "stage" : "do"]);
  write_line(socket_, json_text(request));  // where the worker is gone, receive() reports how
}

Json WorkerProcess::receive(double timeout_seconds, const std::function<void()>& meanwhile) {
  if (process_ <= 0) throw WorkerFailure(fmt::format("was asked for {} after it had ended", doing_));
  const auto deadline = Clock::now() + std::chrono::duration<double>(timeout_seconds);
  for (;;) {
    if (const std::size_t end = pending_.find('\n'); end != std::string::npos) {
      const Json answer = parse_if_json(pending_.substr(0, end));
      pending_.erase(0, end + 1);
      if (!answer.is_object()) fail(fmt::format("answered {} with a line that is no JSON object", doing_));
      if (answer.contains("error")) fail(fmt::format("threw in {}: {}", doing_, plain_text(answer["error"])));
      return answer;
    }
    const double left = std::chrono::duration<double>(deadline - Clock::now()).count();
    pollfd wait{socket_, POLLIN, 0};
    const double pause = meanwhile ? std::min(left, 0.1) : left;
    const int ready = left > 0 ? poll(&wait, 1, static_cast<int>(pause * 1000) + 1) : 0;
    if (ready < 0 && errno == EINTR) continue;
    if (ready == 0 && pause < left) {
      meanwhile();
      continue;
    }
    if (ready == 0) fail(fmt::format("hung in {}: no answer within {:g} s", doing_, timeout_seconds));
    if (pending_.size() > most_line_bytes) fail(fmt::format("answered {} with a line without an end", doing_));
    if (!read_more(socket_, pending_)) fail_as_it_ended();
  }
}

/// The socket is closed, so the worker is gone or soon will be; one that lingers is killed.
void WorkerProcess::fail_as_it_ended() {
  if (is_interrupted_) fail(fmt::format("was interrupted in {}", doing_));
  int status = 0;
  if (!comes_within(1000, [&] { return has_ended(process_, status); }))
    fail(fmt::format("crashed in {}: it closed its connection and went on", doing_));
  process_ = -1;
  constexpr int not_started = 127;  // what is left where exec fails: the program may have gone since it was checked
  if (WIFEXITED(status) && WEXITSTATUS(status) == not_started) program_to_start(options_);
  if (WIFSIGNALED(status))
    fail<WorkerCrash>(fmt::format("crashed in {}: {} (signal {})", doing_, strsignal(WTERMSIG(status)), WTERMSIG(status)));
  fail(fmt::format("crashed in {}: exit status {}", doing_, WEXITSTATUS(status)));
}

std::string WorkerProcess::ended(const std::string& how) {
  end_process();
  char text[400];  // of the last line on its stderr, shortened
  const off_t size = lseek(errors_, 0, SEEK_END);
  const off_t from = std::max<off_t>(0, size - static_cast<off_t>(sizeof text));
  const ssize_t n = pread(errors_, text, sizeof text, from);
  std::string words(text, n > 0 ? static_cast<std::size_t>(n) : 0);
  while (!words.empty() && std::isspace(static_cast<unsigned char>(words.back()))) words.pop_back();
  if (const std::size_t start = words.rfind('\n'); start != std::string::npos) words.erase(0, start + 1);
  return printable(words.empty() ? how : how + "; it said: " + words);
}

}  // namespace gnomon
