// What the sampled places of the light say about a technique's error.
#include <gnomon/kit/area/area_rays.h>
#include <gnomon/kit/area/light_shape.h>
#include <gnomon/kit/parallel.h>

#include <algorithm>

#include "measure/cause/soft_causes.h"

namespace gnomon {

namespace {

/// Places of a light's figure for points on or before it.
struct FigurePlaces {
  const LightFigure& figure;
  glm::dvec3 axis = glm::cross(figure.half_u(), figure.half_v());
  glm::dvec3 across_v = glm::cross(figure.half_v(), axis), across_u = glm::cross(axis, figure.half_u());
  glm::dvec3 u = across_v / glm::dot(figure.half_u(), across_v), v = across_u / glm::dot(figure.half_v(), across_u);

  /// Where the way from the point meets the figure's plane; nothing where it does not.
  std::optional<glm::dvec2> at(const glm::dvec3& way) const {
    const double reach = glm::dot(axis, figure.center()) / glm::dot(axis, way);
    if (!(reach > 0 && std::isfinite(reach))) return std::nullopt;
    const glm::dvec3 off = reach * way - figure.center();
    return glm::dvec2(glm::dot(off, u), glm::dot(off, v));
  }
  bool is_on_light(const glm::dvec2& place) const {
    constexpr double most = 1 + 1e-3;
    return figure.is_disc() ? glm::dot(place, place) <= most * most : std::max(std::abs(place.x), std::abs(place.y)) <= most;
  }
};

/// The samples of one pixel beside the reference's answers at the same places.
struct Answers {
  double weight = 0, lit = 0;                    ///< sums of weights: of all; of those seen, as sampled below the horizon
  double weight_above = 0, lit_above = 0;        ///< of those above the horizon
  bool is_on_light = true, is_one_place = true;  ///< every one; all of them
  bool is_cut = false;                           ///< some of the light is below the horizon
  double spread = 1;                             ///< squares of places, to those of places all over the figure
  glm::dvec2 mean{0};                            ///< place
};

Answers trace_samples(const Attribution& a, std::uint32_t pixel, const Explanation& why) {
  const glm::dvec3 point = a.gbuffer.position(pixel);
  const LightFigure figure(a.light, point, a.gbuffer.normal(pixel));
  const FaceRays rays(a.casters, a.gbuffer, pixel, figure);
  const FigurePlaces places{figure};
  const LightFigure::Box& box = figure.box();
  const glm::dvec3& horizon = figure.horizon();
  Answers sums;
  sums.is_cut = horizon.x - std::abs(horizon.y) - std::abs(horizon.z) < 0;
  double squares_sum = 0;
  const std::span<const LightSample> all = why.samples;
  for (std::size_t first = 0; first < all.size(); first += 16) {
    const auto some = all.subspan(first, std::min<std::size_t>(16, all.size() - first));
    Squares squares{};
    std::uint32_t above_horizon = 0;
    for (std::size_t k = 0; k < some.size(); ++k) {
      sums.is_one_place &= glm::distance(some[k].place, all[0].place) <= 1e-6 * glm::length(figure.half_u());
      const std::optional<glm::dvec2> place = places.at(some[k].place - point);
      const bool is_on_light = place && places.is_on_light(*place);
      sums.is_on_light &= is_on_light;
      if (!is_on_light) continue;
      sums.mean += *place / static_cast<double>(all.size());
      squares_sum += glm::dot(*place, *place);
      if (!(line_at(horizon, *place) > 0)) continue;
      above_horizon |= 1u << k;
      const glm::dvec2 along = glm::clamp((*place - box.low) / (box.high - box.low), 0.0, 1.0);
      squares.x[k] = static_cast<float>(along.x);
      squares.y[k] = static_cast<float>(along.y);
    }
    const FaceHits hits = rays.ask(squares, above_horizon);
    for (std::size_t k = 0; k < some.size(); ++k) {
      const bool is_traced = hits.asked >> k & 1;
      const double seen = is_traced ? hits.seen(static_cast<int>(k)) : some[k].visibility;
      sums.weight += some[k].weight;
      sums.lit += some[k].weight * seen;
      if (!is_traced) continue;
      sums.weight_above += some[k].weight;
      sums.lit_above += some[k].weight * seen;
    }
  }
  // Over a square of side 2 the mean of s^2 + t^2 is 2/3, over a disc of radius 1 it is 1/2.
  sums.spread = squares_sum / static_cast<double>(all.size()) / (figure.is_disc() ? 1.0 / 2 : 2.0 / 3);
  return sums;
}

/// Whether n places are spread as places all over the figure may be. The mean of s^2 + t^2 has the relative deviation
/// sqrt(1/3 / n) on a disc and sqrt(2/5 / n) on a square; the mean of s has sqrt(1/4 / n) and sqrt(1/3 / n).
bool is_spread_as_light(const Answers& answers, std::size_t n) {
  const double count = static_cast<double>(n);
  return std::abs(answers.spread - 1) <= 4 * std::sqrt(0.4 / count) && glm::length(answers.mean) <= 4 * std::sqrt(0.67 / count);
}

}  // namespace

Cause SampleCauses::of(std::uint32_t pixel, const Explanation& why, bool is_shared) const {
  const Answers answers = trace_samples(a_, pixel, why);
  if (!(answers.weight > 0)) return Cause::none;
  const double v = a_.mask[pixel], share = truth_.share[pixel], sign = v < share ? -1 : 1;
  const double with_all = answers.lit / answers.weight;
  const double above = answers.weight_above > 0 ? answers.lit_above / answers.weight_above : share;
  const double sampled = sign * (v - with_all), horizon = sign * (with_all - above), placed = sign * (above - share);
  if (sampled > std::max(horizon, placed)) return Cause::false_sample;
  if (horizon > placed) return Cause::horizon;
  if (!answers.is_on_light) return Cause::none;
  if (answers.is_one_place) return is_shared ? Cause::hard_shadow : Cause::noise;
  // What n places may err by: four deviations of as many independent ones, and one place more or less.
  const auto n = static_cast<double>(why.samples.size());
  if (placed > 4 * std::sqrt(std::max(share * (1 - share), 1 / n) / n) + 1 / n) return Cause::none;
  if (!answers.is_cut && !is_spread_as_light(answers, why.samples.size())) return Cause::none;
  return is_shared ? Cause::banding : Cause::noise;
}

bool SampleCauses::share_places(std::uint32_t pixel, const Explanation& why, std::uint32_t before,
                                const Explanation& why_before) const {
  if (why.samples.size() != why_before.samples.size()) return false;
  const glm::dvec3 point = a_.gbuffer.position(pixel), point_before = a_.gbuffer.position(before);
  const LightFigure figure(a_.light, point, a_.gbuffer.normal(pixel));
  const double size = std::max(glm::length(figure.half_u()), glm::length(figure.half_v()));
  double sum = 0;
  for (std::size_t j = 0; j < why.samples.size(); ++j) sum += glm::distance(why.samples[j].place, why_before.samples[j].place);
  // On a sphere the disc that is seen turns with the point by as much as the way to it does.
  double turned = 0;
  if (!LightShape(a_.light).is_flat())
    turned = 2 * size * glm::distance(point, point_before) / std::max(glm::length(figure.center()), size);
  return sum / static_cast<double>(why.samples.size()) <= std::min(0.02 * size + turned, 0.2 * size);
}

std::vector<Cause> SampleCauses::of(std::span<const std::uint32_t> pixels, std::span<const std::optional<Explanation>> whys) {
  const auto has_samples = [&](std::size_t k) { return whys[k] && !whys[k]->samples.empty(); };
  // A pixel whose left neighbor is not among them is as the one before it.
  std::vector<std::uint8_t> is_shared(pixels.size());
  std::size_t first_known = pixels.size();
  for (std::size_t k = 0; k < pixels.size(); ++k) {
    if (k > 0 && pixels[k] == pixels[k - 1] + 1 && has_samples(k) && has_samples(k - 1)) {
      is_shared_ = share_places(pixels[k], *whys[k], pixels[k - 1], *whys[k - 1]);
      first_known = std::min(first_known, k);
    }
    is_shared[k] = is_shared_;
  }
  for (std::size_t k = 0; k < first_known && first_known < pixels.size(); ++k) is_shared[k] = is_shared[first_known];
  std::vector<Cause> causes(pixels.size(), Cause::none);
  for_blocks(pixels.size(), 8, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k)
      if (has_samples(k)) causes[k] = of(pixels[k], *whys[k], is_shared[k]);
  });
  return causes;
}

}  // namespace gnomon
