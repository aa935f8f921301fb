// What the animations of a glTF file move: nodes, skins, morph targets, and the vertices that they place.
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <cmath>
#include <limits>

#include "formats/gltf_animated.h"

namespace gltf_motion_test {

using namespace gnomon;
using namespace gnomon::importing;
using namespace gnomon::gltf_made;

/// Each place's matrix by the nodes of the motion, as they are in the file.
std::vector<glm::dmat4> places_at_rest(const Motion& motion) {
  std::vector<glm::dmat4> world;
  for (const MotionNode& node : motion.nodes) {
    const glm::dmat4 own = node.matrix ? *node.matrix : node_matrix(node.translation, node.rotation, node.scale);
    world.push_back(node.parent == MotionNode::none ? own : world.at(node.parent) * own);
  }
  return world;
}

TEST(GltfMotion, nodes_come_with_their_parents_first) {
  Animated file;
  file.json["nodes"] = parse_json(R"([{"mesh":0,"scale":[2,2,2]},{"matrix":[1,0,0,0,0,1,0,0,0,0,1,0,3,0,0,1],"children":[2]},
    {"rotation":[0,0,0,2],"children":[0]}])");
  file.json["scenes"][0]["nodes"] = parse_json("[1]");
  file.add(2, "translation", {0, 1}, std::vector<float>{0, 0, 0, 0, 5, 0}, "STEP");
  const MeshFile read = file.read();
  ASSERT_EQ(read.motion.nodes.size(), 3u);
  EXPECT_EQ(read.motion.nodes[0].parent, MotionNode::none);
  EXPECT_EQ(read.motion.nodes[0].matrix.value()[3], glm::dvec4(3, 0, 0, 1)) << "a matrix stays one";
  EXPECT_EQ(read.motion.nodes[1].parent, 0u);
  EXPECT_EQ(read.motion.nodes[1].rotation, glm::dvec4(0, 0, 0, 1)) << "normalized";
  EXPECT_EQ(read.motion.nodes[2].parent, 1u);
  EXPECT_EQ(read.motion.nodes[2].scale, glm::dvec3(2));
  EXPECT_EQ(read.meshes.at(0).nodes, std::vector<std::uint32_t>{2});
  const Track& track = read.motion.animations.at(0).tracks.at(0);
  EXPECT_EQ(track.node, 1u);
  EXPECT_EQ(track.property, Track::Property::translation);
  EXPECT_EQ(track.interpolation, Track::Interpolation::step);
  EXPECT_EQ(track.times, (std::vector<double>{0, 1}));
  EXPECT_EQ(track.values, (std::vector<double>{0, 0, 0, 0, 5, 0}));
  EXPECT_EQ(places_at_rest(read.motion)[2], read.meshes[0].places.at(0));
  EXPECT_EQ(read.notes, std::vector<std::string>{"1 animation moves meshes; SCENE@SECONDS is a still at a time"});
}

TEST(GltfMotion, a_rigid_mesh_needs_no_base) {
  Animated file;
  file.add_step();
  const MeshFile read = file.read();
  EXPECT_TRUE(read.meshes.at(0).base.empty());
  EXPECT_TRUE(read.meshes[0].targets.empty());
  EXPECT_EQ(read.meshes[0].skin, Rig::no_skin);
  EXPECT_TRUE(read.motion.skins.empty());
}

TEST(GltfMotion, meshes_that_nothing_moves_have_no_nodes) {
  Animated file;
  file.json["nodes"] = parse_json(R"([{"mesh":0},{"mesh":1}])");
  file.json["scenes"][0]["nodes"] = parse_json("[0,1]");
  file.add_target();
  file.json["meshes"].push_back(file.json["meshes"][0]);
  file.add_step();
  const MeshFile read = file.read();
  ASSERT_EQ(read.meshes.size(), 2u);
  EXPECT_EQ(read.meshes[0].nodes, std::vector<std::uint32_t>{0});
  EXPECT_FALSE(read.meshes[0].targets.empty());
  EXPECT_TRUE(read.meshes[1].nodes.empty());
  EXPECT_TRUE(read.meshes[1].base.empty());
  EXPECT_TRUE(read.meshes[1].targets.empty());
}

TEST(GltfMotion, all_places_of_a_mesh_have_a_node_where_one_of_them_moves) {
  Animated file;
  file.json["nodes"] = parse_json(R"([{"mesh":0,"name":"a"},{"mesh":0,"name":"b"},{"mesh":0,"name":"c"}])");
  file.json["scenes"][0]["nodes"] = parse_json("[0,1,2]");
  file.add(1, "translation", {0}, std::vector<float>{1, 2, 3}, "LINEAR");
  MeshFile read = file.read();
  ASSERT_EQ(read.meshes.size(), 3u) << "a mesh without a name has those of its nodes";
  EXPECT_TRUE(read.meshes[0].nodes.empty());
  EXPECT_EQ(read.meshes[1].nodes, std::vector<std::uint32_t>{1});
  EXPECT_TRUE(read.meshes[2].nodes.empty());
  file.json["meshes"][0]["name"] = "square";
  read = file.read();
  ASSERT_EQ(read.meshes.size(), 1u);
  EXPECT_EQ(read.meshes[0].nodes, (std::vector<std::uint32_t>{0, 1, 2}));
}

TEST(GltfMotion, instances_are_leaves_below_their_node) {
  Animated file;
  file.json["nodes"][0]["translation"] = parse_json("[0,1,0]");
  const std::size_t places = file.accessor(std::vector<float>{1, 0, 0, 2, 0, 0}, "VEC3", 3);
  file.json["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"]["TRANSLATION"] = places;
  file.add_target();
  file.json["nodes"][0]["weights"] = parse_json("[0.25]");
  file.add_step();
  file.add(0, "weights", {0, 1}, std::vector<float>{0, 1}, "LINEAR");
  const MeshFile read = file.read();
  EXPECT_EQ(read.meshes.at(0).nodes, (std::vector<std::uint32_t>{1, 2}));
  ASSERT_EQ(read.motion.nodes.size(), 3u);
  EXPECT_EQ(read.motion.nodes[2].parent, 0u);
  EXPECT_EQ(read.motion.nodes[2].matrix.value()[3], glm::dvec4(2, 0, 0, 1));
  EXPECT_EQ(read.motion.nodes[2].weights, std::vector<double>{0.25});
  const std::vector<glm::dmat4> rest = places_at_rest(read.motion);
  EXPECT_EQ(read.meshes[0].places, (std::vector<glm::dmat4>{rest[1], rest[2]}));
  const std::vector<Track>& tracks = read.motion.animations.at(0).tracks;
  ASSERT_EQ(tracks.size(), 3u) << "the weights move at each instance";
  EXPECT_EQ(tracks[0].node, 0u);
  EXPECT_EQ(tracks[1].node, 1u);
  EXPECT_EQ(tracks[2].node, 2u);
  EXPECT_EQ(tracks[2].values, tracks[1].values);
}

TEST(GltfMotion, morph_targets_stay_beside_the_base) {
  Animated file;
  file.add_target();
  file.add_target();
  file.primitive()["mode"] = 4;
  file.primitive()["indices"] = file.accessor(std::vector<std::uint8_t>{0, 3, 2}, "SCALAR", 1);
  file.add(0, "weights", {0, 1}, std::vector<float>{0, 0, 1, .5}, "LINEAR");
  MeshFile read = file.read();
  const ImportedMesh& mesh = read.meshes.at(0);
  EXPECT_EQ(mesh.base, (std::vector<glm::dvec3>{{0, 0, 0}, {0, 1, 0}, {1, 1, 0}})) << "corner 1 is unused";
  EXPECT_EQ(mesh.positions, mesh.base);
  EXPECT_EQ(mesh.targets, (std::vector<glm::dvec3>{{0, 0, 8}, {0, 0, 10}, {0, 0, 11}, {0, 0, 8}, {0, 0, 10}, {0, 0, 11}}));
  EXPECT_EQ(read.motion.nodes.at(0).weights, (std::vector<double>{0, 0}));
  EXPECT_EQ(read.motion.animations.at(0).tracks.at(0).width(), 2u);
  file.json["meshes"][0]["weights"] = parse_json("[0.5,0]");
  read = file.read();
  EXPECT_EQ(read.motion.nodes[0].weights, (std::vector<double>{0.5, 0})) << "of the mesh";
  EXPECT_EQ(read.meshes.at(0).positions[2], glm::dvec3(1, 1, 5.5));
  EXPECT_EQ(read.meshes[0].base[2], glm::dvec3(1, 1, 0));
  file.json["nodes"][0]["weights"] = parse_json("[0,1]");
  EXPECT_EQ(file.read().motion.nodes.at(0).weights, (std::vector<double>{0, 1})) << "of the node";
}

TEST(GltfMotion, a_target_without_positions_moves_nothing) {
  Animated file;
  file.add_target();
  file.primitive()["targets"].push_back(json_object({{"NORMAL", 0}}));
  file.add(0, "weights", {0}, std::vector<float>{0, 0}, "STEP");
  const MeshFile read = file.read();
  ASSERT_EQ(read.meshes.at(0).targets.size(), 8u);
  EXPECT_EQ(read.meshes[0].targets[3], glm::dvec3(0, 0, 11));
  EXPECT_EQ(read.meshes[0].targets[7], glm::dvec3(0));
}

TEST(GltfMotion, joints_and_weights_stay_beside_the_base) {
  const MeshFile read = skinned().read();
  const ImportedMesh& mesh = read.meshes.at(0);
  EXPECT_EQ(mesh.nodes, std::vector<std::uint32_t>{0});
  EXPECT_EQ(mesh.skin, 0u);
  EXPECT_EQ(mesh.places, std::vector<glm::dmat4>{glm::dmat4(1)});
  EXPECT_EQ(mesh.base, (std::vector<glm::dvec3>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}}));
  EXPECT_EQ(mesh.positions, (std::vector<glm::dvec3>{{10, 10, 0}, {11, 0, 0}, {10, 6, 0}, {11, 1, 0}}));
  EXPECT_EQ(mesh.joints_per_vertex, 4u);
  EXPECT_EQ(mesh.joints, (std::vector<std::uint32_t>{0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 1, 0, 0, 0}))
      << "a joint of weight 0 is 0";
  EXPECT_EQ(mesh.weights, (std::vector<double>{1, 0, 0, 0, 1, 0, 0, 0, .5, .5, 0, 0, 1, 0, 0, 0}));
  ASSERT_EQ(read.motion.skins.size(), 1u);
  EXPECT_EQ(read.motion.skins[0].joints, (std::vector<std::uint32_t>{2, 1}));
  EXPECT_EQ(read.motion.skins[0].inverse_bind, (std::vector<glm::dmat4>{glm::dmat4(1), glm::dmat4(1)})) << "without matrices";
}

TEST(GltfMotion, all_sets_of_joints_come_vertex_after_vertex) {
  Animated file = skinned();
  file.add_set(0, {0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0}, std::vector<float>(16, .125f));
  file.add_set(1, {1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1}, std::vector<float>(16, .125f));
  file.primitive()["mode"] = 4;
  file.primitive()["indices"] = file.accessor(std::vector<std::uint8_t>{0, 3, 2}, "SCALAR", 1);
  const MeshFile read = file.read();
  const ImportedMesh& mesh = read.meshes.at(0);
  EXPECT_EQ(mesh.joints_per_vertex, 8u);
  ASSERT_EQ(mesh.joints.size(), 24u) << "three vertices are used";
  ASSERT_EQ(mesh.weights.size(), 24u);
  for (std::size_t k = 0; k < 24; ++k) EXPECT_EQ(mesh.joints[k], k / 4 % 2) << k;
  EXPECT_EQ(mesh.base, (std::vector<glm::dvec3>{{0, 0, 0}, {0, 1, 0}, {1, 1, 0}}));
  EXPECT_EQ(mesh.positions[0], glm::dvec3(10, 5, 0));
}

TEST(GltfMotion, the_node_of_a_mesh_with_a_skin_moves_nothing) {
  Animated file = skinned();
  file.channel()["target"]["node"] = 0;
  MeshFile read = file.read();
  EXPECT_TRUE(read.motion.nodes.empty());
  EXPECT_TRUE(read.meshes.at(0).joints.empty());
  EXPECT_EQ(read.meshes[0].joints_per_vertex, 0u);
  EXPECT_EQ(read.notes, std::vector<std::string>{"1 animation moves no mesh and is left out"});
  file.channel()["target"]["node"] = 1;  // above a joint
  read = file.read();
  EXPECT_EQ(read.meshes.at(0).nodes, std::vector<std::uint32_t>{0});
  EXPECT_EQ(read.meshes[0].positions[0], glm::dvec3(10, 10, 0));
}

TEST(GltfMotion, weights_of_a_morph_may_move_under_a_still_skin) {
  Animated file = skinned();
  file.add_target();
  file.json["animations"] = parse_json(R"([{"channels":[],"samplers":[]}])");
  file.add(0, "weights", {0, 1}, std::vector<float>{0, 1}, "LINEAR");
  const MeshFile read = file.read();
  EXPECT_EQ(read.meshes.at(0).nodes, std::vector<std::uint32_t>{0});
  EXPECT_EQ(read.meshes[0].skin, 0u);
  EXPECT_EQ(read.meshes[0].targets.size(), 4u);
  EXPECT_EQ(read.meshes[0].base.size(), 4u);
}

TEST(GltfMotion, an_animation_changes_nothing_of_the_pose_of_the_file) {
  Animated file = skinned();
  file.add_target();
  file.json["meshes"][0]["weights"] = parse_json("[0.3]");
  file.json["skins"][0]["inverseBindMatrices"] =
      file.accessor(std::vector<float>{.6f, .8f, 0, 0, -.8f, .6f, 0, 0, 0, 0, 1, 0, .1f, .2f, .3f, 1,
                                       1,   0,   0, 0, 0,    1,   0, 0, 0, 0, 1, 0, 0,   0,   .7f, 1},
                    "MAT4", 16);
  const MeshFile moved = file.read();
  file.json.erase("animations");
  const MeshFile still = file.read();
  EXPECT_TRUE(still.motion.nodes.empty());
  EXPECT_TRUE(still.meshes.at(0).nodes.empty());
  EXPECT_EQ(moved.meshes.at(0).positions, still.meshes[0].positions);
  EXPECT_EQ(moved.meshes[0].places, still.meshes[0].places);
}

TEST(GltfMotion, odd_sums_of_weights_are_noted_as_their_type_allows) {
  const auto note_count = [](const auto& weights, bool is_normalized) {
    Animated file = skinned();
    const std::size_t accessor = file.accessor(weights, "VEC4", 4);
    file.json["accessors"][accessor]["normalized"] = is_normalized;
    file.primitive()["attributes"]["WEIGHTS_0"] = accessor;
    file.primitive()["attributes"]["JOINTS_0"] = file.accessor(std::vector<std::uint8_t>(16), "VEC4", 4);
    return file.read().notes.size() - 1;  // beside that of the animation
  };
  const auto four_times = [](auto... weight) {
    std::vector<std::common_type_t<decltype(weight)...>> weights;
    for (int k = 0; k < 4; ++k) (weights.push_back(weight), ...);
    return weights;
  };
  // 127 + 127 of 255 is 0.0039 below 1, which rounding to 8 bits may give; floats are rounded more finely.
  EXPECT_EQ(note_count(four_times(std::uint8_t(127), std::uint8_t(127), std::uint8_t(0), std::uint8_t(0)), true), 0u);
  EXPECT_EQ(note_count(four_times(std::uint8_t(127), std::uint8_t(120), std::uint8_t(0), std::uint8_t(0)), true), 1u);
  EXPECT_EQ(note_count(four_times(.5f, .4961f, 0.f, 0.f), false), 1u);
  EXPECT_EQ(note_count(four_times(.5f, .5f + 3e-7f, 0.f, 0.f), false), 0u) << "two weights: 4e-7";
  EXPECT_EQ(note_count(four_times(1 + 3e-7f, 0.f, 0.f, 0.f), false), 1u) << "one weight: 2e-7";
}

TEST(GltfMotion, skins_and_targets_that_make_no_sense_are_refused) {
  Animated skin = skinned();
  skin.json["skins"][0]["joints"] = parse_json("[2,3]");
  expect_words(skin.error(), {"skin 0 names node 3 of 3"});
  skin.json["skins"][0]["joints"] = parse_json("[2]");
  expect_words(skin.error(), {"vertex 1 names joint 1 of 1"});
  skin = skinned();
  std::vector<float> matrices(32);
  matrices[20] = std::numeric_limits<float>::quiet_NaN();
  skin.json["skins"][0]["inverseBindMatrices"] = skin.accessor(matrices, "MAT4", 16);
  expect_words(skin.error(), {"skin 0, joint 1", "nan, which is not finite"});

  Animated morph;
  morph.add_target();
  morph.add(0, "weights", {0, 1}, std::vector<float>{0, 1, 2}, "LINEAR");
  expect_words(morph.error(), {"channel 0", "2 keys and 3 elements of output; 2 are wanted"});
  morph = Animated();
  morph.add_step();
  morph.primitive()["targets"] = parse_json(R"([{"POSITION":9}])");
  expect_words(morph.error(), {"item 9 of 'accessors'"});
  morph.primitive()["targets"][0]["POSITION"] =
      morph.accessor(std::vector<float>{0, 0, 0, 0, 0, 0, 0, 0, 0, 0, std::numeric_limits<float>::infinity(), 0}, "VEC3", 3);
  expect_words(morph.error(), {"mesh 0, primitive 0, target 0 moves vertex 3 by (0, inf, 0)"});
}

TEST(GltfMotion, primitives_that_move_have_equally_many_targets) {
  Animated file;
  file.add_target();
  file.json["meshes"][0]["primitives"].push_back(file.primitive());
  file.json["meshes"][0]["primitives"][1]["targets"].push_back(file.primitive()["targets"][0]);
  EXPECT_EQ(file.error(), "") << "without an animation";
  file.add_step();
  expect_words(file.error(), {"node 0", "1 and 2 morph targets"});
}

/// Trees of any order and depth, some nodes with matrices: the motion's nodes give the places of the file, bit for bit.
RC_GTEST_PROP(GltfMotion, nodes_at_rest_give_the_places_of_the_file, ()) {
  const auto number = [] { return static_cast<double>(*rc::gen::inRange(-1000, 1000)) / 7; };
  const int count = *rc::gen::inRange(2, 12);
  Animated file;
  file.json["meshes"][0]["name"] = "square";
  file.json["nodes"] = Json::array();
  for (int n = 0; n < count; ++n) {
    Json node = json_object({{"mesh", 0}});
    if (n > 0 && *rc::gen::inRange(0, 4) == 0) {
      node["matrix"] = Json::array();
      for (int i = 0; i < 16; ++i) node["matrix"].push_back(i % 4 == 3 ? double(i == 15) : number());
    } else {
      node["translation"] = Json::array({number(), number(), number()});
      node["rotation"] = Json::array({number(), number(), number(), std::abs(number()) + 1});
      node["scale"] = Json::array({number(), number(), number()});
    }
    file.json["nodes"].push_back(node);
  }
  // Node 0 is the root; each other hangs below one of a smaller number in a shuffled order.
  std::vector<int> order = {0};
  for (int n = 1; n < count; ++n) order.insert(order.begin() + *rc::gen::inRange(1, n + 1), n);
  for (int k = 1; k < count; ++k)
    file.json["nodes"][static_cast<std::size_t>(order[static_cast<std::size_t>(*rc::gen::inRange(0, k))])]["children"]
        .push_back(order[static_cast<std::size_t>(k)]);
  file.add_step();
  const MeshFile read = file.read();
  RC_ASSERT(read.meshes.size() == 1u);
  RC_ASSERT(read.motion.nodes.size() == static_cast<std::size_t>(count));
  const std::vector<glm::dmat4> rest = places_at_rest(read.motion);
  RC_ASSERT(read.meshes[0].nodes.size() == read.meshes[0].places.size());
  for (std::size_t k = 0; k < rest.size(); ++k) RC_ASSERT(rest[read.meshes[0].nodes[k]] == read.meshes[0].places[k]);
  file.json.erase("animations");
  RC_ASSERT(file.read().meshes.at(0).places == read.meshes[0].places);
}

}  // namespace gltf_motion_test
