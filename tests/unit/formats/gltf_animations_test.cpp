// Channels and keys of glTF's animations: what they become, what is refused and what is left out.
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <cmath>
#include <limits>

#include "formats/gltf_animated.h"

namespace gltf_animations_test {

using namespace gnomon;
using namespace gnomon::importing;
using namespace gnomon::gltf_made;
using Property = Track::Property;
using Interpolation = Track::Interpolation;

std::vector<std::string> names(const MeshFile& file) {
  std::vector<std::string> names;
  for (const Animation& animation : file.motion.animations) names.push_back(animation.name);
  return names;
}

TEST(GltfAnimations, cubic_keys_have_their_tangents_and_rotations_unit_values) {
  Animated file;
  file.add(0, "rotation", {0.5, 1}, std::vector<float>{1, 2, 3, 4, 0, 0, 0, 2, 5, 6, 7, 8, 0, 0, 0, 9, 3, 0, 4, 0, 1, 1, 1, 1},
           "CUBICSPLINE");
  const Track track = file.read().motion.animations.at(0).tracks.at(0);
  EXPECT_EQ(track.interpolation, Interpolation::cubic);
  EXPECT_EQ(track.width(), 4u);
  const std::vector<double> wanted = {1, 2, 3, 4, 0, 0, 0, 1, 5, 6, 7, 8, 0, 0, 0, 9, .6, 0, .8, 0, 1, 1, 1, 1};
  ASSERT_EQ(track.values.size(), wanted.size());
  for (std::size_t k = 0; k < wanted.size(); ++k) EXPECT_NEAR(track.values[k], wanted[k], 1e-15) << k;
}

TEST(GltfAnimations, normalized_integers_are_shares) {
  Animated file;
  file.add(0, "rotation", {0, 1}, std::vector<std::int16_t>{0, 0, 0, 32767, 0, 32767, 0, -32768}, "LINEAR");
  file.json["accessors"][2]["normalized"] = true;
  const std::vector<double> values = file.read().motion.animations.at(0).tracks.at(0).values;
  EXPECT_EQ(values[3], 1);
  EXPECT_NEAR(values[5], std::sqrt(.5), 1e-15) << "1 and -1, then normalized";
  EXPECT_NEAR(values[7], -std::sqrt(.5), 1e-15);
}

TEST(GltfAnimations, names_are_plain_and_unique) {
  Animated file;
  for (const char* name : {"Walk Cycle", "walk_cycle", "", "\x1b", "walk cycle", "walk_cycle_2"}) {
    file.json["animations"].push_back(json_object({{"name", name}, {"channels", Json::array()}, {"samplers", Json::array()}}));
    file.add(0, "translation", {0}, std::vector<float>{0, 0, 0}, "STEP", file.json["animations"].size() - 1);
  }
  const MeshFile read = file.read();
  EXPECT_EQ(names(read), (std::vector<std::string>{"walk_cycle", "walk_cycle_2", "animation", "animation_2", "walk_cycle_3",
                                                   "walk_cycle_2_2"}));
  EXPECT_EQ(read.notes, (std::vector<std::string>{"6 animations move meshes; SCENE@SECONDS is a still at a time",
                                                  "1 animation moves no mesh and is left out"}));
}

TEST(GltfAnimations, what_moves_no_mesh_is_noted_and_left_out) {
  Animated file;
  file.json["nodes"] = parse_json(R"([{"mesh":0},{"camera":0},{"mesh":0},
    {"children":[4],"extensions":{"KHR_node_visibility":{"visible":false}}},{"mesh":0}])");
  file.json["cameras"] = parse_json(R"([{"type":"perspective","perspective":{"yfov":1,"znear":1}}])");
  file.json["scenes"][0]["nodes"] = parse_json("[0,1,3]");
  file.add_step();
  file.add(1, "translation", {0}, std::vector<float>{0, 0, 0}, "STEP");  // a camera
  file.add(2, "translation", {0}, std::vector<float>{0, 0, 0}, "STEP");  // outside of the scene
  file.add(3, "translation", {0}, std::vector<float>{0, 0, 0}, "STEP");  // hidden
  file.add(0, "weights", {0}, std::vector<float>{0}, "STEP");            // no morph targets
  file.add(0, "scale", {0}, std::vector<float>{0, 0, 0}, "STEP");
  file.channel(5)["target"].erase("node");
  file.add(0, "scale", {0}, std::vector<float>{0, 0, 0}, "STEP");
  file.channel(6)["target"] = parse_json(R"({"path":"pointer","extensions":{"KHR_animation_pointer":{"pointer":"/a"}}})");
  const MeshFile read = file.read();
  ASSERT_EQ(read.motion.animations.size(), 1u);
  EXPECT_EQ(read.motion.animations[0].tracks.size(), 1u);
  EXPECT_EQ(read.notes, (std::vector<std::string>{
                            "1 node with meshes stands outside of the default scene and is left out",
                            "1 node with meshes or lights is hidden by KHR_node_visibility and left out",
                            "1 animation moves meshes; SCENE@SECONDS is a still at a time",
                            "4 channels of animations move no mesh and are left out",
                            "1 channel of animations has no node and is left out",
                            "1 channel of animations is of KHR_animation_pointer and is left out",
                            "1 camera or light is at a node that animations move, and stays where the file has it",
                        }));
}

TEST(GltfAnimations, keys_may_have_the_time_of_the_key_before) {
  Animated file;
  file.add(0, "translation", {0, 1, 1, 2}, std::vector<float>(12), "LINEAR");
  const MeshFile read = file.read();
  EXPECT_EQ(read.motion.animations.at(0).tracks.at(0).times, (std::vector<double>{0, 1, 1, 2}));
  expect_words(read.notes.at(1), {"1 key of animations has the time of the key before"});
}

TEST(GltfAnimations, one_key_and_very_many_are_read) {
  Animated file;
  constexpr std::size_t count = 100'000;
  std::vector<float> times(count), values(3 * count);
  for (std::size_t k = 0; k < count; ++k) {
    times[k] = static_cast<float>(k) / 64;
    values[3 * k] = static_cast<float>(k);
  }
  file.add(0, "translation", times, values, "LINEAR");
  file.add(0, "rotation", {3}, std::vector<float>{0, 0, 0, 1}, "LINEAR");
  const Animation read = file.read().motion.animations.at(0);
  EXPECT_EQ(read.tracks.at(0).times.size(), count);
  EXPECT_EQ(read.tracks[0].values[3 * (count - 1)], static_cast<double>(count - 1));
  EXPECT_EQ(read.end(), static_cast<double>(count - 1) / 64);
  EXPECT_EQ(read.tracks.at(1).times, std::vector<double>{3});
}

TEST(GltfAnimations, animations_that_make_no_sense_are_refused_with_their_place) {
  Animated file;
  file.add_step();
  const Json sound = file.json;
  const auto error = [&](auto spoil) {
    file.json = sound;
    spoil();
    return file.error();
  };
  const auto keys = [&](const std::vector<float>& times) {
    return [&file, times] { file.sampler()["input"] = file.accessor(times, "SCALAR", 1); };
  };
  const auto values = [&](const std::vector<float>& numbers) {
    return [&file, numbers] { file.sampler()["output"] = file.accessor(numbers, "VEC3", 3); };
  };
  constexpr float nan = std::numeric_limits<float>::quiet_NaN(), infinity = std::numeric_limits<float>::infinity();
  EXPECT_EQ(error([] {}), "");
  expect_words(error(keys({1, .5})), {"a.gltf: animation 0, channel 0, key 1: time = 0.5 is below 1", "must ascend"});
  expect_words(error(keys({-1, 0})), {"animation 0, channel 0, key 0: time = -1", "0 or more"});
  expect_words(error(keys({0, nan})), {"channel 0, key 1: time = nan"});
  expect_words(error(keys({0, infinity})), {"channel 0, key 1: time = inf"});
  expect_words(error(keys({})), {"channel 0: its sampler has no keys"});
  expect_words(error(values({0, 0, 0, 0, nan, 0})), {"channel 0, key 1: value = nan"});
  expect_words(error(values({infinity, 0, 0, 0, 0, 0})), {"channel 0, key 0: value = inf"});
  expect_words(error(values({0, 0, 0})), {"channel 0", "2 keys and 1 elements of output; 2 are wanted"});
  expect_words(error([&] { file.sampler()["interpolation"] = "CUBICSPLINE"; }), {"2 keys with tangents", "6 are wanted"});
  expect_words(error([&] { file.sampler()["interpolation"] = "BEZIER"; }),
               {"channel 0: interpolation = 'BEZIER' is none of LINEAR, STEP, CUBICSPLINE"});
  expect_words(error([&] { file.sampler()["interpolation"] = 5; }), {"interpolation = '5' is none of"});
  expect_words(error([&] { file.channel()["target"]["path"] = "color"; }),
               {"channel 0: path = 'color' is none of translation, rotation, scale, weights"});
  expect_words(error([&] { file.channel()["target"]["path"] = "rotation"; }), {"accessor", "VEC3", "4 numbers"});
  expect_words(error([&] { file.channel()["target"]["node"] = 1; }), {"animation 0, channel 0 names node 1 of 1"});
  expect_words(error([&] { file.channel().erase("target"); }), {"animation 0, channel 0 has no target"});
  expect_words(error([&] { file.channel()["sampler"] = 1; }), {"animation 0, channel 0 names sampler 1 of 1"});
  expect_words(error([&] { file.channel().erase("sampler"); }), {"channel 0 has no sampler"});
  expect_words(error([&] { file.sampler().erase("output"); }), {"channel 0: its sampler lacks its output"});
  expect_words(error([&] { file.json["nodes"][0]["matrix"] = parse_json("[1,0,0,0,0,1,0,0,0,0,1,0,0,0,0,1]"); }),
               {"animation 0, channel 0 moves node 0, which has a matrix"});
  expect_words(error([&] { file.add_step(); }), {"animation 0, channel 1 moves the translation of node 0", "one for each"});
  expect_words(error([&] { file.json["animations"][0] = 3; }), {"item 0 of 'animations' is no object"});
}

TEST(GltfAnimations, a_rotation_of_length_0_is_refused) {
  Animated file;
  file.add(0, "rotation", {0, 1}, std::vector<float>{0, 0, 0, 1, 0, 0, 0, 0}, "LINEAR");
  expect_words(file.error(), {"animation 0, channel 0, key 1: rotation = (0, 0, 0, 0) is none"});
}

/// Random times and values come back as they are, rotations as unit quaternions.
RC_GTEST_PROP(GltfAnimations, random_tracks_are_read_as_they_are, ()) {
  const auto number = [] { return static_cast<float>(*rc::gen::inRange(-1000, 1000)) / 8; };
  const char* const paths[] = {"translation", "rotation", "scale", "weights"};
  const char* const words[] = {"STEP", "LINEAR", "CUBICSPLINE"};
  const int target_count = *rc::gen::inRange(1, 4);
  Animated file;
  for (int t = 0; t < target_count; ++t) file.add_target();
  std::vector<std::vector<float>> all_times, all_values;
  std::vector<int> kinds;
  for (int p = 0; p < 4; ++p) {
    const int kind = kinds.emplace_back(*rc::gen::inRange(0, 3));
    const int key_count = *rc::gen::inRange(1, 8);
    const int width = p == 1 ? 4 : p == 3 ? target_count : 3;
    std::vector<float>& times = all_times.emplace_back();
    for (int k = 0; k < key_count; ++k)
      times.push_back((times.empty() ? 0 : times.back()) + static_cast<float>(*rc::gen::inRange(0, 9)));
    std::vector<float>& values = all_values.emplace_back();
    for (int k = 0; k < key_count * width * (kind == 2 ? 3 : 1); ++k) values.push_back(number());
    for (std::size_t k = 3; p == 1 && k < values.size(); k += 4) values[k] = std::abs(values[k]) + 1;
    file.add(0, paths[p], times, values, words[kind]);
  }
  const MeshFile read = file.read();
  const std::vector<Track>& tracks = read.motion.animations.at(0).tracks;
  RC_ASSERT(tracks.size() == 4u);
  for (std::size_t p = 0; p < 4; ++p) {
    const Track& track = tracks[p];
    RC_ASSERT(track.property == static_cast<Property>(p));
    RC_ASSERT(track.interpolation == static_cast<Interpolation>(kinds[p]));
    RC_ASSERT(track.times == std::vector<double>(all_times[p].begin(), all_times[p].end()));
    std::vector<double> wanted(all_values[p].begin(), all_values[p].end());
    const bool is_cubic = kinds[p] == 2;
    for (std::size_t k = is_cubic ? 4 : 0; p == 1 && k < wanted.size(); k += is_cubic ? 12 : 4) {
      const double length = std::hypot(std::hypot(wanted[k], wanted[k + 1]), std::hypot(wanted[k + 2], wanted[k + 3]));
      for (std::size_t i = k; i < k + 4; ++i) {
        RC_ASSERT(std::abs(track.values[i] - wanted[i] / length) < 1e-15);
        wanted[i] = track.values[i];
      }
    }
    RC_ASSERT(track.values == wanted);
  }
}

}  // namespace gltf_animations_test
