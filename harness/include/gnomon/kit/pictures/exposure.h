#pragma once
#include <span>
#include <vector>

namespace gnomon {

/// By how much a picture of radiance is to be multiplied so that it can be seen: of all pixels that send light, 95 % are then
/// at most 1 in their strongest channel. 1 where no pixel sends any. `rgb` has three values a pixel, in linear light.
float exposure(std::span<const float> rgb);

/// The picture times `factor`, what is above 1 cut off: how debug layers show light.
std::vector<float> exposed(std::span<const float> rgb, float factor);
inline std::vector<float> exposed(std::span<const float> rgb) { return exposed(rgb, exposure(rgb)); }

}  // namespace gnomon
