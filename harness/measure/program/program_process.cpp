#include "measure/program/program_process.h"

#include <fcntl.h>
#include <gnomon/error.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <cstring>

#include "measure/keeper.h"
#include "measure/process_memory.h"

namespace gnomon {

namespace {

/// Hundreds of samples of a thousand pixels.
constexpr std::size_t most_answer_bytes = 256 << 20;

/// Arguments and environment are prepared before the fork: between fork and exec only plain system calls are safe.
struct Launch {
  std::vector<std::string> words, environment;
  std::vector<char*> argv, envp;

  Launch(const std::vector<std::string>& command, const ProgramProcess::Variables& variables) : words(command) {
    for (char** entry = environ; *entry; ++entry) {
      const std::string_view name = std::string_view(*entry).substr(0, std::string_view(*entry).find('='));
      if (std::ranges::none_of(variables, [&](const auto& variable) { return variable.first == name; }))
        environment.emplace_back(*entry);
    }
    for (const auto& [name, value] : variables) environment.push_back(fmt::format("{}={}", name, value));
    for (std::string& word : words) argv.push_back(word.data());
    for (std::string& variable : environment) envp.push_back(variable.data());
    argv.push_back(nullptr);
    envp.push_back(nullptr);
  }
};

/// What the program ignores is not meant for others.
void default_signals() {
  for (const int number : {SIGPIPE, SIGXFSZ}) signal(number, SIG_DFL);
}

/// A child in a folder with these as its standard input and output. Answers its number, or -1.
int start(Launch& launch, const std::filesystem::path& folder, int input, int output) {
  const std::string place = folder.empty() ? "." : folder.string();
  const int owner = getpid(), process = fork();
  if (process != 0) return process;
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (getppid() != owner) _exit(0);
  default_signals();
  dup2(input, STDIN_FILENO);
  dup2(output, STDOUT_FILENO);
  if (chdir(place.c_str()) == 0) execvpe(launch.argv[0], launch.argv.data(), launch.envp.data());
  dprintf(STDERR_FILENO, "%s cannot be started: %s\n", launch.argv[0], std::strerror(errno));
  _exit(127);
}

/// Whether `is_over` comes to be within so many milliseconds.
template <class Test>
bool within(int milliseconds, const Test& is_over) {
  for (int waited = 0; waited <= milliseconds; ++waited) {
    if (is_over()) return true;
    usleep(1000);
  }
  return false;
}

std::string shortened(const std::string& text) { return text.size() <= 80 ? text : text.substr(0, 80) + " ..."; }

}  // namespace

bool ends_well(const std::vector<std::string>& command, const std::filesystem::path& folder) {
  Launch launch(command, {});
  const std::string place = folder.empty() ? "." : folder.string();
  const int keeper = fork_kept([&] {
    const int nothing = open("/dev/null", O_RDWR);
    default_signals();
    for (const int standard : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) dup2(nothing, standard);
    if (chdir(place.c_str()) == 0) execvpe(launch.argv[0], launch.argv.data(), launch.envp.data());
    _exit(127);
  });
  if (keeper < 0) return false;
  int status = 0;
  if (within(10'000, [&] { return has_ended(keeper, status); })) return WIFEXITED(status) && WEXITSTATUS(status) == 0;
  end_kept(keeper);
  return false;
}

ProgramProcess::ProgramProcess(const std::vector<std::string>& command, const std::filesystem::path& folder,
                               const Variables& variables)
    : name_(std::filesystem::path(command.at(0)).filename().string()) {
  Launch launch(command, variables);
  int input[2], output[2];  // a socket, because a write to one that is closed can be told from a signal
  if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, input) != 0)
    throw Error("no socket for {}: {}", name_, std::strerror(errno));
  if (pipe2(output, O_CLOEXEC) != 0) {
    close(input[0]);
    close(input[1]);
    throw Error("no pipe for {}: {}", name_, std::strerror(errno));
  }
  process_ = start(launch, folder, input[1], output[1]);
  const int code = errno;
  close(input[1]);
  close(output[1]);
  input_ = input[0];
  output_ = output[0];
  if (process_ < 0) {
    close(input_);
    close(output_);
    throw Error("no process for {}: {}", name_, std::strerror(code));
  }
}

ProgramProcess::~ProgramProcess() {
  close(input_);
  const auto has_left = [this] { return waitpid(process_, nullptr, WNOHANG) == process_; };
  if (process_ > 0 && !within(100, has_left)) {  // the end of its input is its end
    kill(process_, SIGKILL);
    waitpid(process_, nullptr, 0);
  }
  close(output_);
}

Json ProgramProcess::ask(const Json& request) {
  const std::string doing = plain_text(request.at("do")), line = json_text(request) + '\n';
  if (process_ <= 0) throw Error("{} was asked for {} after it had ended", name_, doing);
  if (!pending_.empty()) throw Error("{} said more than it was asked: {}", name_, shortened(pending_));
  for (std::size_t sent = 0; sent < line.size();) {
    const ssize_t n = send(input_, line.data() + sent, line.size() - sent, MSG_NOSIGNAL);
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) break;  // it has ended: its answer will not come
    sent += static_cast<std::size_t>(n);
  }
  std::size_t end = 0, searched = 0;
  while ((end = pending_.find('\n', searched)) == pending_.npos) {
    searched = pending_.size();
    if (searched > most_answer_bytes) throw Error("{} answered {} with a line without an end", name_, doing);
    char chunk[65536];
    const ssize_t n = ::read(output_, chunk, sizeof chunk);
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) fail_as_it_ended(doing);
    pending_.append(chunk, static_cast<std::size_t>(n));
  }
  const std::string text = pending_.substr(0, end);
  pending_.erase(0, end + 1);
  Json answer = parse_if_json(text);
  if (!answer.is_object())
    throw Error("{} answered {} with a line that is no JSON object: {} (what is for people goes to standard error)", name_,
                doing, shortened(text));
  if (answer.contains("error")) throw Error("{} says in {}: {}", name_, doing, plain_text(answer["error"]));
  return answer;
}

void ProgramProcess::fail_as_it_ended(const std::string& doing) {
  const std::string half = pending_.empty() ? "" : fmt::format(", in the middle of a line: {}", shortened(pending_));
  int status = 0;
  if (!within(1000, [&] { return waitpid(process_, &status, WNOHANG) == process_; }))
    throw Error("{} closed its output in {} and went on{}", name_, doing, half);
  process_ = -1;
  if (WIFSIGNALED(status))
    throw Error("{} crashed in {}{}: {} (signal {})", name_, doing, half, strsignal(WTERMSIG(status)), WTERMSIG(status));
  throw Error("{} ended in {}{}: exit status {}", name_, doing, half, WEXITSTATUS(status));
}

double ProgramProcess::resident_bytes() const { return process_ > 0 ? own_resident_bytes(process_) : 0; }

}  // namespace gnomon
