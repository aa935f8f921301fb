// What a soft mask shows beside the reference: shadows that are not there, grain, and the form of penumbrae.
#include <gnomon/kit/parallel.h>

#include "measure/cause/components.h"
#include "measure/cause/soft_causes.h"
#include "measure/frame/boundary.h"

namespace gnomon {

namespace {

constexpr int most_reach = 24;     ///< pixels, of a window
constexpr double most_width = 64;  ///< pixels, of a penumbra

}  // namespace

PenumbraShapes::PenumbraShapes(const Attribution& a, const SoftTruth& truth)
    : a_(a),
      truth_(truth),
      windows_(a.gbuffer.width, a.gbuffer.height, a.reference.classes, &a.gbuffer),
      has_transmission_(a.casters.has_transmission()),
      is_soft_(find_penumbra(truth.share)),
      is_own_soft_(find_penumbra(a.mask)) {
  const int width = a.gbuffer.width, height = a.gbuffer.height;
  nearest_ = nearest_marked(is_soft_, width, height);
  to_penumbra_ = distance_transform(is_soft_, width, height);
  to_own_penumbra_ = distance_transform(is_own_soft_, width, height);
  std::vector<std::uint32_t> shadowed(a.mask.size(), no_mesh);
  for (std::size_t i = 0; i < shadowed.size(); ++i) {
    // Clear glass makes a shadow of less than a fiftieth.
    const float lit = has_transmission_ ? std::max(0.98f, 1 - 4 * truth.error[i]) : 0.98f;
    if (a.reference.classes[i] > PixelClass::F && truth.share[i] < lit) shadowed[i] = a.gbuffer.mesh[i];
  }
  missing_ = missing_shadows(
      shadowed, width, height, [&](std::size_t i) { return 1 - truth.share[i]; }, [&](std::size_t i) { return 1 - a.mask[i]; });
  find_roughness();
}

std::vector<std::uint8_t> PenumbraShapes::find_penumbra(std::span<const float> values) const {
  std::vector<std::uint8_t> is_soft(values.size());
  for_blocks(values.size(), 1024, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      is_soft[i] =
          a_.reference.classes[i] > PixelClass::F && is_penumbra(values[i]) && (!has_transmission_ || is_between(values, i));
  });
  return is_soft;
}

/// Whether there are both more and less light around. Neither side of a hard edge lies between, nor what is dimmed evenly.
bool PenumbraShapes::is_between(std::span<const float> values, std::size_t i) const {
  constexpr int reach = 3;
  const auto [least, most] = range_within(values, i, reach);
  return values[i] > least + truth_.error[i] && values[i] < most - truth_.error[i];
}

/// The least and the largest of the values around pixel i.
std::pair<double, double> PenumbraShapes::range_within(std::span<const float> values, std::size_t i, int reach) const {
  double least = values[i], most = values[i];
  windows_.for_tested(i, reach, [&](std::size_t j) {
    least = std::min<double>(least, values[j]);
    most = std::max<double>(most, values[j]);
  });
  return {least, most};
}

double PenumbraShapes::width(std::size_t i) const {
  if (nearest_[i] < 0) return most_width;
  const int x = nearest_[i] % a_.gbuffer.width, y = nearest_[i] / a_.gbuffer.width;
  if (!windows_.is_inside(x, y, 1)) return most_width;
  const double slope = glm::length(windows_.slope(truth_.share, x, y));
  return slope > 0.8 / most_width ? 0.8 / slope : most_width;
}

Cause PenumbraShapes::of_grain(std::size_t i) const {
  if (!is_own_soft_[i] && is_soft_[i] && to_own_penumbra_[i] > std::max(2.0, width(i))) return Cause::hard_shadow;
  // Places that were drawn in another way err where the light is seen in part, and nowhere else.
  if (to_penumbra_[i] > 2) return Cause::none;
  if (is_incoherent(i)) return Cause::noise;
  return is_in_levels(i) ? Cause::banding : Cause::none;
}

/// Whether the mask has exactly this value at a neighbor where the reference has clearly another one.
bool PenumbraShapes::is_plateau(std::size_t i) const {
  bool is_flat = false;
  windows_.for_tested(i, 1, [&](std::size_t j) {
    const float clear = 4 * (truth_.error[i] + truth_.error[j]);
    is_flat = is_flat || (a_.mask[j] == a_.mask[i] && std::abs(truth_.share[j] - truth_.share[i]) > clear);
  });
  return is_flat;
}

/// Whether the mask's penumbra around the pixel is made of plateaus, half of its pixels or more, and the error is not larger
/// than the step to the next level.
bool PenumbraShapes::is_in_levels(std::size_t i) const {
  const int reach = static_cast<int>(std::clamp(width(i), 3.0, double(most_reach)));
  std::size_t soft = 0, flat = 0;
  double above = INFINITY, below = INFINITY;
  windows_.for_tested(i, reach, [&](std::size_t j) {
    const double step = static_cast<double>(a_.mask[j]) - a_.mask[i];
    if (step > 0) above = std::min(above, step);
    if (step < 0) below = std::min(below, -step);
    if (!is_penumbra(a_.mask[j]) || (has_transmission_ && !is_soft_[j])) return;
    ++soft;
    flat += is_plateau(j);
  });
  const double step = error(i) > 0 ? below : above;  // the level that would be nearer
  return soft >= 4 && 2 * flat >= soft && std::isfinite(step) && std::abs(error(i)) <= step;
}

/// Of every pixel of T the square of its error, and the square of what it differs from the mean error of the neighbors that lie
/// alike: about the same V_ref, about as far from the penumbra. Of errors that have nothing to do with each other the second
/// is (n + 1) / n times the first, where n neighbors lie alike; it is stored without that factor.
void PenumbraShapes::find_roughness() {
  rough_.assign(a_.mask.size(), 0);
  energy_.assign(a_.mask.size(), 0);
  for_blocks(a_.mask.size(), 1024, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      if (a_.reference.classes[i] != PixelClass::T) continue;
      double sum = 0, count = 0;
      windows_.for_tested(i, 1, [&](std::size_t j) {
        if (j == i || std::abs(truth_.share[j] - truth_.share[i]) > 0.05f ||
            std::abs(to_penumbra_[j] - to_penumbra_[i]) > 0.75f)
          return;
        sum += error(j);
        ++count;
      });
      if (count == 0) continue;
      const double off = error(i) - sum / count;
      rough_[i] = static_cast<float>(off * off * count / (count + 1));
      energy_[i] = static_cast<float>(error(i) * error(i));
    }
  });
}

/// Whether the errors around the pixel have little to do with each other: their roughness is more than half of their squares.
bool PenumbraShapes::is_incoherent(std::size_t i) const {
  double rough = 0, energy = 0;
  windows_.for_tested(i, 3, [&](std::size_t j) {
    rough += rough_[j];
    energy += energy_[j];
  });
  return rough > energy / 2;
}

/// Errors around the pixel on the side of light and on that of shadow: a penumbra in another place errs alike on both, one of
/// another width the other way round.
Cause PenumbraShapes::form_within(std::size_t i, int reach) const {
  // Behind transmission the middle between light and shadow is not one half.
  const auto [least, most] = has_transmission_ ? range_within(truth_.share, i, reach) : std::pair(0.0, 1.0);
  const double middle = (least + most) / 2;
  const auto is_light_side = [&](std::size_t j) { return truth_.share[j] > middle; };
  std::array<double, 2> sum{}, count{};
  double all = 0;
  windows_.for_tested(i, reach, [&](std::size_t j) {
    if (error(j) == 0 && !is_soft_[j]) return;
    const int is_light = is_light_side(j);
    sum[is_light] += error(j);
    all += std::abs(error(j));
    ++count[is_light];
  });
  const auto mean = [&](int side) { return count[side] > 0 ? sum[side] / count[side] : 0; };
  const double moved = (mean(1) + mean(0)) / 2, widened = (mean(0) - mean(1)) / 2;
  const double own = error(i);
  const bool fits_move = moved * own > 0, fits_width = widened * own * (is_light_side(i) ? -1 : 1) > 0;
  // A small error amid larger ones belongs to them.
  const bool is_small = std::abs(own) < all / (count[0] + count[1]) / 2;
  if (!fits_move && !fits_width && !is_small) return Cause::none;
  if (fits_move == fits_width ? std::abs(moved) > std::abs(widened) : fits_move) return Cause::shifted;
  return widened > 0 ? Cause::too_wide : Cause::too_narrow;
}

/// As far around as the penumbra is wide; where that mixes several edges, as beside an outline, close by, and then next to it.
Cause PenumbraShapes::of_form(std::size_t i) const {
  constexpr int near = 3;
  if (nearest_[i] < 0) return Cause::none;
  const int reach = static_cast<int>(std::clamp(std::ceil(to_penumbra_[i] + width(i)), double(near), double(most_reach)));
  for (const int around : {reach, near, 1})
    if (const Cause form = form_within(i, around); form != Cause::none) return form;
  return Cause::none;
}

}  // namespace gnomon
