#include "measure/frame/snapping.h"

#include "measure/frame/gbuffer_maker.h"
#include "measure/frame/ray_packets.h"

namespace gnomon {

namespace {

/// Asks the ray tracer again with the sample points moved, sixteen pixels at a time.
class SnappedRays {
 public:
  SnappedRays(const Scene& scene, const RayScene& everything, const RayScene& casters, const GBuffer& gbuffer,
              const Light& light)
      : scene_(scene),
        everything_(everything),
        casters_(casters),
        gbuffer_(gbuffer),
        light_(light),
        l_(homogeneous(light)),
        camera_(gbuffer.view, gbuffer.width, gbuffer.height) {}

  /// Bit k: pixel pixels[k] has another answer at some corner.
  std::uint32_t flips(std::span<const std::size_t> pixels, std::span<const float> reference) const {
    const int count = static_cast<int>(pixels.size());
    std::uint32_t dark = 0, flipped = 0;
    for (int k = 0; k < count; ++k) dark |= static_cast<std::uint32_t>(!is_lit(reference[pixels[k]])) << k;
    for (int corner = 0; corner < 4; ++corner) {
      ShadowPacket packet{};
      std::uint32_t mesh[16] = {}, triangle[16] = {}, valid = 0;
      for (int k = 0; k < count; ++k) {
        const double x = static_cast<double>(pixels[k] % gbuffer_.width) + 0.5 + (corner & 1 ? most_snapping : -most_snapping);
        const double y = static_cast<double>(pixels[k] / gbuffer_.width) + 0.5 + (corner & 2 ? most_snapping : -most_snapping);
        const SurfacePoint point = surface_through(scene_, everything_, camera_, gbuffer_.truth, x, y);
        if (!has_answer(point)) continue;
        valid |= 1u << k;
        mesh[k] = point.mesh;
        triangle[k] = point.triangle;
        aim(packet, k, point);
      }
      if (valid) flipped |= (casters_.occluded(valid, packet, {mesh, triangle}) ^ dark) & valid;
    }
    return flipped;
  }

 private:
  /// As faces_light says it of a pixel.
  bool has_answer(const SurfacePoint& point) const {
    return point.mesh != no_mesh && scene_.meshes[point.mesh].receives &&
           glm::dot(glm::dvec3(point.normal), to_light(l_, point.position)) > 0 && in_spot_cone(light_, point.position);
  }

  /// By the recipe of the reference.
  void aim(ShadowPacket& packet, int k, const SurfacePoint& point) const {
    const glm::vec3 origin = point.position + static_cast<float>(ray_offset(point.position)) * point.normal;
    const glm::vec3 direction = glm::vec3(l_) - static_cast<float>(l_.w) * origin;
    set_ray(packet, k, origin, direction, l_.w != 0);
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
  const SnappedRays snapped(scene, everything, casters, gbuffer, light);
  std::vector<std::uint8_t> snapping(gbuffer.size());
  const auto is_asked = [&](std::size_t i, int, int) { return classes[i] == PixelClass::T; };
  decide_in_packets(gbuffer.width, gbuffer.height, is_asked, [&](std::span<const std::size_t> pixels) {
    const std::uint32_t flips = snapped.flips(pixels, reference);
    for (std::size_t k = 0; k < pixels.size(); ++k) snapping[pixels[k]] = flips >> k & 1;
  });
  return snapping;
}

}  // namespace gnomon
