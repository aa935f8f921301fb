// Exact signs and crossings against rational arithmetic.
#include <gmpxx.h>
#include <gnomon/kit/geometry/exact.h>
#include <gnomon/kit/geometry/shapes.h>
#include <gnomon/kit/random.h>
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <functional>

namespace gnomon::exact_test {

using Rational = mpq_class;
struct RationalVector {
  Rational x, y, z;
};
RationalVector rational(const glm::dvec3& p) { return {Rational(p.x), Rational(p.y), Rational(p.z)}; }
RationalVector operator-(const RationalVector& a, const RationalVector& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
RationalVector cross(const RationalVector& a, const RationalVector& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
Rational dot(const RationalVector& a, const RationalVector& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }

/// The definition: ((b - a) x (c - a)) . (d - w a).
int sign_by_rationals(const glm::vec3& a, const glm::vec3& b, const glm::vec3& c, const glm::dvec4& d) {
  const RationalVector origin = rational(a), to = rational(glm::dvec3(d));
  return sgn(dot(cross(rational(b) - origin, rational(c) - origin), d.w == 0 ? to : to - origin));
}

/// Another road than Cramer's rule: cut the carrier line with the plane, then see on which side of each edge the cut lies.
Crossing crossing_by_rationals(const Segment& segment, const Triangle& triangle) {
  const RationalVector p = rational(segment.point), l = rational(glm::dvec3(segment.light));
  const RationalVector way = segment.light.w == 0 ? l : l - p;
  std::array<RationalVector, 3> corner;
  for (int k = 0; k < 3; ++k) corner[k] = rational(triangle.points[k]);
  const RationalVector normal = cross(corner[1] - corner[0], corner[2] - corner[0]);
  const Rational rise = dot(normal, way), height = dot(normal, corner[0] - p);
  if (rise == 0 || height == 0) return Crossing::none;
  const Rational t = height / rise;
  if (t <= 0 || (segment.light.w != 0 && t >= 1)) return Crossing::none;
  const RationalVector cut = {p.x + t * way.x, p.y + t * way.y, p.z + t * way.z};
  bool on_edge = false;
  for (int k = 0; k < 3; ++k) {
    const int side = sgn(dot(normal, cross(corner[(k + 1) % 3] - corner[k], cut - corner[k])));
    if (side < 0) return Crossing::none;
    on_edge |= side == 0;
  }
  return on_edge ? Crossing::degenerate : Crossing::crosses;
}

/// Rational arithmetic is ten times slower under the sanitizers.
#ifdef __SANITIZE_ADDRESS__
constexpr int input_count = 10'000;
#else
constexpr int input_count = 100'000;
#endif

/// Inputs of one kind: fills four points.
using Source = std::function<void(Random&, std::array<glm::vec3, 4>&)>;

glm::vec3 in_cube(Random& random, double half) {
  return {random.uniform(-half, half), random.uniform(-half, half), random.uniform(-half, half)};
}

/// A float of any exponent between two, with random mantissa and sign.
float of_any_size(Random& random, int low, int high) {
  const double value = std::ldexp(random.uniform(1, 2), low + static_cast<int>(random.below(high - low + 1)));
  return static_cast<float>(random.below(2) ? value : -value);
}

/// d in the plane of a, b, c but for its rounding to float: the determinant is then some 2^-24 of its terms, or zero.
void flatten(Random& random, std::array<glm::vec3, 4>& p) {
  const double s = random.uniform(-2, 2), t = random.uniform(-2, 2);
  const glm::dvec3 a(p[0]);
  p[3] = glm::vec3(a + s * (glm::dvec3(p[1]) - a) + t * (glm::dvec3(p[2]) - a));
}

SignTally expect_signs_are_those_of_rationals(const Source& source) {
  Random random(7);
  SignTally tally;
  std::array<glm::vec3, 4> p;
  for (int i = 0; i < input_count; ++i) {
    source(random, p);
    const glm::dvec4 point(p[3], 1), direction(p[3], 0);
    EXPECT_EQ(orient3d_sign(p[0], p[1], p[2], p[3], &tally), sign_by_rationals(p[0], p[1], p[2], point)) << "input " << i;
    EXPECT_EQ(orient3d_sign(p[0], p[1], p[2], direction, &tally), sign_by_rationals(p[0], p[1], p[2], direction))
        << "input " << i;
    if (testing::Test::HasFailure()) break;
  }
  return tally;
}

TEST(Exact, signs_of_random_points_are_those_of_rationals) {
  const SignTally tally = expect_signs_are_those_of_rationals([](Random& random, auto& p) {
    for (glm::vec3& point : p) point = in_cube(random, 10);
  });
  EXPECT_LT(tally.lattice + tally.big, 20u);  // chance determinants are far above the filter's 2^-49
}

// Points within a millimeter, a kilometer from the origin: the float grid is about 2^-14 there, so the points have few distinct
// places, and rounding onto the grid leaves one in a hundred exactly coplanar. Their exponents are alike: all are on one
// lattice.
TEST(Exact, signs_of_nearly_coplanar_points_are_those_of_rationals) {
  const SignTally tally = expect_signs_are_those_of_rationals([](Random& random, auto& p) {
    const glm::vec3 center = in_cube(random, 1000);
    for (glm::vec3& point : p) point = center + in_cube(random, 0.001);
    flatten(random, p);
  });
  EXPECT_GT(tally.lattice, input_count / 200u);
  EXPECT_EQ(tally.big, 0u);
}

// Four integer points of -4 .. 4 are coplanar often, so that zero is tested as much as the signs; the odd scale changes
// nothing.
TEST(Exact, signs_on_a_coarse_lattice_are_those_of_rationals) {
  expect_signs_are_those_of_rationals([](Random& random, auto& p) {
    for (glm::vec3& point : p) point = (glm::vec3(random.below(9), random.below(9), random.below(9)) - 4.0f) * 0x1p-17f;
  });
}

// The ends of the integer tier: coordinates at +-16, where differences are 2^41 steps of 2^-36, beside single steps. Planes
// that contain nearly the same diagonal make the determinant far smaller than its terms, so that the filter gives up.
// The sanitizers' build would stop at an overflow.
TEST(Exact, integers_do_not_overflow_at_the_ends_of_their_range) {
  const SignTally tally = expect_signs_are_those_of_rationals([](Random& random, auto& p) {
    const auto coordinate = [&] {
      const float values[] = {16, -16, 16 - 0x1p-20f, -16 + 0x1p-20f, 0x1p-36f, -0x1p-36f, 3 * 0x1p-36f, 0};
      return values[random.below(8)];
    };
    for (glm::vec3& point : p) point = {coordinate(), coordinate(), coordinate()};
  });
  EXPECT_GT(tally.lattice, input_count / 100u);
  EXPECT_EQ(tally.big, 0u);
}

// 1e-38 .. 1e38 is about 2^-126 .. 2^126. One term would rule every determinant; equal points and coordinates let the small
// ones decide.
TEST(Exact, signs_over_the_whole_float_range_are_those_of_rationals) {
  expect_signs_are_those_of_rationals([](Random& random, auto& p) {
    for (glm::vec3& point : p)
      for (int k = 0; k < 3; ++k) point[k] = of_any_size(random, -126, 125);
    if (random.below(2)) p[1] = p[0] + p[2];
    if (random.below(2)) p[3] = p[1];
    if (random.below(2)) p[3].x = p[2].x;
  });
}

// Coordinates of 2^-100 .. 2^100 share no lattice of 41 bits, and flattening takes the determinant below the filter: GMP's
// turn.
TEST(Exact, signs_of_huge_flat_configurations_are_those_of_rationals) {
  const SignTally tally = expect_signs_are_those_of_rationals([](Random& random, auto& p) {
    for (int k = 0; k < 3; ++k)
      p[k] = {of_any_size(random, -100, 100), of_any_size(random, -100, 100), of_any_size(random, -100, 100)};
    flatten(random, p);
  });
  EXPECT_GT(tally.big, input_count / 100u);
}

TEST(Exact, signs_of_denormal_coordinates_are_those_of_rationals) {
  expect_signs_are_those_of_rationals([](Random& random, auto& p) {
    for (glm::vec3& point : p)
      point = (glm::vec3(random.below(1000), random.below(1000), random.below(1000)) - 500.0f) * 0x1p-149f;
    if (random.below(2)) flatten(random, p);
  });
}

/// Every finite float, denormals and both zeros included, by its bits.
rc::Gen<float> finite_float() {
  return rc::gen::map(rc::gen::resize(rc::kNominalSize, rc::gen::arbitrary<std::uint32_t>()), [](std::uint32_t bits) {
    const float value = std::bit_cast<float>(bits);
    return std::isfinite(value) ? value : 0.0f;
  });
}
rc::Gen<glm::vec3> finite_point() {
  return rc::gen::map(rc::gen::tuple(finite_float(), finite_float(), finite_float()),
                      [](const auto& t) { return glm::vec3(std::get<0>(t), std::get<1>(t), std::get<2>(t)); });
}

RC_GTEST_PROP(Exact, any_four_finite_points_have_the_sign_of_rationals, ()) {
  const glm::vec3 a = *finite_point(), b = *finite_point(), c = *finite_point(), d = *finite_point();
  for (const double w : {0.0, 1.0})
    RC_ASSERT(orient3d_sign(a, b, c, glm::dvec4(d, w)) == sign_by_rationals(a, b, c, glm::dvec4(d, w)));
}

// Swapping two rows of a determinant negates it: the sign of a permutation carries over, exactly.
TEST(Exact, every_permutation_carries_its_parity_to_the_sign) {
  Random random(11);
  for (int i = 0; i < 20'000; ++i) {
    std::array<glm::vec3, 4> p;
    for (glm::vec3& point : p) point = in_cube(random, 1);
    if (i % 2) flatten(random, p);
    const int sign = orient3d_sign(p[0], p[1], p[2], p[3]);
    std::array<int, 4> order{0, 1, 2, 3};
    do {
      int parity = 1;
      for (int j = 0; j < 4; ++j)
        for (int k = j + 1; k < 4; ++k) parity = order[j] > order[k] ? -parity : parity;
      ASSERT_EQ(orient3d_sign(p[order[0]], p[order[1]], p[order[2]], p[order[3]]), parity * sign);
    } while (std::next_permutation(order.begin(), order.end()));
  }
}

TEST(Exact, counter_clockwise_seen_from_the_fourth_point_is_positive) {
  const glm::vec3 a(0, 0, 0), b(1, 0, 0), c(0, 1, 0);
  EXPECT_EQ(orient3d_sign(a, b, c, glm::vec3(0, 0, 1)), 1);
  EXPECT_EQ(orient3d_sign(a, b, c, glm::dvec4(5, 5, 1, 0)), 1);
  EXPECT_EQ(orient3d_sign(a, b, c, glm::dvec4(5, 5, -1, 0)), -1);
  EXPECT_EQ(orient3d_sign(a, b, c, glm::dvec4(5, 5, 0, 0)), 0);
}

// (0.1, 0.2, 0.3) doubles without rounding, so 0, p and 2p are collinear, and coplanar with any fourth point.
TEST(Exact, coplanar_sees_one_float_step) {
  const glm::vec3 origin(0), p(0.1f, 0.2f, 0.3f), q = 2.0f * p;
  const glm::vec3 beside(q.x, q.y, std::nextafter(q.z, 1.0f));
  EXPECT_TRUE(coplanar(origin, p, beside, q));
  // The normal of 0, p, (1, 0, 0) is (0, 0.3f, -0.2f) up to a factor; (0, 0.2f, 0.3f) is on the plane, one step up is not.
  EXPECT_TRUE(coplanar(origin, p, glm::vec3(1, 0, 0), glm::vec3(0, p.y, p.z)));
  EXPECT_FALSE(coplanar(origin, p, glm::vec3(1, 0, 0), glm::vec3(0, p.y, std::nextafter(p.z, 1.0f))));
}

glm::vec3 integer_point(Random& random, int half) {
  const auto coordinate = [&] { return static_cast<float>(static_cast<int>(random.below(2 * half + 1)) - half); };
  return {coordinate(), coordinate(), coordinate()};
}

// Triangles of even integers have integer midpoints. A segment from M - i D to M + j D, with integer D, goes exactly through M:
// the midpoint of an edge, or a corner, or the middle of a median. D itself, as a direction, is the way of a directional light.
TEST(Exact, crossings_aimed_at_edges_and_corners_are_those_of_rationals) {
  Random random(5);
  int counts[3] = {};
  for (int i = 0; i < input_count; ++i) {
    Triangle triangle;
    for (glm::vec3& p : triangle.points) p = 4.0f * integer_point(random, 8);
    const glm::vec3 *p = triangle.points, way = integer_point(random, 6);
    const glm::vec3 targets[] = {p[0], (p[0] + p[1]) / 2.0f, (p[0] + p[1]) / 4.0f + p[2] / 2.0f, integer_point(random, 40)};
    const glm::vec3 target = targets[random.below(4)];
    const glm::vec3 from = target - static_cast<float>(random.below(4)) * way;
    const glm::vec3 to = target + static_cast<float>(random.below(4)) * way;
    for (const Segment& segment : {Segment{from, glm::dvec4(to, 1)}, Segment{from, glm::dvec4(way, 0)}}) {
      const Crossing expected = crossing_by_rationals(segment, triangle);
      ASSERT_EQ(crosses(segment, triangle), expected) << "input " << i;
      ASSERT_EQ(crosses(segment, {{p[2], p[1], p[0]}}), expected) << "winding must not matter, input " << i;
      ++counts[static_cast<int>(expected)];
    }
  }
  for (const int count : counts) EXPECT_GT(count, input_count / 20);  // the aim was good: all three answers are tested
}

// The same with floats: the target is rounded, so the segment passes within a rounding of the edge, on either side or through
// it.
TEST(Exact, crossings_within_a_rounding_of_an_edge_are_those_of_rationals) {
  Random random(6);
  int crossed = 0, missed = 0;
  for (int i = 0; i < input_count / 2; ++i) {
    Triangle triangle;
    for (glm::vec3& p : triangle.points) p = in_cube(random, 10);
    const glm::vec3 *p = triangle.points, from = in_cube(random, 10);
    const glm::vec3 target = glm::mix(p[0], p[1], static_cast<float>(random.uniform(0, 1)));
    const glm::vec3 beyond = from + 2.0f * (target - from);
    for (const Segment& segment : {Segment{from, glm::dvec4(beyond, 1)}, Segment{from, glm::dvec4(beyond - from, 0)}}) {
      const Crossing expected = crossing_by_rationals(segment, triangle);
      ASSERT_EQ(crosses(segment, triangle), expected) << "input " << i;
      ++(expected == Crossing::none ? missed : crossed);
    }
  }
  EXPECT_GT(crossed, input_count / 5);
  EXPECT_GT(missed, input_count / 5);
}

// From inside a closed mesh there is no way out but through a triangle, an edge or a vertex. Every segment here is aimed at an
// edge, where a rounding predicate may miss both of its triangles.
TEST(Exact, no_segment_leaves_a_closed_mesh_between_two_triangles) {
  const Mesh mesh = tessellate(Sphere{{0.1f, 0.2f, 0.3f}, 1}, 16, "sphere");
  ASSERT_TRUE(mesh.facts.closed());
  Random random(3);
  for (const glm::uvec3& aimed : mesh.triangles)
    for (int i = 0; i < 20; ++i) {
      const float share = i < 2 ? static_cast<float>(i) : static_cast<float>(random.uniform(0, 1));
      const glm::vec3 target = glm::mix(mesh.positions[aimed.x], mesh.positions[aimed.y], share);
      const glm::vec3 inside = glm::vec3(0.1f, 0.2f, 0.3f) + in_cube(random, 0.3);
      const Segment segment{inside, glm::dvec4(inside + 5.0f * (target - inside), 1)};
      EXPECT_TRUE(std::any_of(mesh.triangles.begin(), mesh.triangles.end(), [&](const glm::uvec3& t) {
        return crosses(segment, {{mesh.positions[t.x], mesh.positions[t.y], mesh.positions[t.z]}}) != Crossing::none;
      }));
    }
}

// Triangle (0,0,0) (4,0,0) (0,4,0), point (1,1,-2): the segment to (1,1,z) crosses the plane z = 0 when z > 0.
TEST(Exact, a_plane_that_holds_either_end_is_not_crossed) {
  const Triangle triangle{{{0, 0, 0}, {4, 0, 0}, {0, 4, 0}}};
  EXPECT_EQ(crosses({{1, 1, -2}, {1, 1, 1, 1}}, triangle), Crossing::crosses);
  EXPECT_EQ(crosses({{1, 1, -2}, {1, 1, 0, 1}}, triangle), Crossing::none);
  EXPECT_EQ(crosses({{1, 1, -2}, {1, 1, -1, 1}}, triangle), Crossing::none);
  EXPECT_EQ(crosses({{1, 1, 0}, {1, 1, 3, 1}}, triangle), Crossing::none);
  EXPECT_EQ(crosses({{1, 1, 0}, {1, 0, 0, 0}}, triangle), Crossing::none);
  EXPECT_EQ(crosses({{1, 1, -2}, {1, 0, 0, 0}}, triangle), Crossing::none);
  EXPECT_EQ(crosses({{1, 1, -2}, {0, 0, -1, 0}}, triangle), Crossing::none);
  EXPECT_EQ(crosses({{2, 2, -2}, {0, 0, 1, 0}}, triangle), Crossing::degenerate);  // on the edge x + y = 4
  EXPECT_EQ(crosses({{4, 0, -2}, {0, 0, 1, 0}}, triangle), Crossing::degenerate);  // on a vertex
  EXPECT_EQ(crosses({{1, 1, -2}, {1, 1, -2, 1}}, triangle), Crossing::none);       // the light at the point
}

}  // namespace gnomon::exact_test
