#include "filter.h"

#include <cmath>
#include <numbers>

namespace gnomon::shadow_map {

int Filter::margin() const {
  switch (kind) {
    case FilterKind::pcf:
      return radius;
    case FilterKind::disc:
      return radius + 1;
    case FilterKind::bilinear:
      return 1;
    default:
      return 0;
  }
}

// The point is up to half a texel from the middle of its own, along both axes; that of a disc is its center.
double Filter::reach() const {
  switch (kind) {
    case FilterKind::pcf:
      return 2 * radius + 1;
    case FilterKind::disc:
      return (radius + 0.5) * std::numbers::sqrt2;
    case FilterKind::bilinear:
      return 2;
    default:
      return 1;
  }
}

std::vector<WeightedTexel> Filter::texels(const glm::dvec2& place) const {
  const glm::ivec2 own(glm::floor(place));
  std::vector<WeightedTexel> texels;
  double sum = 0;
  const auto add = [&](const glm::ivec2& texel, double weight) {
    texels.push_back({texel, weight});
    sum += weight;
  };
  if (kind == FilterKind::bilinear) {
    const glm::dvec2 corner = glm::floor(place - 0.5), share = place - 0.5 - corner;
    for (int k = 0; k < 4; ++k) {
      const glm::ivec2 aside(k % 2, k / 2);
      const glm::dvec2 near = glm::mix(1.0 - share, share, glm::dvec2(aside));
      add(glm::ivec2(corner) + aside, near.x * near.y);
    }
  } else {
    const int m = margin();
    for (int y = -m; y <= m; ++y)
      for (int x = -m; x <= m; ++x) {
        const glm::ivec2 texel = own + glm::ivec2(x, y);
        const double distance = glm::distance(glm::dvec2(texel) + 0.5, place);
        add(texel, kind == FilterKind::disc ? glm::clamp(radius + 0.5 - distance, 0.0, 1.0) : 1);
      }
  }
  for (WeightedTexel& one : texels) one.weight /= sum;
  return texels;
}

}  // namespace gnomon::shadow_map
