#include "measure/exchange/gltf.h"

#include <gtest/gtest.h>

#include "measure/scene/load.h"
#include "measure/scratch_folder.h"

namespace gltf_test {
using namespace gnomon;

// What is written and imported again: the same triangles, cameras that look where the views do, lights where they were.
TEST(Gltf, comes_back_through_the_importer) {
  const Scene scene = load_scene("box_city:count=3");
  const ScratchFolder folder = ScratchFolder::temporary("gnomon-gltf");
  write_gltf(folder.path() / "scene.gltf", scene);
  const Scene back = load_scene((folder.path() / "scene.gltf").string());
  EXPECT_EQ(back.triangle_count(), scene.triangle_count());
  const Bounds there = scene.bounds(), here = back.bounds();
  EXPECT_EQ(here.min, there.min);
  EXPECT_EQ(here.max, there.max);
  ASSERT_EQ(back.views.size(), scene.views.size());
  for (std::size_t v = 0; v < scene.views.size(); ++v) {
    const glm::dvec3 wanted = glm::normalize(glm::dvec3(scene.views[v].target) - glm::dvec3(scene.views[v].eye)),
                     found = glm::normalize(glm::dvec3(back.views[v].target) - glm::dvec3(back.views[v].eye));
    EXPECT_GT(glm::dot(wanted, found), 1 - 1e-6) << v;
    EXPECT_LT(glm::distance(scene.views[v].eye, back.views[v].eye), 1e-5f) << v;
  }
  for (const Light& light : scene.lights) {
    if (has_area(light)) continue;  // glTF has no word for it: it is in extras
    const auto same = std::ranges::find(back.lights, light.name, &Light::name);
    ASSERT_NE(same, back.lights.end()) << light.name;
    EXPECT_EQ(kind_name(*same), kind_name(light));
    const glm::dvec4 a = homogeneous(light), b = homogeneous(*same);
    EXPECT_GT(glm::dot(glm::normalize(glm::dvec3(a)), glm::normalize(glm::dvec3(b))), 1 - 1e-6) << light.name;
  }
}

}  // namespace gltf_test
