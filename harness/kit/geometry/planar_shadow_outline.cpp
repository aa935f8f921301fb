#include <gnomon/kit/geometry/across.h>
#include <gnomon/kit/geometry/planar_shadow.h>

#include <algorithm>
#include <cassert>

namespace gnomon {

std::vector<glm::dvec3> clipped(std::span<const glm::dvec3> polygon, const glm::dvec4& half_space) {
  std::vector<glm::dvec3> kept;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const glm::dvec3 &from = polygon[i], &to = polygon[(i + 1) % polygon.size()];
    const double here = glm::dot(half_space, glm::dvec4(from, 1)), there = glm::dot(half_space, glm::dvec4(to, 1));
    if (here >= 0) kept.push_back(from);
    if ((here > 0 && there < 0) || (here < 0 && there > 0)) kept.push_back(from + here / (here - there) * (to - from));
  }
  return kept;
}

namespace {

std::vector<glm::dvec3> corners(const FlatPart& part, int segments) {
  if (!part.is_disc()) return {part.points.begin(), part.points.begin() + part.corner_count};
  std::vector<glm::dvec3> points;
  const glm::dvec3 u = part.points[1] - part.points[0], v = part.points[2] - part.points[0];
  for (int k = 0; k < segments; ++k) {
    const double angle = 2 * std::numbers::pi * k / segments;
    points.push_back(part.points[0] + std::cos(angle) * u + std::sin(angle) * v);
  }
  return points;
}

/// A point of a caster as the light sees it: two coordinates across the axis of its view, and what rounding may add to them.
struct ProjectedPoint {
  glm::dvec2 at;
  double blur;
  glm::dvec3 point;
};

double turn(const ProjectedPoint& a, const ProjectedPoint& b, const ProjectedPoint& c) {
  const glm::dvec2 u = b.at - a.at, v = c.at - b.at;
  return u.x * v.y - u.y * v.x;
}

/// Corners of the convex hull, counter-clockwise (Andrew 1979). Of corners that are one but for rounding the first stays: the
/// edge between two of them would point anywhere.
std::vector<ProjectedPoint> hull(std::vector<ProjectedPoint> points) {
  std::ranges::sort(points, [](const ProjectedPoint& a, const ProjectedPoint& b) {
    return std::pair(a.at.x, a.at.y) < std::pair(b.at.x, b.at.y);
  });
  std::vector<ProjectedPoint> loop;
  const auto walk = [&](const auto& range) {
    const std::size_t start = loop.size();
    for (const ProjectedPoint& p : range) {
      while (loop.size() >= start + 2 && turn(loop[loop.size() - 2], loop.back(), p) <= 0) loop.pop_back();
      loop.push_back(p);
    }
    loop.pop_back();
  };
  walk(points);
  std::ranges::reverse(points);
  walk(points);
  const auto are_one = [](const ProjectedPoint& a, const ProjectedPoint& b) {
    return glm::distance(a.at, b.at) <= std::max(a.blur, b.blur);
  };
  loop.erase(std::unique(loop.begin(), loop.end(), are_one), loop.end());
  while (loop.size() > 1 && are_one(loop.front(), loop.back())) loop.pop_back();
  return loop;
}

/// Central projection from a light, parallel from infinity, along an axis: with u and v across it, the way back to the light is
/// right-handed. Every point is in front of it, at a positive share of the axis, as long as the axis leads from the light
/// through a plane that has all of the points behind it. The blur is a hundred roundings of the point's coordinates, by what
/// the projection makes of them.
ProjectedPoint projected(const glm::dvec3& point, const glm::dvec4& light, const glm::dvec3& axis) {
  const auto [u, v] = Across(-axis);
  if (light.w == 0) return {{glm::dot(u, point), glm::dot(v, point)}, 100 * 0x1p-53 * glm::length(point), point};
  const glm::dvec3 x = point - glm::dvec3(light) / light.w;
  const double scale = glm::dot(axis, x);
  const glm::dvec2 at(glm::dot(u, x) / scale, glm::dot(v, x) / scale);
  return {at, 100 * 0x1p-53 * (glm::length(point) + glm::length(x)) / scale * (1 + glm::length(at)), point};
}

/// The axis of a projection that has the points well in front of it: the mean direction where it will do. Points around the
/// foot of a light close to a part are nearly all around it, and some behind their mean; the plane of a part, or that of the
/// cone's generator nearest to the light, parts them from the light, because what is convex and not around a light has such a
/// plane.
glm::dvec3 projection_axis(const glm::dvec4& light, std::span<const glm::dvec3> points, std::span<const FlatPart> parts,
                           std::span<const ShadowTest> tests) {
  if (light.w == 0) return -glm::normalize(glm::dvec3(light));
  const glm::dvec3 origin = glm::dvec3(light) / light.w;
  std::vector<glm::dvec3> candidates(1, glm::dvec3(0));
  for (const glm::dvec3& p : points) candidates[0] += glm::normalize(p - origin);
  candidates[0] /= std::max(glm::length(candidates[0]), 1e-300);
  for (const ShadowTest& test : tests) candidates.emplace_back(test.beyond);
  if (parts.size() == 2 && parts[0].is_disc() && !parts[1].is_disc()) {
    const glm::dvec3 rise = parts[1].points[0] - parts[0].points[0], to = origin - parts[0].points[0];
    const glm::dvec3 off = to - glm::dot(to, rise) / glm::dot(rise, rise) * rise;
    candidates.push_back(-glm::normalize(glm::dot(rise, rise) * glm::normalize(off) + parts[0].radius() * rise));
  }
  const auto front = [&](const glm::dvec3& axis) {
    double least = 1;
    for (const glm::dvec3& p : points) least = std::min(least, glm::dot(axis, glm::normalize(p - origin)));
    return least;
  };
  return *std::ranges::max_element(candidates, {}, front);
}

}  // namespace

std::vector<std::vector<glm::dvec4>> PlanarShadow::outlines(int segments) const {
  assert(segments >= 3);
  std::vector<std::vector<glm::dvec4>> loops;
  if (form_ != ShadowForm::exact) {
    for (const FlatPart& part : parts()) {
      std::vector<glm::dvec4> loop;
      for (const glm::dvec3& p : corners(part, segments)) loop.emplace_back(p, 1);
      const glm::dvec3 a(loop[0]), normal = glm::cross(glm::dvec3(loop[1]) - a, glm::dvec3(loop[2]) - a);
      if (glm::dot(normal, glm::dvec3(plane_)) < 0) std::ranges::reverse(loop);
      loops.push_back(std::move(loop));
    }
    return loops;
  }
  if (!(glm::dot(plane_, light_) > 0)) return loops;  // the light is in the plane: there is no image
  // What is over the plane and below the light as the plane sees it; the rest has no image, or that of an anti-shadow.
  const glm::dvec4 below_light = glm::dvec4(0, 0, 0, glm::dot(plane_, light_)) - light_.w * plane_;
  std::vector<glm::dvec3> over;
  for (const FlatPart& part : parts()) {
    const std::vector<glm::dvec3> kept = clipped(clipped(corners(part, segments), plane_), below_light);
    over.insert(over.end(), kept.begin(), kept.end());
  }
  if (over.size() < 3) return loops;
  const glm::dvec3 axis = projection_axis(light_, over, parts(), tests());
  std::vector<ProjectedPoint> seen;
  for (const glm::dvec3& p : over) seen.push_back(projected(p, light_, axis));
  const double horizon = 0x1p-44 * glm::dot(plane_, light_);  // to this a clipped point on the light's horizon rounds
  std::vector<glm::dvec4> loop;
  for (const ProjectedPoint& corner : hull(std::move(seen))) {
    glm::dvec4 image = image_on_plane(corner.point, light_, plane_);
    if (image.w < horizon) image.w = 0;
    loop.push_back(image);
  }
  if (loop.size() >= 3) loops.push_back(std::move(loop));
  return loops;
}

}  // namespace gnomon
