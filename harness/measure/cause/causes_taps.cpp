#include "measure/cause/causes_taps.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace gnomon {

namespace {

/// One wrong pixel on its way through the steps.
struct Question {
  std::uint32_t pixel;
  const Explanation* why;
  bool is_dark;  ///< false dark; else false lit
  double visibility, reference;
  glm::dvec3 point, normal, to_light;  ///< to_light is unit
  double reach;                        ///< two texel diagonals, meters
  glm::dvec3 shift{0};                 ///< from the point to where the shifted look-up's ray cuts the tangent plane
  std::size_t first_tap = 0;           ///< in the block's flat list

  /// One half is dark; sums of weights are of floats.
  bool is_on_technique_side(double v) const { return (v > 0.5 + 1e-6) != is_dark; }
  std::size_t tap_count() const { return why->taps.size(); }
};

/// A few pixels at once, so that their rays fill packets.
class Block {
 public:
  Block(const Attribution& a, const LightRays& rays, std::span<const TapCase> cases, std::span<Cause> causes)
      : rays_(rays), causes_(causes), grid_(snapping_grid(a.reference.subpixel_bits)) {
    for (const TapCase& c : cases) {
      Question q{.pixel = c.pixel,
                 .why = c.why,
                 .is_dark = a.mask[c.pixel] < a.reference.mask[c.pixel],
                 .visibility = a.mask[c.pixel],
                 .reference = a.reference.mask[c.pixel],
                 .point = a.gbuffer.position(c.pixel),
                 .normal = a.gbuffer.normal(c.pixel),
                 .to_light = {},
                 .reach = 2 * std::numbers::sqrt2 * c.why->texel_width};
      q.to_light = rays.toward_light(q.point);
      if (c.why->shifted) q.shift = on_plane(q, *c.why->shifted, -rays.toward_light(*c.why->shifted)) - q.point;
      q.first_tap = places_.size();
      for (const Tap& tap : c.why->taps) places_.push_back(on_plane(q, tap.origin, tap.direction));
      mesh_.push_back(a.gbuffer.mesh[c.pixel]);
      questions_.push_back(q);
    }
  }

  void answer() {
    // What a perfect map sees through the taps, at the shifted look-up and where the point itself is.
    seen_ = rays_.lit(all_starts(false));
    std::vector<std::uint8_t> unshifted = seen_;
    if (std::ranges::any_of(questions_, [](const Question& q) { return q.why->shifted.has_value(); }))
      unshifted = rays_.lit(all_starts(true));
    for (std::size_t k = 0; k < questions_.size(); ++k) {
      const Question& q = questions_[k];
      const bool is_shifted = q.why->shifted.has_value();
      if (can_err(q, unshifted, is_shifted))
        causes_[k] = Cause::edge_resolution;
      else if (is_shifted && can_err(q, seen_, false))
        causes_[k] = Cause::lookup_shift;
      else
        causes_[k] = q.is_dark ? of_false_dark(q, mesh_[k]) : of_false_lit(q);
    }
  }

  /// The largest of the three terms that have the error's sign decides: what is stored, the moved look-up, the footprint.
  void answer_soft() {
    seen_ = rays_.lit(all_starts(false));
    const std::vector<std::uint8_t> unshifted = rays_.lit(all_starts(true));
    for (std::size_t k = 0; k < questions_.size(); ++k) {
      const Question& q = questions_[k];
      const double sign = q.is_dark ? -1 : 1, shifted = mean(q, seen_), ideal = mean(q, unshifted);
      const double stored = sign * (q.visibility - shifted), moved = sign * (shifted - ideal);
      if (sign * (ideal - q.reference) >= std::max(stored, moved))
        causes_[k] = Cause::none;
      else if (moved > stored)
        causes_[k] = Cause::lookup_shift;
      else
        causes_[k] = q.is_dark ? of_false_dark(q, mesh_[k]) : of_false_lit(q);
      if (causes_[k] == Cause::unexplained && !q.is_dark) causes_[k] = of_taps_alone(q);
    }
  }

 private:
  /// Where the line from `origin` along the unit `direction` cuts the pixel's tangent plane on the lit side. A ray that does
  /// not come down to the plane meets it beyond everything.
  glm::dvec3 on_plane(const Question& q, const glm::dvec3& origin, const glm::dvec3& direction) const {
    const double down = -glm::dot(q.normal, direction), farthest = rays_.beyond_everything(origin);
    const double t = down > 0 ? glm::dot(q.normal, origin - q.point) / down : INFINITY;
    return origin + std::clamp(t, -farthest, farthest) * direction;
  }

  std::vector<LightRays::Start> all_starts(bool unshifted) const {
    std::vector<LightRays::Start> starts;
    starts.reserve(places_.size());
    for (const Question& q : questions_)
      for (std::size_t j = 0; j < q.tap_count(); ++j)
        starts.push_back({q.pixel, places_[q.first_tap + j] - (unshifted ? q.shift : glm::dvec3(0)), q.reach});
    return starts;
  }

  /// What taps with these answers give.
  static double mean(const Question& q, std::span<const std::uint8_t> lit) {
    double v = 0;
    for (std::size_t j = 0; j < q.tap_count(); ++j)
      if (lit[q.first_tap + j]) v += q.why->taps[j].weight;
    return v;
  }

  /// Whether a perfect map with these taps would be on the technique's side too. Where it would not be, taps within the
  /// raster's tolerance of an edge may count for the other side: snapping vertices to a grid moves an edge by at most half its
  /// side in each coordinate, and four shifts of twice that across the ray meet every half-plane that such a move can.
  bool can_err(const Question& q, std::span<const std::uint8_t> lit, bool unshifted) const {
    const auto mean = [&](auto&& is_lit) {
      double v = 0;
      for (std::size_t j = 0; j < q.tap_count(); ++j)
        if (is_lit(j)) v += q.why->taps[j].weight;
      return v;
    };
    const auto plain = [&](std::size_t j) { return lit[q.first_tap + j] != 0; };
    if (q.is_on_technique_side(mean(plain))) return true;
    const glm::dvec3 back = unshifted ? q.shift : glm::dvec3(0);
    const auto start_of = [&](std::size_t j) { return LightRays::Start{q.pixel, places_[q.first_tap + j] - back, q.reach}; };
    std::vector<LightRays::Start> starts;
    std::vector<std::size_t> tap;
    for (std::size_t j = 0; j < q.tap_count(); ++j) {
      if (plain(j) != q.is_dark) continue;
      for (const glm::dvec3& moved : shaken(q, j)) {
        starts.push_back({q.pixel, moved - back, q.reach});
        tap.push_back(j);
      }
    }
    const std::vector<std::uint8_t> answers = rays_.lit(starts);
    std::vector<std::uint8_t> flips(q.tap_count(), 0);
    for (std::size_t s = 0; s < starts.size(); ++s) flips[tap[s]] |= (answers[s] != 0) != q.is_dark;
    // A map is drawn from triangles: with those, a tap may be lit behind the rim of an exact shape.
    for (std::size_t s = 0; s < starts.size(); s += 4)
      if (!q.is_dark && !flips[tap[s]])
        flips[tap[s]] =
            rays_.triangles_let_through(start_of(tap[s])) ||
            std::any_of(&starts[s], &starts[s] + 4, [&](const auto& start) { return rays_.triangles_let_through(start); });
    return q.is_on_technique_side(mean([&](std::size_t j) { return plain(j) != (flips[j] != 0); }));
  }

  /// The tap's place on the tangent plane with its ray moved by the grid's side and float32 rounding, four ways.
  std::array<glm::dvec3, 4> shaken(const Question& q, std::size_t j) const {
    const glm::dvec3 d = q.why->taps[j].direction, place = places_[q.first_tap + j];
    const double step = q.why->texel_width * grid_ + rays_.rounding();
    const glm::dvec3 u = step * across(d)[0], v = glm::cross(d, u);
    const bool comes_down = glm::dot(q.normal, d) < 0;
    std::array<glm::dvec3, 4> moved;
    for (int k = 0; k < 4; ++k) {
      const glm::dvec3 w = (k % 2 ? -1.0 : 1.0) * (k / 2 ? v : u);
      moved[k] = place + w + (comes_down ? back_to_plane(w, d, q.normal) : glm::dvec3(0));
    }
    return moved;
  }

  /// How far a tap's stored surface stands behind the point, along the tap's ray; or behind the receiver's plane there.
  double behind(const Question& q, std::size_t j, bool is_from_plane) const {
    const Tap& tap = q.why->taps[j];
    return tap.stored - glm::dot((is_from_plane ? places_[q.first_tap + j] : q.point) - tap.origin, tap.direction);
  }
  /// Whether the mask's value is what comparing with the receiver's plane gives, rather than with the point.
  bool compares_with_plane(const Question& q) const {
    const auto error = [&](bool is_from_plane) {
      double lit = 0;
      for (std::size_t j = 0; j < q.tap_count(); ++j)
        if (behind(q, j, is_from_plane) >= -q.why->bias) lit += q.why->taps[j].weight;
      return std::abs(lit - q.visibility);
    };
    return error(true) < error(false);
  }

  /// The taps that made the pixel dark (or lit): those whose stored surface stands farthest before (or least before) what it is
  /// compared with, by weight until the mask's value is reached. Taps that the reference agrees with are no part of the error.
  std::vector<std::size_t> guilty(const Question& q, bool is_from_plane) const {
    std::vector<std::pair<double, std::size_t>> by_margin;
    for (std::size_t j = 0; j < q.tap_count(); ++j) {
      const double margin = behind(q, j, is_from_plane);
      by_margin.emplace_back(q.is_dark ? margin : -margin, j);
    }
    std::ranges::sort(by_margin);
    double weight = q.is_dark ? 1 - q.visibility : q.visibility;
    std::vector<std::size_t> all, result;
    for (const auto& [margin, j] : by_margin) {
      if (weight <= 1e-6) break;  // masks are float32, and a pixel may have hundreds of taps
      weight -= q.why->taps[j].weight;
      all.push_back(j);
      if ((seen_[q.first_tap + j] != 0) == q.is_dark) result.push_back(j);
    }
    return result.empty() ? all : result;
  }

  /// The object that a tap's stored depth was drawn from: a surface within two diagonals of it on the tap's ray, or on a shaken
  /// one; no_mesh where there is none.
  std::uint32_t stored_mesh(const Question& q, std::size_t j) const {
    const Tap& tap = q.why->taps[j];
    const glm::dvec3 stored = tap.origin + tap.stored * tap.direction;
    LightRays::Surface best = rays_.surface_at(stored, tap.direction);
    if (best.off > q.reach)
      for (const glm::dvec3& moved : shaken(q, j)) {
        const glm::dvec3 aside = moved - places_[q.first_tap + j];
        const LightRays::Surface other =
            rays_.surface_at(stored + aside - glm::dot(aside, tap.direction) * tap.direction, tap.direction);
        if (other.off < best.off) best = other;
      }
    return best.off <= q.reach || best.is_shape ? best.mesh : no_mesh;
  }

  /// What a tap's depth stands for: the surface that it was drawn from, or where it lies on none, as midpoints of two do, the
  /// first surface on the tap's ray, if that lies before it.
  struct Stored {
    std::uint32_t mesh = no_mesh;
    glm::dvec3 at{0};
  };
  Stored stored_surface(const Question& q, std::size_t j) const {
    const Tap& tap = q.why->taps[j];
    const Stored drawn{stored_mesh(q, j), tap.origin + tap.stored * tap.direction};
    if (drawn.mesh != no_mesh) return drawn;
    const glm::dvec3 place = places_[q.first_tap + j];
    const double above = rays_.farthest_along(place, -tap.direction);
    const glm::dvec3 first = place - above * tap.direction;
    if (!std::isfinite(above) || !(glm::dot(first - tap.origin, tap.direction) < tap.stored)) return {};
    return {rays_.surface_at(first, tap.direction).mesh, first};
  }

  /// A perfect map would be lit here: what is stored is at fault.
  Cause of_false_dark(const Question& q, std::uint32_t own) const {
    bool is_over_dark = false;
    for (const std::size_t j : guilty(q, false)) {
      const Tap& tap = q.why->taps[j];
      if (!std::isfinite(tap.stored)) continue;
      const auto [mesh, stored] = stored_surface(q, j);
      if (mesh == no_mesh) continue;
      if (mesh != own) {
        is_over_dark = true;
        continue;
      }
      // The tap's place is at most as far from the point as half the filter's diagonal, stretched by the slope; a surface that
      // the reference does not count is within two diagonals of it.
      const double k = filter_radius(q), facing = std::max(glm::dot(q.normal, q.to_light), 1e-3);
      const double reach =
          std::max((k + 1) * q.reach / facing, (k + 0.5) * std::numbers::sqrt2 * q.why->texel_width / facing + q.reach);
      if (glm::distance(stored, q.point + q.shift) <= reach + rays_.rounding()) return Cause::acne;
    }
    return is_over_dark ? Cause::over_dark : Cause::unexplained;
  }

  /// A perfect map would be dark here: the occluders were skipped, or the technique did not believe them.
  Cause of_false_lit(const Question& q) const {
    const double reach = q.why->bias + q.reach;
    const double near = rays_.nearest(q.pixel).distance, far = rays_.farthest(q.pixel);
    if (near == INFINITY && far == INFINITY) return Cause::unexplained;
    if (far <= reach) return Cause::peter_panning;
    if (near <= reach) return Cause::leak_layered;
    // The same seen through the taps: all that covers one of them is inside the reach of the bias there, which a sloping
    // receiver makes longer by what its plane falls from the point to the tap's place.
    const auto is_layered_at = [&](std::size_t j) {
      const glm::dvec3 place = places_[q.first_tap + j], to_light = rays_.toward_light(place);
      const double fall = std::max(0.0, glm::dot(q.point - place, to_light));
      return rays_.farthest_along(place, to_light) <= reach + fall;
    };
    const bool is_layered = std::ranges::any_of(guilty(q, false), is_layered_at) ||
                            (compares_with_plane(q) && std::ranges::any_of(guilty(q, true), is_layered_at));
    return is_layered ? Cause::leak_layered : Cause::leak_representation;
  }

  /// False lit where the light's point is seen from the pixel and hidden at the taps: by what covers those.
  Cause of_taps_alone(const Question& q) const {
    const double reach = q.why->bias + q.reach;
    const std::vector<std::size_t> taps = guilty(q, false);
    if (taps.empty()) return Cause::unexplained;
    const bool is_near = std::ranges::all_of(taps, [&](std::size_t j) {
      const glm::dvec3 place = places_[q.first_tap + j], to_light = rays_.toward_light(place);
      return rays_.farthest_along(place, to_light) <= reach + std::max(0.0, glm::dot(q.point - place, to_light));
    });
    return is_near ? Cause::peter_panning : Cause::leak_representation;
  }

  /// Half the side of a square of as many texels, less one half: 0 for one tap.
  static double filter_radius(const Question& q) { return (std::ceil(std::sqrt(double(q.tap_count()))) - 1) / 2; }

  const LightRays& rays_;
  std::span<Cause> causes_;
  double grid_;  ///< of the raster, texels
  std::vector<Question> questions_;
  std::vector<std::uint32_t> mesh_;  ///< of each question's receiver
  std::vector<glm::dvec3> places_;   ///< of all taps of all questions, on their tangent planes
  std::vector<std::uint8_t> seen_;   ///< 1 where the reference sees the light from there
};

std::vector<Cause> ask(const Attribution& attribution, const LightRays& rays, std::span<const TapCase> cases,
                       void (Block::*answer)()) {
  std::vector<Cause> causes(cases.size(), Cause::unexplained);
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, cases.size(), 64), [&](const auto& range) {
    Block block(attribution, rays, cases.subspan(range.begin(), range.size()),
                std::span(causes).subspan(range.begin(), range.size()));
    (block.*answer)();
  });
  return causes;
}

}  // namespace

std::vector<Cause> find_tap_causes(const Attribution& attribution, const LightRays& rays, std::span<const TapCase> cases) {
  return ask(attribution, rays, cases, &Block::answer);
}

std::vector<Cause> find_soft_tap_causes(const Attribution& attribution, const LightRays& rays, std::span<const TapCase> cases) {
  return ask(attribution, rays, cases, &Block::answer_soft);
}

}  // namespace gnomon
