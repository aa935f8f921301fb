// What a map's texels hold at a wrong pixel, and what is wrong with that.
#include <algorithm>
#include <numbers>

#include "measure/cause/tap_block.h"

namespace gnomon {

/// How far a tap's stored surface is behind the point, along the tap's ray; or behind the receiver's plane there.
double StoredTaps::behind(std::size_t j, bool is_from_plane) const {
  const Tap& tap = q_.why->taps[j];
  return tap.stored - glm::dot((is_from_plane ? place(j) : q_.point) - tap.origin, tap.direction);
}

/// Whether the mask's value is what comparing with the receiver's plane gives, rather than with the point.
bool StoredTaps::compares_with_plane() const {
  const auto error = [&](bool is_from_plane) {
    double lit = 0;
    for (std::size_t j = 0; j < q_.tap_count(); ++j)
      if (behind(j, is_from_plane) >= -q_.why->bias) lit += q_.why->taps[j].weight;
    return std::abs(lit - q_.visibility);
  };
  return error(true) < error(false);
}

/// The taps that made the pixel dark (or lit): those whose stored surface is farthest before (or least before) what it is
/// compared with, by weight until the mask's value is reached. Taps that the reference agrees with are no part of the error.
std::vector<std::size_t> StoredTaps::guilty(bool is_from_plane) const {
  std::vector<std::pair<double, std::size_t>> by_margin;
  for (std::size_t j = 0; j < q_.tap_count(); ++j) {
    const double margin = behind(j, is_from_plane);
    by_margin.emplace_back(q_.is_dark ? margin : -margin, j);
  }
  std::ranges::sort(by_margin);
  double weight = q_.is_dark ? 1 - q_.visibility : q_.visibility;
  std::vector<std::size_t> all, result;
  for (const auto& [margin, j] : by_margin) {
    if (weight <= 1e-6) break;  // masks are float32, and a pixel may have hundreds of taps
    weight -= q_.why->taps[j].weight;
    all.push_back(j);
    if ((block_.seen[q_.first_tap + j] > 0) == q_.is_dark) result.push_back(j);
  }
  return result.empty() ? all : result;
}

/// The object that a tap's stored depth was drawn from: a surface within two diagonals of it on the tap's ray, or on a shaken
/// one; or one with an alpha mask that the ray meets so near in a hole; no_mesh where there is none.
std::uint32_t StoredTaps::stored_mesh(std::size_t j) const {
  const Tap& tap = q_.why->taps[j];
  const glm::dvec3 stored = tap.origin + tap.stored * tap.direction;
  LightRays::Surface best = rays_.surface_at(stored, tap.direction);
  if (best.off > q_.reach)
    for (const glm::dvec3& moved : block_.shaken(q_, j)) {
      const glm::dvec3 aside = moved - place(j);
      const LightRays::Surface other =
          rays_.surface_at(stored + aside - glm::dot(aside, tap.direction) * tap.direction, tap.direction);
      if (other.off < best.off) best = other;
    }
  if (best.off <= q_.reach || best.is_shape) return best.mesh;
  // Solid by another look-up than the reference's: of a smaller level of the texture, or of none.
  return rays_.masked_mesh_at(stored, tap.direction, q_.reach);
}

StoredTaps::Stored StoredTaps::stored_surface(std::size_t j) const {
  const Tap& tap = q_.why->taps[j];
  const Stored drawn{stored_mesh(j), tap.origin + tap.stored * tap.direction};
  if (drawn.mesh != no_mesh) return drawn;
  const double above = rays_.farthest_along(place(j), -tap.direction);
  const glm::dvec3 first = place(j) - above * tap.direction;
  if (!std::isfinite(above) || !(glm::dot(first - tap.origin, tap.direction) < tap.stored)) return {};
  return {rays_.surface_at(first, tap.direction).mesh, first};
}

/// How far from the point the receiver's own surface may lie that a tap stores. The tap's place is at most as far from the
/// point as half the filter's diagonal, stretched by the slope; a surface that the reference does not count is within two
/// diagonals of it.
double StoredTaps::own_reach() const {
  // Half the side of a square of as many texels, less one half: 0 for one tap.
  const double k = (std::ceil(std::sqrt(double(q_.tap_count()))) - 1) / 2;
  const double facing = std::max(glm::dot(q_.normal, q_.to_light), 1e-3);
  return std::max((k + 1) * q_.reach / facing, (k + 0.5) * std::numbers::sqrt2 * q_.why->texel_width / facing + q_.reach) +
         rays_.rounding();
}

bool StoredTaps::holds_caster() const {
  for (std::size_t j = 0; j < q_.tap_count(); ++j) {
    const double before = -behind(j, true);
    if (!std::isfinite(before) || before <= rays_.rounding()) continue;
    if (before > own_reach() || stored_mesh(j) != q_.mesh) return true;
  }
  return false;
}

/// A perfect map would be lit here: what is stored is at fault.
Cause StoredTaps::of_false_dark() const {
  bool is_over_dark = false;
  for (const std::size_t j : guilty(false)) {
    if (!std::isfinite(q_.why->taps[j].stored)) continue;
    const auto [mesh, stored] = stored_surface(j);
    if (mesh == no_mesh) continue;
    if (mesh != q_.mesh)
      is_over_dark = true;
    else if (glm::distance(stored, q_.point + q_.shift) <= own_reach())
      return Cause::acne;
  }
  return is_over_dark ? Cause::over_dark : Cause::unexplained;
}

/// Whether all that covers a tap is inside the reach of the bias there, which a sloping receiver makes longer by what its plane
/// falls from the point to the tap's place.
bool StoredTaps::is_covered_nearby(std::size_t j) const {
  const glm::dvec3 to_light = rays_.toward_light(place(j));
  const double fall = std::max(0.0, glm::dot(q_.point - place(j), to_light));
  return rays_.farthest_along(place(j), to_light) <= q_.why->bias + q_.reach + fall;
}

/// A perfect map would be dark here: the casters were skipped, or the technique did not believe them.
Cause StoredTaps::of_false_lit() const {
  const double reach = q_.why->bias + q_.reach;
  const double near = rays_.nearest(q_.pixel).distance, far = rays_.farthest(q_.pixel);
  if (near == INFINITY && far == INFINITY) return Cause::unexplained;
  if (far <= reach) return Cause::peter_panning;
  if (near <= reach) return Cause::leak_layered;
  // The same seen through the taps.
  const auto is_layered = [&](std::size_t j) { return is_covered_nearby(j); };
  if (std::ranges::any_of(guilty(false), is_layered)) return Cause::leak_layered;
  if (compares_with_plane() && std::ranges::any_of(guilty(true), is_layered)) return Cause::leak_layered;
  return Cause::leak_representation;
}

Cause StoredTaps::of_taps_alone() const {
  const std::vector<std::size_t> taps = guilty(false);
  if (taps.empty()) return Cause::unexplained;
  const bool is_near = std::ranges::all_of(taps, [&](std::size_t j) { return is_covered_nearby(j); });
  return is_near ? Cause::peter_panning : Cause::leak_representation;
}

}  // namespace gnomon
