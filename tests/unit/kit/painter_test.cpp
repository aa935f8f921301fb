#include <gnomon/kit/pictures/painter.h>
#include <gnomon/kit/random.h>
#include <gtest/gtest.h>

#include <set>

#include "small_world.h"

namespace painter_test {

using namespace gnomon;

std::vector<std::size_t> covered(const Camera& camera, const std::vector<glm::dvec3>& corners) {
  Painter painter(camera);
  std::vector<std::size_t> pixels;
  for_covered_pixels(painter, std::span<const glm::dvec3>(corners), [&](std::size_t i) { pixels.push_back(i); });
  return pixels;
}

glm::dvec3 ray_through(const Camera& camera, std::size_t i) {
  return camera.ray(static_cast<double>(i % camera.width) + 0.5, static_cast<double>(i / camera.width) + 0.5);
}

/// How far the ray through a pixel passes inside the polygon, as the sine of the angle to the nearest edge's plane through the
/// eye; negative outside. The rays that meet a convex polygon are those on one side of all these planes.
double inside_by(const Camera& camera, const std::vector<glm::dvec3>& corners, std::size_t i) {
  const glm::dvec3 ray = glm::normalize(ray_through(camera, i));
  double low = INFINITY, high = -INFINITY;
  for (std::size_t k = 0; k < corners.size(); ++k) {
    const glm::dvec3 plane =
        glm::normalize(glm::cross(corners[k] - camera.eye, corners[(k + 1) % corners.size()] - camera.eye));
    low = std::min(low, glm::dot(plane, ray)), high = std::max(high, glm::dot(plane, ray));
  }
  // Seen from behind, all signs are turned. A ray away from the polygon meets its mirror image behind the eye.
  glm::dvec3 middle(0);
  for (const glm::dvec3& p : corners) middle += (p - camera.eye) / static_cast<double>(corners.size());
  const glm::dvec3 normal = glm::cross(corners[1] - corners[0], corners[2] - corners[0]);
  const bool is_mirrored = (glm::dot(normal, ray) > 0) != (glm::dot(normal, middle) > 0);
  return is_mirrored ? -1 : glm::dot(normal, middle) > 0 ? low : -high;
}

View random_view(Random& random) {
  const auto point = [&] { return glm::vec3(random.uniform(glm::dvec3(-3), glm::dvec3(3))); };
  return {.eye = point(), .target = point(), .fov_y_degrees = static_cast<float>(random.uniform(20, 110))};
}

TEST(painter, one_square_is_derived_on_paper) {
  // At 45 degrees from the middle to the upper border and 4 by 4 pixels, a pixel is half a meter wide at one meter: the square
  // from -0.5 to 0.5 fills the four pixels in the middle, and from -0.5 to 0.2 (not half of the second pixel) one of them.
  const Camera camera({.eye = {0, 0, 1}, .target = {0, 0, 0}, .fov_y_degrees = 90}, 4, 4);
  using Pixels = std::vector<std::size_t>;
  EXPECT_EQ(covered(camera, {{-0.5, -0.5, 0}, {0.5, -0.5, 0}, {0.5, 0.5, 0}, {-0.5, 0.5, 0}}), (Pixels{5, 6, 9, 10}));
  EXPECT_EQ(covered(camera, {{-0.5, -0.5, 0}, {-0.5, 0.5, 0}, {0.5, 0.5, 0}, {0.5, -0.5, 0}}), (Pixels{5, 6, 9, 10}));
  EXPECT_EQ(covered(camera, {{-0.5, -0.2, 0}, {0.2, -0.2, 0}, {0.2, 0.5, 0}, {-0.5, 0.5, 0}}), (Pixels{5})) << "up is up";
  EXPECT_EQ(covered(camera, {{-0.5, -0.5, 2}, {0.5, -0.5, 2}, {0.5, 0.5, 2}, {-0.5, 0.5, 2}}), Pixels{}) << "behind the eye";
  EXPECT_EQ(covered(camera, {{-9, 0, -9}, {9, 0, -9}, {9, 0, 9}, {-9, 0, 9}}), Pixels{}) << "edge-on, around the eye";
  EXPECT_EQ(covered(camera, {{0, 0, 1}, {-1, -1, 0}, {1, 1, 0}}), Pixels{}) << "edge-on, a corner at the eye";
}

TEST(painter, a_floor_that_goes_on_behind_the_eye_fills_what_is_below_the_horizon) {
  const Camera camera({.eye = {0, 1, 0}, .target = {0, 1, -1}, .fov_y_degrees = 90}, 16, 10);
  // The lower five rows look down by 0.1, 0.3, 0.5, 0.7 and 0.9 meters a meter, and meet the floor after 10 meters and less.
  const double far = 1e7;
  const auto floor = covered(camera, {{-far, 0, -far}, {-far, 0, far}, {far, 0, far}, {far, 0, -far}});
  ASSERT_EQ(floor.size(), 5u * 16);
  EXPECT_EQ(floor.front(), 5u * 16);
  // What lies more than 2 meters ahead is met by the two rows that look down by less than 1/2.
  const auto rest = covered(camera, {{-far, 0, -far}, {-far, 0, -2.001}, {far, 0, -2.001}, {far, 0, -far}});
  EXPECT_EQ(rest.size(), 2u * 16);
  const auto ceiling = covered(camera, {{-far, 2, -far}, {-far, 2, far}, {far, 2, far}, {far, 2, -far}});
  EXPECT_EQ(ceiling.size(), 5u * 16);
  EXPECT_EQ(ceiling.front(), 0u);
}

TEST(painter, pixels_are_those_whose_rays_meet_the_polygon) {
  Random random(1);
  int decided = 0, met = 0;
  for (int round = 0; round < 3000; ++round) {
    const Camera camera(random_view(random), 24, 18);
    // Points of an ellipse in convex position, some around the eye's side, some far larger than the picture, some tiny.
    const double size = std::pow(10.0, random.uniform(-2, 2));
    const glm::dvec3 center = random.uniform(glm::dvec3(-3), glm::dvec3(3)), u = size * small_world::direction_of(random),
                     v = size * small_world::direction_of(random);
    std::set<double> angles;
    const std::uint32_t count = 3 + random.below(7);
    while (angles.size() < count) angles.insert(random.uniform(0, 6.283185307179586));
    std::vector<glm::dvec3> corners;
    for (const double angle : angles) corners.push_back(center + std::cos(angle) * u + std::sin(angle) * v);
    const std::vector<std::size_t> pixels = covered(camera, corners);
    ASSERT_TRUE(std::ranges::is_sorted(pixels));
    const std::set<std::size_t> found(pixels.begin(), pixels.end());
    ASSERT_EQ(found.size(), pixels.size());
    for (std::size_t i = 0; i < 24 * 18; ++i) {
      const double inside = inside_by(camera, corners, i);
      if (std::abs(inside) < 1e-9) continue;
      ++decided, met += inside > 0;
      ASSERT_EQ(found.contains(i), inside > 0) << "round " << round << " pixel " << i << " inside by " << inside;
    }
  }
  EXPECT_GT(decided, 3000 * 24 * 18 * 0.99);
  EXPECT_GT(met, 100'000);
}

/// A plane cut into triangles that share whole edges: a grid, its corners moved.
std::vector<std::vector<glm::dvec3>> tiles(Random& random, int steps, double half, double moved) {
  std::vector<glm::dvec3> corners;
  for (int y = 0; y <= steps; ++y)
    for (int x = 0; x <= steps; ++x) {
      const bool is_inner = x > 0 && x < steps && y > 0 && y < steps;
      const double step = 2 * half / steps, by = is_inner ? moved * step : 0;
      const double dx = random.uniform(-by, by), dy = random.uniform(-by, by);
      corners.push_back({x * step - half + dx, 0, y * step - half + dy});
    }
  std::vector<std::vector<glm::dvec3>> triangles;
  for (int y = 0; y < steps; ++y)
    for (int x = 0; x < steps; ++x) {
      const auto at = [&](int i, int j) { return corners[static_cast<std::size_t>((y + j) * (steps + 1) + x + i)]; };
      const bool turn = random.below(2);
      triangles.push_back({at(0, 0), at(1, 0), turn ? at(0, 1) : at(1, 1)});
      triangles.push_back({at(0, 1), turn ? at(1, 0) : at(0, 0), at(1, 1)});
    }
  return triangles;
}

/// How many polygons cover each pixel.
std::vector<int> layers(const Camera& camera, const std::vector<std::vector<glm::dvec3>>& polygons) {
  Painter painter(camera);
  std::vector<int> count(static_cast<std::size_t>(camera.width) * camera.height, 0);
  for (const auto& polygon : polygons)
    for_covered_pixels(painter, std::span<const glm::dvec3>(polygon), [&](std::size_t i) { ++count[i]; });
  return count;
}

TEST(painter, polygons_that_share_edges_leave_no_gap_and_no_overlap) {
  Random random(2);
  int once = 0;
  for (int round = 0; round < 300; ++round) {
    const Camera camera(random_view(random), 40, 30);
    const int steps = 1 << random.below(8);  // from two triangles to more than there are pixels
    const double half = std::pow(10.0, random.uniform(-1, 3));
    const auto count = layers(camera, tiles(random, steps, half, 0.25));
    const std::vector<glm::dvec3> whole{{-half, 0, -half}, {half, 0, -half}, {half, 0, half}, {-half, 0, half}};
    for (std::size_t i = 0; i < count.size(); ++i) {
      ASSERT_LE(count[i], 1) << "round " << round << " pixel " << i;
      const double inside = inside_by(camera, whole, i);
      if (std::abs(inside) > 1e-9) {
        ASSERT_EQ(count[i], inside > 0) << "round " << round << " pixel " << i;
      }
      once += count[i];
    }
  }
  EXPECT_GT(once, 50'000);
}

TEST(painter, a_center_on_a_corner_or_an_edge_belongs_to_one_polygon) {
  // From 4 meters above, 32 by 32 pixels and 4 meters to the border: a pixel is a quarter of a meter. The grid's corners lie in
  // pixel centers, but for rounding in the tangent of 45 degrees, and its edges run through centers.
  Random random(3);
  const Camera camera({.eye = {0, 4, 0}, .target = {0, 0, 0}, .up = {0, 0, -1}, .fov_y_degrees = 90}, 32, 32);
  for (const int steps : {62, 31}) {
    const auto count = layers(camera, tiles(random, steps, 3.875, 0));
    for (std::size_t y = 1; y < 31; ++y)
      for (std::size_t x = 1; x < 31; ++x) ASSERT_EQ(count[32 * y + x], 1) << steps << ": " << x << ' ' << y;
  }
}

}  // namespace painter_test
