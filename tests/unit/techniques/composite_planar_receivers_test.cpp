// Analytic composite shadows: what is a receiver, and how far it reaches.
#include <numbers>

#include "composite_planar_rig.h"

namespace composite_planar_receivers_test {
using namespace composite_rig;
using Point = glm::dvec3;

class CompositeReceivers : public TestRig {};

// A ball over a table over a floor: the light at (0, 4, 0) sees the ball (radius 1/2 at height 2) within the half angle whose
// sine is 1/4: its shadow is a disc of tan = 1/sqrt(15) times 3 on the table at height 1, and times 4 on the floor, where that
// of the table, 4/3 of its half side 1, hides it: a square of half side 4/3.
TEST_F(CompositeReceivers, a_table_and_the_floor_below_get_their_own_shadows) {
  Scene scene;
  scene.meshes = {mesh_of(level({0, 0, 0}, 4)), mesh_of(Box{{-1, 0.9f, -1}, {1, 1, 1}}), mesh_of(Sphere{{0, 2, 0}, 0.5f})};
  const World world(std::move(scene), {.eye = {4, 3.5f, 4}, .target = {0, 0.5f, 0}}, 240, 160);
  const Light light{.kind = PointLight{{0, 4, 0}}};
  const std::vector<float> answer = mask(world, light);
  int table = 0, floor = 0;
  for (std::size_t i = 0; i < answer.size(); ++i) {
    if (!world.faces(light, i)) continue;
    const Point p = world.gbuffer.position(i);
    if (world.gbuffer.mesh[i] == 1) {
      const double off = std::hypot(p.x, p.z) - 3 / std::sqrt(15.0);
      if (std::abs(off) > 1e-5) {
        EXPECT_EQ(answer[i], off < 0 ? 0 : 1) << i;
      }
      table += answer[i] == 0;
    } else if (world.gbuffer.mesh[i] == 0) {
      const double off = std::max(std::abs(p.x), std::abs(p.z)) - 4 / 3.0;
      if (std::abs(off) > 1e-5) {
        EXPECT_EQ(answer[i], off < 0 ? 0 : 1) << i;
      }
      floor += answer[i] == 0;
    }
  }
  EXPECT_GT(table, 500);
  EXPECT_GT(floor, 500);
  EXPECT_EQ(count("planes"), 3);  // floor, top and bottom; an edge of the top is too small
}

TEST_F(CompositeReceivers, curved_receivers_are_lit_and_not_covered) {
  Scene scene;
  scene.meshes = {mesh_of(level({0, 0, 0}, 4)), mesh_of(Sphere{{0, 1, 0}, 0.8f}), mesh_of(Disc{{0, 2.5f, 0}, {0, 1, 0}, 0.6f})};
  const Light light{.kind = PointLight{{0, 6, 0}}};
  const World world(scene, view);
  const std::vector<float> answer = mask(world, light), reference = world.reference(light);
  int on_ball = 0, dark_there = 0;
  for (std::size_t i = 0; i < answer.size(); ++i) {
    if (!world.faces(light, i)) continue;
    const Explanation why = explain(i);
    EXPECT_EQ(why.covered, world.gbuffer.mesh[i] != 1) << i;
    if (world.gbuffer.mesh[i] != 1) continue;
    EXPECT_EQ(answer[i], 1);
    EXPECT_FALSE(why.element || why.formula_differs);
    ++on_ball, dark_there += reference[i] == 0;
  }
  EXPECT_GT(on_ball, 150);
  EXPECT_GT(dark_there, 50);
  // Nearly, since areas are those of tessellations.
  const double pi = std::numbers::pi;
  const Support answered = supports(scene, light);
  EXPECT_EQ(answered.kind(), Support::Kind::approximate);
  EXPECT_NEAR(std::stod(answered.why()), 100 * 4 * pi * 0.64 / (4 * pi * 0.64 + 64 + pi * 0.36), 0.5);
  EXPECT_NE(answered.why().find("% of the receiving area lies on no receiver plane; pixels there are not covered"),
            std::string::npos);
}

// A disc is wider than its triangles: the shadow of the ball reaches to its rim. Three corners make the worst of it.
TEST_F(CompositeReceivers, a_disc_receives_out_to_its_rim) {
  Scene scene;
  scene.meshes = {mesh_of(Disc{{0, 0.9f, 0}, {0, 2.5f, 0}, 2.25f}, 3), mesh_of(Sphere{{-1.2f, 1.8f, -1.4f}, 0.4f})};
  const Light light{.kind = DirectionalLight{{0, -1, 0}}};
  Tally tally;
  compare(World(scene, {.eye = {-0.1f, 5.7f, 0}, .target = {-0.1f, 0, 0}, .fov_y_degrees = 60}), light, tally);
  compare(World(scene, {.eye = {-6, 1.4f, -4}, .target = {-1.2f, 0.9f, -1.4f}, .fov_y_degrees = 20}), light, tally);
  EXPECT_EQ(tally.false_dark + tally.false_lit, 0);
  EXPECT_GT(tally.dark, 100);
}

// The base of a cone on its peak is level with the box beside it: pixels there are on the plane, and are answered.
TEST_F(CompositeReceivers, the_base_of_a_cone_in_a_receiver_plane_is_answered) {
  Scene scene;
  scene.meshes = {mesh_of(Box{{-2, 0, -1}, {0, 1, 1}}), mesh_of(Cone{{1.5f, 1, 0}, {0, -1, 0}, 1, 1}),
                  mesh_of(Disc{{1.6f, 2, 0}, {0, 1, 0}, 0.5f})};
  const Light light{.kind = DirectionalLight{{0, -1, 0}}};
  Tally tally;
  compare(World(scene, {.eye = {1.5f, 3, 4}, .target = {1.5f, 1, 0}, .fov_y_degrees = 40}), light, tally);
  EXPECT_EQ(tally.false_dark + tally.false_lit, 0);
  EXPECT_GT(tally.dark, 200);
}

// Both sheets lie in one tilted plane as far as float32 tells, which on a plane 120 m wide is less far than beside the origin:
// neither darkens the other.
TEST_F(CompositeReceivers, sheets_in_one_plane_do_not_shade_each_other) {
  const glm::vec3 u(0.93f, 0.31f, -0.17f), v(0.11f, 0.23f, 0.97f);
  Scene scene;
  scene.meshes = {mesh_of(Plane{{0, 0, 0}, 60.0f * u, 60.0f * v}), mesh_of(Plane{1.3f * u, 0.9f * u, 0.7f * v}),
                  mesh_of(Triangle{{0.4f * v, 1.7f * v, u + v}}), mesh_of(Sphere{{-1, 1.2f, -0.5f}, 0.4f})};
  const World world(scene, {.eye = {2, 6, 3}, .target = {0.5f, 0.3f, 0.3f}});
  Tally tally;
  for (const Light& light : lights) compare(world, light, tally);
  EXPECT_EQ(tally.false_dark, 0);  // rays see what rounding lifted off the plane: there is false light
  EXPECT_GT(tally.dark, 500);
  EXPECT_EQ(count("planes"), 1);
}

// Eye below and light above see different sides of the ground; eye and light below see the same one, and the shadows on it.
TEST_F(CompositeReceivers, a_plane_shows_shadows_on_its_lit_side_only) {
  Scene scene;
  scene.meshes = {mesh_of(level({0, 0, 0}, 4)), mesh_of(Sphere{{0, 1, 0}, 0.6f}), mesh_of(Sphere{{0.5f, -1, 0}, 0.4f})};
  const World from_below(scene, {.eye = {2, -4, 3}, .target = {0, 0, 0}});
  for (const float value : mask(from_below, lights[0])) EXPECT_EQ(value, 1);
  Tally tally;
  compare(from_below, {.kind = PointLight{{-0.5f, -3, 0.4f}}}, tally);
  EXPECT_EQ(tally.false_dark + tally.false_lit, 0);
  EXPECT_GT(tally.dark, 300);
}

// A light in the plane, and a sun along it, see no side.
TEST_F(CompositeReceivers, a_light_in_the_plane_leaves_it_lit) {
  Scene scene;
  scene.meshes = {mesh_of(level({0, 0, 0}, 4)), mesh_of(Sphere{{0, 1, 0}, 0.6f})};
  scene.meshes[0].casts = false;  // the light may be on it
  const World world(scene, view);
  for (const Light& light : {Light{.kind = PointLight{{2, 0, 1}}}, Light{.kind = DirectionalLight{{1, 0, 0.5f}}}})
    for (const float value : mask(world, light)) EXPECT_EQ(value, 1);
}

// Where two receivers cross at a small angle, pixels of each lie in the plane of the other as far as float32 tells. They belong
// to what they are seen on: neither is tested for being behind itself.
TEST_F(CompositeReceivers, sheets_that_cross_at_a_small_angle_do_not_shade_themselves) {
  for (const float slope : {1e-3f, 1e-2f}) {
    Scene scene;
    scene.meshes = {mesh_of(level({0, 0, 0}, 6)), mesh_of(Plane{{0.3f, 0, 0.2f}, {1.5f, 1.5f * slope, 0}, {0, -slope, 1.2f}}),
                    mesh_of(Disc{{-2, 0, 1}, {slope, 1, -0.37f * slope}, 1}), mesh_of(Sphere{{0.8f, 0.9f, 0.7f}, 0.3f})};
    const World world(scene, {.eye = {1, 6, 4}, .target = {0, 0, 0.3f}}, 320, 180);
    Tally tally;
    for (const Light& light : lights) compare(world, light, tally);
    EXPECT_EQ(tally.false_dark + tally.false_lit, 0) << slope;
    EXPECT_GT(tally.dark, 1000);
  }
}

}  // namespace composite_planar_receivers_test
