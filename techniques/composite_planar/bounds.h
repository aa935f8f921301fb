#pragma once
#include <gnomon/kit/gl.h>
#include <gnomon/kit/planar_shadow.h>

#include "receivers.h"

namespace composite_planar {

/// A convex polygon of homogeneous points, w >= 0, that is clipped in place: eight corners and one more for each half-space.
class Polygon {
 public:
  std::size_t size() const { return count_; }
  const glm::dvec4& operator[](std::size_t i) const { return corners_[i]; }
  glm::dvec4& operator[](std::size_t i) { return corners_[i]; }
  void add(const glm::dvec4& corner) { corners_[count_++] = corner; }

  /// Keeps the points x with dot(half_space, x) >= 0.
  void clip(const glm::dvec4& half_space) {
    std::array<double, room> values;
    bool is_whole = true;
    for (std::size_t i = 0; i < count_; ++i) is_whole = (values[i] = glm::dot(half_space, corners_[i])) >= 0 && is_whole;
    if (is_whole) return;
    const std::array<glm::dvec4, room> from = corners_;
    const std::size_t count = std::exchange(count_, 0);
    for (std::size_t i = 0; i < count; ++i) {
      const std::size_t next = i + 1 < count ? i + 1 : 0;
      const double here = values[i], there = values[next];
      if (here >= 0) add(from[i]);
      if ((here > 0 && there < 0) || (here < 0 && there > 0)) add(from[i] + here / (here - there) * (from[next] - from[i]));
    }
    if (count_ < 3) count_ = 0;
  }

 private:
  static constexpr std::size_t room = 24;
  std::array<glm::dvec4, room> corners_;
  std::size_t count_ = 0;
};

/// A polygon around a flat part: its corners, of a disc those of an octagon.
inline Polygon around(const FlatPart& part) {
  Polygon polygon;
  for (int k = 0; k < part.corner_count; ++k) polygon.add({part.points[k], 1});
  if (!part.is_disc()) return polygon;
  // Half a side of an octagon around a circle of radius 1.
  constexpr double t = 0.41421356237309515;
  constexpr std::array<glm::dvec2, 8> octagon{{{1, t}, {t, 1}, {-t, 1}, {-1, t}, {-1, -t}, {-t, -1}, {t, -1}, {1, -t}}};
  const glm::dvec3 u = part.points[1] - part.points[0], v = part.points[2] - part.points[0];
  for (const glm::dvec2& c : octagon) polygon.add({part.points[0] + c.x * u + c.y * v, 1});
  return polygon;
}

/// A polygon on a receiver that holds the shadow of a flat part on it, in world space with w = 1; empty where there is none.
inline Polygon bound_of(const FlatPart& part, bool is_image, const glm::dvec4& light, const Receiver& receiver) {
  Polygon polygon = around(part);
  if (!is_image) {
    polygon.clip(receiver.plane);
    const double light_height = glm::dot(receiver.plane, light);
    if (light.w != 0) polygon.clip(glm::dvec4(0, 0, 0, light_height) - light.w * receiver.plane);
    for (std::size_t i = 0; i < polygon.size(); ++i) {
      const glm::dvec4 p = polygon[i];
      polygon[i] = light_height * p - glm::dot(receiver.plane, p) * light;
      polygon[i].w = std::max(polygon[i].w, 0.0);  // on the light's horizon, but for rounding
    }
  }
  for (const glm::dvec4& side : receiver.sides) polygon.clip(side);
  for (std::size_t i = 0; i < polygon.size(); ++i) polygon[i] /= polygon[i].w;
  return polygon;
}

}  // namespace composite_planar
