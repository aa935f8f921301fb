#include "measure/cause/causes_taps.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <numbers>

#include "measure/cause/tap_block.h"

namespace gnomon {

namespace {

/// Traces what a perfect map of the same texels would see, and then examines what the texels hold.
class PerfectMap {
 public:
  PerfectMap(const Attribution& a, const LightRays& rays, std::span<const ExplainedPixel> pixels, std::span<Cause> causes)
      : causes_(causes), block_{rays, snapping_grid(a.reference.subpixel_bits)} {
    for (const ExplainedPixel& c : pixels) {
      TapQuestion q{.pixel = c.pixel,
                    .mesh = a.gbuffer.mesh[c.pixel],
                    .why = c.why,
                    .is_missing = c.is_missing,
                    .is_dark = a.mask[c.pixel] < a.reference.mask[c.pixel],
                    .visibility = a.mask[c.pixel],
                    .reference = a.reference.mask[c.pixel],
                    .point = a.gbuffer.position(c.pixel),
                    .normal = a.gbuffer.normal(c.pixel),
                    .to_light = {},
                    .reach = 2 * std::numbers::sqrt2 * c.why->texel_width};
      q.kind = a.reference.kind;
      q.to_light = rays.toward_light(q.point);
      if (c.why->shifted) q.shift = on_plane(q, *c.why->shifted, -rays.toward_light(*c.why->shifted)) - q.point;
      q.first_tap = block_.places.size();
      for (const Tap& tap : c.why->taps) block_.places.push_back(on_plane(q, tap.origin, tap.direction));
      block_.questions.push_back(q);
    }
  }

  void answer() {
    // What a perfect map sees through the taps, at the shifted look-up and where the point itself is.
    block_.seen = block_.rays.shares(all_starts(false));
    std::vector<float> unshifted = block_.seen;
    if (std::ranges::any_of(block_.questions, [](const TapQuestion& q) { return q.why->shifted.has_value(); }))
      unshifted = block_.rays.shares(all_starts(true));
    for (std::size_t k = 0; k < block_.questions.size(); ++k) {
      const TapQuestion& q = block_.questions[k];
      const bool is_shifted = q.why->shifted.has_value();
      if (q.is_missing && !StoredTaps(block_, q).holds_caster())
        causes_[k] = Cause::missing_caster;
      else if (can_err(q, unshifted, is_shifted, all_weights(q)))
        causes_[k] = of_texels(q, unshifted, is_shifted);
      else if (is_shifted && can_err(q, block_.seen, false, all_weights(q)))
        causes_[k] = Cause::lookup_shift;
      else
        causes_[k] = StoredTaps(block_, q).cause();
    }
  }

  /// The largest of the three terms that have the error's sign decides: what is stored, the moved look-up, the footprint.
  void answer_soft() {
    block_.seen = block_.rays.shares(all_starts(false));
    const std::vector<float> unshifted = block_.rays.shares(all_starts(true));
    for (std::size_t k = 0; k < block_.questions.size(); ++k) {
      const TapQuestion& q = block_.questions[k];
      const Weights weights = all_weights(q);
      const auto lit_share = [&](std::span<const float> shares) {
        return weighted(weights, [&](std::size_t j) { return shares[q.first_tap + j]; });
      };
      const double sign = q.is_dark ? -1 : 1, shifted = lit_share(block_.seen), ideal = lit_share(unshifted);
      const double stored = sign * (q.visibility - shifted), moved = sign * (shifted - ideal);
      const bool is_footprint = sign * (ideal - q.reference) >= std::max(stored, moved);
      causes_[k] = is_footprint ? Cause::none : moved > stored ? Cause::lookup_shift : StoredTaps(block_, q).cause();
      if (causes_[k] == Cause::unexplained && !q.is_dark) causes_[k] = StoredTaps(block_, q).of_taps_alone();
    }
  }

 private:
  /// Where the line from `origin` along the unit `direction` cuts the pixel's tangent plane on the lit side. A ray that does
  /// not come down to the plane meets it beyond everything.
  glm::dvec3 on_plane(const TapQuestion& q, const glm::dvec3& origin, const glm::dvec3& direction) const {
    const double down = -glm::dot(q.normal, direction), farthest = block_.rays.beyond_everything(origin);
    const double t = down > 0 ? glm::dot(q.normal, origin - q.point) / down : INFINITY;
    return origin + std::clamp(t, -farthest, farthest) * direction;
  }

  /// From a place of the shifted look-up, or from where it is without the shift.
  static LightRays::Start start(const TapQuestion& q, const glm::dvec3& place, bool unshifted) {
    return {q.pixel, place - (unshifted ? q.shift : glm::dvec3(0)), q.reach};
  }
  std::vector<LightRays::Start> all_starts(bool unshifted) const {
    std::vector<LightRays::Start> starts;
    starts.reserve(block_.places.size());
    for (const TapQuestion& q : block_.questions)
      for (std::size_t j = 0; j < q.tap_count(); ++j) starts.push_back(start(q, block_.places[q.first_tap + j], unshifted));
    return starts;
  }

  /// Weights of a question's taps, in their order; 0 leaves one out.
  using Weights = std::vector<double>;
  /// The visibility that taps j of these weights make together of what share(j) says of each.
  template <class Share>
  static double weighted(const Weights& weights, const Share& share) {
    double sum = 0;
    for (std::size_t j = 0; j < weights.size(); ++j) sum += weights[j] * share(j);
    return sum;
  }
  static Weights all_weights(const TapQuestion& q) {
    Weights weights;
    for (const Tap& tap : q.why->taps) weights.push_back(tap.weight);
    return weights;
  }
  /// No filter: equal ones for the taps whose texel may hold the look-up point, which are within half a diagonal across the
  /// light's ray; where a filter has none there, for its nearest.
  Weights weights_at_point(const TapQuestion& q) const {
    std::vector<double> aside;
    for (std::size_t j = 0; j < q.tap_count(); ++j) {
      const glm::dvec3 way = block_.places[q.first_tap + j] - (q.point + q.shift);  // places are those of the moved look-up
      aside.push_back(glm::length(glm::cross(way, q.why->taps[j].direction)));
    }
    const double near = 1.001 * std::max(*std::ranges::min_element(aside), q.why->texel_width / std::numbers::sqrt2);
    const auto count = static_cast<double>(std::ranges::count_if(aside, [&](double d) { return d <= near; }));
    Weights weights;
    for (const double d : aside) weights.push_back(d <= near ? 1 / count : 0);
    return weights;
  }

  /// A perfect map of the same texels errs here, too: is it the texels, or how many of them the filter takes?
  Cause of_texels(const TapQuestion& q, std::span<const float> shares, bool unshifted) const {
    return can_err(q, shares, unshifted, weights_at_point(q)) ? Cause::edge_resolution : Cause::filter_width;
  }

  /// Whether a perfect map with these taps would be on the technique's side too. Where it would not be, taps within the
  /// raster's tolerance of an edge may count for the other side: snapping vertices to a grid moves an edge by at most half its
  /// side in each coordinate, and four shifts of twice that across the ray meet every half-plane that such a move can.
  bool can_err(const TapQuestion& q, std::span<const float> shares, bool unshifted, const Weights& weights) const {
    const auto plain = [&](std::size_t j) { return shares[q.first_tap + j]; };
    if (q.is_on_technique_side(weighted(weights, plain))) return true;
    const float side = q.is_dark ? 0 : 1;  // where the technique's answer lies, as seen from the reference's
    std::vector<LightRays::Start> starts;
    std::vector<std::size_t> tap;
    for (std::size_t j = 0; j < q.tap_count(); ++j) {
      if (plain(j) == side || weights[j] == 0) continue;
      for (const glm::dvec3& moved : block_.shaken(q, j)) {
        starts.push_back(start(q, moved, unshifted));
        tap.push_back(j);
      }
    }
    const std::vector<float> answers = block_.rays.shares(starts);
    std::vector<float> farthest(shares.begin() + static_cast<std::ptrdiff_t>(q.first_tap),
                                shares.begin() + static_cast<std::ptrdiff_t>(q.first_tap + q.tap_count()));
    for (std::size_t s = 0; s < starts.size(); ++s)
      farthest[tap[s]] = q.is_dark ? std::min(farthest[tap[s]], answers[s]) : std::max(farthest[tap[s]], answers[s]);
    // A map is drawn from triangles: with those, a tap may be lit behind the rim of an exact shape.
    const auto lets_through = [&](const LightRays::Start& from) { return block_.rays.triangles_let_through(from); };
    for (std::size_t s = 0; s < starts.size(); s += 4)
      if (const std::size_t j = tap[s]; !q.is_dark && farthest[j] < 1)
        if (lets_through(start(q, block_.places[q.first_tap + j], unshifted)) ||
            std::any_of(&starts[s], &starts[s] + 4, lets_through))
          farthest[j] = 1;
    // Holes have corners, which four shifts may miss.
    for (std::size_t s = 0; s < starts.size(); s += 4)
      if (const std::size_t j = tap[s]; farthest[j] != side)
        if (block_.rays.is_at_hole_border(start(q, block_.places[q.first_tap + j], unshifted),
                                          q.why->texel_width * block_.grid))
          farthest[j] = side;
    return q.is_on_technique_side(weighted(weights, [&](std::size_t j) { return farthest[j]; }));
  }

  std::span<Cause> causes_;
  TapBlock block_;
};

}  // namespace

std::array<glm::dvec3, 4> TapBlock::shaken(const TapQuestion& q, std::size_t j) const {
  const glm::dvec3 d = q.why->taps[j].direction;
  const double step = q.why->texel_width * grid + rays.rounding();
  const glm::dvec3 u = step * across(d)[0], v = glm::cross(d, u);
  const bool comes_down = glm::dot(q.normal, d) < 0;
  std::array<glm::dvec3, 4> moved;
  for (int k = 0; k < 4; ++k) {
    const glm::dvec3 w = (k % 2 ? -1.0 : 1.0) * (k / 2 ? v : u);
    moved[k] = places[q.first_tap + j] + w + (comes_down ? back_to_plane(w, d, q.normal) : glm::dvec3(0));
  }
  return moved;
}

std::vector<Cause> find_tap_causes(const Attribution& a, const LightRays& rays, std::span<const ExplainedPixel> pixels) {
  std::vector<Cause> causes(pixels.size(), Cause::unexplained);
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, pixels.size(), 64), [&](const auto& range) {
    const std::span<Cause> found = std::span(causes).subspan(range.begin(), range.size());
    PerfectMap map(a, rays, pixels.subspan(range.begin(), range.size()), found);
    a.reference.kind == AnswerKind::fraction ? map.answer_soft() : map.answer();
  });
  return causes;
}

}  // namespace gnomon
