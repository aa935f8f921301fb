// Crow's count against the exact oracle on scenes that are hard on counting.
#include <gnomon/kit/exact_scene.h>
#include <gnomon/kit/random.h>
#include <gnomon/kit/shapes.h>
#include <gnomon/registry.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "hand_made.h"
#include "hard_scenes.h"
#include "small_world.h"

extern "C" void gnomon_technique_crow_counting(gnomon::Registry& registry);

namespace gnomon {
namespace {

using namespace hand_made;
using namespace hard_scenes;
using small_world::value;

small_world::Run run(const Scene& scene, const Light& light, const GBuffer& gbuffer) {
  return small_world::run(gnomon_technique_crow_counting, "", scene, light, gbuffer);
}

struct Differences {
  int wrong = 0, dark = 0, lit = 0, degenerate = 0;
  double restarts = 0, eye_inside = 0, touching = 0;
};

/// Counts pixels that the oracle decides otherwise; where it is degenerate anything goes.
void compare(const Scene& scene, const Light& light, const GBuffer& gbuffer, Differences& d) {
  const auto done = run(scene, light, gbuffer);
  const ExactScene exact(scene);
  for (std::size_t i = 0; i < gbuffer.size(); ++i) {
    if (!faces_light(scene, gbuffer, light, i)) {
      ASSERT_EQ(done.mask[i], 1);
      continue;
    }
    ExactTally tally;
    const ExactAnswer answer = exact.occluded(receiver_at(scene, gbuffer, i), homogeneous(light), tally);
    if (answer.degenerate) {
      ++d.degenerate;
      continue;
    }
    ++(answer.blocked ? d.dark : d.lit);
    if ((done.mask[i] == 0) != answer.blocked && d.wrong++ == 0) {
      const glm::vec3 p = gbuffer.position(i);
      ADD_FAILURE() << "pixel " << i << " of mesh " << gbuffer.mesh[i] << ", triangle " << gbuffer.triangle[i] << " at " << p.x
                    << ", " << p.y << ", " << p.z << " should be " << (answer.blocked ? "dark" : "lit");
    }
  }
  const Counts counts = done.technique->counts();
  d.restarts += value(counts, "restarts");
  d.touching += value(counts, "degenerate_rays");
  d.eye_inside += value(counts, "volumes_at_eye") > 0;
}

// Eyes on the same grid stand on side planes, on triangles, inside bodies and volumes.
TEST(CrowCounting, decides_as_the_oracle_does_on_soups) {
  Random random(5);
  Differences d;
  for (int round = 0; round < 150; ++round) {
    Scene scene;
    scene.meshes = {grid_soup(random, 1 + round % 40), grid_soup(random, 5)};
    scene.meshes[1].casts = random.below(2);
    const Light light = hard_light(random);
    Picture picture(40, 20);
    picture.gbuffer.view.eye = on_grid(random, 4, 32);
    scatter(scene, light, random, picture);
    SCOPED_TRACE(round);
    compare(scene, light, picture.gbuffer, d);
  }
  EXPECT_EQ(d.wrong, 0);
  EXPECT_GT(d.dark, 10'000);
  EXPECT_GT(d.lit, 10'000);
  EXPECT_GT(d.restarts, 30);
  EXPECT_GT(d.eye_inside, 10);
  RecordProperty("pixels", fmt::format("{} dark, {} lit, {} degenerate, {} restarts, {} touching", d.dark, d.lit, d.degenerate,
                                       d.restarts, d.touching));
}

TEST(CrowCounting, decides_as_the_oracle_does_on_boxes) {
  Random random(6);
  Differences d;
  for (int round = 0; round < 150; ++round) {
    Scene scene;
    scene.meshes = {boxes(random, 1 + round % 12, round % 2), boxes(random, 2, true), square(6, -2)};
    const Light light = hard_light(random);
    Picture picture(40, 20);
    picture.gbuffer.view.eye = on_grid(random, 4, 32);
    scatter(scene, light, random, picture);
    SCOPED_TRACE(round);
    compare(scene, light, picture.gbuffer, d);
  }
  EXPECT_EQ(d.wrong, 0);
  EXPECT_GT(d.dark, 10'000);
  EXPECT_GT(d.lit, 10'000);
  EXPECT_GT(d.restarts, 30);
  EXPECT_GT(d.eye_inside, 10);
  RecordProperty("pixels", fmt::format("{} dark, {} lit, {} degenerate, {} restarts, {} touching", d.dark, d.lit, d.degenerate,
                                       d.restarts, d.touching));
}

// As pictures are: points where the eye's rays meet the scene. The picture is larger than a few tiles, and not a multiple.
TEST(CrowCounting, decides_as_the_oracle_does_in_pictures) {
  std::mt19937 engine(7);
  Random random(7);
  Differences d;
  for (int round = 0; round < 12; ++round) {
    SCOPED_TRACE(round);
    const auto [scene, gbuffer, lights] = hard_scenes::viewed(random, engine);
    for (const Light& light : lights) compare(scene, light, gbuffer, d);
  }
  EXPECT_EQ(d.wrong, 0);
  EXPECT_GT(d.dark, 10'000);
  EXPECT_GT(d.lit, 10'000);
  RecordProperty("pixels", fmt::format("{} dark, {} lit, {} degenerate, {} restarts, {} touching", d.dark, d.lit, d.degenerate,
                                       d.restarts, d.touching));
}

// Points of a ball's triangles, on their edges but for rounding. Some are behind their own triangle and outside of the ball, so
// that a triangle turned away from the light, which has no volume, blocks theirs.
TEST(CrowCounting, a_point_that_rounding_puts_out_of_a_body_beside_its_edge_is_dark) {
  Scene scene;
  scene.meshes = {tessellate(Sphere{{0.25f, 0.5f, 0}, 1}, 6, "ball")};
  Mesh& ball = scene.meshes[0];
  ball.shape.reset();
  Random random(10);
  Picture picture(100, 50);
  picture.gbuffer.view.eye = {1, 3, 7};
  for (std::size_t i = 0; i < picture.gbuffer.size(); ++i) {
    const std::uint32_t t = random.below(static_cast<std::uint32_t>(ball.triangles.size())), k = random.below(3);
    const Triangle own = ball.corners(t);
    const glm::dvec3 a(own.points[k]), b(own.points[(k + 1) % 3]);
    picture.set(i, a + random.uniform(0, 1) * (b - a), glm::normalize(own.normal()), 0, t);
  }
  int out = 0;
  for (const Light& light :
       {point_light({-7, 5, 0}), sun({-4, -2.5f, -4}), sun({-0.5f, -3, 3.5f}), point_light({-3, -4, -4})}) {
    Differences d;
    compare(scene, light, picture.gbuffer, d);
    EXPECT_EQ(d.wrong, 0);
    EXPECT_GT(d.lit, 1000);
    out += d.dark;
  }
  EXPECT_GT(out, 50);
}

// Points on the true sphere lie outside its triangles, and behind the planes of those that turn away; a body that is convex
// shades none of its points that face the light. Its shadow on the floor, and a plate's shadow on it, remain.
TEST(CrowCounting, an_exact_shape_is_not_shaded_by_its_own_triangles) {
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
  for (const glm::vec3& eye : {glm::vec3(4, 3, 1), glm::vec3(0.1f, -0.2f, 0), glm::vec3(0.3f, -1.2f, 0.2f)}) {
    picture.gbuffer.view.eye = eye;
    Differences d;
    compare(scene, light, picture.gbuffer, d);
    EXPECT_EQ(d.wrong, 0);
    EXPECT_GT(d.dark, 100);
    EXPECT_GT(d.lit, 2000);
    scene.meshes[2].casts = false;
    const auto done = run(scene, light, picture.gbuffer);
    EXPECT_EQ(std::count(done.mask.begin(), done.mask.begin() + 10'000, 1.0f), 10'000);
    EXPECT_GT(std::count(done.mask.begin() + 10'000, done.mask.end(), 0.0f), 10);
    scene.meshes[2].casts = true;
  }
}

}  // namespace
}  // namespace gnomon
