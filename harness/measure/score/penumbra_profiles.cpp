#include "measure/score/penumbra_profiles.h"

#include <tbb/parallel_for.h>

namespace gnomon {

namespace {

constexpr double step = 0.5;  // pixels from sample to sample

/// Where V_ref crosses one half between 4-neighbors on one object, by linear interpolation.
struct LevelCrossing {
  glm::dvec2 point;
  std::size_t pixel;  ///< the left or upper one of the two that it lies between
};

void add_crossings(const Evidence& e, const PixelWindows& windows, int y, std::vector<LevelCrossing>& crossings) {
  const std::span<const float> v = e.reference;
  for (int x = 0; x < e.width; ++x) {
    const std::size_t i = windows.at(x, y);
    const auto look = [&](std::size_t j, glm::dvec2 way) {
      if (is_lit(v[i]) == is_lit(v[j]) || !windows.is_one_object(i, j)) return;
      crossings.push_back({glm::dvec2(x, y) + way * ((0.5 - v[i]) / (static_cast<double>(v[j]) - v[i])), i});
    };
    if (x + 1 < e.width) look(i + 1, {1, 0});
    if (y + 1 < e.height) look(i + e.width, {0, 1});
  }
}

/// Both masks at a place.
struct Pair {
  double theirs, ours;
  bool is_saturated(bool lit) const { return lit ? theirs >= 0.98 && ours >= 0.98 : theirs <= 0.02 && ours <= 0.02; }
};

/// Between four pixels, all tested and on the object of pixel `of`; nothing elsewhere.
std::optional<Pair> between(const Evidence& e, const PixelWindows& windows, const glm::dvec2& p, std::size_t of) {
  const int x = static_cast<int>(std::floor(p.x)), y = static_cast<int>(std::floor(p.y));
  if (x < 0 || y < 0 || x + 1 >= e.width || y + 1 >= e.height) return std::nullopt;
  const double u = p.x - x, v = p.y - y;
  const std::array<double, 4> weights{(1 - u) * (1 - v), u * (1 - v), (1 - u) * v, u * v};
  Pair pair{0, 0};
  for (int k = 0; k < 4; ++k) {
    const std::size_t i = windows.at(x + k % 2, y + k / 2);
    if (weights[k] == 0) continue;
    if (e.classes[i] != PixelClass::T || !windows.is_one_object(of, i)) return std::nullopt;
    pair.theirs += weights[k] * e.reference[i];
    pair.ours += weights[k] * e.mask[i];
  }
  return pair;
}

/// From the crossing one way until both masks have saturated at two samples on end; false where they do not. The reference's
/// way there says how far the technique's may be.
bool walk(const Evidence& e, const PixelWindows& windows, const LevelCrossing& from, bool to_light, PenumbraProfile& profile) {
  int saturated = 0;
  double most = INFINITY;
  for (int k = 1; k * step <= most; ++k) {
    const std::optional<Pair> pair = between(e, windows, from.point + (to_light ? k : -k) * step * profile.way, from.pixel);
    if (!pair) return false;
    profile.theirs += 6 * step * pair->theirs * (1 - pair->theirs);
    profile.ours += 6 * step * pair->ours * (1 - pair->ours);
    profile.shift += step * (pair->theirs - pair->ours);
    if (most == INFINITY && (to_light ? pair->theirs >= 0.98 : pair->theirs <= 0.02)) most = 4 * k * step + 4;
    saturated = pair->is_saturated(to_light) ? saturated + 1 : 0;
    if (saturated == 2) return true;
  }
  return false;
}

std::optional<PenumbraProfile> profile_at(const Evidence& e, const PixelWindows& windows, const LevelCrossing& from) {
  const int x = static_cast<int>(std::lround(from.point.x)), y = static_cast<int>(std::lround(from.point.y));
  if (!windows.is_whole(x, y, 1)) return std::nullopt;
  const glm::dvec2 slope = windows.slope(e.reference, x, y);
  const std::optional<Pair> here = between(e, windows, from.point, from.pixel);
  if (glm::length(slope) == 0 || !here) return std::nullopt;
  PenumbraProfile profile{.pixel = windows.at(x, y),
                          .theirs = 6 * step * here->theirs * (1 - here->theirs),
                          .ours = 6 * step * here->ours * (1 - here->ours),
                          .shift = step * (here->theirs - here->ours),
                          .way = glm::normalize(slope)};
  if (!walk(e, windows, from, true, profile) || !walk(e, windows, from, false, profile)) return std::nullopt;
  return profile.theirs >= 2 ? std::optional(profile) : std::nullopt;
}

}  // namespace

std::vector<PenumbraProfile> penumbra_profiles(const Evidence& e, const PixelWindows& windows) {
  std::vector<std::vector<PenumbraProfile>> rows(static_cast<std::size_t>(e.height));
  tbb::parallel_for(0, e.height, [&](int y) {
    std::vector<LevelCrossing> crossings;
    add_crossings(e, windows, y, crossings);
    for (const LevelCrossing& crossing : crossings)
      if (const auto profile = profile_at(e, windows, crossing)) rows[static_cast<std::size_t>(y)].push_back(*profile);
  });
  std::vector<PenumbraProfile> all;
  for (const auto& row : rows) all.insert(all.end(), row.begin(), row.end());
  return all;
}

}  // namespace gnomon
