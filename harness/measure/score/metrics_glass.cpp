// Behind casters that let a part of the light through: errors by how much glass is on the way, by distance to jumps, and in
// hue.
#include <algorithm>

#include "measure/frame/boundary.h"
#include "measure/scene/channels.h"
#include "measure/score/metrics.h"
#include "measure/statistics/statistics.h"

namespace gnomon {

namespace {

/// Pixels this near to a jump of the reference are at its edge.
constexpr float edge_pixels = 2;

/// A mean in the making.
struct Sum {
  double of = 0;
  std::size_t count = 0;
  void add(double value) {
    of += value;
    ++count;
  }
  std::optional<double> mean() const { return count > 0 ? std::optional(of / static_cast<double>(count)) : std::nullopt; }
};

/// 0, 1, 2, 3 to 4, 5 and more.
std::size_t bin_of(std::uint8_t surfaces) { return surfaces < 3 ? surfaces : surfaces < 5 ? 3 : 4; }

}  // namespace

GlassError measure_glass_error(const Evidence& e) {
  if (e.surfaces.empty()) return {};
  const std::vector<float> to_jump =
      distance_transform(shadow_boundary(e.reference, e.classes, e.width, e.height, e.kind), e.width, e.height);
  Sum squares, near, far;
  std::array<Sum, std::tuple_size_v<decltype(GlassError::by_surfaces)>> by_surfaces;
  std::vector<double> errors;
  for (std::size_t i = 0; i < e.mask.size(); ++i) {
    if (e.classes[i] != PixelClass::T) continue;
    const double error = std::abs(static_cast<double>(e.mask[i]) - e.reference[i]);
    errors.push_back(error);
    squares.add(error * error);
    (to_jump[i] <= edge_pixels ? near : far).add(error);
    if (e.surfaces[i] != blocked_surfaces) by_surfaces[bin_of(e.surfaces[i])].add(error);
  }
  if (errors.empty()) return {};
  GlassError result{.rms = std::sqrt(*squares.mean()),
                    .p95 = quantile(errors, 0.95),
                    .near_jumps = near.mean(),
                    .off_jumps = far.mean(),
                    .by_surfaces = {}};
  std::ranges::transform(by_surfaces, result.by_surfaces.begin(), &Sum::mean);
  return result;
}

std::optional<double> measure_hue_error(const Evidence& e) {
  if (e.channels.size() != std::size(all_channels)) return std::nullopt;
  Sum spreads;
  for (std::size_t i = 0; i < e.mask.size(); ++i) {
    if (std::ranges::any_of(e.channels, [&](const Evidence& one) { return one.classes[i] != PixelClass::T; })) continue;
    std::array<double, std::size(all_channels)> errors;
    std::ranges::transform(e.channels, errors.begin(),
                           [i](const Evidence& one) { return static_cast<double>(one.mask[i]) - one.reference[i]; });
    spreads.add(std::ranges::max(errors) - std::ranges::min(errors));
  }
  return spreads.mean();
}

}  // namespace gnomon
