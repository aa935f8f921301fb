#pragma once
#include <gnomon/kit/rays/rays.h>
#include <tbb/parallel_for.h>

namespace gnomon {

// Shadow rays of pixels that are traced a second time, in the ray tracer's packets of sixteen.

/// Where the ray to a homogeneous light ends, in lengths of the way there: a directional one has no end.
inline float end_of(const glm::dvec4& light) { return light.w != 0 ? 1.0f : INFINITY; }

/// Calls decide(span of pixels) with all pixels i at (x, y) for which is_asked(i, x, y), up to sixteen of a row at once, rows
/// on all threads.
template <class IsAsked, class Decide>
void decide_in_packets(int width, int height, const IsAsked& is_asked, const Decide& decide) {
  tbb::parallel_for(0, height, [&](int y) {
    std::array<std::size_t, 16> pixels;
    std::size_t count = 0;
    for (int x = 0; x < width; ++x) {
      const std::size_t i = static_cast<std::size_t>(y) * width + x;
      if (is_asked(i, x, y)) pixels[count++] = i;
      if (count == 0 || (count < pixels.size() && x + 1 < width)) continue;
      decide(std::span<const std::size_t>(pixels.data(), count));
      count = 0;
    }
  });
}

}  // namespace gnomon
