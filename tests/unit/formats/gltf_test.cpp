// glTF, read directly: nodes, accessors, skins, morph targets, and what is refused.
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "formats/gltf_made.h"
#include "measure/formats/gltf_file.h"

namespace gltf_test {

using namespace gnomon;
using namespace gnomon::importing;
using namespace gnomon::gltf_made;

std::vector<std::uint32_t> corners(const MeshFile& file) { return file.meshes.at(0).corners; }

RC_GTEST_PROP(Base64, gives_back_any_bytes, (const std::string& bytes)) { RC_ASSERT(from_base64("x", base64(bytes)) == bytes); }

TEST(Gltf, names_in_addresses_are_decoded) {
  EXPECT_EQ(percent_decoded("my%20buf%2e%62in"), "my buf.bin");
  EXPECT_EQ(percent_decoded("100%"), "100%");
  EXPECT_EQ(percent_decoded("a%zzb"), "a%zzb");
}

TEST(Gltf, strips_and_fans_keep_their_orientation) {
  // Of the specification: strip {v i, v i+(1+i%2), v i+(2-i%2)}, fan {v i+1, v i+2, v 0}.
  Gltf strip;
  strip.add_square();
  strip.primitive()["mode"] = 5;
  EXPECT_EQ(corners(strip.read()), (std::vector<std::uint32_t>{0, 1, 2, 1, 3, 2}));
  strip.primitive()["mode"] = 6;
  EXPECT_EQ(corners(strip.read()), (std::vector<std::uint32_t>{1, 2, 0, 2, 3, 0}));
}

TEST(Gltf, indices_of_each_type_are_read) {
  const std::vector<std::uint32_t> wanted = {0, 1, 2, 2, 1, 3};
  for (int bits : {8, 16, 32}) {
    Gltf file;
    file.add_square();
    file.primitive()["indices"] =
        bits == 8    ? file.accessor(std::vector<std::uint8_t>(wanted.begin(), wanted.end()), "SCALAR", 1)
        : bits == 16 ? file.accessor(std::vector<std::uint16_t>(wanted.begin(), wanted.end()), "SCALAR", 1)
                     : file.accessor(wanted, "SCALAR", 1);
    EXPECT_EQ(corners(file.read()), wanted) << bits;
  }
}

TEST(Gltf, points_and_lines_are_counted) {
  for (const auto& [mode, count] : {std::pair(0, 4), std::pair(1, 2), std::pair(2, 4), std::pair(3, 3)}) {
    Gltf file;
    file.add_square();
    file.primitive()["mode"] = mode;
    EXPECT_EQ(file.read().notes.at(0), fmt::format("{} points and lines are left out", count)) << mode;
  }
}

TEST(Gltf, normalized_numbers_are_shares_of_their_largest) {
  Gltf file;
  const std::size_t positions =
      file.accessor(std::vector<std::int16_t>{-32768, 0, 0, 0, 32767, 0, 0, 0, 0, 16384, 0, 0}, "VEC3", 4);
  file.json["accessors"][positions]["normalized"] = true;
  file.json["accessors"][positions]["count"] = 3;
  file.json["bufferViews"][0]["byteStride"] = 8;
  file.primitive()["attributes"]["POSITION"] = positions;
  const std::vector<glm::dvec3> read = file.read().meshes.at(0).positions;
  EXPECT_EQ(read[0], glm::dvec3(-1, 0, 0)) << "below -1 is -1";
  EXPECT_EQ(read[1], glm::dvec3(1, 0, 0));
  EXPECT_EQ(read[2], glm::dvec3(0, 16384 / 32767.0, 0));
}

TEST(Gltf, sparse_numbers_replace_some) {
  Gltf file;
  file.add_square();
  Json sparse = json_object({{"count", 1}});
  sparse["indices"] = json_object({{"bufferView", file.view(std::vector<std::uint8_t>{2})}, {"componentType", 5121}});
  sparse["values"] = json_object({{"bufferView", file.view(std::vector<float>{7, 8, 9})}});
  file.json["accessors"][0]["sparse"] = sparse;
  file.primitive()["mode"] = 5;
  EXPECT_EQ(file.read().meshes.at(0).positions[2], glm::dvec3(7, 8, 9));
  file.json["accessors"][0].erase("bufferView");  // then the others are 0
  EXPECT_EQ(file.read().meshes.at(0).positions[1], glm::dvec3(0, 0, 0));
  file.json["accessors"][0]["sparse"]["count"] = 5;
  expect_words(file.error(), {"accessor 0", "replaces 5 elements of 4"});
}

TEST(Gltf, nodes_move_their_children) {
  Gltf file;
  file.add_square();
  file.primitive()["mode"] = 5;
  file.json["nodes"] = parse_json(R"([{"children":[1],"scale":[2,2,2]},
    {"mesh":0,"translation":[1,0,0],"rotation":[0,0,0.7071067811865476,0.7071067811865476]}])");
  const glm::dmat4 place = file.read().meshes.at(0).places.at(0);
  const glm::dvec4 moved = place * glm::dvec4(1, 0, 0, 1);  // turned about z to (0, 1, 0), moved to (1, 1, 0), scaled
  EXPECT_LT(glm::length(moved - glm::dvec4(2, 2, 0, 1)), 1e-12);
}

TEST(Gltf, nodes_that_are_no_tree_are_refused) {
  Gltf file;
  file.add_square();
  file.json["nodes"] = parse_json(R"([{"children":[1]},{"children":[2]},{"children":[1],"mesh":0}])");
  expect_words(file.error(), {"node 1", "more than one node"});
  file.json["nodes"] = parse_json(R"([{"children":[0],"mesh":0}])");
  expect_words(file.error(), {"node 0", "below itself"});
  file.json["nodes"] = parse_json(R"([{"mesh":0},{"children":[2]},{"children":[1]}])");
  expect_words(file.error(), {"below themselves"});
  file.json["nodes"] = parse_json(R"([{"mesh":0,"children":[5]}])");
  expect_words(file.error(), {"node 0", "names node 5 of 1"});
}

TEST(Gltf, a_chain_of_many_nodes_is_no_trouble) {
  Gltf file;
  file.add_square();
  file.primitive()["mode"] = 5;
  Json nodes = Json::array();
  constexpr std::size_t count = 50'000;
  for (std::size_t n = 0; n + 1 < count; ++n) nodes.push_back(json_object({{"children", Json::array({n + 1})}}));
  nodes.push_back(json_object({{"mesh", 0}}));
  file.json["nodes"] = nodes;
  EXPECT_EQ(file.read().meshes.size(), 1u);
}

TEST(Gltf, what_stands_outside_of_the_default_scene_is_noted) {
  Gltf file;
  file.add_square();
  file.primitive()["mode"] = 5;
  file.json["nodes"] = parse_json(R"([{"mesh":0},{"mesh":0}])");
  file.json["animations"] = parse_json(R"([{},{}])");
  file.json["cameras"] = parse_json(R"([{"type":"perspective","perspective":{"yfov":1,"znear":1}}])");
  EXPECT_EQ(file.read().notes,
            (std::vector<std::string>{"1 node with meshes stands outside of the default scene and is left out",
                                      "1 camera stands at no node of the scene and is left out",
                                      "2 animations move no mesh and are left out"}));
}

TEST(Gltf, skins_put_vertices_where_their_joints_are) {
  Gltf file;
  file.add_square();
  file.primitive()["mode"] = 5;
  file.json["nodes"] =
      parse_json(R"([{"mesh":0,"skin":0,"translation":[9,9,9]},{"translation":[10,0,0]},{"translation":[0,10,0]}])");
  file.json["scenes"][0]["nodes"] = Json::array({0, 1, 2});
  file.json["skins"] = parse_json(R"([{"joints":[1,2]}])");
  Json& attributes = file.primitive()["attributes"];
  attributes["JOINTS_0"] = file.accessor(std::vector<std::uint8_t>{0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 1, 0, 0, 0}, "VEC4", 4);
  attributes["WEIGHTS_0"] = file.accessor(std::vector<float>{1, 0, 0, 0, 1, 0, 0, 0, 0.5, 0.5, 0, 0, 0.5, 0, 0, 0}, "VEC4", 4);
  MeshFile read = file.read();
  EXPECT_EQ(read.meshes.at(0).places.at(0), glm::dmat4(1)) << "the mesh's own place counts for nothing";
  EXPECT_EQ(read.meshes[0].positions, (std::vector<glm::dvec3>{{10, 0, 0}, {1, 10, 0}, {5, 6, 0}, {0.5, 5.5, 0}}));
  expect_words(read.notes.at(0), {"1 vertex has weights", "sum is not 1"});
  file.json["skins"] = parse_json(R"([{"joints":[1]}])");
  expect_words(file.error(), {"vertex 1 names joint 1 of 1"});
}

TEST(Gltf, morph_targets_count_by_their_weights) {
  Gltf file;
  file.add_square();
  file.primitive()["mode"] = 5;
  const std::size_t target = file.accessor(std::vector<float>{0, 0, 4, 0, 0, 4, 0, 0, 4, 0, 0, 8}, "VEC3", 3);
  file.primitive()["targets"] = Json::array({json_object({{"POSITION", target}})});
  const auto height = [&] { return file.read().meshes.at(0).positions[3].z; };
  EXPECT_EQ(height(), 0) << "no weights";
  file.json["meshes"][0]["weights"] = Json::array({0.5});
  EXPECT_EQ(height(), 4) << "of the mesh";
  file.json["nodes"][0]["weights"] = Json::array({0.25});
  EXPECT_EQ(height(), 2) << "of the node";
  file.json["nodes"][0]["weights"] = Json::array({1, 1});
  expect_words(file.error(), {"1 morph targets and 2 weights"});
}

TEST(Gltf, what_many_nodes_have_is_read_once) {
  Gltf file;
  file.add_square();
  file.primitive()["mode"] = 5;
  file.json["nodes"] = parse_json(R"([{"mesh":0},{"mesh":0,"translation":[5,0,0]}])");
  file.json["scenes"][0]["nodes"] = Json::array({0, 1});
  const MeshFile read = file.read();
  ASSERT_EQ(read.meshes.size(), 1u);
  ASSERT_EQ(read.meshes[0].places.size(), 2u);
  EXPECT_EQ(read.meshes[0].places[1][3], glm::dvec4(5, 0, 0, 1));
}

TEST(Gltf, vertices_that_no_face_of_a_primitive_names_are_dropped) {
  Gltf file;
  file.add_square();
  file.primitive()["indices"] = file.accessor(std::vector<std::uint8_t>{0, 3, 2}, "SCALAR", 1);
  const MeshFile read = file.read();
  EXPECT_EQ(read.meshes.at(0).positions, (std::vector<glm::dvec3>{{0, 0, 0}, {0, 1, 0}, {1, 1, 0}}));
  EXPECT_EQ(read.meshes[0].corners, (std::vector<std::uint32_t>{0, 2, 1}));
}

TEST(Gltf, instances_are_as_many_as_any_attribute_has) {
  Gltf file;
  file.add_square();
  file.primitive()["mode"] = 5;
  const std::size_t ids = file.accessor(std::vector<float>{1, 2, 3}, "SCALAR", 1);
  file.json["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"]["_ID"] = ids;
  EXPECT_EQ(file.read().meshes.at(0).places.size(), 3u);
  file.json["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"] = Json::object();
  EXPECT_EQ(file.read().meshes.at(0).places.size(), 1u);
}

TEST(Gltf, hidden_nodes_and_all_below_them_are_noted) {
  Gltf file;
  file.add_square();
  file.primitive()["mode"] = 5;
  file.json["nodes"] =
      parse_json(R"([{"mesh":0},{"children":[2],"extensions":{"KHR_node_visibility":{"visible":false}}},{"mesh":0}])");
  file.json["scenes"][0]["nodes"] = Json::array({0, 1});
  const MeshFile read = file.read();
  EXPECT_EQ(read.meshes.at(0).places.size(), 1u);
  EXPECT_EQ(read.notes, std::vector<std::string>{"1 node with meshes or lights is hidden by KHR_node_visibility and left out"});
}

TEST(Gltf, numbers_that_do_not_fit_name_their_accessor) {
  Gltf file;
  file.add_square();
  file.primitive()["mode"] = 5;
  const Json sound = file.json;
  const auto error = [&](auto spoil) {
    file.json = sound;
    spoil(file.json);
    return file.error();
  };
  expect_words(error([](Json& j) { j["accessors"][0]["count"] = 5; }), {"accessor 0", "5 elements", "48 bytes"});
  expect_words(error([](Json& j) { j["accessors"][0]["count"] = -1; }), {"accessor 0", "count = -1"});
  expect_words(error([](Json& j) { j["accessors"][0]["count"] = 1e300; }), {"accessor 0", "count"});
  expect_words(error([](Json& j) { j["accessors"][0]["type"] = "VEC2"; }), {"accessor 0", "VEC2"});
  expect_words(error([](Json& j) { j["accessors"][0]["componentType"] = 5130; }), {"accessor 0", "5130"});
  expect_words(error([](Json& j) { j["bufferViews"][0]["byteLength"] = 49; }), {"bufferView 0", "49"});
  expect_words(error([](Json& j) { j["bufferViews"][0]["byteStride"] = 4; }), {"stride of 4"});
  expect_words(error([](Json& j) { j["bufferViews"][0]["buffer"] = 3; }), {"item 3 of 'buffers'"});
  expect_words(error([](Json& j) { j["meshes"][0]["primitives"][0]["attributes"]["POSITION"] = 7; }),
               {"item 7 of 'accessors'"});
  expect_words(error([](Json& j) { j["nodes"][0]["mesh"] = 1; }), {"item 1 of 'meshes'"});
  expect_words(error([](Json& j) { j["nodes"][0]["matrix"] = Json::array({1, 2}); }), {"node 0", "matrix"});
  expect_words(error([](Json& j) { j["asset"]["version"] = "3.0"; }), {"'3.0'", "2.0 is read"});
  expect_words(error([](Json& j) { j["scene"] = 4; }), {"item 4 of 'scenes'"});
  EXPECT_EQ(error([](Json&) {}), "");
}

}  // namespace gltf_test
