#include <gnomon/error.h>
#include <gnomon/kit/geometry/shapes.h>
#include <gnomon/kit/random.h>
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace shapes_test {

using namespace gnomon;
using std::numbers::pi;

template <class Sum>
void for_each_triangle(const Mesh& mesh, Sum sum) {
  for (const glm::uvec3& t : mesh.triangles)
    sum(glm::dvec3(mesh.positions[t.x]), glm::dvec3(mesh.positions[t.y]), glm::dvec3(mesh.positions[t.z]));
}

/// Sum of half the cross products: area times normal for a flat mesh, zero for a closed one.
glm::dvec3 vector_area(const Mesh& mesh) {
  glm::dvec3 total(0);
  for_each_triangle(mesh, [&](auto a, auto b, auto c) { total += 0.5 * glm::cross(b - a, c - a); });
  return total;
}

double area(const Mesh& mesh) {
  double total = 0;
  for_each_triangle(mesh, [&](auto a, auto b, auto c) { total += 0.5 * glm::length(glm::cross(b - a, c - a)); });
  return total;
}

/// Volume by the divergence theorem; positive exactly when a closed mesh is wound counter-clockwise seen from outside.
double signed_volume(const Mesh& mesh) {
  double total = 0;
  for_each_triangle(mesh, [&](auto a, auto b, auto c) { total += glm::dot(a, glm::cross(b, c)) / 6; });
  return total;
}

/// Area of a regular polygon with `n` corners on a circle of radius `r`: n isosceles triangles of apex angle 2 pi / n.
double polygon_area(double r, int n) { return 0.5 * n * r * r * std::sin(2 * pi / n); }

/// How far a point rounded once to float32 may be from where it was in double: half a unit in the last place each way.
double rounding(const glm::vec3& p) {
  return std::sqrt(3.0) * 0x1p-24 * std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)});
}

std::string error_of(const Shape& shape, int segments = 8) {
  try {
    tessellate(shape, segments, "thing");
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

TEST(Shapes, sphere_has_the_counts_of_its_bands_and_is_a_topological_sphere) {
  // b = max(2, n / 2) bands make b - 1 rings of n vertices and two poles; two fans of n triangles and 2 n in each band between.
  for (const int n : {3, 4, 5, 7, 32, 65}) {
    const Mesh mesh = tessellate(Sphere{{1, 2, 3}, 0.75f}, n, "sphere");
    const std::size_t rings = static_cast<std::size_t>(std::max(2, n / 2) - 1);
    EXPECT_EQ(mesh.positions.size(), rings * n + 2) << n;
    EXPECT_EQ(mesh.triangles.size(), 2 * n * rings) << n;
    EXPECT_TRUE(mesh.facts.closed()) << n;
    EXPECT_EQ(mesh.facts.degenerate_count, 0u) << n;
    // Closed: 3 edges a triangle, each shared by two. Euler: V - E + F = 2.
    EXPECT_EQ(mesh.positions.size() + mesh.triangles.size() - mesh.triangles.size() * 3 / 2, 2u) << n;
  }
}

TEST(Shapes, sphere_vertices_lie_on_the_sphere_to_one_rounding) {
  const Sphere sphere{{-3.7f, 2.1f, 11.3f}, 0.9f};
  for (const glm::vec3& p : tessellate(sphere, 64, "sphere").positions)
    EXPECT_NEAR(glm::distance(glm::dvec3(p), glm::dvec3(sphere.center)), double{sphere.radius}, rounding(p) + 1e-15);
}

TEST(Shapes, sphere_poles_are_exact_and_up_is_y) {
  const Mesh mesh = tessellate(Sphere{{0, 1, 0}, 1}, 16, "sphere");
  EXPECT_EQ(mesh.positions.front(), glm::vec3(0, 2, 0));
  EXPECT_EQ(mesh.positions.back(), glm::vec3(0, 0, 0));
}

TEST(Shapes, sphere_area_and_volume_converge_from_below_with_the_square_of_the_segments) {
  // Chord and arc differ by the square of the angle, so twice the segments leave a quarter of the error, up to the next order.
  const double exact_area = 4 * pi * 4, exact_volume = 4 * pi * 8 / 3;
  const auto misses = [&](int n) {
    const Mesh mesh = tessellate(Sphere{{0, 0, 0}, 2}, n, "sphere");
    return std::pair{exact_area - area(mesh), exact_volume - signed_volume(mesh)};
  };
  const auto [area_32, volume_32] = misses(32);
  const auto [area_64, volume_64] = misses(64);
  EXPECT_GT(area_64, 0);
  EXPECT_GT(volume_64, 0);
  EXPECT_NEAR(area_32 / area_64, 4, 0.05);
  EXPECT_NEAR(volume_32 / volume_64, 4, 0.05);
}

TEST(Shapes, cone_holds_a_third_of_base_times_height) {
  // The inscribed solid is a pyramid over a regular polygon. Euler: n + 2 vertices, 2 n triangles, 3 n edges.
  for (const int n : {3, 8, 65}) {
    const Mesh mesh = tessellate(Cone{.base = {1, 0.5f, -2}, .axis = {0, 3, 0}, .radius = 1.5f, .height = 2}, n, "cone");
    EXPECT_TRUE(mesh.facts.closed());
    EXPECT_EQ(mesh.positions.size(), static_cast<std::size_t>(n + 2));
    EXPECT_EQ(mesh.triangles.size(), static_cast<std::size_t>(2 * n));
    EXPECT_NEAR(signed_volume(mesh), polygon_area(1.5, n) * 2 / 3, 1e-5);
  }
}

TEST(Shapes, disc_is_a_sheet_that_faces_its_normal) {
  const Mesh mesh = tessellate(Disc{.center = {0, 1, 0}, .normal = {0, 0, -2}, .radius = 0.5f}, 12, "disc");
  EXPECT_EQ(mesh.facts.boundary_edge_count, 12u);
  EXPECT_EQ(mesh.facts.misoriented_edge_count, 0u);
  const glm::dvec3 total = vector_area(mesh);
  EXPECT_NEAR(total.z, -polygon_area(0.5, 12), 1e-7);
  EXPECT_NEAR(total.x, 0, 1e-7);
  EXPECT_NEAR(total.y, 0, 1e-7);
}

TEST(Shapes, plane_faces_u_cross_v_with_its_whole_area) {
  // Sides are 2 u and 2 v, so the vector area is 4 u x v: here u x v = (2, 0, 0) x (0, 0, -3) = (0, 6, 0).
  const Mesh mesh = tessellate(Plane{.center = {5, 1, 5}, .half_u = {2, 0, 0}, .half_v = {0, 0, -3}}, 3, "plane");
  EXPECT_EQ(mesh.triangles.size(), 2u);
  EXPECT_EQ(mesh.facts.boundary_edge_count, 4u);
  EXPECT_EQ(vector_area(mesh), glm::dvec3(0, 24, 0));
  EXPECT_EQ(vector_area(tessellate(ground_plane(3), 3, "ground")), glm::dvec3(0, 36, 0));
}

TEST(Shapes, triangle_keeps_its_corners_bit_for_bit) {
  const Triangle triangle{{{0.1f, 0.2f, 0.3f}, {1, 0, 0}, {0, 0, 7e-7f}}};
  const Mesh mesh = tessellate(triangle, 3, "triangle");
  ASSERT_EQ(mesh.triangles.size(), 1u);
  for (int k = 0; k < 3; ++k) EXPECT_EQ(mesh.positions[mesh.triangles[0][k]], triangle.points[k]);
}

TEST(Shapes, box_is_closed_has_eight_vertices_and_its_volume) {
  const Mesh mesh = tessellate(Box{{-1, 0, 2}, {1, 3, 6}}, 3, "box");
  EXPECT_EQ(mesh.positions.size(), 8u);
  EXPECT_EQ(mesh.triangles.size(), 12u);
  EXPECT_TRUE(mesh.facts.closed());
  EXPECT_EQ(area(mesh), 2 * (2 * 3 + 3 * 4 + 4 * 2));
  EXPECT_DOUBLE_EQ(signed_volume(mesh), 24);
}

TEST(Shapes, tessellation_carries_name_and_shape) {
  const Mesh mesh = tessellate(Sphere{}, 8, "ball");
  EXPECT_EQ(mesh.name, "ball");
  ASSERT_TRUE(mesh.shape);
  EXPECT_EQ(kind_name(*mesh.shape), "sphere");
}

RC_GTEST_PROP(Shapes, cone_along_any_axis_is_closed_outward_and_has_its_peak_on_the_axis, ()) {
  const auto component = [] { return *rc::gen::inRange(-1000, 1001) / 100.0f; };
  const glm::vec3 axis{component(), component(), component()};
  RC_PRE(axis != glm::vec3(0));
  const Cone cone{.base = {component(), component(), component()}, .axis = axis, .radius = 0.5f, .height = 2};
  const int segments = *rc::gen::inRange(3, 40);
  const Mesh mesh = tessellate(cone, segments, "cone");
  RC_ASSERT(mesh.facts.closed());
  RC_ASSERT(std::abs(signed_volume(mesh) - polygon_area(0.5, segments) * 2 / 3) < 1e-4);
  const glm::dvec3 base(cone.base), unit = glm::normalize(glm::dvec3(axis));
  RC_ASSERT(glm::distance(glm::dvec3(mesh.positions[1]), base + 2.0 * unit) < 2e-6);
  for (std::size_t i = 2; i < mesh.positions.size(); ++i) {
    const glm::dvec3 spoke = glm::dvec3(mesh.positions[i]) - base;
    RC_ASSERT(std::abs(glm::length(spoke) - 0.5) < 2e-6);
    RC_ASSERT(std::abs(glm::dot(spoke, unit)) < 2e-6);
  }
}

TEST(Shapes, shape_without_extent_is_refused_with_member_and_value) {
  const float nan = std::numeric_limits<float>::quiet_NaN(), inf = std::numeric_limits<float>::infinity();
  EXPECT_EQ(error_of(Sphere{{0, 0, 0}, 0}), "thing: sphere.radius = 0 must be finite and above 0 m");
  EXPECT_EQ(error_of(Sphere{{0, 0, 0}, -1}), "thing: sphere.radius = -1 must be finite and above 0 m");
  EXPECT_EQ(error_of(Sphere{{0, 0, 0}, nan}), "thing: sphere.radius = nan must be finite and above 0 m");
  EXPECT_EQ(error_of(Sphere{{0, inf, 0}, 1}), "thing: sphere.center = [0, inf, 0] must be finite");
  EXPECT_EQ(error_of(Cone{.axis = {0, 0, 0}}), "thing: cone.axis = [0, 0, 0] must not be zero");
  EXPECT_EQ(error_of(Cone{.height = 0}), "thing: cone.height = 0 must be finite and above 0 m");
  EXPECT_EQ(error_of(Cone{.radius = inf}), "thing: cone.radius = inf must be finite and above 0 m");
  EXPECT_EQ(error_of(Disc{.normal = {0, 0, 0}}), "thing: disc.normal = [0, 0, 0] must not be zero");
  EXPECT_EQ(error_of(Disc{.radius = 0}), "thing: disc.radius = 0 must be finite and above 0 m");
  EXPECT_EQ(error_of(Triangle{{{0, 0, 0}, {1, 1, 1}, {3, 3, 3}}}),
            "thing: triangle has no area: its sides must not be zero or parallel");
  EXPECT_EQ(error_of(Plane{.half_u = {1, 2, 0}, .half_v = {-2, -4, 0}}),
            "thing: plane has no area: its sides must not be zero or parallel");
  EXPECT_EQ(error_of(Plane{.half_u = {0, 0, 0}}), "thing: plane.half_u = [0, 0, 0] must not be zero");
  EXPECT_EQ(error_of(Box{{0, 0, 0}, {1, 0, 1}}), "thing: box.max = [1, 0, 1] must exceed min in x, y and z");
  EXPECT_EQ(error_of(Box{{0, nan, 0}, {1, 1, 1}}), "thing: box.min = [0, nan, 0] must be finite");
}

TEST(Shapes, shape_lost_in_rounding_is_refused) {
  // Near 1000 neighboring floats are 6e-5 apart: every vertex of a sphere of a micrometer rounds to the same point.
  EXPECT_NE(error_of(Sphere{{1000, 1000, 1000}, 1e-6f}).find("has no extent"), std::string::npos);
}

TEST(Shapes, segments_outside_their_range_are_refused) {
  EXPECT_EQ(error_of(Sphere{}, 2), "thing: segments = 2 is outside 3 .. 4096");
  EXPECT_EQ(error_of(Sphere{}, 4097), "thing: segments = 4097 is outside 3 .. 4096");
  EXPECT_EQ(error_of(Disc{}, 4096), "");
}

TEST(Shapes, prism_is_closed_and_holds_outline_times_height) {
  // A square with a roof of height 1: area 4 + 1, swept 3 along its normal.
  const glm::dvec3 house[] = {{-1, 0, 0}, {1, 0, 0}, {1, 2, 0}, {0, 3, 0}, {-1, 2, 0}};
  const Mesh mesh = prism(house, {0, 0, 3}, "house");
  EXPECT_TRUE(mesh.facts.closed());
  EXPECT_EQ(mesh.positions.size(), 10u);
  EXPECT_EQ(mesh.triangles.size(), 16u);
  EXPECT_NEAR(signed_volume(mesh), 15, 1e-12);
  // Swept aslant it keeps its volume: only the height above the outline's plane counts.
  EXPECT_NEAR(signed_volume(prism(house, {5, -1, 3}, "house")), 15, 1e-12);
}

TEST(Shapes, cylinder_is_closed_and_inscribed) {
  const Mesh mesh = cylinder({1, 2, 3}, {0, -2, 2}, 0.25, 24, "rod");
  EXPECT_TRUE(mesh.facts.closed());
  EXPECT_FALSE(mesh.shape);
  EXPECT_NEAR(signed_volume(mesh), polygon_area(0.25, 24) * std::sqrt(8.0), 1e-6);
}

TEST(Shapes, merge_keeps_every_part_where_it_was) {
  const Mesh parts[] = {tessellate(Box{{0, 0, 0}, {1, 1, 1}}, 3, "a"), tessellate(Box{{2, 0, 0}, {3, 2, 1}}, 3, "b")};
  const Mesh both = merge(parts, "both");
  EXPECT_EQ(both.name, "both");
  EXPECT_FALSE(both.shape);
  EXPECT_TRUE(both.facts.closed());
  EXPECT_EQ(both.triangles.size(), 24u);
  EXPECT_DOUBLE_EQ(signed_volume(both), 1 + 2);
}

// Places on a lattice are exact, and so is whether three of them lie on a line; a step of float32 beside it they do not.
TEST(shapes, triangles_without_area_are_dropped_and_no_others) {
  Random random(11);
  for (int i = 0; i < 4000; ++i) {
    const auto step = [&] { return static_cast<float>(static_cast<int>(random.below(2001)) - 1000); };
    const float scale = std::ldexp(1.0f, static_cast<int>(random.below(41)) - 20);
    const glm::vec3 a = scale * glm::vec3(step(), step(), step()), d = scale * glm::vec3(step(), step(), step());
    const float times = static_cast<float>(random.below(5)) - 1;
    Mesh line;
    line.positions = {a, a + d, a + times * d};
    line.triangles = {{0, 1, 2}};
    Mesh beside = line;
    for (int k = 0; k < 3; ++k)
      if (d[k] != 0) {
        float& moved = beside.positions[2][(k + 1) % 3];
        moved = moved == 0 ? 0x1p-20f * scale : std::nextafter(moved, INFINITY);
        break;
      }
    finish(line);
    finish(beside);
    EXPECT_EQ(line.facts.degenerate_count, 1u) << i;
    EXPECT_EQ(beside.facts.degenerate_count, d == glm::vec3(0) ? 1u : 0u) << i;
  }
}

}  // namespace shapes_test
