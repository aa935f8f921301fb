// In which order a worker's side calls a technique's stages while its scene moves: by a technique that notes its calls.
#include "measure/worker/technique_frame.h"

#include <gnomon/kit/shared.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "error_words.h"
#include "hand_made.h"
#include "measure/scratch_folder.h"
#include "walking_world.h"

namespace technique_frame_test {

using namespace gnomon;
using error_words::error_of, error_words::expect_words;
using walking_world::in_row;

std::vector<std::string> calls;  ///< of all objects
Changes last_changes;            ///< that an update got
float farthest = 100;            ///< x of the first box's first vertex up to which its technique supports the scene, meters

/// Notes its calls, updates with the number of meshes that moved. Where it `shares`, one object does setup, build and update
/// for all lights.
template <bool shares>
class Noting final : public Technique {
 public:
  Number<int> size{this, "size", 1, {.min = 1, .max = 9}, Stage::build, "A size."};

  Support supports(const Scene& scene, const Light&, const View&) const override {
    return scene.meshes[1].positions[0].x > farthest ? Support::unsupported("the box is too far") : Support::full();
  }
  void setup() override { calls.emplace_back("setup"); }
  void build(const Scene& scene) override {
    calls.emplace_back("build");
    built_on_ = &scene;
  }
  void update(const Scene& scene, const Changes& changes) override {
    EXPECT_EQ(&scene, built_on_) << "the scene that build got";
    EXPECT_EQ(changes.meshes.size(), scene.meshes.size());
    calls.push_back(fmt::format("update {}", std::ranges::count_if(changes.meshes, [](const MeshChange& change) {
                                  return change.kind != MeshChange::Kind::still;
                                })));
    last_changes = changes;
  }
  void relight(const Light&) override { calls.emplace_back("relight"); }
  void resolve(const GBuffer&, VisibilityMask& mask) override {
    calls.emplace_back("resolve");
    std::ranges::fill(mask.pixels(), 1.0f);
  }
  Counts counts() const override { return {}; }
  std::unique_ptr<Technique> for_another_light() const override { return shares ? another(*this, &Noting::made_) : nullptr; }

 private:
  const Scene* built_on_ = nullptr;
  Shared<int> made_;
};

const TechniqueEntry alone{.id = "alone", .about = {}, .make = [] { return gnomon::made<Technique, Noting<false>>("alone"); }};
const TechniqueEntry sharing{
    .id = "sharing", .about = {}, .make = [] { return gnomon::made<Technique, Noting<true>>("sharing"); }};

class FrameOfWalkers : public testing::Test {
 protected:
  FrameOfWalkers() {
    write_file(folder.path() / "scene", scene_bytes(scene));
    const hand_made::Picture nothing(2, 2);
    write_gbuffer(folder.path() / "gbuffer", nothing.gbuffer);
    open(alone);
    calls.clear();
    farthest = 100;
  }
  void open(const TechniqueEntry& entry) {
    frame.open(entry, {.scene = (folder.path() / "scene").string(), .technique = entry.id, .settings = ""});
  }
  GoRequest at_rest(const std::vector<std::size_t>& lights = {0}) const {
    return {.gbuffer = (folder.path() / "gbuffer").string(), .width = 2, .height = 2, .truth = Truth::mesh, .lights = lights};
  }
  GoRequest at(const RowPose& pose, const std::vector<std::size_t>& lights = {0}) {
    GoRequest request = at_rest(lights);
    request.pose = walking_world::moved_to(posed, pose);
    return request;
  }
  GoRequest at(double seconds, const std::vector<std::size_t>& lights = {0}) { return at(in_row(seconds), lights); }
  /// What was called since the last time.
  static std::string said() { return joined(std::exchange(calls, {}), " "); }
  /// What is called so that there is a mask.
  std::string brought_up() {
    frame.bring_up(Stage::resolve);
    return said();
  }

  const ScratchFolder folder = ScratchFolder::temporary("gnomon_technique_frame");
  Scene scene = walking_world::walking_scene();
  PosedScene posed{scene};
  TechniqueFrame frame;
};

TEST_F(FrameOfWalkers, a_row_that_moves_is_built_once_and_updated_at_each_frame) {
  EXPECT_EQ(frame.go_to(at(0)).fresh, 0);
  EXPECT_EQ(brought_up(), "setup build relight resolve") << "a build brings along what an update would";
  for (const double seconds : {0.125, 0.25, 0.125}) {
    EXPECT_EQ(frame.go_to(at(seconds)).fresh, 2);
    EXPECT_EQ(brought_up(), "update 2 relight resolve");
  }
  EXPECT_EQ(frame.go_to(at(0.125)).fresh, 4) << "nothing has moved";
  EXPECT_EQ(brought_up(), "resolve");
  EXPECT_EQ(frame.go_to(at(0.125, {1})).fresh, 3) << "the light alone is another";
  EXPECT_EQ(brought_up(), "relight resolve");
}

TEST_F(FrameOfWalkers, another_row_is_built_and_so_is_a_still) {
  frame.go_to(at(0.25));
  EXPECT_EQ(brought_up(), "setup build relight resolve");
  RowPose slower = in_row(0.25);
  slower.frame_rate = 4;
  EXPECT_EQ(frame.go_to(at(slower)).fresh, 1) << "its meshes have another reach, though they are where they were";
  EXPECT_EQ(brought_up(), "build relight resolve");
  EXPECT_EQ(frame.go_to(at(in_row(0.25, "lift"))).fresh, 1);
  EXPECT_EQ(brought_up(), "build relight resolve");
  EXPECT_EQ(frame.go_to(at(in_row(0.5, "lift"))).fresh, 2);
  EXPECT_EQ(brought_up(), "update 1 relight resolve") << "it moves one of the boxes";
  EXPECT_EQ(frame.go_to(at_rest()).fresh, 1);
  EXPECT_EQ(brought_up(), "build relight resolve");
  EXPECT_EQ(frame.scene().meshes[2].positions, walking_world::walking_scene().meshes[2].positions);
  EXPECT_EQ(frame.go_to(at_rest()).fresh, 4);
}

TEST_F(FrameOfWalkers, an_update_gets_all_that_moved_since_the_one_before) {
  frame.go_to(at(0));
  frame.bring_up(Stage::resolve);
  frame.go_to(at(0.125));
  frame.go_to(at(0.25));
  said();
  frame.bring_up(Stage::update);
  EXPECT_EQ(said(), "update 2");
  ASSERT_EQ(last_changes.meshes.size(), 3u);
  EXPECT_EQ(last_changes.meshes[0].kind, MeshChange::Kind::still);
  EXPECT_EQ(last_changes.meshes[1].kind, MeshChange::Kind::rigid);
  EXPECT_EQ(last_changes.meshes[1].before.min.x, -1.5f);
  EXPECT_EQ(last_changes.meshes[1].after.min.x, -1) << "half a meter in a quarter of a second";
  frame.go_to(at(0.5));
  frame.go_to(at(0.25));
  EXPECT_EQ(brought_up(), "update 0 relight resolve") << "away and back";
}

TEST_F(FrameOfWalkers, a_parameter_that_spoils_build_has_it_built_wherever_it_moved) {
  frame.go_to(at(0));
  brought_up();
  frame.go_to(at(0.125));
  EXPECT_EQ(frame.set("size=2").fresh, 1);
  EXPECT_EQ(frame.go_to(at(0.25)).fresh, 1);
  EXPECT_EQ(brought_up(), "build relight resolve");
  frame.time_stage({.stage = Stage::update});
  EXPECT_EQ(said(), "update 0") << "the build has seen what moved";
}

TEST_F(FrameOfWalkers, stages_that_are_timed_bring_up_those_before_them) {
  frame.go_to(at(0));
  frame.time_stage({.stage = Stage::update});
  EXPECT_EQ(said(), "setup build update 0") << "an update without change";
  EXPECT_EQ(brought_up(), "relight resolve") << "relight follows an update always";
  frame.go_to(at(0.125));
  frame.time_stage({.stage = Stage::update});
  EXPECT_EQ(said(), "update 2");
  frame.time_stage({.stage = Stage::resolve});
  EXPECT_EQ(said(), "relight resolve");
  frame.go_to(at(0.25));
  frame.time_stage({.stage = Stage::relight});
  EXPECT_EQ(said(), "update 2 relight");
  frame.go_to(at(0.375));
  frame.time_stage({.stage = Stage::build});
  EXPECT_EQ(said(), "build");
  EXPECT_EQ(brought_up(), "relight resolve");
}

TEST_F(FrameOfWalkers, objects_that_share_are_updated_once_and_others_each) {
  frame.go_to(at(0, {0, 1}));
  EXPECT_EQ(brought_up(), "setup setup build build relight relight resolve resolve");
  frame.go_to(at(0.125, {0, 1}));
  EXPECT_EQ(brought_up(), "update 2 update 2 relight relight resolve resolve");
  open(sharing);
  frame.go_to(at(0.125, {0, 1}));
  EXPECT_EQ(brought_up(), "setup build relight relight resolve resolve");
  frame.go_to(at(0.25, {0, 1}));
  EXPECT_EQ(brought_up(), "update 2 relight relight resolve resolve");
}

TEST_F(FrameOfWalkers, an_object_that_is_new_is_built) {
  frame.go_to(at(0));
  brought_up();
  EXPECT_EQ(frame.go_to(at(0.125, {0, 1})).fresh, 0);
  EXPECT_EQ(brought_up(), "setup setup build build relight relight resolve resolve");
}

TEST_F(FrameOfWalkers, support_is_asked_of_the_scene_in_its_pose) {
  farthest = -1.25f;
  EXPECT_EQ(frame.go_to(at(0)).support.support, Support::Kind::full);
  brought_up();
  const GoRequest::Reply far = frame.go_to(at(0.25));
  EXPECT_EQ(far.support.support, Support::Kind::unsupported);
  EXPECT_EQ(far.support.why, "the box is too far");
  EXPECT_EQ(frame.go_to(at(0.125)).support.support, Support::Kind::full);
  EXPECT_EQ(brought_up(), "update 2 relight resolve");
}

TEST_F(FrameOfWalkers, positions_that_another_program_does_not_have_are_refused) {
  frame.go_to(at(0));
  brought_up();
  GoRequest request = at(0.125);
  const std::string hash = std::exchange(request.pose->hash, "0123abcd");
  expect_words(error_of([&] { frame.go_to(request); }),
               {"scene walking at 0.125 s of animation walk is posed differently", hash + " here", "0123abcd in the program"});
  request.pose->hash = hash;
  frame.go_to(request);
  EXPECT_EQ(brought_up(), "update 2 relight resolve") << "it moved all the same";
}

TEST_F(FrameOfWalkers, poses_that_make_no_sense_are_refused) {
  frame.go_to(at(0));
  brought_up();
  const auto refusal = [&](const auto& change) {
    GoRequest request = at(0.125);
    change(request.pose->at);
    return error_of([&] { frame.go_to(request); });
  };
  constexpr double infinite = std::numeric_limits<double>::infinity();
  expect_words(refusal([](RowPose& at) { at.animation.clear(); }), {"a pose has no animation"});
  expect_words(refusal([](RowPose& at) { at.animation = "walks"; }), {"walks", "walk"});
  expect_words(refusal([](RowPose& at) { at.frames = 0; }), {"animation walk", "frames = 0 is outside 1 .. 10000"});
  expect_words(refusal([](RowPose& at) { at.frames = 10001; }), {"frames = 10001 is outside"});
  expect_words(refusal([](RowPose& at) { at.seconds = -1; }), {"-1"});
  expect_words(refusal([](RowPose& at) { at.start = infinite; }), {"start = inf", "0 or more"});
  expect_words(refusal([](RowPose& at) { at.frame_rate = 0; }), {"frame_rate = 0", "above 0"});
  expect_words(refusal([](RowPose& at) { at.frame_rate = NAN; }), {"frame_rate = nan", "above 0"});
  EXPECT_EQ(frame.go_to(at(0.125)).fresh, 2) << "and the row is the same";
}

}  // namespace technique_frame_test
