#pragma once
#include "measure/picture/picture.h"

namespace gnomon {

// How different two pictures look. Both functions take pictures of the same size; anything else is an Error.

/// Structural similarity (Wang, Bovik, Sheikh, Simoncelli 2004): 1 for equal pictures, lower for others, symmetric. Windows of
/// 11 x 11 pixels weighted by a Gaussian of sigma 1.5 and summing to 1, K1 = 0.01, K2 = 0.03, on luma: 0.2126 R + 0.7152 G +
/// 0.0722 B of the sRGB values in 0 .. 1. The mean is over the pixels whose whole window lies in the picture; nothing when
/// there is none.
std::optional<double> ssim(const Picture& reference, const Picture& test);

/// LDR-FLIP (Andersson, Nilsson, Akenine-Moller, Oskarsson, Astrom, Fairchild 2020): how much a viewer notices when the two
/// pictures alternate, at 67 pixels per degree of his sight, mean over all pixels: 0 for equal pictures, at most 1, symmetric.
/// Pixels outside the picture are those of its rim. Nothing for a picture without pixels.
std::optional<double> flip(const Picture& reference, const Picture& test);

}  // namespace gnomon
