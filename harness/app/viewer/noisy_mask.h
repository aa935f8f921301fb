#pragma once
#include "app/viewer/compose.h"

namespace gnomon::viewer {

/// Where a mask is noisy, and what it is there on average. By pixel of the side's frame; both empty where nothing is noisy.
struct NoisyMask {
  static constexpr int mean_reach = 4;  ///< pixels to each side that a mean is of

  std::vector<char> is_noisy;  ///< whether the mask goes up and down around the pixel by much more than it changes in all
  std::vector<float> mean;     ///< over pixels of the same mesh that face the light; of noisy pixels and their neighbors
};

/// Of masks that have shares: what is binary has edges, and no noise.
NoisyMask find_noise(const ComposeSide& side);

}  // namespace gnomon::viewer
