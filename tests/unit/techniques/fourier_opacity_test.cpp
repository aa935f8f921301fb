// The curve of a texel that holds terms of a Fourier series of absorbance, on paper and in stacks of plates.
#include <gnomon/kit/random.h>
#include <gtest/gtest.h>

#include "plate_stack.h"
#include "techniques/fourier_opacity/curve.h"

namespace fourier_opacity_test {
using namespace gnomon;
using namespace gnomon::fourier_opacity;
using plate_stack::Plate;

template <class Real>
Series<Real> series_of(const std::vector<Plate>& plates, int n) {
  Series<Real> series(n);
  for (const Plate& plate : plates) series.add(static_cast<Real>(plate.t), static_cast<Real>(plate.absorbance()));
  return series;
}

// a0 = 2 * 2.590267; a1 = 2 (.693147 cos .4 pi + .287682 cos pi + 1.609438 cos 1.4 pi) = -1.141663 and so on.
TEST(FourierOpacity, the_stack_on_paper_has_these_terms) {
  const Series<double> series = series_of<double>(plate_stack::on_paper(), 3);
  const double a[] = {5.180534, -1.141663, -3.150297, .907225}, b[] = {0, -1.742889, 2.706851, 1.077164};
  for (std::size_t k = 0; k < 4; ++k) {
    EXPECT_NEAR(series.a[k], a[k], 1e-6);
    EXPECT_NEAR(series.b[k], b[k], 1e-6);
  }
}

TEST(FourierOpacity, the_stack_on_paper_lets_this_through) {
  const Series<double> series = series_of<double>(plate_stack::on_paper(), 3);
  const Series<float> in_float = series_of<float>(plate_stack::on_paper(), 3);
  const double rows[][2] = {{.1, .877880}, {.35, .424340}, {.6, .345318}, {.9, .060727}};
  for (const auto& [t, share] : rows) {
    EXPECT_NEAR(transmittance(series, t), share, 1e-6);
    EXPECT_NEAR(transmittance(in_float, static_cast<float>(t)), share, 1e-5);
  }
}

// All sines vanish there, and all cosines are 1.
TEST(FourierOpacity, both_ends_are_exact_for_any_number_of_terms) {
  Random random(21);
  for (int n = 1; n <= 15; ++n)
    for (int round = 0; round < 50; ++round) {
      const std::vector<Plate> plates = plate_stack::random_plates(random, 1, 8);
      const Series<double> series = series_of<double>(plates, n);
      EXPECT_EQ(transmittance(series, 0.0), 1);
      EXPECT_NEAR(transmittance(series, 1.0), plate_stack::share_before(plates, 1.0), 1e-12);
    }
}

/// Of the stack on paper, over depth: midpoints of 20000 steps, which the three jumps shift by less than 1e-4.
double mean_error(int n) {
  constexpr int steps = 20000;
  const std::vector<Plate> plates = plate_stack::on_paper();
  const Series<double> series = series_of<double>(plates, n);
  double sum = 0;
  for (int i = 0; i < steps; ++i) {
    const double t = (i + 0.5) / steps;
    sum += std::abs(transmittance(series, t) - plate_stack::share_before(plates, t));
  }
  return sum / steps;
}
TEST(FourierOpacity, the_mean_error_of_the_stack_on_paper) {
  const std::pair<int, double> rows[] = {{3, .0703}, {7, .0327}, {15, .0164}};
  for (const auto& [n, error] : rows) EXPECT_NEAR(mean_error(n), error, 0.01 * error) << n;
}

// More terms are not always better: .108, .056, .070.
TEST(FourierOpacity, two_terms_beat_three_on_the_stack_on_paper) {
  EXPECT_NEAR(mean_error(1), 0.108, 0.001);
  EXPECT_NEAR(mean_error(2), 0.056, 0.001);
  EXPECT_LT(mean_error(2), mean_error(3));
}

// In random stacks of 3 to 8 plates: .063, .037, .022.
TEST(FourierOpacity, the_mean_error_of_random_stacks) {
  const std::pair<int, double> rows[] = {{3, .063}, {7, .037}, {15, .022}};
  for (const auto& [n, expected] : rows) {
    Random random(22);
    double sum = 0;
    constexpr int rounds = 4000;
    for (int round = 0; round < rounds; ++round) {
      const std::vector<Plate> plates = plate_stack::random_plates(random, 3, 8);
      const double t = random.uniform(0, 1);
      sum += std::abs(transmittance(series_of<double>(plates, n), t) - plate_stack::share_before(plates, t));
    }
    EXPECT_NEAR(sum / rounds, expected, 0.1 * expected) << n;
  }
}

// Gibbs: behind the jump of one plate, the sum of n terms overshoots by 8.95 % of it for many terms, by 9.29 % at n = 3.
TEST(FourierOpacity, absorbance_overshoots_by_nine_per_cent) {
  const std::pair<int, double> rows[] = {{3, .0929}, {15, .0895}};
  for (const auto& [n, share] : rows) {
    const Plate plate{0.5, 0.5};
    const Series<double> series = series_of<double>({plate}, n);
    double most = 0;
    for (double t = plate.t; t < 1; t += 1e-5) most = std::max(most, -std::log(transmittance(series, t)) - plate.absorbance());
    EXPECT_NEAR(most / plate.absorbance(), share, 0.001) << n;
  }
}

TEST(FourierOpacity, no_share_is_above_one) {
  Random random(23);
  for (int round = 0; round < 2000; ++round) {
    const Series<float> series = series_of<float>(plate_stack::random_plates(random, 1, 8), 7);
    const float share = transmittance(series, static_cast<float>(random.uniform(0, 1)));
    EXPECT_TRUE(share >= 0 && share <= 1) << share;
  }
}

}  // namespace fourier_opacity_test
