#include "volume.h"

#include <algorithm>
#include <cmath>

namespace gnomon::area_svbsp {

namespace {

/// The least sine between the edges of three points that tell a plane: rounding of double then turns it by less than 1e-9.
constexpr double least_sine = 1e-7;

struct Values {
  double low = INFINITY, high = -INFINITY;
  void add(double value) {
    low = std::min(low, value);
    high = std::max(high, value);
  }
};

Values values_of(std::span<const Corner> polygon, const ClipPlane& plane) {
  Values values;
  for (const Corner& corner : polygon) values.add(plane.at(corner.at));
  return values;
}

Values values_of(const LightBody& light, const ClipPlane& plane) {
  Values values;
  for (const glm::dvec3& corner : light.corners) values.add(plane.at(corner));
  return values;
}

}  // namespace

Relation relation(std::span<const ClipPlane> planes, std::span<const Corner> polygon, double epsilon, int& crossing) {
  crossing = 0;
  for (const ClipPlane& plane : planes) {
    double low = INFINITY, high = -INFINITY;
    for (const Corner& corner : polygon) {
      const double value = plane.at(corner.at);
      low = std::min(low, value);
      high = std::max(high, value);
    }
    if (high <= epsilon) return Relation::outside;
    crossing += low < -epsilon;
  }
  return crossing > 0 ? Relation::across : Relation::inside;
}

Lies lies_of(const LightBody& light, const ClipPlane& plane, double epsilon) {
  const Values values = values_of(light, plane);
  return static_cast<Lies>(static_cast<unsigned>(values.low < -epsilon) | static_cast<unsigned>(values.high > epsilon) << 1);
}

std::optional<ClipPlane> plane_of(std::span<const Corner> polygon) {
  // Of a quadrilateral the diagonals tell more than two edges do.
  const glm::dvec3 u = polygon.size() == 4 ? polygon[2].at - polygon[0].at : polygon[1].at - polygon[0].at,
                   v = polygon.size() == 4 ? polygon[3].at - polygon[1].at : polygon[2].at - polygon[0].at;
  const glm::dvec3 normal = glm::cross(u, v);
  const double length = glm::length(normal);
  if (!(length > least_sine * glm::length(u) * glm::length(v))) return std::nullopt;
  ClipPlane plane{normal / length, 0};
  plane.offset = -glm::dot(plane.normal, polygon[0].at);
  return plane;
}

std::optional<ClipPlane> PlaneMaker::plane_through(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c) const {
  const glm::dvec3 u = b - a, v = c - a, normal = glm::cross(u, v);
  const double length = glm::length(normal), u_length = glm::length(u), v_length = glm::length(v);
  if (!(u_length > least_edge_) || !(v_length > least_edge_) || !(length > least_sine * u_length * v_length))
    return std::nullopt;
  ClipPlane plane{normal / length, 0};
  plane.offset = -glm::dot(plane.normal, a);
  return plane;
}

bool PlaneMaker::turn(ClipPlane& plane, std::span<const Corner> polygon, int light_sign) const {
  const double slack = 0.01 * epsilon_;
  const Values of_polygon = values_of(polygon, plane), of_light = values_of(light_, plane);
  const bool polygon_is_positive = of_polygon.low >= -slack, polygon_is_negative = of_polygon.high <= slack;
  const bool light_is_positive = of_light.low >= -slack, light_is_negative = of_light.high <= slack;
  if (polygon_is_positive && polygon_is_negative && light_is_positive && light_is_negative) return false;
  if (polygon_is_positive && (light_sign > 0 ? light_is_positive : light_is_negative)) return true;
  plane = -plane;
  return polygon_is_negative && (light_sign > 0 ? light_is_negative : light_is_positive);
}

bool PlaneMaker::add_of_edges(std::span<const Corner> polygon, int light_sign, std::vector<ClipPlane>& planes) const {
  bool has_all = true;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const glm::dvec3 &a = polygon[i].at, &b = polygon[(i + 1) % polygon.size()].at;
    const bool is_found = std::ranges::any_of(light_.corners, [&](const glm::dvec3& corner) {
      std::optional<ClipPlane> plane = plane_through(a, b, corner);
      if (!plane || !turn(*plane, polygon, light_sign)) return false;
      planes.push_back(*plane);
      return true;
    });
    has_all &= is_found;
  }
  return has_all;
}

void PlaneMaker::add_of_light_edges(std::span<const Corner> polygon, int light_sign, std::size_t first,
                                    std::vector<ClipPlane>& planes) const {
  for (const auto& [from, to] : light_.edges)
    for (const Corner& corner : polygon) {
      std::optional<ClipPlane> plane = plane_through(light_.corners[from], light_.corners[to], corner.at);
      if (!plane || !turn(*plane, polygon, light_sign)) continue;
      // Where an edge of the light is along one of the polygon the same plane may be there already.
      const bool is_known =
          std::any_of(planes.begin() + static_cast<std::ptrdiff_t>(first), planes.end(), [&](const auto& other) {
            return glm::dot(other.normal, plane->normal) > 1 - 1e-14 && std::abs(other.offset - plane->offset) <= epsilon_;
          });
      if (!is_known) planes.push_back(*plane);
      break;
    }
}

void PlaneMaker::add_penumbra(std::span<const Corner> polygon, std::vector<ClipPlane>& planes) const {
  const std::size_t first = planes.size();
  add_of_edges(polygon, -1, planes);
  add_of_light_edges(polygon, -1, first, planes);
}

bool PlaneMaker::add_umbra(std::span<const Corner> polygon, std::vector<ClipPlane>& planes) const {
  return add_of_edges(polygon, 1, planes);
}

void PlaneMaker::add_shaft(std::span<const Corner> polygon, std::vector<ClipPlane>& planes) const {
  const std::size_t first = planes.size();
  add_of_edges(polygon, 1, planes);
  add_of_light_edges(polygon, 1, first, planes);
}

}  // namespace gnomon::area_svbsp
