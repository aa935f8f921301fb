#include "measure/run/progress.h"

#include <fmt/format.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "measure/notice.h"

namespace gnomon {

std::string duration_text(double seconds) {
  const long s = std::lround(seconds);
  if (s < 60) return fmt::format("{} s", s);
  if (s < 3600) return fmt::format("{} min {} s", s / 60, s % 60);
  return fmt::format("{} h {} min", s / 3600, s % 3600 / 60);
}

Progress::Progress(bool quiet) : quiet_(quiet), terminal_(isatty(STDERR_FILENO)) {}
Progress::~Progress() { clear(); }

void Progress::step(const std::string& what) {
  what_ = what;
  draw(false);
}

void Progress::advance(double units) {
  done_ += units;
  draw(false);
}

void Progress::say(const std::string& line) {
  if (quiet_) return;
  clear();
  print_notice("{}\n", line);
  draw(true);
}

void Progress::clear() {
  if (!quiet_ && terminal_ && drawn_ != Clock::time_point{}) print_notice("\r\033[K");
}

void Progress::draw(bool force) {
  const auto now = Clock::now();
  const auto pause = terminal_ ? std::chrono::milliseconds(100) : std::chrono::milliseconds(5000);
  if (quiet_ || total_ <= 0 || (!force && now - drawn_ < pause) || (force && !terminal_)) return;
  drawn_ = now;
  const double share = std::min(1.0, done_ / total_), spent = std::chrono::duration<double>(now - start_).count();
  const std::string left = share > 0.02 ? duration_text(spent / share * (1 - share)) + " left" : "";
  if (!terminal_) {
    print_notice("{:3.0f} %  {:<14} {}\n", 100 * share, left, what_);
    return;
  }
  winsize window{};
  const int columns = ioctl(STDERR_FILENO, TIOCGWINSZ, &window) == 0 && window.ws_col > 20 ? window.ws_col : 80;
  const int filled = static_cast<int>(20 * share);
  std::string line = fmt::format("[{}{}] {:3.0f} %  {:<14} {}", std::string(filled, '#'), std::string(20 - filled, '.'),
                                 100 * share, left, what_);
  line.resize(std::min<std::size_t>(line.size(), static_cast<std::size_t>(columns - 1)));
  print_notice("\r\033[K{}", line);
  std::fflush(stderr);
}

}  // namespace gnomon
