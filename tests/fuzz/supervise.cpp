// Inputs are read in child processes, one after the other, until one brings its process down or the time is over. What a
// process was reading when it ended is known from memory that both share.
#include "supervise.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <signal.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstring>
#include <fstream>

#include "run_input.h"

namespace fuzz {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

namespace {

constexpr double hang_seconds = 60;  // of the clock; processor time is bounded more closely, see run_input.h

double seconds_since(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

}  // namespace

Supervisor::Supervisor(const Options& options, const Source& source, std::vector<Kind>& kinds, const fs::path& scratch)
    : options_(options), source_(source), kinds_(kinds), scratch_(scratch), log_(scratch / "stderr") {
  void* memory = mmap(nullptr, sizeof(Shared), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
  if (memory == MAP_FAILED) throw std::bad_alloc();
  shared_ = new (memory) Shared;
}

/// Reads inputs from `first` on; in the child.
void Supervisor::read_inputs(std::uint64_t first, Clock::time_point deadline) {
  const int log = open(log_.c_str(), O_RDWR | O_CREAT | O_TRUNC | O_APPEND, 0666), nothing = open("/dev/null", O_RDWR);
  dup2(nothing, STDIN_FILENO);
  dup2(nothing, STDOUT_FILENO);
  dup2(log, STDERR_FILENO);
  fs::current_path(scratch_);
  for (std::uint64_t n = first; n < source_.count && Clock::now() < deadline; ++n) {
    const Input input = source_.make(n);
    ftruncate(log, 0);
    Tally& tally = shared_->tallies[input.kind];
    shared_->kind = input.kind;
    shared_->number = n;
    ++tally.tried;
    try {
      ++(run_input(kinds_[input.kind], input, scratch_) == Outcome::accepted ? tally.accepted : tally.refused);
    } catch (const Problem& problem) {
      const std::size_t size = std::min(problem.what.size(), sizeof shared_->problem - 1);
      std::memcpy(shared_->problem, problem.what.data(), size);
      shared_->problem[size] = 0;
      _exit(found_status);
    }
  }
  shared_->number = source_.count;  // done
  _exit(0);
}

/// Waits for the child's end; empty when it ended well, else what is wrong with the input that it was reading.
std::string Supervisor::watch(pid_t child) {
  std::uint64_t number = UINT64_MAX;
  auto since = Clock::now();
  for (int status = 0;;) {
    if (waitpid(child, &status, WNOHANG) == child) {
      if (WIFEXITED(status) && WEXITSTATUS(status) == 0) return "";
      if (WIFEXITED(status) && WEXITSTATUS(status) == found_status) return shared_->problem;
      if (WIFEXITED(status)) return fmt::format("crash: the process exited with {}", WEXITSTATUS(status));
      return fmt::format("crash: signal {} ({})", WTERMSIG(status), strsignal(WTERMSIG(status)));
    }
    if (const std::uint64_t now = shared_->number; now != number) {
      number = now;
      since = Clock::now();
    }
    if (seconds_since(since) > hang_seconds) {
      kill(child, SIGKILL);
      waitpid(child, nullptr, 0);
      return fmt::format("hang: more than {} s", hang_seconds);
    }
    usleep(20'000);
    show_progress();
  }
}

void Supervisor::save(std::uint64_t number, const std::string& what) {
  const Input input = source_.make(number);
  Tally& tally = shared_->tallies[input.kind];
  ++(what.starts_with("hang") ? tally.hangs : what.starts_with("memory") ? tally.over_memory : tally.crashes);
  const fs::path folder = options_.findings / kinds_[input.kind].name;
  fs::create_directories(folder);
  const fs::path file = folder / fmt::format("{}-{}", number, input.name);
  std::ofstream(file, std::ios::binary) << input.bytes;
  std::ofstream report(file.string() + ".txt");
  report << what << '\n';
  if (std::ifstream log(log_); log.peek() != EOF) report << log.rdbuf();
  fmt::print("found: {}: {}\n", file.string(), what);
  std::fflush(stdout);
}

void Supervisor::show_progress() {
  if (seconds_since(shown_) < 60) return;
  shown_ = Clock::now();
  Tally all;
  for (const Tally& tally : shared_->tallies) all += tally;
  fmt::print("{:.0f} min: {} inputs, {} refused, {} accepted, {} found\n", seconds_since(start_) / 60, all.tried, all.refused,
             all.accepted, all.found());
  std::fflush(stdout);
}

int Supervisor::run() {
  const auto deadline =
      source_.count == UINT64_MAX
          ? start_ + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(60 * options_.minutes))
          : Clock::time_point::max();
  for (std::uint64_t next = 0; next < source_.count && Clock::now() < deadline;) {
    shared_->number = next;
    std::fflush(stdout);
    const pid_t child = fork();
    if (child < 0) throw std::runtime_error("no process");
    if (child == 0) {
      setpgid(0, 0);
      read_inputs(next, deadline);
    }
    const std::string what = watch(child);
    kill(-child, SIGKILL);  // what it left behind
    if (!what.empty()) save(shared_->number, what);
    next = shared_->number + 1;
  }
  return print_table();
}

int Supervisor::print_table() const {
  constexpr const char* row = "{:<10} {:>9} {:>9} {:>9} {:>8} {:>6} {:>12}\n";
  fmt::print(fmt::runtime(row), "kind", "inputs", "refused", "accepted", "crashes", "hangs", "over memory");
  Tally all;
  const auto print = [&](const std::string& name, const Tally& tally) {
    fmt::print(fmt::runtime(row), name, tally.tried.load(), tally.refused.load(), tally.accepted.load(), tally.crashes.load(),
               tally.hangs.load(), tally.over_memory.load());
  };
  for (std::size_t k = 0; k < kinds_.size(); ++k) {
    print(kinds_[k].name, shared_->tallies[k]);
    all += shared_->tallies[k];
  }
  print("all", all);
  fmt::print("{:.1f} minutes; {} found\n", seconds_since(start_) / 60, all.found());
  return all.found() > 0 ? 1 : 0;
}

}  // namespace fuzz
