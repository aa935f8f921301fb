// Every exact technique decides as the exact oracle does, on random scenes that are hard on one or the other.
#include "exact_oracle_rig.h"
#include "exact_techniques.h"
#include "mixed_scene.h"

namespace gnomon::exact_oracle::exact_oracle_test {

using hand_made::Picture;
using hand_made::square;
using hard_scenes::boxes;
using hard_scenes::cycle;
using hard_scenes::grid_soup;
using hard_scenes::on_grid;

INSTANTIATE_TEST_SUITE_P(All, ExactOracle, testing::ValuesIn(exact_techniques()),
                         [](const auto& info) { return info.param.id(); });

/// A point light, a spot or a sun, on a grid: in supporting planes of triangles, along axes, inside bodies, between casters.
Light hard_light(Random& random) {
  for (;;) {
    const glm::vec3 at = on_grid(random, 4, 16);
    if (at == glm::vec3(0)) continue;
    switch (random.below(3)) {
      case 0:
        return {.name = "spot", .kind = SpotLight{at, -at, 20, 10.0f + static_cast<float>(random.below(70))}};
      case 1:
        return hand_made::sun(at);
      default:
        return hand_made::point_light(random.below(2) ? at : 0.25f * at);
    }
  }
}

/// As hard_scenes::scatter does, and every eighth is aimed: behind an end or the middle of some edge, which is exact where the
/// scene is on a grid.
void scatter_and_aim(const Scene& scene, const Light& light, Random& random, Picture& picture) {
  hard_scenes::scatter(scene, light, random, picture);
  for (std::size_t i = 0; i < picture.gbuffer.size(); i += 8) {
    if (picture.gbuffer.is_background(i)) continue;
    const Mesh& mesh = scene.meshes[picture.mesh[i]];
    const Triangle triangle = mesh.corners(picture.triangle[i]);
    const glm::dvec3 a(triangle.points[0]), b(triangle.points[1]);
    const glm::dvec3 edge = random.below(2) ? a : (a + b) / 2.0;
    const glm::vec3 p(edge - (1 + random.below(4)) / 2.0 * to_light(homogeneous(light), edge));
    glm::dvec3 n = glm::normalize(triangle.normal());
    if (glm::dot(n, to_light(homogeneous(light), p)) < 0) n = -n;
    picture.set(i, p, n, picture.mesh[i], random.below(static_cast<std::uint32_t>(mesh.triangles.size())));
  }
}

/// Points on a grid meet what is rare elsewhere.
void expect_rare_work(const std::string& id, const Agreement& sum) {
  EXPECT_GT(sum.degenerate, 500);
  if (id == "alias_free_map") {
    EXPECT_GT(sum.counts.at("exact_tests"), 5'000);
  }
  if (id == "crow_counting") {
    EXPECT_GT(sum.counts.at("restarts"), 30);
    EXPECT_GT(sum.runs_that_count.at("volumes_at_eye"), 10);
  }
}

// Eyes on the same grid stand on side planes, on triangles, inside bodies and volumes.
TEST_P(ExactOracle, decides_as_the_oracle_does_on_soups) {
  Random random(5);
  Agreement sum;
  for (int round = 0; round < 300; ++round) {
    SCOPED_TRACE(round);
    Scene scene;
    scene.meshes = {grid_soup(random, 1 + round % 60), grid_soup(random, 5)};
    scene.meshes[1].casts = random.below(2);
    const Light light = hard_light(random);
    Picture picture(40, 20);
    picture.gbuffer.view.eye = on_grid(random, 4, 32);
    scatter_and_aim(scene, light, random, picture);
    compare(GetParam().settings_in(round), scene, light, picture.gbuffer, sum);
  }
  expect_agreement(sum, 25'000, 25'000);
  expect_rare_work(GetParam().id(), sum);
}

TEST_P(ExactOracle, decides_as_the_oracle_does_on_boxes_and_cycles) {
  Random random(6);
  Agreement sum;
  for (int round = 0; round < 200; ++round) {
    SCOPED_TRACE(round);
    Scene scene;
    scene.meshes = {boxes(random, 1 + round % 12, round % 2), boxes(random, 2, true), square(6, -2), cycle(2, 1.5f)};
    const Light light = hard_light(random);
    Picture picture(40, 20);
    picture.gbuffer.view.eye = on_grid(random, 4, 32);
    scatter_and_aim(scene, light, random, picture);
    compare(GetParam().settings_in(round), scene, light, picture.gbuffer, sum);
  }
  expect_agreement(sum, 20'000, 12'000);
  expect_rare_work(GetParam().id(), sum);
}

TEST_P(ExactOracle, decides_as_the_oracle_does_on_mixed_scenes) {
  Random random(21);
  std::mt19937 engine(21);
  Agreement sum;
  for (int round = 0; round < 48; ++round) {
    SCOPED_TRACE(round);
    const Scene scene = mixed_scene(random, engine, round);
    const Light light = hard_scenes::hard_light(random);
    Picture picture(60, 40);
    hard_scenes::scatter(scene, light, random, picture);
    compare(GetParam().settings_in(round / mixed_kinds), scene, light, picture.gbuffer, sum);
  }
  expect_agreement(sum, 20'000, 20'000);
  if (GetParam().id() == "two_pass_object") {  // a third of the points lie on a grid, on borders on purpose
    EXPECT_LT(sum.counts.at("points_asked"), 0.2 * sum.counts.at("point_locations"));
  }
}

// As pictures are: points where the eye's rays meet the scene; a picture that is not a multiple of a tile.
TEST_P(ExactOracle, decides_as_the_oracle_does_in_pictures) {
  std::mt19937 engine(7);
  Random random(7);
  Agreement sum;
  for (int round = 0; round < 12; ++round) {
    SCOPED_TRACE(round);
    const auto [scene, gbuffer, lights] = hard_scenes::viewed(random, engine);
    for (const Light& light : lights) compare(defaults, scene, light, gbuffer, sum);
  }
  expect_agreement(sum, 50'000, 50'000);
  if (GetParam().id() == "two_pass_object") {  // pieces decide nearly all
    EXPECT_LT(sum.counts.at("points_asked"), 0.001 * sum.counts.at("point_locations"));
  }
}

}  // namespace gnomon::exact_oracle::exact_oracle_test
