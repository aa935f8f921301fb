#pragma once
#include <gnomon/kit/rays.h>

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

/// Gathers pixels and calls decide(span of pixels) whenever sixteen have come together, and at the end with the rest.
template <class Decide>
class PixelPackets {
 public:
  explicit PixelPackets(const Decide& decide) : decide_(decide) {}
  void add(std::size_t pixel) {
    pixels_[count_++] = pixel;
    if (count_ == pixels_.size()) finish();
  }
  void finish() {
    if (count_ > 0) decide_(std::span<const std::size_t>(pixels_.data(), count_));
    count_ = 0;
  }

 private:
  const Decide& decide_;
  std::array<std::size_t, 16> pixels_;
  std::size_t count_ = 0;
};

}  // namespace gnomon
