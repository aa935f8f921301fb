#pragma once
#include "measure/picture/shading.h"

namespace gnomon {

// How signed differences of masks and lines of equal visibility look, wherever they are drawn: the viewer and the report's page
// share it.

/// The differences at which colors may end, largest first: shares of the light.
inline constexpr std::array<double, 4> difference_scales{1, 0.3, 0.1, 0.03};

/// The colors of differences from -full_scale to +full_scale, at equal distances; the middle one is that of 0. Darker than the
/// reference is orange, lighter blue, and both get darker with their size: people who see fewer colors can distinguish
/// the sides, and a gray print still shows the sizes.
std::span<const Color> signed_colors();

/// The color of a difference, linear in sRGB between its neighbors; beyond the full scale that of its end, and of what is no
/// number that of 0. `full_scale` is positive.
Color signed_color(double difference, double full_scale);

/// Visibilities whose lines are drawn: where the umbra ends, the middle of the penumbra, and where it is lit.
inline constexpr std::array<float, 3> contour_levels{0.02f, 0.5f, 0.98f};

/// A line that can be seen over every picture: a core within a wider casing.
struct ContourInk {
  Color core, casing;
};
/// Whose contour it is: the reference's, or that of one of two techniques that are compared.
inline constexpr ContourInk reference_ink{{0, 0, 0}, {255, 255, 255}};
inline constexpr std::array<ContourInk, 2> technique_inks{{{{255, 225, 0}, {0, 0, 0}}, {{255, 120, 210}, {0, 0, 0}}}};

}  // namespace gnomon
