// Causes of errors under lights with area, in their order; docs/causes.md derives each.
#include "measure/cause/soft_causes.h"

#include <gnomon/kit/parallel.h>

#include <algorithm>
#include <unordered_map>

#include "measure/cause/causes_taps.h"
#include "measure/cause/components.h"

namespace gnomon {

namespace {

constexpr double most_errors = 4;            ///< standard errors of the reference that explain a difference
constexpr std::size_t first_chunk = 16;      ///< pixels explained at first, to learn how many samples each has
constexpr std::size_t most_chunk = 4096;     ///< pixels explained at a time,
constexpr std::size_t most_items = 1 << 19;  ///< and samples and taps of them

/// Walks the steps of one mask.
class SoftCauses {
 public:
  explicit SoftCauses(const Attribution& a) : a_(a), truth_(a), causes_(a.mask.size(), Cause::none), shapes_(a, truth_) {}

  std::vector<Cause> find() {
    std::vector<std::uint32_t> open;
    for (std::uint32_t i = 0; i < causes_.size(); ++i) {
      if (a_.reference.classes[i] != PixelClass::T || error(i) == 0) continue;
      const bool is_noise = std::abs(error(i)) <= most_errors * truth_.error[i];
      causes_[i] = is_noise ? Cause::reference_error : a_.found_without_technique(i);
      if (causes_[i] == Cause::none) open.push_back(i);
    }
    open = explain(open);
    examine_mask(open);
    split_regions();
    return std::move(causes_);
  }

 private:
  double error(std::size_t i) const { return static_cast<double>(a_.mask[i]) - truth_.share[i]; }

  /// What the technique says of the pixels; returns those that stay open.
  std::vector<std::uint32_t> explain(std::span<const std::uint32_t> pixels) {
    SampleCauses samples(a_, truth_);
    std::vector<std::uint32_t> open;
    std::size_t chunk = first_chunk;
    for (std::size_t first = 0; first < pixels.size();) {
      const auto some = pixels.subspan(first, std::min(chunk, pixels.size() - first));
      first += some.size();
      const std::vector<std::optional<Explanation>> whys = a_.explanations(some);
      std::size_t items = 1;
      for (const auto& why : whys)
        if (why) items = std::max(items, why->samples.size() + why->taps.size());
      chunk = std::clamp(most_items / items, std::size_t{1}, most_chunk);
      take(some, whys, samples.of(some, whys));
      for (const std::uint32_t i : some)
        if (causes_[i] == Cause::none) open.push_back(i);
    }
    return open;
  }

  void take(std::span<const std::uint32_t> pixels, std::span<const std::optional<Explanation>> whys,
            std::span<const Cause> by_samples) {
    std::vector<ExplainedPixel> with_taps;
    for (std::size_t k = 0; k < pixels.size(); ++k) {
      if (!whys[k]) continue;
      const bool has_taps = !whys[k]->taps.empty();
      Cause& cause = causes_[pixels[k]];
      cause = a_.named_cause(*whys[k]);
      if (cause == Cause::none && has_taps) with_taps.push_back({pixels[k], &*whys[k]});
      if (cause == Cause::none && !has_taps) cause = by_samples[k];
    }
    if (with_taps.empty()) return;
    // Maps are drawn from the light's center.
    Light center = a_.light;
    center.kind = PointLight{glm::vec3(homogeneous_of_center(a_.light))};
    Reference truth = a_.reference;
    truth.mask = truth_.share;
    const Attribution by_center{a_.scene, a_.casters, a_.gbuffer, center, truth, a_.mask, {}, nullptr};
    const LightRays rays(a_.scene, a_.casters, a_.gbuffer, center);
    const std::vector<Cause> found = find_tap_causes(by_center, rays, with_taps);
    for (std::size_t k = 0; k < found.size(); ++k) {
      causes_[with_taps[k].pixel] = found[k];
      if (found[k] == Cause::none) filter_taps_[with_taps[k].pixel] = with_taps[k].why->taps.size();
    }
  }

  /// What the mask shows.
  void examine_mask(std::span<const std::uint32_t> pixels) {
    for_blocks(pixels.size(), 16, [&](std::size_t begin, std::size_t end) {
      for (std::size_t k = begin; k < end; ++k) causes_[pixels[k]] = of_mask(pixels[k]);
    });
  }

  Cause of_mask(std::uint32_t i) const {
    const bool is_small = std::abs(error(i)) <= 3 * most_errors * truth_.error[i];
    if (is_small && is_right_after_all(i)) return Cause::reference_error;
    if (error(i) > 0 && shapes_.missing()[i]) return Cause::missing_caster;
    if (const Cause cause = shapes_.of_grain(i); cause != Cause::none) return cause;
    if (is_horizon(i)) return Cause::horizon;
    if (is_fusion(i)) return Cause::caster_fusion;
    if (const Cause cause = beside_larger_light(i); cause != Cause::none) return cause;
    if (const Cause cause = shapes_.of_form(i); cause != Cause::none) return cause;
    if (!is_small && is_right_after_all(i)) return Cause::reference_error;
    return is_of_few_taps(i) ? Cause::noise : Cause::unexplained;
  }

  /// In full light or umbra, or where the whole light is dimmed: would a light of four times the size see that much, or that
  /// little?
  Cause beside_larger_light(std::uint32_t i) const {
    const double v = a_.mask[i], share = truth_.share[i], slack = most_errors * truth_.error[i];
    const bool is_umbra = share <= slack, is_full = share >= 1 - slack, is_dimmed = shapes_.is_dimmed(i);
    if (!is_umbra && !is_full && !is_dimmed) return Cause::none;
    const std::optional<double> larger = seen_of_larger(a_, i);
    if (!larger) return Cause::none;
    // A larger light sees more of the casters and more past them.
    const auto [least, most] = is_dimmed ? std::minmax({*larger, share}) : std::pair(*larger, *larger);
    if ((is_umbra || is_dimmed) && v > most + slack) return Cause::lost_umbra;
    if ((is_full || is_dimmed) && v < least - slack) return Cause::region;
    return Cause::none;
  }

  /// Whether a filter represents the light, and so many taps as it has, on independent places, may err by as much.
  bool is_of_few_taps(std::uint32_t i) const {
    const auto taps = filter_taps_.find(i);
    if (taps == filter_taps_.end()) return false;
    const double n = static_cast<double>(taps->second), share = truth_.share[i];
    return std::abs(error(i)) <= 4 * std::sqrt(std::max(share * (1 - share), 1 / n) / n) + 1 / n;
  }

  /// Whether the reference, traced again by other rays, agrees with the mask.
  bool is_right_after_all(std::uint32_t i) const {
    const auto [again, again_error] = traced_again(a_, i, truth_.error[i]);
    return std::abs(a_.mask[i] - again) <= most_errors * again_error;
  }

  /// Whether the error is what comes of counting what is below the horizon, as hidden or as seen.
  bool is_horizon(std::uint32_t i) const {
    const double above = share_above_horizon(a_, i), share = truth_.share[i];
    return above < 1 && (is_predicted(i, -(1 - above) * share) || is_predicted(i, (1 - above) * (1 - share)));
  }
  bool is_fusion(std::uint32_t i) const {
    const CasterShares left = caster_shares(a_, i);
    return left.count > 1 && (is_predicted(i, left.product - left.together) || is_predicted(i, left.least - left.together));
  }
  /// Whether an error of this size leaves less than half of the pixel's.
  bool is_predicted(std::uint32_t i, double predicted) const { return std::abs(error(i) - predicted) < std::abs(error(i)) / 2; }

  /// Regions of at most four pixels are cracks.
  void split_regions() {
    std::vector<std::uint32_t> keys(causes_.size(), 0);
    for (std::size_t i = 0; i < keys.size(); ++i) keys[i] = causes_[i] == Cause::region;
    const Components regions = connect(keys, 0, a_.gbuffer.width, a_.gbuffer.height);
    for (std::size_t i = 0; i < keys.size(); ++i)
      if (keys[i] && regions.size[regions.of[i]] <= crack_size) causes_[i] = Cause::crack;
  }

  const Attribution& a_;
  const SoftTruth truth_;
  std::vector<Cause> causes_;
  std::unordered_map<std::uint32_t, std::size_t> filter_taps_;  ///< by pixel, where its footprint errs most
  PenumbraShapes shapes_;
};

}  // namespace

SoftTruth::SoftTruth(const Attribution& a)
    : share(a.estimates == LightShareKind::irradiance ? a.reference.irradiance : a.reference.mask),
      error(a.estimates == LightShareKind::irradiance ? a.reference.irradiance_error : a.reference.error) {}

std::vector<Cause> find_soft_causes(const Attribution& attribution) { return SoftCauses(attribution).find(); }

}  // namespace gnomon
