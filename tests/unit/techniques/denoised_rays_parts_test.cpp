// The parts of denoised rays alone: blending, the terms of an error, the way back to the frame before, widths.
#include <gnomon/kit/geometry/camera.h>
#include <gtest/gtest.h>

#include <cmath>

#include "techniques/denoised_rays/twin.h"
#include "techniques/denoised_rays/widths.h"
#include "walking_world.h"

namespace denoised_rays_parts_test {
using namespace gnomon;
using namespace gnomon::denoised_rays;

// Pixels 0 .. 6, kernel (1/4, 1/2, 1/4), a = 0.2. At pixel 3 the means over frames are .8 .92 .56, their mean over pixels is
// .8; of the exact shares .96 .88 .66, hence .845; and .8 .4 .1 without memory, hence .425.
TEST(denoised_rays_parts, terms_of_an_error_are_those_on_paper) {
  constexpr std::array<float, 7> found{1, 1, 0, 1, 0, 0, 0}, exact{1, 1, .8f, .4f, .1f, 0, 0};
  constexpr std::array<float, 7> exact_before{1, 1, 1, 1, .8f, .4f, .1f}, before{1, 1, 1, .9f, .7f, .5f, .2f};
  const Blend blend{.newest = 0.2f};
  const auto filtered = [](const auto& value) { return 0.25 * value(2) + 0.5 * value(3) + 0.25 * value(4); };
  const double out = filtered([&](int i) { return blend.of(found[i], blend.held(before[i], 1)); });
  const double twin = filtered([&](int i) { return blend.of(exact[i], blend.held(exact_before[i], 1)); });
  const double still = filtered([&](int i) { return exact[i]; });
  EXPECT_NEAR(out, 0.8, 1e-7);
  const ErrorParts parts = error_parts(out, twin, still, exact[3]);
  EXPECT_NEAR(parts.residual_noise, -0.045, 1e-7);
  EXPECT_NEAR(parts.stale_history, 0.42, 1e-7);
  EXPECT_NEAR(parts.over_blur, 0.025, 1e-7);
  EXPECT_NEAR(parts.residual_noise + parts.stale_history + parts.over_blur, out - exact[3], 1e-15);
}

// A history of 3 of 4 is a share of 3/4: within 1/2 .. 1 it stays, held below 1/2 it becomes 2 of 4.
TEST(denoised_rays_parts, a_history_is_held_by_its_share) {
  EXPECT_EQ((Blend{.newest = 0.5f, .low = 0.5f, .high = 1}).held(3, 4), 3);
  EXPECT_EQ((Blend{.newest = 0.5f, .low = 0.25f, .high = 0.5f}).held(3, 4), 2);
  EXPECT_EQ((Blend{.newest = 0.5f, .low = 0.875f, .high = 1.5f}).held(3, 4), 3.5f);
  EXPECT_EQ((Blend{.newest = 0.5f, .low = 0.25f, .high = 0.5f}).held(0, 0), 0) << "nothing was asked";
}

// (2.25, 3.5): weights 3/8 1/8 above, 3/8 1/8 below. Without the last one they are divided by 7/8.
TEST(denoised_rays_parts, weights_of_a_source_sum_to_one_over_what_is_kept) {
  const SourceTaps taps({2.25f, 3.5f, 0b0111}, 10);
  ASSERT_EQ(taps.count, 3);
  EXPECT_EQ(taps.pixel[0], 32u);
  EXPECT_EQ(taps.pixel[1], 33u);
  EXPECT_EQ(taps.pixel[2], 42u);
  EXPECT_NEAR(taps.weight[0], 3.0 / 7, 1e-7);
  EXPECT_NEAR(taps.weight[1], 1.0 / 7, 1e-7);
  EXPECT_NEAR(taps.weight[2], 3.0 / 7, 1e-7);
  EXPECT_EQ(SourceTaps({2.25f, 3.5f, 0}, 10).count, 0);
}

// The triangle is turned by a quarter about y, doubled and lifted by 5; the point is a + (b - a) / 4 + (c - a) / 2.
TEST(denoised_rays_parts, a_point_goes_back_with_its_triangle) {
  const std::array<glm::vec3, 3> before{glm::vec3(0), {4, 0, 0}, {0, 0, -4}}, now{glm::vec3(0, 5, 0), {0, 5, -8}, {-8, 5, 0}};
  const auto point = carried_back({{-4, 5, -2}, {0, 1, 0}}, now, before);
  ASSERT_TRUE(point);
  EXPECT_NEAR(glm::distance(point->position, glm::dvec3(1, 0, -2)), 0, 1e-12);
  EXPECT_NEAR(glm::distance(point->normal, glm::dvec3(0, 1, 0)), 0, 1e-12);
  // Seen from the other side, the normal is on that side.
  const auto below = carried_back({{-4, 5, -2}, {0, -1, 0}}, now, before);
  ASSERT_TRUE(below);
  EXPECT_NEAR(glm::distance(below->normal, glm::dvec3(0, -1, 0)), 0, 1e-12);
  EXPECT_FALSE(carried_back({{-4, 5, -2}, {0, 1, 0}}, now, {glm::vec3(0), {4, 0, 0}, {2, 0, 0}})) << "it had no area";
}

/// Guides over all that is seen.
struct Picture {
  GBuffer gbuffer;
  std::vector<std::uint8_t> faces;
  FilterGuides guides;
  std::vector<float> lengths;

  explicit Picture(GBuffer of) : gbuffer(std::move(of)), faces(gbuffer.size(), 1), lengths(gbuffer.size(), 1) {
    for (std::size_t i = 0; i < faces.size(); ++i) faces[i] = gbuffer.is_background(i) ? 0 : 1;
    guides.make(gbuffer, faces);
  }
};

/// Pixels from the left and from the top, of centers at whole numbers: by the rays of the camera, not by its projection.
glm::dvec2 pixel_of(const GBuffer& gbuffer, const glm::dvec3& point) {
  const Camera camera(gbuffer.view, gbuffer.width, gbuffer.height);
  const glm::dvec3 corner = camera.ray(0, 0), across = camera.ray(gbuffer.width, 0) - corner,
                   down = camera.ray(0, gbuffer.height) - corner, to = point - camera.eye;
  const glm::dvec3 on_plane = to / glm::dot(to, camera.forward) - corner;
  return {glm::dot(on_plane, across) / glm::dot(across, across) * gbuffer.width - 0.5,
          glm::dot(on_plane, down) / glm::dot(down, down) * gbuffer.height - 0.5};
}

// Both boxes move by 2 m/s along x, 1/4 m a frame, which is exact in float32.
TEST(denoised_rays_parts, points_of_a_moving_box_go_back_exactly) {
  walking_world::Row row("walk");
  const Picture before(row.picture());
  const auto first = std::make_shared<const Pose>(row.scene);
  Reprojection reprojection;
  reprojection.follow(row.scene, first, before.gbuffer, before.guides, before.faces, {}, false);
  reprojection.keep(before.gbuffer, first);
  row.go_to(1);
  const auto second = std::make_shared<const Pose>(first->after(row.scene, row.posed.take_changes()));
  EXPECT_TRUE(second->has_still(*first, 0));
  EXPECT_FALSE(second->has_still(*first, 1));
  const Picture now(row.picture());
  reprojection.follow(row.scene, second, now.gbuffer, now.guides, now.faces, before.lengths, false);
  int moved = 0, still = 0, refused = 0;
  for (std::size_t i = 0; i < now.gbuffer.size(); ++i) {
    if (!now.faces[i]) continue;
    const Source& source = reprojection.sources()[i];
    refused += reprojection.is_refused(i);
    EXPECT_EQ(reprojection.is_refused(i), source.kept == 0) << i;
    if (source.kept == 0) continue;
    if (now.gbuffer.mesh[i] == 0) {
      still += source.x == static_cast<float>(i % now.gbuffer.width) && source.kept == 1;
      continue;
    }
    const glm::dvec2 at = pixel_of(before.gbuffer, glm::dvec3(now.gbuffer.position(i)) - glm::dvec3(0.25, 0, 0));
    EXPECT_NEAR(source.x, at.x, 1e-3) << i;
    EXPECT_NEAR(source.y, at.y, 1e-3) << i;
    ++moved;
  }
  EXPECT_GT(moved, 50);
  EXPECT_GT(still, 1000);
  EXPECT_GT(refused, 5) << "ground that the boxes hid";
}

// Seen from 10 m above with a half angle of 45 degrees, 40 pixels are 20 m: the eye moves by 1.75 m, 3.5 pixels. Of the
// three columns whose centers come in nothing was seen.
TEST(denoised_rays_parts, points_of_still_ground_follow_the_camera) {
  Scene scene;
  scene.meshes = {small_world::ground(100)};
  const auto from = [&](float x) {
    return Picture(small_world::make_gbuffer(
        scene, {.eye = {x, 10, 0}, .target = {x, 0, 0}, .up = {0, 0, -1}, .fov_y_degrees = 90}, 40, 40));
  };
  const Picture before = from(0), now = from(1.75f);
  const auto pose = std::make_shared<const Pose>(scene);
  Reprojection reprojection;
  reprojection.follow(scene, pose, before.gbuffer, before.guides, before.faces, {}, false);
  reprojection.keep(before.gbuffer, pose);
  reprojection.follow(scene, pose, now.gbuffer, now.guides, now.faces, before.lengths, false);
  for (std::size_t i = 0; i < now.gbuffer.size(); ++i) {
    const std::size_t x = i % 40;
    const Source& source = reprojection.sources()[i];
    EXPECT_EQ(source.kept == 0, x + 3 > 39) << i;
    EXPECT_EQ(reprojection.began_refused(i), source.kept == 0) << i;
    if (source.kept == 0) continue;
    EXPECT_NEAR(source.x, static_cast<double>(x) + 3.5, 1e-3) << i;
    EXPECT_NEAR(source.y, static_cast<double>(i / 40), 1e-3) << i;
  }
  // Dropped histories are gone, and nothing is refused.
  reprojection.follow(scene, pose, now.gbuffer, now.guides, now.faces, before.lengths, true);
  for (std::size_t i = 0; i < now.gbuffer.size(); ++i) {
    EXPECT_EQ(reprojection.sources()[i].kept, 0u);
    EXPECT_FALSE(reprojection.is_refused(i));
  }
}

// Seen from 60 degrees off its normal a flat lamp covers half as much, so that its mean half width is sqrt(1/2) of it.
TEST(denoised_rays_parts, a_lamp_has_the_size_that_it_shows) {
  const Light square{.kind = RectLight{{0, 4, 0}, {1, 0, 0}, {0, 0, 1}}};
  EXPECT_NEAR(lamp_size(square, {0, 0, 0}).half_width, 1, 1e-7);
  EXPECT_NEAR(lamp_size(square, {0, 0, 0}).distance, 4, 1e-7);
  EXPECT_NEAR(lamp_size(square, {4 * std::sqrt(3.0), 0, 0}).half_width, std::sqrt(0.5), 1e-6);
  const Light disc{.kind = DiscLight{{0, 4, 0}, {0, -3, 0}, 0.5f}};
  EXPECT_NEAR(lamp_size(disc, {0, 0, 0}).half_width, 0.5, 1e-7);
  EXPECT_NEAR(lamp_size(disc, {4 * std::sqrt(3.0), 0, 0}).half_width, 0.5 * std::sqrt(0.5), 1e-6);
  const Light sphere{.kind = SphereLight{{0, 4, 0}, 0.25f}};
  EXPECT_NEAR(lamp_size(sphere, {3, 0, 0}).half_width, 0.25, 1e-7);
  EXPECT_NEAR(lamp_size(sphere, {3, 0, 0}).distance, 5, 1e-7);
}

TEST(denoised_rays_parts, the_width_of_a_sigma_is_the_one_that_led_to_it) {
  for (const double width : {0.5, 4.0, 12.0, 24.0, 100.0})
    EXPECT_NEAR(width_of_sigma(sigma_of_width(static_cast<float>(width))), width, 1e-4 * width);
  EXPECT_EQ(width_of_sigma(0), 0);
}

}  // namespace denoised_rays_parts_test
