// The alias-free map against the exact oracle on scenes that are hard on it, whatever its resolution and the threads.
#include <gnomon/kit/exact_scene.h>
#include <gnomon/kit/random.h>
#include <gnomon/kit/shapes.h>
#include <gnomon/registry.h>
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <cmath>

#include "hand_made.h"
#include "hard_scenes.h"
#include "small_world.h"

extern "C" void gnomon_technique_alias_free_map(gnomon::Registry& registry);

namespace gnomon {
namespace {

using namespace hand_made;
using hard_scenes::boxes;
using hard_scenes::grid_soup;
using hard_scenes::on_grid;
using small_world::value;

small_world::Run run(const Scene& scene, const Light& light, const GBuffer& gbuffer, const std::string& settings = "") {
  return small_world::run(gnomon_technique_alias_free_map, settings, scene, light, gbuffer);
}

/// A point light, a spot or a sun, on a grid: in supporting planes of triangles, along axes, inside bodies, between casters.
Light hard_light(Random& random) {
  for (;;) {
    const glm::vec3 at = on_grid(random, 4, 16);
    if (at == glm::vec3(0)) continue;
    switch (random.below(3)) {
      case 0:
        return {.name = "spot", .kind = SpotLight{at, -at, 20, 10.0f + static_cast<float>(random.below(70))}};
      case 1:
        return sun(at);
      default:
        return point_light(random.below(2) ? at : 0.25f * at);
    }
  }
}

struct Differences {
  int wrong = 0, dark = 0, lit = 0, degenerate = 0;
  double exact = 0;
};

/// Counts pixels that the oracle decides otherwise. Degenerate answers are alike too: edges and vertices block in both.
void compare(const Scene& scene, const Light& light, const GBuffer& gbuffer, const std::string& settings, Differences& d) {
  const auto done = run(scene, light, gbuffer, settings);
  const ExactScene exact(scene);
  for (std::size_t i = 0; i < gbuffer.size(); ++i) {
    if (!faces_light(scene, gbuffer, light, i)) {
      ASSERT_EQ(done.mask[i], 1);
      continue;
    }
    ExactTally tally;
    const ExactAnswer answer = exact.occluded(receiver_at(scene, gbuffer, i), homogeneous(light), tally);
    d.degenerate += answer.degenerate;
    ++(answer.blocked ? d.dark : d.lit);
    if ((done.mask[i] == 0) != answer.blocked && d.wrong++ == 0) {
      const glm::vec3 p = gbuffer.position(i);
      ADD_FAILURE() << "pixel " << i << " of mesh " << gbuffer.mesh[i] << ", triangle " << gbuffer.triangle[i] << " at " << p.x
                    << ", " << p.y << ", " << p.z << " should be " << (answer.blocked ? "dark" : "lit");
    }
    if (!answer.blocked) continue;
    // What is named does shade the point.
    std::uint64_t named = done.technique->explain(i)->element.value();
    std::size_t m = 0;
    while (named >= scene.meshes[m].triangles.size()) named -= scene.meshes[m++].triangles.size();
    const glm::uvec3& corner = scene.meshes[m].triangles[named];
    const auto& positions = scene.meshes[m].positions;
    const Triangle triangle{{positions[corner.x], positions[corner.y], positions[corner.z]}};
    ASSERT_NE(crosses({gbuffer.position(i), homogeneous(light)}, triangle), Crossing::none);
  }
  d.exact += value(done.technique->counts(), "exact_tests");
}

/// Points of all triangles, rounded, turned to the light. Shares in sixteenths put many of them exactly on edges and on planes
/// of other triangles. Every eighth is aimed: behind an end or the middle of some edge, which is exact where the scene is on a
/// grid.
void scatter(const Scene& scene, const Light& light, Random& random, Picture& picture) {
  for (std::size_t i = 0; i < picture.gbuffer.size(); ++i) {
    const std::uint32_t m = random.below(static_cast<std::uint32_t>(scene.meshes.size()));
    const Mesh& mesh = scene.meshes[m];
    if (mesh.triangles.empty()) continue;
    std::uint32_t t = random.below(static_cast<std::uint32_t>(mesh.triangles.size()));
    const glm::uvec3& corners = mesh.triangles[t];
    const glm::dvec3 a(mesh.positions[corners.x]), b(mesh.positions[corners.y]), c(mesh.positions[corners.z]);
    const bool coarse = random.below(2);
    const double u = coarse ? random.below(17) / 16.0 : random.uniform(0, 1),
                 v = (coarse ? random.below(17) / 16.0 : random.uniform(0, 1)) * (1 - u);
    glm::vec3 p(a + u * (b - a) + v * (c - a));
    if (i % 8 == 0) {
      const glm::dvec3 edge = random.below(2) ? a : (a + b) / 2.0;
      p = edge - (1 + random.below(4)) / 2.0 * to_light(homogeneous(light), edge);
      t = random.below(static_cast<std::uint32_t>(mesh.triangles.size()));
    }
    glm::dvec3 n = glm::normalize(glm::cross(b - a, c - a));
    if (glm::dot(n, to_light(homogeneous(light), p)) < 0) n = -n;
    picture.set(i, p, n, m, t);
  }
}

std::string resolution(Random& random) { return fmt::format("resolution={}", 16 << random.below(7)); }

TEST(AliasFreeMap, decides_as_the_oracle_does_on_soups) {
  Random random(5);
  Differences d;
  for (int round = 0; round < 300; ++round) {
    Scene scene;
    scene.meshes = {grid_soup(random, 1 + round % 40), grid_soup(random, 5)};
    scene.meshes[1].casts = random.below(2);
    const Light light = hard_light(random);
    Picture picture(40, 20);
    scatter(scene, light, random, picture);
    SCOPED_TRACE(round);
    compare(scene, light, picture.gbuffer, resolution(random), d);
  }
  EXPECT_EQ(d.wrong, 0);
  EXPECT_GT(d.dark, 20'000);
  EXPECT_GT(d.lit, 20'000);
  EXPECT_GT(d.degenerate, 500);
  EXPECT_GT(d.exact, 5000);
  RecordProperty("pixels", fmt::format("{} dark, {} lit, {} degenerate, {} exact", d.dark, d.lit, d.degenerate, d.exact));
}

TEST(AliasFreeMap, decides_as_the_oracle_does_on_boxes) {
  Random random(6);
  Differences d;
  for (int round = 0; round < 200; ++round) {
    Scene scene;
    scene.meshes = {boxes(random, 1 + round % 12, round % 2), boxes(random, 2, true), square(6, -2)};
    const Light light = hard_light(random);
    Picture picture(40, 20);
    scatter(scene, light, random, picture);
    SCOPED_TRACE(round);
    compare(scene, light, picture.gbuffer, resolution(random), d);
  }
  EXPECT_EQ(d.wrong, 0);
  EXPECT_GT(d.dark, 20'000);
  EXPECT_GT(d.lit, 10'000);
  EXPECT_GT(d.degenerate, 500);
  EXPECT_GT(d.exact, 5000);
  RecordProperty("pixels", fmt::format("{} dark, {} lit, {} degenerate, {} exact", d.dark, d.lit, d.degenerate, d.exact));
}

// Three bars, each over the next one: no order of them is right for all points.
TEST(AliasFreeMap, decides_as_the_oracle_does_on_cyclic_overlap) {
  std::vector<glm::vec3> positions;
  std::vector<glm::uvec3> triangles;
  for (int k = 0; k < 3; ++k) {
    const double turn = 2 * 3.14159265358979 / 3 * k;
    const auto at = [&](double x, double y, double z) {
      return glm::vec3(std::cos(turn) * x - std::sin(turn) * z, y, std::sin(turn) * x + std::cos(turn) * z);
    };
    const auto base = static_cast<std::uint32_t>(positions.size());
    positions.insert(positions.end(), {at(-2, 1, 0.5), at(-2, 1, 0.9), at(2, 2, 0.9), at(2, 2, 0.5)});
    triangles.insert(triangles.end(), {{base, base + 1, base + 2}, {base, base + 2, base + 3}});
  }
  Scene scene;
  scene.meshes = {mesh_of(positions, triangles), square(4, 0)};
  Random random(9);
  Differences d;
  for (const Light& light :
       {point_light({0.2f, 5, 0.1f}), sun({0.1f, -1, 0.05f}), point_light({0.1f, 1.5f, 0}), sun({1, -0.2f, 0})}) {
    Picture picture(80, 60);
    scatter(scene, light, random, picture);
    compare(scene, light, picture.gbuffer, "", d);
  }
  EXPECT_EQ(d.wrong, 0);
  EXPECT_GT(d.dark, 1000);
  EXPECT_GT(d.lit, 1000);
}

/// Pictures as the eye sees them, with a light among the casters in every second one.
template <class Visit>
void for_pictures(int rounds, Visit&& visit) {
  std::mt19937 engine(7);
  Random random(7);
  for (int round = 0; round < rounds; ++round) {
    Scene scene;
    scene.meshes = {small_world::ground(3, 0), small_world::random_soup(engine, 60, 2, 0.1f, 2, 0.4f), boxes(random, 5, false)};
    const View view{.eye = glm::vec3(random.uniform(glm::dvec3(-4, 0.5, -4), glm::dvec3(4, 4, 4))), .target = {0, 0.5f, 0}};
    const GBuffer gbuffer = small_world::make_gbuffer(scene, view, 150, 83);
    const glm::vec3 up(random.uniform(glm::dvec3(-3, 2, -3), glm::dvec3(3, 5, 3)));
    for (const Light& light : {point_light(round % 2 ? 0.3f * up : up), sun(-up)}) {
      SCOPED_TRACE(round);
      visit(scene, light, gbuffer);
    }
  }
}

// The light is 2^-56 m off the plane of the triangle around it, which so shades half of space. In double the light's faces see
// the triangle as a line through themselves, and a clip to a face leaves nothing of it, or little.
TEST(AliasFreeMap, a_triangle_that_all_but_holds_the_light_shades_half_of_space) {
  Scene scene;
  scene.meshes = {mesh_of({{0.25f, -0.5f, 0}, {0.25f, 0.5f, -1}, {1.25f, 0.5f, 0x1p-54f}}, {{0, 1, 2}}),
                  tessellate(Sphere{{0.25f, 0.5f, 0}, 3}, 12, "room"), square(6, -2)};
  scene.meshes[1].shape.reset();
  scene.meshes[1].casts = false;
  const Light light = point_light({0.5f, 0, -0.25f});
  Random random(12);
  Picture picture(100, 20);
  scatter(scene, light, random, picture);
  Differences d;
  compare(scene, light, picture.gbuffer, "", d);
  EXPECT_EQ(d.wrong, 0);
  EXPECT_GT(d.dark, 500);
  EXPECT_GT(d.lit, 500);
}

TEST(AliasFreeMap, decides_as_the_oracle_does_in_pictures) {
  Differences d;
  for_pictures(12,
               [&](const Scene& scene, const Light& light, const GBuffer& gbuffer) { compare(scene, light, gbuffer, "", d); });
  EXPECT_EQ(d.wrong, 0);
  EXPECT_GT(d.dark, 10'000);
  EXPECT_GT(d.lit, 10'000);
  RecordProperty("pixels", fmt::format("{} dark, {} lit, {} degenerate, {} exact", d.dark, d.lit, d.degenerate, d.exact));
}

// More cells leave fewer samples to test, and never another answer.
TEST(AliasFreeMap, all_resolutions_agree) {
  for_pictures(3, [](const Scene& scene, const Light& light, const GBuffer& gbuffer) {
    const auto expected = run(scene, light, gbuffer);
    double before = INFINITY;
    for (const int resolution : {16, 17, 100, 333, 1024, 4096}) {
      const auto done = run(scene, light, gbuffer, fmt::format("resolution={}", resolution));
      EXPECT_EQ(done.mask, expected.mask) << resolution;
      const double tests = value(done.technique->counts(), "sample_tests");
      if (resolution == 16 || resolution == 100 || resolution == 1024) {
        EXPECT_LT(tests, before);
        before = tests;
      }
    }
  });
}

TEST(AliasFreeMap, one_thread_and_many_agree) {
  for_pictures(3, [](const Scene& scene, const Light& light, const GBuffer& gbuffer) {
    const auto answer = [&](std::size_t threads) {
      const tbb::global_control control(tbb::global_control::max_allowed_parallelism, threads);
      return run(scene, light, gbuffer);
    };
    const auto one = answer(1), many = answer(8);
    EXPECT_EQ(one.mask, many.mask);
    const Counts counts = one.technique->counts(), others = many.technique->counts();
    for (std::size_t k = 0; k < counts.size(); ++k)
      if (counts[k].name != "bytes") {
        EXPECT_EQ(counts[k].value, others[k].value) << counts[k].name;
      }
    for (std::size_t i = 0; i < gbuffer.size(); ++i) {
      const auto why = one.technique->explain(i), other = many.technique->explain(i);
      ASSERT_EQ(why.has_value(), other.has_value());
      if (!why) continue;
      ASSERT_EQ(why->element, other->element) << i;
    }
    for (const auto& layer : one.technique->debug_layers())
      EXPECT_EQ(one.technique->draw_debug(layer.name), many.technique->draw_debug(layer.name));
  });
}

// Points on a true sphere, drawn smaller than its triangles so that these are before every one of them: they are shaded by
// other meshes only.
TEST(AliasFreeMap, an_exact_shape_is_not_shaded_by_its_own_triangles) {
  Scene scene;
  scene.meshes = {tessellate(Sphere{{0, 0, 0}, 1}, 12, "sphere"), square(4, -1.5f), square(0.4f, 3)};
  scene.meshes[0].shape = Sphere{{0, 0, 0}, 0.75f};
  Picture picture(100, 102, Truth::shape);
  Random random(4);
  const Light light = point_light({0.3f, 6, -0.2f});
  for (std::size_t i = 0; i < picture.gbuffer.size(); ++i) {
    const glm::vec3 n(glm::normalize(random.uniform(glm::dvec3(-1), glm::dvec3(1))));
    const float x = static_cast<float>(random.uniform(-3, 3)), z = static_cast<float>(random.uniform(-3, 3));
    if (i < 10'000)
      picture.set(i, 0.75f * n, n, 0, 0);
    else
      picture.set(i, {x, -1.5f, z}, {0, 1, 0}, 1, z > x ? 0 : 1);
  }
  Differences d;
  compare(scene, light, picture.gbuffer, "", d);
  EXPECT_EQ(d.wrong, 0);
  EXPECT_GT(d.dark, 100);
  EXPECT_GT(d.lit, 1000);
  scene.meshes[2].casts = false;
  const auto done = run(scene, light, picture.gbuffer);
  EXPECT_EQ(std::count(done.mask.begin(), done.mask.begin() + 10'000, 1.0f), 10'000);
  EXPECT_GT(std::count(done.mask.begin() + 10'000, done.mask.end(), 0.0f), 10);
}

}  // namespace
}  // namespace gnomon
