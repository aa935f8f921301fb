#pragma once
#include <gnomon/kit/area/light_shape.h>

#include <algorithm>
#include <span>
#include <vector>

namespace gnomon {

/// What a light with area turns to one point, if nothing is between: a flat figure, or what the point's horizon leaves of it.
/// The figure of a sphere is the disc within the circle where tangents from the point touch: it covers the same directions.
///
/// A place of the figure has two coordinates in -1 .. 1: it lies at center + s * half_u + t * half_v. A rectangle holds all of
/// them, a disc those with s * s + t * t <= 1. Vectors are in meters from the point, in double.
class LightFigure {
 public:
  /// `normal` is the surface's, unit, on the side that is queried.
  LightFigure(const LightShape& shape, const glm::dvec3& point, const glm::dvec3& normal);
  LightFigure(const Light& light, const glm::dvec3& point, const glm::dvec3& normal)
      : LightFigure(LightShape(light), point, normal) {}

  /// Whether the point sees any of it: some of the figure is above the horizon, the point is not in the figure's plane nor
  /// behind a one-sided light, and not inside a sphere.
  bool is_seen() const { return is_seen_; }
  /// Sine of the height over the horizon of its highest place; to 0.1 % on discs.
  double highest() const;

  bool is_disc() const { return is_disc_; }
  const glm::dvec3& center() const { return center_; }
  const glm::dvec3& half_u() const { return half_u_; }
  const glm::dvec3& half_v() const { return half_v_; }
  const glm::dvec3& normal() const { return normal_; }  ///< of the surface, as given
  glm::dvec3 at(const glm::dvec2& place) const { return center_ + place.x * half_u_ + place.y * half_v_; }
  /// Above the horizon is where horizon.x + horizon.y * s + horizon.z * t > 0: the height of a place in meters.
  const glm::dvec3& horizon() const { return horizon_; }

  /// The smallest box of places that holds what is seen: at least half of a rectangle's box is seen, and of a disc's more than
  /// 0.65.
  struct Box {
    glm::dvec2 low{-1}, high{1};
    void add(const glm::dvec2& place) {
      low = glm::min(low, place);
      high = glm::max(high, place);
    }
    /// The place of the box at a place of the unit square.
    glm::dvec2 at(const glm::dvec2& square) const { return low + square * (high - low); }
  };
  const Box& box() const { return box_; }
  bool holds(const glm::dvec2& place) const {
    return (!is_disc_ || glm::dot(place, place) <= 1) && horizon_.x + horizon_.y * place.x + horizon_.z * place.y > 0;
  }

  /// Irradiance at radiance 1 of all that is above the horizon, without casters: Lambert's integral along its outline, in
  /// closed form. 0 where nothing is seen.
  double irradiance() const;

  /// Irradiance that the figure at radiance 1 gives the point from the places around `to`, by coordinates: cosine at both
  /// ends, inverse square, times half_u x half_v. The integral over the places above the horizon is all of it.
  double weight(const glm::dvec3& to) const {
    const double square = glm::dot(to, to);
    return glm::dot(normal_, to) * std::abs(glm::dot(axis_, to)) / (square * square);
  }

 private:
  double of_rectangle(bool is_cut) const;

  glm::dvec3 center_{0}, half_u_{0}, half_v_{0};
  glm::dvec3 normal_, axis_{0};  ///< axis: half_u x half_v, across the figure
  glm::dvec3 horizon_{0};
  Box box_;
  bool is_disc_ = false, is_seen_ = false;
};

/// The part of a convex polygon of places where line.x + line.y * s + line.z * t > 0; what lies on the line belongs to it.
void clip_places(std::vector<glm::dvec2>& polygon, const glm::dvec3& line);

/// A linear function of a place, such as LightFigure::horizon.
inline double line_at(const glm::dvec3& line, const glm::dvec2& place) { return line.x + line.y * place.x + line.z * place.y; }

/// Divides a convex polygon of places by a line: calls inside(place) and outside(place) with the corners of the two parts, in
/// order. The point where an edge crosses is computed from its inner end, so that both parts get the same one.
template <class Inside, class Outside>
void divide_places(std::span<const glm::dvec2> polygon, const glm::dvec3& line, const Inside& inside, const Outside& outside) {
  double at_here = line_at(line, polygon[0]);
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const glm::dvec2 &here = polygon[i], &next = polygon[i + 1 < polygon.size() ? i + 1 : 0];
    const double at_next = line_at(line, next);
    if (at_here >= 0) inside(here);
    if (at_here <= 0) outside(here);
    if ((at_here > 0 && at_next < 0) || (at_here < 0 && at_next > 0)) {
      const bool starts_inside = at_here > 0;
      const glm::dvec2 &in = starts_inside ? here : next, &out = starts_inside ? next : here;
      const double at_in = std::max(at_here, at_next), at_out = std::min(at_here, at_next);
      const glm::dvec2 crossing = in + at_in / (at_in - at_out) * (out - in);
      inside(crossing);
      outside(crossing);
    }
    at_here = at_next;
  }
}

/// Twice the area of a convex polygon of places, as it is wound.
inline double twice_area(std::span<const glm::dvec2> polygon) {
  double sum = 0;
  for (std::size_t i = 2; i < polygon.size(); ++i) {
    const glm::dvec2 a = polygon[i - 1] - polygon[0], b = polygon[i] - polygon[0];
    sum += a.x * b.y - a.y * b.x;
  }
  return sum;
}

}  // namespace gnomon
