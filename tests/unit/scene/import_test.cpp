// The importer's parts that need no file: what reads the pipe, and the triangulation of polygons.
#include "measure/scene/import.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <cmath>
#include <ctime>
#include <numbers>

namespace import_test {

using namespace gnomon;

TEST(FieldReader, believes_no_count_that_the_rest_cannot_hold) {
  const std::uint64_t count = std::uint64_t{1} << 60;
  FieldReader reader(std::as_bytes(std::span(&count, 1)), "too short");
  std::vector<glm::vec3> positions;
  EXPECT_THROW(reader(positions), Error);
}

// A star-shaped polygon with random radii is simple; its triangles must cover its area, which the shoelace formula gives.
RC_GTEST_PROP(Triangulate, covers_a_simple_polygon, ()) {
  const auto radii = *rc::gen::suchThat(rc::gen::container<std::vector<int>>(rc::gen::inRange(1, 100)),
                                        [](const auto& r) { return r.size() >= 3; });
  const std::size_t n = radii.size();
  std::vector<glm::vec3> points;
  std::vector<std::uint32_t> corners;
  for (std::size_t i = 0; i < n; ++i) {
    const double angle = 2 * std::numbers::pi * static_cast<double>(i) / static_cast<double>(n);
    points.emplace_back(radii[i] * std::cos(angle), 3, -radii[i] * std::sin(angle));  // counter-clockwise from +y
    corners.push_back(static_cast<std::uint32_t>(i));
  }
  std::vector<glm::uvec3> triangles;
  RC_ASSERT(importing::triangulate(points, corners, triangles));
  RC_ASSERT(triangles.size() == n - 2);
  double shoelace = 0, covered = 0;
  for (std::size_t i = 0; i < n; ++i) {
    const glm::dvec3 a(points[i]), b(points[(i + 1) % n]);
    shoelace += (a.z * b.x - a.x * b.z) / 2;
  }
  for (const glm::uvec3& t : triangles) {
    const glm::dvec3 a(points[t.x]), b(points[t.y]), c(points[t.z]);
    const double up = glm::cross(b - a, c - a).y / 2;
    RC_ASSERT(up > -1e-6);
    covered += up;
  }
  RC_ASSERT(std::abs(covered - shoelace) < 1e-6 * (1 + shoelace));
}

TEST(Triangulate, leaves_no_polygon_out_that_is_not_simple) {
  // A bow tie: its edges cross. It is split as a fan, and the answer says so.
  const std::vector<glm::vec3> points = {{0, 0, 0}, {1, 1, 0}, {1, 0, 0}, {0, 2, 0}};
  const std::vector<std::uint32_t> corners = {0, 1, 2, 3};
  std::vector<glm::uvec3> triangles;
  importing::triangulate(points, corners, triangles);
  EXPECT_EQ(triangles.size(), 2u);
}

TEST(Triangulate, takes_polygons_of_thousands_of_corners) {
  // A saw of 2000 slanted teeth on a bar; the shoelace formula gives its area.
  std::vector<glm::vec3> points = {{0, 0, 0}, {4000, 0, 0}};
  for (int x = 4000; x > 0; x -= 2) {
    points.emplace_back(x, 2, 0);
    points.emplace_back(x - 1, 1, 0);
  }
  points.emplace_back(0, 1, 0);
  std::vector<std::uint32_t> corners(points.size());
  for (std::uint32_t i = 0; i < corners.size(); ++i) corners[i] = i;
  std::vector<glm::uvec3> triangles;
  EXPECT_TRUE(importing::triangulate(points, corners, triangles));
  double covered = 0, shoelace = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const glm::dvec3 a(points[i]), b(points[(i + 1) % points.size()]);
    shoelace += (a.x * b.y - a.y * b.x) / 2;
  }
  for (const glm::uvec3& t : triangles) {
    const glm::dvec3 a(points[t.x]), b(points[t.y]), c(points[t.z]);
    covered += glm::cross(b - a, c - a).z / 2;
  }
  EXPECT_EQ(covered, shoelace) << "halves of small whole numbers: exact";
}

/// Seconds of this process for a spiral of four turns and back again, half of whose corners turn in.
double seconds_of_spiral(int corner_count) {
  const int count = corner_count / 2;
  std::vector<glm::vec3> points;
  for (const double inset : {0.0, 0.4})
    for (int k = 0; k < count; ++k) {
      const double t = (inset == 0 ? k : count - 1 - k) / static_cast<double>(count), angle = 8 * std::numbers::pi * t;
      const double radius = 1 + 4 * t - inset;
      points.emplace_back(radius * std::cos(angle), radius * std::sin(angle), 0);
    }
  std::vector<std::uint32_t> corners(points.size());
  for (std::uint32_t i = 0; i < corners.size(); ++i) corners[i] = i;
  std::vector<glm::uvec3> triangles;
  const std::clock_t start = std::clock();
  EXPECT_TRUE(importing::triangulate(points, corners, triangles));
  EXPECT_EQ(triangles.size(), points.size() - 2);
  return static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
}

TEST(Triangulate, takes_time_that_grows_with_the_square_of_the_corners) {
  // Four times as many corners: 16 times as long. Looking at all corners after each cut it was 64 times, 14 s for 4,000.
  double small = seconds_of_spiral(750), large = seconds_of_spiral(3000);
  for (int again = 0; again < 2; ++again) {
    small = std::min(small, seconds_of_spiral(750));
    large = std::min(large, seconds_of_spiral(3000));
  }
  EXPECT_LT(large, 40 * small + 0.05);
}

}  // namespace import_test
