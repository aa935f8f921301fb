#pragma once
#include <gnomon/technique.h>

namespace gnomon::denoised_rays {

/// In the order of the terms.
enum Term : std::size_t { residual_noise, stale_history, over_blur, disocclusion, bias, term_count };

inline constexpr OwnCause own_causes[term_count] = {
    {"residual_noise",
     "Noise of few rays that filter and memory left: exact shares in their place would be right.",
     {0, 180, 204}},
    {"stale_history", "The memory holds light of earlier frames that is no longer true.", {228, 48, 120}},
    {"over_blur", "The filter over pixels is wider than the penumbra: it blurs exact shares, too.", {252, 252, 120}},
    {"disocclusion", "Noise where the frame before did not show the point, so that few frames are remembered.", {36, 60, 36}},
    {"bias", "Shares were divided pixel by pixel: a mean of ratios is not the ratio of sums.", {80, 0, 0}},
};

}  // namespace gnomon::denoised_rays
