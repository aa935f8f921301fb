// The technique svbsp: orders and rules that change no answer, counts on paper, what shades what.
#include <gnomon/kit/geometry/exact_scene.h>
#include <gnomon/kit/geometry/shapes.h>
#include <gtest/gtest.h>

#include "hard_scenes.h"
#include "svbsp_rig.h"

namespace gnomon::svbsp_test {

using namespace hand_made;
using namespace svbsp_rig;
using small_world::value;

// Light at every kind of place; a picture of points away from all edges and planes by 1e-6.
TEST(Svbsp, orders_and_rules_change_no_answer) {
  Random random(4);
  std::size_t compared = 0, dark = 0;
  for (int round = 0; round < 40; ++round) {
    Scene scene;
    scene.meshes = {hard_scenes::boxes(random, 8, round % 2), hard_scenes::grid_soup(random, 30), hard_scenes::cycle(2, 1.5f),
                    square(6, -2)};
    scene.meshes[1].casts = round % 3 != 0;
    const Light light = hard_scenes::hard_light(random);
    Picture picture(40, 25);
    hard_scenes::scatter(scene, light, random, picture);
    const ExactScene exact(scene);
    std::vector<bool> is_plain(picture.gbuffer.size());
    for (std::size_t i = 0; i < is_plain.size(); ++i)
      is_plain[i] = std::isinf(exact.edge_margin(receiver_at(scene, picture.gbuffer, i), homogeneous(light), 1e-6).clearance);
    const auto wanted = run("", scene, light, picture.gbuffer).mask;
    for (const char* const settings :
         {"drop_edges=cut", "drop_edges=none", "tile_size=1", "tile_size=4096", "order=bsp", "order=bsp,drop_edges=cut",
          "order=bsp,drop_edges=none", "order=bsp,split=first", "order=bsp,free_cuts=false", "order=face_planes"}) {
      const auto mask = run(settings, scene, light, picture.gbuffer).mask;
      for (std::size_t i = 0; i < mask.size(); ++i) {
        if (!is_plain[i]) continue;
        ++compared, dark += mask[i] == 0;
        ASSERT_EQ(mask[i], wanted[i]) << "round " << round << ", " << settings << ", pixel " << i;
      }
    }
  }
  EXPECT_GT(compared, 100'000u);
  EXPECT_GT(dark, 20'000u);
}

// Every copy of one triangle lies in all tiles. So there are 64 at most, however many copies, and the work grows as they do.
TEST(Svbsp, copies_do_not_multiply) {
  std::vector<glm::vec3> positions;
  std::vector<glm::uvec3> triangles;
  for (std::uint32_t i = 0; i < 60'000; i += 3) {
    positions.insert(positions.end(), {{-1, 1, -1}, {1, 1, -1}, {0, 1, 1}});
    triangles.push_back({i, i + 1, i + 2});
  }
  Scene scene;
  scene.meshes = {mesh_of(positions, triangles)};
  const Counts counts = lit("", scene, sun({0, -1, 0}))->counts();
  EXPECT_EQ(value(counts, "polygons"), 20'000);
  EXPECT_LE(value(counts, "tiles"), 64);
  EXPECT_LE(value(counts, "fragments") + value(counts, "hidden"), 64 * 20'000);
}

// Planes are counted, and so is what they do: one triangle over a ground casts by three planes, and the ground's two by
// five; lit are the triangle, whole, and the ground's parts around it.
TEST(Svbsp, counts_on_paper) {
  Scene scene;
  scene.meshes = {square(5, 0), mesh_of({{1, 1, 0}, {2, 1, 0}, {1, 1, -0.5f}}, {{0, 1, 2}})};
  for (const char* const settings : {"order=bsp", ""}) {
    const Counts counts = lit(settings, scene, sun({0, -1, 0}))->counts();
    EXPECT_EQ(value(counts, "polygons"), 3);
    EXPECT_EQ(value(counts, "nodes"), value(counts, "shadow_planes"));
    EXPECT_EQ(value(counts, "tiles"), 1);
    EXPECT_GE(value(counts, "shadow_planes"), 8);
    EXPECT_GE(value(counts, "fragments"), value(counts, "lit_fragments") + 1);
    EXPECT_GT(value(counts, "bytes"), 0);
  }
}

// Under the sun a steep triangle stands within the outline of a level one and reaches through its plane: all that this adds
// to the splits is the crossing. One triangle alone is a chain of three planes. A thousand side by side are no chain in the
// order `face_planes`, which shuffles them.
TEST(Svbsp, counts_of_crossings_and_depth) {
  const auto counts = [](const char* settings, std::vector<Mesh> meshes) {
    Scene scene;
    scene.meshes = std::move(meshes);
    return lit(settings, scene, sun({0, -1, 0}))->counts();
  };
  const Mesh level = mesh_of({{-4, 1, -4}, {0, 1, 6}, {5, 1, -4}}, {{0, 1, 2}});
  const auto steep = [](float lift) {
    return mesh_of({{0, lift, 0}, {0.5f, 1.5f + lift, 0.25f}, {0, lift, 0.5f}}, {{0, 1, 2}});
  };
  for (const char* const settings : {"", "order=face_planes"})
    EXPECT_EQ(value(counts(settings, {level, steep(0.5f)}), "splits"),
              value(counts(settings, {level, steep(2)}), "splits") + 1);
  const Counts one = counts("", {level});
  EXPECT_EQ(value(one, "nodes"), 3);
  EXPECT_EQ(value(one, "depth"), 3);
  std::vector<Mesh> row;
  for (int i = 0; i < 1000; ++i) {
    const float x = static_cast<float>(i);
    row.push_back(mesh_of({{x, 0, 0}, {x, 0, 1}, {x + 0.5f, 0, 0.5f}}, {{0, 1, 2}}));
  }
  EXPECT_LT(value(counts("order=face_planes", row), "depth"), 200);
}

// Below a plate, whose tiles are cut by their borders, squares are hidden, all of those in tiles in its middle.
TEST(Svbsp, counts_of_what_a_plate_hides) {
  Scene scene;
  scene.meshes = {square(8, 3)};
  for (int x = -4; x < 4; ++x)
    for (int z = -4; z < 4; ++z) {
      scene.meshes.push_back(square(0.25f, 1));
      for (glm::vec3& p : scene.meshes.back().positions)
        p += glm::vec3(static_cast<float>(x) + 0.5f, 0, static_cast<float>(z) + 0.5f);
    }
  const auto technique = lit("tile_size=4", scene, sun({0, -1, 0}));
  EXPECT_GT(value(technique->counts(), "tile_splits"), 0);
  EXPECT_GE(value(technique->counts(), "hidden"), 64);
  for (std::uint32_t mesh = 1; mesh < scene.meshes.size(); ++mesh)
    EXPECT_EQ(area(*technique->surface_detail(), mesh, true), 0) << mesh;
}

// Twenty rows of one point are as many queries, with as many visits each as there are for the point alone; and a second
// picture counts anew.
TEST(Svbsp, counts_of_queries_are_those_of_the_picture) {
  Scene scene;
  scene.meshes = {square(5, 0), square(1, 1)};
  const Light light = sun({0, -1, 0});
  Picture single(1, 1), many(3, 20);
  single.set(0, {0.3f, 0, 0.6f}, {0, 1, 0}, 0, 0);
  for (std::size_t i = 0; i < 60; ++i) many.set(i, {0.3f, 0, 0.6f}, {0, i % 3 == 0 ? -1.0f : 1.0f, 0}, 0, 0);
  const Counts one = run("", scene, light, single.gbuffer).technique->counts();
  EXPECT_EQ(value(one, "queries"), 1);
  EXPECT_GT(value(one, "visits"), 0);
  const auto technique = run("", scene, light, many.gbuffer).technique;
  const double queries = value(technique->counts(), "queries");
  EXPECT_GE(queries, 40);
  VisibilityMask mask(3, 20);
  technique->resolve(many.gbuffer, mask);
  EXPECT_EQ(value(technique->counts(), "queries"), queries);
  EXPECT_EQ(value(technique->counts(), "visits"), value(one, "visits"));
}

// What shades a point is named, counted over the scene; lit points and those that are turned away name nothing.
TEST(Svbsp, a_shaded_point_names_its_triangle) {
  Scene scene;
  scene.meshes = {square(5, 0), square(1, 1)};
  Picture picture(3, 1);
  picture.set(0, {-0.5f, 0, 0.25f}, {0, 1, 0}, 0, 0);  // below the plate's first triangle, x < z
  picture.set(1, {3, 0, 2}, {0, 1, 0}, 0, 1);
  picture.set(2, {-0.5f, 0, 0.25f}, {0, 1, 0}, 0, 0);
  for (const char* const settings : all_orders) {
    const auto above = run(settings, scene, sun({0, -1, 0}), picture.gbuffer);
    ASSERT_TRUE(above.technique->explain(0));
    EXPECT_EQ(above.technique->explain(0)->element, 2u);
    ASSERT_TRUE(above.technique->explain(1));
    EXPECT_FALSE(above.technique->explain(1)->element);
    const auto below = run(settings, scene, sun({0, 1, 0}), picture.gbuffer);
    EXPECT_FALSE(below.technique->explain(0));
  }
}

// One object, relit in another order after another scene, keeps nothing of the tree it had.
TEST(Svbsp, a_new_order_forgets_the_regular_tree) {
  Scene before, after;
  before.meshes = {square(5, 0), square(2, 1)};
  after.meshes = {square(5, 0), square(1, 2)};
  const Light light = sun({0, -1, 0});
  const auto technique = lit("order=bsp", before, light);
  technique->apply("order=tiles");
  technique->build(after);
  technique->relight(light);
  EXPECT_NEAR(area(*technique->surface_detail(), 0, false), 4, 1e-9);
  for (const Count& count : technique->counts()) EXPECT_NE(count.name, "bsp_nodes");
}

// From the light to the point x and y fall alike, so that it lies on the border of two faces of the light, where the shadow of
// a triangle goes on from one to the other. What a cut rounds must not leave a gap there.
TEST(Svbsp, a_point_on_the_border_of_two_faces_is_in_shadow) {
  Scene scene;
  scene.meshes = {mesh_of({{-1.875f, -2, 1.75f}, {1.25f, 1.375f, -2}, {-14, 8, -8}}, {{0, 1, 2}}), square(6, -2)};
  Picture picture(1, 1);
  picture.set(0, {-6, -2, -1.5f}, {0, 1, 0}, 1, 0);
  for (const char* const settings : all_orders)
    EXPECT_EQ(run(settings, scene, point_light({-0.5f, 3.5f, 0}), picture.gbuffer).mask[0], 0) << settings;
}

TEST(Svbsp, area_lights_are_refused) {
  const auto technique = lit("", {}, sun({0, -1, 0}));
  EXPECT_FALSE(technique->supports({}, {.name = "area", .kind = SphereLight{}}, {}));
  EXPECT_TRUE(technique->supports({}, {.name = "spot", .kind = SpotLight{}}, {}));
}

// Where a mesh reaches beyond its exact shape, as a ball of radius 1 in triangles beyond one of 0.9, it shades no point of
// the shape that faces the light; in a picture of the mesh the shape means nothing, and a plate shades the other one of its
// mesh.
TEST(Svbsp, a_mesh_shades_itself_only_as_a_mesh) {
  Scene scene;
  scene.meshes = {tessellate(Sphere{{0, 0, 0}, 1}, 24, "ball")};
  scene.meshes[0].shape = Sphere{{0, 0, 0}, 0.9f};
  Picture curve(20, 20, Truth::shape);
  Random random(8);
  for (std::size_t i = 0; i < curve.gbuffer.size(); ++i) {
    const glm::dvec3 n = small_world::direction_of(random);
    curve.set(i, glm::vec3(0.9 * n), glm::vec3(n), 0, 0);
  }
  EXPECT_EQ(std::ranges::count(run("", scene, sun({0, -1, 0}), curve.gbuffer).mask, 0.0f), 0);
  Mesh plates = square(3, 0);
  for (const glm::vec3& p : square(1, 1).positions) plates.positions.push_back(p);
  plates.triangles.insert(plates.triangles.end(), {{4, 5, 6}, {4, 6, 7}});
  scene.meshes = {mesh_of(plates.positions, plates.triangles)};
  scene.meshes[0].shape = Sphere{};
  Picture flat(1, 1);
  flat.set(0, {0.5f, 0, 0.25f}, {0, 1, 0}, 0, 1);
  EXPECT_EQ(run("", scene, sun({0, -1, 0}), flat.gbuffer).mask[0], 0);
}

}  // namespace gnomon::svbsp_test
