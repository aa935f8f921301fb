#include "measure/score/together.h"

#include <gnomon/kit/rays/gbuffer_maker.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>
#include <numeric>

#include "measure/cause/own_causes.h"
#include "measure/picture/picture.h"
#include "measure/picture/shading.h"
#include "measure/scene/load.h"
#include "measure/score/score.h"

namespace together_test {

using namespace gnomon;

// Four pixels of a level ground, two suns: one from straight above (N.l = 1, intensity 1), one at 60 degrees from the zenith
// (N.l = 1/2) of intensity 4, which gives 2. Without shadows a pixel receives 3.
class Suns : public testing::Test {
 protected:
  Suns() {
    Mesh ground;
    ground.positions = {{-1, 0, -1}, {-1, 0, 1}, {1, 0, 1}};
    ground.triangles = {{0, 1, 2}};
    ground.albedo = glm::vec3(0.5f);
    scene.meshes = {ground};
    scene.ambient = 0;
    for (int i = 0; i < 4; ++i) {
      ny[i] = 1;
      mesh[i] = 0;
    }
    gbuffer.width = 4, gbuffer.height = 1;
    gbuffer.px = gbuffer.py = gbuffer.pz = gbuffer.nx = gbuffer.nz = zeros;
    gbuffer.ny = ny;
    gbuffer.mesh = gbuffer.triangle = mesh;
  }
  Evidence of(const Light& light, std::span<const float> reference, std::span<const float> mask,
              std::span<const PixelClass> classes) const {
    Evidence e{.width = 4, .height = 1, .classes = classes, .reference = reference, .mask = mask};
    e.scene = &scene, e.gbuffer = &gbuffer, e.light = &light;
    return e;
  }

  Scene scene;
  std::array<float, 4> zeros{}, ny{};
  std::array<std::uint32_t, 4> mesh{};
  GBuffer gbuffer;
  const float sine = std::sqrt(0.75f);
  const Light high{.name = "high", .kind = DirectionalLight{{0, -1, 0}}, .intensity = 1};
  const Light low{.name = "low", .kind = DirectionalLight{{sine, -0.5f, 0}}, .intensity = 4};
  const std::vector<PixelClass> tested = std::vector(4, PixelClass::T);
};

// Right; dark under `high`; dark under `low`; dark under both where the reference is lit by both.
TEST_F(Suns, visibility_is_the_share_of_the_light_received) {
  const std::vector<float> lit(4, 1.0f), of_high{1, 0, 1, 0}, of_low{1, 1, 0, 0};
  const Evidence lights[] = {of(high, lit, of_high, tested), of(low, lit, of_low, tested)};
  const Together all = together(lights);
  for (int i = 0; i < 4; ++i) EXPECT_NEAR(all.received[i], 3, 1e-6);
  EXPECT_NEAR(all.mask[0], 1, 1e-6);
  EXPECT_NEAR(all.mask[1], 2.0 / 3, 1e-6);
  EXPECT_NEAR(all.mask[2], 1.0 / 3, 1e-6);
  EXPECT_EQ(all.mask[3], 0);
  EXPECT_EQ(all.reference, lit);

  // Differences of 0, 1, 2 and 3 against 3 everywhere: rms sqrt(14 / 4), relative sqrt(14 / 36); mean 6 / 4.
  const Evidence e = all.evidence();
  const Scoring scoring(e);
  EXPECT_NEAR(*measure_metric(scoring, "received_error_rms"), std::sqrt(14.0 / 36), 1e-6);
  EXPECT_NEAR(*measure_metric(scoring, "received_error_mean"), 1.5, 1e-6);
  EXPECT_NEAR(*measure_metric(scoring, "wrong_rate"), 0.5, 1e-9) << "off by 2 and by 3 of 3";
  EXPECT_LT(*measure_metric(scoring, "flip"), 1);
  EXPECT_GT(*measure_metric(scoring, "flip"), 0);
}

// What half of the rays say is off by 0.5 under `low`, which gives two thirds of the light: by a third, and not at all where
// `low` is not tested.
TEST_F(Suns, the_half_counts_where_the_light_is_tested) {
  const std::vector<float> lit(4, 1.0f), half(4, 0.5f);
  std::vector<PixelClass> some = tested;
  some[3] = PixelClass::U;
  Evidence lights[] = {of(high, lit, lit, tested), of(low, lit, lit, some)};
  lights[1].reference_half = half;
  const Together all = together(lights);
  for (int i = 0; i < 3; ++i) EXPECT_NEAR(all.reference_half[i], 2.0 / 3, 1e-6);
  EXPECT_EQ(all.reference_half[3], 1);
  EXPECT_NEAR(*measure_metric(Scoring(all.evidence()), "error_floor"), 1.1 * 0.25, 1e-6);
}

// Where `low` is not tested its reference counts on both sides: only what is wrong under `high` remains.
TEST_F(Suns, a_light_that_is_not_tested_at_a_pixel_is_right_there) {
  const std::vector<float> lit(4, 1.0f), dark(4, 0.0f);
  const std::vector<PixelClass> of_high{PixelClass::T, PixelClass::T, PixelClass::U, PixelClass::F};
  const std::vector<PixelClass> of_low{PixelClass::T, PixelClass::U, PixelClass::U, PixelClass::F};
  const Evidence lights[] = {of(high, lit, dark, of_high), of(low, lit, dark, of_low)};
  const Together all = together(lights);
  EXPECT_EQ(all.classes, (std::vector{PixelClass::T, PixelClass::T, PixelClass::U, PixelClass::F}));
  EXPECT_EQ(all.mask[0], 0);
  EXPECT_NEAR(all.mask[1], 2.0 / 3, 1e-6);
  EXPECT_EQ(all.mask[2], 1);
  for (int i = 0; i < 4; ++i) EXPECT_EQ(all.shown[i], 0) << "pictures show what the technique answered";
}

// The light that errs more names the pixel: `low` gives twice as much.
TEST_F(Suns, a_pixel_has_the_cause_of_the_light_that_errs_most) {
  const std::vector<float> lit(4, 1.0f), dark{0, 0, 1, 1};
  const std::vector<Cause> acne{Cause::acne, Cause::acne, Cause::none, Cause::none};
  const std::vector<Cause> crack{Cause::none, Cause::crack, Cause::crack, Cause::none};
  const std::vector<float> dark_low{1, 0, 0, 1};
  Evidence lights[] = {of(high, lit, dark, tested), of(low, lit, dark_low, tested)};
  lights[0].causes = acne;
  lights[1].causes = crack;
  const Together all = together(lights);
  EXPECT_EQ(all.causes, (std::vector{Cause::acne, Cause::crack, Cause::crack, Cause::none}));
  // Shares of the light received that are missing: 1/3, 3/3, 2/3, 0; as means over four pixels they add up to the mean error.
  const auto errors = cause_errors(all.evidence());
  EXPECT_NEAR(errors.at("acne"), 1.0 / 12, 1e-6);
  EXPECT_NEAR(errors.at("crack"), 5.0 / 12, 1e-6);
  EXPECT_NEAR(*measure_metric(Scoring(all.evidence()), "error"), 6.0 / 12, 1e-6);
  // A cause of the technique's own is like any other.
  const std::vector<CauseInfo> own{{own_cause(0), "off_screen", "It is out of the picture.", {252, 0, 132}}};
  const std::vector<Cause> off_screen{Cause::none, own_cause(0), own_cause(0), Cause::none};
  for (Evidence& light : lights) light.own_causes = own;
  lights[1].causes = off_screen;
  const Together with_own = together(lights);
  EXPECT_EQ(with_own.causes, (std::vector{Cause::acne, own_cause(0), own_cause(0), Cause::none}));
  EXPECT_NEAR(cause_errors(with_own.evidence()).at("off_screen"), 5.0 / 12, 1e-6);
  EXPECT_EQ(cause_errors(with_own.evidence()).at("crack"), 0);
}

// Independent errors add up as squares do: 0.01 of 1 and 0.02 of 2 are sqrt(0.01^2 + 0.04^2) of 3.
TEST_F(Suns, standard_errors_of_the_reference_add_up_as_squares) {
  const std::vector<float> lit(4, 1.0f), of_high(4, 0.01f), of_low(4, 0.02f);
  Evidence lights[] = {of(high, lit, lit, tested), of(low, lit, lit, tested)};
  lights[0].reference_error = of_high;
  lights[1].reference_error = of_low;
  EXPECT_NEAR(together(lights).reference_error[0], std::sqrt(0.0001 + 0.0016) / 3, 1e-7);
  lights[0].reference_error = {};
  EXPECT_NEAR(together(lights).reference_error[0], 0.04 / 3, 1e-7) << "a light without area has none";
}

// What a tenth of the lit pixels receives more than is exposed to show a surface as bright as its albedo, here 1/2, whatever
// the lights' watts; half of the light is then half of that.
TEST_F(Suns, pictures_are_exposed_for_what_is_lit) {
  const std::vector<float> shares{1, 0.5f, 0, 1};
  for (const double watts : {3.0, 1e-6, 1e9}) {
    const std::vector<double> received{watts, watts, watts, 0.5 * watts};
    EXPECT_NEAR(exposure_of(scene, gbuffer, received) * watts, 1, 1e-12);
    const Picture picture = shade(scene, gbuffer, received, shares);
    EXPECT_NEAR(picture.rgb[0], srgb(0.5), 1);
    EXPECT_NEAR(picture.rgb[3], srgb(0.25), 1);
    EXPECT_EQ(picture.rgb[6], 0);
    EXPECT_NEAR(picture.rgb[9], srgb(0.25), 1);
  }
  EXPECT_EQ(exposure_of(scene, gbuffer, std::vector<double>{0, 0, 0, 8}), 0.125) << "what is not lit does not count";
  EXPECT_EQ(exposure_of(scene, gbuffer, std::vector<double>(4, 0)), 1) << "nothing is lit";
  std::vector<double> many(100, 2);
  std::fill_n(many.begin(), 10, 1000.0);
  EXPECT_EQ(exposure_of(scene, gbuffer, many), 0.5) << "a tenth is brighter";
  many[50] = 1000;
  EXPECT_EQ(exposure_of(scene, gbuffer, many), 0.001);
  scene.ambient = 0.25f;
  EXPECT_EQ(exposure_of(scene, gbuffer, std::vector<double>(4, 3)), 0.25) << "with the ambient light as bright as the albedo";
  gbuffer.view.exposure = 0.5f;
  EXPECT_EQ(exposure_of(scene, gbuffer, std::vector<double>(4, 3)), 0.5) << "the view's own";
}

// A point light over the fence, one ten times farther, and a bulb of 1 cm radius in the place of the first with the same number
// for its radiance: the bulb sends pi r^2 = 0.000314 W/sr.
TEST(together, lights_count_by_what_they_give) {
  const Scene scene = load_scene("fence");
  const glm::vec3 place(-1.5f, 2.6f, -3.5f);
  const RayScene everything(scene, Truth::mesh, RayScene::Which::seen);
  const GBuffer gbuffer = make_gbuffer(scene, everything, scene.views[0], 320, 180, Truth::mesh);
  std::vector<double> sums;
  for (const Light& light : {Light{.kind = PointLight{place}}, Light{.kind = PointLight{10.0f * place}},
                             Light{.kind = SphereLight{.center = place, .radius = 0.01f}}}) {
    const std::vector<double> received = received_light(gbuffer, light);
    sums.push_back(std::accumulate(received.begin(), received.end(), 0.0));
  }
  const double all = sums[0] + sums[1] + sums[2];
  EXPECT_NEAR(sums[0] / all, 0.983, 0.00983);
  EXPECT_NEAR(sums[1] / all, 0.017, 0.0017);
  EXPECT_NEAR(sums[2] / all, 0.983 * std::numbers::pi * 1e-4, 3e-6);
}

}  // namespace together_test
