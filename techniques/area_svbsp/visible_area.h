#pragma once
#include <gnomon/kit/area/light_figure.h>

#include <span>

#include "casters.h"

namespace gnomon::area_svbsp {

/// How much of a light's area one point sees past polygons, in closed form: from the point every polygon hides a convex region
/// of the light's figure, bounded by the lines in which planes through the point and its edges meet the figure's plane. The
/// figure is halved until few regions reach into a part, and there they are cut away; the area of what is left is a sum over
/// its contour. So it takes time like the number of polygons, and not like its square. Keeps its memory from one point to the
/// next.
///
/// A disc lies between polygons of 64 corners, inside and around, and two thirds of what is between them belong to it: 1e-6.
class VisibleArea {
 public:
  /// `face` must be seen, and outlive what follows.
  void start(const LightFigure& face);
  /// A polygon between, with the place of the point. One whose plane holds the point hides nothing.
  void add(const CasterPolygon& polygon, const glm::dvec3& point);
  /// Of the figure above the horizon.
  double share();

 private:
  /// Where all lines are positive: line.x + line.y * s + line.z * t, by the coordinates of the figure.
  struct Region {
    std::uint32_t count = 0;
    glm::dvec3 lines[5];
  };
  struct Part {
    std::size_t first, count;  ///< of corners_
  };
  struct List {
    std::size_t first, count;  ///< of lists_
  };
  std::span<const glm::dvec2> corners(const Part& part) const { return {corners_.data() + part.first, part.count}; }
  double twice_area(const Part& part) const;
  /// Twice the area of a part that no region of the list hides. `last` and `before` regions reached into the part that this is
  /// half of, and into the one that that was half of.
  double seen(Part part, List list, std::size_t last, std::size_t before);
  double seen_past(Part part, std::span<const std::uint32_t> regions);
  /// The parts where a line is negative and positive, at the end of corners_.
  std::pair<Part, Part> divide(const Part& part, const glm::dvec3& line);
  /// Of a figure with these corners, what is above the horizon: twice its area, and twice of what is seen.
  std::pair<double, double> seen_of(std::vector<glm::dvec2> figure);

  const LightFigure* face_ = nullptr;
  glm::dvec3 axis_{0};
  double plane_ = 0;
  std::vector<Region> regions_;
  std::vector<glm::dvec2> corners_;
  std::vector<std::uint32_t> lists_;
};

}  // namespace gnomon::area_svbsp
