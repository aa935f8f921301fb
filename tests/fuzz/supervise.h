#pragma once
#include <atomic>
#include <chrono>

#include "fuzz.h"

namespace fuzz {

/// Input `n`, the same at every call.
struct Source {
  std::uint64_t count = UINT64_MAX;  ///< that many there are, or no end
  std::function<Input(std::uint64_t n)> make;
};

struct Tally {
  std::atomic<std::uint64_t> tried = 0, refused = 0, accepted = 0, crashes = 0, hangs = 0, over_memory = 0, blind = 0;
  std::atomic<std::uint64_t> seeds_tried = 0, seeds_accepted = 0, seeds_refused_in_row = 0;
  std::uint64_t found() const { return crashes + hangs + over_memory + blind; }
  double accepted_percent() const { return tried > 0 ? 100.0 * static_cast<double>(accepted) / static_cast<double>(tried) : 0; }
  void operator+=(const Tally& other) {
    tried += other.tried;
    refused += other.refused;
    accepted += other.accepted;
    crashes += other.crashes;
    hangs += other.hangs;
    over_memory += other.over_memory;
    blind += other.blind;
  }
};

class Supervisor {
 public:
  Supervisor(const Options& options, const Source& source, std::vector<Kind>& kinds, const std::filesystem::path& scratch);
  /// Until the inputs or the time are over; prints the table. The exit status: 1 when something was found.
  int run();

 private:
  static constexpr std::size_t most_kinds = 16;
  static constexpr int found_status = 3;  ///< of a child that has put a Problem into `Shared`

  /// What a child tells while it lives, and leaves when it ends.
  struct Shared {
    std::atomic<std::uint64_t> number = 0, kind = 0;
    Tally tallies[most_kinds];
    char problem[2000] = {};
  };

  [[noreturn]] void read_inputs(std::uint64_t first, std::chrono::steady_clock::time_point deadline);
  std::string watch(pid_t child);
  void save(std::uint64_t number, const std::string& what);
  void show_progress();
  void look_for_blindness(const Kind& kind, Tally& tally, const Answer& answer);
  int print_table() const;

  const Options& options_;
  const Source& source_;
  std::vector<Kind>& kinds_;
  const std::filesystem::path scratch_, log_;
  const std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
  std::chrono::steady_clock::time_point shown_ = start_;
  std::uint64_t shown_tried_[most_kinds] = {}, shown_accepted_[most_kinds] = {};
  Shared* shared_ = nullptr;
};

}  // namespace fuzz
