// Values of tracks, against numbers derived on paper and against Appendix C of glTF 2.0 in long double with a linear search.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "measure/scene/pose.h"

namespace sampled_test {

using namespace gnomon;
using Property = Track::Property;
using Interpolation = Track::Interpolation;
using Real = long double;

/// The quarter turn about y, from none at 0 s, within a second.
Track quarter_turn() {
  const double half = std::sqrt(0.5);
  return {.property = Property::rotation, .times = {0, 1}, .values = {0, 0, 0, 1, 0, half, 0, half}};
}

/// Numbers from 0 to 1 in two seconds, which leave at a speed of 3 and arrive at one of -1.
Track swing() { return {.interpolation = Interpolation::cubic, .times = {0, 2}, .values = {9, 0, 3, -1, 1, 9}}; }

TEST(Sampled, turns_at_an_even_speed) {
  // A third of 90 degrees: (0, sin 15 degrees, 0, cos 15 degrees). The normalized mean of the keys is at 29.28 degrees.
  const std::vector<double> third = sampled(quarter_turn(), 1.0 / 3);
  const double expected[] = {0, 0.25881904510252074, 0, 0.9659258262890683};
  for (int i = 0; i < 4; ++i) EXPECT_NEAR(third[i], expected[i], 1e-15);
  EXPECT_NEAR(2 * std::asin(third[1]) * 180 / std::numbers::pi, 30, 1e-12);
}

TEST(Sampled, turns_the_short_way_whatever_the_sign_of_a_quaternion) {
  Track other = quarter_turn();
  for (int i = 4; i < 8; ++i) other.values[i] = -other.values[i];
  for (const double t : {0.0, 0.25, 1.0 / 3, 0.5, 0.999}) EXPECT_EQ(sampled(quarter_turn(), t), sampled(other, t)) << t;
  Track from = quarter_turn();  // the first key as (0, 0, 0, -1): all between is negative, and the same turn
  from.values[3] = -1;
  for (const double t : {0.25, 1.0 / 3, 0.5}) {
    std::vector<double> q = sampled(from, t);
    for (double& x : q) x = -x;
    EXPECT_EQ(q, sampled(quarter_turn(), t)) << t;
  }
}

TEST(Sampled, leaves_and_reaches_cubic_keys_along_their_tangents) {
  // At half of the time 0.5 + 2 * (0.125 * 3 + 0.125) = 1.5, at a quarter 0.15625 + 2 * (0.140625 * 3 + 0.046875) = 1.09375.
  EXPECT_EQ(sampled(swing(), 1), std::vector<double>{1.5});
  EXPECT_EQ(sampled(swing(), 0.5), std::vector<double>{1.09375});
}

TEST(Sampled, keeps_the_nearest_key_outside_of_its_keys) {
  for (const Interpolation interpolation : {Interpolation::step, Interpolation::linear}) {
    const Track track{.interpolation = interpolation, .times = {1, 3}, .values = {1, 2, 3, 7, 8, 9}};
    for (const double t : {-1e300, 0.0, 1.0}) EXPECT_EQ(sampled(track, t), (std::vector<double>{1, 2, 3})) << t;
    for (const double t : {3.0, 3.5, 1e300}) EXPECT_EQ(sampled(track, t), (std::vector<double>{7, 8, 9})) << t;
  }
  EXPECT_EQ(sampled(swing(), -1), std::vector<double>{0});
  EXPECT_EQ(sampled(swing(), 2.5), std::vector<double>{1});
}

TEST(Sampled, of_one_key_is_that_key_at_all_times) {
  const Track linear{.times = {2}, .values = {1, 2, 3}};
  const Track cubic{.interpolation = Interpolation::cubic, .times = {2}, .values = {9, 9, 9, 1, 2, 3, 9, 9, 9}};
  for (const double t : {0.0, 2.0, 5.0}) {
    EXPECT_EQ(sampled(linear, t), (std::vector<double>{1, 2, 3}));
    EXPECT_EQ(sampled(cubic, t), (std::vector<double>{1, 2, 3}));
  }
}

TEST(Sampled, steps_at_the_next_key_and_not_before) {
  const Track track{.interpolation = Interpolation::step, .times = {0, 1}, .values = {1, 2, 3, 7, 8, 9}};
  EXPECT_EQ(sampled(track, std::nextafter(1.0, 0.0)), (std::vector<double>{1, 2, 3}));
  EXPECT_EQ(sampled(track, 1), (std::vector<double>{7, 8, 9}));
}

TEST(Sampled, takes_the_last_of_keys_at_one_time) {
  const Track jump{.times = {0, 0, 1, 1, 2, 2}, .values = {9, 9, 9, 0, 0, 0, 4, 4, 4, 8, 8, 8, 6, 6, 6, 5, 5, 5}};
  EXPECT_EQ(sampled(jump, 0)[0], 0);
  EXPECT_EQ(sampled(jump, 0.5)[0], 2);
  EXPECT_EQ(sampled(jump, 1)[0], 8);
  EXPECT_EQ(sampled(jump, 1.5)[0], 7);
  EXPECT_EQ(sampled(jump, 2)[0], 5);
}

TEST(Sampled, reads_all_weights_of_a_cubic_key_after_all_its_in_tangents) {
  // Two weights, two keys: in-tangents of both, values of both, out-tangents of both.
  const Track track{.property = Property::weights,
                    .interpolation = Interpolation::cubic,
                    .times = {0, 1},
                    .values = {9, 9, 0, 10, 8, 0, 0, -8, 1, 20, 9, 9}};
  EXPECT_EQ(track.width(), 2u);
  // At half: 0.5 * (0 + 1) + 0.125 * 8 and 0.5 * (10 + 20) + 0.125 * 8.
  EXPECT_EQ(sampled(track, 0.5), (std::vector<double>{1.5, 16}));
}

TEST(Sampled, holds_the_value_between_equal_keys_to_the_bit) {
  const double third = 1.0 / 3, side = std::sqrt(1 - 2 * third * third);
  const Track moved{.times = {0, 0.7}, .values = {0.1, third, -7e10, 0.1, third, -7e10}};
  const Track turned{
      .property = Property::rotation, .times = {0, 0.7}, .values = {third, third, 0, side, third, third, 0, side}};
  const Track eased{.property = Property::weights,
                    .interpolation = Interpolation::cubic,
                    .times = {0, 0.7},
                    .values = {0, third, 0, 0, third, 0}};
  for (const double t : {0.1, 0.23, 0.6999}) {
    EXPECT_EQ(sampled(moved, t), (std::vector<double>{0.1, third, -7e10}));
    EXPECT_EQ(sampled(turned, t), (std::vector<double>{third, third, 0, side}));
    EXPECT_EQ(sampled(eased, t), std::vector<double>{third});
  }
}

TEST(Sampled, has_no_jump_where_turns_are_too_small_for_sines) {
  // Two quaternions `angle` apart in their space: at the share 0.3 the sum is 0.3 * angle from the first.
  for (const double angle : {1e-12, 1e-7, 9.99e-7, 1.001e-6, 1e-5}) {
    const Track track{
        .property = Property::rotation, .times = {0, 1}, .values = {0, 0, 0, 1, 0, 0, -std::sin(angle), -std::cos(angle)}};
    EXPECT_NEAR(sampled(track, 0.3)[2], 0.3 * angle, 1e-9 * angle) << angle;
  }
}

TEST(Sampled, finds_each_of_a_hundred_thousand_keys) {
  Track track;
  constexpr int count = 100'000;
  for (int k = 0; k < count; ++k) {
    track.times.push_back(k * 0.25);
    track.values.insert(track.values.end(), {double(k), double(-k), double(k % 2)});
  }
  for (int k = 0; k + 1 < count; ++k) {
    ASSERT_EQ(sampled(track, k * 0.25), (std::vector<double>{double(k), double(-k), double(k % 2)}));
    ASSERT_EQ(sampled(track, k * 0.25 + 0.125), (std::vector<double>{k + 0.5, -k - 0.5, 0.5}));
  }
}

/// As the specification has it: the sum of the keys' values and tangents times their polynomials or sines.
std::vector<Real> plain(const Track& track, Real seconds) {
  const bool is_cubic = track.interpolation == Interpolation::cubic;
  const std::size_t width = track.width(), parts = is_cubic ? 3 : 1, count = track.times.size();
  const auto part = [&](std::size_t key, std::size_t which, std::size_t i) -> Real {
    return track.values[(key * parts + which) * width + i];
  };
  std::size_t k = 0;
  while (k + 1 < count && track.times[k + 1] <= seconds) ++k;
  std::vector<Real> value(width);
  for (std::size_t i = 0; i < width; ++i) value[i] = part(k, parts / 2, i);
  if (seconds < track.times[0] || k + 1 == count || track.interpolation == Interpolation::step) return value;
  const Real between = Real(track.times[k + 1]) - track.times[k], t = (seconds - track.times[k]) / between, u = 1 - t;
  const bool turns = track.property == Property::rotation;
  Real dot = 0, length = 0;
  for (std::size_t i = 0; i < width; ++i) dot += part(k, parts / 2, i) * part(k + 1, parts / 2, i);
  const Real angle = std::acos(std::min(std::abs(dot), Real(1)));
  for (std::size_t i = 0; i < width; ++i) {
    const Real a = part(k, parts / 2, i), b = part(k + 1, parts / 2, i);
    if (is_cubic)
      value[i] = (2 * t * t * t - 3 * t * t + 1) * a + between * (t * t * t - 2 * t * t + t) * part(k, 2, i) +
                 (3 * t * t - 2 * t * t * t) * b + between * (t * t * t - t * t) * part(k + 1, 0, i);
    else if (turns && angle >= 1e-6L)
      value[i] = (std::sin(angle * u) * a + (dot < 0 ? -1 : 1) * std::sin(angle * t) * b) / std::sin(angle);
    else
      value[i] = u * a + t * (turns && dot < 0 ? -b : b);
    length += value[i] * value[i];
  }
  if (turns)
    for (Real& x : value) x /= std::sqrt(length);
  return value;
}

class Random {
 public:
  explicit Random(unsigned seed) : engine_(seed) {}
  double number(double most) { return std::uniform_real_distribution(-most, most)(engine_); }
  int below(int count) { return std::uniform_int_distribution(0, count - 1)(engine_); }

  Track track() {
    Track track{.property = Property(below(4)), .interpolation = Interpolation(below(3))};
    const int width = track.property == Property::rotation ? 4 : track.property == Property::weights ? 1 + below(5) : 3;
    double time = below(2) * 0.5;
    std::vector<double> before;
    for (int k = 1 + below(6); k > 0; --k) {
      track.times.push_back(time);
      time += below(8) == 0 ? 0 : std::exp(number(4));
      std::vector<double> value = this->value(width, before);
      if (track.property == Property::rotation) normalize(value);
      const bool is_cubic = track.interpolation == Interpolation::cubic;
      for (int part = 0; part < (is_cubic ? 3 : 1); ++part)
        for (int i = 0; i < width; ++i) track.values.push_back(is_cubic && part != 1 ? number(2) : value[i]);
      before = value;
    }
    return track;
  }

 private:
  /// Now and then the one before, its opposite, or one near it.
  std::vector<double> value(int width, const std::vector<double>& before) {
    std::vector<double> value = before;
    const double side = below(2) * 2 - 1, near = std::pow(10, -6 + number(3));
    if (before.empty() || below(2) == 0) {
      value.clear();
      for (int i = 0; i < width; ++i) value.push_back(number(4));
    } else if (below(4) > 0) {
      for (double& x : value) x = side * (x + near * number(1));
    }
    return value;
  }
  static void normalize(std::vector<double>& value) {
    double length = 0;
    for (const double x : value) length += x * x;
    for (double& x : value) x /= std::sqrt(length);
  }
  std::mt19937_64 engine_;
};

TEST(Sampled, is_what_the_specification_says_of_random_tracks) {
  for (unsigned seed = 0; seed < 3000; ++seed) {
    Random random(seed);
    const Track track = random.track();
    for (int i = 0; i < 12; ++i) {
      double t = track.times.front() + (track.times.back() - track.times.front()) * (0.5 + random.number(0.55));
      if (i < 4) t = std::nextafter(track.times[random.below(static_cast<int>(track.times.size()))], i % 2 == 0 ? -1e9 : 1e9);
      const std::vector<double> value = sampled(track, t);
      const std::vector<Real> expected = plain(track, t);
      ASSERT_EQ(value.size(), track.width());
      // Times are below 350 s, tangents below 2 a second. A cubic quaternion may pass near 0, where its direction is rounding.
      for (std::size_t k = 0; k < value.size(); ++k) ASSERT_NEAR(value[k], double(expected[k]), 1e-10) << seed << ' ' << t;
    }
  }
}

TEST(Sampled, is_exactly_the_key_at_each_key_of_random_tracks) {
  for (unsigned seed = 0; seed < 1000; ++seed) {
    const Track track = Random(seed).track();
    const bool is_cubic = track.interpolation == Interpolation::cubic;
    for (std::size_t k = 0; k < track.times.size(); ++k) {
      if (k + 1 < track.times.size() && track.times[k + 1] == track.times[k]) continue;
      const auto first = track.values.begin() + static_cast<std::ptrdiff_t>((is_cubic ? 3 * k + 1 : k) * track.width());
      ASSERT_EQ(sampled(track, track.times[k]), std::vector(first, first + static_cast<std::ptrdiff_t>(track.width()))) << seed;
    }
  }
}

TEST(Sampled, turns_by_unit_quaternions_between_cubic_keys) {
  const Track track{.property = Property::rotation,
                    .interpolation = Interpolation::cubic,
                    .times = {0, 2},
                    .values = {0, 0, 0, 0, 0, 0, 0, 1, 1, 2, 3, 4, -4, -3, 0, 1, 1, 0, 0, 0, 0, 0, 0, 0}};
  for (const double t : {0.1, 0.5, 1.0, 1.9}) {
    const std::vector<double> q = sampled(track, t);
    EXPECT_NEAR(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3], 1, 1e-14) << t;
  }
}

}  // namespace sampled_test
