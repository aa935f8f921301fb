#include "layers.h"

#include <gnomon/kit/pictures/layers.h>

#include <algorithm>
#include <cmath>

namespace gnomon::denoised_rays {

namespace {

/// A picture of what `color(pixel)` says of the pixels that face the light.
template <class Color>
std::vector<float> paint(const GBuffer& gbuffer, std::span<const std::uint8_t> faces, const Color& color) {
  const glm::vec3 turned_away(0, 0, 0.15f);
  std::vector<float> picture(3 * gbuffer.size());
  for (std::size_t i = 0; i < gbuffer.size(); ++i) {
    const glm::vec3 rgb = gbuffer.is_background(i) ? background_color() : faces[i] ? color(i) : turned_away;
    for (int c = 0; c < 3; ++c) picture[3 * i + c] = rgb[c];
  }
  return picture;
}

}  // namespace

std::vector<DebugLayer> layers() {
  std::vector<DebugLayer> all = {
      {"raw", "The share that each pixel's own rays of this frame found, black 0 and white 1, before memory and filter."},
      heat_debug_layer("widths", "Width in pixels of the penumbra around each pixel, by which filter=width spreads it"),
      {"variance",
       "Standard deviation of the shares that weights of filter=svgf and filter=tiles look at: black 0, white 1/2 and more."},
      heat_debug_layer("length", "Frames that each pixel's history counts as, this one included"),
      {"refused", "White: the frame before does not show the point, so that its history begins here."},
      {"weights",
       "The part of each pixel's share that comes from the pixel at (pick_x, pick_y), in the last frame's filter: white is "
       "the largest in the picture."}};
  for (const OwnCause& cause : own_causes)
    all.push_back({std::string(cause.id),
                   fmt::format("The term {} of the difference from exact shares, where these are known: orange too light, "
                               "blue too dark.",
                               cause.id)});
  return all;
}

std::optional<std::size_t> term_of_layer(std::string_view layer) {
  for (std::size_t k = 0; k < term_count; ++k)
    if (own_causes[k].id == layer) return k;
  return std::nullopt;
}

std::vector<float> paint_gray(const GBuffer& gbuffer, std::span<const std::uint8_t> faces, std::span<const float> values) {
  return paint(gbuffer, faces, [&](std::size_t i) { return glm::vec3(std::clamp(values[i], 0.0f, 1.0f)); });
}

std::vector<float> paint_signed(const GBuffer& gbuffer, std::span<const std::uint8_t> faces, std::span<const float> values) {
  const glm::vec3 nothing(0.2f), light(1, 0.5f, 0.05f), dark(0.1f, 0.4f, 1);
  return paint(gbuffer, faces, [&](std::size_t i) {
    const float value = values.empty() ? 0 : std::clamp(values[i], -1.0f, 1.0f);
    // By the root: most terms are small.
    return glm::mix(nothing, value < 0 ? dark : light, std::sqrt(std::abs(value)));
  });
}

}  // namespace gnomon::denoised_rays
