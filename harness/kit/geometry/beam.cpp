#include <gnomon/kit/geometry/beam.h>

#include <algorithm>
#include <cmath>

namespace gnomon {

Beam::Beam(const Bounds& from, const Bounds& to) {
  for (int k = 0; k < 3; ++k) {
    low_[k] = std::min(from.min[k], to.min[k]);
    high_[k] = std::max(from.max[k], to.max[k]);
  }
  for (int axis = 0; axis < 3; ++axis) {
    const int i = (axis + 1) % 3, j = (axis + 2) % 3;
    for (int quadrant = 0; quadrant < 4; ++quadrant) {
      // The corners farthest into the quadrant, and the line through them where its normal points there.
      const bool right = quadrant & 1, up = quadrant & 2;
      const double ax = right ? from.max[i] : from.min[i], ay = up ? from.max[j] : from.min[j],
                   bx = right ? to.max[i] : to.min[i], by = up ? to.max[j] : to.min[j];
      double x = by - ay, y = ax - bx;
      if (right ? x < 0 : x > 0) {
        x = -x;
        y = -y;
      }
      if (x == 0 || y == 0 || (x > 0) != right || (y > 0) != up) continue;
      // Products of differences of floats: rounding is far below 2^-48 of the sum of their sizes.
      const double reach =
          0x1p-48 * (std::abs(x) * std::max(std::abs(ax), std::abs(bx)) + std::abs(y) * std::max(std::abs(ay), std::abs(by)));
      sides_[count_++] = {i, j, x, y, std::max(x * ax + y * ay, x * bx + y * by) + reach};
    }
  }
}

}  // namespace gnomon
