#pragma once
#include <chrono>
#include <optional>
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
  /// A part of the work takes long by itself: what it is, and its share that is done, 0 where it is unknown. The line shows it
  /// for as long as this is called again and again; where nothing was expected, the bar is that of the part. It is shown when
  /// it has taken longer than the pause between two lines.
  void part(const std::string& what, double share);
  /// The part is through.
  void end_part();
  /// A line that stays, above the bar.
  void say(const std::string& line);

 private:
  using Clock = std::chrono::steady_clock;
  struct Part {
    std::string what;
    double share = 0;
    Clock::time_point start = Clock::now(), moving = start;  ///< moving: when nothing was done yet
  };

  void draw(bool force);
  void clear();
  /// The share that is done, how long the rest will take, and what is done.
  std::string line(double share, Clock::time_point start, const std::string& what) const;
  std::string part_text() const;

  bool quiet_, terminal_;
  double total_ = 0, done_ = 0;
  std::string what_;
  std::optional<Part> part_;
  Clock::time_point start_ = Clock::now(), drawn_{};
};

inline double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

/// "1 min 5 s", "12 s".
std::string duration_text(double seconds);

}  // namespace gnomon
