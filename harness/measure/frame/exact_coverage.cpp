#include "measure/frame/exact_coverage.h"

#include <gnomon/kit/area/light_figure.h>
#include <gnomon/kit/geometry/exact.h>

#include <algorithm>
#include <array>

namespace gnomon {

namespace {

/// Twice the area of the smallest part of a square that is kept.
constexpr double least_square_area = 4e-13;

constexpr std::array<glm::dvec2, 4> square_corners = {glm::dvec2(0, 0), {1, 0}, {1, 1}, {0, 1}};

/// Corners of a triangle, from the eye.
std::array<glm::dvec3, 3> from_eye(const Triangle& triangle, const glm::dvec3& eye) {
  std::array<glm::dvec3, 3> corners;
  for (int k = 0; k < 3; ++k) corners[k] = glm::dvec3(triangle.points[k]) - eye;
  return corners;
}

bool has_extent(std::span<const glm::dvec2> polygon) {
  return polygon.size() >= 3 && std::abs(twice_area(polygon)) >= least_square_area;
}

/// Takes away what lies on the positive side of all lines.
void take_away(std::vector<std::vector<glm::dvec2>>& pieces, std::span<const glm::dvec3> lines) {
  std::vector<std::vector<glm::dvec2>> left, outsides;
  for (std::vector<glm::dvec2>& piece : pieces) {
    std::vector<glm::dvec2> rest = piece;
    outsides.clear();
    for (const glm::dvec3& line : lines) {
      std::vector<glm::dvec2> inside, outside;
      divide_places(
          rest, line, [&](const glm::dvec2& place) { inside.push_back(place); },
          [&](const glm::dvec2& place) { outside.push_back(place); });
      if (has_extent(outside)) outsides.push_back(std::move(outside));
      rest = std::move(inside);
      if (!has_extent(rest)) break;
    }
    // Where nothing is inside all lines the piece stays whole, whatever the first of them have cut off.
    if (!has_extent(rest))
      left.push_back(std::move(piece));
    else
      std::ranges::move(outsides, std::back_inserter(left));
  }
  pieces = std::move(left);
}

}  // namespace

/// A pixel's square and its plane, from the eye: the ray through place (s, t) is ray + s * along_x + t * along_y.
struct ExactCoverage::Square {
  Triangle triangle;
  glm::dvec3 ray, along_x, along_y;
  glm::dvec3 normal;  ///< of the receiver's plane, toward the eye
  double height;      ///< dot(normal, a point of the plane)

  glm::dvec3 ray_at(const glm::dvec2& place) const { return ray + place.x * along_x + place.y * along_y; }
  glm::dvec3 point_at(const glm::dvec2& place) const {
    const glm::dvec3 to = ray_at(place);
    return height / glm::dot(normal, to) * to;
  }
  /// The line whose positive side shows points X with dot(q, X) + d > 0.
  glm::dvec3 line_of(const glm::dvec3& q, double d) const {
    const glm::dvec3 w = -(d * normal + height * q);
    return {glm::dot(w, ray), glm::dot(w, along_x), glm::dot(w, along_y)};
  }
};

ExactCoverage::ExactCoverage(const Scene& scene, const GBuffer& gbuffer, const Light& light)
    : scene_(scene), gbuffer_(gbuffer), light_(light) {
  const glm::dvec4 l = homogeneous(light);
  l_ = l - l.w * glm::dvec4(camera_.eye, 0);
}

ExactCoverage::Square ExactCoverage::square(std::size_t i) const {
  const double x = static_cast<double>(i % gbuffer_.width), y = static_cast<double>(i / gbuffer_.width);
  Square square{.triangle = scene_.meshes[gbuffer_.mesh[i]].corners(gbuffer_.triangle[i]),
                .ray = camera_.ray(x, y),
                .along_x = camera_.ray(x + 1, y) - camera_.ray(x, y),
                .along_y = camera_.ray(x, y + 1) - camera_.ray(x, y),
                .normal = {},
                .height = 0};
  const std::array<glm::dvec3, 3> corners = from_eye(square.triangle, camera_.eye);
  square.normal = glm::normalize(glm::cross(corners[1] - corners[0], corners[2] - corners[0]));
  square.height = glm::dot(square.normal, corners[0]);
  if (square.height > 0) {
    square.normal = -square.normal;
    square.height = -square.height;
  }
  return square;
}

bool ExactCoverage::is_within(std::size_t i) const {
  if (gbuffer_.is_background(i)) return false;
  const Square pixel = square(i);
  const std::array<glm::dvec3, 3> corners = from_eye(pixel.triangle, camera_.eye);
  const double turn = glm::dot(glm::cross(corners[0], corners[1]), corners[2]);
  return std::ranges::all_of(square_corners, [&](const glm::dvec2& place) {
    const glm::dvec3 ray = pixel.ray_at(place);
    for (int k = 0; k < 3; ++k)
      if (!(turn * glm::dot(glm::cross(corners[k], corners[(k + 1) % 3]), ray) > 0)) return false;
    return in_spot_cone(light_, camera_.eye + pixel.point_at(place));
  });
}

double ExactCoverage::share(std::size_t i) const {
  const Square pixel = square(i);
  std::vector<Polygon> pieces = {Polygon(square_corners.begin(), square_corners.end())};
  const auto hide = [&](const Triangle& caster) {
    const std::array<glm::dvec3, 3> corners = from_eye(caster, camera_.eye);
    std::array<glm::dvec3, 4> lines;
    const auto set_line = [&](std::size_t k, glm::dvec3 normal, double side, const glm::dvec3& on) {
      if (side < 0) normal = -normal;
      lines[k] = pixel.line_of(normal, -glm::dot(normal, on));
      // Seen edge-on it hides nothing; nor does it where the square is on the other side of the line.
      return side != 0 && std::ranges::any_of(square_corners, [&](const auto& at) { return line_at(lines[k], at) > 0; });
    };
    for (std::size_t k = 0; k < 3; ++k) {
      const glm::dvec3 &a = corners[k], &b = corners[(k + 1) % 3], &c = corners[(k + 2) % 3];
      const glm::dvec3 normal = glm::cross(b - a, to_light(l_, a));
      if (!set_line(k, normal, glm::dot(normal, c - a), a)) return;
    }
    const glm::dvec3 normal = glm::cross(corners[1] - corners[0], corners[2] - corners[0]);
    if (!set_line(3, normal, -glm::dot(normal, to_light(l_, corners[0])), corners[0])) return;
    if (!coplanar(pixel.triangle, caster.points)) take_away(pieces, lines);
  };
  for (std::size_t m = 0; m < scene_.meshes.size(); ++m) {
    const Mesh& mesh = scene_.meshes[m];
    if (!mesh.casts) continue;
    for (std::size_t t = 0; t < mesh.triangles.size() && !pieces.empty(); ++t)
      if (m != gbuffer_.mesh[i] || t != gbuffer_.triangle[i]) hide(mesh.corners(t));
  }
  double area = 0;
  for (const Polygon& piece : pieces) area += std::abs(twice_area(piece)) / 2;
  return std::min(area, 1.0);
}

}  // namespace gnomon
