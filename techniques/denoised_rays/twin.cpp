#include "twin.h"

#include <gnomon/error.h>

namespace gnomon::denoised_rays {

void Twin::forget() {
  frames_ = 0;
  has_stepped_ = false;
}

void Twin::advance() {
  if (!has_stepped_) return;
  last_.swap(next_);
  ++frames_;
  has_stepped_ = false;
}

std::vector<ErrorParts> Twin::part(const Denoiser& denoiser, const FrameInput& in, const Settings& settings,
                                   std::span<const float> exact, std::span<const float> out) {
  const std::size_t size = in.asked.size();
  if (exact.size() != size) throw Error("{} exact shares do not fit a picture of {} pixels", exact.size(), size);
  const std::span<const float> blended = denoiser.blended_asked();
  std::vector<float> now(size), still(size), asked(size);
  for (std::size_t i = 0; i < size; ++i) {
    if (!in.faces[i]) continue;
    now[i] = exact[i] * in.asked[i];
    still[i] = exact[i] * blended[i];
  }
  next_.resize(size);
  denoiser.follow(in, settings, filter_, {.before = last_, .now = now, .still = still, .asked = asked, .kept = next_});
  has_stepped_ = true;

  std::vector<ErrorParts> parts(size);
  for (std::size_t i = 0; i < size; ++i) {
    if (!in.faces[i]) continue;
    // Nothing asked: the twin has nothing to be off by.
    const double whole = asked[i], twin = whole > 0 ? now[i] / whole : exact[i],
                 filtered = whole > 0 ? still[i] / whole : exact[i];
    parts[i] = error_parts(out[i], twin, filtered, exact[i]);
  }
  return parts;
}

}  // namespace gnomon::denoised_rays
