// Rays in OpenGL against the rays of the reference: random scenes, holes, glass, what moves, and edges and corners hit exactly.
#include <gnomon/kit/geometry/shapes.h>
#include <gnomon/kit/rays/rays.h>

#include <cstdlib>

#include "degenerate_scenes.h"
#include "drawing_test.h"
#include "glass_scenes.h"
#include "less_of_the_device.h"
#include "map_scenes.h"
#include "measure/frame/classify.h"
#include "shape_world.h"
#include "walking_world.h"

extern "C" void gnomon_technique_gl_rays(gnomon::Registry&);

namespace gl_rays_test {
using namespace gnomon;
using small_world::value;

class GlRays : public DrawingTest {
 protected:
  static small_world::Run run(const Scene& scene, const Light& light, const GBuffer& g) {
    return small_world::run(gnomon_technique_gl_rays, "", scene, light, g);
  }
  static std::vector<float> reference(const Scene& scene, const Light& light, const GBuffer& g) {
    const RayScene casters(scene, Truth::mesh, RayScene::Which::casters);
    std::vector<float> mask(g.size());
    trace_shadows(casters, scene, g, light, mask);
    return mask;
  }
  /// One object for many scenes.
  static std::unique_ptr<Technique> set_up() {
    Registry registry;
    gnomon_technique_gl_rays(registry);
    auto technique = registry.techniques()[0].make();
    technique->setup();
    return technique;
  }
};

/// How often masks differ from the reference: anywhere, and in class T by more than `most`.
struct Differences {
  std::size_t pixels = 0, tested = 0, dark = 0, gray = 0, all = 0, wrong = 0;
  std::string first_wrong = {};

  void add(Technique& technique, const Scene& scene, const Light& light, const GBuffer& g, int round) {
    const RayScene casters(scene, Truth::mesh, RayScene::Which::casters);
    std::vector<float> reference(g.size());
    trace_shadows(casters, scene, g, light, reference);
    const std::vector<PixelClass> classes = classify(scene, casters, g, light, reference, {});
    technique.build(scene);
    technique.relight(light);
    const std::vector<float> mask = small_world::mask_of(technique, g);
    for (std::size_t i = 0; i < g.size(); ++i) {
      pixels += faces_light(scene, g, light, i);
      const bool differs = std::abs(mask[i] - reference[i]) > 1e-6f;
      all += differs;
      if (classes[i] != PixelClass::T) continue;
      ++tested;
      dark += reference[i] == 0;
      gray += reference[i] > 0 && reference[i] < 1;
      wrong += differs;
      if (differs && first_wrong.empty())
        first_wrong = fmt::format("round {}, pixel {}: {} for {}", round, i, mask[i], reference[i]);
    }
    release_inputs();
  }
  /// None in a day's pixels; one of 100,000 in many more, for a light may be nearer to a corner than class U looks at ends of
  /// ways.
  void expect_none() const { EXPECT_LE(wrong, tested / 100000) << first_wrong; }
  std::string text() const {
    return fmt::format("{} pixels, {} of T, {} dark, {} gray; {} differ, {} of T", pixels, tested, dark, gray, all, wrong);
  }
};

std::size_t wanted_pixels(std::size_t least) {
  const char* const wanted = std::getenv("GNOMON_PIXELS");
  return wanted ? std::strtoull(wanted, nullptr, 10) : least;
}

// Scenes of all sizes and places, with lights on edges and corners.
TEST_F(GlRays, differ_from_the_reference_in_class_u_alone) {
  const auto technique = set_up();
  Random random(5);
  Differences seen;
  for (int round = 0; seen.pixels < wanted_pixels(20000); ++round) {
    const auto c = degenerate_scenes::make(round, random);
    if (technique->supports(c->scene, c->light, c->picture.gbuffer.view))
      seen.add(*technique, c->scene, c->light, c->picture.gbuffer, round);
  }
  seen.expect_none();
  EXPECT_GT(seen.dark, seen.tested / 20);
  RecordProperty("seen", seen.text());
}

/// Points scattered over random scenes, under a light without area each.
Differences differences_in(Scene (*random_scene)(Random&, bool), std::uint64_t seed, Technique& technique) {
  Random random(seed);
  Differences seen;
  for (int round = 0; seen.pixels < wanted_pixels(20000); ++round) {
    const Scene scene = random_scene(random, round % 2 == 0);
    const Light light = questions::hard_light(scene.meshes[0], random);
    hand_made::Picture picture(64, 24);
    picture.gbuffer.view.eye = {1, 3, 7};
    hard_scenes::scatter(scene, light, random, picture);
    seen.add(technique, scene, light, picture.gbuffer, round);
  }
  return seen;
}

TEST_F(GlRays, through_holes_differ_from_the_reference_in_class_u_alone) {
  const Differences seen = differences_in(masked_scenes::random_scene, 6, *set_up());
  seen.expect_none();
  EXPECT_GT(seen.dark, seen.tested / 20);
  RecordProperty("seen", seen.text());
}

TEST_F(GlRays, through_glass_differ_from_the_reference_in_class_u_alone) {
  const Differences seen = differences_in(glass_scenes::random_scene, 7, *set_up());
  seen.expect_none();
  EXPECT_GT(seen.gray, seen.tested / 50);
  RecordProperty("seen", seen.text());
}

/// Closed; triangles that share a corner have the very same floats of it.
Mesh ball(const glm::vec3& center, int segments) { return tessellate(Sphere{center, 1}, segments, "ball"); }

// Light inside of a closed mesh, points outside, each on the line from the light through a corner or through a point of an
// edge, and lifted along it: none is lit.
TEST_F(GlRays, no_ray_enters_a_closed_mesh) {
  const auto technique = set_up();
  Random random(8);
  for (const int segments : {24, 96}) {
    Scene scene;
    const glm::vec3 center(3.1f, -2.7f, 5.3f);
    scene.meshes = {ball(center, segments), small_world::ground(1, 0, false)};
    scene.meshes[0].shape.reset();
    ASSERT_TRUE(scene.meshes[0].facts.closed());
    const Mesh& mesh = scene.meshes[0];
    technique->build(scene);
    for (int lamp = 0; lamp < 4; ++lamp) {
      const glm::vec3 at = center + glm::vec3(0.5 * small_world::direction_of(random));
      hand_made::Picture picture(128, 64);
      for (std::size_t i = 0; i < picture.gbuffer.size(); ++i) {
        const Triangle t = mesh.corners(random.below(static_cast<std::uint32_t>(mesh.triangles.size())));
        const float share = i % 2 ? 0.0f : static_cast<float>(random.uniform(0, 1));
        const glm::dvec3 aimed = glm::mix(glm::dvec3(t.points[i % 3]), glm::dvec3(t.points[(i + 1) % 3]), double(share));
        const glm::dvec3 way = aimed - glm::dvec3(at);
        picture.set(i, glm::vec3(glm::dvec3(at) + random.uniform(1.5, 4) * way), glm::vec3(glm::normalize(-way)), 1, 0);
      }
      technique->relight(hand_made::point_light(at));
      const std::vector<float> mask = small_world::mask_of(*technique, picture.gbuffer);
      EXPECT_EQ(std::ranges::count(mask, 1.0f), 0) << segments << ' ' << lamp;
      EXPECT_EQ(value(technique->counts(), "rays"), 128 * 64);
    }
    release_inputs();
  }
}

// A wall up to y = 2, and a ray along z at this very height, in the plane of the upper side of the wall's box: it meets the
// wall's edge. The same along x.
TEST_F(GlRays, a_ray_in_the_plane_of_a_boxs_side_meets_what_is_there) {
  for (const bool turned : {false, true}) {
    const auto at = [&](float x, float y, float z) { return turned ? glm::vec3(z, y, x) : glm::vec3(x, y, z); };
    Scene scene;
    scene.meshes = {small_world::ground(4, 0, false),
                    small_world::make_mesh({at(-1, 0, 0), at(1, 0, 0), at(1, 2, 0), at(-1, 2, 0)}, {{0, 1, 2}, {0, 2, 3}})};
    hand_made::Picture picture(2, 1);
    picture.set(0, at(0.25f, 2, -3), at(0, 0, 1), 0, 0);
    picture.set(1, at(0.25f, 2.0625f, -3), at(0, 0, 1), 0, 0);
    EXPECT_EQ(run(scene, hand_made::point_light(at(0.25f, 2, 3)), picture.gbuffer).mask[0], 0) << turned;
    EXPECT_EQ(run(scene, hand_made::point_light(at(0.25f, 2.0625f, 3)), picture.gbuffer).mask[1], 1) << turned;
  }
}

// A light on a corner, an edge and a face of a caster that is seen at all angles, and copies of the own triangle in one place:
// by exact signs nothing is on the way. Coordinates have so few digits that the middles are exact.
TEST_F(GlRays, what_touches_the_light_or_lies_in_the_own_plane_keeps_none_of_it_off) {
  Scene scene;
  const Mesh floor = small_world::ground(8);
  scene.meshes = {floor, floor,
                  small_world::make_mesh({{0.25f, 1.125f, 0.75f}, {2.75f, 1.875f, 0.125f}, {0.75f, 3, 2.125f}}, {{0, 1, 2}})};
  const std::vector<glm::vec3>& corners = scene.meshes[2].positions;
  hand_made::Picture picture(32, 32);
  Random random(9);
  for (std::size_t i = 0; i < picture.gbuffer.size(); ++i) {
    const glm::dvec3 place = random.uniform(glm::dvec3(-3, 0, -3), glm::dvec3(3, 0, 3));
    picture.set(i, glm::vec3(place), {0, 1, 0}, 0, place.z > place.x ? 0 : 1);
  }
  const glm::vec3 face = (corners[0] + corners[1] + corners[2]) / 3.0f;
  for (const glm::vec3& lamp : {corners[0], corners[1], corners[2], (corners[0] + corners[1]) / 2.0f, face}) {
    const Light light = hand_made::point_light(lamp);
    const auto exact = registry().technique("exact_rays").make();
    exact->build(scene);
    exact->relight(light);
    const std::vector<float> truth = small_world::mask_of(*exact, picture.gbuffer);
    EXPECT_GT(std::ranges::count(truth, 1.0f), 500) << lamp.x;
    EXPECT_EQ(run(scene, light, picture.gbuffer).mask, truth) << lamp.x;
  }
}

// On exact shapes the whole own mesh is left out, and triangles stand for the other ones.
TEST_F(GlRays, see_triangles_for_shapes_and_leave_out_the_own_one) {
  Scene scene;
  scene.meshes = {small_world::ground(3), tessellate(Sphere{{0, 1, 0}, 0.6f}, 128, "ball")};
  const Light light = hand_made::point_light({0.5f, 4, 0.3f});
  const shape_world::ShapeWorld world(std::move(scene), View{.eye = {3, 4, 5}, .target = {0, 0.5f, 0}}, 128, 96);
  const auto rays = run(world.scene, light, world.gbuffer);
  const std::vector<float> truth = world.reference(light);
  std::size_t differ = 0, on_ball = 0, dark = 0;
  for (std::size_t i = 0; i < truth.size(); ++i) {
    differ += rays.mask[i] != truth[i];
    on_ball += world.gbuffer.mesh[i] == 1 && rays.mask[i] != truth[i];
    dark += truth[i] == 0;
  }
  EXPECT_EQ(on_ball, 0u);
  EXPECT_LT(differ, dark / 20);
  EXPECT_GT(dark, 200u);
}

TEST_F(GlRays, answer_every_light_without_area) {
  const Scene scene = map_scenes::soup_over_ground(7);
  const GBuffer g = small_world::make_gbuffer(scene, View{.eye = {3, 5, 6}, .target = {0, 0.3f, 0}}, 96, 72);
  for (const Light& light : map_scenes::all_kinds) {
    const auto rays = run(scene, light, g);
    const std::vector<float> truth = reference(scene, light, g);
    for (std::size_t i = 0; i < truth.size(); ++i)
      if (rays.mask[i] != truth[i]) {
        EXPECT_TRUE(map_scenes::near_shadow_edge(scene, light, g.position(i), g.normal(i), 1e-5, truth[i] == 0))
            << light.name << ", pixel " << i;
      }
    std::size_t facing = 0;
    for (std::size_t i = 0; i < g.size(); ++i) facing += faces_light(scene, g, light, i);
    EXPECT_EQ(value(rays.technique->counts(), "rays"), static_cast<double>(facing)) << light.name;
  }
}

TEST_F(GlRays, share_the_tree_among_lights) {
  const Scene scene = map_scenes::soup_over_ground(7);
  const GBuffer g = small_world::make_gbuffer(scene, View{.eye = {3, 5, 6}, .target = {0, 0.3f, 0}}, 96, 72);
  const Light &first_light = map_scenes::all_kinds[0], &second_light = map_scenes::all_kinds[2];
  auto first = run(scene, first_light, g);
  const auto guest = first.technique->for_another_light();
  guest->relight(second_light);
  EXPECT_EQ(small_world::mask_of(*guest, g), run(scene, second_light, g).mask);
  EXPECT_EQ(small_world::mask_of(*first.technique, g), first.mask);
  // A number for each pixel is its own.
  EXPECT_EQ(value(guest->counts(), "bytes"), 4 * 96 * 72);
}

TEST_F(GlRays, after_an_update_answer_as_after_a_build) {
  using namespace walking_world;
  for (const std::string animation : {"lift", "walk"}) {
    Row row(animation);
    const auto rays = made("gl_rays", "", row.scene);
    for (const int frame : {0, 3, 8, 3}) {
      row.go_to(frame);
      rays->update(row.scene, row.posed.take_changes());
      const GBuffer g = row.picture();
      for (const Light& light : {row.point(), row.sun()}) {
        rays->relight(light);
        const std::vector<float> mask = small_world::mask_of(*rays, g);
        const auto fresh = made("gl_rays", "", row.scene);
        fresh->relight(light);
        EXPECT_EQ(mask, small_world::mask_of(*fresh, g)) << animation << ", frame " << frame << ", " << light.name;
        EXPECT_EQ(mask, reference(row.scene, light, g)) << animation << ", frame " << frame << ", " << light.name;
      }
    }
  }
}

TEST_F(GlRays, without_casters_all_is_lit) {
  Scene scene;
  scene.meshes = {small_world::ground(3, 0, false)};
  const GBuffer g = small_world::make_gbuffer(scene, View{.eye = {3, 5, 6}}, 32, 24);
  const auto rays = run(scene, map_scenes::all_kinds[0], g);
  EXPECT_EQ(rays.mask, std::vector<float>(g.size(), 1));
  EXPECT_EQ(value(rays.technique->counts(), "nodes"), 0);
}

// The ground and a box are 14 triangles and 27 nodes at most. Corners take 48 bytes a triangle, nodes 32, three numbers 12.
TEST_F(GlRays, count_rays_boxes_and_bytes) {
  Scene scene;
  scene.meshes = {small_world::ground(3), small_world::box({0, 1, 0}, {1, 2, 1})};
  const GBuffer g = small_world::make_gbuffer(scene, View{.eye = {3, 5, 6}}, 32, 24);
  const auto rays = run(scene, map_scenes::all_kinds[0], g);
  const Counts counts = rays.technique->counts();
  const double nodes = value(counts, "nodes");
  EXPECT_GE(nodes, 7);
  EXPECT_LE(nodes, 27);
  EXPECT_EQ(value(counts, "triangles"), 14);
  EXPECT_EQ(value(counts, "bytes"), 48 * 14 + 32 * nodes + 12 + 4 * 32 * 24);
  EXPECT_GE(value(counts, "boxes_per_ray"), 3) << "the root and its children";
  EXPECT_LE(value(counts, "boxes_per_ray"), nodes);
  const std::vector<float> layer = rays.technique->draw_debug("boxes");
  EXPECT_EQ(layer.size(), 3 * g.size());
}

TEST_F(GlRays, what_does_not_fit_is_refused_with_the_number) {
  Scene scene;
  scene.meshes = {small_world::ground(3), small_world::box({0, 1, 0}, {1, 2, 1})};
  const auto support = [&] {
    return registry().technique("gl_rays").make()->supports(scene, map_scenes::all_kinds[0], View());
  };
  const auto why = [&](const std::string& limits) {
    const LessOfTheDevice less(limits);
    return support().why();
  };
  EXPECT_EQ(why("compute_storage_blocks=5,storage_bindings=8,work_group_size=64,storage_block_bytes=16"), "");
  EXPECT_EQ(why("compute_storage_blocks=4"), "the OpenGL device has compute_storage_blocks = 4; 5 are needed");
  EXPECT_EQ(why("work_group_size=32"), "the OpenGL device has work_group_size = 32; 64 are needed");
  // Eight places of eight bytes in the box, four in the ground; 14 triangles of twelve bytes.
  scene.meshes[1].transmission = std::make_shared<const Transmission>(glm::vec3(0.5f));
  EXPECT_EQ(why("storage_block_bytes=168"), "");
  EXPECT_EQ(why("storage_block_bytes=167"), "the OpenGL device has storage_block_bytes = 167; 168 are needed");
  const Light lamp{.name = "lamp", .kind = DiscLight{.center = {0, 4, 0}}};
  EXPECT_EQ(registry().technique("gl_rays").make()->supports(scene, lamp, View()).why(),
            "one ray per pixel cannot see part of a light with area");
}

}  // namespace gl_rays_test
