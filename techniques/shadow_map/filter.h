#pragma once
#include <glm/glm.hpp>
#include <vector>

namespace gnomon::shadow_map {

/// In the order of the parameter's choices.
enum class FilterKind { nearest, pcf, disc, bilinear };

/// A texel that is compared for a point, and its share of the answer.
struct WeightedTexel {
  glm::ivec2 texel;
  double weight;
};

/// Which texels are compared for one point. Mirrored by the resolve shader.
struct Filter {
  FilterKind kind = FilterKind::nearest;
  int radius = 0;  ///< texels; of pcf and disc

  /// Texels that a comparison may lie beside the one that holds the point.
  int margin() const;
  /// How far the centers of compared texels may be from the point, in half diagonals of a texel. Depths of a plane spread by so
  /// much more than inside one texel, and biases grow with it.
  double reach() const;
  /// For a point at this place, in texels. Weights sum to 1.
  std::vector<WeightedTexel> texels(const glm::dvec2& place) const;
};

}  // namespace gnomon::shadow_map
