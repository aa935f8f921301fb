// Workers of this program, called by types: what techniques answer by way of them.
#include <gnomon/registry.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "measure/frame/frame.h"
#include "measure/scene/load.h"
#include "measure/scratch_folder.h"
#include "measure/worker/worker_client.h"
#include "places.h"

namespace own_worker_test {

using namespace gnomon;

/// Workers of this program on a scene of one triangle, 80 pixels by 45.
class OwnWorker : public testing::Test {
 protected:
  WorkerClient worker(const std::string& name) {
    return WorkerClient({.threads = 0, .plugins = {}, .program = tested_program()}, folder.path() / name, 60);
  }
  TechniqueOnScene request(const std::string& technique, const std::string& settings = "") {
    return {.scene_file = frames.scene_file(), .technique = technique, .settings = settings};
  }
  FrameRequest frame() {
    const FrameKey key{.view = scene.views[0], .width = 80, .height = 45, .truth = Truth::mesh};
    return {.gbuffer_file = frames.gbuffer_file(key),
            .width = key.width,
            .height = key.height,
            .truth = key.truth,
            .seen = SceneLightAndView{}};
  }
  static constexpr std::size_t pixel_count = 80 * 45;

  const ScratchFolder folder = ScratchFolder::temporary("gnomon_worker");
  const Scene scene = load_scene("single_triangle");
  FrameStore frames{scene, folder.path() / "frames"};
};

TEST_F(OwnWorker, answers_counts_layers_and_explanations) {
  WorkerClient client = worker("map");
  client.load(request("shadow_map", "resolution=256"));
  ASSERT_TRUE(client.gl());
  EXPECT_FALSE(client.gl()->renderer.empty());
  EXPECT_GE(client.gl()->subpixel_bits, 4);  // what OpenGL promises
  const FrameReply reply = client.frame(frame());
  EXPECT_TRUE(reply.support);
  const MaskReply answer = client.answer();
  ASSERT_TRUE(answer.gl);
  EXPECT_GT(answer.gl->input_bytes, 0u);
  EXPECT_EQ(client.fresh_count(), 5);
  EXPECT_EQ(answer.mask.size(), pixel_count);
  EXPECT_NE(std::ranges::find(answer.mask, 0.0f), answer.mask.end());
  const auto bytes = std::ranges::find(answer.counts, "bytes", &Count::name);
  ASSERT_NE(bytes, answer.counts.end());
  EXPECT_GE(bytes->value, 6 * 256 * 256 * 2) << "six faces of at least 16 bits a texel";
  EXPECT_GT(answer.peak_bytes, 1'000'000u);
  EXPECT_EQ(client.debug_layer("map").size(), 3 * pixel_count);
  // More pixels than one request holds: those of the picture, twice over.
  std::vector<std::uint32_t> pixels(2 * pixel_count);
  for (std::size_t k = 0; k < pixels.size(); ++k) pixels[k] = static_cast<std::uint32_t>(k % pixel_count);
  const auto explanations = client.explain(pixels);
  ASSERT_EQ(explanations.size(), pixels.size());
  const std::size_t shadow = static_cast<std::size_t>(std::ranges::find(answer.mask, 0.0f) - answer.mask.begin());
  ASSERT_TRUE(explanations[shadow] && explanations[shadow + pixel_count]);
  EXPECT_FALSE(explanations[shadow]->taps.empty());
  EXPECT_EQ(explanations[shadow]->taps.size(), explanations[shadow + pixel_count]->taps.size());
  client.set("resolution=128");
  EXPECT_EQ(client.fresh_count(), 3) << "setup, build and update have no resolution";
  EXPECT_EQ(client.mask().size(), pixel_count);
}

// Whatever is requested: all triangles that go up to OpenGL do so while a stage is timed, and count as memory.
TEST_F(OwnWorker, geometry_goes_up_in_stages_alone) {
  std::size_t holding = 0;
  for (const TechniqueEntry& entry : registry().techniques()) {
    if (!draws(entry.about)) continue;
    WorkerClient client = worker(entry.id);
    client.load(request(entry.id));
    if (!client.frame(frame()).support) continue;
    client.answer();
    for (const Stage stage : timed_stages) client.time(stage, 2);
    if (entry.about.floor != Floor::none) client.time_floor(2);  // a bare pass may draw them, too
    client.answer();
    const MaskReply answer = client.answer();
    ASSERT_TRUE(answer.gl) << entry.id;
    EXPECT_EQ(answer.gl->loose_bytes, 0u) << entry.id;
    holding += *answer.gl->geometry_bytes > 0;
    const auto bytes = std::ranges::find(answer.counts, "bytes", &Count::name);
    if (bytes != answer.counts.end()) {
      EXPECT_GE(bytes->value, static_cast<double>(*answer.gl->geometry_bytes)) << entry.id;
    }
  }
  EXPECT_GE(holding, 8u);
}

TEST_F(OwnWorker, a_technique_without_samples_explains_nothing) {
  WorkerClient client = worker("rays");
  client.load(request("embree_rays"));
  EXPECT_FALSE(client.gl());
  client.frame(frame());
  const std::vector<std::uint32_t> pixels{0, 7, 9};
  const auto explanations = client.explain(pixels);
  ASSERT_EQ(explanations.size(), 3u);
  EXPECT_FALSE(explanations[0] || explanations[1] || explanations[2]);
}

// A light without direction looks through six faces, a map of one image has one part, and rays have no images.
TEST_F(OwnWorker, gives_the_parts_of_images) {
  for (const char* technique : {"shadow_map", "virtual_map", "embree_rays"}) {
    WorkerClient client = worker(technique);
    client.load(request(technique));
    client.frame(frame());
    const std::vector<std::uint32_t> parts = client.parts();
    if (technique == std::string_view("embree_rays")) {
      EXPECT_TRUE(parts.empty());
      continue;
    }
    ASSERT_EQ(parts.size(), pixel_count) << technique;
    EXPECT_GT(std::set(parts.begin(), parts.end()).size(), 2u) << technique << ": none, and two at least";
  }
}

// At the depth where it was looked up a curve has the mask's answer: no caster is opaque where that is between 0 and 1.
TEST_F(OwnWorker, gives_the_depth_curve_of_a_texel_of_glass) {
  const Scene glass = load_scene("glass_stack");
  FrameStore store{glass, folder.path() / "glass"};
  const FrameKey key{.view = glass.views[0], .width = 80, .height = 45, .truth = Truth::mesh};
  const FrameRequest seen{.gbuffer_file = store.gbuffer_file(key),
                          .width = key.width,
                          .height = key.height,
                          .truth = key.truth,
                          .seen = SceneLightAndView{}};
  for (const char* technique : {"transmittance_map", "shadow_map", "embree_rays"}) {
    WorkerClient client = worker(technique);
    client.load({.scene_file = store.scene_file(), .technique = technique, .settings = ""});
    ASSERT_TRUE(client.frame(seen).support);
    const std::vector<float> mask = client.mask();
    const bool holds_curves = technique == std::string_view("transmittance_map");
    const auto shaded = std::ranges::find_if(mask, [&](float v) { return !holds_curves || (v > 0.05f && v < 0.95f); });
    ASSERT_NE(shaded, mask.end());
    const auto curve = client.depth_curve(static_cast<std::uint32_t>(shaded - mask.begin()));
    EXPECT_EQ(curve.has_value(), holds_curves) << technique;
    if (!curve) continue;
    const auto behind = std::ranges::lower_bound(curve->held.depth, curve->receiver);
    ASSERT_NE(behind, curve->held.depth.end());
    EXPECT_NEAR(curve->held.share[static_cast<std::size_t>(behind - curve->held.depth.begin())], *shaded, 1e-6);
    EXPECT_EQ(curve->exact.share.front(), 1);
    EXPECT_THROW(client.depth_curve(pixel_count), WorkerFailure) << "no such pixel";
  }
}

TEST_F(OwnWorker, gives_surface_detail_once_light_is_there) {
  WorkerClient client = worker("tree");
  client.load(request("svbsp"));
  client.frame(frame());
  const SurfaceDetail detail = client.surface_detail();
  EXPECT_FALSE(detail.polygons.empty());
  EXPECT_EQ(client.fresh_count(), 4);
}

TEST_F(OwnWorker, answers_a_light_that_is_not_the_scenes) {
  WorkerClient client = worker("free");
  client.load(request("embree_rays"));
  client.frame(frame());
  const std::vector<float> before = client.mask();
  Light moved = scene.lights[0];
  std::get<PointLight>(moved.kind).position += glm::vec3(1, 0, 0);
  FrameRequest elsewhere = frame();
  elsewhere.seen = FreeLightAndView{{moved}, scene.views[0]};
  client.frame(elsewhere);
  EXPECT_EQ(client.fresh_count(), 3) << "another light: build stays valid";
  EXPECT_NE(client.mask(), before);
  elsewhere.seen = FreeLightAndView{{scene.lights[0]}, scene.views[0]};
  client.frame(elsewhere);
  EXPECT_EQ(client.mask(), before);
}

TEST_F(OwnWorker, several_load_at_once) {
  WorkerClient one = worker("one"), two = worker("two");
  one.begin_load(request("unshadowed"));
  two.begin_load(request("embree_rays"));
  two.end_load();
  one.end_load();
  one.frame(frame());
  two.frame(frame());
  EXPECT_EQ(one.mask(), std::vector<float>(pixel_count, 1.0f));
  EXPECT_NE(two.mask(), one.mask());
}

TEST_F(OwnWorker, an_unknown_technique_is_an_exception_in_open) {
  WorkerClient client = worker("none");
  try {
    client.load(request("shadow_mop"));
    FAIL() << "no error";
  } catch (const WorkerFailure& failure) {
    EXPECT_TRUE(std::string(failure.what()).starts_with("threw in open: there is no technique shadow_mop")) << failure.what();
  }
}

}  // namespace own_worker_test
