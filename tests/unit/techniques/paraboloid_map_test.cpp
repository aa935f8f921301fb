#include <gnomon/kit/geometry/shapes.h>
#include <gtest/gtest.h>

#include <array>

#include "device/context.h"
#include "measure/conformance/gl_state.h"
#include "small_world.h"

extern "C" void gnomon_technique_paraboloid_map(gnomon::Registry&);

namespace paraboloid_map_test {
using namespace gnomon;

class ParaboloidMap : public testing::Test {
 protected:
  ParaboloidMap() { process_context(); }
  void TearDown() override { EXPECT_EQ(state_differences(), std::vector<std::string>{}); }
  static small_world::Run run(const std::string& settings, const Scene& scene, const Light& light, const GBuffer& g) {
    return small_world::run(gnomon_technique_paraboloid_map, settings, scene, light, g);
  }
};

/// A square at height y with so many cells a side, each of two triangles.
Mesh cells(float half, float y, int count) {
  std::vector<glm::vec3> points;
  std::vector<glm::uvec3> triangles;
  for (int row = 0; row <= count; ++row)
    for (int column = 0; column <= count; ++column)
      points.push_back({half * (2.0f * column / count - 1), y, half * (2.0f * row / count - 1)});
  const auto at = [&](int row, int column) { return static_cast<unsigned>(row * (count + 1) + column); };
  for (int row = 0; row < count; ++row)
    for (int column = 0; column < count; ++column) {
      triangles.push_back({at(row, column), at(row + 1, column), at(row + 1, column + 1)});
      triangles.push_back({at(row, column), at(row + 1, column + 1), at(row, column + 1)});
    }
  return small_world::make_mesh(points, triangles);
}

const Light light{.name = "point", .kind = PointLight{{0.1f, 2, 0.2f}}};
const View view{.eye = {4, 6, 7}, .target = {0, 0.3f, 0}};

struct Wrong {
  int all = 0, curved = 0, shadowed = 0;
};
Wrong wrong_of(const small_world::Run& map, const Scene& scene, const GBuffer& g) {
  Wrong wrong;
  for (std::size_t i = 0; i < g.size(); ++i) {
    if (!faces_light(scene, g, light, i)) continue;
    const bool is_dark = small_world::caster_distance(scene, light, g.position(i)) < INFINITY;
    wrong.shadowed += is_dark;
    if (is_dark == (map.mask[i] < 0.5f)) continue;
    ++wrong.all;
    wrong.curved += map.technique->explain(i)->cause == "projection_curve";
  }
  return wrong;
}

// A sheet below the light that reaches 4 m to each side is seen under angles up to 76 degrees. Drawn as two triangles its edges
// and its inside bend; drawn as 64 x 64 cells no edge spans more than a degree or two, and what is left is what texels are
// wide.
TEST_F(ParaboloidMap, large_triangles_are_what_it_errs_by) {
  Wrong by_count[2];
  for (const int k : {0, 1}) {
    Scene scene;
    scene.meshes = {cells(8, 0, 64), cells(4, 1, k == 0 ? 1 : 64)};
    const GBuffer g = small_world::make_gbuffer(scene, view, 160, 120);
    by_count[k] = wrong_of(run("", scene, light, g), scene, g);
    EXPECT_GT(by_count[k].shadowed, 1000);
  }
  EXPECT_GT(by_count[0].all, 10 * std::max(by_count[1].all, 10));
  EXPECT_GT(by_count[0].curved, 0.9 * by_count[0].all);
  EXPECT_LT(by_count[1].all, 60);
}

// The texel that a point is looked up in is one that sees it: its ray passes within a texel's diagonal of the point.
TEST_F(ParaboloidMap, rays_of_texels_pass_their_points) {
  Scene scene;
  scene.meshes = {small_world::ground(5), small_world::box({-3, -2, -3}, {3, 5, 3})};
  scene.meshes[1].casts = false;
  const GBuffer g = small_world::make_gbuffer(scene, {.eye = {2, 1.5f, 2}, .target = {-1, 2.2f, -1}}, 120, 90);
  for (const std::string axis : {"x", "y", "z"}) {
    const auto map = run("resolution=256,axis=" + axis, scene, light, g);
    int seen = 0;
    for (std::size_t i = 0; i < g.size(); ++i) {
      if (!faces_light(scene, g, light, i)) continue;
      const auto why = map.technique->explain(i);
      ASSERT_EQ(why->taps.size(), 1u);
      const glm::dvec3 v = glm::dvec3(g.position(i)) - why->taps[0].origin;
      EXPECT_NEAR(glm::length(why->taps[0].direction), 1, 1e-6);
      EXPECT_LE(glm::length(glm::cross(why->taps[0].direction, v)), why->texel_width * std::sqrt(0.5) * 1.01)
          << axis << ' ' << i;
      ++seen;
    }
    EXPECT_GT(seen, 2000) << axis;
  }
}

// Two parts meet in the plane through the light across the axis, and in the room around it each sees about half of what faces
// the light. The image of a point's texel is that of its part.
TEST_F(ParaboloidMap, parts_are_the_half_spaces_of_the_axis) {
  Scene scene;
  scene.meshes = {small_world::ground(5), small_world::box({-3, -2, -3}, {3, 5, 3})};
  scene.meshes[1].casts = false;
  const GBuffer g = small_world::make_gbuffer(scene, {.eye = {2, 1.5f, 2}, .target = {-1, 2.2f, -1}}, 120, 90);
  const glm::dvec3 place(std::get<PointLight>(light.kind).position);
  for (const int axis : {0, 1, 2}) {
    const auto map = run(fmt::format("resolution=256,axis={}", "xyz"[axis]), scene, light, g);
    const std::vector<std::uint32_t> parts = map.technique->image_parts();
    ASSERT_EQ(parts.size(), g.size());
    std::array<int, 3> counted{};
    for (std::size_t i = 0; i < g.size(); ++i) {
      const bool is_behind = g.position(i)[axis] < place[axis];
      ASSERT_EQ(parts[i], !faces_light(scene, g, light, i) ? 0u : is_behind ? 2u : 1u) << axis << ' ' << i;
      ++counted[parts[i]];
      if (parts[i] == 0 || std::abs(g.position(i)[axis] - place[axis]) < 0.1) continue;
      EXPECT_EQ(map.technique->explain(i)->taps[0].direction[axis] < 0, is_behind) << axis << ' ' << i;
    }
    EXPECT_GT(counted[1], 500) << axis;
    EXPECT_GT(counted[2], 500) << axis;
  }
}

// What the shader answers is what the tap says.
TEST_F(ParaboloidMap, masks_are_what_their_taps_say) {
  Scene scene;
  std::mt19937 random(7);
  scene.meshes = {small_world::ground(4), small_world::random_soup(random, 20, 3, 0.2f, 1.5f, 0.7f)};
  const GBuffer g = small_world::make_gbuffer(scene, view, 120, 90);
  const auto map = run("resolution=512", scene, light, g);
  int dark = 0, other = 0;
  for (std::size_t i = 0; i < g.size(); ++i) {
    if (!faces_light(scene, g, light, i)) continue;
    const auto why = map.technique->explain(i);
    const bool says = why->taps[0].stored < glm::length(glm::dvec3(g.position(i)) - why->taps[0].origin) - why->bias;
    dark += says;
    other += says != (map.mask[i] == 0);
  }
  EXPECT_GT(dark, 300);
  EXPECT_LE(other, 5);
}

TEST_F(ParaboloidMap, other_lights_are_refused) {
  Registry registry;
  gnomon_technique_paraboloid_map(registry);
  const auto technique = registry.techniques()[0].make();
  EXPECT_EQ(technique->supports({}, {.kind = DirectionalLight{{0, -1, 0}}}, {}).why(),
            "a directional light does not shine all around a place, as two paraboloids see it");
  EXPECT_TRUE(technique->supports({}, {.kind = PointLight{}}, {}));
}

}  // namespace paraboloid_map_test
