#include "measure/progress.h"

#include <fmt/format.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>

#include "measure/notice.h"
#include "measure/printable.h"

namespace gnomon {

std::string duration_text(double seconds) {
  const long s = std::lround(seconds);
  if (s < 60) return fmt::format("{} s", s);
  if (s < 3600) return fmt::format("{} min {} s", s / 60, s % 60);
  return fmt::format("{} h {} min", s / 3600, s % 3600 / 60);
}

static std::string time_left(double share, std::chrono::steady_clock::time_point start) {
  return share > 0.02 ? duration_text(seconds_since(start) / share * (1 - share)) + " left" : "";
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
  print_notice("{}\n", printable(line));
  draw(true);
}

void Progress::part(const std::string& what, double share) {
  if (!part_ || part_->what != what) part_ = Part{.what = what};
  part_->share = std::min(1.0, share);
  if (share == 0) part_->moving = Clock::now();
  draw(false);
}

void Progress::end_part() {
  if (!part_) return;
  part_.reset();
  if (total_ > 0) return;
  clear();
  drawn_ = {};
}

void Progress::clear() {
  if (!quiet_ && terminal_ && drawn_ != Clock::time_point{}) print_notice("\r\033[K");
}

void Progress::draw(bool force) {
  const auto now = Clock::now();
  const auto pause = terminal_ ? std::chrono::milliseconds(100) : std::chrono::milliseconds(5000);
  const bool is_silent = part_ ? now - part_->start < pause : total_ <= 0;
  if (quiet_ || is_silent || (!force && now - drawn_ < pause) || (force && !terminal_)) return;
  drawn_ = now;
  const std::string text = total_ > 0         ? line(std::min(1.0, done_ / total_), start_, part_ ? part_text() : what_)
                           : part_->share > 0 ? line(part_->share, part_->moving, part_->what)
                                              : part_->what + " ...";
  if (!terminal_) return print_notice("{}\n", text);
  winsize window{};
  const int columns = ioctl(STDERR_FILENO, TIOCGWINSZ, &window) == 0 && window.ws_col > 20 ? window.ws_col : 80;
  print_notice("\r\033[K{}", text.substr(0, static_cast<std::size_t>(columns - 1)));
  std::fflush(stderr);
}

std::string Progress::line(double share, Clock::time_point start, const std::string& what) const {
  const int filled = static_cast<int>(20 * share);
  const std::string bar = terminal_ ? fmt::format("[{}{}] ", std::string(filled, '#'), std::string(20 - filled, '.')) : "";
  return fmt::format("{}{:3.0f} %  {:<14} {}", bar, 100 * share, time_left(share, start), what);
}

std::string Progress::part_text() const {
  const std::string left = time_left(part_->share, part_->moving);
  const std::string share = part_->share > 0 ? fmt::format(": {:.0f} %", 100 * part_->share) : "";
  return part_->what + share + (left.empty() ? "" : ", " + left);
}

}  // namespace gnomon
