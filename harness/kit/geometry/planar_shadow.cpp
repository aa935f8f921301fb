#include <fmt/format.h>
#include <gnomon/kit/geometry/contour.h>
#include <gnomon/kit/geometry/planar_shadow.h>

#include <algorithm>

namespace gnomon {

namespace {

/// Flat parts of a shape, or of its image.
struct Parts {
  std::size_t count = 0;
  std::array<FlatPart, 3> all;
};

/// Angles and lengths that differ from what a form requires by less than this share do so by rounding of float32 coordinates.
constexpr double alike = 1e-5;

double height_of(const glm::dvec4& plane, const glm::dvec3& point) { return glm::dot(plane, glm::dvec4(point, 1)); }

FlatPart disc_part(const glm::dvec3& center, const glm::dvec3& normal, double radius) {
  const auto [u, v] = Across(normal);
  return {.corner_count = 0, .points = {center, center + radius * u, center + radius * v, center}};
}

FlatPart triangle_part(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c) {
  return {.corner_count = 3, .points = {a, b, c, a}};
}

// --- The formulas of the paper, in its letters ----------------------------------------------------------------------------

/// The paper puts the plane at y = 0 and the object over its origin, the foot; x_i is where the light is, along the plane.
struct PaperFrame {
  glm::dvec3 up, foot, x_i;  ///< x_i: vector along the plane from the foot to the light's foot (times w)
  double d, y_i, w;          ///< heights of the object and the light

  PaperFrame(const glm::dvec3& object, const glm::dvec4& light, const glm::dvec4& plane)
      : up(plane), d(height_of(plane, object)), y_i(glm::dot(plane, light)), w(light.w) {
    foot = object - d * up;
    x_i = glm::dvec3(light) - w * foot;
    x_i -= glm::dot(x_i, up) * up;
  }
  glm::dvec3 x_s() const { return -d * x_i / (y_i - w * d); }                            // (1), (3), (6)
  double grown(double length) const { return length * y_i / (y_i - w * d); }             // (2), (4), (5)
  glm::dvec3 x_s3(double h_p) const { return x_i * (h_p + d) / (w * (d + h_p) - y_i); }  // (9)
};

FlatPart image_of_circle(const PaperFrame& frame, double r) {
  return disc_part(frame.foot + frame.x_s(), frame.up, frame.grown(r));
}

/// The paper's formulas of a form other than exact. There must be no objection.
Parts paper_parts(const Disc& disc, const glm::dvec4& light, const glm::dvec4& plane, ShadowForm) {
  return {1, {image_of_circle({disc.center, light, plane}, disc.radius)}};
}

/// "The equations for the shadow of the sphere are given before in circle part."
Parts paper_parts(const Sphere& sphere, const glm::dvec4& light, const glm::dvec4& plane, ShadowForm) {
  return {1, {image_of_circle({sphere.center, light, plane}, sphere.radius)}};
}

/// Circle and triangle, whose base is the diameter across the light's way. As printed the triangle's base stays at x = 0.
Parts paper_parts(const Cone& cone, const glm::dvec4& light, const glm::dvec4& plane, ShadowForm form) {
  const PaperFrame frame(cone.base, light, plane);
  const FlatPart circle = image_of_circle(frame, cone.radius);
  const double r_1 = frame.grown(cone.radius);
  if (glm::length(frame.x_i) == 0)
    return {1, {circle}};  // "if the light source is just above the cone, shadow consists just of circle"
  const glm::dvec3 z = r_1 * glm::normalize(glm::cross(frame.up, frame.x_i));
  const glm::dvec3 base = frame.foot + (form == ShadowForm::paper ? frame.x_s() : glm::dvec3(0));
  return {2, {circle, triangle_part(base + z, base - z, frame.foot + frame.x_s3(cone.height))}};
}

/// An upright isosceles triangle: its base is parallel to the plane, the peak over the base's middle.
struct Upright {
  glm::dvec3 middle, half_base;
  double height;
};

std::optional<Upright> upright(const Triangle& triangle, const glm::dvec4& plane) {
  for (int k = 0; k < 3; ++k) {
    const glm::dvec3 a(triangle.points[k]), b(triangle.points[(k + 1) % 3]), peak(triangle.points[(k + 2) % 3]);
    const glm::dvec3 middle = (a + b) / 2.0, up(plane), rise = peak - middle;
    const double height = glm::dot(rise, up), size = std::max(glm::distance(a, b), glm::length(rise));
    if (std::abs(glm::dot(b - a, up)) <= alike * size && glm::length(rise - height * up) <= alike * size && height > 0)
      return Upright{middle, (b - a) / 2.0, height};
  }
  return std::nullopt;
}

Parts paper_parts(const Triangle& triangle, const glm::dvec4& light, const glm::dvec4& plane, ShadowForm form) {
  if (form == ShadowForm::paper) {
    const auto image = [&](int k) {
      const glm::dvec4 at = image_on_plane(triangle.points[k], light, plane);
      return glm::dvec3(at) / at.w;
    };
    return {1, {triangle_part(image(0), image(1), image(2))}};
  }
  // With the base along X the ends are x_s -+ a_1 / 2; with it along Z they are printed at x = 0. So what x_s has along the
  // base stays, and what it has across is lost.
  const Upright it = *upright(triangle, plane);
  const PaperFrame frame(it.middle, light, plane);
  const glm::dvec3 along = glm::normalize(it.half_base), half = frame.grown(glm::length(it.half_base)) * along;
  const glm::dvec3 base = frame.foot + glm::dot(frame.x_s(), along) * along;
  return {1, {triangle_part(base - half, base + half, frame.foot + frame.x_s3(it.height))}};
}

Parts paper_parts(const auto&, const glm::dvec4&, const glm::dvec4&, ShadowForm) { return {}; }

/// What of the paper's requirements the shape or its place breaks. The paper has formulas for four shapes.
std::string paper_objection(const Shape& shape, const glm::dvec4& plane, ShadowForm form) {
  const auto leans = [&](const glm::vec3& axis) {
    return glm::length(glm::cross(glm::normalize(glm::dvec3(axis)), glm::dvec3(plane))) > alike;
  };
  if (const auto* disc = std::get_if<Disc>(&shape); disc && leans(disc->normal)) return "the disc is not parallel to the plane";
  if (const auto* cone = std::get_if<Cone>(&shape))
    if (leans(cone->axis) || glm::dot(glm::dvec3(cone->axis), glm::dvec3(plane)) < 0) return "the cone does not stand upright";
  if (const auto* triangle = std::get_if<Triangle>(&shape))
    if (form == ShadowForm::printed && !upright(*triangle, plane)) return "the triangle is not isosceles and upright";
  if (std::holds_alternative<Plane>(shape) || std::holds_alternative<Box>(shape))
    return fmt::format("there is no formula for a {}", kind_name(shape));
  return "";
}

// --- What the light sees of a shape, as flat parts -------------------------------------------------------------------------

/// The disc that the circle of tangents bounds: a point behind it in the cone of tangents, and not in the ball, is behind the
/// ball.
Parts exact_parts(const Sphere& sphere, const glm::dvec4& light) {
  const TangencyCircle circle = tangency_circle(sphere, light);
  return {1, {disc_part(circle.center, circle.axis, circle.radius)}};
}

Parts exact_parts(const Disc& disc, const glm::dvec4&) {
  return {1, {disc_part(disc.center, glm::normalize(glm::dvec3(disc.normal)), disc.radius)}};
}

/// The base, and the triangle of the peak and the two points of the base's rim where tangents from its image touch: together
/// the hull of base and peak.
Parts exact_parts(const Cone& cone, const glm::dvec4& light) {
  const ConeOutline outline(cone, light);
  const FlatPart base = disc_part(outline.base, outline.axis, outline.radius);
  if (outline.is_circle) return {1, {base}};
  const glm::dvec3 from = outline.rim(outline.side - outline.half), to = outline.rim(outline.side + outline.half);
  return {2, {base, triangle_part(outline.peak(), from, to)}};
}

Parts exact_parts(const Triangle& triangle, const glm::dvec4&) {
  return {1, {triangle_part(triangle.points[0], triangle.points[1], triangle.points[2])}};
}

Parts exact_parts(const Plane& plane, const glm::dvec4&) {
  const glm::dvec3 c(plane.center), u(plane.half_u), v(plane.half_v);
  // The corners as the tessellation rounds them: flat shapes are their triangles.
  const auto corner = [](const glm::dvec3& p) { return glm::dvec3(glm::vec3(p)); };
  return {1, {FlatPart{4, {corner(c - u - v), corner(c + u - v), corner(c + u + v), corner(c - u + v)}}}};
}

/// The sides that face the light.
Parts exact_parts(const Box& box, const glm::dvec4& light) {
  const glm::dvec3 low = box.min, high = box.max, l(light);
  Parts parts;
  for (int k = 0; k < 3; ++k) {
    const bool is_above = l[k] > light.w * high[k];
    if (!is_above && !(l[k] < light.w * low[k])) continue;
    const int i = (k + 1) % 3, j = (k + 2) % 3;
    FlatPart& part = parts.all[parts.count++];
    part.corner_count = 4;
    for (int corner = 0; corner < 4; ++corner) {
      part.points[corner][k] = (is_above ? high : low)[k];
      part.points[corner][i] = (corner == 1 || corner == 2 ? high : low)[i];
      part.points[corner][j] = (corner >= 2 ? high : low)[j];
    }
  }
  return parts;
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
  const auto* plane = std::get_if<Plane>(&shape);
  const FlatPart part = (plane ? exact_parts(*plane, {}) : exact_parts(std::get<Triangle>(shape), {})).all[0];
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
  for (const glm::dvec3& p : part.points) scale = std::max(scale, extent(p));
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
  const auto parts_of = [&](const auto& s) { return is_image ? paper_parts(s, light, plane, form) : exact_parts(s, light); };
  const Parts parts = std::visit(parts_of, shape);
  for (std::size_t i = 0; i < parts.count; ++i) add(parts.all[i], is_image);
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
