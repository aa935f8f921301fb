// The regular BSP tree: its order along rays, what its cuts make of triangles, and trees on paper.
#include <gnomon/error.h>
#include <gnomon/kit/bsp.h>
#include <gnomon/kit/exact.h>
#include <gnomon/kit/shapes.h>
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <map>
#include <numeric>

#include "hard_scenes.h"
#include "kit/bsp_dividing.h"

namespace gnomon {
namespace {

using Choice = BspOptions::Choice;
using hand_made::mesh_of, hand_made::square;

const std::vector<BspOptions> all_options = {{},
                                             {.free_cuts = false},
                                             {.choice = Choice::fewest_splits},
                                             {.choice = Choice::fewest_splits, .free_cuts = false, .candidates = 20},
                                             {.choice = Choice::first},
                                             {.candidates = 1, .sample = 1}};

Scene scene_of(std::vector<Mesh> meshes) {
  Scene scene;
  scene.meshes = std::move(meshes);
  return scene;
}

std::vector<Triangle> triangles_of(const Scene& scene) {
  std::vector<Triangle> triangles;
  for (const Mesh& mesh : scene.meshes)
    for (const glm::uvec3& t : mesh.triangles)
      triangles.push_back({{mesh.positions[t.x], mesh.positions[t.y], mesh.positions[t.z]}});
  return triangles;
}

glm::dvec3 normal_of(const Triangle& t) {
  const glm::dvec3 a(t.points[0]);
  return glm::normalize(glm::cross(glm::dvec3(t.points[1]) - a, glm::dvec3(t.points[2]) - a));
}

/// How far a point of the polygon's plane is inside it, by its nearest edge; negative outside.
double depth_inside(std::span<const Corner> polygon, const glm::dvec3& normal, const glm::dvec3& p) {
  double least = INFINITY;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const glm::dvec3 a = polygon[i].at, along = polygon[(i + 1) % polygon.size()].at - a;
    least = std::min(least, glm::dot(glm::cross(along, p - a), normal) / std::max(glm::length(along), 1e-300));
  }
  return least;
}

double area(std::span<const Corner> polygon) {
  glm::dvec3 sum(0);
  for (std::size_t i = 2; i < polygon.size(); ++i)
    sum += glm::cross(polygon[i - 1].at - polygon[0].at, polygon[i].at - polygon[0].at);
  return glm::length(sum) / 2;
}

/// The triangles of each coplanar set, sorted, from front to back.
std::vector<std::vector<std::uint32_t>> order(const Bsp& bsp, const glm::dvec4& from) {
  std::vector<std::vector<std::uint32_t>> sets;
  bsp.front_to_back(from, [&](std::span<const BspPolygon> set) {
    sets.emplace_back();
    for (const BspPolygon& polygon : set) sets.back().push_back(polygon.triangle);
    std::ranges::sort(sets.back());
  });
  return sets;
}

/// Six kinds of scenes, one after the other.
Scene random_scene(Random& random, int round) {
  std::mt19937 engine(static_cast<unsigned>(round));
  switch (round % 6) {
    case 0:
      return scene_of({hard_scenes::grid_soup(random, 40)});
    case 1:
      return scene_of({hard_scenes::boxes(random, 6, true), square(3, 0)});
    case 2:
      return scene_of({hard_scenes::boxes(random, 6, false), square(3, 0)});
    case 3:
      return scene_of({hard_scenes::cycle(2, 0), hard_scenes::cycle(1, 0.3f), hard_scenes::grid_soup(random, 10)});
    case 4:
      return scene_of({small_world::random_soup(engine, 40, 2, 0.1f, 2, 0.6f), square(3, 0)});
    default:
      return scene_of({tessellate(Sphere{{0.5f, 0, 0}, 1}, 8, "a"), tessellate(Sphere{{-0.5f, 0, 0}, 1}, 8, "b")});
  }
}

/// Along random rays from `from`, the hits well inside polygons come in the order of their sets; and a ray that hits a triangle
/// well inside hits one of its parts, or the border of two. Returns how many pairs of hits were put in order.
int expect_order(const Scene& scene, const Bsp& bsp, const glm::dvec4& from, Random& random, int rays) {
  const std::vector<Triangle> triangles = triangles_of(scene);
  struct Ranked {
    BspPolygon polygon;
    int rank;
  };
  std::vector<Ranked> ranked;
  std::vector<std::uint32_t> firsts;
  int rank = 0;
  bsp.front_to_back(from, [&](std::span<const BspPolygon> set) {
    EXPECT_FALSE(set.empty());
    firsts.push_back(set[0].first);
    for (const BspPolygon& polygon : set) ranked.push_back({polygon, rank});
    ++rank;
  });
  EXPECT_EQ(ranked.size(), bsp.polygons().size());
  std::vector<std::uint32_t> back;
  bsp.back_to_front(from, [&](std::span<const BspPolygon> set) { back.push_back(set[0].first); });
  std::ranges::reverse(back);
  EXPECT_EQ(back, firsts);

  constexpr double near = 1e-8;
  int pairs = 0;
  struct Hit {
    double t;
    int rank;
  };
  std::vector<Hit> hits;
  std::vector<int> parts(triangles.size());
  for (int r = 0; r < rays; ++r) {
    const Triangle& aim = triangles[random.below(static_cast<std::uint32_t>(triangles.size()))];
    const double u = random.uniform(0, 1), v = random.uniform(0, 1) * (1 - u);
    const glm::dvec3 target =
        (1 - u - v) * glm::dvec3(aim.points[0]) + u * glm::dvec3(aim.points[1]) + v * glm::dvec3(aim.points[2]);
    const glm::dvec3 origin = from.w != 0 ? glm::dvec3(from) : target + 40.0 * glm::normalize(glm::dvec3(from));
    if (glm::distance(origin, target) < 1e-3) continue;
    const glm::dvec3 direction = glm::normalize(target - origin);
    hits.clear();
    std::ranges::fill(parts, 0);
    for (const Ranked& r : ranked) {
      const Triangle& t = triangles[r.polygon.triangle];
      const glm::dvec3 n = normal_of(t);
      const double slope = glm::dot(n, direction);
      if (std::abs(slope) < 1e-3) continue;
      const double at = glm::dot(n, glm::dvec3(t.points[0]) - origin) / slope;
      if (at < near) continue;
      const double inside = depth_inside(bsp.corners(r.polygon), n, origin + at * direction);
      if (inside > -near) parts[r.polygon.triangle] += inside > near ? 1 : 1000;
      if (inside > near) hits.push_back({at, r.rank});
    }
    for (std::size_t i = 0; i < triangles.size(); ++i) {
      const glm::dvec3 n = normal_of(triangles[i]);
      const double slope = glm::dot(n, direction), at = glm::dot(n, glm::dvec3(triangles[i].points[0]) - origin) / slope;
      if (std::abs(slope) < 1e-3 || at < near) continue;
      Corner whole[3];
      for (int k = 0; k < 3; ++k) whole[k].at = triangles[i].points[k];
      if (depth_inside(whole, n, origin + at * direction) > 2 * near) {
        EXPECT_TRUE(parts[i] == 1 || parts[i] >= 1000) << "triangle " << i;
      }
    }
    std::ranges::sort(hits, {}, &Hit::t);
    for (std::size_t i = 0; i < hits.size(); ++i)
      for (std::size_t j = i + 1; j < hits.size(); ++j) {
        if (hits[j].t - hits[i].t < near) continue;
        ++pairs;
        EXPECT_LT(hits[i].rank, hits[j].rank);
      }
  }
  return pairs;
}

// From points all about, half of them on a grid and so on many planes, and from directions.
TEST(Bsp, order_is_that_along_every_ray) {
  Random random(1);
  int pairs = 0, splits = 0;
  for (int round = 0; round < 36; ++round) {
    SCOPED_TRACE(round);
    const Scene scene = random_scene(random, round);
    for (const BspOptions& options : all_options) {
      const Bsp bsp(scene, options);
      splits += static_cast<int>(bsp.split_count());
      const glm::dvec3 at = random.uniform(glm::dvec3(-3), glm::dvec3(3));
      for (const glm::dvec4& from : {glm::dvec4(at, 1), glm::dvec4(hard_scenes::on_grid(random, 2, 16), 1), glm::dvec4(at, 0)})
        pairs += expect_order(scene, bsp, from, random, 25);
    }
  }
  EXPECT_GT(pairs, 20'000);
  EXPECT_GT(splits, 10'000);
}

/// Areas of the parts against those of the triangles; edges of parts against those of their triangle: what is marked 0 lies on
/// one of them, what is marked 1 does not. A sliver of 2^-12 m is at most as wide there.
void expect_partition(const Scene& scene, const Bsp& bsp) {
  const std::vector<Triangle> triangles = triangles_of(scene);
  std::vector<double> areas(triangles.size(), 0);
  for (const BspPolygon& polygon : bsp.polygons()) {
    const std::span<const Corner> corners = bsp.corners(polygon);
    ASSERT_GE(corners.size(), 3u);
    areas[polygon.triangle] += area(corners);
    const Triangle& t = triangles[polygon.triangle];
    const glm::dvec3 n = normal_of(t);
    for (std::size_t i = 0; i < corners.size(); ++i) {
      const glm::dvec3 a = corners[i].at, b = corners[(i + 1) % corners.size()].at;
      EXPECT_LT(std::abs(glm::dot(n, a - glm::dvec3(t.points[0]))), 1e-8);
      double off = INFINITY;  // of both ends, from the nearest of the triangle's own edges
      for (int k = 0; k < 3; ++k) {
        const glm::dvec3 p(t.points[k]), along = glm::normalize(glm::dvec3(t.points[(k + 1) % 3]) - p);
        off = std::min(off, std::max(glm::length(glm::cross(along, a - p)), glm::length(glm::cross(along, b - p))));
      }
      if (corners[i].edge == 0) {
        EXPECT_LT(off, 1e-8);
      } else {
        EXPECT_EQ(corners[i].edge, 1u);
        // A cut that starts at a corner may leave an edge at as small an angle as epsilon over its length.
        if (glm::distance(a, b) > 1e-3) {
          EXPECT_GT(off, bsp.epsilon() / 1000);
        }
      }
    }
  }
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    const glm::dvec3 a(triangles[i].points[0]);
    const double whole =
        glm::length(glm::cross(glm::dvec3(triangles[i].points[1]) - a, glm::dvec3(triangles[i].points[2]) - a)) / 2;
    EXPECT_NEAR(areas[i], whole, 1e-8 * (1 + whole)) << i;
  }
}

TEST(Bsp, parts_make_up_their_triangles) {
  Random random(2);
  for (int round = 0; round < 60; ++round) {
    SCOPED_TRACE(round);
    const Scene scene = random_scene(random, round);
    for (const BspOptions& options : all_options) {
      const Bsp bsp(scene, options);
      expect_partition(scene, bsp);
      EXPECT_EQ(bsp.polygons().size(), scene.triangle_count() + bsp.split_count());
      EXPECT_LE(bsp.depth(), bsp.node_count());
    }
  }
}

// Each of the six planes of a box has the rest on its inner side: six nodes, one below the other, two triangles each, no cut.
TEST(Bsp, a_box_is_a_chain_of_its_sides) {
  const Scene scene = scene_of({small_world::box({-1, -2, -3}, {3, 2, 1})});
  for (const Choice choice : {Choice::first, Choice::fewest_splits, Choice::balanced}) {
    const Bsp bsp(scene, {.choice = choice, .free_cuts = false});
    EXPECT_EQ(bsp.node_count(), 6u);
    EXPECT_EQ(bsp.depth(), 6u);
    EXPECT_EQ(bsp.split_count(), 0u);
    for (const auto& set : order(bsp, {0, 0, 0, 1})) EXPECT_EQ(set.size(), 2u);
  }
}

// Choice `first`: the triangle in y = 0 divides the one in x = 0, whose corners are at heights -1, 1, 1: the cut runs through
// the middles of two edges. Below is a triangle, above a quadrilateral, each with one edge of the cut.
TEST(Bsp, a_cut_on_paper) {
  const Scene scene = scene_of(
      {mesh_of({{-4, 0, -4}, {0, 0, 8}, {4, 0, -4}}, {{0, 1, 2}}), mesh_of({{0, -1, 0}, {0, 1, -1}, {0, 1, 1}}, {{0, 1, 2}})});
  const Bsp bsp(scene, {.choice = Choice::first});
  EXPECT_EQ(bsp.split_count(), 1u);
  EXPECT_EQ(bsp.node_count(), 3u);
  EXPECT_EQ(bsp.depth(), 2u);
  EXPECT_EQ(bsp.epsilon(), 8e-10);
  std::vector<std::size_t> corners;
  bsp.front_to_back({3, 5, 0, 1}, [&](std::span<const BspPolygon> set) {
    ASSERT_EQ(set.size(), 1u);
    const auto polygon = bsp.corners(set[0]);
    corners.push_back(polygon.size());
    std::uint32_t marks = 0;
    for (std::size_t i = 0; i < polygon.size(); ++i) {
      marks += polygon[i].edge;
      if (set[0].triangle == 1 && polygon[i].at.y == 0) {
        EXPECT_EQ(std::abs(polygon[i].at.z), 0.5);
      }
      const glm::dvec3 next = polygon[(i + 1) % polygon.size()].at;
      if (polygon[i].edge == 1) {
        EXPECT_TRUE(polygon[i].at.y == 0 && next.y == 0);
      }
    }
    EXPECT_EQ(marks, set[0].triangle);
  });
  EXPECT_EQ(corners, (std::vector<std::size_t>{4, 3, 3}));  // above, the first triangle, below
}

// Sheets 2^-44 m apart, far below epsilon, go to their sides by their exact signs; copies, and a neighbor wound the other way,
// lie in one set with the original.
TEST(Bsp, sheets_within_epsilon_keep_their_order) {
  std::vector<Mesh> meshes{square(4, 0)};
  for (const int k : {2, -1, 3, 1, -2})
    meshes.push_back(
        mesh_of({{-1, 0x1p-44f * float(k), -1}, {0, 0x1p-44f * float(k), 2}, {2, 0x1p-44f * float(k), -1}}, {{0, 1, 2}}));
  meshes.push_back(meshes[3]);
  meshes.push_back(mesh_of({{-1, 0, -1}, {2, 0, -1}, {0, 0, 2}}, {{0, 1, 2}}));
  const Scene scene = scene_of(meshes);
  const std::vector<std::vector<std::uint32_t>> down = {{4, 7}, {2}, {5}, {0, 1, 8}, {3}, {6}};
  for (const BspOptions& options : all_options) {
    const Bsp bsp(scene, options);
    EXPECT_GT(bsp.epsilon(), 0x1p-42);
    EXPECT_EQ(bsp.split_count(), 0u);
    EXPECT_EQ(order(bsp, {0, 1, 0, 1}), down);
    EXPECT_EQ(order(bsp, {0.1, 1, 0.1, 0}), down);
    auto up = order(bsp, {0, -1, 0, 1});
    std::ranges::reverse(up);
    EXPECT_EQ(up, down);
  }
}

// A triangle of a mesh whose corners are on a plane, or below epsilon from it, is not cut: a fan around the axis y, whose
// triangles share the corner that lies on the plane of the ground.
TEST(Bsp, shared_corners_on_a_plane_cause_no_cuts) {
  std::vector<glm::vec3> positions{{0.3f, 0, 0.7f}};
  std::vector<glm::uvec3> triangles;
  for (std::uint32_t k = 0; k < 12; ++k) {
    const float angle = 0.5f * static_cast<float>(k);
    positions.push_back({std::cos(angle), 0.5f, std::sin(angle)});
    if (k > 0) triangles.push_back({0, k, k + 1});
  }
  const Scene scene = scene_of({square(2, 0), mesh_of(positions, triangles)});
  EXPECT_EQ(Bsp(scene, {.choice = Choice::first}).split_count(),
            Bsp(scene_of({scene.meshes[1]}), {.choice = Choice::first}).split_count());
}

// Sixty-four copies, half of them turned over, are one set; so are all triangles of a floor, cut as it may be.
TEST(Bsp, copies_and_floors_are_one_set) {
  Mesh copies = mesh_of({{0, 1, 0}, {0.1f, 2, 4}, {4, 3, 0.7f}}, {{0, 1, 2}});
  for (int i = 1; i < 64; ++i) copies.triangles.push_back(i % 2 ? glm::uvec3(0, 2, 1) : glm::uvec3(1, 2, 0));
  for (const BspOptions& options : all_options) {
    const Bsp bsp(scene_of({copies}), options);
    EXPECT_EQ(bsp.node_count(), 1u);
    EXPECT_EQ(bsp.polygons().size(), 64u);
  }
  std::vector<glm::vec3> positions;
  std::vector<glm::uvec3> triangles;
  for (std::uint32_t x = 0; x < 9; ++x)
    for (std::uint32_t z = 0; z < 9; ++z) {
      positions.push_back({0.1f * float(x), 0.7f, 0.3f * float(z)});
      if (x > 0 && z > 0)
        triangles.push_back({9 * x + z, 9 * x + z - 1, 9 * x + z - 9}),
            triangles.push_back({9 * x + z - 10, 9 * x + z - 9, 9 * x + z - 1});
    }
  const Bsp floor(scene_of({mesh_of(positions, triangles)}), {.free_cuts = false});
  EXPECT_EQ(floor.node_count(), 1u);
  EXPECT_EQ(floor.polygons().size(), 128u);
}

// A stack of n sheets by the choice `first` is a chain of n nodes: no call stack is used, neither to make nor to walk it.
TEST(Bsp, a_stack_is_a_chain_without_recursion) {
  constexpr int count = 4000;
  std::vector<Mesh> meshes(1);
  for (int i = 0; i < count; ++i) {
    const float y = static_cast<float>(i);
    const auto first = static_cast<std::uint32_t>(meshes[0].positions.size());
    meshes[0].positions.insert(meshes[0].positions.end(), {{0, y, 0}, {0, y, 1}, {1, y, 0}});
    meshes[0].triangles.push_back({first, first + 1, first + 2});
  }
  const Scene scene = scene_of(meshes);
  const Bsp chain(scene, {.choice = Choice::first}), even(scene), faces(scene, {.free_cuts = false});
  EXPECT_EQ(chain.depth(), static_cast<std::size_t>(count));
  EXPECT_LT(even.depth(), 32u);
  EXPECT_LT(faces.depth(), 64u);
  for (const Bsp* bsp : {&chain, &even, &faces}) {
    EXPECT_EQ(bsp->split_count(), 0u);
    std::vector<std::uint32_t> seen;
    bsp->back_to_front({0, -1, 0, 1}, [&](std::span<const BspPolygon> set) { seen.push_back(set[0].triangle); });
    std::vector<std::uint32_t> expected(count);
    std::iota(expected.rbegin(), expected.rend(), 0u);
    EXPECT_EQ(seen, expected);
  }
}

// A convex mesh is a chain by its own planes: n levels. Free cuts make it logarithmic, for cuts of fewer than all triangles.
TEST(Bsp, free_cuts_keep_smooth_meshes_shallow) {
  const Scene scene = scene_of({tessellate(Sphere{{0, 0, 0}, 1}, 40, "sphere")});
  const std::size_t count = scene.triangle_count();
  ASSERT_GT(count, 1000u);
  const Bsp chain(scene, {.free_cuts = false}), even(scene);
  EXPECT_GT(chain.depth(), count / 4);
  EXPECT_LT(even.depth(), 64u);
  EXPECT_LT(even.split_count(), count);
}

TEST(Bsp, threads_change_nothing) {
  std::mt19937 engine(12);
  const Scene scene =
      scene_of({square(3, 0), small_world::random_soup(engine, 30'000, 2, 0.1f, 2, 0.03f), hard_scenes::cycle(2, 1)});
  for (const BspOptions& options : {BspOptions{}, BspOptions{.free_cuts = false}}) {
    const Bsp many(scene, options);
    const tbb::global_control control(tbb::global_control::max_allowed_parallelism, 1);
    const Bsp one(scene, options);
    EXPECT_EQ(one.node_count(), many.node_count());
    EXPECT_EQ(one.depth(), many.depth());
    ASSERT_EQ(one.polygons().size(), many.polygons().size());
    for (std::size_t i = 0; i < one.polygons().size(); ++i) {
      const BspPolygon &p = one.polygons()[i], &q = many.polygons()[i];
      ASSERT_EQ(p.triangle, q.triangle);
      ASSERT_EQ(p.first, q.first);
      const auto a = one.corners(p), b = many.corners(q);
      ASSERT_EQ(a.size(), b.size());
      for (std::size_t k = 0; k < a.size(); ++k) ASSERT_TRUE(a[k].at == b[k].at && a[k].edge == b[k].edge);
    }
    const glm::dvec4 from(1, 2, 3, 1);
    EXPECT_EQ(order(one, from), order(many, from));
    EXPECT_LT(one.depth(), 64u);
  }
}

// A floor at each of the heights 1, 0, 2, 3 and 4, of 2 x 64 x 64 triangles, and a triangle that reaches from 0.5 to 1.5. By
// the choice `first` each floor is one set: 1 divides the rest, 0 is below it and 2, 3 and 4 are a chain above. Every floor's
// list is large, 8192 or more, and so a task of its own. The part of the triangle below 1 is above 0, the other one below 2.
TEST(Bsp, tasks_make_one_tree) {
  Scene scene;
  for (const float height : {1.0f, 0.0f, 2.0f, 3.0f, 4.0f}) {
    std::vector<glm::vec3> positions;
    std::vector<glm::uvec3> triangles;
    for (std::uint32_t x = 0; x <= 64; ++x)
      for (std::uint32_t z = 0; z <= 64; ++z) {
        positions.push_back({x, height, z});
        const std::uint32_t k = 65 * x + z;
        if (x > 0 && z > 0) triangles.insert(triangles.end(), {{k, k - 1, k - 65}, {k - 66, k - 65, k - 1}});
      }
    scene.meshes.push_back(mesh_of(positions, triangles));
  }
  scene.meshes.push_back(mesh_of({{9, 0.5f, 9}, {9, 0.5f, 8}, {9, 1.5f, 8}}, {{0, 1, 2}}));
  const Bsp bsp(scene, {.choice = Choice::first});
  EXPECT_EQ(bsp.node_count(), 7u);
  EXPECT_EQ(bsp.depth(), 4u);
  EXPECT_EQ(bsp.split_count(), 1u);
  std::vector<std::pair<std::uint32_t, std::size_t>> sets;  // first triangle, size
  for (const auto& set : order(bsp, {9, 9, 9, 1})) sets.emplace_back(set[0], set.size());
  EXPECT_EQ(sets,
            (decltype(sets){{32768, 8192}, {24576, 8192}, {16384, 8192}, {40960, 1}, {0, 8192}, {40960, 1}, {8192, 8192}}));
}

// Faces around an axis, no other one beyond the plane of any, and a wall through the middle of the first and between two
// opposite ones. Of 21 faces a face's plane cuts none and has 21 on one side, the wall's cuts one and has 10 + 10: `balanced`
// takes the wall, 8 against 21, and two chains of 11 parts; `fewest_splits` the first face, and then the wall, which cuts none
// any more: two chains of 10. Of 7 faces `balanced` takes the first one, too, 7 against 8, and then the wall and chains of 3.
// Of 24 faces a wall at z = 1/2 cuts the third and the eleventh and has 7 and 15 beside it: 16 + 8, no less than the 24 of the
// first face, then 23 and 23, 22 and 22; when the third is gone 8 + 6 are less than 21. Chains of 8 and 14 are left.
TEST(Bsp, choices_on_paper) {
  const auto ring = [](int faces, double wall = 0) {
    std::vector<glm::vec3> positions;
    std::vector<glm::uvec3> triangles;
    const auto add = [&](const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c) {
      const auto first = static_cast<std::uint32_t>(positions.size());
      positions.insert(positions.end(), {glm::vec3(a), glm::vec3(b), glm::vec3(c)});
      triangles.push_back({first, first + 1, first + 2});
    };
    for (int k = 0; k < faces; ++k) {
      const double angle = 6.283185307179586 * k / faces;
      const glm::dvec3 middle(std::cos(angle), 0, std::sin(angle)), along(-middle.z, 0, middle.x);
      add(middle - 0.05 * along, middle + 0.05 * along, middle + glm::dvec3(0, 1, 0));
    }
    add({-0.3, 0, wall}, {0.3, 0, wall}, {0, 0.5, wall});
    return scene_of({mesh_of(positions, triangles)});
  };
  const auto expect = [](const Bsp& bsp, std::size_t splits, std::size_t nodes, std::size_t depth) {
    EXPECT_EQ(bsp.split_count(), splits);
    EXPECT_EQ(bsp.node_count(), nodes);
    EXPECT_EQ(bsp.depth(), depth);
  };
  expect(Bsp(ring(21), {.free_cuts = false, .candidates = 99}), 1, 23, 12);
  expect(Bsp(ring(21), {.choice = Choice::fewest_splits, .free_cuts = false, .candidates = 99}), 0, 22, 12);
  expect(Bsp(ring(7), {.free_cuts = false, .candidates = 99}), 0, 8, 5);
  expect(Bsp(ring(24, 0.5), {.free_cuts = false, .candidates = 99}), 1, 26, 18);
}

// Of a sliver edges and normal are as good as those of other triangles: within 1e-11 of the product in quadruple precision,
// where double would lose all of the 2^-20 by which edges differ in direction, but 2^-33.
TEST(Bsp, slivers_have_exact_normals) {
  using Quad = __float128;
  Random random(13);
  for (int round = 0; round < 1000; ++round) {
    const glm::dvec3 along = random.uniform(glm::dvec3(1), glm::dvec3(2));
    const glm::vec3 a(0x1p-20 * random.uniform(glm::dvec3(-1), glm::dvec3(1))), b(along),
        c(3.0 * along + 0x1p-20 * random.uniform(glm::dvec3(-1), glm::dvec3(1)));
    const glm::dvec3 u = glm::dvec3(b) - glm::dvec3(a), v = glm::dvec3(c) - glm::dvec3(a),
                     n = glm::normalize(bsp::normal_of({{a, b, c}}));
    Quad wanted[3], square = 0;
    for (int i = 0; i < 3; ++i) {
      const int j = (i + 1) % 3, k = (i + 2) % 3;
      wanted[i] = Quad(u[j]) * v[k] - Quad(u[k]) * v[j], square += wanted[i] * wanted[i];
    }
    const double length = std::sqrt(static_cast<double>(square));
    ASSERT_GT(length, 0);
    for (int i = 0; i < 3; ++i) EXPECT_NEAR(n[i], static_cast<double>(wanted[i]) / length, 1e-11) << round;
  }
}

// Of a leaning sheet one corner is in the plane of the floor and the others 2^-44 m above or below it: it lies on that side,
// and not in the floor's set.
TEST(Bsp, sheets_that_touch_a_plane_lie_on_their_side) {
  constexpr float tiny = 0x1p-44f;
  const Scene scene = scene_of({square(4, 0), mesh_of({{-1, 0, -1}, {0, tiny, 2}, {2, tiny, -1}}, {{0, 1, 2}}),
                                mesh_of({{-1, 0, -1}, {0, -tiny, 2}, {2, -tiny, -1}}, {{0, 1, 2}})});
  EXPECT_EQ(order(Bsp(scene, {.choice = Choice::first}), {0, 1, 0, 1}),
            (std::vector<std::vector<std::uint32_t>>{{2}, {0, 1}, {3}}));
}

// A wall cuts two triangles of one plane that overlap; on either side their parts are one set again.
TEST(Bsp, parts_in_one_plane_are_one_set) {
  const Scene scene = scene_of({mesh_of({{0, -1, -9}, {0, 1, 0}, {0, -1, 9}}, {{0, 1, 2}}),
                                mesh_of({{-2, 0, 0}, {3, 0, 1}, {2, 0, 3}, {-3, 0, 0}}, {{0, 1, 2}, {3, 1, 2}})});
  const Bsp bsp(scene, {.choice = Choice::first});
  EXPECT_EQ(bsp.split_count(), 2u);
  EXPECT_EQ(order(bsp, {5, 1, 0, 1}), (std::vector<std::vector<std::uint32_t>>{{1, 2}, {0}, {1, 2}}));
}

// The largest coordinate may be a negative one.
TEST(Bsp, epsilon_goes_with_the_largest_coordinate) {
  const Scene scene = scene_of({mesh_of({{-16, 0, 1}, {2, 3, 1}, {1, 4, -5}}, {{0, 1, 2}})});
  EXPECT_DOUBLE_EQ(Bsp(scene).epsilon(), 1.6e-9);
}

TEST(Bsp, scale_changes_nothing) {
  // Powers of two round nothing, and epsilon goes with the extent.
  Random random(5);
  const Scene scene = scene_of({hard_scenes::grid_soup(random, 60), hard_scenes::boxes(random, 6, false)});
  const Bsp bsp(scene);
  for (const int exponent : {-90, -20, 20, 90}) {
    Scene scaled = scene;
    for (Mesh& mesh : scaled.meshes)
      for (glm::vec3& p : mesh.positions) p *= std::ldexp(1.0f, exponent);
    const Bsp other(scaled);
    EXPECT_EQ(other.node_count(), bsp.node_count());
    EXPECT_EQ(other.split_count(), bsp.split_count());
    const glm::dvec3 from = glm::dvec3(1, 2, 3) * std::ldexp(1.0, exponent);
    EXPECT_EQ(order(other, glm::dvec4(from, 1)), order(bsp, {1, 2, 3, 1}));
  }
}

TEST(Bsp, nothing_and_triangles_without_area_make_no_nodes) {
  const auto never = [](std::span<const BspPolygon>) { FAIL(); };
  Mesh flat;
  flat.positions = {{0, 0, 0}, {1, 1, 1}, {2, 2, 2}, {1, 0, 0}};
  flat.triangles = {{0, 1, 2}, {0, 1, 1}};
  for (const Scene& scene : {Scene{}, scene_of({Mesh{}}), scene_of({flat})}) {
    const Bsp bsp(scene);
    EXPECT_EQ(bsp.node_count(), 0u);
    EXPECT_EQ(bsp.depth(), 0u);
    bsp.front_to_back({0, 0, 0, 1}, never);
  }
  flat.triangles.push_back({0, 1, 3});
  const Bsp bsp(scene_of({flat}));
  ASSERT_EQ(bsp.polygons().size(), 1u);
  EXPECT_EQ(bsp.polygons()[0].triangle, 2u);
}

TEST(Bsp, options_without_candidates_are_refused) {
  EXPECT_THROW(Bsp(Scene{}, {.candidates = 0}), Error);
  EXPECT_THROW(Bsp(Scene{}, {.sample = 0}), Error);
}

}  // namespace
}  // namespace gnomon
