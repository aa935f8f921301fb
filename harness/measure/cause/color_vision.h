#pragma once
// How far apart colors look, also to people with one kind of cone missing.
#include <array>
#include <cmath>
#include <cstdint>
#include <glm/glm.hpp>

namespace gnomon::color_vision {

/// All cones, and one kind missing (Machado, Oliveira and Fernandes 2009, severity 1), for linear light.
inline const glm::dmat3 visions[] = {
    glm::dmat3(1),
    {0.152286, 1.052583, -0.204868, 0.114503, 0.786281, 0.099216, -0.003882, -0.048116, 1.051998},
    {0.367322, 0.860646, -0.227968, 0.280085, 0.672501, 0.047413, -0.011820, 0.042940, 0.968881},
    {1.255528, -0.076749, -0.178779, -0.078411, 0.930809, 0.147602, 0.004733, 0.691367, 0.303900},
};

/// What a color in sRGB looks like with such cones, in CIE Lab. A distance of 2.3 is just noticeable side by side.
inline glm::dvec3 lab(const std::array<std::uint8_t, 3>& rgb, const glm::dmat3& vision) {
  glm::dvec3 linear;
  for (int c = 0; c < 3; ++c) {
    const double v = rgb[c] / 255.0;
    linear[c] = v <= 0.04045 ? v / 12.92 : std::pow((v + 0.055) / 1.055, 2.4);
  }
  linear = glm::clamp(linear * vision, 0.0, 1.0);  // rows are stored as columns
  const glm::dmat3 xyz(0.4124, 0.3576, 0.1805, 0.2126, 0.7152, 0.0722, 0.0193, 0.1192, 0.9505);
  glm::dvec3 f = linear * xyz / glm::dvec3(0.95047, 1, 1.08883);
  for (int c = 0; c < 3; ++c) f[c] = f[c] > 0.008856 ? std::cbrt(f[c]) : 7.787 * f[c] + 16.0 / 116;
  return {116 * f.y - 16, 500 * (f.x - f.y), 200 * (f.y - f.z)};
}

}  // namespace gnomon::color_vision
