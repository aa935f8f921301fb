#pragma once
#include <gnomon/kit/rays/rays.h>

#include <algorithm>
#include <bit>
#include <cmath>

namespace gnomon {

// The frame in which Embree traces a scene: that of the world, or scaled to numbers that float32 has room for.

/// Largest absolute coordinate of the meshes that do not move.
inline double extent_of_still(const Scene& scene) {
  Bounds bounds;
  for (const Mesh& mesh : scene.meshes)
    if (mesh.reach.empty()) bounds.add(mesh.positions);
  return bounds.extent();
}

/// Embree multiplies up to three lengths, and divides by components of directions that it takes for 1e-18 at least. Between 1
/// mm and 2^30 m a scene is traced as it is; else in units of a power of two in which its largest coordinate is 1 to 2: that
/// rounds nothing. Scale of the world to that frame; `still` is extent_of_still. What meshes reach counts, so that the frame
/// stays the same while they move.
inline double traced_scale(const Scene& scene, double still) {
  double extent = still;
  for (const Mesh& mesh : scene.meshes) extent = std::max(extent, mesh.reach.extent());
  return extent == 0 || (extent >= 0x1p-10 && extent <= 0x1p30) ? 1 : std::exp2(std::min(-std::ilogb(extent), 100));
}

/// From there, in units of the frame, a scene is a point, and Embree ends the program soon after.
constexpr double too_far = 0x1p56;

/// Takes a packet to the frame, each direction at a length of 1 to 4. Returns the lanes whose origin is near enough to trace.
inline std::uint32_t into_frame(ShadowPacket& packet, double scale) {
  std::uint32_t near = 0;
  for (int lane = 0; lane < 16; ++lane) {
    const glm::dvec3 origin = scale * glm::dvec3(packet.ox[lane], packet.oy[lane], packet.oz[lane]);
    if (!(extent(origin) < too_far)) continue;
    near |= 1u << lane;
    const glm::dvec3 direction(packet.dx[lane], packet.dy[lane], packet.dz[lane]);
    const double longest = extent(direction), unit = longest > 0 ? std::exp2(-std::ilogb(longest)) : 1;
    const auto scaled = [&](float length) { return static_cast<float>(length * (scale / unit)); };
    set_ray(packet, lane, origin, direction * unit, scaled(packet.tfar[lane]), scaled(packet.tnear[lane]));
  }
  return near;
}

/// Whether a packet has directions so short that Embree would take others for them.
inline bool is_short(std::uint32_t valid, const ShadowPacket& packet) {
  const auto lane = static_cast<std::size_t>(std::countr_zero(valid));
  return lane < 16 && extent(glm::dvec3(packet.dx[lane], packet.dy[lane], packet.dz[lane])) < 0x1p-30;
}

}  // namespace gnomon
