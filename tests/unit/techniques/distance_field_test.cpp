// What distance fields answer: their shadows and penumbrae against exact witnesses, surfaces that do not darken themselves, and
// the cause of each way in which they err.
#include <gnomon/kit/geometry/shapes.h>
#include <gtest/gtest.h>

#include <cmath>

#include "area_lights.h"
#include "hand_made.h"
#include "measure/cause/own_causes.h"

extern "C" void gnomon_technique_distance_field(gnomon::Registry&);
extern "C" void gnomon_technique_exact_area(gnomon::Registry&);
extern "C" void gnomon_technique_exact_rays(gnomon::Registry&);

namespace gnomon::distance_field_test {

/// A ground that casts nothing, and casters.
Scene over_ground(std::vector<Mesh> casters) {
  Scene scene;
  scene.meshes = {small_world::ground(8, 0, false)};
  for (Mesh& caster : casters) scene.meshes.push_back(std::move(caster));
  return scene;
}

small_world::Run fields_of(const Scene& scene, const Light& light, const GBuffer& g, const std::string& settings = "") {
  return small_world::run(gnomon_technique_distance_field, settings, scene, light, g);
}

/// One point of the ground: the answer, and the cause of it.
struct Told {
  float answer;
  Explanation why;
};
Told at(const Scene& scene, const Light& light, const glm::vec3& point, const std::string& settings = "") {
  hand_made::Picture picture(1, 1);
  picture.set(0, point, {0, 1, 0}, 0, 0);
  const auto run = fields_of(scene, light, picture.gbuffer, settings);
  return {run.mask[0], *run.technique->explain(0)};
}

TEST(DistanceField, a_box_casts_the_shadow_that_rays_find_but_for_a_voxel) {
  const Scene scene = over_ground({small_world::box({-1, 0.5f, -1}, {1, 1.5f, 1})});
  const Light light = hand_made::point_light({2, 6, 1});
  hand_made::Picture picture(128, 128);
  for (std::size_t i = 0; i < picture.gbuffer.size(); ++i)
    picture.set(i, {static_cast<float>(i % 128) / 16 - 4, 0, static_cast<float>(i / 128) / 16 - 4}, {0, 1, 0}, 0, 0);
  const auto ours = fields_of(scene, light, picture.gbuffer);
  const auto exact = small_world::run(gnomon_technique_exact_rays, "", scene, light, picture.gbuffer).mask;
  std::size_t wrong = 0, dark = 0;
  for (std::size_t i = 0; i < exact.size(); ++i) {
    ASSERT_TRUE(ours.mask[i] == 0 || ours.mask[i] == 1);
    dark += exact[i] == 0;
    wrong += ours.mask[i] != exact[i];
  }
  EXPECT_GT(dark, 1000u);
  // The outline, some 160 pixels of 1/16 m long, is off by a part of a voxel of 1/32 m.
  EXPECT_LT(wrong, 160u);
  // Rays that leave the box's field behind take one step or none.
  EXPECT_GT(small_world::value(ours.technique->counts(), "steps_per_ray"), 0.5);
  // 2 m along x and z, 1 m along y, in voxels of 1/32 m, and one more on each side.
  EXPECT_EQ(small_world::value(ours.technique->counts(), "voxels"), 67 * 35 * 67);
}

// The way from a convex body, and from a sheet, leads away from it: the own field never comes nearer again.
TEST(DistanceField, convex_bodies_and_sheets_do_not_darken_themselves) {
  Scene scene;
  scene.meshes = {small_world::ground(8), tessellate(Sphere{{0, 3, 0}, 1}, 48, "sphere"),
                  small_world::box({3, 1, -1}, {4, 2, 1})};
  Random random(4);
  for (const std::uint32_t own : {0u, 1u, 2u}) {
    Scene alone = scene;
    for (std::uint32_t m = 0; m < 3; ++m) alone.meshes[m].casts = m == own;
    const Mesh& mesh = alone.meshes[own];
    hand_made::Picture picture(64, 16);
    for (std::size_t i = 0; i < picture.gbuffer.size(); ++i) {
      const auto t = random.below(static_cast<std::uint32_t>(mesh.triangles.size()));
      const Triangle corners = mesh.corners(t);
      double u = random.uniform(0, 1), v = random.uniform(0, 1);
      if (u + v > 1) {
        u = 1 - u;
        v = 1 - v;
      }
      const glm::dvec3 a(corners.points[0]), b(corners.points[1]), c(corners.points[2]);
      picture.set(i, glm::vec3(a + u * (b - a) + v * (c - a)), glm::vec3(glm::normalize(corners.normal())), own, t);
    }
    for (const Light& light :
         {hand_made::point_light({3, 6, 2}), hand_made::sun({-1, -0.2f, 0.1f}), sphere({-4, 7, 1}, 0.5f)}) {
      const auto run = fields_of(alone, light, picture.gbuffer);
      for (std::size_t i = 0; i < run.mask.size(); ++i) ASSERT_EQ(run.mask[i], 1) << own << " " << kind_name(light) << " " << i;
    }
  }
}

/// Points along x below the straight edge at x = 0 of a box that is 4 m long, 1 to 1.5 m above them, under a disc 100 m away
/// whose cone has the tangent 0.2.
struct Edge {
  static constexpr int count = 200;
  Scene scene = over_ground({small_world::box({-2, 1, -2}, {0, 1.5f, 2})});
  Light light = disc({0, 100, 0}, {0, -1, 0}, 20);
  hand_made::Picture picture{count, 1};
  Edge() {
    for (int i = 0; i < count; ++i) picture.set(i, {at(i), 0, 0}, {0, 1, 0}, 0, 0);
  }
  static float at(int i) { return -0.3f + 0.6f * (static_cast<float>(i) + 0.5f) / count; }
};

// Past the upper edge, at 1.5 m, where the way is free, and before the lower one, at 1 m, where it is blocked. Within, the way
// out is first as long as that to the edge where the way is as far above the lower face: s is too small by that share, at most
// 0.2 at -1, where the disc's share is flat; that is 0.04 of the light. A voxel is 1/32 m, and a tenth of the cone.
TEST(DistanceField, a_straight_edge_of_a_thick_caster_has_the_penumbra_of_the_light) {
  Edge edge;
  const auto ours = fields_of(edge.scene, edge.light, edge.picture.gbuffer, "resolution=128");
  const auto exact = small_world::run(gnomon_technique_exact_area, "", edge.scene, edge.light, edge.picture.gbuffer).mask;
  double sum = 0;
  int soft = 0;
  for (int i = 0; i < Edge::count; ++i) {
    EXPECT_NEAR(ours.mask[i], exact[i], 0.1) << Edge::at(i);
    if (exact[i] == 0 || exact[i] == 1) continue;
    sum += std::abs(ours.mask[i] - exact[i]);
    ++soft;
  }
  EXPECT_GT(soft, Edge::count / 2);
  EXPECT_LT(sum / soft, 0.04);
}

// Of the outer half s grows evenly with x, and the ratio is off by 1 - 2 / (3 pi) - 1/2 = 0.2878 in the mean, see
// distance_field_parts_test. The upper edge is cut off by a part of a voxel, here a tenth of the half.
TEST(DistanceField, the_ratio_lacks_the_inner_half_and_the_cause_is_the_formula) {
  Edge edge;
  const auto ours = fields_of(edge.scene, edge.light, edge.picture.gbuffer, "resolution=128");
  const auto ratio = fields_of(edge.scene, edge.light, edge.picture.gbuffer, "resolution=128,formula=ratio");
  const auto cubic = fields_of(edge.scene, edge.light, edge.picture.gbuffer, "resolution=128,formula=smoothstep");
  double outer = 0;
  int outer_count = 0;
  for (int i = 0; i < Edge::count; ++i) {
    EXPECT_NEAR(cubic.mask[i], ours.mask[i], 0.0395) << Edge::at(i);
    if (Edge::at(i) < -0.01f) {
      EXPECT_EQ(ratio.mask[i], 0) << Edge::at(i);
    }
    if (Edge::at(i) < 0 || ours.mask[i] == 1) continue;
    outer += ours.mask[i] - ratio.mask[i];
    ++outer_count;
  }
  ASSERT_GT(outer_count, 50);
  EXPECT_NEAR(outer / outer_count, 0.2878, 0.03);
  EXPECT_TRUE(at(edge.scene, edge.light, {0.15f, 0, 0}, "formula=ratio").why.formula_differs);
  EXPECT_FALSE(at(edge.scene, edge.light, {0.15f, 0, 0}).why.formula_differs);
}

/// The slab x 5.2 .. 5.8 between two boxes that fix the grid: at resolution 16 samples lie at whole meters, none within, and at
/// twice that at 5.5.
TEST(DistanceField, a_slab_between_samples_is_lost_by_the_resolution) {
  const Mesh parts[] = {small_world::box({0, 0, 0}, {1, 1, 1}), small_world::box({5.2f, 0, 0}, {5.8f, 2, 2}),
                        small_world::box({15, 1, 1}, {16, 2, 2})};
  Scene scene;
  scene.meshes = {small_world::make_mesh({{3, -1, -1}, {3, 3, -1}, {3, 1, 3}}, {{0, 1, 2}}, false), merge(parts, "parts")};
  const Light light = hand_made::point_light({9, 1, 1});
  hand_made::Picture picture(1, 1);
  picture.set(0, {3, 1, 1}, {1, 0, 0}, 0, 0);
  const auto coarse = fields_of(scene, light, picture.gbuffer, "resolution=16");
  EXPECT_EQ(coarse.mask[0], 1);
  EXPECT_EQ(coarse.technique->explain(0)->cause, "field_resolution");
  EXPECT_EQ(fields_of(scene, light, picture.gbuffer, "resolution=32").mask[0], 0);
}

// A box whose side is 0.01 m beside the point, a twelfth of its voxel, hides half of a light that is straight above.
TEST(DistanceField, a_side_within_a_voxel_is_a_contact_gap) {
  const Scene scene = over_ground({small_world::box({0.01f, -4, -4}, {8.01f, 4, 4})});
  const Told told = at(scene, disc({0, 16, 0}, {0, -1, 0}, 4), {0, 0, 0});
  EXPECT_EQ(told.answer, 1);
  EXPECT_EQ(told.why.cause, "contact_gap");
}

// A box 0.1 m below a light of radius 1 and beside the way: its distance is asked up to 3.2 m alone.
TEST(DistanceField, a_caster_at_the_light_is_told_from_what_is_behind_it_by_no_distance) {
  const Scene scene = over_ground({small_world::box({0.2f, 3.5f, -3}, {6, 3.9f, 3})});
  const Told told = at(scene, disc({0, 4, 0}, {0, -1, 0}, 1), {0, 0, 0});
  EXPECT_GT(told.answer, 0.7);
  EXPECT_EQ(told.why.cause, "near_light");
  // A ceiling behind the light hides nothing.
  const Scene ceiling = over_ground({small_world::box({-6, 4.1f, -6}, {6, 5, 6})});
  EXPECT_EQ(at(ceiling, disc({0, 4, 0}, {0, -1, 0}, 1), {0, 0, 0}).answer, 1);
}

// Each box hides two fifths and more of the light, and the slit between them is seen.
TEST(DistanceField, of_two_casters_the_nearest_counts_alone) {
  const Scene scene = over_ground({small_world::box({-5, 1, -4}, {-0.02f, 3, 4}), small_world::box({0.02f, 1, -4}, {5, 3, 4})});
  const Told told = at(scene, disc({0, 20, 0}, {0, -1, 0}, 4), {0, 0, 0});
  EXPECT_GT(told.answer, 0.4);
  EXPECT_EQ(told.why.cause, "nearest_caster");
}

// The way through its middle is out of the plate after 0.1 m, and the cone is 0.4 m wide there.
TEST(DistanceField, the_umbra_of_a_thin_plate_is_gray) {
  const Scene scene = over_ground({small_world::box({-3, 1.9f, -3}, {3, 2.1f, 3})});
  const Told told = at(scene, disc({0, 20, 0}, {0, -1, 0}, 4), {0, 0, 0});
  EXPECT_GT(told.answer, 0.25);
  EXPECT_EQ(told.why.cause, "thin_caster");
}

// A body of 0.1 m in the middle of a cone that is 0.4 m wide hides a sixteenth of the light or so, and counts as half.
TEST(DistanceField, a_small_body_counts_as_a_straight_edge) {
  const Scene scene = over_ground({tessellate(Sphere{{0, 2, 0}, 0.1f}, 32, "sphere")});
  const Told told = at(scene, disc({0, 20, 0}, {0, -1, 0}, 4), {0, 0, 0});
  EXPECT_LT(told.answer, 0.5);
  EXPECT_EQ(told.why.cause, "one_edge");
}

TEST(DistanceField, fields_of_what_moved_are_those_of_a_build) {
  Scene scene = over_ground({small_world::box({-1, 0.5f, -1}, {0, 1.5f, 1}), small_world::box({0.5f, 0.5f, -1}, {1, 2, 1})});
  const Light light = disc({1, 6, 0}, {0, -1, 0}, 1);
  hand_made::Picture picture(64, 64);
  for (std::size_t i = 0; i < picture.gbuffer.size(); ++i)
    picture.set(i, {static_cast<float>(i % 64) / 8 - 4, 0, static_cast<float>(i / 64) / 8 - 4}, {0, 1, 0}, 0, 0);
  const auto run = fields_of(scene, light, picture.gbuffer, "resolution=32");
  Changes changes;
  changes.meshes.resize(3);
  for (int step = 0; step < 4; ++step) {
    const std::size_t moved = 1 + step % 2;
    Mesh& mesh = scene.meshes[moved];
    for (glm::vec3& p : mesh.positions) p += glm::vec3(0.1f, 0.05f * p.x, 0.07f);
    for (MeshChange& change : changes.meshes) change = {};
    changes.meshes[moved].kind = MeshChange::Kind::deformed;
    changes.meshes[moved].count = static_cast<std::uint32_t>(mesh.positions.size());
    run.technique->update(scene, changes);
    run.technique->relight(light);
    EXPECT_EQ(small_world::mask_of(*run.technique, picture.gbuffer),
              fields_of(scene, light, picture.gbuffer, "resolution=32").mask);
  }
}

// The card of 2 m is a plate one voxel of 1/32 m thick, so the way out of it is at most 1/64 m. The cone's radius is 0.4 m
// where it meets the card: s is -0.04 or more, and the disc's share 1/2 - 0.04 * 2 / pi > 0.47.
TEST(DistanceField, a_sheet_leaves_half_of_the_light_and_the_support_promises_no_more) {
  Registry registry;
  gnomon_technique_distance_field(registry);
  const auto technique = registry.techniques()[0].make();
  Mesh card = hand_made::square(1, 1);
  card.name = "card";
  const Light light = disc({0, 100, 0}, {0, -1, 0}, 40), hard = hand_made::point_light({0, 100, 0});
  Scene scene;
  scene.meshes = {small_world::ground(8), small_world::box({-1, 0.5f, -1}, {1, 1.5f, 1})};
  EXPECT_EQ(technique->supports(scene, light, {}).most_wrong(), std::nullopt);  // the ground hides no light
  scene.meshes = {small_world::ground(8), card};
  const Support support = technique->supports(scene, light, {});
  EXPECT_EQ(support.most_wrong(), 0.5);
  EXPECT_NE(support.why().find("card is open"), std::string::npos) << support.why();
  EXPECT_EQ(technique->supports(scene, hard, {}).most_wrong(), std::nullopt);
  // Below the ground of another: that one is in the way.
  scene.meshes = {small_world::ground(8), small_world::box({-1, -1.5f, -1}, {1, -0.5f, 1})};
  EXPECT_EQ(technique->supports(scene, light, {}).most_wrong(), 0.5);
  technique->apply("formula=ratio");
  EXPECT_EQ(technique->supports(scene, light, {}).most_wrong(), std::nullopt);

  scene = over_ground({card});
  const Told below = at(scene, light, {0, 0, 0});
  EXPECT_GT(below.answer, 0.47f);
  EXPECT_LE(below.answer, 0.5f);
  EXPECT_EQ(below.why.cause, "thin_caster");
  EXPECT_EQ(at(scene, light, {0, 0, 0}, "formula=ratio").answer, 0);
}

TEST(DistanceField, colors_of_its_causes_are_told_apart_and_large_scenes_are_refused_with_their_size) {
  Registry registry;
  gnomon_technique_distance_field(registry);
  EXPECT_NO_THROW(check_own_causes(registry.techniques()));
  const auto technique = registry.techniques()[0].make();
  EXPECT_EQ(technique->supports({}, hand_made::point_light({0, 1, 0}), {}).kind(), Support::Kind::approximate);
  // 67^3 halves are 0.57 MiB, so 1 GiB holds 1785 cubes.
  Scene scene;
  const Mesh cube = small_world::box({0, 0, 0}, {1, 1, 1});
  scene.meshes.assign(1785, cube);
  EXPECT_TRUE(technique->supports(scene, hand_made::point_light({0, 9, 0}), {}));
  scene.meshes.push_back(cube);
  const Support refused = technique->supports(scene, hand_made::point_light({0, 9, 0}), {});
  EXPECT_FALSE(refused);
  EXPECT_NE(refused.why().find("1024 MiB"), std::string::npos) << refused.why();
}

}  // namespace gnomon::distance_field_test
