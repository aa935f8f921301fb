#include <gnomon/kit/progress.h>

#include <algorithm>

namespace gnomon {

namespace {
std::atomic<std::atomic<std::size_t>*> watched = nullptr;
}  // namespace

void tell_progress(double share) {
  if (std::atomic<std::size_t>* const steps = watched.load())
    steps->store(static_cast<std::size_t>(std::clamp(share, 0.0, 1.0) * progress_steps));
}

void watch_progress(std::atomic<std::size_t>* steps) { watched = steps; }

}  // namespace gnomon
