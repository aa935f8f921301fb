#pragma once
#include <gnomon/technique.h>

namespace gnomon {

/// Causes of glass maps, for their About: of those whose texels hold a curve, and of those that filter absorbance, too.
inline constexpr OwnCause glass_map_causes[] = {
    {"curve",
     "What a texel holds of the glass on its ray differs from the exact list, which would answer right.",
     {56, 48, 144}},
    {"filtered_absorbance",
     "The filter averaged absorbance, not light: with the light of the same texels averaged the answer would be right.",
     {80, 56, 40}},
};
inline constexpr std::span<const OwnCause> curve_causes = std::span(glass_map_causes).first(1);

}  // namespace gnomon
