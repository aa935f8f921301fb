#pragma once
#include <gnomon/kit/area/light_figure.h>

#include <array>
#include <optional>
#include <vector>

namespace gnomon::penumbra_wedge {

inline double cross(const glm::dvec2& a, const glm::dvec2& b) { return a.x * b.y - a.y * b.x; }

/// A convex part of the square around a light's figure, by few lines. Inside of a line is where line_at() >= 0. Allocates
/// nothing.
class Figure {
 public:
  /// What the point's horizon leaves.
  explicit Figure(const LightFigure& figure);
  void clip(const glm::dvec3& line);
  /// Of what lies on the light, in places: a whole rectangle has 4, a disc pi. Closed form.
  double area() const;

 private:
  static constexpr int most_corners = 12;  // four of the square, one more for each line
  std::array<glm::dvec2, most_corners> corners_;
  int count_ = 0;
  bool is_disc_ = false;
};

/// How many layers of casters lie before the places of a light, as one point sees them: counted at a base, and from there by
/// the edges of an outline. An edge lies behind the way from the base to a place of its region: the part of the light within
/// the two lines from the base through the edge's ends, and past the edge. There are as many layers more as the edge counts. So
/// the mean over the light is closed form: each region is convex.
class Coverage {
 public:
  /// A vertex on its way to the light's plane: (x, y) times w is its place; at w = 0 it is beside the point, at w = 1 in the
  /// plane.
  struct Projected {
    glm::dvec3 to;  ///< from the point
    double x, y, w;
    bool is_beyond;  ///< in the light's plane, or behind it
  };

  void set(const LightFigure& figure);
  /// Starts anew with another base, a place of the light.
  void start(const LightFigure& figure, const glm::dvec2& base);
  Projected project(const glm::dvec3& to) const;

  /// A directed edge: as the light sees it, `count` layers more lie on its left. Only what is before the light's plane counts.
  /// False where double cannot tell on which side of it the base lies.
  bool add_edge(const Projected& a, const Projected& b, int count);
  /// The end of a triangle in the light's plane, corners in the triangle's order, which is counter-clockwise seen from the
  /// light for `facing` 1. `is_swapped`: of edges that start at each corner, which were added from their end to their start.
  bool add_section(const Projected (&corners)[3], const bool (&is_swapped)[3], int facing);

  const glm::dvec3& to_base() const { return to_base_; }  ///< from the point
  /// The mean over what is seen of the light, in layers more than at the base.
  double mean() const;
  /// The same at one place.
  int at(const glm::dvec2& place) const;

 private:
  struct Region {
    glm::dvec3 lines[3];
    int layers;
  };
  static Projected cut(const Projected& a, const Projected& b);
  /// `side`: +1 where the base is on the left of the way from a to b, in the coordinates of places.
  void add_region(Projected a, Projected b, int side, int count);

  std::vector<Region> regions_;
  std::optional<Figure> seen_;
  double area_ = 0;
  glm::dvec3 s_, t_, w_;
  int turn_ = 1;  ///< -1 where the coordinates are a mirror image of what the light sees
  glm::dvec2 base_{0};
  glm::dvec3 to_base_{0};
};

}  // namespace gnomon::penumbra_wedge
