#include <gnomon/error.h>
#include <gnomon/kit/geometry/across.h>
#include <gnomon/kit/geometry/shapes.h>

#include <algorithm>
#include <cassert>

namespace gnomon {

namespace {

// Everything below is computed in double and rounded once, when a point becomes a vertex.

void add_vertex(Mesh& mesh, const glm::dvec3& point) { mesh.positions.emplace_back(point); }

/// `segments` points on the circle around `center`, counter-clockwise seen from the tip of `axis` (any length but zero).
std::vector<glm::dvec3> circle(const glm::dvec3& center, const glm::dvec3& axis, double radius, int segments) {
  const auto [u, v] = Across(glm::normalize(axis));
  std::vector<glm::dvec3> points;
  for (int k = 0; k < segments; ++k) {
    const double angle = 2 * std::numbers::pi * k / segments;
    points.push_back(center + radius * (std::cos(angle) * u + std::sin(angle) * v));
  }
  return points;
}

/// Triangles from the vertex `hub` to the ring of `count` vertices that starts at `first`; `forward` keeps the ring's sense.
void add_fan(Mesh& mesh, std::uint32_t hub, std::uint32_t first, std::uint32_t count, bool forward) {
  for (std::uint32_t k = 0; k < count; ++k) {
    const std::uint32_t a = first + k, b = first + (k + 1) % count;
    mesh.triangles.push_back(forward ? glm::uvec3{hub, a, b} : glm::uvec3{hub, b, a});
  }
}

/// Rings of constant latitude about +y, each counter-clockwise seen from above, between two poles that are single vertices.
void add_triangles(const Sphere& sphere, int segments, Mesh& mesh) {
  const int band_count = std::max(2, segments / 2);
  const glm::dvec3 center(sphere.center);
  const double radius = sphere.radius;
  add_vertex(mesh, center + glm::dvec3{0, radius, 0});
  for (int i = 1; i < band_count; ++i) {
    const double polar = std::numbers::pi * i / band_count;
    for (int k = 0; k < segments; ++k) {
      const double around = 2 * std::numbers::pi * k / segments, flat = std::sin(polar);
      add_vertex(mesh, center + radius * glm::dvec3{flat * std::sin(around), std::cos(polar), flat * std::cos(around)});
    }
  }
  add_vertex(mesh, center - glm::dvec3{0, radius, 0});

  const auto n = static_cast<std::uint32_t>(segments), ring_count = static_cast<std::uint32_t>(band_count - 1);
  add_fan(mesh, 0, 1, n, true);
  for (std::uint32_t ring = 0; ring + 1 < ring_count; ++ring)
    for (std::uint32_t k = 0; k < n; ++k) {
      const std::uint32_t left = 1 + ring * n + k, right = 1 + ring * n + (k + 1) % n;
      mesh.triangles.emplace_back(left, left + n, right + n);
      mesh.triangles.emplace_back(left, right + n, right);
    }
  add_fan(mesh, 1 + ring_count * n, 1 + (ring_count - 1) * n, n, false);
}

void add_triangles(const Cone& cone, int segments, Mesh& mesh) {
  const glm::dvec3 base(cone.base), axis = glm::normalize(glm::dvec3(cone.axis));
  add_vertex(mesh, base);
  add_vertex(mesh, base + static_cast<double>(cone.height) * axis);
  for (const glm::dvec3& point : circle(base, axis, cone.radius, segments)) add_vertex(mesh, point);
  add_fan(mesh, 0, 2, static_cast<std::uint32_t>(segments), false);
  add_fan(mesh, 1, 2, static_cast<std::uint32_t>(segments), true);
}

void add_triangles(const Disc& disc, int segments, Mesh& mesh) {
  add_vertex(mesh, glm::dvec3(disc.center));
  for (const glm::dvec3& p : circle(disc.center, disc.normal, disc.radius, segments)) add_vertex(mesh, p);
  add_fan(mesh, 0, 1, static_cast<std::uint32_t>(segments), true);
}

void add_triangles(const Triangle& triangle, int, Mesh& mesh) {
  mesh.positions.assign(std::begin(triangle.points), std::end(triangle.points));
  mesh.triangles = {{0, 1, 2}};
}

void add_triangles(const Plane& plane, int, Mesh& mesh) {
  const glm::dvec3 center(plane.center), u(plane.half_u), v(plane.half_v);
  for (const glm::dvec3& corner : {center - u - v, center + u - v, center + u + v, center - u + v}) add_vertex(mesh, corner);
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
}

void add_triangles(const Box& box, int, Mesh& mesh) {
  // Bits 0, 1, 2 of a vertex's index say whether it takes x, y, z from max.
  for (int i = 0; i < 8; ++i)
    mesh.positions.emplace_back((i & 1 ? box.max : box.min).x, (i & 2 ? box.max : box.min).y, (i & 4 ? box.max : box.min).z);
  mesh.triangles = {{0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5},   // -x, +x
                    {0, 1, 5}, {0, 5, 4}, {2, 6, 7}, {2, 7, 3},   // -y, +y
                    {0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}};  // -z, +z
}

/// Checks of the single members, each of which opens its error with the member's name.
class Checker {
 public:
  Checker(const std::string& where, std::string_view kind) : where_(where), kind_(kind) {}

  void finite(std::string_view member, const glm::vec3& v) const {
    if (!std::isfinite(v.x) || !std::isfinite(v.y) || !std::isfinite(v.z)) refuse(member, v, "must be finite");
  }
  void direction(std::string_view member, const glm::vec3& v) const {
    finite(member, v);
    if (v == glm::vec3(0)) refuse(member, v, "must not be zero");
  }
  void length(std::string_view member, float value) const {
    if (!std::isfinite(value) || !(value > 0))
      throw Error("{}: {}.{} = {} must be finite and above 0 m", where_, kind_, member, value);
  }
  void area(const glm::dvec3& u, const glm::dvec3& v) const {
    if (glm::cross(u, v) == glm::dvec3(0))
      throw Error("{}: {} has no area: its sides must not be zero or parallel", where_, kind_);
  }

  void operator()(const Sphere& sphere) const {
    finite("center", sphere.center);
    length("radius", sphere.radius);
  }
  void operator()(const Cone& cone) const {
    finite("base", cone.base);
    direction("axis", cone.axis);
    length("radius", cone.radius);
    length("height", cone.height);
  }
  void operator()(const Disc& disc) const {
    finite("center", disc.center);
    direction("normal", disc.normal);
    length("radius", disc.radius);
  }
  void operator()(const Triangle& triangle) const {
    for (const glm::vec3& point : triangle.points) finite("points", point);
    const glm::dvec3 a(triangle.points[0]), b(triangle.points[1]), c(triangle.points[2]);
    area(b - a, c - a);
  }
  void operator()(const Plane& plane) const {
    finite("center", plane.center);
    direction("half_u", plane.half_u);
    direction("half_v", plane.half_v);
    area(plane.half_u, plane.half_v);
  }
  void operator()(const Box& box) const {
    finite("min", box.min);
    finite("max", box.max);
    if (!glm::all(glm::lessThan(box.min, box.max))) refuse("max", box.max, "must exceed min in x, y and z");
  }

 private:
  [[noreturn]] void refuse(std::string_view member, const glm::vec3& v, std::string_view allowed) const {
    throw Error("{}: {}.{} = [{}, {}, {}] {}", where_, kind_, member, v.x, v.y, v.z, allowed);
  }
  const std::string& where_;
  std::string_view kind_;
};

}  // namespace

void check(const Shape& shape, const std::string& where) { std::visit(Checker(where, kind_name(shape)), shape); }

Mesh tessellate(const Shape& shape, int segments, std::string name) {
  check(shape, name);
  if (segments < 3 || segments > 4096) throw Error("{}: segments = {} is outside 3 .. 4096", name, segments);
  Mesh mesh;
  mesh.name = std::move(name);
  std::visit([&](const auto& one) { add_triangles(one, segments, mesh); }, shape);
  mesh.shape = shape;
  finish(mesh);
  if (mesh.triangles.empty())
    throw Error("{}: the {} has no extent: its size must show in float32 at its distance from the origin", mesh.name,
                kind_name(shape));
  return mesh;
}

Plane ground_plane(float half_side) { return {.center = {0, 0, 0}, .half_u = {0, 0, half_side}, .half_v = {half_side, 0, 0}}; }

RectLight level_square(const glm::vec3& center, double side) {
  const auto half = static_cast<float>(side / 2);
  return {.center = center, .half_u = {half, 0, 0}, .half_v = {0, 0, half}};
}

Mesh prism(std::span<const glm::dvec3> outline, const glm::dvec3& sweep, std::string name) {
  assert(outline.size() >= 3);
  assert(glm::dot(glm::cross(outline[1] - outline[0], outline[2] - outline[0]), sweep) > 0);
  Mesh mesh;
  mesh.name = std::move(name);
  for (const glm::dvec3& point : outline) add_vertex(mesh, point);
  for (const glm::dvec3& point : outline) add_vertex(mesh, point + sweep);
  const auto n = static_cast<std::uint32_t>(outline.size());
  for (std::uint32_t k = 1; k + 1 < n; ++k) {
    mesh.triangles.emplace_back(0, k + 1, k);
    mesh.triangles.emplace_back(n, n + k, n + k + 1);
  }
  for (std::uint32_t k = 0; k < n; ++k) {
    const std::uint32_t next = (k + 1) % n;
    mesh.triangles.emplace_back(k, next, n + next);
    mesh.triangles.emplace_back(k, n + next, n + k);
  }
  finish(mesh);
  return mesh;
}

Mesh cylinder(const glm::dvec3& base, const glm::dvec3& sweep, double radius, int segments, std::string name) {
  return prism(circle(base, sweep, radius, segments), sweep, std::move(name));
}

Mesh merge(std::span<const Mesh> parts, std::string name) {
  Mesh whole;
  whole.name = std::move(name);
  for (const Mesh& part : parts) {
    if (part.alpha_mask)
      throw Error("part {} of mesh {} has an alpha mask, and merged meshes have none", part.name, whole.name);
    const auto offset = static_cast<std::uint32_t>(whole.positions.size());
    whole.positions.insert(whole.positions.end(), part.positions.begin(), part.positions.end());
    for (const glm::uvec3& triangle : part.triangles) whole.triangles.push_back(triangle + offset);
  }
  finish(whole);
  return whole;
}

Mesh painted(Mesh mesh, const glm::vec3& albedo) {
  mesh.albedo = albedo;
  return mesh;
}

}  // namespace gnomon
