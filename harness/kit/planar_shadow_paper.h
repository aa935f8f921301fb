#pragma once
// Private to kit/planar_shadow: flat parts, and the formulas of the paper, in its letters, in any frame.
#include <fmt/format.h>
#include <gnomon/kit/contour.h>
#include <gnomon/kit/planar_shadow.h>

#include <cmath>
#include <optional>

namespace gnomon {

using Parts = std::array<FlatPart, 3>;

/// Angles and lengths that differ from what a form wants by less than this share do so by rounding of float32 coordinates.
inline constexpr double alike = 1e-5;

inline double height_of(const glm::dvec4& plane, const glm::dvec3& point) { return glm::dot(plane, glm::dvec4(point, 1)); }

inline FlatPart disc_part(const glm::dvec3& center, const glm::dvec3& normal, double radius) {
  const auto [u, v] = Across(normal);
  return {.corner_count = 0, .points = {center, center + radius * u, center + radius * v, center}};
}

inline FlatPart triangle_part(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c) {
  return {.corner_count = 3, .points = {a, b, c, a}};
}

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

inline std::size_t image_of_circle(const glm::dvec3& center, double r, const glm::dvec4& light, const glm::dvec4& plane,
                                   Parts& parts) {
  const PaperFrame frame(center, light, plane);
  parts[0] = disc_part(frame.foot + frame.x_s(), frame.up, frame.grown(r));
  return 1;
}

inline std::size_t paper_parts(const Disc& disc, const glm::dvec4& light, const glm::dvec4& plane, ShadowForm, Parts& parts) {
  return image_of_circle(disc.center, disc.radius, light, plane, parts);
}

/// "The equations for the shadow of the sphere are given before in circle part."
inline std::size_t paper_parts(const Sphere& sphere, const glm::dvec4& light, const glm::dvec4& plane, ShadowForm,
                               Parts& parts) {
  return image_of_circle(sphere.center, sphere.radius, light, plane, parts);
}

/// Circle and triangle, whose base is the diameter across the light's way. As printed the triangle's base stays at x = 0.
inline std::size_t paper_parts(const Cone& cone, const glm::dvec4& light, const glm::dvec4& plane, ShadowForm form,
                               Parts& parts) {
  image_of_circle(cone.base, cone.radius, light, plane, parts);
  const PaperFrame frame(cone.base, light, plane);
  const double r_1 = frame.grown(cone.radius);
  if (glm::length(frame.x_i) == 0) return 1;  // "if the light source is just above the cone, shadow consists just of circle"
  const glm::dvec3 z = r_1 * glm::normalize(glm::cross(frame.up, frame.x_i));
  const glm::dvec3 base = frame.foot + (form == ShadowForm::paper ? frame.x_s() : glm::dvec3(0));
  parts[1] = triangle_part(base + z, base - z, frame.foot + frame.x_s3(cone.height));
  return 2;
}

/// An upright isosceles triangle: its base is parallel to the plane, the peak over the base's middle.
struct Upright {
  glm::dvec3 middle, half_base;
  double height;
};

inline std::optional<Upright> upright(const Triangle& triangle, const glm::dvec4& plane) {
  for (int k = 0; k < 3; ++k) {
    const glm::dvec3 a(triangle.points[k]), b(triangle.points[(k + 1) % 3]), peak(triangle.points[(k + 2) % 3]);
    const glm::dvec3 middle = (a + b) / 2.0, up(plane), rise = peak - middle;
    const double height = glm::dot(rise, up), size = std::max(glm::distance(a, b), glm::length(rise));
    if (std::abs(glm::dot(b - a, up)) <= alike * size && glm::length(rise - height * up) <= alike * size && height > 0)
      return Upright{middle, (b - a) / 2.0, height};
  }
  return std::nullopt;
}

inline std::size_t paper_parts(const Triangle& triangle, const glm::dvec4& light, const glm::dvec4& plane, ShadowForm form,
                               Parts& parts) {
  if (form == ShadowForm::paper) {
    std::array<glm::dvec3, 3> images;
    for (int k = 0; k < 3; ++k) {
      const glm::dvec4 image = image_on_plane(triangle.points[k], light, plane);
      images[k] = glm::dvec3(image) / image.w;
    }
    parts[0] = triangle_part(images[0], images[1], images[2]);
    return 1;
  }
  // With the base along X the ends are x_s -+ a_1 / 2; with it along Z they are printed at x = 0. So what x_s has along the
  // base stays, and what it has across is lost.
  const Upright it = *upright(triangle, plane);
  const PaperFrame frame(it.middle, light, plane);
  const glm::dvec3 along = glm::normalize(it.half_base), half = frame.grown(glm::length(it.half_base)) * along;
  const glm::dvec3 base = frame.foot + glm::dot(frame.x_s(), along) * along;
  parts[0] = triangle_part(base - half, base + half, frame.foot + frame.x_s3(it.height));
  return 1;
}

std::size_t paper_parts(const auto&, const glm::dvec4&, const glm::dvec4&, ShadowForm, Parts&) { return 0; }

/// The paper's formulas of a form other than exact, in `parts`; says how many. There must be no objection.
inline std::size_t image_parts(const Shape& shape, const glm::dvec4& light, const glm::dvec4& plane, ShadowForm form,
                               Parts& parts) {
  return std::visit([&](const auto& s) { return paper_parts(s, light, plane, form, parts); }, shape);
}

/// What the paper asks of the shape and its place; it knows four shapes.
inline std::string paper_objection(const Shape& shape, const glm::dvec4& plane, ShadowForm form) {
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

}  // namespace gnomon
