#pragma once
#include <gnomon/technique.h>

#include "measure/images/image_files.h"

namespace gnomon {

/// Lambert with constant ambient: albedo * (ambient + exposure * irradiance * visibility), sRGB; see exposure_of.
Picture shade(const Scene& scene, const GBuffer& gbuffer, const Light& light, std::span<const float> visibility);

/// Under several lights together: of the irradiance that they would give without shadows, per pixel, these shares. `white` is
/// the linear light that is shown as white; what is brighter is white, too.
Picture shade(const Scene& scene, const GBuffer& gbuffer, std::span<const double> received, std::span<const float> shares,
              double white = 1);

/// What reaches each pixel of one channel: irradiance without shadows, W/m2, and the share of it. Both are empty in the dark.
struct ChannelLight {
  std::span<const double> received = {};
  std::span<const float> shares = {};
};
/// Under colored light: its red, green and blue. Of such a picture exposure_of needs the light of one channel.
Picture shade(const Scene& scene, const GBuffer& gbuffer, const std::array<ChannelLight, 3>& channels, double exposure);

/// The largest channel, linear, that `shade` shows where all light is received.
double brightest(const Scene& scene, const GBuffer& gbuffer, std::span<const double> received);

/// Visibility as gray, black in shadow.
Picture draw_mask(std::span<const float> visibility, int width, int height);

/// The same of a light with area, and below it what the grays mean.
Picture draw_soft_mask(std::span<const float> visibility, int width, int height);
/// The same of masks of red, green and blue light, in color; an empty one is dark.
Picture draw_color_mask(const std::array<std::span<const float>, 3>& channels, int width, int height);

/// A technique's debug layer, width * height * 3 linear floats, and below it its sentence, in three lines at most, and its
/// legend.
Picture draw_layer(std::span<const float> linear, int width, int height, const DebugLayer& layer);

/// PNG. Throws Error when it cannot be written; nothing half-written stays.
void write_png(const std::filesystem::path& path, const Picture& picture);

/// 8 bits of gray a pixel, with alpha two bytes a pixel, as they are: no curve. As `write_png` otherwise.
void write_gray_png(const std::filesystem::path& path, int width, int height, std::span<const std::uint8_t> values,
                    bool has_alpha = false);

/// One float channel per mask, named `names[k]`; zip-compressed half would round visibilities, so float it is.
void write_exr(const std::filesystem::path& path, int width, int height, std::span<const std::string> names,
               std::span<const std::span<const float>> channels);

}  // namespace gnomon
