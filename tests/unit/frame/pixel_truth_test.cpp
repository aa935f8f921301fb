// The truth over the pixel: which of its rays count, how far they are from exact shares, and what it says of masks.
#include "measure/frame/pixel_truth.h"

#include <fmt/core.h>
#include <gtest/gtest.h>

#include "measure/frame/certify_pixels.h"
#include "measure/frame/exact_coverage.h"
#include "measure/frame/point_rays.h"
#include "measure/score/score.h"
#include "measure/scratch_folder.h"
#include "small_world.h"

namespace pixel_truth_test {

using namespace small_world;

/// Straight down from 4 meters with tan(fov / 2) = 1: of 64 x 64 pixels each covers 0.125 m of the ground at height 0, from
/// -4 to 4 along x, which runs to the right, and along z, which runs down.
View from_above() { return {.eye = {0, 4, 0}, .target = {0, 0, 0}, .up = {0, 0, -1}, .fov_y_degrees = 90}; }

Light sun(const glm::vec3& direction) { return {.name = "sun", .kind = DirectionalLight{direction}}; }
Light lamp(const glm::vec3& position) { return {.name = "lamp", .kind = PointLight{position}}; }

struct Seen {
  Scene scene;
  Light light;
  RayScene everything, casters;
  GBuffer gbuffer;
  std::vector<float> mask;
  std::vector<PixelClass> classes;
  PixelShares shares;

  Seen(Scene the_scene, const Light& the_light, const View& view = from_above(), int width = 64, int height = 64)
      : scene(std::move(the_scene)),
        light(the_light),
        everything(scene, Truth::mesh, RayScene::Which::seen),
        casters(scene, Truth::mesh, RayScene::Which::casters),
        gbuffer(gnomon::make_gbuffer(scene, everything, view, width, height, Truth::mesh)),
        mask(gbuffer.size()) {
    trace_shadows(casters, scene, gbuffer, light, mask);
    classes = classify(scene, casters, gbuffer, light, mask, find_silhouettes(everything, gbuffer));
    shares = trace_pixels(scene, everything, casters, gbuffer, light);
  }
  std::size_t pixel(int x, int y) const { return static_cast<std::size_t>(gbuffer.width) * y + x; }
  /// Whether the pixel is tested, all its rays are kept, and its share can be told exactly.
  bool has_exact(const ExactCoverage& exact, std::size_t i) const {
    return classes[i] == PixelClass::T && shares.kept[i] == pixel_rays && exact.is_within(i);
  }
  Reference reference() const { return {.mask = mask, .classes = classes}; }
  PixelTruth truth() const { return {.mean = shares.mean, .error = shares.error, .half = shares.half, .kept = shares.kept}; }
  double coverage_error(std::span<const float> of) const {
    const Evidence evidence{.width = gbuffer.width,
                            .height = gbuffer.height,
                            .classes = classes,
                            .reference = mask,
                            .mask = of,
                            .causes = {},
                            .pixel_mean = shares.mean,
                            .pixel_half = shares.half,
                            .pixel_kept = shares.kept};
    return measure_metric(Scoring(evidence), "coverage_error_mean").value();
  }
};

Mesh plate(float left, float right, float back, float front, float height) {
  return make_mesh({{left, height, back}, {left, height, front}, {right, height, front}, {right, height, back}},
                   {{0, 1, 2}, {0, 2, 3}});
}

/// Ground below casters.
Scene over_ground(std::vector<Mesh> casters) {
  Scene scene;
  scene.name = "few";
  scene.meshes = {ground(4)};
  scene.meshes.insert(scene.meshes.end(), casters.begin(), casters.end());
  return scene;
}

/// Three triangles over the ground, which the eye does not see: no pixel shows two surfaces.
Scene few_casters(std::mt19937& random) {
  Scene scene = over_ground({random_soup(random, 3, 1.5f, 0.8f, 2, 0.8f)});
  scene.meshes[1].seen = false;
  return scene;
}

/// At a slant, so that hardly an edge runs along rows or columns.
View slanted() { return {.eye = {1.3f, 4, 3.1f}, .target = {0.2f, 0, 0}, .fov_y_degrees = 50}; }

/// Under a sun and a lamp in turns.
Light light_of(int round) { return round % 2 ? sun({0.4f, -1, 0.3f}) : lamp({0.5f, 5, -1}); }

// Under a sun at 45 degrees, what is 1 m high casts its shadow 1 m to the right. Column 48 covers 2 < x < 2.125, and row 40
// covers 1 < z < 1.125.
TEST(pixel_truth, exact_shares_are_areas_of_the_pixel) {
  for (const bool is_lamp : {false, true}) {
    // A lamp 3 m high makes shadows of what is 1 m high 3/2 as large.
    const float scale = is_lamp ? 1.5f : 1, shift = is_lamp ? 0.0f : 1.0f;
    const auto at = [&](float x) { return (x - shift) / scale; };
    const Scene scene = over_ground({plate(at(1), at(2.0925f), -1 / scale, 1.02f / scale, 1)});
    const Seen seen(scene, is_lamp ? lamp({0, 3, 0}) : sun({1, -1, 0}));
    const ExactCoverage exact(seen.scene, seen.gbuffer, seen.light);
    ASSERT_TRUE(exact.is_within(seen.pixel(48, 35)) && exact.is_within(seen.pixel(48, 40)));
    EXPECT_NEAR(exact.share(seen.pixel(48, 35)), 0.0325 / 0.125, 1e-5) << "dark up to x = 2.0925";
    EXPECT_NEAR(exact.share(seen.pixel(48, 40)), 1 - 0.74 * 0.16, 1e-5) << "dark up to z = 1.02, too";
    EXPECT_NEAR(exact.share(seen.pixel(47, 35)), 0, 1e-5);
    EXPECT_NEAR(exact.share(seen.pixel(49, 35)), 1, 1e-5);
  }
  // What two casters hide counts once: the second shadow ends at 2.05, within the first.
  const Seen two(over_ground({plate(0, 1.0925f, -1, 1, 1), plate(0.5f, 1.55f, -1, 1, 0.5f)}), sun({1, -1, 0}));
  const ExactCoverage exact(two.scene, two.gbuffer, two.light);
  EXPECT_NEAR(exact.share(two.pixel(48, 35)), 0.26, 1e-5);
  // A caster below the ground hides nothing of it.
  const Seen below(over_ground({plate(-2, 2, -2, 2, -1)}), sun({1, -1, 0}));
  EXPECT_EQ(ExactCoverage(below.scene, below.gbuffer, below.light).share(below.pixel(40, 35)), 1);
}

TEST(pixel_truth, is_that_of_exact_shares_within_its_stated_errors) {
  std::mt19937 random(7);
  std::vector<double> differences, errors, at_edges, errors_at_edges;
  for (int round = 0; round < 12; ++round) {
    const Seen seen(few_casters(random), light_of(round), slanted(), 96, 54);
    const ExactCoverage exact(seen.scene, seen.gbuffer, seen.light);
    for (std::size_t i = 0; i < seen.gbuffer.size(); ++i) {
      if (!seen.has_exact(exact, i)) continue;
      const double share = exact.share(i), difference = seen.shares.mean[i] - share, error = seen.shares.error[i];
      differences.push_back(difference);
      errors.push_back(error);
      // Chosen by the exact share, which the rays have no part in.
      if (share <= 0 || share >= 1) continue;
      at_edges.push_back(difference);
      errors_at_edges.push_back(error);
    }
  }
  const StatedErrors all = stated_errors("over all pixels", differences, errors, 1e-4),
                     edges = stated_errors("at edges", at_edges, errors_at_edges, 1e-4);
  EXPECT_TRUE(all.holds()) << text(all);
  EXPECT_LT(std::abs(all.mean), 1e-4) << text(all);
  EXPECT_GT(edges.count, 300u);
  EXPECT_TRUE(edges.holds()) << text(edges);
  EXPECT_GT(edges.mean_error * std::sqrt(static_cast<double>(edges.count)), 0.005) << "there is noise to be judged";
}

TEST(pixel_truth, a_certificate_refuses_errors_that_are_stated_too_small_and_a_mean_that_is_off) {
  std::mt19937 random(11);
  Seen seen(few_casters(random), light_of(1), slanted(), 192, 108);
  const auto certificate = [&] { return certify_pixels(seen.scene, seen.light, seen.gbuffer, seen.reference(), seen.truth()); };
  const PixelCertificate right = certificate();
  EXPECT_TRUE(right.holds()) << text(right);
  EXPECT_GT(right.filled_count, 8'000u);
  ASSERT_EQ(right.comparisons.size(), 2u);
  EXPECT_GT(right.comparisons[0].count, 50u);
  EXPECT_EQ(Json(right)["truth_over"], "pixel");
  const std::vector<float> errors = seen.shares.error;
  for (float& error : seen.shares.error) error /= 8;
  EXPECT_FALSE(certificate().holds());
  seen.shares.error = errors;
  for (float& mean : seen.shares.mean) mean = std::min(1.0f, mean + 0.02f);
  EXPECT_FALSE(certificate().holds());
}

// Seen from 4 m, what is 1 m high is shown 4/3 as large. Column 48 shows 2 < x < 2.125 of the ground.
TEST(pixel_truth, rays_that_show_another_mesh_are_left_out) {
  const auto kept = [](const Mesh& mesh) {
    const Seen seen(over_ground({mesh}), sun({0, -1, 0}));
    const std::size_t i = seen.pixel(48, 32);
    EXPECT_EQ(seen.shares.mean[i], 1) << "the sun is overhead: nothing that the eye sees is dark";
    return static_cast<int>(seen.shares.kept[i]);
  };
  const auto plate_to = [](float x) { return plate(0, x * 0.75f, -1, 1, 1); };
  // Of the center's mesh, 7/10 of the square each time: of eight places of a sequence at least five and at most six.
  EXPECT_NEAR(kept(plate_to(2 + 0.7f * 0.125f)), 0.7 * pixel_rays, 5) << "the center shows the plate";
  EXPECT_NEAR(kept(plate_to(2 + 0.3f * 0.125f)), 0.7 * pixel_rays, 5) << "the center shows the ground";
  // A strip of 3/10 of a pixel around the center: too few to test the pixel.
  const int few = kept(plate(2.04375f * 0.75f, 2.08125f * 0.75f, -1, 1, 1));
  EXPECT_NEAR(few, 0.3 * pixel_rays, 5);
  EXPECT_LT(few, least_kept_rays);
}

// Of one mesh, ground up to x = s and a step beyond it. The center shows what covers 7/10 of its pixel.
TEST(pixel_truth, rays_that_are_farther_than_a_pixel_from_the_tangent_plane_are_left_out) {
  const auto kept = [](float height) {
    const float edge = (2 + 0.7f * 0.125f) * (4 - height) / 4;
    Scene scene;
    scene.meshes = {make_mesh({{-4, 0, -4},
                               {-4, 0, 4},
                               {4, 0, 4},
                               {4, 0, -4},
                               {edge, height, -4},
                               {edge, height, 4},
                               {4, height, 4},
                               {4, height, -4}},
                              {{0, 1, 2}, {0, 2, 3}, {4, 5, 6}, {4, 6, 7}})};
    const Seen seen(std::move(scene), sun({0, -1, 0}));
    return static_cast<int>(seen.shares.kept[seen.pixel(48, 32)]);
  };
  EXPECT_NEAR(kept(1), 0.7 * pixel_rays, 5);
  EXPECT_EQ(kept(0.05f), pixel_rays) << "a step of less than the width of a pixel, 0.125 m";
}

TEST(pixel_truth, pixels_without_an_answer_have_no_rays) {
  std::mt19937 random(3);
  Scene scene = few_casters(random);
  scene.meshes.push_back(box({-1, 0, -3}, {0, 1, -2}));
  scene.meshes[2].receives = false;
  const Seen seen(scene, {.name = "spot", .kind = SpotLight{{1, 3.5f, 1}, {-0.2f, -1, -0.1f}, 20, 40}}, slanted(), 96, 54);
  std::size_t without = 0, with = 0;
  for (std::size_t i = 0; i < seen.gbuffer.size(); ++i) {
    const bool faces = faces_light(seen.scene, seen.gbuffer, seen.light, i);
    (faces ? with : without) += 1;
    EXPECT_EQ(seen.shares.kept[i] > 0, faces) << i;
    if (!faces) {
      EXPECT_EQ(seen.shares.mean[i], 1) << i;
    }
    EXPECT_EQ(seen.shares.error[i] > 0, faces) << i;
  }
  EXPECT_GT(with, 1000u);
  EXPECT_GT(without, 100u);
  // The same again, whatever thread did it.
  const PixelShares again = trace_pixels(seen.scene, seen.everything, seen.casters, seen.gbuffer, seen.light);
  EXPECT_EQ(again.mean, seen.shares.mean);
  EXPECT_EQ(again.error, seen.shares.error);
  EXPECT_EQ(again.half, seen.shares.half);
  EXPECT_EQ(again.kept, seen.shares.kept);
}

/// What the reference says where each eye ray is moved aside by a part of a pixel.
std::vector<float> moved_mask(const Seen& seen, const glm::dvec2& shift) {
  const PointRays rays(seen.scene, seen.casters, seen.light);
  const Camera camera(seen.gbuffer.view, seen.gbuffer.width, seen.gbuffer.height);
  std::array<Crossings, ray_lanes> crossings;
  std::vector<float> mask;
  for (int y = 0; y < seen.gbuffer.height; ++y)
    for (int x = 0; x < seen.gbuffer.width; ++x) {
      const SurfacePoint point =
          surface_through(seen.scene, seen.everything, camera, Truth::mesh, x + 0.5 + shift.x, y + 0.5 + shift.y);
      const PointRays::Shares found = rays.ask({&point, 1}, crossings);
      mask.push_back(found.faces ? found.share[0] : 1);
    }
  return mask;
}

// A pixel that an edge cuts so that the share s is lit is off by min(s, 1 - s) in the mask of centers: by 1/4 in the mean over
// 0 < s < 1. Sixteen places in a square grid find s to some hundredths, and the truth itself has errors of some hundredths.
TEST(pixel_truth, the_mean_of_sixteen_masks_is_nearer_than_the_mask_of_centers) {
  std::mt19937 random(5);
  double of_one = 0, of_sixteen = 0;
  for (int round = 0; round < 4; ++round) {
    const Seen seen(few_casters(random), light_of(round), slanted(), 96, 54);
    std::vector<float> mean(seen.gbuffer.size(), 0);
    for (int k = 0; k < 16; ++k) {
      const std::vector<float> mask = moved_mask(seen, {(k % 4 - 1.5) / 4, (k / 4 - 1.5) / 4});
      for (std::size_t i = 0; i < mean.size(); ++i) mean[i] += mask[i] / 16;
    }
    of_one += seen.coverage_error(seen.mask);
    of_sixteen += seen.coverage_error(mean);
    const std::vector<float> unmoved = moved_mask(seen, {0, 0});
    for (std::size_t i = 0; i < mean.size(); ++i)
      EXPECT_TRUE(seen.classes[i] != PixelClass::T || unmoved[i] == seen.mask[i]) << "as the reference, at " << i;
  }
  const double ratio = of_sixteen / of_one;
  fmt::print("coverage_error_mean of the mean of 16 masks over that of one: {:.3f}\n", ratio);
  EXPECT_GT(of_one, 0);
  EXPECT_LT(ratio, 0.4);
}

TEST(pixel_truth, is_kept_in_the_cache_and_refuses_lights_with_area) {
  const ScratchFolder folder = ScratchFolder::temporary("gnomon_pixel");
  std::mt19937 random(9);
  Scene scene = few_casters(random);
  scene.lights = {light_of(0), {.name = "panel", .kind = RectLight{{0, 3, 0}, {0.5f, 0, 0}, {0, 0, 0.5f}}}};
  scene.views = {slanted()};
  const FrameKey key{scene.views[0], 48, 27, Truth::mesh};
  const auto file_count = [&] {
    const std::filesystem::directory_iterator files(folder.path());
    return std::ranges::count_if(files, [](const auto& entry) { return entry.path().extension() == ".reference"; });
  };
  const Seen seen(scene, scene.lights[0], slanted(), 48, 27);
  for (int round = 0; round < 2; ++round) {  // the first makes the file, the second finds it
    FrameStore frames(scene, folder.path());
    const PixelTruth truth = frames.pixel_truth(key, scene.lights[0]);
    EXPECT_TRUE(std::ranges::equal(truth.mean, seen.shares.mean));
    EXPECT_TRUE(std::ranges::equal(truth.error, seen.shares.error));
    EXPECT_TRUE(std::ranges::equal(truth.half, seen.shares.half));
    EXPECT_TRUE(std::ranges::equal(truth.kept, seen.shares.kept));
    EXPECT_EQ(file_count(), 1);
  }
  FrameStore frames(scene, folder.path());
  EXPECT_THROW(frames.pixel_truth(key, scene.lights[1]), Error);
}

}  // namespace pixel_truth_test
