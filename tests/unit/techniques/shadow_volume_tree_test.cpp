// The shadow volume tree against the exact oracle on scenes that are hard on it, what size, threads and copies cost it, what it
// refuses.
#include <gnomon/kit/exact_scene.h>
#include <gnomon/kit/random.h>
#include <gnomon/kit/shapes.h>
#include <gnomon/registry.h>
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "hard_scenes.h"

extern "C" void gnomon_technique_shadow_volume_tree(gnomon::Registry& registry);

namespace gnomon {
namespace {

using namespace hand_made;
using small_world::value;

small_world::Run run(const std::string& settings, const Scene& scene, const Light& light, const GBuffer& gbuffer) {
  return small_world::run(gnomon_technique_shadow_volume_tree, settings, scene, light, gbuffer);
}

struct Agreement {
  int wrong = 0, dark = 0, lit = 0, degenerate = 0;
  std::string text() const {
    return fmt::format("{} dark, {} lit, {} of the dark through edges or vertices", dark, lit, degenerate);
  }
};

/// The mask under one setting; counts pixels that the oracle decides otherwise, those where it is degenerate included.
std::vector<float> compare(const std::string& settings, const Scene& scene, const Light& light, const GBuffer& gbuffer,
                           Agreement& sum) {
  const auto done = run(settings, scene, light, gbuffer);
  const ExactScene exact(scene);
  for (std::size_t i = 0; i < gbuffer.size(); ++i) {
    if (!faces_light(scene, gbuffer, light, i)) {
      EXPECT_EQ(done.mask[i], 1);
      continue;
    }
    ExactTally tally;
    const ExactAnswer answer = exact.occluded(receiver_at(scene, gbuffer, i), homogeneous(light), tally);
    ++(answer.blocked ? sum.dark : sum.lit);
    sum.degenerate += answer.degenerate;
    if ((done.mask[i] == 0) != answer.blocked && sum.wrong++ == 0) {
      const glm::vec3 p = gbuffer.position(i);
      ADD_FAILURE() << "'" << settings << "', pixel " << i << " of mesh " << gbuffer.mesh[i] << ", triangle "
                    << gbuffer.triangle[i] << " at " << p.x << ", " << p.y << ", " << p.z << " should be "
                    << (answer.blocked ? "dark" : "lit") << (answer.degenerate ? ", degenerate" : "");
    }
  }
  return done.mask;
}

const char* const all_settings[] = {"",
                                    "seed=2",
                                    "order=random",
                                    "order=scene",
                                    "order=near_first",
                                    "early_out=false",
                                    "wedge=false",
                                    "order=scene,early_out=false,wedge=false",
                                    "order=near_first,early_out=false,wedge=false"};

TEST(ShadowVolumeTree, decides_as_the_oracle_does_on_soups) {
  Random random(5);
  Agreement sum;
  for (int round = 0; round < 200; ++round) {
    SCOPED_TRACE(round);
    Scene scene;
    scene.meshes = {hard_scenes::grid_soup(random, 1 + round % 60), hard_scenes::grid_soup(random, 5)};
    scene.meshes[1].casts = random.below(2);
    const Light light = hard_scenes::hard_light(random);
    Picture picture(40, 20);
    hard_scenes::scatter(scene, light, random, picture);
    for (const char* const settings : all_settings) compare(settings, scene, light, picture.gbuffer, sum);
  }
  EXPECT_EQ(sum.wrong, 0);
  EXPECT_GT(sum.dark, 200'000);
  EXPECT_GT(sum.lit, 200'000);
  EXPECT_GT(sum.degenerate, 200);
  RecordProperty("pixels", sum.text());
}

TEST(ShadowVolumeTree, decides_as_the_oracle_does_on_boxes_and_cycles) {
  Random random(6);
  Agreement sum;
  for (int round = 0; round < 150; ++round) {
    SCOPED_TRACE(round);
    Scene scene;
    scene.meshes = {hard_scenes::boxes(random, 1 + round % 12, round % 2), hard_scenes::boxes(random, 2, true), square(6, -2),
                    hard_scenes::cycle(2, 1.5f)};
    const Light light = hard_scenes::hard_light(random);
    Picture picture(40, 20);
    hard_scenes::scatter(scene, light, random, picture);
    for (const char* const settings : all_settings) compare(settings, scene, light, picture.gbuffer, sum);
  }
  EXPECT_EQ(sum.wrong, 0);
  EXPECT_GT(sum.dark, 100'000);
  EXPECT_GT(sum.lit, 100'000);
  EXPECT_GT(sum.degenerate, 1000);
  RecordProperty("pixels", sum.text());
}

// As pictures are: points where the eye's rays meet the scene; a picture that is not a multiple of a tile.
TEST(ShadowVolumeTree, decides_as_the_oracle_does_in_pictures) {
  std::mt19937 engine(7);
  Random random(7);
  Agreement sum;
  for (int round = 0; round < 12; ++round) {
    SCOPED_TRACE(round);
    const auto [scene, gbuffer, lights] = hard_scenes::viewed(random, engine);
    for (const Light& light : lights) compare("", scene, light, gbuffer, sum);
  }
  EXPECT_EQ(sum.wrong, 0);
  EXPECT_GT(sum.dark, 50'000);
  EXPECT_GT(sum.lit, 50'000);
  RecordProperty("pixels", sum.text());
}

// A power of two changes no sign. Lights far away, and coordinates so large or small that float32 proves nothing; with float32
// as it should be, few signs are taken in double.
TEST(ShadowVolumeTree, answers_do_not_depend_on_the_scale) {
  Random random(11);
  Scene scene;
  scene.meshes = {hard_scenes::grid_soup(random, 40), hard_scenes::boxes(random, 4, false)};
  for (const Light& light : {point_light({1.3f, 3.1f, 0.4f}), point_light({1e6f, 3e6f, 2e6f}), sun({0.3f, -1, 0.1f})}) {
    Picture picture(60, 40);
    hard_scenes::scatter(scene, light, random, picture);
    Agreement sum;
    const std::vector<float> mask = compare("", scene, light, picture.gbuffer, sum);
    EXPECT_EQ(sum.wrong, 0);
    EXPECT_GT(sum.dark, 100);
    EXPECT_GT(sum.lit, 100);
    EXPECT_LT(value(run("", scene, light, picture.gbuffer).technique->counts(), "signs_in_double"), 20'000);
    for (const int exponent : {-80, -20, 20, 98, 101, 120}) {
      if (exponent > 101 && light.name == "point" && std::get<PointLight>(light.kind).position.x > 100)
        continue;  // beyond float32
      const float scale = std::ldexp(1.0f, exponent);
      Scene scaled = scene;
      for (Mesh& mesh : scaled.meshes)
        for (glm::vec3& p : mesh.positions) p *= scale;
      Light lamp = light;
      if (auto* const point = std::get_if<PointLight>(&lamp.kind)) point->position *= scale;
      Picture other(60, 40);
      const auto& g = picture.gbuffer;
      for (std::size_t i = 0; i < g.size(); ++i)
        if (!g.is_background(i)) other.set(i, scale * g.position(i), g.normal(i), g.mesh[i], g.triangle[i]);
      EXPECT_EQ(run("", scaled, lamp, other.gbuffer).mask, mask) << "times 2^" << exponent;
    }
  }
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

// A body on an exact shape leaves itself out; its shadow on the floor, and a plate's shadow on it, remain.
TEST(ShadowVolumeTree, an_exact_shape_is_not_shaded_by_its_own_triangles) {
  Scene scene;
  scene.meshes = {tessellate(Sphere{{0, 0, 0}, 1}, 12, "sphere"), square(4, -1.5f), square(0.4f, 3)};
  Picture picture(100, 102, Truth::shape);
  Random random(4);
  const Light light = point_light({0.3f, 6, -0.2f});
  for (std::size_t i = 0; i < 10'000; ++i) {
    const glm::vec3 n(glm::normalize(random.uniform(glm::dvec3(-1), glm::dvec3(1))));
    picture.set(i, n, n, 0, 0);
  }
  for (std::size_t i = 10'000; i < 10'200; ++i) {
    const float x = static_cast<float>(random.uniform(-3, 3)), z = static_cast<float>(random.uniform(-3, 3));
    picture.set(i, {x, -1.5f, z}, {0, 1, 0}, 1, z > x ? 0 : 1);
  }
  Agreement sum;
  for (const char* const settings : all_settings) compare(settings, scene, light, picture.gbuffer, sum);
  EXPECT_EQ(sum.wrong, 0);
  EXPECT_GT(sum.dark, 1000);
  EXPECT_GT(sum.lit, 10'000);
  scene.meshes[2].casts = false;
  const auto done = run("", scene, light, picture.gbuffer);
  EXPECT_EQ(std::count(done.mask.begin(), done.mask.begin() + 10'000, 1.0f), 10'000);
  EXPECT_GT(std::count(done.mask.begin() + 10'000, done.mask.end(), 0.0f), 10);
}

// Trees large enough that threads share the first splits and the rest: masks, counts and occluders are the same, and each
// occluder blocks the way.
TEST(ShadowVolumeTree, threads_change_nothing_and_what_is_named_shades) {
  std::mt19937 engine(12);
  Scene scene;
  scene.meshes = {square(3, 0), small_world::random_soup(engine, 12'000, 2, 0.1f, 2, 0.05f)};
  Random random(12);
  const Light light = point_light({0.7f, 3, 1.1f});
  Picture picture(200, 100);
  hard_scenes::scatter(scene, light, random, picture);
  for (const char* const settings : {"", "order=near_first"}) {
    const auto many = run(settings, scene, light, picture.gbuffer);
    const tbb::global_control control(tbb::global_control::max_allowed_parallelism, 1);
    const auto one = run(settings, scene, light, picture.gbuffer);
    EXPECT_EQ(one.mask, many.mask);
    const Counts a = one.technique->counts(), b = many.technique->counts();
    for (std::size_t k = 0; k < a.size(); ++k) EXPECT_EQ(a[k].value, b[k].value) << a[k].name;
    int dark = 0;
    for (std::size_t i = 0; i < one.mask.size(); ++i) {
      const auto why = one.technique->explain(i), other = many.technique->explain(i);
      ASSERT_EQ(why.has_value(), faces_light(scene, picture.gbuffer, light, i));
      if (!why) continue;
      ASSERT_EQ(why->element, other->element);
      ASSERT_EQ(why->element.has_value(), one.mask[i] == 0);
      EXPECT_TRUE(why->covered);
      if (!why->element) continue;
      ++dark;
      const Mesh& mesh = scene.meshes[*why->element >= 2];
      const glm::uvec3& t = mesh.triangles[*why->element - (*why->element >= 2 ? 2 : 0)];
      const Triangle triangle{{mesh.positions[t.x], mesh.positions[t.y], mesh.positions[t.z]}};
      EXPECT_NE(crosses({picture.gbuffer.position(i), homogeneous(light)}, triangle), Crossing::none);
    }
    EXPECT_GT(dark, 1000);
  }
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

}  // namespace
}  // namespace gnomon
