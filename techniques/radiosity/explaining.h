#pragma once
#include <gnomon/kit/area/area_rays.h>
#include <gnomon/kit/geometry/holes.h>
#include <gnomon/technique.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "layers.h"
#include "lighting.h"

namespace gnomon::radiosity {

inline constexpr OwnCause own_causes[] = {
    {"interpolated", "Light is not linear between the points where it was computed: the element is too large.", {32, 144, 255}},
    {"crossed_patch",
     "A surface touches or cuts the element: light or shadow leaks from a point on the other side.",
     {252, 0, 132}},
    {"few_rays", "Too few rays sampled the lamp at the points where light was computed.", {188, 88, 48}},
    {"hemicube_aliasing",
     "The lamp's hemicube has too few texels for the element, which got one too many or too few.",
     {20, 255, 148}},
};

/// Why a pixel's answer differs from what its own point would get.
struct Explainer {
  const Surfaces& surfaces;
  const Lighting& lighting;
  bool uses_corners, uses_hemicube;

  static constexpr int many_rays = 256;            ///< to a lamp
  static constexpr double as_good_as_none = 0.01;  ///< difference that so many rays leave open

  static double share(const Factor& factor) { return factor.whole > 0 ? factor.seen / factor.whole : 1; }

  /// One of `own_causes`, or nothing where the point itself, with many rays, would get the same.
  ///
  ///   answer - point = (answer - exact) + (exact - point)
  ///                     few_rays,           interpolated,
  ///                     hemicube_aliasing   crossed_patch
  ///
  /// `exact` is interpolated between the same points, each with as many rays as the pixel's own point. The larger term
  /// decides; it is `crossed_patch` where one of the points does not see the pixel's.
  std::string cause(const glm::dvec3& point, const Found& found, double answer) const {
    const Division& division = lighting.division();
    const Element& element = division.elements()[found.element];
    const Face& face = division.face_of(element);
    const glm::dvec3 normal = found.side ? -face.normal : face.normal;
    const Receiving here{point, normal, face.mesh, face.triangle_at(found.place), found.element};
    const double of_point = share(lamp_at(here));
    if (std::abs(answer - of_point) <= as_good_as_none) return "";

    const std::size_t count = uses_corners ? division.corner_count(element) : 1;
    const std::array weights = uses_corners ? division.weights(element, found.place) : std::array{1.0, 0.0, 0.0, 0.0};
    Factor exact;
    bool is_crossed = false;
    for (std::size_t k = 0; k < count; ++k) {
      const std::uint32_t number = uses_corners ? element.corners[k] : element.center;
      const Node& node = division.nodes()[number];
      const Receiving at{node.point, normal, face.mesh, face.triangle_at(node.place), 2ull * number + found.side};
      const Factor got = lamp_at(at);
      exact.whole += static_cast<float>(weights[k] * got.whole);
      exact.seen += static_cast<float>(weights[k] * got.seen);
      // Both ends are lifted by the same, or the element itself would lie between one near the origin and one that is not.
      const float largest = static_cast<float>(std::max(extent(point), extent(node.point)));
      const glm::dvec3 from = point + ray_offset(glm::vec3(largest)) * normal;
      is_crossed = is_crossed || is_blocked(from, node.point - point);
    }
    const double between = share(exact);
    if (std::abs(answer - between) > std::abs(between - of_point)) return uses_hemicube ? "hemicube_aliasing" : "few_rays";
    return is_crossed ? "crossed_patch" : "interpolated";
  }
  /// Whether a surface is solid between a point and another one.
  bool is_blocked(const glm::dvec3& from, const glm::dvec3& way) const {
    return std::ranges::any_of(surfaces.all->met(from, way), [&](const RayScene::Met& met) {
      return is_solid_along(surfaces.scene->meshes[met.mesh], met.triangle, from, way);
    });
  }
  /// Of the whole lamp, by many rays.
  Factor lamp_at(const Receiving& at) const {
    const std::span<const Sender> lamps = lighting.lamps();
    const Gathering gathering(*surfaces.casters, Way::contour, std::max<int>(many_rays / static_cast<int>(lamps.size()), 16));
    Factor sum;
    for (std::size_t k = 0; k < lamps.size(); ++k) {
      Factor one;
      gathering.factors(lamps[k], true, {&at, 1}, k + 1, {&one, 1});
      sum.whole += one.whole;
      sum.seen += one.seen;
    }
    return sum;
  }
};

}  // namespace gnomon::radiosity
