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
#include <utility>

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

/// A reader that refuses what it should read, because a file is missing or a limit too tight, tries nothing. Seeds show it,
/// which are read again and again as they are: where each is accepted with its usual chance, that many refused in a row come
/// once in 160,000 times.
void Supervisor::look_for_blindness(const Kind& kind, Tally& tally, const Answer& answer) {
  constexpr std::uint64_t in_row_per_chance = 12;
  ++tally.seeds_tried;
  tally.seeds_accepted += answer.outcome == Outcome::accepted;
  tally.seeds_refused_in_row = answer.outcome == Outcome::accepted ? 0 : tally.seeds_refused_in_row + 1;
  const std::uint64_t most =
      tally.seeds_accepted > 0 ? in_row_per_chance * tally.seeds_tried / tally.seeds_accepted : kind.seeds.size();
  if (tally.seeds_refused_in_row < most) return;
  throw Problem{fmt::format("blind: {} unchanged seeds in a row are refused, the last with: {}",
                            tally.seeds_refused_in_row.exchange(0), answer.complaint)};
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
      const Answer answer = run_input(kinds_[input.kind], input, scratch_);
      ++(answer.outcome == Outcome::accepted ? tally.accepted : tally.refused);
      if (input.is_seed) look_for_blindness(kinds_[input.kind], tally, answer);
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
  ++(what.starts_with("hang")     ? tally.hangs
     : what.starts_with("memory") ? tally.over_memory
     : what.starts_with("blind")  ? tally.blind
                                  : tally.crashes);
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
  std::string shares;  // of the last minute
  for (std::size_t k = 0; k < kinds_.size(); ++k) {
    const Tally& tally = shared_->tallies[k];
    all += tally;
    const std::uint64_t tried = tally.tried - std::exchange(shown_tried_[k], tally.tried);
    const std::uint64_t accepted = tally.accepted - std::exchange(shown_accepted_[k], tally.accepted);
    if (tried > 0) shares += fmt::format(" {} {}/{}", kinds_[k].name, accepted, tried);
  }
  fmt::print("{:.0f} min: {} inputs, {} found; accepted in this minute:{}\n", seconds_since(start_) / 60, all.tried.load(),
             all.found(), shares);
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
  constexpr const char* row = "{:<10} {:>9} {:>9} {:>9} {:>9} {:>8} {:>6} {:>12} {:>6}\n";
  fmt::print(fmt::runtime(row), "kind", "inputs", "refused", "accepted", "share", "crashes", "hangs", "over memory", "blind");
  Tally all;
  const auto print = [&](const std::string& name, const Tally& tally) {
    fmt::print(fmt::runtime(row), name, tally.tried.load(), tally.refused.load(), tally.accepted.load(),
               fmt::format("{:.1f} %", tally.accepted_percent()), tally.crashes.load(), tally.hangs.load(),
               tally.over_memory.load(), tally.blind.load());
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
