#include "light_body.h"

#include <gnomon/kit/geometry/across.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace gnomon::area_svbsp {

namespace {

constexpr int disc_corners = 8;

/// The twelve corners (0, +-1, +-phi), turned through the axes; edges of length 2. The inscribed sphere of that has the radius
/// phi^2 / sqrt(3).
void set_icosahedron(LightBody& body, const glm::dvec3& center, double radius) {
  constexpr double phi = std::numbers::phi;
  const double scale = radius * std::numbers::sqrt3 / (phi * phi) * (1 + 1e-12);
  std::vector<glm::dvec3> unit;
  for (int axis = 0; axis < 3; ++axis)
    for (const double one : {-1.0, 1.0})
      for (const double far : {-phi, phi}) {
        glm::dvec3 corner(0);
        corner[(axis + 1) % 3] = one;
        corner[(axis + 2) % 3] = far;
        unit.push_back(corner);
      }
  for (std::uint32_t i = 0; i < unit.size(); ++i) {
    body.corners.push_back(center + scale * unit[i]);
    for (std::uint32_t k = 0; k < i; ++k)
      if (glm::distance(unit[i], unit[k]) < 2.1) body.edges.push_back({k, i});
  }
}

}  // namespace

void LightBody::set_corners(std::span<const Corner> polygon) {
  corners.clear();
  edges.clear();
  for (std::uint32_t i = 0; i < polygon.size(); ++i) {
    corners.push_back(polygon[i].at);
    edges.push_back({i, static_cast<std::uint32_t>((i + 1) % polygon.size())});
  }
}

LightBody body_of(const Light& light) {
  LightBody body;
  glm::dvec3 center, half_u, half_v;
  std::vector<Corner> polygon;
  if (const auto* rect = std::get_if<RectLight>(&light.kind)) {
    center = rect->center;
    half_u = rect->half_u;
    half_v = rect->half_v;
    body.is_one_sided = rect->emits == Emits::in_front;
    for (const glm::dvec2& place : {glm::dvec2(-1, -1), glm::dvec2(1, -1), glm::dvec2(1, 1), glm::dvec2(-1, 1)})
      polygon.push_back({center + place.x * half_u + place.y * half_v});
  } else if (const auto* disc = std::get_if<DiscLight>(&light.kind)) {
    center = disc->center;
    const Across across(glm::normalize(glm::dvec3(disc->normal)));
    half_u = across.u;
    half_v = across.v;
    if (glm::dot(glm::cross(half_u, half_v), glm::dvec3(disc->normal)) < 0) half_v = -half_v;
    body.is_one_sided = disc->emits == Emits::in_front;
    const double radius = disc->radius / std::cos(std::numbers::pi / disc_corners) * (1 + 1e-12);
    for (int k = 0; k < disc_corners; ++k) {
      const double angle = 2 * std::numbers::pi * k / disc_corners;
      polygon.push_back({center + radius * (std::cos(angle) * half_u + std::sin(angle) * half_v)});
    }
  } else {
    const auto& sphere = std::get<SphereLight>(light.kind);
    set_icosahedron(body, sphere.center, sphere.radius);
    return body;
  }
  body.is_flat = true;
  body.set_corners(polygon);
  const glm::dvec3 normal = glm::cross(half_u, half_v);
  if (const double length = glm::length(normal); length > 0) {
    body.plane.normal = normal / length;
    body.plane.offset = -glm::dot(body.plane.normal, center);
  }
  return body;
}

std::array<LightBody, 2> halves(const LightBody& body) {
  glm::dvec3 longest(0), middle(0);
  for (const auto& [a, b] : body.edges)
    if (const glm::dvec3 edge = body.corners[b] - body.corners[a]; glm::dot(edge, edge) > glm::dot(longest, longest))
      longest = edge;
  for (const glm::dvec3& corner : body.corners) middle += corner / static_cast<double>(body.corners.size());
  Clipper clipper;
  clipper.start();
  for (const glm::dvec3& corner : body.corners) clipper.add({corner});
  const glm::dvec3 along = glm::normalize(longest);
  clipper.keep_positive({along, -glm::dot(along, middle)}, 0);
  std::array<LightBody, 2> parts{body, body};
  parts[0].set_corners(clipper.cut_off());
  parts[1].set_corners(clipper.corners());
  return parts;
}

}  // namespace gnomon::area_svbsp
