#include "measure/frame/classify.h"

#include <gnomon/kit/rays/gbuffer_maker.h>

#include <algorithm>

#include "measure/frame/glass_doubt.h"
#include "measure/frame/moved_rays.h"
#include "measure/frame/point_rays.h"
#include "measure/frame/ray_packets.h"

namespace gnomon {

namespace {

// Gray for what is not decided, light for what is scored, colors for what is left out.
constexpr ClassInfo classes_table[] = {
    {"B", "background", "No surface: nothing to decide.", rgb(24, 26, 30)},
    {"F", "turned away", "Faces away from the light, lies outside its cone, or does not receive: dark whatever the mask says.",
     rgb(92, 96, 104)},
    {"G", "grazing", "The light grazes the surface, at 2 degrees or less: any bias decides it.", rgb(238, 190, 50)},
    {"S", "silhouette",
     "What it shows is in doubt: 1/512 px beside its center is nothing, another mesh, or the same much nearer or farther.",
     rgb(20, 105, 210)},
    {"U", "uncertain", "The reference's answer changes within float32 rounding.", rgb(215, 55, 60)},
    {"T", "tested", "The error is what these are off by on average, the wrong rate the share of them that are wrong.",
     rgb(212, 216, 214)},
};

/// Of a square around a pixel's center.
constexpr glm::dvec2 corners[] = {{-1, -1}, {1, -1}, {-1, 1}, {1, 1}};

/// Traces again with the sample points moved, sixteen pixels at a time.
struct SnappedRays {
  const Scene& scene;
  const RayScene &everything, &casters;
  const GBuffer& gbuffer;
  const Light& light;
  double most;  ///< pixels that a vertex is moved by
  AnswerKind kind = answer_kind(scene, light);
  PointRays rays{scene, casters, light};
  Camera camera{gbuffer.view, gbuffer.width, gbuffer.height};

  /// Bit k: pixel pixels[k] has another answer at some corner.
  std::uint32_t flips(std::span<const std::size_t> pixels, std::span<const float> reference) const {
    std::uint32_t flipped = 0;
    std::array<Crossings, ray_lanes> crossings;
    std::array<SurfacePoint, ray_lanes> points;
    for (const glm::dvec2& corner : corners) {
      for (std::size_t k = 0; k < pixels.size(); ++k) {
        const double x = static_cast<double>(pixels[k] % gbuffer.width) + 0.5 + corner.x * most;
        const double y = static_cast<double>(pixels[k] / gbuffer.width) + 0.5 + corner.y * most;
        points[k] = surface_through(scene, everything, camera, gbuffer.truth, x, y);
      }
      const PointRays::Shares found = rays.ask({points.data(), pixels.size()}, crossings);
      for (std::size_t k = 0; k < pixels.size(); ++k)
        if (found.faces >> k & 1 && is_wrong(found.share[k], reference[pixels[k]], kind)) flipped |= 1u << k;
    }
    return flipped;
  }
};

}  // namespace

std::vector<std::uint8_t> find_silhouettes(const RayScene& everything, const GBuffer& gbuffer) {
  const Camera camera(gbuffer.view, gbuffer.width, gbuffer.height);
  const auto is_in_doubt = [&](std::size_t i, const glm::dvec2& center) {
    const double distance = glm::distance(glm::dvec3(gbuffer.position(i)), camera.eye);
    return std::ranges::any_of(corners, [&](const glm::dvec2& corner) {
      const glm::dvec2 at = center + snapping_grid(usual_subpixel_bits) / 2 * corner;
      const glm::dvec3 ray = camera.ray(at.x, at.y);
      const RayScene::Hit hit = everything.closest(camera.eye, ray);
      return hit.mesh != gbuffer.mesh[i] || std::abs(hit.t * glm::length(ray) - distance) > 0.02 * distance;
    });
  };
  std::vector<std::uint8_t> silhouettes(gbuffer.size());
  tbb::parallel_for(0, gbuffer.height, [&](int y) {
    for (int x = 0; x < gbuffer.width; ++x) {
      const std::size_t i = static_cast<std::size_t>(y) * gbuffer.width + x;
      if (!gbuffer.is_background(i)) silhouettes[i] = is_in_doubt(i, {x + 0.5, y + 0.5});
    }
  });
  return silhouettes;
}

bool is_resolved(const Scene& scene, const Light& light, const View& view) {
  const Bounds box = scene.bounds();
  return box.empty() || extent(glm::dvec3(box.max) - glm::dvec3(box.min)) >= 0x1p-12 * extent(scene, light, view);
}

std::vector<PixelClass> classify(const Scene& scene, const RayScene& casters, const GBuffer& gbuffer, const Light& light,
                                 std::span<const float> reference, std::span<const std::uint8_t> silhouettes) {
  const glm::dvec4 l = homogeneous(light);
  const std::span<const float> answers = reference;
  std::vector<float> by_opaque;
  if (casters.has_transmission()) {
    by_opaque.resize(gbuffer.size());
    trace_opaque_shadows(casters, scene, gbuffer, light, by_opaque);
    reference = by_opaque;
  }
  const double extent = gnomon::extent(scene, light, gbuffer.view);
  const GlassDoubt glass(scene, l, extent);
  std::optional<MovedRays> moved;
  if (is_resolved(scene, light, gbuffer.view)) moved.emplace(scene, casters, gbuffer, l, extent, reference);
  std::vector<PixelClass> classes(gbuffer.size(), PixelClass::T);
  const auto class_of = [&](std::size_t i) {
    if (gbuffer.is_background(i)) return PixelClass::B;
    if (!faces_light(scene, gbuffer, light, i)) return PixelClass::F;
    const glm::dvec3 to = to_light(l, gbuffer.position(i));
    if (glm::dot(glm::dvec3(gbuffer.normal(i)), to) < 0.035 * glm::length(to)) return PixelClass::G;
    return !silhouettes.empty() && silhouettes[i] ? PixelClass::S : PixelClass::T;
  };
  const auto needs_rays = [&](std::size_t i, int, int) { return (classes[i] = class_of(i)) == PixelClass::T; };
  decide_in_packets(gbuffer.width, gbuffer.height, needs_rays, [&](std::span<const std::size_t> pixels) {
    const std::uint32_t unstable = moved ? moved->unstable(pixels) : ~0u;
    const auto is_uncertain = [&](std::size_t k) {
      if (unstable >> k & 1) return true;
      const std::size_t i = pixels[k];
      // The ray that counts glass may pass an edge that the other one met.
      if (!is_lit(reference[i])) return answers[i] > 0;
      return glass.is_uncertain(receiver_at(scene, gbuffer, i), answers[i]);
    };
    for (std::size_t k = 0; k < pixels.size(); ++k)
      if (is_uncertain(k)) classes[pixels[k]] = PixelClass::U;
  });
  return classes;
}

std::vector<std::uint8_t> find_snapping(const Scene& scene, const RayScene& everything, const RayScene& casters,
                                        const GBuffer& gbuffer, const Light& light, std::span<const float> reference,
                                        std::span<const PixelClass> classes, int subpixel_bits) {
  const SnappedRays snapped{scene, everything, casters, gbuffer, light, snapping_grid(subpixel_bits) / 2};
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
