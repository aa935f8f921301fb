#include <gnomon/kit/geometry/camera.h>
#include <gtest/gtest.h>

#include <cmath>

#include "hand_made.h"
#include "measure/score/score.h"

namespace metrics_meters_test {

using namespace gnomon;

constexpr int size = 80;

/// The plane y = 0 as an eye sees it, every pixel of it tested.
struct Ground {
  hand_made::Picture picture{size, size};
  std::vector<PixelClass> classes = std::vector<PixelClass>(size * size, PixelClass::B);

  explicit Ground(const View& view) {
    picture.gbuffer.view = view;
    const Camera camera(view, size, size);
    for (std::size_t i = 0; i < size * size; ++i) {
      const glm::dvec3 ray = camera.ray(static_cast<double>(i % size) + 0.5, static_cast<double>(i / size) + 0.5);
      if (ray.y >= 0) continue;
      picture.set(i, camera.eye - ray * (camera.eye.y / ray.y), {0, 1, 0}, 0, 0);
      classes[i] = PixelClass::T;
    }
  }
  Evidence evidence(const std::vector<float>& reference, const std::vector<float>& mask) const {
    return {.width = size,
            .height = size,
            .classes = classes,
            .reference = reference,
            .mask = mask,
            .causes = {},
            .gbuffer = &picture.gbuffer};
  }
  std::optional<double> metric(const char* name, const std::vector<float>& reference, const std::vector<float>& mask) const {
    const Evidence e = evidence(reference, mask);
    return measure_metric(Scoring(e), name);
  }
};

/// From `height` straight down: 80 pixels are 2 tan(45) height wide, so a pixel is height / 40 everywhere.
View from_above(float height) { return {.eye = {0, height, 0}, .target = {0, 0, 0}, .up = {0, 0, -1}, .fov_y_degrees = 90}; }

/// 1, and `value` in columns x0 .. x1 and rows y0 .. y1 without the last of both.
std::vector<float> shadow(int x0, int x1, int y0, int y1, float value = 0) {
  std::vector<float> mask(size * size, 1.0f);
  for (int y = y0; y < y1; ++y)
    for (int x = x0; x < x1; ++x) mask[y * size + x] = value;
  return mask;
}
const std::vector<float> lit(size* size, 1.0f);

TEST(wrong_area, of_a_shadow_that_is_missing_or_added_is_its_own) {
  // 20 x 30 pixels from 4 m: a pixel is 0.1 m wide, so 2 m x 3 m. From 12 m nine times as much.
  const auto square = shadow(10, 30, 40, 70);
  for (const auto& [height, area] : {std::pair(4.0f, 6.0), {12.0f, 54.0}}) {
    const Ground ground(from_above(height));
    EXPECT_NEAR(ground.metric("wrong_area_m2", square, lit).value(), area, 1e-5 * area);
    EXPECT_NEAR(ground.metric("wrong_area_m2", lit, square).value(), area, 1e-5 * area);
    EXPECT_EQ(ground.metric("wrong_area_m2", square, square), 0);
  }
}

TEST(wrong_area, of_a_shadow_moved_by_k_pixels_is_both_of_its_stripes) {
  // 3 columns of 30 pixels are lit and 3 are dark: 180 pixels of 0.01 m2.
  const Ground ground(from_above(4));
  EXPECT_NEAR(ground.metric("wrong_area_m2", shadow(10, 30, 40, 70), shadow(13, 33, 40, 70)).value(), 1.8, 1e-5);
}

TEST(wrong_area, counts_pixels_that_are_wrong_whole_and_others_not) {
  // 0.4 where the reference is dark is on its side; 0.6 is not.
  const Ground ground(from_above(4));
  const auto square = shadow(10, 30, 40, 70);
  EXPECT_EQ(ground.metric("wrong_area_m2", square, shadow(10, 30, 40, 70, 0.4f)), 0);
  EXPECT_NEAR(ground.metric("wrong_area_m2", square, shadow(10, 30, 40, 70, 0.6f)).value(), 6, 1e-4);
}

TEST(wrong_area, is_of_tested_pixels_and_of_a_slant_that_of_the_ground) {
  // An eye 3 m above the ground and 4 m beside it looks down by 36.87 degrees. The whole ground in the picture is dark in one
  // and lit in the other: a trapezoid, whose corners are where the picture's corner rays meet the ground. Above the picture's
  // top the ray looks 16.87 degrees down, so no pixel is flat.
  const View slanted{.eye = {0, 3, 4}, .target = {0, 0, 0}, .fov_y_degrees = 40};
  Ground ground(slanted);
  const Camera camera(slanted, size, size);
  std::vector<glm::dvec3> corners;
  for (const auto& [x, y] : {std::pair(0, 0), {size, 0}, {size, size}, {0, size}}) {
    const glm::dvec3 ray = camera.ray(x, y);
    corners.push_back(camera.eye - ray * (camera.eye.y / ray.y));
  }
  const double trapezoid =
      (corners[1].x - corners[0].x + corners[2].x - corners[3].x) / 2 * std::abs(corners[0].z - corners[3].z);
  const std::vector<float> dark(size * size, 0.0f);
  EXPECT_NEAR(ground.metric("wrong_area_m2", lit, dark).value() / trapezoid, 1, 1e-5);
  // Without the upper half what is left is nearer, and less than half.
  std::fill(ground.classes.begin(), ground.classes.begin() + size * size / 2, PixelClass::U);
  EXPECT_LT(ground.metric("wrong_area_m2", lit, dark).value(), trapezoid / 2);
  std::ranges::fill(ground.classes, PixelClass::U);
  EXPECT_EQ(ground.metric("wrong_area_m2", lit, dark), std::nullopt);
}

TEST(displacement_in_meters, of_an_edge_moved_by_k_pixels_is_k_times_a_pixel_s_width) {
  // A pixel is 0.1 m wide from 4 m, and 0.3 m from 12 m. The rims are two columns of pixels k apart.
  for (const auto& [height, width] : {std::pair(4.0f, 0.1), {12.0f, 0.3}}) {
    const Ground ground(from_above(height));
    for (const int k : {-9, -1, 0, 1, 2, 15}) {
      const auto truth = shadow(40, size, 0, size), moved = shadow(40 + k, size, 0, size);
      EXPECT_NEAR(ground.metric("displacement_mean_m", truth, moved).value(), width * std::abs(k), 1e-5) << k;
      EXPECT_NEAR(ground.metric("displacement_p95_m", truth, moved).value(), width * std::abs(k), 1e-5) << k;
      EXPECT_DOUBLE_EQ(ground.metric("displacement_mean", truth, moved).value(), std::abs(k));
    }
  }
}

TEST(displacement_in_meters, of_an_edge_across_the_view_is_the_way_along_the_ground) {
  // Rows 20 and 26 of a slanted view: pixels of a row have one z, so from any pixel of the lower row the nearest of the other
  // row is the one straight ahead, or nearer to the middle, which x no farther apart than a pixel's width leaves within.
  const Ground ground({.eye = {0, 3, 4}, .target = {0, 0, 0}, .fov_y_degrees = 40});
  const GBuffer& seen = ground.picture.gbuffer;
  const double way = std::abs(static_cast<double>(seen.pz[26 * size]) - seen.pz[20 * size]);
  const double across = static_cast<double>(seen.px[20 * size + 1]) - seen.px[20 * size];
  const double found = ground.metric("displacement_mean_m", shadow(0, size, 20, size), shadow(0, size, 26, size)).value();
  EXPECT_GE(found, way * 0.999);
  // The ends of the farther row jut out by the picture's slant: at most 8 columns a side are more than half a pixel from any.
  EXPECT_LT(found, std::hypot(way, across / 2) * 1.02);
}

TEST(displacement_in_meters, is_to_the_nearest_point_in_the_scene_not_in_the_picture) {
  // A row of pixels 1 m apart. The truth's rim is at pixel 10, the answer's at 12 and at 30, which shows a thing in front whose
  // point is 0.25 m beside that of pixel 10. Ways: 12 to 10 is 2 m, 30 to 10 is 0.25 m, 10 to 30 is 0.25 m.
  constexpr int width = 40;
  hand_made::Picture picture(width, 1);
  picture.gbuffer.view = {.eye = {0, 1000, 0}, .target = {0, 0, 0}, .up = {0, 0, -1}, .fov_y_degrees = 1};
  for (int i = 0; i < width; ++i) picture.set(i, {i == 30 ? 10.25f : static_cast<float>(i), 0, 0}, {0, 1, 0}, 0, 0);
  const std::vector<PixelClass> all(width, PixelClass::T);
  std::vector<float> truth(width, 1.0f), answer = truth;
  truth[10] = answer[12] = answer[30] = 0;
  const Evidence e{.width = width,
                   .height = 1,
                   .classes = all,
                   .reference = truth,
                   .mask = answer,
                   .causes = {},
                   .gbuffer = &picture.gbuffer};
  const Displacement found = Scoring(e).displacement();
  EXPECT_DOUBLE_EQ(found.mean_m.value(), (2 + 0.25 + 0.25) / 3);
  EXPECT_DOUBLE_EQ(found.mean.value(), (2 + 20 + 2) / 3.0);
}

TEST(displacement_in_meters, leaves_out_pixels_that_see_their_plane_too_flatly) {
  // An eye 1 m above the ground that looks at the horizon, between rows 39 and 40: pixels of row 40 cover nothing, those of row
  // 41 do (their upper corners are twice as far as their lower ones). Row r meets the ground at z = -1 / ((r - 39.5) s), s = 2
  // tan(30) / 80.
  const Ground ground({.eye = {0, 1, 0}, .target = {0, 1, -1}, .fov_y_degrees = 60});
  const double s = 2 * std::tan(std::acos(-1.0) / 6) / size;
  const auto row = [&](int r) { return shadow(0, size, r, r + 1); };
  // Of a single dark row the row is the rim.
  EXPECT_EQ(ground.metric("displacement_mean_m", row(60), row(40)), std::nullopt);
  EXPECT_EQ(ground.metric("displacement_mean_m", row(40), row(40)), std::nullopt);
  EXPECT_NEAR(ground.metric("displacement_mean", row(60), row(40)).value(), 20, 1e-9);
  const double way = 1 / (1.5 * s) - 1 / (2.5 * s);
  EXPECT_GE(ground.metric("displacement_mean_m", row(42), row(41)).value(), way * 0.999);
  // Every other pixel of the flat row is on the rim, too, and changes nothing.
  auto both = row(41);
  for (int x = 0; x < size; x += 2) both[40 * size + x] = 0;
  EXPECT_EQ(ground.metric("displacement_mean_m", row(41), both), 0);
}

TEST(displacement_in_meters, is_nothing_without_points_and_where_one_side_has_no_boundary) {
  const Ground ground(from_above(4));
  const auto square = shadow(10, 30, 40, 70);
  EXPECT_EQ(ground.metric("displacement_mean_m", lit, lit), 0);
  EXPECT_EQ(ground.metric("displacement_mean_m", square, lit), std::nullopt);
  EXPECT_EQ(ground.metric("displacement_p95_m", lit, square), std::nullopt);
  Evidence blind = ground.evidence(square, shadow(12, 32, 40, 70));
  blind.gbuffer = nullptr;
  for (const char* name : {"displacement_mean_m", "displacement_p95_m", "wrong_area_m2"})
    EXPECT_EQ(measure_metric(Scoring(blind), name), std::nullopt) << name;
  EXPECT_TRUE(measure_metric(Scoring(blind), "displacement_mean").has_value());
}

}  // namespace metrics_meters_test
