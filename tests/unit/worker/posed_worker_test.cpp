// Workers whose scene moves: they answer at each pose as one that has just been started there.
#include <gtest/gtest.h>

#include <algorithm>

#include "measure/scene/load.h"
#include "measure/scratch_folder.h"
#include "measure/worker/worker_client.h"
#include "measure/worker/worker_frame_maker.h"
#include "places.h"

namespace posed_worker_test {

using namespace gnomon;
namespace fs = std::filesystem;

constexpr int width = 64, height = 36;
const std::string walkers = "walking_boxes:count=3";

RowPose walking(double seconds) { return {.animation = "walk", .seconds = seconds, .start = 0, .frame_rate = 8, .frames = 17}; }

/// Workers of this program on boxes that walk, of which the third turns.
class PosedWorker : public testing::Test {
 protected:
  std::unique_ptr<WorkerClient> worker(const std::string& technique) {
    auto client = std::make_unique<WorkerClient>(WorkerOptions{.threads = 0, .plugins = {}, .program = tested_program()},
                                                 folder.path() / fmt::format("{}_{}", technique, ++worker_count), 60);
    client->load({.scene_file = frames.scene_file(), .technique = technique, .settings = ""});
    return client;
  }
  /// Moves the scene there; nothing: to rest.
  FrameRequest frame(std::optional<double> seconds) {
    posed.go_to(seconds ? std::optional(walking(*seconds)) : std::nullopt);
    FrameKey key{.view = scene.views[0], .width = width, .height = height, .truth = Truth::mesh};
    if (seconds) key.pose = WantedPose{*posed.now(), posed.hash()};
    return {.gbuffer_file = frames.gbuffer_file(key),
            .width = width,
            .height = height,
            .truth = key.truth,
            .seen = SceneLightAndView{},
            .pose = key.pose};
  }

  const ScratchFolder folder = ScratchFolder::temporary("gnomon_worker");
  int worker_count = 0;
  Scene scene = load_scene(walkers);
  PosedScene posed{scene};
  FrameStore frames{scene, folder.path() / "frames"};
};

TEST_F(PosedWorker, answers_at_each_pose_as_a_worker_that_starts_there) {
  for (const char* technique : {"embree_rays", "shadow_map"}) {
    const auto client = worker(technique);
    std::map<std::optional<double>, std::vector<float>> fresh;
    const std::optional<double> at_rest;
    for (const std::optional<double>& seconds :
         {std::optional(0.375), std::optional(0.75), std::optional(0.375), at_rest, std::optional(0.75)}) {
      const FrameRequest request = frame(seconds);
      ASSERT_TRUE(client->frame(request).support) << technique;
      const std::vector<float> mask = client->mask();
      EXPECT_EQ(client->fresh_count(), 5);
      if (!fresh.contains(seconds)) {
        const auto starting = worker(technique);
        ASSERT_TRUE(starting->frame(request).support);
        fresh[seconds] = starting->mask();
      }
      EXPECT_TRUE(mask == fresh.at(seconds)) << technique << " at " << seconds.value_or(-1);
    }
    EXPECT_NE(fresh.at(0.375), fresh.at(0.75)) << technique;
    EXPECT_NE(fresh.at(at_rest), fresh.at(0.75)) << technique;
  }
}

TEST_F(PosedWorker, counts_stages_as_its_worker_does) {
  const auto client = worker("embree_rays");
  client->frame(frame(0));
  client->bring_up(Stage::build);
  EXPECT_EQ(client->fresh_count(), 3) << "build brings along what update would";
  client->mask();
  client->frame(frame(0.125));
  EXPECT_EQ(client->fresh_count(), 2);
  EXPECT_GE(client->time(Stage::update), 0);
  EXPECT_EQ(client->fresh_count(), 3);
  client->time(Stage::build);
  EXPECT_EQ(client->fresh_count(), 3);
  client->frame(frame({}));
  EXPECT_EQ(client->fresh_count(), 1) << "a still is built";
}

// As in stages of scenes that stand still: positions go up to OpenGL while a stage is timed.
TEST_F(PosedWorker, what_moved_goes_up_in_stages_alone) {
  for (const char* technique : {"shadow_map", "stencil_volume"}) {
    const auto client = worker(technique);
    std::uint64_t geometry = 0;
    for (const double seconds : {0.0, 0.125, 0.25}) {
      const FrameReply reply = client->frame(frame(seconds));
      ASSERT_TRUE(reply.support);
      if (!reply.floor.empty()) client->time_floor(2);
      const MaskReply answer = client->answer();
      ASSERT_TRUE(answer.gl) << technique;
      EXPECT_EQ(answer.gl->loose_bytes, 0u) << technique << " at " << seconds;
      if (seconds > 0) {
        EXPECT_EQ(*answer.gl->geometry_bytes, geometry) << technique << " at " << seconds;
      }
      geometry = *answer.gl->geometry_bytes;
    }
    EXPECT_GT(geometry, 0u) << technique;
  }
}

TEST_F(PosedWorker, another_pose_than_the_askers_is_a_failure_with_both_hashes) {
  const auto client = worker("embree_rays");
  FrameRequest request = frame(0.125);
  const std::string hash = std::exchange(request.pose->hash, "another");
  try {
    client->frame(request);
    ADD_FAILURE() << "no failure";
  } catch (const WorkerFailure& failure) {
    const std::string why = failure.what();
    EXPECT_NE(why.find("posed differently by two programs"), std::string::npos) << why;
    EXPECT_NE(why.find(hash + " here, and another"), std::string::npos) << why;
  }
}

/// Whether both stores have the same picture and the same references under point and sun.
void expect_same_frames(FrameStore& a, const FrameKey& of_a, FrameStore& b, const FrameKey& of_b, const Scene& scene) {
  const auto same = [](const auto& one, const auto& other) { return std::ranges::equal(one, other); };
  const GBuffer g = a.gbuffer(of_a), h = b.gbuffer(of_b);
  EXPECT_TRUE(same(g.px, h.px) && same(g.nx, h.nx) && same(g.mesh, h.mesh) && same(g.triangle, h.triangle));
  for (std::size_t k = 0; k < 2; ++k) {
    const Reference r = a.reference(of_a, scene.lights[k]), s = b.reference(of_b, scene.lights[k]);
    EXPECT_TRUE(same(r.mask, s.mask)) << scene.lights[k].name;
    EXPECT_TRUE(same(r.classes, s.classes) && same(r.nearest_caster, s.nearest_caster) && same(r.snapping, s.snapping));
  }
}

// One worker traces them all, from pose to pose.
TEST_F(PosedWorker, a_reference_at_a_pose_is_that_of_the_still) {
  FrameStore traced(scene, folder.path() / "traced", std::make_unique<WorkerFrameMaker>(fs::path(), tested_program()));
  std::vector<float> before;
  for (const double seconds : {0.375, 0.75}) {
    const Scene still = load_scene(fmt::format("{}@walk={}", walkers, seconds));
    FrameStore of_still(still, folder.path() / "still");
    posed.go_to(walking(seconds));
    for (std::size_t m = 0; m < scene.meshes.size(); ++m) ASSERT_EQ(scene.meshes[m].positions, still.meshes[m].positions) << m;
    const FrameKey at_rest{.view = scene.views[0], .width = width, .height = height, .truth = Truth::mesh};
    FrameKey key = at_rest;
    key.pose = WantedPose{*posed.now(), posed.hash()};
    expect_same_frames(traced, key, of_still, at_rest, scene);
    const Reference reference = traced.reference(key, scene.lights[0]);
    EXPECT_FALSE(std::ranges::equal(reference.mask, before));
    before.assign(reference.mask.begin(), reference.mask.end());
  }
  posed.go_to({});
  const Scene loaded = load_scene(walkers);
  FrameStore of_loaded(loaded, folder.path() / "loaded");
  const FrameKey key{.view = scene.views[0], .width = width, .height = height, .truth = Truth::mesh};
  expect_same_frames(traced, key, of_loaded, key, scene);
}

TEST_F(PosedWorker, a_frame_that_cannot_be_made_says_that_poses_differ_and_others_are_made) {
  WorkerFrameMaker maker(folder.path() / "maker", tested_program());
  posed.go_to(walking(0.25));
  MissingFrame missing{.scene_file = frames.scene_file(),
                       .key = {.view = scene.views[0],
                               .width = width,
                               .height = height,
                               .truth = Truth::mesh,
                               .pose = WantedPose{*posed.now(), "another"}}};
  try {
    maker.make(missing);
    ADD_FAILURE() << "no failure";
  } catch (const WorkerFailure& failure) {
    EXPECT_NE(std::string(failure.what()).find("posed differently by two programs"), std::string::npos) << failure.what();
  }
  missing.key.pose->hash = posed.hash();
  EXPECT_FALSE(maker.make(missing).empty()) << "a frame of another pose is another frame";
}

}  // namespace posed_worker_test
