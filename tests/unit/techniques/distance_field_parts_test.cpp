// The parts of distance fields: formulas by their vectors, distances and signs against brute force, and what a grid loses.
#include <gnomon/kit/geometry/shapes.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "small_world.h"
#include "techniques/distance_field/field.h"
#include "techniques/distance_field/penumbra.h"

namespace gnomon::distance_field_parts_test {

using namespace distance_field;

TEST(DistanceFieldParts, every_half_comes_back_and_rounding_is_to_the_nearest_even) {
  for (std::uint32_t half = 0; half < 0x10000u; ++half) {
    if ((half >> 10 & 31) == 31) continue;  // infinities and not-a-numbers
    ASSERT_EQ(to_half(from_half(static_cast<std::uint16_t>(half))), half);
  }
  EXPECT_EQ(from_half(0x3c00), 1);
  EXPECT_EQ(from_half(0x0001), 0x1p-24f);
  EXPECT_EQ(from_half(0xc580), -5.5f);
  // Between neighbors, at halfway to the even one: 1 + k 2^-10, and multiples of 2^-24 below 2^-14.
  EXPECT_EQ(to_half(1 + 0x1p-11f), 0x3c00);
  EXPECT_EQ(to_half(1 + 3 * 0x1p-11f), 0x3c02);
  EXPECT_EQ(to_half(1 + 0x1p-11f + 0x1p-20f), 0x3c01);
  EXPECT_EQ(to_half(-2.5f * 0x1p-24f), 0x8002);
  EXPECT_EQ(to_half(3.5f * 0x1p-24f), 0x0004);
  EXPECT_EQ(to_half(1024 - 0x1p-3f), 0x6400);
}

// A point caster 0.3 beside the ray at 2: from 1.6 it is 0.5 away, so the next step is at 2.1, 0.316228 away.
TEST(DistanceFieldParts, the_closest_approach_to_a_point_is_exact) {
  const Approach vector = closest_approach(0.5, std::sqrt(0.1), 2.1);
  EXPECT_NEAR(vector.along, 2, 1e-12);
  EXPECT_NEAR(vector.distance, 0.3, 1e-12);
  Random random(3);
  int asked = 0;
  while (asked < 1000) {
    const double along = random.uniform(1, 3), beside = random.uniform(0.01, 1), start = random.uniform(0, along);
    const double before = std::hypot(along - start, beside), now = std::hypot(along - start - before, beside);
    if (now * now >= 2 * before * before) continue;
    const Approach nearest = closest_approach(before, now, start + before);
    ASSERT_NEAR(nearest.along, along, 1e-9);
    ASSERT_NEAR(nearest.distance, beside, 1e-9);
    ++asked;
  }
}

TEST(DistanceFieldParts, the_share_of_a_disc_past_a_line_has_its_vectors) {
  const double vectors[][2] = {{-1, 0}, {-0.5, 0.195501}, {0, 0.5}, {0.25, 0.657481}, {0.5, 0.804499}, {1, 1}};
  for (const auto& [s, share] : vectors) EXPECT_NEAR(share_seen(Formula::disc, s), share, 5e-7) << s;
}

// The mean over -1 .. 1 of what ratio is off by: from -1 to 0 the integral of the disc's share, 2 / (3 pi) = 0.2122, and from 0
// to 1 that of the share less s, 1 - 0.2122 - 1/2 = 0.2878. Both together over the length 2: 1/4 exactly.
TEST(DistanceFieldParts, the_cubic_is_off_by_four_hundredths_and_the_ratio_by_a_quarter_in_the_mean) {
  constexpr int count = 20'000;
  double most = 0, inner = 0, outer = 0;
  for (int k = 0; k < count; ++k) {
    const double s = -1 + (2 * k + 1.0) / count, share = share_seen(Formula::disc, s);
    most = std::max(most, std::abs(share_seen(Formula::smoothstep, s) - share));
    (s < 0 ? inner : outer) += std::abs(share_seen(Formula::ratio, s) - share) * 2 / count;
  }
  EXPECT_NEAR(most, 0.0394, 1e-4);
  EXPECT_NEAR(inner, 2 / (3 * std::numbers::pi), 1e-6);
  EXPECT_NEAR(outer, 0.5 - 2 / (3 * std::numbers::pi), 1e-6);
  EXPECT_NEAR((inner + outer) / 2, 0.25, 1e-6);
}

/// The distance to a triangle by its seven regions: the foot of the perpendicular by barycentric coordinates, else sides as
/// 4096 points that are then refined.
double distance_by_hand(const glm::dvec3& p, const Triangle& triangle) {
  const glm::dvec3 a(triangle.points[0]), u = glm::dvec3(triangle.points[1]) - a, v = glm::dvec3(triangle.points[2]) - a,
                                          w = p - a;
  const double uu = glm::dot(u, u), uv = glm::dot(u, v), vv = glm::dot(v, v), uw = glm::dot(u, w), vw = glm::dot(v, w);
  const double s = (vv * uw - uv * vw) / (uu * vv - uv * uv), t = (uu * vw - uv * uw) / (uu * vv - uv * uv);
  if (s >= 0 && t >= 0 && s + t <= 1) return glm::length(w - s * u - t * v);
  double best = INFINITY;
  for (int side = 0; side < 3; ++side) {
    const glm::dvec3 from(triangle.points[side]), way = glm::dvec3(triangle.points[(side + 1) % 3]) - from;
    double low = 0, high = 1;
    // The distance along a line has one minimum.
    for (int k = 0; k < 100; ++k) {
      const double third = (high - low) / 3;
      if (glm::length(p - from - (low + third) * way) < glm::length(p - from - (high - third) * way))
        high -= third;
      else
        low += third;
    }
    best = std::min(best, glm::length(p - from - low * way));
  }
  return best;
}

TEST(DistanceFieldParts, the_tree_finds_the_distance_that_all_triangles_give) {
  std::mt19937 engine(5);
  Random random(5);
  for (int round = 0; round < 5; ++round) {
    const Mesh soup = small_world::random_soup(engine, 40, 1, -1, 1, 0.4f);
    const MeshDistances distances(soup);
    std::uint32_t near = 0;
    for (int k = 0; k < 100; ++k) {
      const glm::dvec3 p = random.uniform(glm::dvec3(-2), glm::dvec3(2));
      double best = INFINITY;
      for (std::size_t t = 0; t < soup.triangles.size(); ++t) best = std::min(best, distance_by_hand(p, soup.corners(t)));
      ASSERT_NEAR(distances.to_nearest(p, near), best, 1e-7);
      std::uint32_t first = 0;  // where the search begins changes nothing
      ASSERT_NEAR(distances.to_nearest(p, first), distances.to_nearest(p, near), 1e-14);
    }
  }
}

/// Passages of a ray in a random direction, by Moeller and Trumbore in double.
bool is_odd(const Mesh& mesh, const glm::dvec3& p, const glm::dvec3& direction) {
  int count = 0;
  for (const glm::uvec3& t : mesh.triangles) {
    const double hit = small_world::intersect(p, direction, mesh.positions[t.x], mesh.positions[t.y], mesh.positions[t.z]);
    count += hit > 0 && hit < std::numeric_limits<double>::infinity();
  }
  return count % 2 == 1;
}

TEST(DistanceFieldParts, winding_numbers_are_what_rays_count_and_samples_have_their_sign) {
  Random random(7);
  const Mesh bodies[] = {tessellate(Sphere{{0.1f, 0.2f, -0.3f}, 0.9f}, 17, "sphere"),
                         tessellate(Cone{{0, -0.7f, 0}, {0.3f, 1, 0.2f}, 0.8f, 1.4f}, 12, "cone"),
                         small_world::box({-0.5f, -0.8f, -0.25f}, {0.75f, 0.5f, 0.5f})};
  for (const Mesh& body : bodies) {
    ASSERT_TRUE(body.is_closed());
    const MeshDistances distances(body);
    const Field field(body, 16);
    std::uint32_t near = 0;
    int inside = 0;
    for (int k = 0; k < 1000; ++k) {
      // On samples, too: their rows pass through vertices and along sides.
      const Frame& frame = field.frame();
      const glm::ivec3 sample(random.below(frame.cells.x + 1), random.below(frame.cells.y + 1),
                              random.below(frame.cells.z + 1));
      const glm::dvec3 p = k % 2 ? random.uniform(glm::dvec3(-1.2), glm::dvec3(1.2)) : frame.place(sample);
      const double distance = distances.to_nearest(p, near);
      if (distance < 1e-3) continue;
      const bool is_within = is_odd(body, p, small_world::direction_of(random));
      inside += is_within;
      ASSERT_EQ(distances.winding(p) != 0, is_within) << p.x << " " << p.y << " " << p.z;
      if (k % 2) continue;
      // A sample is the distance in voxels, rounded to a half: to 2^-11 of itself.
      ASSERT_NEAR(field.distance(p), is_within ? -distance : distance, distance * 0x1p-11 + 1e-9);
    }
    EXPECT_GT(inside, 50);
  }
}

// Both bodies are oriented alike: where they overlap the winding number is 2, and parity would say outside.
TEST(DistanceFieldParts, bodies_that_overlap_are_solid_where_they_do) {
  const Mesh parts[] = {small_world::box({0, 0, 0}, {2, 2, 2}), small_world::box({1, 1, 1}, {3, 3, 3})};
  const MeshDistances distances(merge(parts, "boxes"));
  EXPECT_NE(distances.winding({1.5, 1.5, 1.5}), 0);
  EXPECT_NE(distances.winding({0.5, 0.5, 0.5}), 0);
  EXPECT_EQ(distances.winding({2.5, 0.5, 0.5}), 0);
  EXPECT_EQ(distances.winding({-1, 1, 1}), 0);
}

TEST(DistanceFieldParts, an_open_mesh_is_a_plate_one_voxel_thick) {
  const Field field(small_world::ground(8), 16);  // voxels of a meter, samples at heights -1, 0 and 1
  EXPECT_FALSE(field.frame().is_closed);
  EXPECT_EQ(field.frame().voxel, 1);
  EXPECT_EQ(field.frame().sample_count(), 19u * 3 * 19);
  EXPECT_NEAR(field.distance({0.3, 0, 0.4}), -0.5, 1e-3);
  EXPECT_NEAR(field.distance({0.3, 0.5, 0.4}), 0, 1e-3);
  EXPECT_NEAR(field.distance({0.3, 1.5, 0.4}), 1, 1e-3);
  EXPECT_NEAR(field.distance({0.3, -7, 0.4}), 6.5, 1e-3);
}

// The middle of the box is a layer of samples, which lie within.
TEST(DistanceFieldParts, a_body_thinner_than_a_voxel_is_held_where_it_is_alone) {
  const Field field(small_world::box({-8, -0.125f, -8}, {8, 0.125f, 8}), 16);
  EXPECT_NEAR(field.distance({0.3, 0, 0.4}), -0.125, 1e-3);
  EXPECT_GT(field.distance({0.3, 0.25, 0.4}), 0);
}

TEST(DistanceFieldParts, outside_of_its_frame_a_field_is_below_the_distance) {
  const Mesh body = tessellate(Sphere{{0, 0, 0}, 1}, 32, "sphere");
  const Field field(body, 64);
  const MeshDistances distances(body);
  Random random(2);
  std::uint32_t near = 0;
  for (int k = 0; k < 1000; ++k) {
    const glm::dvec3 p = random.uniform(glm::dvec3(-6), glm::dvec3(6));
    if (glm::all(glm::lessThan(glm::abs(p), glm::dvec3(1.05)))) continue;
    const double distance = distances.to_nearest(p, near), held = field.distance(p);
    // Interpolation between samples is off by the sphere's curve over a voxel: 3/8 h^2 / R = 0.0004 m.
    ASSERT_LE(held, distance + 0.001);
    ASSERT_GE(held, 0.7 * distance);
  }
}

/// Boxes in a grid of 16 x 8 x 4 meters, with samples at whole meters at resolution 16, whatever else is in it.
Mesh in_meters(const Mesh& body) {
  const Mesh parts[] = {small_world::box({0, 0, 0}, {1, 1, 1}), body, small_world::box({15, 7, 3}, {16, 8, 4})};
  return merge(parts, "in meters");
}

// The bilinear interpolant of max(x, y) within and of the length without, over all phases of the edge in the grid, is zero up
// to 0.42 voxel before the edge along its bisector.
TEST(DistanceFieldParts, a_right_edge_moves_in_by_less_than_half_a_voxel) {
  constexpr int phases = 12;
  double most = 0;
  for (int a = 0; a < phases; ++a)
    for (int b = 0; b < phases; ++b) {
      const glm::vec3 edge(8 + static_cast<float>(a) / phases, 4 + static_cast<float>(b) / phases, 4);
      const Field field(in_meters(small_world::box({3, 0, 0}, edge)), 16);
      double low = -1.5, high = 1;
      for (int k = 0; k < 40; ++k) {
        const double middle = (low + high) / 2, step = middle * std::numbers::sqrt2 / 2;
        (field.distance({edge.x + step, edge.y + step, 2}) > 0 ? high : low) = middle;
      }
      ASSERT_LT(low, 0.01);
      most = std::max(most, -low);
    }
  EXPECT_GT(most, 0.38);
  EXPECT_LT(most, 0.425);
}

// It is held where a sample lies within: at a share t of all positions.
TEST(DistanceFieldParts, a_plate_thinner_than_a_voxel_is_lost_at_the_share_that_it_lacks) {
  for (const float thickness : {0.25f, 0.5f, 0.75f}) {
    constexpr int count = 199;
    int lost = 0;
    for (int k = 0; k < count; ++k) {
      const float x = 5 + 4 * (static_cast<float>(k) + 0.5f) / count;
      const Field field(in_meters(small_world::box({x, 0, 0}, {x + thickness, 4, 4})), 16);
      double least = INFINITY;
      for (double at = 4; at <= 11; at += 0.125) least = std::min(least, field.distance({at, 2, 2}));
      lost += least > 0;
    }
    EXPECT_NEAR(static_cast<double>(lost) / count, 1 - thickness, 0.02) << thickness;
  }
}

}  // namespace gnomon::distance_field_parts_test
