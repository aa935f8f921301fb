#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "planar_shadow_paper.h"

namespace gnomon {

namespace {

// --- What the light sees of a shape, as flat parts -------------------------------------------------------------------------

/// The disc that the circle of tangents bounds: a point behind it in the cone of tangents, and not in the ball, is behind the
/// ball.
std::size_t exact_parts(const Sphere& sphere, const glm::dvec4& light, Parts& parts) {
  const TangencyCircle circle = tangency_circle(sphere, light);
  parts[0] = disc_part(circle.center, circle.axis, circle.radius);
  return 1;
}

std::size_t exact_parts(const Disc& disc, const glm::dvec4&, Parts& parts) {
  parts[0] = disc_part(disc.center, glm::normalize(glm::dvec3(disc.normal)), disc.radius);
  return 1;
}

/// The base, and the triangle of the peak and the two points of the base's rim where tangents from its image touch: together
/// the hull of base and peak.
std::size_t exact_parts(const Cone& cone, const glm::dvec4& light, Parts& parts) {
  const ConeOutline outline(cone, light);
  parts[0] = disc_part(outline.base, outline.axis, outline.radius);
  if (outline.is_circle) return 1;
  parts[1] = triangle_part(outline.peak(), outline.rim(outline.side - outline.half), outline.rim(outline.side + outline.half));
  return 2;
}

std::size_t exact_parts(const Triangle& triangle, const glm::dvec4&, Parts& parts) {
  parts[0] = triangle_part(triangle.points[0], triangle.points[1], triangle.points[2]);
  return 1;
}

std::size_t exact_parts(const Plane& plane, const glm::dvec4&, Parts& parts) {
  const glm::dvec3 c(plane.center), u(plane.half_u), v(plane.half_v);
  // The corners as the tessellation rounds them: flat shapes are their triangles.
  const auto corner = [](const glm::dvec3& p) { return glm::dvec3(glm::vec3(p)); };
  parts[0] = {.corner_count = 4, .points = {corner(c - u - v), corner(c + u - v), corner(c + u + v), corner(c - u + v)}};
  return 1;
}

/// The sides that face the light.
std::size_t exact_parts(const Box& box, const glm::dvec4& light, Parts& parts) {
  const glm::dvec3 low = box.min, high = box.max, l(light);
  std::size_t count = 0;
  for (int k = 0; k < 3; ++k) {
    const bool is_above = l[k] > light.w * high[k];
    if (!is_above && !(l[k] < light.w * low[k])) continue;
    const int i = (k + 1) % 3, j = (k + 2) % 3;
    FlatPart& part = parts[count++];
    part.corner_count = 4;
    for (int corner = 0; corner < 4; ++corner) {
      part.points[corner][k] = (is_above ? high : low)[k];
      part.points[corner][i] = (corner == 1 || corner == 2 ? high : low)[i];
      part.points[corner][j] = (corner >= 2 ? high : low)[j];
    }
  }
  return count;
}

// --- Objections ------------------------------------------------------------------------------------------------------------

double size_of(const Shape& shape) {
  const auto length = [](const glm::vec3& v) { return glm::length(glm::dvec3(v)); };
  if (const auto* sphere = std::get_if<Sphere>(&shape)) return sphere->radius;
  if (const auto* disc = std::get_if<Disc>(&shape)) return disc->radius;
  if (const auto* cone = std::get_if<Cone>(&shape)) return std::max(cone->radius, cone->height);
  if (const auto* plane = std::get_if<Plane>(&shape)) return std::max(length(plane->half_u), length(plane->half_v));
  if (const auto* box = std::get_if<Box>(&shape)) return length(box->max - box->min);
  const auto& points = std::get<Triangle>(shape).points;
  return std::max(length(points[1] - points[0]), length(points[2] - points[0]));
}

/// Whether a finite light is in a solid or within a millionth of its size of its surface; edge-on to a flat shape is allowed,
/// on it is not.
bool touches(const Shape& shape, const glm::dvec3& light) {
  const double slack = 1e-6 * size_of(shape);
  if (const auto* sphere = std::get_if<Sphere>(&shape))
    return glm::distance(light, glm::dvec3(sphere->center)) <= double(sphere->radius) + slack;
  if (const auto* disc = std::get_if<Disc>(&shape)) {
    const glm::dvec3 x = light - glm::dvec3(disc->center);
    return std::abs(glm::dot(x, glm::normalize(glm::dvec3(disc->normal)))) <= slack && glm::length(x) <= disc->radius + slack;
  }
  if (const auto* cone = std::get_if<Cone>(&shape)) {
    const auto [along, off] = ConePlace(*cone, light);
    return along >= -slack && along <= cone->height + slack && off <= slack;
  }
  if (const auto* box = std::get_if<Box>(&shape))
    return glm::all(glm::greaterThanEqual(light, glm::dvec3(box->min) - slack)) &&
           glm::all(glm::lessThanEqual(light, glm::dvec3(box->max) + slack));
  std::array<FlatPart, 3> parts;
  if (const auto* plane = std::get_if<Plane>(&shape))
    exact_parts(*plane, {}, parts);
  else
    exact_parts(std::get<Triangle>(shape), {}, parts);
  const FlatPart& part = parts[0];
  const glm::dvec3 normal = glm::normalize(glm::cross(part.points[1] - part.points[0], part.points[2] - part.points[0]));
  if (std::abs(glm::dot(normal, light - part.points[0])) > slack) return false;
  for (int k = 0; k < part.corner_count; ++k) {
    const glm::dvec3 edge = glm::normalize(part.points[(k + 1) % part.corner_count] - part.points[k]);
    if (glm::dot(glm::cross(normal, edge), light - part.points[k]) < -slack) return false;
  }
  return true;
}

/// Height of the highest point of a part over a plane.
double top_of(const FlatPart& part, const glm::dvec4& plane) {
  const glm::dvec3 up(plane);
  double top = height_of(plane, part.points[0]);
  if (part.is_disc())
    return top + std::hypot(glm::dot(up, part.points[1] - part.points[0]), glm::dot(up, part.points[2] - part.points[0]));
  for (int k = 1; k < part.corner_count; ++k) top = std::max(top, height_of(plane, part.points[k]));
  return top;
}

/// Largest coordinate of the part, and the plane's distance from the origin: the scale of float32 rounding.
double scale_of(const FlatPart& part, const glm::dvec4& plane) {
  double scale = std::abs(plane.w);
  for (const glm::dvec3& p : part.points) scale = std::max({scale, std::abs(p.x), std::abs(p.y), std::abs(p.z)});
  return scale;
}

}  // namespace

bool ShadowTest::contains(const glm::dvec3& point) const {
  const glm::dvec4 x(point - anchor, 1);
  if (!(glm::dot(beyond, x) > 0)) return false;
  const double a = glm::dot(rows[0], x), b = glm::dot(rows[1], x), c = glm::dot(rows[2], x);
  if (is_disc) return a * a + b * b <= c * c && c > 0;
  return a >= 0 && b >= 0 && c >= 0 && glm::dot(rows[3], x) >= 0;
}

std::string PlanarShadow::objection(const Shape& shape, const glm::dvec4& light, const glm::dvec4& plane, ShadowForm form) {
  if (light.w != 0 && touches(shape, glm::dvec3(light) / light.w))
    return fmt::format("the light is in or on the {}", kind_name(shape));
  if (form == ShadowForm::exact) return "";
  const auto [low, high] = heights_over(shape, plane);
  const double slack = alike * size_of(shape);
  if (high <= slack) return "";  // casts nothing
  if (std::string why = paper_objection(shape, plane, form); !why.empty()) return why;
  if (low < -slack) return fmt::format("the {} crosses the plane", kind_name(shape));
  if (light.w * high >= glm::dot(plane, light)) return fmt::format("the light is not above the {}", kind_name(shape));
  return "";
}

PlanarShadow::PlanarShadow(const Shape& shape, const glm::dvec4& light, const glm::dvec4& plane, ShadowForm form)
    : light_(light), plane_(plane), form_(form) {
  const bool is_image = form != ShadowForm::exact;
  if (is_image && heights_over(shape, plane).second <= alike * size_of(shape)) return;
  Parts parts;
  const std::size_t count = is_image ? image_parts(shape, light, plane, form, parts)
                                     : std::visit([&](const auto& s) { return exact_parts(s, light, parts); }, shape);
  for (std::size_t i = 0; i < count; ++i) add(parts[i], is_image);
}

/// Through the light at l (homogeneous, l_w) the point x sees the disc's plane at the share h / (h - l_w n.x), h = n.l, of the
/// way from the light, everything from the disc's center; there it is at (x h - (n.x) l) / (h - l_w n.x). So u.x h - (n.x)
/// (u.l) and the same with v must stay within the radius times h - l_w n.x. All is divided by the length of l, so that no row
/// is large where the light is nearly edge-on. A polygon's planes go through light and edge and are turned by its winding, not
/// by where its middle lies: one that is edge-on but for rounding then has planes that face each other, and its shadow is a
/// sliver, never a half plane.
void PlanarShadow::add(const FlatPart& part, bool is_image) {
  if (!is_image && top_of(part, plane_) <= 0x1p-20 * scale_of(part, plane_)) return;
  ShadowTest test;
  test.is_disc = part.is_disc();
  glm::dvec3 middle = part.points[0];
  if (!test.is_disc) {
    middle = glm::dvec3(0);
    for (int k = 0; k < part.corner_count; ++k) middle += part.points[k] / double(part.corner_count);
  }
  test.anchor = glm::dvec3(glm::vec3(middle));
  const glm::dvec3 a = part.points[1] - part.points[0], b = part.points[2] - part.points[0];
  const glm::dvec3 to_light = glm::dvec3(light_) - light_.w * part.points[0];
  // The normal about which the corners run counter-clockwise, and then the one toward the light.
  const glm::dvec3 n_corners = glm::cross(a, b);
  const double area = glm::length(n_corners), facing = glm::dot(n_corners, is_image ? glm::dvec3(plane_) : to_light);
  if (area == 0 || facing == 0) return;  // nothing, or edge-on
  const double turn = facing > 0 ? 1 : -1;
  const glm::dvec3 n = turn / area * n_corners;
  const auto anchored = [&](const glm::dvec3& row, const glm::dvec3& from, double offset) {
    return glm::dvec4(row, offset - glm::dot(row, from - test.anchor));
  };
  if (!is_image) test.beyond = anchored(-n, part.points[0], 0);
  if (test.is_disc) {
    const double radius = part.radius(), distance = glm::length(to_light), sine = glm::dot(n, to_light) / distance;
    const auto row = [&](const glm::dvec3& rim) {
      const glm::dvec3 u = rim / radius;
      return anchored((is_image ? u : u * sine - n * (glm::dot(u, to_light) / distance)) / radius, part.points[0], 0);
    };
    test.rows[0] = row(a);
    test.rows[1] = row(b);
    test.rows[2] = is_image ? glm::dvec4(0, 0, 0, 1) : anchored(-light_.w / distance * n, part.points[0], sine);
  } else {
    test.rows.fill({0, 0, 0, 1});
    for (int k = 0; k < part.corner_count; ++k) {
      const glm::dvec3 &from = part.points[k], edge = part.points[(k + 1) % part.corner_count] - from;
      const glm::dvec3 side =
          turn * (is_image ? glm::cross(glm::dvec3(plane_), edge) : glm::cross(glm::dvec3(light_) - light_.w * from, edge));
      const double length = glm::length(side);
      if (length == 0) return;  // edge-on, along this edge
      test.rows[k] = anchored(side / length, from, 0);
    }
  }
  parts_[count_] = part;
  tests_[count_++] = test;
}

bool PlanarShadow::contains(const glm::dvec3& point) const {
  return std::ranges::any_of(tests(), [&](const ShadowTest& test) { return test.contains(point); });
}

}  // namespace gnomon
