// What is solid along a segment, against rational arithmetic, and how far float32 may be off.
#include <gnomon/kit/geometry/holes.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "masked.h"
#include "rational_holes.h"

namespace gnomon::holes_test {

/// Rational arithmetic is ten times slower under the sanitizers.
#ifdef __SANITIZE_ADDRESS__
constexpr int input_count = 2'000;
#else
constexpr int input_count = 20'000;
#endif

glm::dvec4 at(const glm::vec3& p) { return {glm::dvec3(p), 1}; }
glm::dvec4 toward(const glm::vec3& d) { return {glm::dvec3(d), 0}; }

const glm::vec3 point_on_paper(1, 0, 1), light_on_paper(3, 6, 2);

TEST(holes, the_place_is_that_of_the_vector_on_paper) {
  // 8 * (5/12, 1/3) = (3.33, 2.67), 4 * (5/12, 1/3) = (1.67, 1.33).
  for (const int size : {8, 4}) {
    const Mesh mesh = masked::triangle_on_paper(masked::checker(size, size));
    for (const glm::dvec4& light : {at(light_on_paper), toward(light_on_paper - point_on_paper)}) {
      const TexelPlace place = texel_place(mesh, 0, point_on_paper, light);
      EXPECT_NEAR(place.x, size * 5 / 12.0, 1e-14);
      EXPECT_NEAR(place.y, size / 3.0, 1e-14);
    }
  }
}

// (3, 2) of 8 x 8 is a hole of the checker, (1, 1) of 4 x 4 is set.
TEST(holes, the_texel_is_that_of_the_vector_on_paper) {
  for (const glm::dvec4& light : {at(light_on_paper), toward(light_on_paper - point_on_paper)}) {
    EXPECT_FALSE(is_solid_at(masked::triangle_on_paper(masked::checker(8, 8)), 0, {point_on_paper, light}));
    EXPECT_TRUE(is_solid_at(masked::triangle_on_paper(masked::checker(4, 4)), 0, {point_on_paper, light}));
  }
}

// From (1.5, 0, 1) the way meets x = 2, u = 1/2: column 4 of 8 exactly, row 2.
TEST(holes, a_place_on_the_edge_of_a_texel_belongs_to_the_greater_one) {
  for (int column = 0; column < 8; ++column) {
    std::vector<std::uint8_t> alpha(64, 0);
    alpha[2 * 8 + column] = 255;
    const Mesh mesh = masked::triangle_on_paper(std::make_shared<const AlphaMask>(8, 8, alpha));
    EXPECT_EQ(is_solid_at(mesh, 0, {{1.5f, 0, 1}, at(light_on_paper)}), column == 4) << column;
  }
}

TEST(holes, a_triangle_without_a_mask_is_solid) {
  const Mesh mesh = hand_made::mesh_of({{0, 2, 0}, {4, 2, 0}, {0, 2, 4}}, {{0, 1, 2}});
  EXPECT_TRUE(is_solid_at(mesh, 0, {point_on_paper, at(light_on_paper)}));
  EXPECT_TRUE(is_solid_along(mesh, 0, point_on_paper, light_on_paper));
}

TEST(holes, what_is_around_a_place_is_both_only_beside_texels_that_differ) {
  const auto mask = masked::mask_of({"##..", "##.."});
  EXPECT_EQ(around(*mask, {1.5, 0.5}, 0.4), Around::solid);
  EXPECT_EQ(around(*mask, {0.999, 0.999}, 0.1), Around::solid);  // across edges of equal bits
  EXPECT_EQ(around(*mask, {3, 1}, 0.25), Around::hole);
  EXPECT_EQ(around(*mask, {1.75, 0.5}, 0.24), Around::solid);
  EXPECT_EQ(around(*mask, {1.75, 0.5}, 0.25), Around::both);  // 2 is of the hole
  EXPECT_EQ(around(*mask, {2.25, 0.5}, 0.25), Around::hole);
  EXPECT_EQ(around(*mask, {2.25, 0.5}, 0.2501), Around::both);
  EXPECT_EQ(around(*mask, {0.1, 0.5}, 0.2), Around::both);  // the image repeats
  const auto clamped = masked::mask_of({"##..", "##.."}, AlphaMask::Wrap::clamp, AlphaMask::Wrap::clamp);
  EXPECT_EQ(around(*clamped, {0.1, 0.5}, 0.2), Around::solid);
  EXPECT_EQ(around(*clamped, {-7, 9}, 3), Around::solid);
}

TEST(holes, around_everywhere_is_what_the_whole_mask_is) {
  for (const double reach : {64.0, 1e30, double(INFINITY), double(NAN)}) {
    EXPECT_EQ(around(*masked::mask_of({"#.", ".."}), {0.5, 0.5}, reach), Around::both);
    EXPECT_EQ(around(*masked::mask_of({"##", "##"}), {0.5, 0.5}, reach), Around::solid);
    EXPECT_EQ(around(*masked::mask_of({"..", ".."}), {0.5, 0.5}, reach), Around::hole);
  }
  EXPECT_EQ(around(*masked::mask_of({"#.", ".."}), {NAN, 0.5}, 0), Around::both);
}

// 8 texels along 4 m, so 2 a meter, and u up to 1. Straight on: 16 * 2^-24 * (2 * 4 * 2 + 8) = 24 * 2^-20; at 60 degrees twice
// the first term.
TEST(holes, the_rounding_of_a_look_up_is_the_formulas) {
  const Mesh mesh = masked::triangle_on_paper(masked::checker(8, 8));
  EXPECT_NEAR(texel_rounding(mesh, 0, {0, 1, 0}, 4), 24 * 0x1p-20, 1e-18);
  EXPECT_NEAR(texel_rounding(mesh, 0, {0, -7, 0}, 4), 24 * 0x1p-20, 1e-18);
  EXPECT_NEAR(texel_rounding(mesh, 0, {std::sqrt(3.0), 1, 0}, 4), 40 * 0x1p-20, 1e-18);
  EXPECT_EQ(texel_rounding(mesh, 0, {1, 0, 1}, 4), INFINITY);
}

/// One triangle and a segment through it, or beside it.
struct Trial {
  Triangle corners;
  std::array<glm::vec2, 3> uv;
  Segment segment;
};
using Source = std::function<Trial(Random&)>;

struct Tally {
  int crossings = 0, on_texel_edges = 0, holes = 0, doubtful = 0;
};

double extent_of(const Trial& trial) {
  double most = std::max(extent(glm::dvec3(trial.segment.point)),
                         trial.segment.light.w != 0 ? extent(glm::dvec3(trial.segment.light)) : 0);
  for (const glm::vec3& corner : trial.corners.points) most = std::max(most, extent(glm::dvec3(corner)));
  return most;
}

/// Some of each kind of wrap and size.
std::vector<std::shared_ptr<const AlphaMask>> all_masks() {
  Random random(3);
  std::vector<std::shared_ptr<const AlphaMask>> masks;
  for (const AlphaMask::Wrap wrap_u : masked::wraps)
    for (const AlphaMask::Wrap wrap_v : masked::wraps)
      for (const glm::ivec2 size :
           {glm::ivec2(1, 1), glm::ivec2(2, 3), glm::ivec2(8, 8), glm::ivec2(33, 7), glm::ivec2(256, 128)})
        masks.push_back(masked::random_mask(random, size.x, size.y, wrap_u, wrap_v));
  return masks;
}

/// Compares all answers about one source's segments with those of rational numbers. Places in double are off by at most
/// `share` of what float32 may be off by; infinite: by anything.
Tally expect_answers_are_those_of_rationals(const Source& source, double share) {
  static const auto masks = all_masks();
  Random random(11);
  Tally tally;
  for (int i = 0; i < input_count && !testing::Test::HasFailure(); ++i) {
    const Trial trial = source(random);
    const auto found = rational_holes::cut(trial.segment, trial.corners);
    if (!found) continue;
    Mesh mesh;
    mesh.positions.assign(trial.corners.points, trial.corners.points + 3);
    mesh.triangles = {{0, 1, 2}};
    mesh.uv.assign(trial.uv.begin(), trial.uv.end());
    mesh.alpha_mask = masks[random.below(static_cast<std::uint32_t>(masks.size()))];
    const bool is_solid = rational_holes::is_solid(mesh, 0, *found);
    EXPECT_EQ(is_solid_at(mesh, 0, trial.segment), is_solid) << "input " << i;
    const glm::dvec3 point = trial.segment.point, way = glm::dvec3(trial.segment.light) - trial.segment.light.w * point;
    const TexelPlace place = texel_place(mesh, 0, point, trial.segment.light);
    const double rounding = texel_rounding(mesh, 0, way, extent_of(trial));
    const Around near = around(*mesh.alpha_mask, place, rounding);
    if (near != Around::both) {
      EXPECT_EQ(near == Around::solid, is_solid) << "input " << i;
      EXPECT_EQ(is_solid_along(mesh, 0, point, way), is_solid) << "input " << i;
      EXPECT_EQ(is_solid_along(mesh, 0, 0x1p20 * point, way, 0x1p20), is_solid) << "input " << i;
    }
    for (int axis = 0; axis < 2; ++axis) {
      const mpq_class exact = rational_holes::place(mesh, 0, *found, axis);
      const double off = std::abs((axis == 0 ? place.x : place.y) - exact.get_d());
      EXPECT_TRUE(share == INFINITY || off <= share * rounding) << "input " << i << ": " << off << " of " << rounding;
      tally.on_texel_edges += exact.get_den() == 1;
    }
    ++tally.crossings;
    tally.holes += !is_solid;
    tally.doubtful += near == Around::both;
  }
  EXPECT_GT(tally.holes, tally.crossings / 4);
  EXPECT_LT(tally.holes, tally.crossings * 3 / 4);
  return tally;
}

glm::dvec3 in_triangle(Random& random, const Triangle& triangle) {
  double a = random.uniform(0, 1), b = random.uniform(0, 1);
  if (a + b > 1) {
    a = 1 - a;
    b = 1 - b;
  }
  const glm::dvec3 corner(triangle.points[0]);
  return corner + a * (glm::dvec3(triangle.points[1]) - corner) + b * (glm::dvec3(triangle.points[2]) - corner);
}

/// A triangle of some size anywhere, uv up to +- `most`, and a segment through it whose ends are up to `half` away; `slope` is
/// what it leaves the plane by.
Trial anywhere(Random& random, double half, double size, double most, double slope = 1) {
  Trial trial;
  const glm::dvec3 center = random.uniform(glm::dvec3(-half), glm::dvec3(half));
  for (glm::vec3& corner : trial.corners.points) corner = center + random.uniform(glm::dvec3(-size), glm::dvec3(size));
  for (glm::vec2& uv : trial.uv) {
    uv.x = static_cast<float>(random.uniform(-most, most));
    uv.y = static_cast<float>(random.uniform(-most, most));
  }
  const glm::dvec3 through = in_triangle(random, trial.corners), anyhow = random.uniform(glm::dvec3(-1), glm::dvec3(1));
  const glm::dvec3 edge(trial.corners.points[1] - trial.corners.points[0]);
  const glm::dvec3 way = slope == 1 ? anyhow : edge / std::max(glm::length(edge), 1e-9) + slope * anyhow;
  const double before = random.uniform(0.05, 1) * half, behind = random.uniform(0.05, 1) * half;
  trial.segment.point = through - before * way;
  trial.segment.light = random.below(3) ? at(through + behind * way) : toward(way);
  return trial;
}

TEST(holes, answers_in_a_room_are_those_of_rationals) {
  const Tally tally = expect_answers_are_those_of_rationals([](Random& random) { return anywhere(random, 4, 2, 2); }, 0x1p-20);
  EXPECT_GT(tally.crossings, input_count * 9 / 10);
  EXPECT_LT(tally.doubtful, input_count / 8);
}

TEST(holes, answers_ten_kilometers_away_are_those_of_rationals) {
  const Tally tally =
      expect_answers_are_those_of_rationals([](Random& random) { return anywhere(random, 1e4, 5, 2); }, 0x1p-10);
  EXPECT_GT(tally.crossings, input_count / 2);
}

// Triangles of centimeters at ten kilometers: the float grid is a millimeter there, and double is off by many texels.
TEST(holes, answers_about_tiny_triangles_far_away_are_those_of_rationals) {
  const Tally tally =
      expect_answers_are_those_of_rationals([](Random& random) { return anywhere(random, 1e4, 0.02, 100); }, INFINITY);
  EXPECT_GT(tally.crossings, input_count / 10);
}

TEST(holes, answers_about_grazing_ways_are_those_of_rationals) {
  const Tally tally = expect_answers_are_those_of_rationals([](Random& random) { return anywhere(random, 4, 2, 8, 1e-5); }, 1);
  EXPECT_GT(tally.crossings, input_count / 10);
}

// Whole coordinates and uv in eighths: a crossing at shares in eighths is a float32 point, and its place is on the edges of
// texels again and again, also at the edges and corners of the triangle.
TEST(holes, answers_exactly_on_the_edges_of_texels_are_those_of_rationals) {
  const auto whole = [](Random& random, int most) { return static_cast<int>(random.below(2 * most + 1)) - most; };
  const auto on_lattice = [&](Random& random) {
    Trial trial;
    for (glm::vec3& corner : trial.corners.points)
      for (int k = 0; k < 3; ++k) corner[k] = static_cast<float>(whole(random, 4));
    for (glm::vec2& uv : trial.uv)
      for (int k = 0; k < 2; ++k) uv[k] = static_cast<float>(whole(random, 16)) / 8;
    const auto first = static_cast<float>(random.below(9)), second = static_cast<float>(random.below(9)) * (8 - first) / 8;
    const glm::vec3* p = trial.corners.points;
    const glm::vec3 through = p[0] + first / 8 * (p[1] - p[0]) + second / 8 * (p[2] - p[0]);
    glm::vec3 way(0);
    for (int k = 0; k < 3; ++k) way[k] = static_cast<float>(whole(random, 3));
    trial.segment.point = through - static_cast<float>(1 + random.below(3)) * way;
    trial.segment.light = random.below(3) ? at(through + static_cast<float>(1 + random.below(3)) * way) : toward(way);
    return trial;
  };
  const Tally tally = expect_answers_are_those_of_rationals(on_lattice, 0x1p-20);
  EXPECT_GT(tally.crossings, input_count / 2);
  EXPECT_GT(tally.on_texel_edges, input_count / 10);
}

/// In float32, as a program that intersects a ray with a triangle does it (Moeller and Trumbore 1997).
float looked_up(const Trial& trial, int axis, float texels) {
  const glm::vec3* p = trial.corners.points;
  const glm::vec3 way = glm::vec3(trial.segment.light) - static_cast<float>(trial.segment.light.w) * trial.segment.point;
  const glm::vec3 e1 = p[1] - p[0], e2 = p[2] - p[0], across = glm::cross(way, e2), from = trial.segment.point - p[0],
                  other = glm::cross(from, e1);
  const float determinant = glm::dot(e1, across), a = glm::dot(from, across) / determinant,
              b = glm::dot(way, other) / determinant;
  return (trial.uv[0][axis] + a * (trial.uv[1][axis] - trial.uv[0][axis]) + b * (trial.uv[2][axis] - trial.uv[0][axis])) *
         texels;
}

// The margin is for points and lights that are rounded before: few look-ups use half of it.
TEST(holes, look_ups_in_float32_stay_within_the_rounding) {
  Random random(5);
  int count = 0, beyond_half = 0;
  for (int i = 0; i < 100'000; ++i) {
    const Trial trial = anywhere(random, 4, 1, 1);
    Mesh mesh;
    mesh.positions.assign(trial.corners.points, trial.corners.points + 3);
    mesh.triangles = {{0, 1, 2}};
    mesh.uv.assign(trial.uv.begin(), trial.uv.end());
    static const auto mask = masked::checker(1024, 1024);
    mesh.alpha_mask = mask;
    const glm::dvec3 point = trial.segment.point, way = glm::dvec3(trial.segment.light) - trial.segment.light.w * point;
    const glm::dvec3 normal = trial.corners.normal();
    if (!(std::abs(glm::dot(normal, way)) > 0.05 * glm::length(normal) * glm::length(way))) continue;
    const TexelPlace place = texel_place(mesh, 0, point, trial.segment.light);
    const double rounding = texel_rounding(mesh, 0, way, extent_of(trial));
    const double off = std::max(std::abs(looked_up(trial, 0, 1024) - place.x), std::abs(looked_up(trial, 1, 1024) - place.y));
    EXPECT_LT(off, rounding) << "input " << i;
    ++count;
    beyond_half += off > rounding / 2;
  }
  EXPECT_GT(count, 90'000);
  EXPECT_LT(beyond_half, count / 10'000);
}

}  // namespace gnomon::holes_test
