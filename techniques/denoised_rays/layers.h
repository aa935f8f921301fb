#pragma once
#include <gnomon/gbuffer.h>

#include "causes.h"

namespace gnomon::denoised_rays {

/// `raw`, `widths`, `variance`, `length`, `refused`, `weights`, and a layer for each term by its name.
std::vector<DebugLayer> layers();
/// The term that a layer shows; nothing for other layers.
std::optional<std::size_t> term_of_layer(std::string_view layer);

// Pictures: width * height * 3 floats, linear RGB in 0 .. 1. Pixels that do not face the light are dark blue.

/// Values of 0 .. 1 from black to white; what is beyond is cut off.
std::vector<float> paint_gray(const GBuffer& gbuffer, std::span<const std::uint8_t> faces, std::span<const float> values);
/// Values of -1 .. 1 on gray: too light in orange, too dark in blue. None at all: gray.
std::vector<float> paint_signed(const GBuffer& gbuffer, std::span<const std::uint8_t> faces, std::span<const float> values);

}  // namespace gnomon::denoised_rays
