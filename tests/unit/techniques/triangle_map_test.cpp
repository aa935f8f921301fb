#include <gnomon/kit/geometry/shapes.h>

#include <numeric>

#include "drawing_test.h"
#include "map_scenes.h"
#include "masked.h"
#include "walking_world.h"

extern "C" void gnomon_technique_shadow_map(gnomon::Registry&);
extern "C" void gnomon_technique_triangle_map(gnomon::Registry&);

namespace triangle_map_test {
using namespace gnomon;
using small_world::value;

class TriangleMap : public DrawingTest {
 protected:
  static small_world::Run run(const std::string& settings, const Scene& scene, const Light& light, const GBuffer& g) {
    return small_world::run(gnomon_technique_triangle_map, settings, scene, light, g);
  }
  static small_world::Run shadow_map(const std::string& settings, const Scene& scene, const Light& light, const GBuffer& g) {
    return small_world::run(gnomon_technique_shadow_map, settings, scene, light, g);
  }
  /// Of each pixel that is away from shadow edges, whether the mask is wrong; 1 where it is.
  static std::vector<int> wrong(const Scene& scene, const Light& light, const GBuffer& g, const std::vector<float>& mask) {
    std::vector<int> is_wrong(g.size(), 0);
    for (std::size_t i = 0; i < g.size(); ++i) {
      if (!faces_light(scene, g, light, i)) continue;
      const bool is_dark = small_world::caster_distance(scene, light, g.position(i)) < INFINITY;
      if ((mask[i] < 0.5f) == is_dark) continue;
      is_wrong[i] = !map_scenes::near_shadow_edge(scene, light, g.position(i), g.normal(i), 1e-4, is_dark);
    }
    return is_wrong;
  }
  static int sum(const std::vector<int>& numbers) { return std::accumulate(numbers.begin(), numbers.end(), 0); }
};

const View view{.eye = {3, 5, 6}, .target = {0, 0.3f, 0}};
const Light sun{.name = "sun", .kind = DirectionalLight{{0.1f, -1, -0.6f}}};
const Light point{.name = "point", .kind = PointLight{{0.2f, 3, 2}}};

/// 24 upright bars, 0.1 m wide and 0.1 m apart, of two triangles each, over a ground that casts nothing.
Scene bars() {
  Scene scene;
  scene.meshes = {small_world::ground(4, 0, false)};
  std::vector<glm::vec3> positions;
  std::vector<glm::uvec3> triangles;
  for (std::uint32_t k = 0; k < 24; ++k) {
    const float left = -2.4f + 0.2f * static_cast<float>(k), right = left + 0.1f;
    for (const glm::vec2& p : {glm::vec2(left, 0.2f), glm::vec2(right, 0.2f), glm::vec2(right, 1.2f), glm::vec2(left, 1.2f)})
      positions.emplace_back(p.x, p.y, 0);
    triangles.push_back({4 * k, 4 * k + 1, 4 * k + 2});
    triangles.push_back({4 * k, 4 * k + 2, 4 * k + 3});
  }
  scene.meshes.push_back(small_world::make_mesh(positions, triangles));
  return scene;
}

TEST_F(TriangleMap, without_lists_is_the_shadow_map_bit_for_bit) {
  const Scene scene = map_scenes::soup_over_ground(7);
  const GBuffer g = small_world::make_gbuffer(scene, view, 96, 72);
  for (const Light& light : map_scenes::all_kinds)
    for (const std::string fit : {"scene", "view"})
      for (const std::string settings : {"bias=constant", "bias=slope,filter=pcf", "bias=normal_offset,filter=bilinear",
                                         "bias=receiver_plane,filter=disc,filter_radius=2", "depth_bias=3,slope_bias=0"}) {
        const std::string all = "resolution=128,fit=" + fit + "," + settings;
        EXPECT_EQ(run("list_length=0," + all, scene, light, g).mask, shadow_map(all, scene, light, g).mask)
            << light.name << ' ' << all;
      }
}

// A bar is some five texels wide and as far from the next one: a texel touches one of them, two triangles at most.
TEST_F(TriangleMap, two_triangles_a_texel_are_enough_for_bars_that_are_wider_than_texels) {
  const Scene scene = bars();
  const GBuffer g = small_world::make_gbuffer(scene, view, 128, 96);
  const auto map = run("resolution=256,list_length=2", scene, sun, g);
  EXPECT_EQ(value(map.technique->counts(), "full_texels"), 0);
  EXPECT_EQ(value(map.technique->counts(), "longest_list"), 2);
  EXPECT_EQ(sum(wrong(scene, sun, g, map.mask)), 0);
  EXPECT_GT(sum(wrong(scene, sun, g, shadow_map("resolution=256", scene, sun, g).mask)), 5);
}

TEST_F(TriangleMap, whole_lists_are_exact_under_every_light) {
  const Scene scene = map_scenes::soup_over_ground(11);
  const GBuffer g = small_world::make_gbuffer(scene, view, 96, 72);
  for (const Light& light : map_scenes::all_kinds)
    for (const std::string settings : {"", ",fit=view", ",bias=normal_offset,filter=pcf"}) {
      const auto map = run("resolution=128,list_length=32" + settings, scene, light, g);
      EXPECT_EQ(value(map.technique->counts(), "full_texels"), 0) << light.name << settings;
      EXPECT_EQ(sum(wrong(scene, light, g, map.mask)), 0) << light.name << settings;
    }
}

// The sphere's triangles are some three texels long, two or more before each other, and 64 of them meet at a pole: most lists
// of three overflow. A list that is not whole answers as the shadow map does, and one that is whole answers right. So no pixel
// is wrong that is right there.
TEST_F(TriangleMap, lists_that_overflow_are_no_worse_than_depth) {
  Scene scene;
  scene.meshes = {small_world::ground(3, 0, false), tessellate(Sphere{{0, 1, 0}, 0.6f}, 64, "ball")};
  const GBuffer g = small_world::make_gbuffer(scene, view, 64, 48);
  for (const Light& light : {sun, point}) {
    const auto map = run("resolution=64,list_length=3", scene, light, g);
    const auto depth = shadow_map("resolution=64", scene, light, g);
    EXPECT_GT(value(map.technique->counts(), "full_texels"), 50) << light.name;
    EXPECT_GT(value(map.technique->counts(), "longest_list"), 8) << light.name;
    const std::vector<int> by_lists = wrong(scene, light, g, map.mask), by_depth = wrong(scene, light, g, depth.mask);
    for (std::size_t i = 0; i < g.size(); ++i)
      if (g.mesh[i] == 0) {
        EXPECT_LE(by_lists[i], by_depth[i]) << light.name << ", pixel " << i;
      }
  }
}

TEST_F(TriangleMap, explains_by_taps_and_its_own_cause_where_a_list_is_not_whole) {
  Scene scene;
  scene.meshes = {small_world::ground(3, 0, false), tessellate(Sphere{{0, 1, 0}, 0.6f}, 64, "ball")};
  const GBuffer g = small_world::make_gbuffer(scene, view, 64, 48);
  const auto map = run("resolution=64,list_length=3", scene, sun, g);
  const std::vector<float> layer = map.technique->draw_debug("list");
  ASSERT_EQ(layer.size(), 3 * g.size());
  int full = 0, whole = 0;
  for (std::size_t i = 0; i < g.size(); ++i) {
    if (!faces_light(scene, g, sun, i)) continue;
    const Explanation why = map.technique->explain(i).value();
    EXPECT_TRUE(why.cause.empty() || why.cause == "list_full");
    EXPECT_EQ(why.cause.empty(), why.taps.empty());
    full += !why.cause.empty();
    whole += why.cause.empty();
  }
  EXPECT_GT(full, 10);
  EXPECT_GT(whole, 10);
  // Without lists it explains as a shadow map.
  const auto without = run("resolution=64,list_length=0", scene, sun, g);
  for (std::size_t i = 0; i < g.size(); i += 7)
    if (faces_light(scene, g, sun, i)) {
      EXPECT_EQ(without.technique->explain(i)->cause, "");
    }
}

// The bars have holes: their texels are open whatever a list could hold, and depth decides by the mask's rule.
TEST_F(TriangleMap, casters_with_holes_are_left_to_depth) {
  Scene scene = bars();
  Mesh& mesh = scene.meshes[1];
  mesh.alpha_mask = masked::checker(4, 4);
  for (const glm::vec3& p : mesh.positions) mesh.uv.emplace_back(p.x, p.y);
  const GBuffer g = small_world::make_gbuffer(scene, view, 96, 72);
  for (const std::string alpha : {"texel", "mips"}) {
    const std::string settings = "resolution=128,alpha=" + alpha;
    const auto map = run(settings, scene, sun, g);
    EXPECT_EQ(value(map.technique->counts(), "entries"), 0) << alpha;
    EXPECT_EQ(map.mask, shadow_map(settings, scene, sun, g).mask) << alpha;
  }
}

TEST_F(TriangleMap, counts_what_lists_take) {
  const Scene scene = bars();
  const GBuffer g = small_world::make_gbuffer(scene, view, 32, 24);
  const auto bytes = [&](const std::string& length) {
    return value(run("resolution=128,list_length=" + length, scene, sun, g).technique->counts(), "bytes");
  };
  const double texels = 128.0 * 128, meshes = 4.0 * 3;
  EXPECT_EQ(bytes("8") - bytes("0"), 4 * 9 * texels + meshes);
  EXPECT_EQ(bytes("2") - bytes("0"), 4 * 3 * texels + meshes);
}

TEST_F(TriangleMap, lists_that_are_too_large_are_unsupported) {
  const auto supports = [](const std::string& settings, const Light& light) {
    Registry registry;
    gnomon_technique_triangle_map(registry);
    const auto technique = registry.techniques()[0].make();
    technique->apply(settings);
    return technique->supports(bars(), light, view);
  };
  EXPECT_TRUE(supports("", point));
  EXPECT_TRUE(supports("resolution=4096", sun));
  EXPECT_TRUE(supports("resolution=8192,list_length=0", sun));
  // 8192^2 texels times 8 entries of 4 bytes.
  const Support refused = supports("resolution=8192", sun);
  EXPECT_EQ(refused.kind(), Support::Kind::unsupported);
  EXPECT_EQ(refused.why(), "lists of 8 triangles for 1 x 8192 x 8192 texels take 2048 MiB; 1024 MiB are the most that fit");
  EXPECT_EQ(supports("resolution=8192,list_length=1", point).why(),
            "lists of 1 triangle for 6 x 8192 x 8192 texels take 1536 MiB; 1024 MiB are the most that fit");
}

TEST_F(TriangleMap, after_an_update_it_answers_as_after_a_build) {
  using namespace walking_world;
  for (const std::string settings : {"resolution=128", "resolution=128,fit=view,list_length=2"}) {
    Row row;
    const auto map = made("triangle_map", settings, row.scene);
    for (const int frame : {0, 3, 8, 3}) {
      row.go_to(frame);
      map->update(row.scene, row.posed.take_changes());
      const GBuffer g = row.picture();
      for (const Light& light : {row.point(), row.sun()}) {
        map->relight(light);
        const std::vector<float> mask = small_world::mask_of(*map, g);
        const auto fresh = made("triangle_map", settings, row.scene);
        fresh->relight(light);
        EXPECT_EQ(mask, small_world::mask_of(*fresh, g)) << settings << ", frame " << frame << ", " << light.name;
        EXPECT_EQ(value(map->counts(), "entries"), value(fresh->counts(), "entries"));
      }
    }
  }
}

}  // namespace triangle_map_test
