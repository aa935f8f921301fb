// Every technique that draws nothing answers in a pose in which triangles have no area as it does without them.
#include <gnomon/kit/rays/gbuffer_maker.h>
#include <gnomon/kit/rays/rays.h>
#include <gnomon/registry.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "measure/conformance/world.h"
#include "small_world.h"

namespace degenerate_pose_test {

using namespace gnomon;

Mesh unfinished(std::string name, std::vector<glm::vec3> positions, std::vector<glm::uvec3> triangles) {
  Mesh mesh;
  mesh.name = std::move(name);
  mesh.positions = std::move(positions);
  mesh.triangles = std::move(triangles);
  mesh.facts = measure_facts(mesh.positions, mesh.triangles);
  return mesh;
}

/// Over a ground a box of which a corner has come to another one, a box that is a point, and a sheet: a triangle between two
/// without area, and one that is a point.
Scene posed() {
  Scene scene;
  scene.name = "posed";
  Mesh bent = small_world::box({-2, 0.5f, -1}, {-0.5f, 2, 0.5f});
  bent.positions[7] = bent.positions[3];
  Mesh gone = small_world::box({1, 1, 1}, {2, 2, 2});
  gone.positions.assign(8, {1.25f, 1.5f, 0.75f});
  Mesh sheet = unfinished("sheet", {{0, 1, -1}, {2, 1, -1}, {1, 1, -1}, {1, 1.5f, 1}, {2, 1, -1}, {1.5f, 1, 0.5f}},
                          {{0, 2, 1}, {0, 3, 1}, {1, 4, 3}, {5, 5, 5}});
  scene.meshes = {small_world::ground(5), std::move(bent), std::move(gone), std::move(sheet)};
  for (std::size_t m = 0; m < scene.meshes.size(); ++m) scene.meshes[m].name = fmt::format("mesh_{}", m);
  scene.motion = std::make_shared<const Motion>();
  scene.pose_number = 1;
  scene.lights = {{.name = "point", .kind = PointLight{{0.75f, 7, 1.25f}}},
                  {.name = "sun", .kind = DirectionalLight{{-0.25f, -1, -0.125f}}}};
  scene.views = {{.name = "view", .eye = {1, 6, 7}, .target = {0, 0, 0}}};
  return scene;
}

/// A scene with its picture.
struct Pictured {
  Scene scene;
  GBuffer gbuffer;

  explicit Pictured(Scene the_scene)
      : scene(std::move(the_scene)),
        gbuffer(make_gbuffer(scene, RayScene(scene, Truth::mesh, RayScene::Which::seen), scene.views[0], 48, 27, Truth::mesh)) {
  }
};

Scene without_degenerate() {
  Scene scene = posed();
  for (Mesh& mesh : scene.meshes) {
    // Facts are those of rest, in both.
    const MeshFacts facts = mesh.facts;
    finish(mesh);
    mesh.facts = facts;
  }
  std::erase_if(scene.meshes, [](const Mesh& mesh) { return mesh.triangles.empty(); });
  return scene;
}

std::vector<float> mask_of(const TechniqueEntry& entry, const Pictured& pictured, const Light& light) {
  const auto technique = entry.make();
  technique->setup();
  technique->build(pictured.scene);
  technique->relight(light);
  VisibilityMask mask(pictured.gbuffer.width, pictured.gbuffer.height);
  technique->resolve(pictured.gbuffer, mask);
  const auto pixels = mask.read();
  return {pixels.begin(), pixels.end()};
}

std::vector<std::string> drawing_nothing() {
  std::vector<std::string> ids;
  for (const TechniqueEntry& entry : registry().techniques())
    if (!draws(entry.about) && !entry.about.named_only) ids.push_back(entry.id);
  return ids;
}
std::string name_of(const testing::TestParamInfo<std::string>& info) { return info.param; }

class DegeneratePose : public testing::TestWithParam<std::string> {};
INSTANTIATE_TEST_SUITE_P(All, DegeneratePose, testing::ValuesIn(drawing_nothing()), name_of);

TEST_P(DegeneratePose, has_the_mask_of_the_scene_without_the_triangles) {
  const TechniqueEntry& entry = *std::ranges::find(registry().techniques(), GetParam(), &TechniqueEntry::id);
  const Pictured with(posed()), without(without_degenerate());
  ASSERT_TRUE(std::ranges::equal(with.gbuffer.px, without.gbuffer.px));
  int supported = 0;
  std::size_t dark = 0;
  for (const Light& light : conformance::lights_of_all_kinds(with.scene)) {
    const auto supports = [&](const Pictured& pictured) {
      return support_of(entry.about, *entry.make(), pictured.scene, light, pictured.scene.views[0]).kind();
    };
    ASSERT_EQ(supports(with), supports(without)) << light.name;
    if (supports(with) == Support::Kind::unsupported) continue;
    ++supported;
    const std::vector<float> mask = mask_of(entry, with, light), wanted = mask_of(entry, without, light);
    ASSERT_EQ(mask.size(), wanted.size());
    std::size_t different = 0;
    for (std::size_t i = 0; i < mask.size(); ++i) {
      EXPECT_TRUE(mask[i] >= 0 && mask[i] <= 1) << light.name << ", pixel " << i << ": " << mask[i];
      different += std::abs(mask[i] - wanted[i]) > 1e-5f;
      dark += mask[i] < 1;
    }
    EXPECT_EQ(different, 0u) << light.name;
  }
  if (supported == 0) GTEST_SKIP() << "it supports no light of the scene";
  EXPECT_TRUE(dark > 20 || entry.about.role == Role::baseline) << dark;
}

}  // namespace degenerate_pose_test
