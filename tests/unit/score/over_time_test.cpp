// Errors over time against values derived on paper, and what must hold of any film.
#include "measure/score/over_time.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "film.h"

namespace over_time_test {

using namespace gnomon;
using film::Film;
using film::Frame;

double value(const Metrics& metrics, std::string_view name) {
  const auto found = metrics.find(name);
  if (found != metrics.end() && found->second) return *found->second;
  ADD_FAILURE() << name << " has no value";
  return NAN;
}

/// Of a film whose frames `draw(frame, seconds)` fills, one after the other.
template <class Draw>
Metrics score_of(int width, int height, double frame_rate, double seconds, const Draw& draw) {
  const int frames = static_cast<int>(std::lround(seconds * frame_rate)) + 1;
  TimeScore score(frames, frame_rate, Path::Moves::light);
  Frame frame(width, height);
  for (int t = 0; t < frames; ++t) {
    draw(frame, t / frame_rate);
    score.add(frame.evidence());
  }
  return score.metrics();
}

// --- a constructed edge: dark and lit stripes of 50 px move to the right at 31.7 px/s
// -----------------------------------------

constexpr double stripe = 50, speed = 31.7;
constexpr int edge_width = 100, edge_height = 20;

/// Whether the point x is in a lit stripe, where edge j at first + 50 j is answered at `moved` of that, which is not larger.
template <class Moved>
bool is_in_lit_stripe(double x, double first, const Moved& moved) {
  int j = static_cast<int>(std::floor((x - first) / stripe)) + 1;
  while (moved(first + stripe * j) > x) --j;
  return j % 2 == 0;
}

/// The rows begin at 20 phases over 3 px, so that a frame has all of them.
template <class Moved>
Metrics score_of_edges(double frame_rate, const Moved& moved) {
  return score_of(edge_width, edge_height, frame_rate, 6, [&](Frame& frame, double seconds) {
    for (int y = 0; y < edge_height; ++y)
      for (int x = 0; x < edge_width; ++x) {
        const double first = 0.01 + 3.0 * y / edge_height + speed * seconds;
        const auto i = static_cast<std::size_t>(y * edge_width + x);
        frame.reference[i] = is_in_lit_stripe(x + 0.5, first, [](double edge) { return edge; });
        frame.mask[i] = is_in_lit_stripe(x + 0.5, first, moved);
      }
  });
}

// Of 50 px the error has 0.25, never the same ones after 1/60 s: the mean square of the change is 2 * 0.25 / 50 = 0.01. An edge
// passes a pixel 31.7 / 50 = 0.634 times per second. The answer flips in another frame than the reference where a frame falls
// into the 0.25 px, a step of the edge being 0.528, 0.264, 0.132 px: 0.473, 0.946 and all of them.
TEST(over_time, flicker_of_a_late_edge_is_the_same_at_every_rate_and_its_flips_are_late) {
  const std::pair<double, double> late_at[] = {{60, 0.300}, {120, 0.600}, {240, 0.634}};
  for (const auto& [rate, late] : late_at) {
    const Metrics metrics = score_of_edges(rate, [](double edge) { return edge - 0.25; });
    for (const FlickerMetric& flicker : flicker_metrics)
      EXPECT_NEAR(value(metrics, flicker.name), 0.100, 0.001) << flicker.name << " at " << rate;
    EXPECT_NEAR(value(metrics, "late_flips"), late, 0.01 * late) << rate;
    EXPECT_LT(value(metrics, "false_flips"), 0.002) << "but for those of reference flips before the first frame";
    EXPECT_EQ(value(metrics, "steady_share"), 1);
  }
}

// Per edge the change is wrong at 1.0377, 2.742 and 3.0 px on average: where the edge stays between two multiples of 3 px at
// the pixels that it passes, else at those beside the old place and those beside the new one. Divided by 50 and rooted: 0.1441,
// 0.2342, 0.2449.
TEST(over_time, an_edge_snapped_to_3_pixels_flickers_more_at_longer_lags) {
  for (const double rate : {60.0, 120.0, 240.0}) {
    const Metrics metrics = score_of_edges(rate, [](double edge) { return 3 * std::floor(edge / 3); });
    EXPECT_NEAR(value(metrics, "flicker_1_60"), 0.144, 0.00144) << rate;
    EXPECT_NEAR(value(metrics, "flicker_1_15"), 0.233, 0.00233) << rate;
    EXPECT_NEAR(value(metrics, "flicker_1_4"), 0.244, 0.00244) << rate;
  }
}

// --- errors of one value a frame
// ----------------------------------------------------------------------------------------------

TEST(over_time, errors_alternating_each_sixtieth_have_flicker_1_0_1) {
  for (const double rate : {60.0, 120.0, 240.0}) {
    const Metrics metrics = score_of(3, 2, rate, 1, [](Frame& frame, double seconds) {
      std::ranges::fill(frame.mask, static_cast<float>(std::lround(std::floor(seconds * 60 + 1e-6)) % 2));
    });
    EXPECT_EQ(value(metrics, "flicker_1_60"), 1) << rate;
    EXPECT_EQ(value(metrics, "flicker_1_15"), 0) << rate;
    EXPECT_EQ(value(metrics, "flicker_1_4"), 1) << "15 is odd " << rate;
    EXPECT_DOUBLE_EQ(value(metrics, "false_flips"), 60) << rate;
    EXPECT_EQ(value(metrics, "late_flips"), 0) << rate;
  }
}

TEST(over_time, white_noise_flickers_by_its_deviation_times_root_two_at_every_lag) {
  std::mt19937 random(3);
  std::normal_distribution<float> noise(0, 0.1f);
  const double rate = 120, frames = rate + 1;
  const Metrics metrics = score_of(64, 64, rate, 1, [&](Frame& frame, double) {
    std::ranges::fill(frame.reference, 0.5f);
    for (float& v : frame.mask) v = 0.5f + noise(random);
  });
  for (const FlickerMetric& flicker : flicker_metrics)
    EXPECT_NEAR(value(metrics, flicker.name), 0.1 * std::sqrt(2), 0.01 * 0.1 * std::sqrt(2)) << flicker.name;
  EXPECT_NEAR(value(metrics, "temporal_sd"), 0.1 * std::sqrt((frames - 1) / frames), 0.001) << "about the mean over the frames";
}

// --- what holds of any film
// ---------------------------------------------------------------------------------------------------

/// A reference that changes everywhere, and a mask that is off by `error(pixel, frame)`.
template <class Error>
Film off_by(const Error& error) {
  Film film = film::blank(20, 5, 1);
  for (std::size_t t = 0; t < film.size(); ++t)
    for (std::size_t i = 0; i < 5; ++i) {
      film[t].reference[i] = (t + i) % 3 == 0 ? 0.75f : 0.25f;
      film[t].mask[i] = film[t].reference[i] + error(i, t);
    }
  return film;
}

TEST(over_time, without_errors_all_are_0) {
  const Metrics metrics = film::score(off_by([](std::size_t, std::size_t) { return 0.0f; }), 60);
  for (const auto& [name, of] : metrics) EXPECT_EQ(of, name == "steady_share" ? 1 : 0) << name;
}

TEST(over_time, an_error_that_stays_does_not_flicker) {
  const Metrics metrics = film::score(off_by([](std::size_t i, std::size_t) { return i % 2 == 0 ? 0.125f : -0.125f; }), 60);
  for (const auto& [name, of] : metrics) EXPECT_EQ(of, name == "steady_share" ? 1 : 0) << name;
}

TEST(over_time, scales_with_the_error) {
  const auto at = [](float factor) {
    return film::score(
        off_by([&](std::size_t i, std::size_t t) { return factor * static_cast<float>((7 * i + 3 * t) % 7) / 64; }), 60);
  };
  const Metrics one = at(1), two = at(2);
  for (const std::string_view name : {"flicker_1_60", "flicker_1_15", "flicker_1_4", "temporal_sd"}) {
    EXPECT_GT(value(one, name), 0) << name;
    EXPECT_DOUBLE_EQ(value(two, name), 2 * value(one, name)) << name;
  }
}

TEST(over_time, is_the_same_with_time_reversed) {
  Film film = off_by([](std::size_t i, std::size_t t) { return static_cast<float>((7 * i + t * t) % 11) / 64; });
  const Metrics onward = film::score(film, 60);
  std::ranges::reverse(film);
  const Metrics back = film::score(film, 60);
  for (const std::string_view name : {"flicker_1_60", "flicker_1_15", "flicker_1_4", "temporal_sd", "steady_share"})
    EXPECT_NEAR(value(onward, name), value(back, name), 1e-12) << name;
}

TEST(over_time, mean_square_is_that_of_the_means_and_the_variance) {
  const Film film = off_by([](std::size_t i, std::size_t t) { return static_cast<float>((7 * i + t * t) % 11) / 64; });
  double squares = 0, squares_of_means = 0;
  for (std::size_t i = 0; i < 5; ++i) {
    double sum = 0;
    for (const Frame& frame : film) {
      const double error = static_cast<double>(frame.mask[i]) - frame.reference[i];
      sum += error / 20;
      squares += error * error / 100;
    }
    squares_of_means += sum * sum / 5;
  }
  EXPECT_NEAR(std::pow(value(film::score(film, 60), "temporal_sd"), 2), squares - squares_of_means, 1e-12);
}

// --- what is compared
// ---------------------------------------------------------------------------------------------------------

TEST(over_time, pixels_that_show_another_point_are_not_compared) {
  // The mask alternates, so that each pair of frames of a compared pixel has a change of 1. Pixel 0 stands still; pixel 1 shows
  // another triangle from frame 2 on, pixel 2 another point in each frame, pixel 3 is not tested in frame 3.
  Film film = film::blank(4, 4, 1);
  for (std::size_t t = 0; t < 4; ++t) {
    std::ranges::fill(film[t].mask, static_cast<float>(t % 2));
    film[t].show(1, 1, t < 2 ? 0 : 1);
    film[t].show(2, static_cast<float>(t), 0);
  }
  film[3].classes[3] = PixelClass::U;
  const Metrics metrics = film::score(film, 60);
  EXPECT_EQ(value(metrics, "flicker_1_60"), 1);
  EXPECT_EQ(value(metrics, "temporal_sd"), 0.5) << "of pixel 0 alone";
  EXPECT_EQ(value(metrics, "steady_share"), 0.25);
  EXPECT_EQ(value(metrics, "false_flips"), 60);
  for (Frame& frame : film) frame.mask[2] = 0.25f * frame.mask[2];
  EXPECT_EQ(value(film::score(film, 60), "flicker_1_60"), 1) << "pixel 2 counts nowhere";
}

TEST(over_time, a_position_of_other_bits_is_another_point) {
  Film film = film::blank(2, 1, 1);
  film[0].show(0, 0.0f, 0);
  film[1].show(0, -0.0f, 0);
  EXPECT_EQ(film::score(film, 60).at("flicker_1_60"), std::nullopt);
  EXPECT_EQ(film::score(film, 60).at("steady_share"), 0);
}

TEST(over_time, flicker_needs_frames_at_a_multiple_of_60_hertz) {
  const Film film = off_by([](std::size_t, std::size_t t) { return static_cast<float>(t % 2) / 8; });
  for (const double rate : {24.0, 30.0, 90.0, 59.94}) {
    const Metrics metrics = film::score(film, rate);
    for (const FlickerMetric& flicker : flicker_metrics) EXPECT_EQ(metrics.at(std::string(flicker.name)), std::nullopt) << rate;
    EXPECT_NEAR(value(metrics, "temporal_sd"), 1.0 / 16, 1e-12);
    EXPECT_EQ(value(metrics, "false_flips"), 0);
  }
  EXPECT_EQ(flicker_obstacle(24), "24 frames a second is no multiple of 60");
  EXPECT_EQ(flicker_obstacle(240), "");
}

TEST(over_time, a_row_shorter_than_a_lag_has_no_flicker_there) {
  Film film = film::blank(5, 2, 1);
  EXPECT_EQ(value(film::score(film, 60), "flicker_1_15"), 0);
  EXPECT_EQ(film::score(film, 60).at("flicker_1_4"), std::nullopt);
  EXPECT_EQ(film::score(film, 120).at("flicker_1_15"), std::nullopt);
}

TEST(over_time, nothing_tested_leaves_all_undefined) {
  Film film = film::blank(20, 2, 1);
  for (Frame& frame : film) std::ranges::fill(frame.classes, PixelClass::B);
  EXPECT_EQ(film::score(film, 60), no_metrics_over_time());
  EXPECT_EQ(film::score(Film(), 60), no_metrics_over_time());
}

TEST(over_time, of_channels_is_the_mean_over_them) {
  const Film red = off_by([](std::size_t, std::size_t t) { return static_cast<float>(t % 2) / 8; });
  const Film blue = off_by([](std::size_t, std::size_t t) { return static_cast<float>(t % 2) / 16; });
  TimeScore score(20, 60, Path::Moves::light);
  for (std::size_t t = 0; t < red.size(); ++t) {
    Evidence whole = red[t].evidence();
    whole.channels = {red[t].evidence(), blue[t].evidence()};
    score.add(whole);
  }
  EXPECT_NEAR(value(score.metrics(), "flicker_1_60"), (1.0 / 8 + 1.0 / 16) / 2, 1e-12);
  EXPECT_EQ(value(score.metrics(), "steady_share"), 1);
}

}  // namespace over_time_test
