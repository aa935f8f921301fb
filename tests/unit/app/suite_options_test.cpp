// What the options of a run make of a suite: the times of its scenes.
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
  options.animation = "walk";
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
  options.animation = "fly";
  const Suite suite = make_suite(options, "run");
  EXPECT_EQ(suite.groups.at(0).scenes, (Words{"a@fly=7", "b@fly=7"}));
  EXPECT_EQ(suite.groups.at(1).scenes, Words{"c@fly=7"});
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
