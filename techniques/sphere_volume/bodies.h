#pragma once
#include <gnomon/kit/bytes.h>
#include <gnomon/kit/geometry/contour.h>

#include <algorithm>
#include <array>
#include <numbers>

namespace sphere_volume {
using namespace gnomon;

/// What replaces a circle of the outline: a polygon inside, of equal area, around it; `exact` decides at the pixel's point.
enum Fit { inscribed, equal_area, circumscribed, exact };

/// A point of a polygon that replaces a circle of radius 1: at `angle`, `radius` from the center.
struct Corner {
  double angle, radius;
};

/// Factor on the radius of a regular polygon of `count` sides.
inline double radius_factor(Fit fit, int count) {
  const double step = 2 * std::numbers::pi / count;
  return fit == inscribed ? 1 : fit == equal_area ? std::sqrt(step / std::sin(step)) : 1 / std::cos(step / 2);
}

/// The corners of a regular polygon.
inline std::vector<Corner> full_circle(Fit fit, int count) {
  std::vector<Corner> corners;
  const double radius = radius_factor(fit, count);
  for (int k = 0; k < count; ++k) corners.push_back({2 * std::numbers::pi * k / count, radius});
  return corners;
}

/// An arc of a circle that `count` sides go around (fewer here, none longer). Both ends stay on the circle, so that tangents
/// meet it there. The polygon around it touches the arc at its ends and between corners; for equal area the same corners are
/// drawn in to the radius k that makes the fan from the center as large as the sector:
///   (n - 1) k^2 sin s + 2 k sin(s / 2) = n s,  s the step, n the number of inner corners.
inline std::vector<Corner> arc(Fit fit, double from, double to, int count) {
  const int n = std::max(1, static_cast<int>(std::ceil(count * std::abs(to - from) / (2 * std::numbers::pi) - 1e-9)));
  const double step = (to - from) / n, s = std::abs(step), half = std::sin(s / 2);
  std::vector<Corner> corners{{from, 1}};
  if (fit == inscribed) {
    for (int k = 1; k < n; ++k) corners.push_back({from + k * step, 1});
  } else if (s > 0) {
    const double radius =
        fit == equal_area ? n * s / (half + std::sqrt(half * half + (n - 1) * n * s * std::sin(s))) : 1 / std::cos(s / 2);
    for (int k = 0; k < n; ++k) corners.push_back({from + (k + 0.5) * step, radius});
  }
  corners.push_back({to, 1});
  return corners;
}

/// Outline of a convex body as the light sees it, in double. Points are counter-clockwise seen from the light.
struct Contour {
  std::vector<glm::dvec3> points;
  std::vector<glm::dvec3> away;  ///< where light that passes each point goes on; of a directional light all the same
  glm::dvec3 hub{0};             ///< of the light cap: a point inside the body
};

inline void add_away(Contour& contour, const glm::dvec4& light) {
  for (const glm::dvec3& p : contour.points) contour.away.push_back(light.w * p - glm::dvec3(light));
}

inline Contour contour_of(const Sphere& sphere, const glm::dvec4& light, Fit fit, int segments) {
  const TangencyCircle circle = tangency_circle(sphere, light);
  Contour contour{.points = {}, .away = {}, .hub = circle.center};
  for (const Corner& c : full_circle(fit, segments)) {
    contour.points.push_back(circle.point(-c.angle, c.radius));
    const glm::dvec3 tangent = circle.cos_alpha * circle.axis + c.radius * circle.sin_alpha * circle.arm(-c.angle);
    contour.away.push_back(light.w == 0 ? -glm::dvec3(light) : tangent);
  }
  return contour;
}

inline Contour contour_of(const Cone& cone, const glm::dvec4& light, Fit fit, int segments) {
  const ConeOutline outline(cone, light);
  Contour contour{.points = {}, .away = {}, .hub = outline.base + outline.height / 4 * outline.axis};
  if (outline.is_circle) {
    for (const Corner& c : full_circle(fit, segments))
      contour.points.push_back(outline.rim(outline.base_faces ? -c.angle : c.angle, c.radius));
  } else {
    // With the base lit, the lit part ends at the far arc, else at the near one.
    const double from = outline.side - outline.half, to = outline.side + outline.half;
    contour.points.push_back(outline.peak());
    for (const Corner& c : arc(fit, from, outline.base_faces ? to - 2 * std::numbers::pi : to, segments))
      contour.points.push_back(outline.rim(c.angle, c.radius));
  }
  add_away(contour, light);
  return contour;
}

inline Contour contour_of(const Disc& disc, const glm::dvec4& light, Fit fit, int segments) {
  const glm::dvec3 normal = glm::normalize(glm::dvec3(disc.normal)), center = disc.center;
  const double height = glm::dot(normal, to_light(light, center)), radius = disc.radius;
  const Across frame(normal);
  Contour contour{.points = {}, .away = {}, .hub = center};
  if (height == 0) return contour;
  for (const Corner& c : full_circle(fit, segments)) {
    const double angle = height < 0 ? -c.angle : c.angle;
    contour.points.push_back(center + radius * c.radius * (std::cos(angle) * frame.u + std::sin(angle) * frame.v));
  }
  add_away(contour, light);
  return contour;
}

Contour contour_of(const auto&, const glm::dvec4&, Fit, int) { return {}; }

/// The light must not be inside the sphere, nor inside the cone or on its lateral surface. Of a disc that the light sees
/// edge-on, and of flat shapes, the contour is empty: the disc casts nothing, and flat shapes cast by their triangles.
inline Contour contour_of(const Shape& shape, const glm::dvec4& light, Fit fit, int segments) {
  return std::visit([&](const auto& one) { return contour_of(one, light, fit, segments); }, shape);
}

/// A casting mesh with a curved shape.
struct Body {
  std::uint32_t mesh;
  Shape shape;
};

/// Radius of a ball about the middle that holds the body.
inline double reach(const Shape& shape) {
  if (const auto* sphere = std::get_if<Sphere>(&shape)) return sphere->radius;
  if (const auto* disc = std::get_if<Disc>(&shape)) return disc->radius;
  const auto& cone = std::get<Cone>(shape);
  return std::max(std::hypot(cone.radius, cone.height / 4.0), 0.75 * cone.height);
}

/// A point inside the body.
inline glm::dvec3 middle(const Shape& shape) {
  if (const auto* sphere = std::get_if<Sphere>(&shape)) return sphere->center;
  if (const auto* disc = std::get_if<Disc>(&shape)) return disc->center;
  const auto& cone = std::get<Cone>(shape);
  return glm::dvec3(cone.base) + cone.height / 4.0 * glm::normalize(glm::dvec3(cone.axis));
}

/// Whether `point` lies on a cone or disc, to a millionth of their size: no outline is seen from there.
inline bool is_on_surface(const Shape& shape, const glm::dvec3& point) {
  if (const auto* cone = std::get_if<Cone>(&shape)) {
    const double height = cone->height, slack = 1e-6 * std::max<double>(height, cone->radius);
    const auto [along, off] = ConePlace(*cone, point);
    return along > -slack && along < height + slack && off < slack && (along < slack || off > -slack);
  }
  if (const auto* disc = std::get_if<Disc>(&shape)) {
    const glm::dvec3 x = point - glm::dvec3(disc->center), normal = glm::normalize(glm::dvec3(disc->normal));
    const double slack = 1e-6 * disc->radius;
    return std::abs(glm::dot(x, normal)) < slack && glm::length(x) < disc->radius + slack;
  }
  return false;
}

/// How far the outlines of polygons may be off at `point`, meters across the light's ray: the largest over the bodies whose
/// shadow the point is in or beside.
inline double outline_error(std::span<const Body> bodies, const glm::dvec4& light, const glm::dvec3& point, Fit fit,
                            int segments) {
  const double outward = radius_factor(fit, segments) - 1;
  const double inward = 1 - radius_factor(fit, segments) * std::cos(std::numbers::pi / segments);
  const double share = std::max(outward, inward);
  const glm::dvec3 to = to_light(light, point), direction = glm::normalize(to);
  double error = 0;
  for (const Body& body : bodies) {
    const glm::dvec3 center = middle(body.shape), off = center - point;
    const double along = glm::dot(off, direction), aside = glm::length(off - along * direction), ball = reach(body.shape);
    if (along < -ball || aside > (1 + share) * ball * (1 + 1e-9)) continue;
    const double left = light.w != 0 ? glm::length(to_light(light, center)) : 1, whole = light.w != 0 ? glm::length(to) : 1;
    if (left > 0) error = std::max(error, share * ball * whole / left);
  }
  return error;
}

/// How much wider than the body a bounding volume is: the rasterizer may lose what is thinner than 1/256 pixel.
inline constexpr double bounding_margin = 0.02;

/// Sides around an outline that only has to find pixels.
inline constexpr int bounding_segments = 8;

/// Under a directional light: the contour, wider, on a plane before the body.
inline void widen_across(Contour& contour, const glm::dvec3& center, const glm::dvec3& axis, double nearest) {
  const double along = glm::dot(center, axis), start = nearest - bounding_margin * (along - nearest);
  const auto place = [&](const glm::dvec3& p, double grow) {
    const glm::dvec3 off = p - center;
    return center + (off - glm::dot(off, axis) * axis) * grow + (start - along) * axis;
  };
  for (glm::dvec3& p : contour.points) p = place(p, 1 + bounding_margin);
  contour.hub = place(center, 1);
}

/// Under a light at a finite point: wider in angle, away from the axis, also where that leads backward; and the points on a
/// plane before the body.
inline void widen_angle(Contour& contour, const glm::dvec3& light, const glm::dvec3& axis, double nearest) {
  bool has_plane = true;
  for (glm::dvec3& away : contour.away) {
    away = glm::normalize(away);
    const double along = glm::dot(away, axis);
    const glm::dvec3 across = away - along * axis;
    away = along > 0 ? along * axis + (1 + bounding_margin) * across : (1 + bounding_margin) * along * axis + across;
    has_plane = has_plane && along > 0.05;
  }
  const double start = has_plane ? std::max(0.0, (1 - bounding_margin) * (nearest - glm::dot(light, axis))) : 0;
  for (std::size_t i = 0; i < contour.points.size(); ++i)
    contour.points[i] = light + contour.away[i] * (start > 0 ? start / glm::dot(contour.away[i], axis) : 0);
  contour.hub = light + start * axis;
}

/// Outline of a volume that holds the body's shadow volume with a margin: from a plane before the body (from the light itself
/// where it is too near for one), around the body.
inline Contour bounding_contour(const Shape& shape, const glm::dvec4& light) {
  Contour contour = contour_of(shape, light, circumscribed, bounding_segments);
  if (contour.points.empty()) return contour;
  const glm::dvec3 center = middle(shape), axis = glm::normalize(light.w * center - glm::dvec3(light));
  const double nearest = heights_over(shape, glm::dvec4(axis, 0)).first;
  if (light.w == 0)
    widen_across(contour, center, axis, nearest);
  else
    widen_angle(contour, glm::dvec3(light), axis, nearest);
  return contour;
}

/// Triangles of one draw, all of one body.
struct DrawRange {
  std::uint32_t first = 0, count = 0;  ///< indices
  std::uint32_t own_mesh = 0;          ///< the body's mesh plus one
};

/// Faces of the shadow volumes of bodies as homogeneous triangles, made anew for each light.
struct Volumes {
  std::vector<glm::vec4> vertices;
  std::vector<std::uint32_t> body_of;                 ///< of each vertex
  std::array<std::vector<std::uint32_t>, 3> indices;  ///< by VolumeFace
  std::array<std::vector<DrawRange>, 3> ranges;       ///< into `indices`; in the order of the bodies

  /// The volume of the body with number `body`, of mesh `mesh`.
  void add(const Contour& contour, const glm::dvec4& light, std::uint32_t body, std::uint32_t mesh) {
    const auto n = static_cast<std::uint32_t>(contour.points.size()), first = static_cast<std::uint32_t>(vertices.size());
    for (const glm::dvec3& p : contour.points) vertices.emplace_back(glm::dvec4(p, 1));
    // All light of a directional light goes on to one point.
    const bool one_end = light.w == 0;
    for (std::uint32_t i = 0; i < (one_end ? std::min(n, 1u) : n); ++i) vertices.emplace_back(glm::dvec4(contour.away[i], 0));
    const auto hub = static_cast<std::uint32_t>(vertices.size());
    if (n) vertices.emplace_back(glm::dvec4(contour.hub, 1));
    body_of.resize(vertices.size(), body);

    const auto size = [&](int face) { return static_cast<std::uint32_t>(indices[face].size()); };
    const std::array<std::uint32_t, 3> start{size(0), size(1), size(2)};
    auto& [sides, light_cap, dark_cap] = indices;
    for (std::uint32_t i = 0; i < n; ++i) {
      const std::uint32_t next = (i + 1) % n, a = first + i, b = first + next;
      if (one_end) {
        sides.insert(sides.end(), {b, a, first + n});
      } else {
        sides.insert(sides.end(), {b, a, a + n, b, a + n, b + n});
        if (i > 0 && next > 0) dark_cap.insert(dark_cap.end(), {first + n, b + n, a + n});
      }
      light_cap.insert(light_cap.end(), {hub, a, b});
    }
    for (int f = 0; f < 3; ++f) ranges[f].push_back({start[f], size(f) - start[f], mesh + 1});
  }
  std::size_t side_triangle_count() const { return indices[0].size() / 3; }
  std::size_t triangle_count() const { return (indices[0].size() + indices[1].size() + indices[2].size()) / 3; }
  std::size_t bytes() const {
    std::size_t sum = bytes_of(vertices, body_of);
    for (int f = 0; f < 3; ++f) sum += bytes_of(indices[f], ranges[f]);
    return sum;
  }
};

}  // namespace sphere_volume
