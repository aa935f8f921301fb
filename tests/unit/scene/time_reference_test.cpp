// References of stills: what is a time and what belongs to the scene, and that every way to name a scene takes one.
#include "measure/scene/time_reference.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <fstream>
#include <limits>

#include "error_words.h"
#include "measure/paths.h"
#include "measure/scene/base_scene.h"
#include "measure/scene/load.h"
#include "measure/scratch_folder.h"

namespace time_reference_test {

using namespace gnomon;
using error_words::error_of, error_words::expect_words;
namespace fs = std::filesystem;

/// "SCENE | ANIMATION | SECONDS", "SCENE" without a time.
std::string parts_of(const std::string& reference) {
  const TimedReference timed = split_time(reference);
  return timed.at ? fmt::format("{} | {} | {}", timed.scene, timed.at->animation, timed.at->seconds) : timed.scene;
}

/// A floor that stands still and a block that two animations move: 4 m along x in 2 s, or up by 1 m.
const std::string moving =
    "[[shape]]\nkind = \"plane\"\ncenter = [0, 0, 0]\nnormal = [0, 1, 0]\nsize = [9, 9]\n"
    "[[shape]]\nname = \"block\"\nkind = \"box\"\nmin = [0, 1, 0]\nmax = [1, 2, 1]\n"
    "[[path]]\nname = \"slide\"\nmoves = \"mesh\"\nmesh = \"block\"\ntimes = [0, 2]\npositions = [[0, 0, 0], [4, 0, 0]]\n"
    "[[path]]\nname = \"lift\"\nmoves = \"mesh\"\nmesh = \"block\"\ntimes = [0, 1]\npositions = [[0, 0, 0], [0, 1, 0]]\n";

/// Each test writes its files below a folder of its own.
class TimedScene : public testing::Test {
 protected:
  std::string write(const std::string& name, const std::string& text) const {
    fs::create_directories((folder_ / name).parent_path());
    std::ofstream(folder_ / name) << text;
    return (folder_ / name).string();
  }
  /// What an action complains of, without the name of the folder.
  template <class Action>
  std::string complaint_of(const Action& action) const {
    std::string words = error_of(action);
    const std::string prefix = folder_.string() + "/";
    for (std::size_t at; (at = words.find(prefix)) != std::string::npos;) words.erase(at, prefix.size());
    return words;
  }

  const ScratchFolder scratch_ = ScratchFolder::temporary("gnomon_time");
  const fs::path& folder_ = scratch_.path();
};

/// The least corner of the block.
glm::vec3 corner(const Scene& scene) {
  Bounds bounds;
  bounds.add(scene.meshes.at(1).positions);
  return bounds.min;
}

TEST(split_time, seconds_or_an_animation_and_seconds_follow_the_last_at_sign) {
  EXPECT_EQ(parts_of("fence"), "fence");
  EXPECT_EQ(parts_of("fence@0"), "fence |  | 0");
  EXPECT_EQ(parts_of("swarm:count=9,reach=0.5@1.25"), "swarm:count=9,reach=0.5 |  | 1.25");
  EXPECT_EQ(parts_of("swarm:count=9@fly=1e-3"), "swarm:count=9 | fly | 0.001");
  EXPECT_EQ(parts_of("models/x.glb@walk_2=.5"), "models/x.glb | walk_2 | 0.5");
  EXPECT_EQ(parts_of("me@home.glb@007.50"), "me@home.glb |  | 7.5");
}

TEST(split_time, a_folder_may_have_an_at_sign_in_its_name) {
  EXPECT_EQ(parts_of("a@b/x.glb"), "a@b/x.glb");
  EXPECT_EQ(parts_of("a@2/x.glb"), "a@2/x.glb");
  EXPECT_EQ(parts_of("a@2/x.glb@3"), "a@2/x.glb |  | 3");
}

TEST(split_time, what_is_no_time_is_refused_with_what_is_allowed) {
  for (const char* const text : {"", "-1", "+1", "1s", "1,5", "inf", "nan", "1e999", "0x1p3", " 1", "1 ", "=1", "walk",
                                 "walk=", "Walk=1", "walk=-1", "walk==1", "a=b=1", "walk=1=2"}) {
    const std::string reference = fmt::format("fence@{}", text);
    expect_words(error_of([&] { split_time(reference); }),
                 {fmt::format("scene {}: '{}' behind the @ is neither SECONDS nor ANIMATION=SECONDS", reference, text),
                  "a number of 0 or more"});
    EXPECT_EQ(without_time(reference), reference);
  }
}

TEST_F(TimedScene, the_name_of_a_file_with_an_at_has_no_time) {
  const std::string file = write("sprite@2x.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"), odd = write("x@1", "");
  EXPECT_EQ(parts_of(file), file);
  EXPECT_EQ(load_scene(file).triangle_count(), 1u);
  EXPECT_EQ(parts_of(odd), (folder_ / "x").string() + " |  | 1") << "no scene has such a name";
  expect_words(complaint_of([&] { load_scene((folder_ / "no@2x.obj").string()); }), {"'2x.obj'", "no@2x.obj is no file"});
  fs::create_directory(folder_ / "fence@1");
  EXPECT_EQ(parts_of((folder_ / "fence@1").string()), (folder_ / "fence").string() + " |  | 1") << "a folder is no scene";
}

TEST(with_time, is_canonical) {
  EXPECT_EQ(with_time("fence", {"", 1}), "fence@1");
  EXPECT_EQ(with_time("fence", {"walk", 0.1}), "fence@walk=0.1");
  EXPECT_EQ(with_time("fence", {"", -0.0}), "fence@0");
  EXPECT_EQ(with_time("fence", {"", 100000}), "fence@100000");
}

RC_GTEST_PROP(with_time, gives_back_the_very_number, (const std::string& letters)) {
  std::string name;
  for (const char c : letters)
    if (c >= 'a' && c <= 'z') name += c;
  const PoseTime at{name, std::abs(*rc::gen::arbitrary<double>())};
  RC_PRE(std::isfinite(at.seconds));
  const TimedReference read = split_time(with_time("soup:count=3", at));
  RC_ASSERT(read.scene == "soup:count=3");
  RC_ASSERT(read.at.has_value());
  RC_ASSERT(read.at->animation == at.animation);
  RC_ASSERT(read.at->seconds == at.seconds);
}

TEST(at_times, gives_each_scene_each_time) {
  using Words = std::vector<std::string>;
  EXPECT_EQ(at_times({"a", "b:n=1"}, "", {0, 0.5}), (Words{"a@0", "a@0.5", "b:n=1@0", "b:n=1@0.5"}));
  EXPECT_EQ(at_times({"a"}, "walk", {1.5}), Words{"a@walk=1.5"});
  EXPECT_EQ(at_times({"a", "b@walk=01.50"}, "", {}), (Words{"a", "b@walk=1.5"}));
}

TEST(at_times, refuses_what_is_no_time) {
  const double nan = std::numeric_limits<double>::quiet_NaN(), infinity = std::numeric_limits<double>::infinity();
  const auto refused = [](const std::string& animation, const std::vector<double>& times, const std::string& scene = "a") {
    return error_of([&] { at_times({scene}, animation, times); });
  };
  EXPECT_EQ(refused("", {0, -1}), "time = -1 is not a number of seconds, 0 or more");
  for (const double seconds : {nan, infinity, -infinity}) expect_words(refused("", {seconds}), {"is not a number of seconds"});
  EXPECT_EQ(refused("walk", {}), "animation = walk needs a time: the seconds at which it is shown");
  expect_words(refused("Walk", {0}), {"animation = 'Walk' is not a name of a..z"});
  expect_words(refused("", std::vector<double>(most_times + 1)), {"10001 times are given; at most 10000 are taken"});
  EXPECT_EQ(refused("", {2}, "a@1"), "scene a@1 has a time already, and gets another: 2");
  expect_words(refused("", {}, "a@b"), {"'b' behind the @"});
}

TEST_F(TimedScene, a_time_makes_a_still_that_has_the_time_in_its_name) {
  const std::string file = write("moving.toml", moving);
  EXPECT_EQ(corner(load_scene(file)), glm::vec3(0, 1, 0));
  EXPECT_TRUE(load_scene(file).motion);
  const Scene still = load_scene(file + "@0.5");
  EXPECT_EQ(still.name, "moving@0.5");
  EXPECT_FALSE(still.motion);
  EXPECT_EQ(corner(still), glm::vec3(1, 1, 0)) << "4 m in 2 s, after half a second";
  EXPECT_EQ(corner(load_scene(file + "@slide=9")), glm::vec3(4, 1, 0)) << "behind the last key";
  EXPECT_EQ(corner(load_scene(file + "@lift=0.25")), glm::vec3(0, 1.25f, 0));
  EXPECT_EQ(still.meshes[0].positions, load_scene(file).meshes[0].positions);
}

TEST_F(TimedScene, a_description_starts_from_a_scene_at_a_time) {
  write("base/moving.toml", moving);
  const std::string top = write("top.toml", "scene = \"base/moving.toml@lift=0.5\"\n"),
                    beside = write("tops/beside.toml", "scene = \"../top.toml\"\n");
  for (const std::string& file : {top, beside}) {
    const Scene scene = load_scene(file);
    EXPECT_EQ(corner(scene), glm::vec3(0, 1.5f, 0));
    EXPECT_FALSE(scene.motion);
  }
  expect_words(complaint_of([&] { load_scene(top + "@1"); }), {"scene top has no animation"});
  const std::string wrong = write("wrong.toml", "scene = \"base/moving.toml@soon\"\n");
  expect_words(complaint_of([&] { load_scene(wrong); }), {"'soon' behind the @", "(named in wrong.toml:1)"});
}

TEST_F(TimedScene, an_animation_that_the_scene_lacks_is_refused_with_those_that_it_has) {
  const std::string file = write("moving.toml", moving), still = write("still.toml", moving.substr(0, moving.find("[[path]]")));
  expect_words(complaint_of([&] { load_scene(file + "@walk=1"); }), {"walk", "slide", "lift"});
  expect_words(complaint_of([&] { load_scene(still + "@1"); }), {"scene still has no animation"});
  expect_words(error_of([] { load_scene("contact@1"); }), {"scene contact has no animation"});
  expect_words(error_of([] { load_scene("contac@1"); }), {"scene contac does not exist", "did you mean contact?"});
}

TEST_F(TimedScene, files_are_known_by_their_names_whatever_the_time) {
  for (const char* const scene : {"x.glb", "x.toml", "a/x", "x.obj"}) {
    EXPECT_TRUE(names_file(scene));
    EXPECT_TRUE(names_file(fmt::format("{}@1.5", scene)));
    EXPECT_TRUE(names_file(fmt::format("{}@walk=1.5", scene)));
  }
  EXPECT_EQ(scene_in_words("scene/office.toml@1.5"), "scene/office.toml@1.5");
  EXPECT_EQ(scene_in_words("fence@1.5"), "scene fence@1.5");
  EXPECT_FALSE(names_file("fence@1.5"));
  EXPECT_FALSE(names_file("swarm:count=3@fly=1"));
}

TEST_F(TimedScene, a_still_whose_files_are_not_fetched_is_not_there) {
  const std::string missing = write("missing.toml", "[[mesh]]\nfile = \"cache:no_such_scene/x.glb\"\n");
  EXPECT_FALSE(is_fetched(missing + "@1"));
  EXPECT_THROW(load_scene(missing + "@1"), SceneNotFetched);
  EXPECT_TRUE(is_fetched(write("moving.toml", moving) + "@slide=1"));
  const std::string above = write("above.toml", "scene = \"missing.toml@1\"\n");
  EXPECT_FALSE(is_fetched(above));
  EXPECT_THROW(load_scene(above + "@2"), SceneNotFetched);
}

}  // namespace time_reference_test
