// The bound on overlapping shadow volumes, against the exact depth of many points.
#include <gnomon/kit/geometry/edges.h>
#include <gnomon/kit/geometry/shapes.h>
#include <gtest/gtest.h>

#include "small_world.h"
#include "volume_scenes.h"

namespace depth_bound_test {
using namespace gnomon;
using namespace volume_scenes;

struct Bounded {
  EdgeAdjacency adjacency;
  Silhouette silhouette;
  std::int64_t bound = 0;
  Bounded(const Scene& scene, const glm::dvec4& light) : adjacency(scene) {
    adjacency.find_silhouette(light, silhouette);
    bound = bound_depth(adjacency, silhouette, 255);
  }
  std::int64_t depth(const glm::vec3& point) const { return adjacency.depth_at(point, silhouette).volumes; }
};

const glm::dvec4 lamp(0.25, 20, 0.125, 1), sun(0x1p-6, 1, 0x1p-5, 0);

TEST(DepthBound, nothing_that_casts_is_bounded_by_zero) {
  for (const glm::dvec4& light : {lamp, sun}) {
    EXPECT_EQ(Bounded({}, light).bound, 0);
    EXPECT_EQ(Bounded(scene_of({small_world::ground(3, 0, false)}), light).bound, 0);
    EXPECT_EQ(Bounded(scene_of({mesh_of({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}})}), {2, 1, 0, light.w}).bound, 0);
  }
}

// One convex outline: a line of sight crosses it twice, or meets one of its corners.
TEST(DepthBound, one_convex_caster_is_bounded_by_one_or_two) {
  Random random(1);
  for (const Mesh& mesh : {mesh_of({{-1, 0, -1}, {0, 0, 1}, {1, 0, -1}}, {{0, 1, 2}}), small_world::box({-1, 0, -1}, {1, 1, 1}),
                           tetrahedron({-1, 0, -1}, {1, 0, -1}, {0, 0, 1}, {0, 1, 0})})
    for (int round = 0; round < 20; ++round)
      for (const glm::dvec4& light : {glm::dvec4(random_point(random, {-9, 5, -9}, {9, 9, 9}), 1),
                                      glm::dvec4(random_point(random, {-1, 0.5f, -1}, {1, 1, 1}), 0)}) {
        const Bounded one(scene_of({mesh}), light);
        EXPECT_GE(one.bound, 1);
        EXPECT_LE(one.bound, 2);
      }
}

// Triangles over each other, smaller and smaller to the light: a point under all of them lies in n volumes. Of their 3 n edges
// a line meets 2 n, and all where it passes all their common corners; one more n of them is met twice under the lamp, where the
// unrolled image has a corner that cuts edges in two. Half of that is the quick bound: between n and 2 n.
TEST(DepthBound, stacked_triangles_are_bounded_by_little_more_than_their_number) {
  for (const int n : {2, 10, 100, 255, 256, 300})
    for (const glm::dvec4& light : {lamp, sun}) {
      std::vector<Mesh> stack;
      for (int i = 0; i < n; ++i) {
        const float y = 4.0f * static_cast<float>(i + 1) / static_cast<float>(n), size = 2 - 0.2f * y;
        stack.push_back(mesh_of({{-size, y, -size}, {0, y, size}, {size, y, -size}}, {{0, 1, 2}}));
      }
      const Bounded nested(scene_of(stack), light);
      EXPECT_EQ(nested.depth({0, -0.25f, -0.25f}), n);
      EXPECT_GE(nested.bound, n);
      EXPECT_LE(nested.bound, 2 * n);
      const int fine = n <= 127 ? 2 * n : 3 * n / 2 + 2;
      EXPECT_LE(bound_depth(nested.adjacency, nested.silhouette, fine), fine);
    }
}

// A row of boxes whose shadows do not meet: every line of sight over the light's image meets few of them, wherever it runs.
TEST(DepthBound, casters_side_by_side_do_not_add_up) {
  std::vector<Mesh> row;
  for (int i = 0; i < 100; ++i) {
    const float x = 3.0f * static_cast<float>(i), z = 3.0f * static_cast<float>(i % 10);
    row.push_back(small_world::box({x, 0, z}, {x + 1, 1, z + 1}));
  }
  for (const glm::dvec4& light : {glm::dvec4(150, 400, 7, 1), glm::dvec4(0.125, 1, 0.0625, 0)}) {
    const Bounded separate(scene_of(row), light);
    EXPECT_GE(separate.bound, 1);
    EXPECT_LE(separate.bound, 50);
  }
}

// A file of boxes over each other in the light's image: a line of sight enters and leaves one after the other, and the quick
// bound counts them all. The finer one takes leaving back.
TEST(DepthBound, casters_in_a_file_do_not_add_up_in_the_finer_bound) {
  for (const glm::vec3& step : {glm::vec3(3, 0, 0), glm::vec3(0, 0, 3)})
    for (const glm::dvec4& light : {glm::dvec4(150, 4000, 150, 1), glm::dvec4(0.125, 1, 0.0625, 0)}) {
      std::vector<Mesh> file;
      for (int i = 0; i < 100; ++i)
        file.push_back(small_world::box(static_cast<float>(i) * step, static_cast<float>(i) * step + glm::vec3(1)));
      const Bounded separate(scene_of(file), light);
      EXPECT_GE(separate.bound, 1);
      EXPECT_LE(bound_depth(separate.adjacency, separate.silhouette, 4), 20);
    }
}

// Behind every caster, along the light's rays through it and its corners, and anywhere.
std::int64_t deepest(Random& random, const Bounded& world, const Scene& scene, const glm::dvec4& light, int count) {
  std::int64_t most = 0;
  for (int i = 0; i < count; ++i) {
    glm::vec3 point = random_point(random, glm::vec3(-4), glm::vec3(4));
    if (i % 3) {
      const Mesh& mesh = scene.meshes[random.below(static_cast<std::uint32_t>(scene.meshes.size()))];
      if (mesh.triangles.empty()) continue;
      const Triangle triangle = corners(mesh, random.below(static_cast<std::uint32_t>(mesh.triangles.size())));
      const double u = random.uniform(0, 1), v = random.uniform(0, 1 - u);
      const glm::dvec3 on = u * glm::dvec3(triangle.points[0]) + v * glm::dvec3(triangle.points[1]) +
                            (1 - u - v) * glm::dvec3(triangle.points[2]);
      point = glm::vec3(on - to_light(light, on) * random.uniform(0, light.w != 0 ? 2 : 20));
    }
    const EdgeAdjacency::Depth depth = world.adjacency.depth_at(point, world.silhouette);
    if (!depth.degenerate) most = std::max(most, depth.volumes);
  }
  return most;
}

TEST(DepthBound, no_point_lies_in_more_volumes_than_the_bound) {
  Random random(2);
  double slack = 0;
  int cases = 0, over_a_byte = 0;
  for (int round = 0; round < 100; ++round) {
    Scene scene = scene_of(random_casters(random, 1 + round % 12, glm::vec3(-2), glm::vec3(2)));
    if (round % 4 == 3)
      for (Mesh& mesh : scene.meshes) snap(mesh, 0.5f);
    // Many times the same, for the finer bound above what a byte counts.
    const bool many = round % 5 == 4;
    if (many) {
      const std::vector<Mesh> once = scene.meshes;
      while (scene.meshes.size() < 60 * once.size()) scene.meshes.insert(scene.meshes.end(), once.begin(), once.end());
    }
    // Outside of everything, among the casters, on a vertex, in the plane of a side of the bounds, and at infinity.
    const Mesh& mesh = scene.meshes[0];
    std::vector<glm::dvec4> lights{{random_point(random, glm::vec3(-9), glm::vec3(9)), 1},
                                   {random_point(random, glm::vec3(-1.5f), glm::vec3(1.5f)), 1},
                                   {random_point(random, glm::vec3(-1), glm::vec3(1)), 0},
                                   {0, -1, 0, 0},
                                   {0, 0, 0, 1}};
    if (!mesh.positions.empty()) {
      lights.emplace_back(mesh.positions[0], 1);
      lights.emplace_back(glm::vec3(scene.bounds().max.x, random_point(random, glm::vec3(-3), glm::vec3(3)).y, 0.25f), 1);
    }
    for (const glm::dvec4& light : lights) {
      const Bounded world(scene, light);
      const std::int64_t most = deepest(random, world, scene, light, many ? 60 : 250);
      ASSERT_GE(world.bound, most) << "round " << round << ", light " << light.x << ' ' << light.y << ' ' << light.z << ' '
                                   << light.w;
      over_a_byte += most > 255;
      if (most > 0) slack += double(world.bound) / double(most), ++cases;
    }
  }
  EXPECT_GT(over_a_byte, 20);
  EXPECT_LT(slack / cases, 6);
  RecordProperty("mean_ratio", std::to_string(slack / cases));
}

// A lamp among the pages of a stack and inside nested closed boxes: volumes on both sides of it.
TEST(DepthBound, light_inside_nested_boxes) {
  std::vector<Mesh> boxes;
  for (int i = 1; i <= 40; ++i)
    boxes.push_back(small_world::box(glm::vec3(-0.1f * float(i)), glm::vec3(0.1f * float(i) + 0.05f)));
  Random random(3);
  for (const glm::dvec4& light :
       {glm::dvec4(0, 0, 0, 1), glm::dvec4(0.01f, 0.02f, 0.03f, 1), glm::dvec4(2.0625, 0.5, 0.25, 1)}) {
    const Scene scene = scene_of(boxes);
    const Bounded nested(scene, light);
    const std::int64_t most = deepest(random, nested, scene, light, 500);
    EXPECT_GE(most, 20);
    EXPECT_GE(nested.bound, most);
  }
}

}  // namespace depth_bound_test
