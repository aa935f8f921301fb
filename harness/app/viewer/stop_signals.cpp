#include "app/viewer/stop_signals.h"

#include <fcntl.h>
#include <signal.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <system_error>

namespace gnomon::viewer {

namespace {

constexpr std::array stopping = {SIGTERM, SIGINT, SIGHUP};
constexpr char asked_to_stop = 's', over = 'o';

// A handler may do little more than write to a pipe; a thread reads the other end.
int ends[2] = {-1, -1};
std::array<struct sigaction, stopping.size()> before;

void tell(char what) {
  const int kept = errno;
  [[maybe_unused]] const ssize_t ignored = write(ends[1], &what, 1);
  errno = kept;
}

}  // namespace

StopSignals::StopSignals(std::function<void()> asked) {
  if (pipe2(ends, O_CLOEXEC) != 0) throw std::system_error(errno, std::generic_category(), "pipe");
  thread_ = std::thread([this, asked = std::move(asked)] {
    char what = 0;
    while (what != over) {
      const ssize_t count = read(ends[0], &what, 1);
      if (count < 0 && errno == EINTR) continue;
      if (count != 1) return;
      if (what == asked_to_stop) {
        is_asked_ = true;
        asked();
      }
    }
  });
  struct sigaction ours = {};
  ours.sa_handler = [](int) { tell(asked_to_stop); };
  ours.sa_flags = SA_RESTART | static_cast<int>(SA_RESETHAND);
  for (std::size_t k = 0; k < stopping.size(); ++k) {
    sigaction(stopping[k], nullptr, &before[k]);
    if (before[k].sa_handler != SIG_IGN) sigaction(stopping[k], &ours, nullptr);
  }
}

StopSignals::~StopSignals() {
  for (std::size_t k = 0; k < stopping.size(); ++k) sigaction(stopping[k], &before[k], nullptr);
  tell(over);
  thread_.join();
  for (const int end : ends) close(end);
}

}  // namespace gnomon::viewer
