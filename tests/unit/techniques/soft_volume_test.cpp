// What soft volumes say of each place of a light, against exact signs and shadow rays.
#include <gnomon/error.h>
#include <gnomon/kit/geometry/exact_scene.h>
#include <gnomon/kit/geometry/shapes.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>

#include "area_lights.h"
#include "exact_way.h"
#include "hard_scenes.h"
#include "measure/conformance/world.h"
#include "techniques/questions.h"

extern "C" void gnomon_technique_soft_volume(gnomon::Registry&);
extern "C" void gnomon_technique_area_rays(gnomon::Registry&);

namespace gnomon::soft_volume_test {

/// Points of all triangles, each side of them.
void scatter(const Scene& scene, Random& random, hand_made::Picture& picture) {
  hard_scenes::scatter(scene, {.name = "sun", .kind = DirectionalLight{glm::vec3(small_world::direction_of(random))}}, random,
                       picture);
}

/// Whether the point is so close to the plane of another caster that double takes it as in the plane, though it is not.
bool is_all_but_in_a_plane(const Scene& scene, const Receiver& receiver) {
  for (std::uint32_t m = 0; m < scene.meshes.size(); ++m)
    for (std::uint32_t t = 0; scene.meshes[m].casts && t < scene.meshes[m].triangles.size(); ++t) {
      const Triangle corners = scene.meshes[m].corners(t);
      const glm::dvec3 normal = glm::normalize(corners.normal()), a(corners.points[0]);
      const double height = glm::dot(normal, glm::dvec3(receiver.point) - a);
      if (std::abs(height) > 0x1p-46 * (extent(receiver.point) + extent(a))) continue;
      if (receiver.is_own(m, t) || receiver.is_coplanar(scene, corners.points)) continue;
      if (orient3d_sign(corners.points[0], corners.points[1], corners.points[2], receiver.point) != 0) return true;
    }
  return false;
}

struct Tally {
  std::size_t places = 0, wrong = 0, degenerate = 0;
  std::size_t penumbrae = 0, left_out = 0;  // pixels
};

/// Calls the exact judge for every place of every pixel.
void judge(const Scene& scene, const Light& light, const GBuffer& g, const std::string& settings, Tally& asked) {
  const small_world::Run run = small_world::run(gnomon_technique_soft_volume, settings, scene, light, g);
  for (std::size_t i = 0; i < g.size(); ++i) {
    if (!faces_light(scene, g, light, i)) {
      EXPECT_EQ(run.mask[i], 1);
      continue;
    }
    const Receiver receiver = receiver_at(scene, g, i);
    if (is_all_but_in_a_plane(scene, receiver)) {
      ++asked.left_out;
      continue;
    }
    const auto why = run.technique->explain(i);
    double seen = 0;
    for (const LightSample& sample : why->samples) {
      seen += sample.visibility * sample.weight;
      ++asked.places;
      const auto way = exact_way::way(scene, receiver, sample.place - glm::dvec3(receiver.point));
      if (way == exact_way::Way::degenerate) {
        ++asked.degenerate;
        continue;
      }
      if ((sample.visibility == 1) != (way == exact_way::Way::clear)) {
        if (asked.wrong++ < 5)
          ADD_FAILURE() << "pixel " << i << ", " << kind_name(light) << " light: the place " << sample.place.x << " "
                        << sample.place.y << " " << sample.place.z << " is said to be "
                        << (sample.visibility == 1 ? "seen" : "hidden");
      }
    }
    EXPECT_NEAR(run.mask[i], why->samples.empty() ? 1 : seen, 1e-6);
    asked.penumbrae += run.mask[i] > 0 && run.mask[i] < 1;
  }
}

/// Open and closed casters, on a grid or not: soups, boxes that lack faces or have some twice, cycles, fans, a floor.
Scene random_scene(int round, Random& random) {
  Scene scene;
  scene.meshes.push_back(hand_made::square(4, -2));
  switch (round % 4) {
    case 0:
      scene.meshes.push_back(hard_scenes::grid_soup(random, 12));
      break;
    case 1:
      scene.meshes.push_back(hard_scenes::boxes(random, 4, false));
      break;
    case 2:
      scene.meshes.push_back(hard_scenes::boxes(random, 4, true));
      break;
    default:
      scene.meshes.push_back(questions::hard_mesh(round / 4 % questions::kinds, round / 40, random));
  }
  return scene;
}

// Lights stand above casters, between them, in them and across them. GNOMON_PIXELS gives more places, GNOMON_SEED for
// others.
TEST(SoftVolume, every_place_of_random_scenes_is_what_exact_signs_say) {
  const char* wanted = std::getenv("GNOMON_PIXELS");
  const std::size_t least = wanted ? std::strtoull(wanted, nullptr, 10) : 90'000;
  const char* seed = std::getenv("GNOMON_SEED");
  Random random(seed ? std::strtoull(seed, nullptr, 10) : 22);
  Tally asked;
  for (int round = 0; asked.places < least; ++round) {
    const Scene scene = random_scene(round, random);
    hand_made::Picture picture(40, 3);
    scatter(scene, random, picture);
    judge(scene, random_light(random), picture.gbuffer, "samples=16", asked);
  }
  const std::string seen = fmt::format("{} places, {} wrong, {} degenerate, {} pixels in penumbra, {} left out", asked.places,
                                       asked.wrong, asked.degenerate, asked.penumbrae, asked.left_out);
  if (wanted) fmt::print("{}\n", seen);
  RecordProperty("seen", seen);
  EXPECT_EQ(asked.wrong, 0u);
  EXPECT_GT(asked.penumbrae, 800u);
  EXPECT_LT(asked.left_out, 10u + asked.places / 10'000);
  // Only places on a grid lie behind edges, and places of a light are random.
  EXPECT_LT(asked.degenerate, asked.places / 1'000);
}

// Rays start 5e-7 m and less above their surfaces and are traced in float32.
TEST(SoftVolume, at_most_one_place_in_100000_differs_from_a_ray_to_it_and_is_right) {
  Random random(5);
  std::mt19937 engine(5);
  std::size_t places = 0, differ = 0, wrong = 0, penumbrae = 0;
  for (int round = 0; round < 8; ++round) {
    const hard_scenes::Viewed viewed = hard_scenes::viewed(random, engine);
    const Light lights[] = {rect({1, 4, 2}, {0.8f, 0, 0.1f}, {0, 0.3f, 0.7f}), disc({-3, 3, 1}, {1, -1, 0}, 0.5f),
                            sphere({2, 4, -2}, 0.6f)};
    const Light& light = lights[round % 3];
    const GBuffer& g = viewed.gbuffer;
    const auto volume = small_world::run(gnomon_technique_soft_volume, "samples=32", viewed.scene, light, g),
               rays = small_world::run(gnomon_technique_area_rays, "samples=32", viewed.scene, light, g);
    for (std::size_t i = 0; i < g.size(); ++i) {
      const auto ours = volume.technique->explain(i), theirs = rays.technique->explain(i);
      ASSERT_EQ(ours->samples.size(), theirs->samples.size());
      penumbrae += volume.mask[i] > 0 && volume.mask[i] < 1;
      for (std::size_t k = 0; k < ours->samples.size(); ++k) {
        const LightSample &a = ours->samples[k], &b = theirs->samples[k];
        ASSERT_LT(glm::length(a.place - b.place), 1e-6);
        ++places;
        if (a.visibility == b.visibility) continue;
        ++differ;
        const Receiver receiver = receiver_at(viewed.scene, g, i);
        const auto way = exact_way::way(viewed.scene, receiver, a.place - glm::dvec3(receiver.point));
        wrong += (a.visibility == 1) != (way == exact_way::Way::clear);
      }
    }
  }
  RecordProperty("seen",
                 fmt::format("{} places, {} differ, {} wrong, {} pixels in penumbra", places, differ, wrong, penumbrae));
  EXPECT_GT(places, 1'000'000u);
  EXPECT_GT(penumbrae, 4'000u);
  EXPECT_LE(differ, places / 100'000);
  EXPECT_EQ(wrong, 0u);
}

// In every pattern the places are those of the rays: masks differ by no more than one place in 100,000.
TEST(SoftVolume, masks_are_those_of_area_rays_in_every_pattern) {
  for (const char* reference : {"box_city:count=12", "sphere_over_plane:segments=24"}) {
    const conformance::World world(conformance::generated_scene(reference), Truth::mesh);
    const GBuffer g = world.gbuffer(world.scene.views[0], 160, 90);
    const Light lights[] = {rect({-2, 9, 3}, {1.5f, 0, 0.2f}, {0, 0.3f, 1.5f}), disc({2, 6, 3}, {0, -1, 0.2f}, 1),
                            sphere({-2, 7, 1}, 1)};
    for (const char* pattern : {"random", "stratified", "low_discrepancy", "interleaved"}) {
      double places = 0, differ = 0;
      std::size_t penumbrae = 0;
      for (const Light& light : lights) {
        const std::string settings = fmt::format("samples=50,seed=7,pattern={}", pattern);
        const auto volume = small_world::run(gnomon_technique_soft_volume, settings, world.scene, light, g),
                   rays = small_world::run(gnomon_technique_area_rays, settings, world.scene, light, g);
        for (std::size_t i = 0; i < g.size(); ++i) {
          if (!faces_light(world.scene, g, light, i)) continue;
          places += 50;
          differ += 50 * std::abs(volume.mask[i] - rays.mask[i]);
          penumbrae += rays.mask[i] > 0 && rays.mask[i] < 1;
        }
      }
      RecordProperty(fmt::format("{}_{}", world.scene.name, pattern), fmt::format("{:.1f} of {}", differ, places));
      EXPECT_GT(places, 500'000) << reference;
      EXPECT_GT(penumbrae, 500u) << reference;
      EXPECT_LE(differ, 0.5 + places / 100'000) << reference << ' ' << pattern;
    }
  }
}

// Points are rounded by some 1e-7 m, triangles are 1e-3 m wide: their own edges pass at every distance of the point, whose own
// triangle faces it neither way.
TEST(SoftVolume, a_point_that_rounding_put_off_its_own_triangle_is_not_shaded_by_it) {
  Random random(4);
  Tally asked;
  for (int round = 0; round < 6; ++round) {
    Scene scene;
    for (int k = 0; k < 3; ++k)
      scene.meshes.push_back(tessellate(Sphere{{1.5f + 0.025f * static_cast<float>(k), 1.25f, -1.75f}, 0.02f}, 24, "ball"));
    hand_made::Picture picture(50, 10);
    scatter(scene, random, picture);
    judge(scene, rect({3, 1.5f, -1.5f}, {0, 0.4f, 0.1f}, {0, 0.1f, 0.4f}), picture.gbuffer, "samples=16", asked);
  }
  EXPECT_EQ(asked.wrong, 0u);
  EXPECT_GT(asked.places, 10'000u);
  EXPECT_GT(asked.penumbrae, 100u);
}

// The light as a point: of a rect of 2e-9 m all places are where its center is, but for points that see an edge of a caster
// there as closely.
TEST(SoftVolume, a_light_that_shrinks_to_a_point_gives_the_hard_mask) {
  Random random(9);
  std::mt19937 engine(9);
  std::size_t asked = 0, dark = 0;
  for (int round = 0; round < 6; ++round) {
    const hard_scenes::Viewed viewed = hard_scenes::viewed(random, engine);
    const glm::vec3 at(random.uniform({-3, 2, -3}, {3, 5, 3}));
    const Light point = hand_made::point_light(at);
    const ExactScene exact(viewed.scene);
    std::vector<float> hard(viewed.gbuffer.size());
    exact.decide(viewed.gbuffer, point, hard);
    for (const float size : {1e-9f, 1e-30f})
      for (const Light& light :
           {rect(at, {size, 0, 0}, {0, size / 2, size}), disc(at, {0, -1, 0.5f}, size), sphere(at, size)}) {
        const auto run = small_world::run(gnomon_technique_soft_volume, "samples=4", viewed.scene, light, viewed.gbuffer);
        for (std::size_t i = 0; i < hard.size(); ++i) {
          if (!faces_light(viewed.scene, viewed.gbuffer, light, i) || !faces_light(viewed.scene, viewed.gbuffer, point, i))
            continue;
          const Receiver receiver = receiver_at(viewed.scene, viewed.gbuffer, i);
          if (exact.edge_margin(receiver, homogeneous(point), 1e-7).clearance < 1e-7) continue;
          ++asked;
          dark += hard[i] == 0;
          ASSERT_EQ(run.mask[i], hard[i]) << "pixel " << i << ", " << kind_name(light) << " of " << size << " m";
        }
      }
  }
  EXPECT_GT(asked, 100'000u);
  EXPECT_GT(dark, asked / 10);
}

// A square light of 0.6 m at height 4 over an edge at height 1: see area_maps_test. Of 1,024 places spread evenly, those
// between the edge and its true place are off by a few.
TEST(SoftVolume, one_straight_edge_gives_the_penumbra_of_closed_form) {
  Scene scene;
  scene.meshes = {small_world::ground(4),
                  small_world::make_mesh({{-3, 1, -3}, {-3, 1, 3}, {0, 1, 3}, {0, 1, -3}}, {{0, 1, 2}, {0, 2, 3}})};
  hand_made::Picture picture(80, 1);
  for (std::size_t i = 0; i < 80; ++i) picture.set(i, {(static_cast<float>(i) - 40) / 200, 0, 0.3f}, {0, 1, 0}, 0, 0);
  const auto run = small_world::run(gnomon_technique_soft_volume, "samples=1024", scene,
                                    rect({0, 4, 0}, {0.3f, 0, 0}, {0, 0, 0.3f}), picture.gbuffer);
  for (std::size_t i = 0; i < 80; ++i)
    EXPECT_NEAR(run.mask[i], std::clamp((0.3 + 3 * (static_cast<double>(i) - 40) / 200) / 0.6, 0.0, 1.0), 0.004) << i;
}

/// One point of the ground under casters.
float at_origin(const std::vector<Mesh>& casters, const Light& light) {
  Scene scene;
  scene.meshes = {small_world::ground(4)};
  scene.meshes.insert(scene.meshes.end(), casters.begin(), casters.end());
  hand_made::Picture picture(1, 1);
  picture.set(0, {0, 0, 0}, {0, 1, 0}, 0, 0);
  return small_world::run(gnomon_technique_soft_volume, "samples=1024", scene, light, picture.gbuffer).mask[0];
}

TEST(SoftVolume, a_caster_in_the_plane_of_the_light_hides_nothing) {
  const Light level = rect({0, 3, 0}, {1, 0, 0}, {0, 0, 1});
  EXPECT_EQ(at_origin({hand_made::square(5, 3)}, level), 1);
  EXPECT_EQ(at_origin({hand_made::square(0.5f, 3)}, level), 1);
  // Tilted: on its plane but for what double makes of it.
  const Light tilted = rect({0.25f, 3, 0}, {0.5f, 0.25f, 0}, {0, 0.25f, 1});
  EXPECT_EQ(at_origin({small_world::make_mesh({{0.25f, 3, 0}, {0.75f, 3.25f, 0}, {0.25f, 3.25f, 1}}, {{0, 1, 2}})}, tilted), 1);
  // A hair below it, it hides what it covers.
  EXPECT_EQ(at_origin({hand_made::square(5, 2.9999f)}, level), 0);
}

// A plate stands upright in the light, at x = 0: its lower part, below the light, is edge-on to the origin. Moved to x = 0.5 it
// hides what is behind it, x > 0.5: a quarter of the light.
TEST(SoftVolume, a_caster_across_the_light_hides_what_is_behind_its_near_part) {
  const Light level = rect({0, 3, 0}, {1, 0, 0}, {0, 0, 1});
  const auto plate = [](float x) {
    return small_world::make_mesh({{x, 2, -5}, {x, 2, 5}, {x, 4, 5}, {x, 4, -5}}, {{0, 1, 2}, {0, 2, 3}});
  };
  EXPECT_EQ(at_origin({plate(0)}, level), 1);
  // From the origin the plate's lower edge, at height 2, lies before x = 0.75 of the light: what is between is hidden.
  EXPECT_NEAR(at_origin({plate(0.5f)}, level), 1 - 0.25 / 2, 0.004);
}

// Slivers, triangles of no area and stacks of copies are nothing special.
TEST(SoftVolume, degenerate_and_doubled_triangles_change_nothing) {
  const Light light = rect({0, 3, 0}, {1, 0, 0}, {0, 0, 1});
  const std::vector<glm::vec3> corners{{-1, 1, -9}, {-1, 1, 9}, {0, 1, 9}, {0, 1, -9}, {0, 1, 0}, {-0.5f, 1, 0}};
  const float plain = at_origin({small_world::make_mesh(corners, {{0, 1, 2}, {0, 2, 3}})}, light);
  EXPECT_NEAR(plain, 0.5, 0.004);
  EXPECT_EQ(
      at_origin({small_world::make_mesh(corners, {{0, 1, 2}, {0, 2, 3}, {0, 1, 2}, {2, 1, 0}, {3, 4, 2}, {3, 3, 2}})}, light),
      plain);
}

TEST(SoftVolume, refuses_a_million_places_and_lights_without_area) {
  Registry registry;
  gnomon_technique_soft_volume(registry);
  const auto technique = registry.techniques()[0].make();
  try {
    technique->apply("samples=1000000");
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(std::string(error.what()), "soft_volume.samples = 1000000 is outside 1 .. 4096 place");
  }
  EXPECT_FALSE(technique->supports({}, hand_made::point_light({0, 1, 0}), {}));
}

}  // namespace gnomon::soft_volume_test
