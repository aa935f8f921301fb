#pragma once
#include "measure/frame/classify.h"

namespace gnomon {

/// Marks the pixels facing the light that have a 4-neighbor facing the light on the other side of one half; of a transmitted
/// answer one that would be wrong in their place.
std::vector<std::uint8_t> shadow_boundary(std::span<const float> mask, std::span<const PixelClass> classes, int width,
                                          int height, AnswerKind kind = AnswerKind::binary);

/// Euclidean distance in pixels from every pixel to the nearest marked one; infinity when none is marked.
std::vector<float> distance_transform(std::span<const std::uint8_t> marked, int width, int height);

/// Index of the marked pixel nearest to each pixel, -1 everywhere when none is marked. Of several as near, any; always the
/// same.
std::vector<std::int32_t> nearest_marked(std::span<const std::uint8_t> marked, int width, int height);

}  // namespace gnomon
