#pragma once
#include <gnomon/scene.h>

#include <array>

namespace gnomon {

/// All ways from one box to another: their convex hull. Its faces are those of the box around both, and planes through an edge
/// of one box and a parallel edge of the other, which are lines in the picture along a coordinate axis.
class Beam {
 public:
  Beam(const Bounds& from, const Bounds& to);

  /// Only what reaches above a plane counts, too: where dot(normal, x) > height.
  void cut_below(const glm::dvec3& normal, double height) {
    normal_ = normal;
    height_ = height;
  }

  /// Whether a box may meet the hull; never a false no.
  bool meets(const float* low, const float* high) const {
    for (int k = 0; k < 3; ++k)
      if (low[k] > high_[k] || high[k] < low_[k]) return false;
    for (int k = 0; k < count_; ++k) {
      const Side& side = sides_[k];
      const double x = side.x > 0 ? low[side.axis_x] : high[side.axis_x], y = side.y > 0 ? low[side.axis_y] : high[side.axis_y];
      if (side.x * x + side.y * y > side.most) return false;
    }
    double top = 0;
    for (int k = 0; k < 3; ++k) top += normal_[k] * (normal_[k] > 0 ? high[k] : low[k]);
    return top > height_;
  }

 private:
  /// x * p[axis_x] + y * p[axis_y] <= most inside.
  struct Side {
    int axis_x, axis_y;
    double x, y, most;
  };
  std::array<double, 3> low_, high_;
  std::array<Side, 12> sides_;
  int count_ = 0;
  glm::dvec3 normal_{0};
  double height_ = -1;
};

}  // namespace gnomon
