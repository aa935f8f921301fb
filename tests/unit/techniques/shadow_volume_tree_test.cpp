// The shadow volume tree: what copies and size cost it, what it leaves out, and what it refuses.
#include <gnomon/kit/geometry/shapes.h>
#include <gnomon/kit/random.h>
#include <gnomon/registry.h>
#include <gtest/gtest.h>

#include "hard_scenes.h"

extern "C" void gnomon_technique_shadow_volume_tree(gnomon::Registry& registry);

namespace gnomon::shadow_volume_tree_test {

using namespace hand_made;
using small_world::value;

small_world::Run run(const std::string& settings, const Scene& scene, const Light& light, const GBuffer& gbuffer) {
  return small_world::run(gnomon_technique_shadow_volume_tree, settings, scene, light, gbuffer);
}

// Layers, copies and all: what a caster covers exactly is not put into the tree.
TEST(ShadowVolumeTree, copies_cost_nothing) {
  std::vector<glm::vec3> positions = {{0, 1, 0}, {0, 1, 4}, {4, 1, 0}};
  std::vector<glm::uvec3> triangles(5000, glm::uvec3(0, 1, 2));
  for (std::size_t i = 0; i < triangles.size(); i += 3) std::swap(triangles[i].x, triangles[i].z);
  Scene scene;
  scene.meshes = {mesh_of(positions, triangles), square(5, 0)};
  Picture picture(3, 1);
  picture.set(0, {1, 0, 1}, {0, 1, 0}, 1, 1);
  picture.set(1, {3, 0, 3}, {0, 1, 0}, 1, 1);
  picture.set(2, {1, 1 - 0x1p-24f, 1}, {0, 1, 0}, 0, 4000);  // below itself and all others
  for (const char* const settings : {"", "order=scene", "order=near_first"}) {
    const auto done = run(settings, scene, sun({0, -1, 0}), picture.gbuffer);
    EXPECT_EQ(done.mask, (std::vector<float>{0, 1, 1}));
    EXPECT_EQ(value(done.technique->counts(), "triangles"), 3);
    EXPECT_EQ(value(done.technique->counts(), "nodes"), 12);
  }
}

// An open box of two thin walls seen edge-on, and a lamp in the plane of a third.
TEST(ShadowVolumeTree, edge_on_triangles_cast_nothing) {
  Scene scene;
  scene.meshes = {mesh_of({{0, 1, -1}, {0, 1, 1}, {0, 2, 0}, {-1, 1, 0}, {1, 1, 0}}, {{0, 1, 2}, {3, 4, 2}}), square(5, 0)};
  Picture picture(2, 1);
  picture.set(0, {0, 0, 0.25f}, {0, 1, 0}, 1, 0);
  picture.set(1, {0.5f, 0, 0.5f}, {0, 1, 0}, 1, 0);
  const auto done = run("", scene, sun({0, -1, 0}), picture.gbuffer);
  EXPECT_EQ(done.mask, (std::vector<float>{1, 1}));
  EXPECT_EQ(value(done.technique->counts(), "triangles"), 2);
  const auto lamp = run("", scene, point_light({0, 4, 0.5f}), picture.gbuffer);
  EXPECT_EQ(value(lamp.technique->counts(), "triangles"), 3);
}

// What the tree stands for: visits grow far slower than triangles, and what passes trees by saves most of them.
TEST(ShadowVolumeTree, visits_grow_slowly) {
  double visits[2][2];
  for (int k = 0; k < 2; ++k) {
    Scene scene;
    scene.meshes = {square(4, -1.5f), tessellate(Sphere{{0, 0, 0}, 1}, k == 0 ? 32 : 128, "sphere")};
    Random random(13);
    const Light light = point_light({2, 5, 1});
    Picture picture(100, 50);
    hard_scenes::scatter(scene, light, random, picture);
    visits[k][0] = value(run("", scene, light, picture.gbuffer).technique->counts(), "visits");
    visits[k][1] = value(run("wedge=false", scene, light, picture.gbuffer).technique->counts(), "visits");
    EXPECT_LT(2 * visits[k][0], visits[k][1]);
  }
  EXPECT_LT(visits[1][0], 2 * visits[0][0]);  // for 16 times the triangles
  RecordProperty("visits",
                 fmt::format("{} -> {}, without wedges {} -> {}", visits[0][0], visits[1][0], visits[0][1], visits[1][1]));
}

TEST(ShadowVolumeTree, area_lights_are_refused_with_a_reason) {
  Registry roll;
  gnomon_technique_shadow_volume_tree(roll);
  const auto technique = roll.technique("shadow_volume_tree").make();
  const Support support = technique->supports({}, {.name = "area", .kind = SphereLight{}}, {});
  EXPECT_FALSE(support);
  EXPECT_FALSE(support.why().empty());
  EXPECT_TRUE(technique->supports({}, {.name = "spot", .kind = SpotLight{}}, {}));
}

// Two casters, a triangle and a floor of one: far from both the layer is darker than between them.
TEST(ShadowVolumeTree, the_layer_shows_where_queries_are_long) {
  Scene scene;
  scene.meshes = {mesh_of({{0, 1, 0}, {0, 1, 4}, {4, 1, 0}}, {{0, 1, 2}}), square(10, 0)};
  scene.meshes[1].casts = false;
  Picture picture(3, 1);
  picture.set(0, {-1, 0, 1}, {0, 1, 0}, 1, 0);  // 1 node
  picture.set(1, {1, 0, 1}, {0, 1, 0}, 1, 0);   // 4 nodes
  const auto done = run("", scene, sun({0, -1, 0}), picture.gbuffer);
  EXPECT_EQ(done.mask, (std::vector<float>{1, 0, 1}));
  EXPECT_EQ(value(done.technique->counts(), "visits"), 2.5);
  const std::vector<float> layer = done.technique->draw_debug("visits");
  ASSERT_EQ(layer.size(), 9u);
  EXPECT_GT(layer[3] + layer[4], layer[0] + layer[1]);
  EXPECT_THROW(done.technique->draw_debug("nodes"), Error);
}

}  // namespace gnomon::shadow_volume_tree_test
