#pragma once
#include <chrono>
#include <string>

namespace gnomon {

/// Progress of long work on stderr: one line that redraws itself on a terminal (what runs, how much is done, time left),
/// plain lines otherwise, at most one every few seconds.
class Progress {
 public:
  explicit Progress(bool quiet = false);
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  /// Sets how many units there are in all, done ones included.
  void expect(double units) { total_ = units; }
  /// What is being done now.
  void step(const std::string& what);
  /// Some units were done.
  void advance(double units);
  /// A line that stays, above the bar.
  void say(const std::string& line);

 private:
  void draw(bool force);
  void clear();

  using Clock = std::chrono::steady_clock;
  bool quiet_, terminal_;
  double total_ = 0, done_ = 0;
  std::string what_;
  Clock::time_point start_ = Clock::now(), drawn_{};
};

inline double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

/// "1 min 5 s", "12 s".
std::string duration_text(double seconds);

}  // namespace gnomon
