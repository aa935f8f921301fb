#include <gnomon/kit/parallel.h>
#include <gnomon/kit/rays/rays.h>
#include <gnomon/kit/vectorized.h>

#include <algorithm>
#include <atomic>
#include <bit>
#include <cmath>

namespace gnomon {

namespace {

/// Sixteen pixels of a G-buffer.
struct Pixels {
  const float *px, *py, *pz, *nx, *ny, *nz;
  const std::uint32_t* mesh;
};

/// Ray set-up of a full group. Bit k of the result: pixel k is no background and N.to_light > 0, evaluated in double as
/// faces_light does.
GNOMON_VECTORIZED std::uint32_t set_up(const Pixels& g, const double* light, ShadowPacket& __restrict packet) {
  const double lx = light[0], ly = light[1], lz = light[2], lw = light[3];
  std::uint32_t facing = 0;
  for (int k = 0; k < ray_lanes; ++k) {
    const double x = g.px[k], y = g.py[k], z = g.pz[k], nx = g.nx[k], ny = g.ny[k], nz = g.nz[k];
    const bool on = nx * (lx - lw * x) + ny * (ly - lw * y) + nz * (lz - lw * z) > 0;
    facing |= (on & (g.mesh[k] != no_mesh)) ? 1u << k : 0;
  }
  const float tfar = lw != 0 ? 1.0f : INFINITY;
  const float fx = static_cast<float>(lx), fy = static_cast<float>(ly), fz = static_cast<float>(lz);
  const float fw = static_cast<float>(lw);
  for (int k = 0; k < ray_lanes; ++k) {
    const float x = g.px[k], y = g.py[k], z = g.pz[k];
    const float ax = std::fabs(x), ay = std::fabs(y), az = std::fabs(z);
    const float axy = ax > ay ? ax : ay;
    const float offset = 8 * 0x1p-24f * (axy > az ? axy : az);
    const float ox = x + offset * g.nx[k], oy = y + offset * g.ny[k], oz = z + offset * g.nz[k];
    packet.ox[k] = ox;
    packet.oy[k] = oy;
    packet.oz[k] = oz;
    packet.dx[k] = fx - fw * ox;
    packet.dy[k] = fy - fw * oy;
    packet.dz[k] = fz - fw * oz;
    packet.tnear[k] = 0;
    packet.time[k] = 0;
    packet.tfar[k] = tfar;
    packet.mask[k] = 0xffffffffu;
    packet.id[k] = static_cast<std::uint32_t>(k);
    packet.flags[k] = 0;
  }
  return facing;
}

/// A mask from bits: 0 where blocked, else 1.
GNOMON_VECTORIZED void unpack(std::uint32_t blocked, float* visibility) {
  for (int k = 0; k < ray_lanes; ++k) visibility[k] = blocked & 1u << k ? 0.0f : 1.0f;
}

/// Fills packets with the shadow rays of pixels: what is the same for all of them is found once.
struct PacketFiller {
  const Scene& scene;
  const GBuffer& gbuffer;
  const Light& light;
  glm::dvec4 l = homogeneous(light);
  bool all_receive = std::all_of(scene.meshes.begin(), scene.meshes.end(), [](const Mesh& m) { return m.receives; });
  bool is_spot = std::holds_alternative<SpotLight>(light.kind);

  std::uint32_t fill(std::size_t first, ShadowPacket& packet) const {
    const int count = static_cast<int>(std::min<std::size_t>(ray_lanes, gbuffer.size() - first));
    Pixels pixels{&gbuffer.px[first], &gbuffer.py[first], &gbuffer.pz[first],  &gbuffer.nx[first],
                  &gbuffer.ny[first], &gbuffer.nz[first], &gbuffer.mesh[first]};
    float tail[6][ray_lanes] = {};
    std::uint32_t tail_mesh[ray_lanes];
    if (count < ray_lanes) {
      const float** sources[] = {&pixels.px, &pixels.py, &pixels.pz, &pixels.nx, &pixels.ny, &pixels.nz};
      for (int s = 0; s < 6; ++s) *sources[s] = std::copy_n(*sources[s], count, tail[s]) - count;
      std::fill_n(std::copy_n(pixels.mesh, count, tail_mesh), ray_lanes - count, no_mesh);
      pixels.mesh = tail_mesh;
    }
    std::uint32_t valid = set_up(pixels, &l.x, packet);
    if (all_receive && !is_spot) return valid;
    for (std::uint32_t left = valid; left; left &= left - 1) {
      const int k = std::countr_zero(left);
      const bool on = scene.meshes[pixels.mesh[k]].receives && in_spot_cone(light, gbuffer.position(first + k));
      if (!on) valid &= ~(1u << k);
    }
    return valid;
  }
};

}  // namespace

std::uint32_t fill_packet(const Scene& scene, const GBuffer& gbuffer, const Light& light, std::size_t first,
                          ShadowPacket& packet) {
  return PacketFiller{scene, gbuffer, light}.fill(first, packet);
}

std::size_t trace_shadows(const RayScene& casters, const Scene& scene, const GBuffer& gbuffer, const Light& light,
                          std::span<float> visibility) {
  const PacketFiller filler{scene, gbuffer, light};
  const std::size_t group_count = (gbuffer.size() + ray_lanes - 1) / ray_lanes;
  std::atomic<std::size_t> ray_count = 0;
  for_blocks(group_count, 16, [&](std::size_t begin, std::size_t end) {
    std::size_t rays = 0;
    ShadowPacket packet;
    std::uint32_t ids[2][ray_lanes] = {};
    float answer[ray_lanes];
    for (std::size_t group = begin; group < end; ++group) {
      const std::size_t first = group * ray_lanes, count = std::min<std::size_t>(ray_lanes, gbuffer.size() - first);
      const std::uint32_t valid = filler.fill(first, packet);
      std::uint32_t blocked = 0;
      if (valid) {
        Receivers receivers{&gbuffer.mesh[first], &gbuffer.triangle[first]};
        if (count < ray_lanes) {
          std::copy_n(receivers.mesh, count, ids[0]);
          std::copy_n(receivers.triangle, count, ids[1]);
          receivers = {ids[0], ids[1]};
        }
        blocked = casters.occluded(valid, packet, receivers);
      }
      unpack(blocked, answer);
      std::copy_n(answer, count, &visibility[first]);
      rays += std::popcount(valid);
    }
    ray_count += rays;
  });
  return ray_count;
}

}  // namespace gnomon
