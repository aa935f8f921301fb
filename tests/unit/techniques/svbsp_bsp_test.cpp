// The regular BSP tree on any scene: its order along rays, parts that make up their triangles, depth, threads, scale.
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <numeric>

#include "svbsp_bsp_rig.h"

namespace gnomon::svbsp_bsp_test {

using namespace bsp_rig;
using Choice = BspOptions::Choice;
using hand_made::mesh_of, hand_made::square;

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

}  // namespace gnomon::svbsp_bsp_test
