// Lines of equal visibility, pixel by pixel.
#include "app/viewer/contours.h"

#include <algorithm>
#include <cmath>

#include "app/viewer/packed_color.h"

namespace gnomon::viewer {

Contours::Contours(const ComposeSide& side, const ContourInk& ink, bool is_broad)
    : side_(side),
      gbuffer_(side.frame->gbuffer),
      core_(pack(ink.core)),
      casing_(pack(ink.casing)),
      half_core_(is_broad ? 1.3f : 0.6f),
      half_casing_(is_broad ? 2.2f : 1.2f),
      noise_(find_noise(side)) {}

float Contours::distance(int x, int y) const {
  const auto faces_light = [&](std::size_t i) { return !gbuffer_.is_background(i) && side_.frame->received[i] > 0; };
  const std::size_t here = index(x, y);
  if (!faces_light(here)) return INFINITY;
  const bool is_mean = is_of_mean(x, y);
  const auto visibility = [&](int column, int row) {
    return is_mean ? noise_.mean[index(column, row)] : visibility_at(side_, gbuffer_, column, row);
  };
  const float v = visibility(x, y);
  // The larger of the steps to both neighbors: at a sharp edge one of them is zero.
  const auto step = [&](int column, int row) {
    if (column < 0 || row < 0 || column >= gbuffer_.width || row >= gbuffer_.height) return 0.0f;
    const std::size_t there = index(column, row);
    if (gbuffer_.mesh[there] != gbuffer_.mesh[here] || !faces_light(there)) return 0.0f;
    return std::abs(visibility(column, row) - v);
  };
  const float slope = std::hypot(std::max(step(x - 1, y), step(x + 1, y)), std::max(step(x, y - 1), step(x, y + 1)));
  if (!(slope > 0)) return INFINITY;
  float nearest = INFINITY;
  for (const float level : contour_levels) nearest = std::min(nearest, std::abs(v - level) / slope);
  return nearest;
}

void Contours::paint(int y, int first, int last, std::span<std::uint32_t> colors) const {
  for (int x = first; x < last; ++x) {
    const float off = distance(x, y);
    if (off >= half_casing_ + 0.5f) continue;
    colors[x] = mixed(colors[x], casing_, weight_of(half_casing_ + 0.5f - off));
    colors[x] = mixed(colors[x], core_, weight_of(half_core_ + 0.5f - off));
  }
}

}  // namespace gnomon::viewer
