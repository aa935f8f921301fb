#pragma once
#include <gnomon/gbuffer.h>

#include <algorithm>
#include <array>

namespace gnomon {

// What shaded pictures and pictures of errors are made of, one pixel at a time: draw_errors and the viewer share it.

using Color = std::array<std::uint8_t, 3>;  ///< sRGB
/// sRGB of every 4096th of linear light: a table, because a power per channel and pixel costs more than the shading.
using SrgbSteps = std::array<std::uint8_t, 4097>;

/// sRGB of a channel of linear light, which counts as 0 or 1 outside 0 .. 1 (IEC 61966-2-1).
std::uint8_t srgb(double linear);
const SrgbSteps& srgb_steps();
/// sRGB of the step that the linear light lies in; of 0 where it is no number.
inline std::uint8_t srgb_fast(const SrgbSteps& steps, double linear) {
  return steps[static_cast<std::size_t>(static_cast<int>(linear > 0 ? std::min(linear, 1.0) * 4096 : 0.0))];
}
/// What shows no surface.
inline constexpr Color background_srgb{24, 26, 30};

/// Irradiance of every pixel without casters, W/m2; 0 on the background. On all threads.
std::vector<double> received_light(const GBuffer& gbuffer, const Light& light);

/// What irradiance is multiplied by in pictures: the view's own exposure, or one for which nine tenths of the pixels that
/// receive light without shadows show no more than their albedo: a gray card of 18 % is middle gray where it is brightest but
/// for a tenth, ambient light included. 1 where none receives any.
double exposure_of(const Scene& scene, const GBuffer& gbuffer, std::span<const double> received);

/// A surface of linear albedo under the light `ambient + exposure * received * visibility`, by channel.
inline Color shaded_srgb(const SrgbSteps& steps, const glm::vec3& albedo, const glm::dvec3& light) {
  return {srgb_fast(steps, albedo.x * light.x), srgb_fast(steps, albedo.y * light.y), srgb_fast(steps, albedo.z * light.z)};
}
/// Under white light.
inline Color shaded_srgb(const SrgbSteps& steps, const glm::vec3& albedo, double light) {
  return shaded_srgb(steps, albedo, glm::dvec3(light));
}

/// Visibility as gray, black in shadow; no number is black, too.
inline std::uint8_t mask_gray(float visibility) {
  return static_cast<std::uint8_t>(visibility > 0 ? static_cast<double>(255 * std::min(visibility, 1.0f)) + 0.5 : 0);
}

/// The gray behind the colors of errors: right pixels keep their shading in light gray, untested ones sink to dark
/// gray.
inline std::uint8_t dimmed(const Color& shaded, bool is_tested) {
  const int gray = (2 * shaded[0] + 5 * shaded[1] + shaded[2]) / 8;
  return static_cast<std::uint8_t>(is_tested ? 70 + gray * 2 / 5 : 20 + gray / 5);
}

/// "0.0312 %", "3.12 %", "31.2 %".
std::string percent(double share);

}  // namespace gnomon
