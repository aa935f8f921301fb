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

/// Sixteen pixels of a row of shadow rays.
struct Group {
  std::size_t first, count;
  std::uint32_t valid;  ///< bit k: pixel first + k faces the light
  Receivers receivers;
};

/// Calls answer(group, packet, visibility of sixteen pixels) for all groups of pixels, on all threads. Returns the number of
/// rays.
template <class Answer>
std::size_t for_groups(const Scene& scene, const GBuffer& gbuffer, const Light& light, std::span<float> visibility,
                       const Answer& make_answer) {
  const PacketFiller filler{scene, gbuffer, light};
  const std::size_t group_count = (gbuffer.size() + ray_lanes - 1) / ray_lanes;
  std::atomic<std::size_t> ray_count = 0;
  for_blocks(group_count, 16, [&](std::size_t begin, std::size_t end) {
    auto answer = make_answer();
    std::size_t rays = 0;
    ShadowPacket packet;
    std::uint32_t ids[2][ray_lanes] = {};
    float answers[ray_lanes];
    for (std::size_t index = begin; index < end; ++index) {
      const std::size_t first = index * ray_lanes, count = std::min<std::size_t>(ray_lanes, gbuffer.size() - first);
      Group group{first, count, filler.fill(first, packet), {&gbuffer.mesh[first], &gbuffer.triangle[first]}};
      if (count < ray_lanes) {
        std::copy_n(group.receivers.mesh, count, ids[0]);
        std::copy_n(group.receivers.triangle, count, ids[1]);
        group.receivers = {ids[0], ids[1]};
      }
      answer(group, packet, answers);
      std::copy_n(answers, count, &visibility[first]);
      rays += std::popcount(group.valid);
    }
    ray_count += rays;
  });
  return ray_count;
}

}  // namespace

std::uint32_t fill_packet(const Scene& scene, const GBuffer& gbuffer, const Light& light, std::size_t first,
                          ShadowPacket& packet) {
  return PacketFiller{scene, gbuffer, light}.fill(first, packet);
}

std::size_t trace_opaque_shadows(const RayScene& casters, const Scene& scene, const GBuffer& gbuffer, const Light& light,
                                 std::span<float> visibility) {
  return for_groups(scene, gbuffer, light, visibility, [&] {
    return [&](const Group& group, ShadowPacket& packet, float* answers) {
      unpack(group.valid ? casters.occluded(group.valid, packet, group.receivers) : 0, answers);
    };
  });
}

std::size_t trace_shadows(const RayScene& casters, const Scene& scene, const GBuffer& gbuffer, const Light& light,
                          std::span<float> visibility, std::span<std::uint8_t> surfaces) {
  if (!casters.has_transmission()) return trace_opaque_shadows(casters, scene, gbuffer, light, visibility);
  const glm::dvec4 l = homogeneous(light);
  const auto answer_group = [&](const Group& group, ShadowPacket& packet, float* answers,
                                std::span<Crossings, ray_lanes> crossings) {
    const std::uint32_t blocked = group.valid ? casters.crossed(group.valid, packet, group.receivers, crossings) : 0;
    unpack(blocked, answers);
    for (std::uint32_t left = group.valid; left; left &= left - 1) {
      const int k = std::countr_zero(left);
      const std::size_t i = group.first + k;
      std::uint8_t crossed = blocked_surfaces;
      if (!(blocked >> k & 1)) {
        const Crossings::Product product = crossings[k].product(scene, {gbuffer.position(i), l});
        answers[k] = static_cast<float>(product.share.x);
        if (product.share.x > 0) crossed = static_cast<std::uint8_t>(std::min(product.surfaces, blocked_surfaces - 1));
      }
      if (!surfaces.empty()) surfaces[i] = crossed;
    }
  };
  return for_groups(scene, gbuffer, light, visibility, [&] {
    return
        [&, crossings = std::array<Crossings, ray_lanes>()](const Group& group, ShadowPacket& packet, float* answers) mutable {
          answer_group(group, packet, answers, crossings);
        };
  });
}

}  // namespace gnomon
