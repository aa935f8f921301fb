// The reference of all light in the cache of frames.
#include <gnomon/error.h>
#include <gnomon/kit/area/path_light.h>
#include <gnomon/kit/geometry/shapes.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "measure/frame/frame.h"
#include "measure/scratch_folder.h"

namespace gnomon::global_reference_test {

Scene ball_over_ground() {
  Scene scene;
  scene.name = "ball";
  scene.meshes = {tessellate(Plane{{0, 0, 0}, {4, 0, 0}, {0, 0, 4}}, 4, "ground"),
                  tessellate(Sphere{{0, 1.2f, 0}, 1}, 12, "ball")};
  scene.lights = {{.name = "lamp", .kind = RectLight{{1, 4, 0}, {0.5f, 0, 0}, {0, 0, 0.5f}}}};
  scene.views = {View{.eye = {1, 4, 7}}};
  return scene;
}

std::vector<float> copy(std::span<const float> floats) { return {floats.begin(), floats.end()}; }

TEST(GlobalReference, is_kept_and_is_what_paths_of_the_kit_give) {
  const ScratchFolder folder = ScratchFolder::temporary("gnomon_global");
  const Scene scene = ball_over_ground();
  const FrameKey key{scene.views[0], 48, 32, Truth::shape};
  std::vector<float> radiance, error;
  std::uint64_t rays = 0;
  const auto file_count = [&] {
    const std::filesystem::directory_iterator files(folder.path());
    return std::ranges::count_if(files, [](const auto& entry) { return entry.path().extension() == ".reference"; });
  };
  {
    FrameStore frames(scene, folder.path());
    const GlobalReference made = frames.global_reference(key, scene.lights[0], 32);
    radiance = copy(made.radiance);
    error = copy(made.error);
    rays = made.rays;
    const PathPicture traced = trace_paths({scene, frames.everything(Truth::shape), frames.casters(Truth::shape)},
                                           frames.gbuffer(key), scene.lights[0], {.samples = 32, .seed = 0x7fffffff});
    EXPECT_EQ(traced.radiance, radiance);
    EXPECT_EQ(traced.error, error);
    EXPECT_EQ(traced.rays, rays);
  }
  FrameStore again(scene, folder.path());
  EXPECT_EQ(file_count(), 1);
  const GlobalReference kept = again.global_reference(key, scene.lights[0], 32);
  EXPECT_EQ(copy(kept.radiance), radiance);
  EXPECT_EQ(copy(kept.error), error);
  EXPECT_EQ(kept.rays, rays);
  EXPECT_EQ(file_count(), 1);
  EXPECT_NE(copy(again.global_reference(key, scene.lights[0], 48).radiance), radiance);
  EXPECT_EQ(file_count(), 2);
}

TEST(GlobalReference, refuses_a_scene_that_keeps_all_light) {
  const ScratchFolder folder = ScratchFolder::temporary("gnomon_global");
  Scene scene = ball_over_ground();
  scene.meshes[1].albedo = {0.5f, 1, 0.5f};
  FrameStore frames(scene, folder.path());
  try {
    frames.global_reference({scene.views[0], 16, 16, Truth::shape}, scene.lights[0], 16);
    ADD_FAILURE() << "it was made";
  } catch (const Error& error) {
    EXPECT_NE(std::string_view(error.what()).find("mesh ball has an albedo of 1,"), std::string_view::npos) << error.what();
  }
}

}  // namespace gnomon::global_reference_test
