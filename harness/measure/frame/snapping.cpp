#include "measure/frame/snapping.h"

#include <tbb/parallel_for.h>

#include <cmath>

#include "measure/frame/gbuffer_maker.h"

namespace gnomon {

namespace {

/// Asks the ray tracer again with the sample points moved, sixteen pixels at a time.
class Mover {
 public:
  Mover(const Scene& scene, const RayScene& everything, const RayScene& casters, const GBuffer& gbuffer, const Light& light)
      : scene_(scene),
        everything_(everything),
        casters_(casters),
        gbuffer_(gbuffer),
        light_(light),
        l_(homogeneous(light)),
        camera_(gbuffer.view, gbuffer.width, gbuffer.height) {}

  /// Bit k: pixel pixels[k] has another answer at some corner.
  std::uint32_t flips(const std::size_t* pixels, int count, std::span<const float> reference) const {
    std::uint32_t dark = 0, flipped = 0;
    for (int k = 0; k < count; ++k) dark |= static_cast<std::uint32_t>(reference[pixels[k]] < 0.5f) << k;
    for (int corner = 0; corner < 4; ++corner) {
      ShadowPacket packet{};
      std::uint32_t mesh[16] = {}, triangle[16] = {}, valid = 0;
      for (int k = 0; k < count; ++k) {
        const double x = static_cast<double>(pixels[k] % gbuffer_.width) + 0.5 + (corner & 1 ? most_snapping : -most_snapping);
        const double y = static_cast<double>(pixels[k] / gbuffer_.width) + 0.5 + (corner & 2 ? most_snapping : -most_snapping);
        const Seen seen = see(scene_, everything_, camera_, gbuffer_.truth, x, y);
        if (!has_answer(seen)) continue;
        valid |= 1u << k;
        mesh[k] = seen.mesh;
        triangle[k] = seen.triangle;
        aim(packet, k, seen);
      }
      if (valid) flipped |= (casters_.occluded(valid, packet, {mesh, triangle}) ^ dark) & valid;
    }
    return flipped;
  }

 private:
  /// As faces_light says it of a pixel.
  bool has_answer(const Seen& seen) const {
    return seen.mesh != no_mesh && scene_.meshes[seen.mesh].receives &&
           glm::dot(glm::dvec3(seen.normal), to_light(l_, seen.position)) > 0 && in_spot_cone(light_, seen.position);
  }

  /// By the recipe of the reference.
  void aim(ShadowPacket& packet, int k, const Seen& seen) const {
    const glm::vec3 origin = seen.position + static_cast<float>(ray_offset(seen.position)) * seen.normal;
    const glm::vec3 direction = glm::vec3(l_) - static_cast<float>(l_.w) * origin;
    packet.ox[k] = origin.x;
    packet.oy[k] = origin.y;
    packet.oz[k] = origin.z;
    packet.dx[k] = direction.x;
    packet.dy[k] = direction.y;
    packet.dz[k] = direction.z;
    packet.tfar[k] = l_.w != 0 ? 1.0f : INFINITY;
    packet.mask[k] = 0xffffffffu;
    packet.id[k] = static_cast<std::uint32_t>(k);
  }

  const Scene& scene_;
  const RayScene& everything_;
  const RayScene& casters_;
  const GBuffer& gbuffer_;
  const Light& light_;
  glm::dvec4 l_;
  Camera camera_;
};

}  // namespace

std::vector<std::uint8_t> find_snapping(const Scene& scene, const RayScene& everything, const RayScene& casters,
                                        const GBuffer& gbuffer, const Light& light, std::span<const float> reference,
                                        std::span<const PixelClass> classes) {
  const Mover mover(scene, everything, casters, gbuffer, light);
  std::vector<std::uint8_t> snapping(gbuffer.size());
  tbb::parallel_for(0, gbuffer.height, [&](int y) {
    std::size_t pending[16];
    int count = 0;
    const auto flush = [&] {
      const std::uint32_t flips = count ? mover.flips(pending, count, reference) : 0;
      for (int k = 0; k < count; ++k) snapping[pending[k]] = flips >> k & 1;
      count = 0;
    };
    for (int x = 0; x < gbuffer.width; ++x) {
      const std::size_t i = static_cast<std::size_t>(y) * gbuffer.width + x;
      if (classes[i] != PixelClass::T) continue;
      pending[count++] = i;
      if (count == 16) flush();
    }
    flush();
  });
  return snapping;
}

}  // namespace gnomon
