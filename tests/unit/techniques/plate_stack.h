#pragma once
// Plates of glass across a ray, and scenes of them, for tests of techniques whose texels hold a curve.
#include <gnomon/kit/random.h>

#include <cmath>
#include <vector>

namespace plate_stack {
using gnomon::Random;

/// At depth t, 0 .. 1; it takes `alpha` of the light.
struct Plate {
  double t, alpha;
  double absorbance() const { return -std::log(1 - alpha); }
};

/// The one of all tables: T at .1, .35, .6, .9 is 1, .5, .375, .075.
inline std::vector<Plate> on_paper() { return {{0.2, 0.5}, {0.5, 0.25}, {0.7, 0.8}}; }

/// From `least` to `most` of them, each number as likely as the other; depths even in 0 .. 1, alphas even in .05 .. .95.
inline std::vector<Plate> random_plates(Random& random, std::uint32_t least, std::uint32_t most) {
  std::vector<Plate> plates(least + random.below(most - least + 1));
  for (Plate& plate : plates) {
    plate.t = random.uniform(0, 1);
    plate.alpha = random.uniform(0.05, 0.95);
  }
  return plates;
}

inline double share_before(const std::vector<Plate>& plates, double t) {
  double share = 1;
  for (const Plate& plate : plates)
    if (plate.t < t) share *= 1 - plate.alpha;
  return share;
}

}  // namespace plate_stack
