// The parts of a triangle map: the test of a segment with a triangle, and the lists of texels.
#include <gnomon/kit/random.h>

#include <set>

#include "drawing_test.h"
#include "map_scenes.h"
#include "techniques/triangle_map/lists.h"
#include "techniques/triangle_map/segment.h"

namespace triangle_map_parts_test {
using namespace gnomon;
using namespace gnomon::triangle_map;

// --- The test --------------------------------------------------------------------------------------------------------------

// The way (1, 2, 4) is longest along z: corners are sheared by (1/4, 1/2) of their z, to (-1.5, -2), (2.5, -2) and (-0.5, 4).
// The edge functions are -0.5 * -2 - 4 * 2.5 = -9, -1.5 * 4 - -2 * -0.5 = -7 and 2.5 * -2 - -2 * -1.5 = -8. The plane is z = 2,
// half way.
TEST(triangle_map_segment, computes_edge_functions_and_height) {
  const Shear along = shear_along({1, 2, 4}, true);
  EXPECT_EQ(along.axis, 2);
  EXPECT_EQ(along.shear, glm::vec3(0.25f, 0.5f, 0.25f));
  const Meeting m = meeting({{{-1, -1, 2}, {3, -1, 2}, {0, 5, 2}}}, along);
  EXPECT_EQ(glm::vec3(m.u, m.v, m.w), glm::vec3(-9, -7, -8));
  EXPECT_EQ(m.height / m.sum(), 0.5f);
  EXPECT_TRUE(is_met(m, true));
}

// The way (1, 1, 4) meets z = 2 at (0.5, 0.5, 2), on the diagonal that both halves of a square have.
TEST(triangle_map_segment, meets_both_triangles_at_their_common_edge) {
  const Shear along = shear_along({1, 1, 4}, true);
  const Meeting below = meeting({{{0, 0, 2}, {2, 2, 2}, {2, 0, 2}}}, along);
  const Meeting above = meeting({{{0, 0, 2}, {0, 2, 2}, {2, 2, 2}}}, along);
  EXPECT_EQ(glm::vec3(below.u, below.v, below.w), glm::vec3(3, 1, 0));
  EXPECT_EQ(glm::vec3(above.u, above.v, above.w), glm::vec3(3, 0, 1));
  EXPECT_TRUE(is_met(below, true));
  EXPECT_TRUE(is_met(above, true));
}

// The same triangle in all three turns of the axes, against the way, and before and behind what the segment spans.
TEST(triangle_map_segment, meets_only_what_lies_on_it) {
  for (int turn = 0; turn < 3; ++turn) {
    const auto at = [&](const glm::vec3& p) { return glm::vec3(p[turn], p[(turn + 1) % 3], p[(turn + 2) % 3]); };
    const auto met = [&](float z, const glm::vec3& way, bool has_end) {
      const std::array<glm::vec3, 3> corners{at({-1, -1, z}), at({3, -1, z}), at({0, 5, z})};
      return is_met(meeting(corners, shear_along(at(way), has_end)), has_end);
    };
    EXPECT_TRUE(met(2, {1, 2, 4}, true)) << turn;
    EXPECT_TRUE(met(-2, {-1, 2, -4}, true)) << turn;
    EXPECT_FALSE(met(2, {-1, 2, -4}, true)) << turn << ", behind the start";
    EXPECT_FALSE(met(2, {-1, 2, -4}, false)) << turn << ", behind the start";
    EXPECT_TRUE(met(4, {0, 1, 4}, true)) << turn << ", at the end";
    EXPECT_FALSE(met(4.5f, {0, 1, 4}, true)) << turn << ", beyond the end";
    EXPECT_TRUE(met(4.5f, {0, 1, 4}, false)) << turn << ", on a segment without an end";
    EXPECT_FALSE(met(2, {-4, 1, 4}, true)) << turn << ", beside the triangle";
  }
  // Without area, and edge-on.
  EXPECT_FALSE(is_met(meeting({{{1, 1, 2}, {1, 1, 2}, {1, 1, 2}}}, shear_along({1, 1, 4}, true)), true));
  EXPECT_FALSE(is_met(meeting({{{0, -1, 1}, {0, 1, 2}, {0, -1, 3}}}, shear_along({0, 0, 4}, true)), true));
}

/// Triangles of a sphere around a point: an octahedron's, divided. The middle of an edge is the same from both of its sides.
void divide(const std::array<glm::vec3, 3>& face, int levels, std::vector<std::array<glm::vec3, 3>>& triangles) {
  if (levels == 0) {
    triangles.push_back(face);
    return;
  }
  glm::vec3 middle[3];
  for (int k = 0; k < 3; ++k) middle[k] = glm::normalize(face[k] + face[(k + 1) % 3]);
  divide({face[0], middle[0], middle[2]}, levels - 1, triangles);
  divide({middle[0], face[1], middle[1]}, levels - 1, triangles);
  divide({middle[2], middle[1], face[2]}, levels - 1, triangles);
  divide({middle[0], middle[1], middle[2]}, levels - 1, triangles);
}

// From inside a closed surface no segment gets out, not even one that is aimed at a vertex or along an edge.
TEST(triangle_map_segment, no_segment_leaves_a_closed_sphere) {
  std::vector<std::array<glm::vec3, 3>> triangles;
  for (int octant = 0; octant < 8; ++octant)
    divide({glm::vec3(octant & 1 ? 1 : -1, 0, 0), glm::vec3(0, octant & 2 ? 1 : -1, 0), glm::vec3(0, 0, octant & 4 ? 1 : -1)},
           3, triangles);
  const glm::vec3 center(3.1f, -2.7f, 5.3f);
  for (auto& triangle : triangles)
    for (glm::vec3& p : triangle) p += center;
  Random random(4);
  int leaks = 0;
  for (int round = 0; round < 6000; ++round) {
    const auto& aimed = triangles[round % triangles.size()];
    const glm::vec3 start = center + glm::vec3(0.5 * small_world::direction_of(random));
    const float share = round % 2 ? 0 : static_cast<float>(random.uniform(0.0, 1.0));
    const glm::vec3 target = glm::mix(aimed[round % 3], aimed[(round + 1) % 3], share), way = 2.0f * (target - start);
    const Shear along = shear_along(way, true);
    bool is_stopped = false;
    for (const auto& t : triangles)
      is_stopped = is_stopped || is_met(meeting({t[0] - start, t[1] - start, t[2] - start}, along), true);
    leaks += !is_stopped;
  }
  EXPECT_EQ(leaks, 0);
}

// --- The lists -------------------------------------------------------------------------------------------------------------

class TriangleMapLists : public DrawingTest {
 protected:
  static constexpr int resolution = 64, length = 32;

  struct Drawn {
    LightCamera camera;
    std::vector<std::uint32_t> counts, entries;
    ListTotals totals;

    std::uint32_t count(const LightImage& image, const glm::ivec2& texel) const { return counts[place(image.layer, texel)]; }
    /// Of a list that is whole.
    std::vector<std::uint32_t> list(const LightImage& image, const glm::ivec2& texel) const {
      std::vector<std::uint32_t> numbers;
      for (std::uint32_t k = 0; k < count(image, texel); ++k)
        numbers.push_back(entries[place(image.layer * length + static_cast<int>(k), texel)]);
      return numbers;
    }
    static std::size_t place(int layer, const glm::ivec2& texel) {
      return (std::size_t(layer) * resolution + texel.y) * resolution + texel.x;
    }
  };
  static Drawn drawn(const Scene& scene, const Light& light) {
    const StateGuard guard;
    ListPrograms programs;
    programs.setup(length);
    TriangleLists lists;
    Drawn all{fit_to_scene(light, mesh_boxes(scene), resolution, 1), {}, {}, {}};
    lists.draw(all.camera, scene_buffers(scene), programs);
    const std::size_t texels = std::size_t{resolution} * resolution * std::max(all.camera.layer_count, 1);
    EXPECT_EQ(lists.bytes(), 4 * (length + 1) * texels);
    all.counts = lists.counts();
    all.entries = lists.entries();
    all.totals = lists.totals();
    return all;
  }
  static void for_texels(const LightCamera& camera, const auto& visit) {
    for (const LightImage& image : camera.images)
      for (int y = 0; image.layer >= 0 && y < resolution; ++y)
        for (int x = 0; x < resolution; ++x) visit(image, glm::ivec2(x, y));
  }
  static void for_triangles(const Scene& scene, const auto& visit) {
    std::uint32_t number = 0;
    for (const Mesh& mesh : scene.meshes)
      for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t, ++number)
        if (mesh.casts) visit(mesh.corners(t), number);
  }
};

/// Whether a triangle of texel coordinates touches a square: no line along a side of either parts them.
bool touches(const glm::dvec2 (&p)[3], const glm::dvec2& low, const glm::dvec2& high) {
  const auto parts = [&](const glm::dvec2& across) {
    double least = INFINITY, most = -INFINITY;
    for (const glm::dvec2& corner : p) {
      least = std::min(least, glm::dot(corner, across));
      most = std::max(most, glm::dot(corner, across));
    }
    const glm::dvec2 middle = (low + high) / 2.0, half = (high - low) / 2.0;
    const double at = glm::dot(middle, across), reach = glm::dot(half, glm::abs(across));
    return most < at - reach || least > at + reach;
  };
  if (parts({1, 0}) || parts({0, 1})) return false;
  for (int k = 0; k < 3; ++k)
    if (const glm::dvec2 side = p[(k + 1) % 3] - p[k]; parts({-side.y, side.x})) return false;
  return true;
}

// Of each texel and each triangle whose corners are before the light: it is in the list where it reaches into the texel by a
// twentieth, and is not where it stays off by as much. Slack is below a fiftieth of a texel here.
TEST_F(TriangleMapLists, hold_what_touches_a_texel_and_nothing_else) {
  const Scene scene = map_scenes::soup_over_ground(3);
  for (const Light& light : map_scenes::all_kinds) {
    const Drawn lists = drawn(scene, light);
    int missing = 0, listed = 0, too_much = 0;
    for_texels(lists.camera, [&](const LightImage& image, const glm::ivec2& texel) {
      if (lists.count(image, texel) > length) return;
      const std::vector<std::uint32_t> list = lists.list(image, texel);
      for_triangles(scene, [&](const Triangle& triangle, std::uint32_t number) {
        glm::dvec2 places[3];
        for (int k = 0; k < 3; ++k) {
          const glm::dvec3 q = image.seen(triangle.points[k]);
          if (image.is_perspective && q.z < 0.05) return;
          places[k] = image.texel_of(image.place(q));
        }
        const bool is_listed = std::ranges::binary_search(list, number);
        const glm::dvec2 low(texel), high = low + 1.0;
        listed += is_listed;
        missing += !is_listed && touches(places, low + 0.05, high - 0.05);
        too_much += is_listed && !touches(places, low - 0.05, high + 0.05);
      });
    });
    EXPECT_EQ(missing, 0) << light.name;
    EXPECT_EQ(too_much, 0) << light.name;
    EXPECT_GT(listed, 100) << light.name;
  }
}

// Also of triangles that reach behind the light, as the ground does in the images that look aside: whatever the ray through a
// texel's center meets is in its list.
TEST_F(TriangleMapLists, lack_nothing_that_the_ray_of_a_texel_meets) {
  const Scene scene = map_scenes::soup_over_ground(4);
  for (const Light& light : map_scenes::all_kinds) {
    const Drawn lists = drawn(scene, light);
    int met = 0, missing = 0;
    for_texels(lists.camera, [&](const LightImage& image, const glm::ivec2& texel) {
      if (lists.count(image, texel) > length) return;
      const std::vector<std::uint32_t> list = lists.list(image, texel);
      const Tap ray = image.tap(glm::dvec2(texel) + 0.5, 0, 1);
      for_triangles(scene, [&](const Triangle& t, std::uint32_t number) {
        const glm::dvec3 from = image.is_perspective ? ray.origin : ray.origin - 100.0 * ray.direction;
        const double at = small_world::intersect(from, ray.direction, t.points[0], t.points[1], t.points[2]);
        if (!(at > 0 && at < INFINITY)) return;
        ++met;
        missing += !std::ranges::binary_search(list, number);
      });
    });
    EXPECT_EQ(missing, 0) << light.name;
    EXPECT_GT(met, 100) << light.name;
  }
}

TEST_F(TriangleMapLists, are_sorted_counted_and_the_same_each_time) {
  const Scene scene = map_scenes::soup_over_ground(5);
  for (const Light& light : map_scenes::all_kinds) {
    const Drawn first = drawn(scene, light), second = drawn(scene, light);
    EXPECT_EQ(first.counts, second.counts) << light.name;
    std::uint32_t entries = 0, full = 0, longest = 0;
    for_texels(first.camera, [&](const LightImage& image, const glm::ivec2& texel) {
      const std::uint32_t count = first.count(image, texel);
      longest = std::max(longest, count);
      full += count > length;
      if (count > length) return;
      entries += count;
      const std::vector<std::uint32_t> list = first.list(image, texel);
      EXPECT_TRUE(std::ranges::is_sorted(list)) << light.name;
      EXPECT_EQ(std::set(list.begin(), list.end()).size(), list.size()) << light.name;
      EXPECT_EQ(list, second.list(image, texel)) << light.name;
    });
    EXPECT_EQ(first.totals.entries, entries) << light.name;
    EXPECT_EQ(first.totals.full_texels, full) << light.name;
    EXPECT_EQ(first.totals.longest, longest) << light.name;
  }
}

// Forty squares below each other under a sun from above: 80 triangles along each diagonal, 40 beside it, more than 32.
TEST_F(TriangleMapLists, that_are_too_short_say_how_many_there_are) {
  Scene scene;
  for (int k = 0; k < 40; ++k) scene.meshes.push_back(small_world::ground(1, 0.1f * static_cast<float>(k)));
  const Drawn lists = drawn(scene, {.name = "sun", .kind = DirectionalLight{{0, -1, 0}}});
  EXPECT_EQ(lists.totals.longest, 80u);
  EXPECT_EQ(lists.totals.entries, 0u);
  EXPECT_GT(lists.totals.full_texels, 3000u);
  EXPECT_LE(lists.totals.full_texels, 4096u);
}

}  // namespace triangle_map_parts_test
