// The certificate of a reference mask, on a floor under a square.
#include "measure/frame/certify.h"

#include <gnomon/error.h>
#include <gnomon/kit/geometry/shapes.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "hand_made.h"

namespace gnomon::certify_test {

using namespace hand_made;

/// 100 x 100 points on a floor of half side 5 (off the diagonal, where two triangles of the square meet), under a square of
/// half side 1.
struct CertifiedScene {
  Scene scene;
  hand_made::Picture picture{100, 100};
  Light light = point_light({0, 2, 0});
  std::vector<float> reference;

  CertifiedScene() {
    scene.name = "floor";
    scene.meshes = {square(5, 0), square(1, 1)};
    picture.gbuffer.view = {.name = "top", .eye = {0, 8, 0}, .target = {0, 0, 0}, .up = {0, 0, 1}};
    for (int y = 0; y < 100; ++y)
      for (int x = 0; x < 100; ++x) {
        const float px = (static_cast<float>(x) - 49.7f) / 10, pz = (static_cast<float>(y) - 49.4f) / 10;
        picture.set(100 * y + x, {px, 0, pz}, {0, 1, 0}, 0, px > pz ? 1 : 0);
      }
    reference.resize(picture.gbuffer.size());
    ExactScene(scene).decide(picture.gbuffer, light, reference);
  }
};

// The shadow covers |x|, |z| < 2: columns 30 .. 69 (x = -1.97 .. 1.93), 40 of 100. The band of 2 pixels is the square ring of
// columns and rows 28 .. 71 without 32 .. 67: 44^2 - 36^2 = 640 pixels.
TEST(Certify, an_exact_reference_is_certified_with_three_over_n) {
  CertifiedScene s;
  ASSERT_EQ(std::count(s.reference.begin(), s.reference.end(), 0.0f), 40 * 40);
  const Certificate c = certify(s.scene, s.light, s.picture.gbuffer, s.reference);
  EXPECT_TRUE(c.holds());
  EXPECT_EQ(c.facing_count, 10'000u);
  EXPECT_EQ(c.band_count, 640u);
  EXPECT_NEAR(static_cast<double>(c.random_count), 0.02 * 9360, 60);  // 4 standard deviations: 4 sqrt(9360 * 0.02 * 0.98)
  EXPECT_EQ(c.query_count, c.band_count + c.random_count);
  EXPECT_EQ(c.tally.rays, c.query_count);
  EXPECT_EQ(c.uncertain_count, 0u);
  EXPECT_NEAR(c.bound, 3.0 / static_cast<double>(c.query_count), 0.01 / static_cast<double>(c.query_count));
  EXPECT_DOUBLE_EQ(c.clearance_floor, 4 * 0x1p-24 * 8);  // the eye is the farthest
  EXPECT_EQ(c.lattice_exponent, 0);                      // all corners and the light are integers
  EXPECT_NE(text(c).find("certified"), std::string::npos);
  EXPECT_EQ(Json(c)["queries"], c.query_count);
}

TEST(Certify, a_wrong_pixel_is_found_unless_it_is_uncertain) {
  CertifiedScene s;
  const std::size_t wrong = 100 * 50 + 68;  // x = 1.83: dark, in the band
  s.reference[wrong] = 1;
  const Certificate c = certify(s.scene, s.light, s.picture.gbuffer, s.reference);
  EXPECT_FALSE(c.holds());
  EXPECT_EQ(c.disagreements, std::vector<std::size_t>{wrong});
  // The segment to the light passes the edge x = 1, y = 1; its clearance, in the plane z = 0.03 t: the line from (1.83, 0) to
  // (0, 2) is at (0.915, 1) there, 0.085 beside, times cos of its slope 2 / sqrt(1.83^2 + 2^2) = 0.738: 0.0627. Carried by
  // about 2.
  const Certificate excused =
      certify(s.scene, s.light, s.picture.gbuffer, s.reference, {.is_uncertain = [&](std::size_t i) { return i == wrong; }});
  EXPECT_TRUE(excused.holds());
  EXPECT_EQ(excused.uncertain_count, 1u);
  EXPECT_EQ(excused.uncertain_disagreement_count, 1u);
  EXPECT_NEAR(excused.worst_margin, 2 * 0.0627, 0.01);
}

// A pixel whose segment goes exactly through the square's edge: degenerate, and below every margin.
TEST(Certify, a_degenerate_pixel_is_uncertain) {
  CertifiedScene s;
  s.picture.set(100 * 50 + 70, {2, 0, 0.5f}, {0, 1, 0}, 0, 1);
  const Certificate c = certify(s.scene, s.light, s.picture.gbuffer, s.reference);
  EXPECT_TRUE(c.holds());
  EXPECT_EQ(c.degenerate_count, 1u);
  EXPECT_EQ(c.close_count, 1u);
  EXPECT_EQ(c.uncertain_count, 1u);
  EXPECT_EQ(c.uncertain_disagreement_count, 1u);  // the reference says lit, closed triangles say dark
  EXPECT_EQ(c.worst_margin, 0);
}

TEST(Certify, what_the_oracle_does_not_know_is_an_error) {
  CertifiedScene s;
  const Light area{.name = "area", .kind = RectLight{}};
  EXPECT_THROW(certify(s.scene, area, s.picture.gbuffer, s.reference), Error);
  s.scene.meshes.push_back(tessellate(Sphere{}, 8, "sphere"));
  s.picture.gbuffer.truth = Truth::shape;
  EXPECT_THROW(certify(s.scene, s.light, s.picture.gbuffer, s.reference), Error);
}

// P(X <= 0) = (1 - p)^n = 0.05 gives 1 - 0.05^(1/n), near 3 / n; P(X <= 1) of two trials is 1 - p^2 = 0.05, p = sqrt(0.95).
TEST(Certify, the_bound_is_clopper_and_pearsons) {
  EXPECT_NEAR(upper_bound_95(0, 1000), 1 - std::pow(0.05, 0.001), 1e-12);
  EXPECT_NEAR(upper_bound_95(0, 1'000'000), 3e-6, 0.005e-6);
  EXPECT_NEAR(upper_bound_95(1, 2), std::sqrt(0.95), 1e-12);
  EXPECT_EQ(upper_bound_95(5, 5), 1);
  EXPECT_EQ(upper_bound_95(0, 0), 1);
}

}  // namespace gnomon::certify_test
