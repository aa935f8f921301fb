// Soft shadows: size, width, place and noise of penumbrae.
#include <tbb/parallel_for.h>

#include <algorithm>
#include <numeric>

#include "measure/frame/boundary.h"
#include "measure/score/penumbra_profiles.h"
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

/// So many lines, or places of a third, make a mean.
constexpr std::size_t least_places = 10;

/// The mean of the middle half: hardly less sure than the mean, and a quarter of wild ones on either side does not move it.
std::optional<double> middle_mean(std::span<const PenumbraProfile> profiles, auto value) {
  if (profiles.size() < least_places) return std::nullopt;
  std::vector<double> values;
  for (const PenumbraProfile& profile : profiles) values.push_back(std::invoke(value, profile));
  std::ranges::sort(values);
  const std::span<const double> middle = std::span(values).subspan(values.size() / 4, values.size() - 2 * (values.size() / 4));
  return std::accumulate(middle.begin(), middle.end(), 0.0) / static_cast<double>(middle.size());
}

/// Where both have penumbra: how far the caster is, and how wide they are in meters along the surface.
struct Place {
  double distance, ours, theirs;
};

/// Meters on the surface from a pixel's point to that one pixel on along a unit way in the picture.
double meters_along(const GBuffer& gbuffer, const PixelWindows& windows, int x, int y, const glm::dvec2& way) {
  const auto point = [&](int px, int py) { return glm::dvec3(gbuffer.position(windows.at(px, py))); };
  const glm::dvec3 along_x = (point(x + 1, y) - point(x - 1, y)) / 2.0, along_y = (point(x, y + 1) - point(x, y - 1)) / 2.0;
  return glm::length(way.x * along_x + way.y * along_y);
}

/// Width of penumbra against the distance to the caster: the median of the farthest third of the places less that of the
/// nearest. Nothing where a third has less than ten, or the thirds' distances differ by less than a half.
std::optional<double> measure_hardening(const Evidence& e, const PixelWindows& windows,
                                        std::span<const PenumbraProfile> profiles) {
  if (e.caster_distance.empty() || !e.gbuffer) return std::nullopt;
  std::vector<Place> places;
  for (const PenumbraProfile& profile : profiles) {
    const int x = static_cast<int>(profile.pixel % e.width), y = static_cast<int>(profile.pixel / e.width);
    const double distance = e.caster_distance[profile.pixel], meters = meters_along(*e.gbuffer, windows, x, y, profile.way);
    if (distance > 0) places.push_back({distance, profile.ours * meters, profile.theirs * meters});
  }
  const std::size_t third = places.size() / 3;
  if (third < least_places) return std::nullopt;
  std::ranges::sort(places, {}, &Place::distance);
  const auto middle = [](std::span<const Place> of, double Place::*value) {
    std::vector<double> values;
    for (const Place& place : of) values.push_back(place.*value);
    return median(values);
  };
  const std::span<const Place> near = std::span(places).first(third), far = std::span(places).last(third);
  if (middle(far, &Place::distance) < 1.5 * middle(near, &Place::distance)) return std::nullopt;
  const auto growth = [&](double Place::*width) { return middle(far, width) - middle(near, width); };
  const double theirs = growth(&Place::theirs);
  return theirs > 0 ? std::optional(growth(&Place::ours) / theirs) : std::nullopt;
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
  return count > 0 ? std::optional(std::sqrt(squares / count)) : std::nullopt;
}

}  // namespace

Softness measure_softness(const Evidence& e) {
  if (e.kind == AnswerKind::transmitted) return {};  // what lies between is behind glass, in no penumbra
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
  const std::vector<PenumbraProfile> profiles = penumbra_profiles(e, windows);
  return {.band_mean = ratio(band[0], band[2]),
          .band_rms = root(ratio(band[1], band[2])),
          .outside_mean = ratio(outside[0], outside[2]),
          .outside_rms = root(ratio(outside[1], outside[2])),
          .umbra_ratio = ratio(static_cast<double>(umbra_ours), static_cast<double>(umbra_theirs)),
          .penumbra_ratio = ratio(static_cast<double>(penumbra_ours), static_cast<double>(penumbra_theirs)),
          .width_ratio = middle_mean(profiles, [](const PenumbraProfile& p) { return p.ours / p.theirs; }),
          .shift = middle_mean(profiles, &PenumbraProfile::shift),
          .noise = measure_noise(e, windows, to_penumbra),
          .hardening = measure_hardening(e, windows, profiles)};
}

}  // namespace gnomon
