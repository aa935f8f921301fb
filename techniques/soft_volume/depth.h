#pragma once
#include <gnomon/kit/area/light_figure.h>

#include <vector>

namespace gnomon::soft_volume {

/// Places of a light for one point, as numbers in 0 .. 1 along both sides of the box of its figure.
struct Places {
  std::vector<double> x, y;
  std::size_t size() const { return x.size(); }
  void clear() {
    x.clear();
    y.clear();
  }
};

/// How many casting triangles lie between a point and each place of a light, up to a number that is the same for all places:
/// from edges alone. Laine et al. 2005 integrate the jumps of that depth at edges over the light; so does this class.
///
/// Let m be how many triangles more the light's places on the left of a directed edge have before them than those on its right.
/// From the light's corner (0, 0) a way leads up the side x = 0 to the height of a place and then to the right. Only edges that
/// cross the side, and those between the side and the place, make the depth at the place differ from that at the corner: edges
/// that pass beside the light's box never count. The crossing with the side is computed once, so that it is at the same height
/// for both parts of the way, and a vertex once for all of its edges: rounding may move a caster's corner by 1e-15, but never
/// opens an outline.
class LightDepth {
 public:
  /// A vertex as the point sees it: (x, y) times w, and how far its depth is on the way to the light's plane; is_beyond: on it
  /// or behind it.
  struct Corner {
    double x, y, w;
    bool is_beyond;
  };

  /// Starts anew with a light's figure.
  void set(const LightFigure& figure);
  Corner corner(const glm::dvec3& to) const;
  /// A directed edge; `jump` is m. Only what is before the light's plane counts.
  void add_edge(const Corner& a, const Corner& b, int jump);
  /// Where a triangle crosses the light's plane its part before it ends: m is `facing`, corners in the triangle's order.
  /// `is_swapped`: of the edges that start at each corner, which were added from their end to their start.
  void add_section(const Corner (&corners)[3], const bool (&is_swapped)[3], int facing);
  bool is_flat() const { return lines_.empty() && steps_.empty(); }
  std::size_t line_count() const { return lines_.size(); }

  /// The depth at places less that at the corner.
  void find(const Places& places, std::vector<double>& depths) const;

  /// x, 1 - x, y, 1 - y, each times w, as rows to be multiplied by the way to a vertex: an edge with both ends below zero in
  /// one of them does not meet the light.
  const glm::dvec3& row_x() const { return x_; }
  const glm::dvec3& row_y() const { return y_; }
  const glm::dvec3& row_w() const { return w_; }

  /// A line that runs up from (x, y) by (dx, dy), in rows from `low` to below `high`; places on its right have `jump` more.
  struct Line {
    double x, y, dx, dy, low, high, jump;
  };
  /// Places in rows from `low` on have `jump` more.
  struct Step {
    double low, jump;
  };

 private:
  static Corner cut(const Corner& a, const Corner& b);
  void add_line(const Corner& a, const Corner& b, int jump);

  glm::dvec3 x_{0}, y_{0}, w_{0};
  int turn_ = 1;  ///< -1 where the coordinates are a mirror image of what the point sees
  std::vector<Line> lines_;
  std::vector<Step> steps_;
};

}  // namespace gnomon::soft_volume
