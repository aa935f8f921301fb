#include "measure/frame/classify.h"

#include <optional>

#include "measure/frame/gbuffer_maker.h"
#include "measure/frame/moved_rays.h"
#include "measure/frame/ray_packets.h"

namespace gnomon {

namespace {

// Gray for what is not decided, light for what is scored, colors for what is left out.
constexpr ClassInfo classes_table[] = {
    {"B", "background", "No surface: nothing to decide.", {24, 26, 30}},
    {"F",
     "turned away",
     "Faces away from the light, lies outside its cone, or does not receive: dark whatever the mask says.",
     {92, 96, 104}},
    {"G", "grazing", "The light grazes the surface, at 2 degrees or less: any bias decides it.", {238, 190, 50}},
    {"S", "silhouette", "Beside the outline of something nearer or farther: primary visibility decides it.", {20, 105, 210}},
    {"U", "uncertain", "The reference's answer changes within float32 rounding.", {215, 55, 60}},
    {"T",
     "tested",
     "The wrong rate is the share of these that are wrong, the mean error what they are off by on average.",
     {212, 216, 214}},
};

/// Asks the ray tracer again with the sample points moved, sixteen pixels at a time.
class SnappedRays {
 public:
  SnappedRays(const Scene& scene, const RayScene& everything, const RayScene& casters, const GBuffer& gbuffer,
              const Light& light, int subpixel_bits)
      : scene_(scene),
        everything_(everything),
        casters_(casters),
        gbuffer_(gbuffer),
        light_(light),
        l_(homogeneous(light)),
        camera_(gbuffer.view, gbuffer.width, gbuffer.height),
        most_(snapping_grid(subpixel_bits) / 2) {}

  /// Bit k: pixel pixels[k] has another answer at some corner.
  std::uint32_t flips(std::span<const std::size_t> pixels, std::span<const float> reference) const {
    const int count = static_cast<int>(pixels.size());
    std::uint32_t dark = 0, flipped = 0;
    for (int k = 0; k < count; ++k) dark |= static_cast<std::uint32_t>(!is_lit(reference[pixels[k]])) << k;
    for (int corner = 0; corner < 4; ++corner) {
      ShadowPacket packet{};
      std::uint32_t mesh[16] = {}, triangle[16] = {}, valid = 0;
      for (int k = 0; k < count; ++k) {
        const double x = static_cast<double>(pixels[k] % gbuffer_.width) + 0.5 + (corner & 1 ? most_ : -most_);
        const double y = static_cast<double>(pixels[k] / gbuffer_.width) + 0.5 + (corner & 2 ? most_ : -most_);
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
    set_ray(packet, k, origin, direction, end_of(l_));
  }

  const Scene& scene_;
  const RayScene& everything_;
  const RayScene& casters_;
  const GBuffer& gbuffer_;
  const Light& light_;
  glm::dvec4 l_;
  Camera camera_;
  double most_;  // pixels that a vertex is moved by
};

}  // namespace

bool is_silhouette(const GBuffer& gbuffer, int x, int y) {
  const std::size_t i = static_cast<std::size_t>(y) * gbuffer.width + x;
  const glm::vec3 eye = gbuffer.view.eye;
  const float distance = glm::distance(gbuffer.position(i), eye);
  for (int ny = std::max(0, y - 1); ny <= std::min(gbuffer.height - 1, y + 1); ++ny)
    for (int nx = std::max(0, x - 1); nx <= std::min(gbuffer.width - 1, x + 1); ++nx) {
      const std::size_t j = static_cast<std::size_t>(ny) * gbuffer.width + nx;
      if (gbuffer.is_background(j)) return true;
      if (gbuffer.mesh[j] != gbuffer.mesh[i] && std::abs(glm::distance(gbuffer.position(j), eye) - distance) > 0.02f * distance)
        return true;
    }
  return false;
}

bool is_resolved(const Scene& scene, const Light& light, const View& view) {
  const Bounds box = scene.bounds();
  return box.empty() || extent(glm::dvec3(box.max) - glm::dvec3(box.min)) >= 0x1p-12 * extent(scene, light, view);
}

std::vector<PixelClass> classify(const Scene& scene, const RayScene& casters, const GBuffer& gbuffer, const Light& light,
                                 std::span<const float> reference) {
  const glm::dvec4 l = homogeneous(light);
  std::optional<MovedRays> moved;
  if (is_resolved(scene, light, gbuffer.view))
    moved.emplace(scene, casters, gbuffer, l, extent(scene, light, gbuffer.view), reference);
  std::vector<PixelClass> classes(gbuffer.size(), PixelClass::T);
  const auto is_asked = [&](std::size_t i, int x, int y) {
    if (gbuffer.is_background(i))
      classes[i] = PixelClass::B;
    else if (!faces_light(scene, gbuffer, light, i))
      classes[i] = PixelClass::F;
    else if (const glm::dvec3 to = to_light(l, gbuffer.position(i));
             glm::dot(glm::dvec3(gbuffer.normal(i)), to) < 0.035 * glm::length(to))
      classes[i] = PixelClass::G;
    else if (is_silhouette(gbuffer, x, y))
      classes[i] = PixelClass::S;
    return classes[i] == PixelClass::T;
  };
  decide_in_packets(gbuffer.width, gbuffer.height, is_asked, [&](std::span<const std::size_t> pixels) {
    const std::uint32_t unstable = moved ? moved->unstable(pixels) : ~0u;
    for (std::size_t k = 0; k < pixels.size(); ++k)
      if (unstable >> k & 1) classes[pixels[k]] = PixelClass::U;
  });
  return classes;
}

std::vector<std::uint8_t> find_snapping(const Scene& scene, const RayScene& everything, const RayScene& casters,
                                        const GBuffer& gbuffer, const Light& light, std::span<const float> reference,
                                        std::span<const PixelClass> classes, int subpixel_bits) {
  const SnappedRays snapped(scene, everything, casters, gbuffer, light, subpixel_bits);
  std::vector<std::uint8_t> snapping(gbuffer.size());
  const auto is_asked = [&](std::size_t i, int, int) { return classes[i] == PixelClass::T; };
  decide_in_packets(gbuffer.width, gbuffer.height, is_asked, [&](std::span<const std::size_t> pixels) {
    const std::uint32_t flips = snapped.flips(pixels, reference);
    for (std::size_t k = 0; k < pixels.size(); ++k) snapping[pixels[k]] = flips >> k & 1;
  });
  return snapping;
}

std::span<const ClassInfo> class_infos() { return classes_table; }

std::array<std::size_t, 6> count_classes(std::span<const PixelClass> classes) {
  std::array<std::size_t, 6> counts{};
  for (const PixelClass c : classes) ++counts[static_cast<std::size_t>(c)];
  return counts;
}

}  // namespace gnomon
