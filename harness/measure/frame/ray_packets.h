#pragma once
#include <gnomon/kit/rays.h>
#include <tbb/parallel_for.h>

#include <array>
#include <span>

namespace gnomon {

// Shadow rays of the pixels that are asked about a second time: sixteen at once, as the ray tracer wants them.

/// Lane `lane` of the packet becomes a ray from `origin` along `direction`, both rounded to float32: as long as `direction` for
/// a light at a place, without end for a directional one. Hits before `nearest` of that length do not count.
inline void set_ray(ShadowPacket& packet, int lane, const glm::vec3& origin, const glm::vec3& direction, bool ends_at_light,
                    float nearest = 0) {
  packet.ox[lane] = origin.x;
  packet.oy[lane] = origin.y;
  packet.oz[lane] = origin.z;
  packet.dx[lane] = direction.x;
  packet.dy[lane] = direction.y;
  packet.dz[lane] = direction.z;
  packet.tnear[lane] = nearest;
  packet.tfar[lane] = ends_at_light ? 1.0f : INFINITY;
  packet.time[lane] = 0;
  packet.mask[lane] = 0xffffffffu;
  packet.id[lane] = static_cast<std::uint32_t>(lane);
  packet.flags[lane] = 0;
}

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
