#include "measure/program/program_process.h"

#include <fcntl.h>
#include <gnomon/error.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstring>

#include "measure/keeper.h"
#include "measure/process_memory.h"

namespace gnomon {

namespace {

/// Hundreds of samples of a thousand pixels.
constexpr std::size_t most_answer_bytes = 256 << 20;

std::string place_of(const std::filesystem::path& folder) { return folder.empty() ? "." : folder.string(); }

/// In the child: becomes the program, in a folder, with these as its standard input and output.
[[noreturn]] void become(const Launch& launch, const std::string& place, int input, int output) {
  for (const int number : {SIGPIPE, SIGXFSZ}) signal(number, SIG_DFL);  // this process ignores them, its children do not
  dup2(input, STDIN_FILENO);
  dup2(output, STDOUT_FILENO);
  if (chdir(place.c_str()) == 0) execvpe(launch.argv[0], launch.argv.data(), launch.envp.data());
  dprintf(STDERR_FILENO, "%s cannot be started: %s\n", launch.argv[0], std::strerror(errno));
  _exit(127);
}

std::string shortened(const std::string& text) { return text.size() <= 80 ? text : text.substr(0, 80) + " ..."; }

}  // namespace

bool ends_well(const std::vector<std::string>& command, const std::filesystem::path& folder) {
  const Launch launch(command, {});
  const std::string place = place_of(folder);
  const int keeper = fork_kept([&] {
    const int nothing = open("/dev/null", O_RDWR);
    dup2(nothing, STDERR_FILENO);
    become(launch, place, nothing, nothing);
  });
  if (keeper < 0) return false;
  int status = 0;
  if (comes_within(10'000, [&] { return has_ended(keeper, status); })) return WIFEXITED(status) && WEXITSTATUS(status) == 0;
  end_kept(keeper);
  return false;
}

ProgramProcess::ProgramProcess(const std::vector<std::string>& command, const std::filesystem::path& folder,
                               const Launch::Variables& variables)
    : name_(std::filesystem::path(command.at(0)).filename().string()) {
  const Launch launch(command, variables);
  const std::string place = place_of(folder);
  int input[2], output[2];  // a socket, because a write to one that is closed can be told from a signal
  if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, input) != 0)
    throw Error("no socket for {}: {}", name_, std::strerror(errno));
  if (pipe2(output, O_CLOEXEC) != 0) {
    for (const int end : input) close(end);
    throw Error("no pipe for {}: {}", name_, std::strerror(errno));
  }
  const int owner = getpid();
  process_ = fork();
  if (process_ == 0) {
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    if (getppid() != owner) _exit(0);
    become(launch, place, input[1], output[1]);
  }
  const int code = errno;
  close(input[1]);
  close(output[1]);
  input_ = input[0];
  output_ = output[0];
  if (process_ < 0) {
    for (const int end : {input_, output_}) close(end);
    throw Error("no process for {}: {}", name_, std::strerror(code));
  }
}

ProgramProcess::~ProgramProcess() {
  close(input_);
  const auto has_left = [this] { return waitpid(process_, nullptr, WNOHANG) == process_; };
  if (process_ > 0 && !comes_within(100, has_left)) {  // the end of its input is its end
    kill(process_, SIGKILL);
    waitpid(process_, nullptr, 0);
  }
  close(output_);
}

Json ProgramProcess::ask(const Json& request) {
  const std::string doing = plain_text(request.at("do"));
  if (process_ <= 0) throw Error("{} got a request for {} after it had ended", name_, doing);
  if (!pending_.empty()) throw Error("{} said more than it was asked: {}", name_, shortened(pending_));
  write_line(input_, json_text(request));  // where it has ended, its answer will not come
  std::size_t end = 0, searched = 0;
  while ((end = pending_.find('\n', searched)) == pending_.npos) {
    searched = pending_.size();
    if (searched > most_answer_bytes) throw Error("{} answered {} with a line without an end", name_, doing);
    if (!read_more(output_, pending_)) fail_as_it_ended(doing);
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
  if (!comes_within(1000, [&] { return waitpid(process_, &status, WNOHANG) == process_; }))
    throw Error("{} closed its output in {} and went on{}", name_, doing, half);
  process_ = -1;
  if (WIFSIGNALED(status))
    throw Error("{} crashed in {}{}: {} (signal {})", name_, doing, half, strsignal(WTERMSIG(status)), WTERMSIG(status));
  throw Error("{} ended in {}{}: exit status {}", name_, doing, half, WEXITSTATUS(status));
}

double ProgramProcess::resident_bytes() const { return process_ > 0 ? own_resident_bytes(process_) : 0; }

}  // namespace gnomon
