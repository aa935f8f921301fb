// The curve of a texel that holds moments of absorbance, on paper and in stacks of plates.
#include <gnomon/kit/random.h>
#include <gtest/gtest.h>

#include "plate_stack.h"
#include "techniques/moment_transmittance/curve.h"

namespace moment_transmittance_test {
using namespace gnomon;
using namespace gnomon::moment_transmittance;
using plate_stack::Plate;

template <class Real>
Moments<Real> moments_of(const std::vector<Plate>& plates) {
  Moments<Real> moments;
  for (const Plate& plate : plates) moments.add(static_cast<Real>(plate.t), static_cast<Real>(plate.absorbance()));
  return moments;
}

template <class Real>
Canonical<Real> canonical_at(const Moments<Real>& moments, Real t, Real moment_bias) {
  Real n[4];
  for (int k = 0; k < 4; ++k) n[k] = moments.b[k + 1] / moments.b[0];
  return canonical(n, 2 * t - 1, moment_bias);
}

// tau = -ln(1 - alpha) = .693147, .287682, 1.609438 at z = -.6, 0, .4; their sum 2.590267, and divided by it
//   b1 = (-.6 * .693147 + .4 * 1.609438) / 2.590267 = .087978 and so on.
TEST(MomentTransmittance, the_stack_on_paper_has_these_moments) {
  const Moments<double> moments = moments_of<double>(plate_stack::on_paper());
  EXPECT_NEAR(moments.b[0], 2.590267, 1e-6);
  const double normalized[] = {.087978, .195749, -.018035, .050587};
  for (int k = 0; k < 4; ++k) EXPECT_NEAR(moments.b[k + 1] / moments.b[0], normalized[k], 1e-6);
}

struct Row {
  double t;
  double roots[2], w0, weights[2];
  double lower, upper, quarter;
};
constexpr Row table[] = {{.1, {-.476353, .385036}, .053112, {.271791, .675096}, .871469, 1, .966191},
                         {.35, {-.641915, .388985}, .134537, {.202069, .663394}, .418157, .592496, .543061},
                         {.6, {-.589818, .427308}, .233871, {.281351, .484778}, .263273, .482500, .414691},
                         {.9, {-.579564, .354954}, .015948, {.293278, .690774}, .075, .078163, .077360}};

template <class Real>
void expect_table(double tolerance) {
  const Moments<Real> moments = moments_of<Real>(plate_stack::on_paper());
  for (const Row& row : table) {
    const Canonical<Real> found = canonical_at(moments, static_cast<Real>(row.t), Real(0));
    const double other = 1.0 / double(found.g);
    const bool is_first = double(found.z) < other;
    EXPECT_NEAR(is_first ? double(found.z) : other, row.roots[0], tolerance) << row.t;
    EXPECT_NEAR(is_first ? other : double(found.z), row.roots[1], tolerance) << row.t;
    EXPECT_NEAR(double(found.w0), row.w0, tolerance) << row.t;
    EXPECT_NEAR(double(is_first ? found.w : found.wg), row.weights[0], tolerance) << row.t;
    EXPECT_NEAR(double(is_first ? found.wg : found.w), row.weights[1], tolerance) << row.t;
    const auto share = [&](double beta) {
      return double(transmittance(moments, static_cast<Real>(row.t), Real(0), static_cast<Real>(beta)));
    };
    EXPECT_NEAR(share(1), row.lower, tolerance) << row.t;
    EXPECT_NEAR(share(0), row.upper, tolerance) << row.t;
    EXPECT_NEAR(share(0.25), row.quarter, tolerance) << row.t;
  }
}
TEST(MomentTransmittance, the_table_on_paper_comes_out_without_bias) { expect_table<double>(1e-6); }
TEST(MomentTransmittance, the_table_on_paper_comes_out_in_float32) { expect_table<float>(2e-5); }

// A measure on three points that has the moments: its own are them again. A root far away has next to no weight, known but to
// the rounding of 1.
TEST(MomentTransmittance, the_measure_has_the_moments_that_it_is_made_of) {
  Random random(11);
  for (int round = 0; round < 1000; ++round) {
    const Moments<double> moments = moments_of<double>(plate_stack::random_plates(random, 3, 8));
    const double t = random.uniform(0, 1), z0 = 2 * t - 1;
    const Canonical<double> found = canonical_at(moments, t, 0.0);
    const double at[] = {z0, found.z, 1 / found.g}, weight[] = {found.w0, found.w, found.wg};
    for (int k = 0; k < 5; ++k) {
      double sum = 0;
      for (int i = 0; i < 3; ++i) sum += weight[i] * std::pow(at[i], k);
      const double tolerance = 1e-7 + 0x1p-50 * std::pow(std::abs(found.z) + std::abs(1 / found.g), k);
      EXPECT_NEAR(sum, moments.b[k] / moments.b[0], tolerance) << "moment " << k << " of round " << round;
    }
  }
}

// Of all absorbances with these moments the bounds are the sharpest: the true one is among them. Plates: random_plates.
TEST(MomentTransmittance, bounds_hold_in_random_stacks) {
  Random random(12);
  double width = 0, error = 0;
  int count = 0;
  for (int round = 0; round < 4000; ++round) {
    const std::vector<Plate> plates = plate_stack::random_plates(random, 3, 8);
    const Moments<double> moments = moments_of<double>(plates);
    for (int i = 0; i < 8; ++i) {
      const double t = random.uniform(0, 1), exact = plate_stack::share_before(plates, t);
      const double lower = transmittance(moments, t, 0.0, 1.0), upper = transmittance(moments, t, 0.0, 0.0);
      ASSERT_LE(lower, exact + 1e-9) << "round " << round << ", t " << t;
      ASSERT_GE(upper, exact - 1e-9) << "round " << round << ", t " << t;
      width += upper - lower;
      error += std::abs(transmittance(moments, t, 0.0, 0.25) - exact);
      ++count;
    }
  }
  EXPECT_NEAR(width / count, 0.226, 0.01);
  EXPECT_NEAR(error / count, 0.062, 0.004);
}

// What is behind everything is known: the sum is a moment.
TEST(MomentTransmittance, the_lower_bound_is_exact_behind_everything_and_the_upper_one_before) {
  Random random(13);
  for (int round = 0; round < 500; ++round) {
    std::vector<Plate> plates = plate_stack::random_plates(random, 3, 8);
    for (Plate& plate : plates) plate.t = 0.1 + 0.8 * plate.t;
    const Moments<double> moments = moments_of<double>(plates);
    EXPECT_NEAR(transmittance(moments, 1.0, 0.0, 1.0), std::exp(-moments.b[0]), 1e-9);
    EXPECT_NEAR(transmittance(moments, 0.0, 0.0, 0.0), 1, 1e-9);
  }
}

// One surface and two make the matrix singular. In float32 and with the bias that is the default, an answer that is a share of
// the light comes out anywhere, also at the surfaces; farther from them than 1/20 it is off by less than 1/40.
TEST(MomentTransmittance, two_surfaces_do_not_fail_in_float32) {
  Random random(14);
  for (int round = 0; round < 20000; ++round) {
    std::vector<Plate> plates = plate_stack::random_plates(random, 1, 2);
    if (round % 8 == 0) plates.push_back(plates[0]);                       // twice at one depth
    if (round % 8 == 1) plates[0].t = static_cast<double>(round / 8 % 2);  // at an end
    const Moments<float> moments = moments_of<float>(plates);
    for (int i = 0; i < 10; ++i) {
      const double t = i == 0 ? plates[0].t : random.uniform(0, 1);
      double nearest = 1;
      for (const Plate& plate : plates) nearest = std::min(nearest, std::abs(plate.t - t));
      for (const float beta : {0.0f, 0.25f, 1.0f}) {
        const float share = transmittance(moments, static_cast<float>(t), 5e-7f, beta);
        ASSERT_TRUE(share >= 0 && share <= 1) << share << " in round " << round;
        if (nearest > 0.05) {
          ASSERT_NEAR(share, plate_stack::share_before(plates, t), 1.0 / 40) << "round " << round;
        }
      }
    }
  }
}

// Half of a filter that lets all light through and half .01: the mean of the light is .505, what comes of the mean absorbance
// is sqrt(.01).
TEST(MomentTransmittance, mean_absorbance_darkens) {
  Moments<double> mean = moments_of<double>({{0.3, 0.99}});
  for (double& b : mean.b) b /= 2;
  EXPECT_NEAR(transmittance(mean, 1.0, 5e-7, 0.25), 0.1, 1e-4);
}

TEST(MomentTransmittance, nothing_on_the_ray_is_all_light) {
  EXPECT_EQ(transmittance(Moments<float>(), 0.5f, 5e-7f, 0.25f), 1);
}

}  // namespace moment_transmittance_test
