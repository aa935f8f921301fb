#include "volume.h"

#include <gnomon/kit/area/light_shape.h>

#include <algorithm>
#include <numbers>

namespace gnomon::area_svbsp {

namespace {

/// The least sine between the edges of three points that determine a plane: rounding of double then turns it by less than 1e-9.
constexpr double least_sine = 1e-7;

/// The plane at a point along two ways.
std::optional<ClipPlane> plane_along(const glm::dvec3& at, const glm::dvec3& u, const glm::dvec3& v) {
  const glm::dvec3 across = glm::cross(u, v);
  const double length = glm::length(across);
  if (!(length > least_sine * glm::length(u) * glm::length(v))) return std::nullopt;
  const glm::dvec3 normal = across / length;
  return ClipPlane{normal, -glm::dot(normal, at)};
}

/// The twelve corners (0, +-1, +-phi), turned through the axes; edges of length 2. The inscribed sphere of that has the radius
/// phi^2 / sqrt(3).
void set_icosahedron(LightBody& body, const glm::dvec3& center, double radius) {
  constexpr double phi = std::numbers::phi;
  const double scale = radius * std::numbers::sqrt3 / (phi * phi) * (1 + 1e-12);
  std::vector<glm::dvec3> unit;
  for (int axis = 0; axis < 3; ++axis)
    for (const double one : {-1.0, 1.0})
      for (const double far : {-phi, phi}) {
        glm::dvec3& corner = unit.emplace_back(0);
        corner[(axis + 1) % 3] = one;
        corner[(axis + 2) % 3] = far;
      }
  for (std::uint32_t i = 0; i < unit.size(); ++i) {
    body.corners.push_back({center + scale * unit[i]});
    for (std::uint32_t k = 0; k < i; ++k)
      if (glm::distance(unit[i], unit[k]) < 2.1) body.edges.push_back({k, i});
  }
}

}  // namespace

void LightBody::set_corners(std::span<const Corner> polygon) {
  corners.assign(polygon.begin(), polygon.end());
  edges.clear();
  for (std::uint32_t i = 0; i < polygon.size(); ++i) edges.push_back({i, static_cast<std::uint32_t>((i + 1) % polygon.size())});
}

LightBody body_of(const Light& light) {
  const LightShape shape(light);
  LightBody body;
  body.is_flat = shape.is_flat();
  body.is_one_sided = shape.is_one_sided;
  if (!body.is_flat) {
    set_icosahedron(body, shape.center, shape.radius);
    return body;
  }
  std::vector<Corner> polygon;
  for (const glm::dvec3& corner : shape.corners(8)) polygon.push_back({corner});
  body.set_corners(polygon);
  if (const double length = glm::length(shape.across); length > 0) {
    body.plane.normal = shape.across / length;
    body.plane.offset = -glm::dot(body.plane.normal, shape.center);
  }
  return body;
}

std::array<LightBody, 2> halves(const LightBody& body) {
  glm::dvec3 longest(0), middle(0);
  for (const auto& [a, b] : body.edges)
    if (const glm::dvec3 edge = body.corners[b].at - body.corners[a].at; glm::dot(edge, edge) > glm::dot(longest, longest))
      longest = edge;
  for (const Corner& corner : body.corners) middle += corner.at / static_cast<double>(body.corners.size());
  Clipper clipper;
  clipper.start(body.corners);
  const glm::dvec3 along = glm::normalize(longest);
  clipper.keep_positive({along, -glm::dot(along, middle)}, 0);
  std::array<LightBody, 2> parts{body, body};
  parts[0].set_corners(clipper.cut_off());
  parts[1].set_corners(clipper.corners());
  return parts;
}

Relation relation(std::span<const ClipPlane> planes, std::span<const Corner> polygon, double epsilon, int& crossing) {
  crossing = 0;
  for (const ClipPlane& plane : planes) {
    const Values values = values_of(polygon, plane);
    if (values.high <= epsilon) return Relation::outside;
    crossing += values.low < -epsilon;
  }
  return crossing > 0 ? Relation::across : Relation::inside;
}

Lies lies_of(const LightBody& light, const ClipPlane& plane, double epsilon) {
  const auto [low, high] = values_of(light.corners, plane);
  return static_cast<Lies>(static_cast<unsigned>(low < -epsilon) | static_cast<unsigned>(high > epsilon) << 1);
}

std::optional<ClipPlane> plane_of(std::span<const Corner> polygon) {
  const glm::dvec3& first = polygon[0].at;
  // The diagonals of a quadrilateral determine its plane better than two edges.
  if (polygon.size() == 4) return plane_along(first, polygon[2].at - first, polygon[3].at - polygon[1].at);
  return plane_along(first, polygon[1].at - first, polygon[2].at - first);
}

std::optional<ClipPlane> PlaneMaker::plane_through(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c) const {
  const glm::dvec3 u = b - a, v = c - a;
  return glm::length(u) > least_edge_ && glm::length(v) > least_edge_ ? plane_along(a, u, v) : std::nullopt;
}

bool PlaneMaker::turn(ClipPlane& plane, std::span<const Corner> polygon, int light_sign) const {
  const double slack = 0.01 * epsilon_;
  const Values of_polygon = values_of(polygon, plane), of_light = values_of(light_.corners, plane);
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
    has_all &= std::ranges::any_of(light_.corners, [&](const Corner& corner) {
      std::optional<ClipPlane> plane = plane_through(a, b, corner.at);
      if (!plane || !turn(*plane, polygon, light_sign)) return false;
      planes.push_back(*plane);
      return true;
    });
  }
  return has_all;
}

void PlaneMaker::add_all(std::span<const Corner> polygon, int light_sign, std::vector<ClipPlane>& planes) const {
  const auto first = static_cast<std::ptrdiff_t>(planes.size());
  add_of_edges(polygon, light_sign, planes);
  for (const auto& [from, to] : light_.edges)
    for (const Corner& corner : polygon) {
      std::optional<ClipPlane> plane = plane_through(light_.corners[from].at, light_.corners[to].at, corner.at);
      if (!plane || !turn(*plane, polygon, light_sign)) continue;
      // Where an edge of the light is along one of the polygon the same plane may be there already.
      const bool is_known = std::any_of(planes.begin() + first, planes.end(), [&](const ClipPlane& other) {
        return glm::dot(other.normal, plane->normal) > 1 - 1e-14 && std::abs(other.offset - plane->offset) <= epsilon_;
      });
      if (!is_known) planes.push_back(*plane);
      break;
    }
}

}  // namespace gnomon::area_svbsp
