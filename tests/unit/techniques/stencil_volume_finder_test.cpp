// Stencil volumes whose outline the device finds: room, the bound on depth, and the same work as the processor's.
#include "stencil_rig.h"
#include "techniques/stencil_volume/gpu_finder.h"

namespace stencil_volume_finder_test {
using namespace stencil_rig;

class StencilVolumeFinder : public TestRig {};

// Boxes beside each other have 6 of their 18 edges on the outline: more than the room that the device's finder begins with.
TEST_F(StencilVolumeFinder, fresh_finder_has_room_for_every_outline) {
  Random random(12);
  Scene scene = scene_of({small_world::ground(4)});
  for (int i = 0; i < 400; ++i)
    scene.meshes.push_back(turned_box(random, random_point(random, {-3, 0.5f, -3}, {3, 2, 3}), glm::vec3(0.0625f)));
  const GBuffer g = small_world::make_gbuffer(scene, random_view(random, false), 64, 48);
  for (const Light& light : {Light{.kind = PointLight{{1, 5, 0.5f}}}, Light{.kind = DirectionalLight{{0.25f, -1, 0.5f}}}})
    for (const char* extrusion : {"", ",extrusion=per_triangle"}) {
      const auto expected = mask("finder=cpu" + std::string(extrusion), scene, light, g);
      EXPECT_GT(std::ranges::count(expected, 0.0f), 100);
      TearDownTestSuite();  // what is made next has small buffers
      EXPECT_EQ(differences(mask("finder=gpu" + std::string(extrusion), scene, light, g), expected), 0);
    }
}

// What is written beyond a buffer may be lost, or may end the program, as the driver likes.
TEST_F(StencilVolumeFinder, the_devices_finder_is_told_the_room_that_there_is) {
  const Scene scene = scene_of({small_world::box({-1, 0, -1}, {1, 1, 1})});
  const EdgeAdjacency adjacency(scene);
  const StateGuard guard;
  stencil_volume::GpuFinder finder;
  finder.setup();
  finder.build(adjacency);
  FaceBuffers faces;
  finder.find(scene_buffers(scene), adjacency, {1, 5, 0.5, 1}, {}, faces);
  GLint program = 0, told = 0, sides = 0, bytes = 0;
  glGetIntegerv(GL_CURRENT_PROGRAM, &program);
  glGetUniformiv(static_cast<GLuint>(program), glGetUniformLocation(static_cast<GLuint>(program), "side_capacity"), &told);
  glGetIntegeri_v(GL_SHADER_STORAGE_BUFFER_BINDING, 6, &sides);
  glGetNamedBufferParameteriv(static_cast<GLuint>(sides), GL_BUFFER_SIZE, &bytes);
  EXPECT_GE(told, 4) << "sides of the outline";
  EXPECT_LE(told * static_cast<int>(sizeof(glm::uvec4)), bytes);
}

// The short proof that the stencil's bits are enough: never less than what the processor proves, and none where casters may be
// all around the light.
TEST_F(StencilVolumeFinder, the_devices_depth_bound_is_one) {
  Random random(12);
  stencil_volume::GpuFinder finder;
  finder.setup();
  int bounded = 0, open = 0;
  for (int round = 0; round < 12; ++round) {
    const Scene scene = casters_over_ground(random, 10);
    const EdgeAdjacency adjacency(scene);
    for (const Light& light : lights_around(random)) {
      const StateGuard guard;
      finder.build(adjacency);
      FaceBuffers faces;
      finder.find(scene_buffers(scene), adjacency, homogeneous(light), {}, faces);
      const auto bound = finder.depth_bound(adjacency, homogeneous(light));
      Silhouette silhouette;
      adjacency.find_silhouette(homogeneous(light), silhouette);
      if (!bound) {
        ++open;
        continue;
      }
      ++bounded;
      for (int k = 0; k < 200; ++k) {
        const glm::vec3 point(random.uniform(-3, 3), random.uniform(0, 2), random.uniform(-3, 3));
        EXPECT_LE(adjacency.depth_at(point, silhouette).volumes, *bound);
      }
    }
  }
  EXPECT_GT(bounded, 10);
  EXPECT_GT(open, 0);
}

// The device finds the same outline as the processor, so every count of work is the same; buffers may be larger.
TEST_F(StencilVolumeFinder, finders_count_the_same_work) {
  Random random(11);
  for (int round = 0; round < 6; ++round) {
    const Scene scene = casters_over_ground(random, 10);
    const GBuffer g = small_world::make_gbuffer(scene, random_view(random, round % 3 == 2), 48, 36);
    for (const Light& light : lights_around(random))
      for (const std::string settings : {"count=zfail", "count=zpass_plus", "count=zfail,extrusion=per_triangle"}) {
        mask(settings, scene, light, g);
        const Counts by_processor = technique_->counts();
        mask(settings + ",finder=gpu", scene, light, g);
        const Counts by_device = technique_->counts();
        ASSERT_EQ(by_processor.size(), by_device.size());
        for (std::size_t i = 0; i < by_device.size(); ++i) {
          ASSERT_EQ(by_processor[i].name, by_device[i].name);
          if (by_device[i].name != "bytes") {
            EXPECT_EQ(by_processor[i].value, by_device[i].value)
                << by_device[i].name << ", " << settings << ", round " << round << ", " << light.name;
          }
        }
      }
  }
}

}  // namespace stencil_volume_finder_test
