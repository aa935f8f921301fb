#include "measure/picture/signed_color.h"

#include <cassert>

namespace gnomon {

std::span<const Color> signed_colors() {
  static constexpr Color colors[] = {
      {110, 38, 0},    {177, 77, 0},   {230, 137, 47}, {248, 200, 145},  // darker
      {244, 244, 242},                                                   // no difference
      {173, 212, 238}, {94, 165, 214}, {31, 106, 168}, {8, 45, 100},     // lighter
  };
  return colors;
}

Color signed_color(double difference, double full_scale) {
  assert(full_scale > 0);
  const std::span<const Color> colors = signed_colors();
  const double middle = static_cast<double>(colors.size() - 1) / 2, share = difference / full_scale;
  const double place = middle * (1 + (std::isnan(share) ? 0 : std::clamp(share, -1.0, 1.0)));
  const std::size_t below = std::min(static_cast<std::size_t>(place), colors.size() - 2);
  const double part = place - static_cast<double>(below);
  Color color;
  for (std::size_t c = 0; c < color.size(); ++c)
    color[c] = static_cast<std::uint8_t>(std::lround((1 - part) * colors[below][c] + part * colors[below + 1][c]));
  return color;
}

}  // namespace gnomon
