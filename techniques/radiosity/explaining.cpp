#include "explaining.h"

#include <gnomon/kit/area/area_rays.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace gnomon::radiosity {

namespace {

constexpr int many_rays = 256;            ///< to a lamp
constexpr double as_good_as_none = 0.01;  ///< difference that so many rays leave open

double share(const Factor& factor) { return factor.whole > 0 ? factor.seen / factor.whole : 1; }

}  // namespace

Factor Explainer::lamp_at(const Receiving& at) const {
  const Gathering gathering(*surfaces_.casters, Way::contour,
                            std::max<int>(many_rays / static_cast<int>(lighting_.lamps().size()), 16));
  Factor sum;
  for (std::size_t k = 0; k < lighting_.lamps().size(); ++k) {
    Factor one;
    gathering.factors(lighting_.lamps()[k], true, {&at, 1}, k + 1, {&one, 1});
    sum.whole += one.whole;
    sum.seen += one.seen;
  }
  return sum;
}

std::string Explainer::cause(const glm::dvec3& point, const Found& found, double answer) const {
  const Division& division = lighting_.division();
  const Element& element = division.elements()[found.element];
  const Face& face = division.face_of(element);
  const glm::dvec3 normal = found.side ? -face.normal : face.normal;
  const Receiving here{point, normal, face.mesh, face.triangle_at(found.place), found.element};
  const double of_point = share(lamp_at(here));
  if (std::abs(answer - of_point) <= as_good_as_none) return "";

  std::array<std::uint32_t, 4> nodes = element.corners;
  std::array<double, 4> weights = division.weights(element, found.place);
  std::size_t count = division.corner_count(element);
  if (!uses_corners_) nodes[0] = element.center, weights[0] = 1, count = 1;
  Factor exact;
  bool is_crossed = false;
  for (std::size_t k = 0; k < count; ++k) {
    const Node& node = division.nodes()[nodes[k]];
    const Receiving at{node.point, normal, face.mesh, face.triangle_at(node.place), 2ull * nodes[k] + found.side};
    const Factor got = lamp_at(at);
    exact.whole += static_cast<float>(weights[k] * got.whole);
    exact.seen += static_cast<float>(weights[k] * got.seen);
    // Both ends are lifted by the same, or the element itself would lie between one near the origin and one that is not.
    const float largest = static_cast<float>(std::max(extent(point), extent(node.point)));
    const glm::dvec3 from = point + ray_offset(glm::vec3(largest)) * normal;
    is_crossed = is_crossed || !surfaces_.all->met(from, node.point - point).empty();
  }
  const double between = share(exact);
  if (std::abs(answer - between) > std::abs(between - of_point)) return uses_hemicube_ ? "hemicube_aliasing" : "few_rays";
  return is_crossed ? "crossed_patch" : "interpolated";
}

}  // namespace gnomon::radiosity
