#pragma once
#include <gnomon/alpha_mask.h>

#include <cstddef>
#include <vector>

namespace gnomon {

/// A PNG of gray and alpha, 8 bits each, white throughout: alpha is 255 where the mask is solid, 0 in its holes. Not
/// compressed.
std::vector<std::byte> mask_png(const AlphaMask& mask);

}  // namespace gnomon
