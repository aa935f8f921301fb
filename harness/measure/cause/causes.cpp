#include "measure/cause/causes.h"

#include <algorithm>
#include <cassert>
#include <numbers>

#include "measure/cause/causes_taps.h"
#include "measure/cause/components.h"
#include "measure/cause/own_causes.h"
#include "measure/cause/soft_causes.h"
#include "measure/cause/whole_mask.h"
#include "measure/frame/boundary.h"

namespace gnomon {

namespace {

constexpr float edge_width = 1.5f;  ///< pixels
/// Pixels explained at a time: hundreds of taps each are held in memory.
constexpr std::size_t chunk = 4096;

/// Of each start, whether the light's answer there would be wrong for its pixel, joined over every `per_pixel` starts in a row:
/// 1 where it is for any of them.
std::vector<std::uint8_t> any_differs(const Attribution& a, const LightRays& rays, std::span<const LightRays::Start> starts,
                                      std::size_t per_pixel) {
  const std::vector<float> shares = rays.shares(starts);
  std::vector<std::uint8_t> differs(starts.size() / per_pixel, 0);
  for (std::size_t s = 0; s < starts.size(); ++s)
    differs[s / per_pixel] |= is_wrong(shares[s], a.reference.mask[starts[s].pixel], a.reference.kind);
  return differs;
}

/// 1 where the reference answers otherwise within the raster's snapping of the pixel's center, though no other pixel shows it:
/// a shadow thinner than a pixel. Snapping to a grid moves an edge by at most half its side in each coordinate, and four
/// shifts of twice that meet every half-plane that such a move can. Two things are snapped: the receiver, so the point moves
/// across the view ray; and what hides the light, so the light's ray moves by as much across itself, which under grazing light
/// is a long way on the receiver.
std::vector<std::uint8_t> is_on_thin_edge(const Attribution& a, const LightRays& rays, std::span<const std::uint32_t> pixels) {
  const glm::dvec3 eye = a.gbuffer.view.eye;
  const double per_meter = 2 * std::tan(glm::radians(double(a.gbuffer.view.fov_y_degrees)) / 2) / a.gbuffer.height;
  std::vector<LightRays::Start> starts;
  for (const std::uint32_t i : pixels) {
    const glm::dvec3 point = a.gbuffer.position(i), n = a.gbuffer.normal(i), from_eye = point - eye;
    const glm::dvec3 v = glm::normalize(from_eye);
    const double step = glm::length(from_eye) * per_meter * snapping_grid(a.reference.subpixel_bits) + rays.rounding();
    for (const glm::dvec3& along : {v, rays.toward_light(point)}) {
      const glm::dvec3 u = step * across(along)[0], w = glm::cross(along, u);
      for (const glm::dvec3& move : {u, -u, w, -w}) starts.push_back({i, point + move + back_to_plane(move, along, n), 0});
    }
  }
  return any_differs(a, rays, starts, 8);
}

/// 1 where the reference answers otherwise when the light's ray moves across itself by up to the error of the outline: sixteen
/// ways, the whole of it and half. A convex outline that is nearer than the error is met by one of them.
std::vector<std::uint8_t> is_within_outline_error(const Attribution& a, const LightRays& rays,
                                                  std::span<const ExplainedPixel> pixels) {
  constexpr int ways = 16;
  std::vector<LightRays::Start> starts;
  for (const ExplainedPixel& at : pixels) {
    const glm::dvec3 point = a.gbuffer.position(at.pixel), n = a.gbuffer.normal(at.pixel), to = rays.toward_light(point);
    const auto [u, w] = across(to);
    for (int k = 0; k < 2 * ways; ++k) {
      // The nearest of sixteen ways is at most 11.25 degrees off the one to the edge.
      const double angle = k * std::numbers::pi / (ways / 2);
      const double step = (k < ways ? 1.02 : 0.51) * at.why->outline_error + rays.rounding();
      const glm::dvec3 move = step * (std::cos(angle) * u + std::sin(angle) * w);
      starts.push_back({at.pixel, point + move + back_to_plane(move, to, n), 0});
    }
  }
  return any_differs(a, rays, starts, 2 * ways);
}

/// Causes of a technique without taps: by distance to the reference's edge and by size.
void find_regions(const Attribution& a, const LightRays& rays, std::span<const std::uint32_t> pixels, std::span<Cause> causes) {
  const int width = a.gbuffer.width, height = a.gbuffer.height;
  const std::vector<float> to_edge = distance_transform(
      shadow_boundary(a.reference.mask, a.reference.classes, width, height, a.reference.kind), width, height);
  const Cause at_edge = a.rasterizes ? Cause::edge_raster : Cause::edge;
  std::vector<std::uint32_t> candidates, far_away(a.mask.size(), 0);
  for (const std::uint32_t i : pixels) {
    causes[i] = at_edge;
    if (to_edge[i] > edge_width) candidates.push_back(i);
  }
  const std::vector<std::uint8_t> thin = is_on_thin_edge(a, rays, candidates);
  for (std::size_t k = 0; k < candidates.size(); ++k) far_away[candidates[k]] = !thin[k];
  const Components regions = connect(far_away, 0, width, height);
  for (const std::uint32_t i : candidates)
    if (far_away[i]) causes[i] = regions.size[regions.of[i]] <= crack_size ? Cause::crack : Cause::region;
}

}  // namespace

Cause Attribution::found_without_technique(std::size_t i) const {
  if (whole && whole->explains(*this, i)) return whole->cause();
  return !right_on_mesh.empty() && right_on_mesh[i] ? Cause::tessellation : Cause::none;
}

std::vector<std::optional<Explanation>> Attribution::explanations(std::span<const std::uint32_t> pixels) const {
  if (!explain) return std::vector<std::optional<Explanation>>(pixels.size());
  std::vector<std::optional<Explanation>> whys = explain(pixels);
  if (whys.size() != pixels.size()) throw Error("{} explanations were given for {} pixels", whys.size(), pixels.size());
  return whys;
}

Cause Attribution::named_cause(const Explanation& why) const {
  if (!why.covered) return Cause::beyond_coverage;
  if (why.formula_differs) return Cause::formula;
  return why.cause.empty() ? Cause::none : own_cause_named(why.cause, own_causes);
}

std::vector<Cause> find_causes(const Attribution& a) {
  assert(a.mask.size() == a.gbuffer.size() && a.reference.mask.size() == a.mask.size());
  assert(a.reference.classes.size() == a.mask.size());
  if (a.reference.kind == AnswerKind::fraction) return find_soft_causes(a);
  std::vector<Cause> causes(a.mask.size(), Cause::none);
  std::vector<std::uint32_t> open;
  for (std::uint32_t i = 0; i < causes.size(); ++i) {
    if (a.reference.classes[i] != PixelClass::T || !is_wrong(a.mask[i], a.reference.mask[i], a.reference.kind)) continue;
    causes[i] = a.found_without_technique(i);
    if (causes[i] == Cause::none) open.push_back(i);
  }
  if (open.empty()) return causes;

  const bool is_through_glass = a.reference.kind == AnswerKind::transmitted;
  const std::vector<std::uint8_t> missing = missing_shadows(
      a.reference.nearest_caster, a.gbuffer.width, a.gbuffer.height,
      [&](std::size_t i) { return is_through_glass ? 1.0 - a.reference.mask[i] : 1; },
      [&](std::size_t i) { return is_through_glass ? 1.0 - a.mask[i] : !is_lit(a.mask[i]); });
  const LightRays rays(a.scene, a.casters, a.gbuffer, a.light);
  for (std::size_t first = 0; first < open.size(); first += chunk) {
    const auto pixels = std::span(open).subspan(first, std::min(chunk, open.size() - first));
    const std::vector<std::optional<Explanation>> whys = a.explanations(pixels);
    std::vector<ExplainedPixel> with_taps, with_outlines;
    for (std::size_t k = 0; k < pixels.size(); ++k) {
      const std::uint32_t i = pixels[k];
      const auto& why = whys[k];
      const bool is_missing = a.mask[i] > a.reference.mask[i] && missing[i];
      if (why) causes[i] = a.named_cause(*why);
      if (causes[i] != Cause::none) continue;
      if (why && !why->taps.empty())
        with_taps.push_back({i, &*why, is_missing});
      else if (is_missing)
        causes[i] = Cause::missing_caster;
      else if (why && why->outline_error > 0)
        with_outlines.push_back({i, &*why});
    }
    const std::vector<std::uint8_t> within = is_within_outline_error(a, rays, with_outlines);
    for (std::size_t k = 0; k < within.size(); ++k)
      if (within[k]) causes[with_outlines[k].pixel] = Cause::tessellation;
    const std::vector<Cause> found = find_tap_causes(a, rays, with_taps);
    for (std::size_t k = 0; k < found.size(); ++k) causes[with_taps[k].pixel] = found[k];
  }
  std::erase_if(open, [&](std::uint32_t i) { return causes[i] != Cause::none; });
  if (!open.empty()) find_regions(a, rays, open, causes);
  return causes;
}

}  // namespace gnomon
