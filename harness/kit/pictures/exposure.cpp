#include <gnomon/kit/pictures/exposure.h>

#include <algorithm>
#include <cstddef>

namespace gnomon {

float exposure(std::span<const float> rgb) {
  std::vector<float> strongest;
  for (std::size_t i = 0; i + 2 < rgb.size(); i += 3)
    if (const float most = std::max({rgb[i], rgb[i + 1], rgb[i + 2]}); most > 0) strongest.push_back(most);
  if (strongest.empty()) return 1;
  const auto at = strongest.begin() + static_cast<std::ptrdiff_t>((strongest.size() - 1) * 95 / 100);
  std::ranges::nth_element(strongest, at);
  // Of the least numbers of float32 the reciprocal would be infinite.
  return 1 / std::max(*at, 1e-30f);
}

std::vector<float> exposed(std::span<const float> rgb, float factor) {
  std::vector<float> shown(rgb.size());
  std::ranges::transform(rgb, shown.begin(), [factor](float value) { return std::clamp(value * factor, 0.0f, 1.0f); });
  return shown;
}

}  // namespace gnomon
