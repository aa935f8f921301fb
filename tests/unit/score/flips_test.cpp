#include "measure/score/flips.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>
#include <random>
#include <string_view>

#include "film.h"

namespace flips_test {

using namespace gnomon;
using film::Film;
using film::Frame;

/// One pixel's course, a letter a frame: `.` lit, `#` dark. `compared`: `x` where the frame is not compared.
Flips::Counts count(std::string_view mask, std::string_view reference, std::size_t window, std::string_view compared = "") {
  Flips flips;
  std::uint32_t age = 0;
  for (std::size_t t = 0; t < mask.size(); ++t) {
    age = t < compared.size() && compared[t] == 'x' ? 0 : age + 1;
    const float ours = mask[t] == '.', theirs = reference[t] == '.';
    flips.add(std::array{ours}, std::array{theirs}, std::array{age});
  }
  return flips.count(window);
}

TEST(flips, in_the_frame_of_the_reference_are_right) {
  const Flips::Counts counts = count("..##..", "..##..", 2);
  EXPECT_EQ(counts.pairs, 5u);
  EXPECT_EQ(counts.late, 0u);
  EXPECT_EQ(counts.unmatched, 0u);
}

TEST(flips, within_the_window_are_late_on_both_sides) {
  EXPECT_EQ(count("....##", "..####", 2).late, 1u);
  EXPECT_EQ(count("..####", "....##", 2).late, 1u) << "before the reference";
  const Flips::Counts outside = count("....##", "..####", 1);
  EXPECT_EQ(outside.late, 0u);
  EXPECT_EQ(outside.unmatched, 1u);
}

TEST(flips, the_other_way_are_no_match) {
  const Flips::Counts counts = count("##..", "..##", 3);
  EXPECT_EQ(counts.late, 0u);
  EXPECT_EQ(counts.unmatched, 1u);
}

TEST(flips, of_the_reference_are_matched_once_the_nearest_first) {
  // The mask becomes dark in frames 1, 3 and 6, the reference in 4: frame 3 is the nearest.
  const Flips::Counts counts = count(".#.##.##", "....####", 7);
  EXPECT_EQ(counts.late, 1u);
  EXPECT_EQ(counts.unmatched, 4u) << "two become dark, two become lit";
}

TEST(flips, are_not_matched_across_a_frame_that_is_not_compared) {
  EXPECT_EQ(count("..####", ".#####", 3).late, 1u);
  const Flips::Counts counts = count("...###", ".#####", 3, "  x");
  EXPECT_EQ(counts.pairs, 3u);
  EXPECT_EQ(counts.late, 0u);
  EXPECT_EQ(counts.unmatched, 0u) << "frame 3 has no frame before it";
  EXPECT_EQ(count("....##", ".#####", 4, "  x").unmatched, 1u);
}

TEST(flips, without_frames_there_are_none) { EXPECT_EQ(Flips().count(3).pairs, 0u); }

// --- all metrics over time a second time, pixel by pixel and pair by pair
// -----------------------------------------------------

/// Whether the pixel is T and shows one surface point in all frames first .. last.
bool is_compared(const Film& film, std::size_t pixel, std::size_t first, std::size_t last) {
  const GBuffer& at_first = film[first].picture->gbuffer;
  for (std::size_t t = first; t <= last; ++t) {
    const GBuffer& g = film[t].picture->gbuffer;
    if (film[t].classes[pixel] != PixelClass::T || g.triangle[pixel] != at_first.triangle[pixel] ||
        g.position(pixel) != at_first.position(pixel))
      return false;
  }
  return true;
}

double error(const Frame& frame, std::size_t pixel) { return static_cast<double>(frame.mask[pixel]) - frame.reference[pixel]; }

std::optional<double> flicker(const Film& film, std::size_t lag) {
  double sum = 0, count = 0;
  for (std::size_t t = 0; t + lag < film.size(); ++t)
    for (std::size_t i = 0; i < film[t].mask.size(); ++i)
      if (is_compared(film, i, t, t + lag)) {
        const double change = error(film[t + lag], i) - error(film[t], i);
        sum += change * change;
        ++count;
      }
  return count > 0 ? std::optional(std::sqrt(sum / count)) : std::nullopt;
}

std::optional<double> temporal_sd(const Film& film) {
  double sum = 0, count = 0;
  for (std::size_t i = 0; i < film[0].mask.size(); ++i) {
    if (!is_compared(film, i, 0, film.size() - 1)) continue;
    double mean = 0;
    for (const Frame& frame : film) mean += error(frame, i) / static_cast<double>(film.size());
    for (const Frame& frame : film) sum += std::pow(error(frame, i) - mean, 2);
    count += static_cast<double>(film.size());
  }
  return count > 0 ? std::optional(std::sqrt(sum / count)) : std::nullopt;
}

/// All flips of a pixel and way, then all pairs within the window, then the nearest pairs first.
Flips::Counts flips_of(const Film& film, std::size_t pixel, bool to_lit, std::size_t window) {
  std::vector<std::size_t> ours, theirs;
  for (std::size_t t = 1; t < film.size(); ++t) {
    if (!is_compared(film, pixel, t - 1, t)) continue;
    const auto flips = [&](std::vector<float> Frame::*of) {
      return is_lit((film[t].*of)[pixel]) == to_lit && is_lit((film[t - 1].*of)[pixel]) != to_lit;
    };
    if (flips(&Frame::mask)) ours.push_back(t);
    if (flips(&Frame::reference)) theirs.push_back(t);
  }
  std::vector<std::array<std::size_t, 3>> pairs;  // distance, ours, theirs
  for (const std::size_t a : ours)
    for (const std::size_t b : theirs) {
      const std::size_t distance = std::max(a, b) - std::min(a, b);
      if (distance <= window && is_compared(film, pixel, std::min(a, b) - 1, std::max(a, b))) pairs.push_back({distance, a, b});
    }
  std::ranges::sort(pairs);
  Flips::Counts counts;
  for (const auto& [distance, a, b] : pairs) {
    if (std::ranges::count(ours, a) == 0 || std::ranges::count(theirs, b) == 0) continue;
    std::erase(ours, a);
    std::erase(theirs, b);
    counts.late += distance > 0;
  }
  counts.unmatched = ours.size();
  return counts;
}

Film random_film(std::mt19937& random) {
  const auto below = [&](int count) { return static_cast<int>(random() % static_cast<unsigned>(count)); };
  Film film = film::blank(static_cast<std::size_t>(2 + below(30)), 13, 6);
  for (std::size_t t = 0; t < film.size(); ++t)
    for (std::size_t i = 0; i < film[t].mask.size(); ++i) {
      film[t].mask[i] = static_cast<float>(below(5)) / 4;
      film[t].reference[i] = static_cast<float>(below(5)) / 4;
      if (below(40) == 0) film[t].classes[i] = static_cast<PixelClass>(below(5));
      if (t > 0) {  // from now on another point, or another triangle
        const GBuffer& before = film[t - 1].picture->gbuffer;
        film[t].show(i, before.px[i] + (below(60) == 0 ? 0.5f : 0), before.triangle[i] + (below(60) == 0 ? 1 : 0));
      }
    }
  return film;
}

TEST(over_time_again, a_second_implementation_finds_the_same_in_random_films) {
  std::mt19937 random(11);
  for (int k = 0; k < 60; ++k) {
    const Film film = random_film(random);
    const double rate = std::array{24.0, 60.0, 120.0, 50.0, 30.0}[static_cast<std::size_t>(k % 5)];
    std::map<std::string, std::optional<double>> again;
    for (const FlickerMetric& metric : flicker_metrics)
      again[std::string(metric.name)] =
          std::fmod(rate, 60) == 0 ? flicker(film, static_cast<std::size_t>(metric.sixtieths * rate / 60)) : std::nullopt;
    again["temporal_sd"] = temporal_sd(film);
    double late = 0, unmatched = 0, seconds = 0, steady = 0;
    for (std::size_t i = 0; i < film[0].mask.size(); ++i) {
      for (const bool to_lit : {false, true}) {
        const Flips::Counts counts = flips_of(film, i, to_lit, static_cast<std::size_t>(rate / 10));
        late += static_cast<double>(counts.late);
        unmatched += static_cast<double>(counts.unmatched);
      }
      for (std::size_t t = 1; t < film.size(); ++t) seconds += is_compared(film, i, t - 1, t) / rate;
      steady += is_compared(film, i, 0, film.size() - 1);
    }
    again["late_flips"] = late / seconds;
    again["false_flips"] = unmatched / seconds;
    again["steady_share"] = steady / static_cast<double>(std::ranges::count(film[0].classes, PixelClass::T));
    const Metrics metrics = film::score(film, rate);
    ASSERT_EQ(metrics.size(), again.size());
    for (const auto& [name, value] : again) {
      ASSERT_EQ(metrics.at(name).has_value(), value.has_value()) << name << " of film " << k;
      EXPECT_NEAR(metrics.at(name).value_or(0), value.value_or(0), 1e-9) << name << " of film " << k;
    }
  }
}

}  // namespace flips_test
