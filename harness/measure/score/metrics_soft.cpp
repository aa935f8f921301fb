// Soft shadows: size, width, place and noise of penumbrae.
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "measure/frame/boundary.h"
#include "measure/frame/pixel_windows.h"
#include "measure/score/metrics.h"
#include "measure/statistics/statistics.h"

namespace gnomon {

namespace {

/// Calls row(y) for every row in parallel and adds up its answers in order.
template <class Row>
std::array<double, 3> add_rows(int height, const Row& row) {
  std::vector<std::array<double, 3>> rows(static_cast<std::size_t>(height));
  tbb::parallel_for(0, height, [&](int y) { rows[static_cast<std::size_t>(y)] = row(y); });
  std::array<double, 3> total{};
  for (const auto& sums : rows)
    for (int k = 0; k < 3; ++k) total[k] += sums[k];
  return total;
}

/// A point on the line V = 0.5, in pixels.
struct Crossing {
  glm::dvec2 point;
  std::size_t pixel;  ///< the left or upper one of the two that it lies between
};

/// Where V crosses one half between 4-neighbors on one object, by linear interpolation.
std::vector<Crossing> half_line(const Evidence& e, const PixelWindows& windows, std::span<const float> v) {
  std::vector<Crossing> crossings;
  for (int y = 0; y < e.height; ++y)
    for (int x = 0; x < e.width; ++x) {
      const std::size_t i = windows.at(x, y);
      const auto look = [&](std::size_t j, glm::dvec2 step) {
        if (is_lit(v[i]) == is_lit(v[j]) || !windows.is_one_object(i, j)) return;
        crossings.push_back({glm::dvec2(x, y) + step * ((0.5 - v[i]) / (static_cast<double>(v[j]) - v[i])), i});
      };
      if (x + 1 < e.width) look(i + 1, {1, 0});
      if (y + 1 < e.height) look(i + e.width, {0, 1});
    }
  return crossings;
}

/// Median over the technique's line of its distance from the nearest piece of the reference's, measured across that; positive
/// where it lies on the lit side.
std::optional<double> measure_shift(const Evidence& e, const PixelWindows& windows) {
  const std::vector<Crossing> ours = half_line(e, windows, e.mask), theirs = half_line(e, windows, e.reference);
  if (ours.empty() || theirs.empty()) return std::nullopt;
  std::vector<std::uint8_t> marked(e.mask.size(), 0);
  std::vector<std::int32_t> first(e.mask.size(), -1);  // the first crossing of a pixel; a second one follows it
  for (std::size_t k = 0; k < theirs.size(); ++k)
    if (!std::exchange(marked[theirs[k].pixel], 1)) first[theirs[k].pixel] = static_cast<std::int32_t>(k);
  const std::vector<std::int32_t> nearest = nearest_marked(marked, e.width, e.height);
  std::vector<double> distances;
  for (const Crossing& crossing : ours) {
    if (e.classes[crossing.pixel] != PixelClass::T) continue;
    const auto pixel = static_cast<std::size_t>(nearest[crossing.pixel]);
    const int x = static_cast<int>(pixel % e.width), y = static_cast<int>(pixel / e.width);
    if (!windows.is_inside(x, y, 1)) continue;
    const glm::dvec2 to_lit = windows.slope(e.reference, x, y);
    if (glm::length(to_lit) == 0) continue;
    const auto k = static_cast<std::size_t>(first[pixel]);
    glm::dvec2 offset = crossing.point - theirs[k].point;
    if (k + 1 < theirs.size() && theirs[k + 1].pixel == pixel) {
      const glm::dvec2 other = crossing.point - theirs[k + 1].point;
      if (glm::dot(other, other) < glm::dot(offset, offset)) offset = other;
    }
    distances.push_back(glm::dot(offset, glm::normalize(to_lit)));
  }
  if (distances.empty()) return std::nullopt;
  return median(distances);
}

/// Slopes are compared, not widths: a technique without slope somewhere has no width there.
std::optional<double> measure_width_ratio(const Evidence& e, const PixelWindows& windows) {
  const auto is_middle = [](float v) { return v > 0.1f && v < 0.9f; };
  std::vector<double> ratios;
  for (int y = 1; y + 1 < e.height; ++y)
    for (int x = 1; x + 1 < e.width; ++x) {
      const std::size_t i = windows.at(x, y);
      if (e.classes[i] != PixelClass::T || !is_middle(e.reference[i]) || !is_middle(e.mask[i])) continue;
      const double steep = glm::length(windows.slope(e.reference, x, y));
      if (steep == 0 || !windows.is_whole(x, y, 1)) continue;
      ratios.push_back(glm::length(windows.slope(e.mask, x, y)) / steep);
    }
  if (ratios.empty()) return std::nullopt;
  const double ratio = median(ratios);
  return ratio > 0 ? std::optional(1 / ratio) : std::nullopt;
}

/// Where both have penumbra: how far the caster is, and how steep V is per meter along the surface.
struct Place {
  double distance, ours, theirs;
};

/// Meters on the surface from a pixel's point to that one pixel on along a slope.
double meters_along(const Evidence& e, const PixelWindows& windows, int x, int y, const glm::dvec2& slope) {
  const glm::dvec2 way = glm::normalize(slope);
  const auto point = [&](int px, int py) { return glm::dvec3(e.gbuffer->position(windows.at(px, py))); };
  const glm::dvec3 along_x = (point(x + 1, y) - point(x - 1, y)) / 2.0, along_y = (point(x, y + 1) - point(x, y - 1)) / 2.0;
  return glm::length(way.x * along_x + way.y * along_y);
}

/// Width of penumbra w = 0.8 / slope against the distance to the caster: w of the farthest third of the places less w of the
/// nearest, by the medians of their slopes. Nothing where the thirds' distances differ by less than a half.
std::optional<double> measure_hardening(const Evidence& e, const PixelWindows& windows) {
  if (e.caster_distance.empty() || !e.gbuffer) return std::nullopt;
  const auto is_middle = [](float v) { return v > 0.1f && v < 0.9f; };
  std::vector<Place> places;
  for (int y = 1; y + 1 < e.height; ++y)
    for (int x = 1; x + 1 < e.width; ++x) {
      const std::size_t i = windows.at(x, y);
      if (e.classes[i] != PixelClass::T || !is_middle(e.reference[i]) || !is_middle(e.mask[i])) continue;
      const glm::dvec2 theirs = windows.slope(e.reference, x, y);
      if (!(e.caster_distance[i] > 0) || glm::length(theirs) == 0 || !windows.is_whole(x, y, 1)) continue;
      const double meters = meters_along(e, windows, x, y, theirs);
      if (meters > 0)
        places.push_back(
            {e.caster_distance[i], glm::length(windows.slope(e.mask, x, y)) / meters, glm::length(theirs) / meters});
    }
  const std::size_t third = places.size() / 3;
  if (third < 10) return std::nullopt;
  std::ranges::sort(places, {}, &Place::distance);
  const auto middle = [](std::span<const Place> of, double Place::*value) {
    std::vector<double> values;
    for (const Place& place : of) values.push_back(place.*value);
    return median(values);
  };
  const std::span<const Place> near = std::span(places).first(third), far = std::span(places).last(third);
  if (middle(far, &Place::distance) < 1.5 * middle(near, &Place::distance)) return std::nullopt;
  const auto growth = [&](double Place::*slope) { return 0.8 / middle(far, slope) - 0.8 / middle(near, slope); };
  const double ours = growth(&Place::ours), theirs = growth(&Place::theirs);
  return std::isfinite(ours) && theirs > 0 ? std::optional(ours / theirs) : std::nullopt;
}

/// Of the pixels whose whole 5 x 5 window is on one object: a ramp leaves nothing, so that what is left is noise or corners.
std::optional<double> measure_noise(const Evidence& e, const PixelWindows& windows, std::span<const float> to_penumbra) {
  const auto [squares, count, unused] = add_rows(e.height, [&](int y) {
    std::array<double, 3> sums{};
    for (int x = 0; x < e.width; ++x) {
      const std::size_t i = windows.at(x, y);
      if (e.classes[i] != PixelClass::T || to_penumbra[i] > 2 || !windows.is_whole(x, y, 2)) continue;
      std::array<float, 25> values;
      for (int k = 0; k < 25; ++k) values[k] = e.mask[windows.at(x + k % 5 - 2, y + k / 5 - 2)];
      std::nth_element(values.begin(), values.begin() + 12, values.end());
      const double left = static_cast<double>(e.mask[i]) - values[12];
      sums[0] += left * left;
      ++sums[1];
    }
    return sums;
  });
  if (count == 0) return std::nullopt;
  return std::sqrt(squares / count);
}

}  // namespace

Softness measure_softness(const Evidence& e) {
  std::vector<std::uint8_t> penumbra(e.mask.size());
  std::size_t umbra_ours = 0, umbra_theirs = 0, penumbra_ours = 0, penumbra_theirs = 0;
  for (std::size_t i = 0; i < e.mask.size(); ++i) {
    if (!e.faces_light(i)) continue;
    penumbra[i] = is_penumbra(e.reference[i]);
    if (e.classes[i] != PixelClass::T) continue;
    umbra_ours += e.mask[i] <= 0.02f;
    umbra_theirs += e.reference[i] <= 0.02f;
    penumbra_ours += is_penumbra(e.mask[i]);
    penumbra_theirs += penumbra[i];
  }
  if (penumbra_theirs == 0) return {};

  const PixelWindows windows(e.width, e.height, e.classes, e.gbuffer);
  const std::vector<float> to_penumbra = distance_transform(penumbra, e.width, e.height);
  const auto errors = [&](bool in_band) {
    return add_rows(e.height, [&](int y) {
      std::array<double, 3> sums{};
      for (int x = 0; x < e.width; ++x) {
        const std::size_t i = windows.at(x, y);
        if (e.classes[i] != PixelClass::T || (to_penumbra[i] <= 2) != in_band) continue;
        const double error = std::abs(static_cast<double>(e.mask[i]) - e.reference[i]);
        sums[0] += error;
        sums[1] += error * error;
        ++sums[2];
      }
      return sums;
    });
  };
  const auto ratio = [](double part, double whole) { return whole > 0 ? std::optional(part / whole) : std::nullopt; };
  const auto root = [](std::optional<double> square) { return square ? std::optional(std::sqrt(*square)) : std::nullopt; };
  const auto band = errors(true), outside = errors(false);
  return {.band_mean = ratio(band[0], band[2]),
          .band_rms = root(ratio(band[1], band[2])),
          .outside_mean = ratio(outside[0], outside[2]),
          .outside_rms = root(ratio(outside[1], outside[2])),
          .umbra_ratio = ratio(static_cast<double>(umbra_ours), static_cast<double>(umbra_theirs)),
          .penumbra_ratio = ratio(static_cast<double>(penumbra_ours), static_cast<double>(penumbra_theirs)),
          .width_ratio = measure_width_ratio(e, windows),
          .shift = measure_shift(e, windows),
          .noise = measure_noise(e, windows, to_penumbra),
          .hardening = measure_hardening(e, windows)};
}

}  // namespace gnomon
