#include "wedges.h"

#include <gnomon/kit/area/light_shape.h>
#include <gnomon/kit/geometry/across.h>
#include <gnomon/kit/parallel.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace gnomon::penumbra_wedge {

namespace {

/// The directions in which something is seen in a plane, as angles.
struct Angles {
  double least = INFINITY, most = -INFINITY;
  bool is_around = false;  ///< it touches the place that it is seen from

  /// A disc around (x, y), as seen from the origin; angles are at most pi from `near`.
  void add(double x, double y, double radius, double near) {
    const double distance = std::hypot(x, y);
    if (!(distance > radius * (1 + 0x1p-40))) {
      is_around = true;
      return;
    }
    const double angle = near + std::remainder(std::atan2(y, x) - near, 2 * std::numbers::pi),
                 wide = radius > 0 ? std::asin(std::min(radius / distance, 1.0)) : 0;
    least = std::min(least, angle - wide);
    most = std::max(most, angle + wide);
  }
  /// Some plane through the origin leaves all of it on one side, by more than rounding.
  bool has_planes() const { return !is_around && most - least < std::numbers::pi - 0x1p-20; }
};

/// Makes the planes of one wedge: any plane with the edge on its inner side or in it, and the light on the outer side or in it,
/// holds all points that see the edge before the light on its inner side.
class Maker {
 public:
  Maker(const LightHull& light, double scene_extent) : light_(light), extent_(scene_extent) {}

  void make(const glm::dvec3& a, const glm::dvec3& b, glm::dvec4 (&planes)[4]) const {
    const double length = glm::length(b - a);
    const glm::dvec3 along = (b - a) / length, to_center = light_.center - a;
    add_tangents(a, along, to_center, planes);
    // The plane of the edge and the light's center: x runs along the edge, y to the center.
    glm::dvec3 up = to_center - glm::dot(to_center, along) * along;
    const double height = glm::length(up);
    if (!(height > 0x1p-40 * (glm::length(to_center) + extent(a)))) return;
    up /= height;
    add_end(a, along, up, planes[2]);
    add_end(b, -along, up, planes[3]);
  }

 private:
  void add_tangents(const glm::dvec3& a, const glm::dvec3& along, const glm::dvec3& to_center, glm::dvec4 (&planes)[4]) const {
    const Across across(along);
    const double radius = wide_radius(a);
    const double near = std::atan2(glm::dot(to_center, across.v), glm::dot(to_center, across.u));
    Angles angles;
    for (const glm::dvec3& corner : light_.corners)
      angles.add(glm::dot(corner - a, across.u), glm::dot(corner - a, across.v), radius, near);
    if (!angles.has_planes()) return;
    planes[0] = plane_at(a, std::sin(angles.most) * across.u - std::cos(angles.most) * across.v);
    planes[1] = plane_at(a, -std::sin(angles.least) * across.u + std::cos(angles.least) * across.v);
  }
  /// Through an end, across the plane of x and y; the edge runs along x.
  void add_end(const glm::dvec3& end, const glm::dvec3& x, const glm::dvec3& y, glm::dvec4& plane) const {
    const double radius = wide_radius(end);
    Angles angles;
    for (const glm::dvec3& corner : light_.corners)
      angles.add(glm::dot(corner - end, x), glm::dot(corner - end, y), radius, std::numbers::pi / 2);
    // The edge itself is at the angle 0.
    if (!angles.has_planes() || angles.least < 0 || angles.least > std::numbers::pi) return;
    plane = plane_at(end, -std::sin(angles.least) * x + std::cos(angles.least) * y);
  }
  /// The light's, and what coordinates may be rounded by.
  double wide_radius(const glm::dvec3& place) const {
    return light_.radius + 0x1p-48 * (extent(light_.center) + extent(place));
  }
  /// The light is where the normal points.
  glm::dvec4 plane_at(const glm::dvec3& place, const glm::dvec3& normal) const {
    // The normal errs by some 2^-50, over the way from the place to any point.
    const double slack = 0x1p-40 * (extent_ + extent(place));
    const glm::dvec4 plane(normal, -glm::dot(normal, place) - slack);
    return std::isfinite(glm::dot(plane, plane)) ? plane : glm::dvec4(0);
  }

  const LightHull& light_;
  double extent_;  // of the scene
};

}  // namespace

LightHull hull_of(const Light& light) {
  const LightShape shape(light);
  LightHull hull{.corners = {shape.center}, .center = shape.center, .box = {}};
  if (shape.is_flat())
    hull.corners = shape.corners(16);
  else
    hull.radius = shape.radius;
  glm::dvec3 low = hull.center, high = hull.center;
  for (const glm::dvec3& corner : hull.corners) {
    low = glm::min(low, corner);
    high = glm::max(high, corner);
  }
  const double more = hull.radius + 0x1p-21 * (extent(hull.center) + extent(high - low) + hull.radius);
  hull.box.add(glm::vec3(low - more));
  hull.box.add(glm::vec3(high + more));
  return hull;
}

void Wedges::make(const EdgeAdjacency& adjacency, const Silhouette& silhouette, const LightHull& light, double scene_extent) {
  std::vector<Bounds> boxes(silhouette.edges.size());
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    boxes[i].add(adjacency.positions()[silhouette.edges[i].low]);
    boxes[i].add(adjacency.positions()[silhouette.edges[i].high]);
  }
  tree_ = BoxTree(boxes);
  wedges_.assign(boxes.size(), {});
  const Maker maker(light, scene_extent);
  for_blocks(wedges_.size(), 1024, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const SilhouetteEdge& edge = silhouette.edges[tree_.order()[i]];
      wedges_[i] = {.low = edge.low, .high = edge.high, .count = edge.count, .part = edge.part, .planes = {}};
      maker.make(adjacency.positions()[edge.low], adjacency.positions()[edge.high], wedges_[i].planes);
    }
  });
}

void Wedges::find(const Beam& beam, const Bounds& points, std::vector<std::uint32_t>& found) const {
  found.clear();
  const glm::dvec3 half = 0.5 * (glm::dvec3(points.max) - glm::dvec3(points.min)), middle = glm::dvec3(points.min) + half;
  tree_.each([&](const float* low, const float* high) { return beam.meets(low, high); },
             [&](std::uint32_t place) {
               if (wedges_[place].meets(middle, half)) found.push_back(place);
               return false;
             });
}

void Wedges::narrow(const Bounds& points, std::span<const std::uint32_t> wide, std::vector<std::uint32_t>& found) const {
  found.clear();
  const glm::dvec3 half = 0.5 * (glm::dvec3(points.max) - glm::dvec3(points.min)), middle = glm::dvec3(points.min) + half;
  for (const std::uint32_t place : wide)
    if (wedges_[place].meets(middle, half)) found.push_back(place);
}

}  // namespace gnomon::penumbra_wedge
