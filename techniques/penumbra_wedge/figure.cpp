#include "figure.h"

#include <cassert>
#include <cmath>

namespace gnomon::penumbra_wedge {

namespace {

double angle_between(const glm::dvec2& a, const glm::dvec2& b) { return std::atan2(cross(a, b), glm::dot(a, b)); }

/// Twice the signed area that the triangle of the origin, a and b has in the unit disc: sectors where the way from a to b is
/// outside, a triangle where it is inside.
double twice_in_disc(const glm::dvec2& a, const glm::dvec2& b) {
  const glm::dvec2 way = b - a;
  const double square = glm::dot(way, way), along = glm::dot(a, way), root = along * along - square * (glm::dot(a, a) - 1);
  if (square == 0) return 0;
  if (root <= 0) return angle_between(a, b);
  const double half = std::sqrt(root), enter = (-along - half) / square, leave = (-along + half) / square;
  if (enter >= 1 || leave <= 0) return angle_between(a, b);
  const glm::dvec2 from = enter > 0 ? a + enter * way : a, to = leave < 1 ? a + leave * way : b;
  return (enter > 0 ? angle_between(a, from) : 0) + cross(from, to) + (leave < 1 ? angle_between(to, b) : 0);
}

}  // namespace

Figure::Figure(const LightFigure& face) : corners_{{{-1, -1}, {1, -1}, {1, 1}, {-1, 1}}}, count_(4), is_disc_(face.is_disc()) {
  clip(face.horizon());
}

void Figure::clip(const PlaceLine& line) {
  std::array<double, most_corners> at;
  bool is_inside = true;
  for (int k = 0; k < count_; ++k) {
    at[k] = line_at(line, corners_[k]);
    is_inside &= at[k] >= 0;
  }
  if (is_inside) return;
  assert(count_ < most_corners);
  const std::array<glm::dvec2, most_corners> whole = corners_;
  int kept = 0;
  for (int k = 0; k < count_; ++k) {
    const int next = k + 1 < count_ ? k + 1 : 0;
    if (at[k] >= 0) corners_[kept++] = whole[k];
    if ((at[k] > 0 && at[next] < 0) || (at[k] < 0 && at[next] > 0))
      corners_[kept++] = whole[k] + at[k] / (at[k] - at[next]) * (whole[next] - whole[k]);
  }
  count_ = kept;
}

double Figure::area() const {
  if (count_ < 3) return 0;
  double twice = 0;
  for (int k = 0; k < count_; ++k) {
    const glm::dvec2 &a = corners_[k], &b = corners_[k + 1 < count_ ? k + 1 : 0];
    twice += is_disc_ ? twice_in_disc(a, b) : cross(a - corners_[0], b - corners_[0]);
  }
  return std::max(twice / 2, 0.0);
}

}  // namespace gnomon::penumbra_wedge
