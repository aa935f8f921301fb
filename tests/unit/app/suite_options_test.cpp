// What the options of a run make of a suite: the times of its scenes, and what moves.
#include "app/suite_options.h"

#include <gtest/gtest.h>

#include <fstream>

#include "app/time_option.h"
#include "error_words.h"
#include "measure/scratch_folder.h"

namespace suite_options_test {

using namespace gnomon;
using namespace gnomon::app;
using error_words::error_of, error_words::expect_words;
using Words = std::vector<std::string>;

TEST(suite_options, times_make_stills_of_the_scenes) {
  SuiteOptions options;
  options.scenes = {"a", "b@2.50"};
  options.techniques = {"unshadowed"};
  EXPECT_EQ(make_suite(options, "run").groups.at(0).scenes, (Words{"a", "b@2.5"}));
  options.times = {0, 0.5};
  expect_words(error_of([&] { make_suite(options, "run"); }), {"scene b@2.50 has a time already"});
  options.scenes = {"a"};
  options.animations = {"walk"};
  EXPECT_EQ(make_suite(options, "run").groups.at(0).scenes, (Words{"a@walk=0", "a@walk=0.5"}));
}

TEST(suite_options, times_replace_those_of_a_suite) {
  const ScratchFolder scratch = ScratchFolder::temporary("gnomon_times");
  const std::filesystem::path file = scratch.path() / "suite.toml";
  std::ofstream(file) << "[[group]]\nscenes = ['a', 'b']\ntime = [1, 2]\ntechniques = ['unshadowed']\n"
                         "[[group]]\nscenes = ['c@walk=3']\ntechniques = ['unshadowed']\n";
  SuiteOptions options;
  options.suite = file.string();
  EXPECT_EQ(make_suite(options, "run").groups.at(0).scenes, (Words{"a@1", "a@2", "b@1", "b@2"}));
  options.times = {7};
  EXPECT_EQ(make_suite(options, "run").groups.at(0).scenes, (Words{"a@7", "b@7"})) << "each once";
  EXPECT_EQ(make_suite(options, "run").groups.at(1).scenes, Words{"c@walk=7"}) << "of the suite's animation";
  options.animations = {"fly"};
  const Suite suite = make_suite(options, "run");
  EXPECT_EQ(suite.groups.at(0).scenes, (Words{"a@fly=7", "b@fly=7"}));
  EXPECT_EQ(suite.groups.at(1).scenes, Words{"c@fly=7"});
}

TEST(suite_options, an_animation_without_a_time_is_followed) {
  SuiteOptions options;
  options.scenes = {"a"};
  options.techniques = {"unshadowed"};
  options.animations = {"walk", "*"};
  options.frames = 5;
  options.frame_rate = 30;
  options.start = 0.5;
  const SuiteGroup group = make_suite(options, "run").groups.at(0);
  EXPECT_EQ(group.scenes, Words{"a"});
  EXPECT_EQ(group.animations, (Words{"walk", "*"}));
  EXPECT_EQ(group.times, (FrameTimes{5, 30, 0.5}));
  EXPECT_TRUE(group.paths.empty());
}

TEST(suite_options, what_moves_replaces_that_of_a_suite) {
  const ScratchFolder scratch = ScratchFolder::temporary("gnomon_motion");
  const std::filesystem::path file = scratch.path() / "suite.toml";
  std::ofstream(file) << "[[group]]\nscenes = ['a']\nanimations = ['walk']\nframes = 9\ntechniques = ['unshadowed']\n"
                         "[[group]]\nscenes = ['b']\npaths = ['light_slide']\ntechniques = ['unshadowed']\n";
  SuiteOptions options;
  options.suite = file.string();
  options.frame_rate = 15;
  std::vector<SuiteGroup> groups = make_suite(options, "run").groups;
  EXPECT_EQ(groups.at(0).times, (FrameTimes{9, 15, {}}));
  EXPECT_EQ(groups.at(1).times, FrameTimes{}) << "nothing of it follows an animation";
  options.paths = {"camera_slide"};
  options.animations = {"fly"};
  groups = make_suite(options, "run").groups;
  for (const SuiteGroup& group : groups) {
    EXPECT_EQ(group.paths, Words{"camera_slide"});
    EXPECT_EQ(group.animations, Words{"fly"});
  }
  EXPECT_EQ(groups.at(0).times, (FrameTimes{9, 15, {}}));

  options = {};
  options.suite = file.string();
  options.paths = {"camera_slide"};
  for (const SuiteGroup& group : make_suite(options, "run").groups) {
    EXPECT_EQ(group.paths, Words{"camera_slide"});
    EXPECT_TRUE(group.animations.empty());
  }

  options = {};
  options.suite = file.string();
  options.times = {0.5};
  const SuiteGroup stills = make_suite(options, "run").groups.at(0);
  EXPECT_EQ(stills.scenes, Words{"a@walk=0.5"}) << "of the animation that the suite follows";
  EXPECT_TRUE(stills.animations.empty());
  EXPECT_EQ(stills.times, FrameTimes{});
}

TEST(suite_options, times_and_frames_that_do_not_go_together_are_refused) {
  SuiteOptions options;
  options.scenes = {"a"};
  options.techniques = {"unshadowed"};
  options.frames = 5;
  const auto error = [&] { return error_of([&] { make_suite(options, "run"); }); };
  expect_words(error(), {"--frames 5 is for rows that follow an animation, and none does", "--animation"});
  options.times = {0.25};
  expect_words(error(), {"--frames 5", "--time 0.25 is of stills"});
  options.animations = {"walk"};
  expect_words(error(), {"--frames 5", "--time 0.25 is of stills"});
  options.frames = 0;
  options.start = 0;
  expect_words(error(), {"--start 0", "--time 0.25 is of stills"});
  options.start.reset();
  options.animations = {"walk", "fly"};
  expect_words(error(), {"--time 0.25 is of stills of one animation", "walk, fly"});
}

TEST(suite_options, the_truth_over_pixels_replaces_that_of_a_suite) {
  SuiteOptions options;
  options.scenes = {"a"};
  options.techniques = {"unshadowed"};
  EXPECT_EQ(make_suite(options, "run").truth_over, TruthOver::center);
  options.truth_over = "both";
  EXPECT_EQ(make_suite(options, "run").truth_over, TruthOver::both);
}

TEST(time_option, rewrites_the_reference_of_one_scene) {
  std::string scene = "a@01";
  put_time(scene, {});
  EXPECT_EQ(scene, "a@1");
  expect_words(error_of([&] { put_time(scene, {.seconds = 2, .animation = ""}); }), {"a@1 has a time already"});
  scene = "a";
  put_time(scene, {.seconds = 2, .animation = "walk"});
  EXPECT_EQ(scene, "a@walk=2");
}

}  // namespace suite_options_test
