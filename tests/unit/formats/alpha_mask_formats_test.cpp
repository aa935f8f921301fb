// What readers take of alpha masks: image, factor, cutoff, wrapping, and texture coordinates.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <fstream>
#include <limits>
#include <numbers>

#include "error_words.h"
#include "formats/gltf_made.h"
#include "measure/formats/mesh_file.h"
#include "measure/scratch_folder.h"

namespace alpha_mask_formats_test {

using namespace gnomon;
using namespace error_words;
using namespace gnomon::importing;
namespace fs = std::filesystem;

// --- glTF

using gltf_made::base64;

/// The unit square as a strip of four vertices with two sets of coordinates, float and 16 bits.
struct Card {
  std::string mode = "MASK", more_material, factor, texture = R"({"index":0})", more_attributes, more_textures;
  std::string image = R"({"uri":"data:image/png;base64,AAEC"})";  // bytes 0, 1, 2
  std::vector<float> uv = {0, 0, 1, 0, 0, 1, 1, 1};
  std::size_t uv_count = 4;

  MeshFile read(bool with_uv = false) const {
    std::string bytes;
    const auto append = [&](const auto& values) {
      bytes.append(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(values[0]));
    };
    append(std::vector<float>{0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0});                 // 48 bytes
    append(uv);                                                                     // 32
    append(std::vector<std::uint16_t>{0, 0, 65535, 0, 0, 13107, 0, 65535});         // 16
    append(std::vector<float>{1, 1, 1, 1, 1, 1, 1, 0.5f, 1, 1, 1, 1, 1, 1, 1, 1});  // 64
    const std::string json = fmt::format(
        R"({{"asset":{{"version":"2.0"}},"nodes":[{{"mesh":0}}],
        "meshes":[{{"primitives":[{{"mode":5,"material":0,"attributes":{{"POSITION":0,"TEXCOORD_0":1,"TEXCOORD_1":2{}}}}}]}}],
        "materials":[{{"alphaMode":"{}"{},"pbrMetallicRoughness":{{"baseColorTexture":{}{}}}}}],
        "textures":[{{"source":0{}}}],"images":[{}],"samplers":[{{"wrapS":33071,"wrapT":33648}},{{"wrapS":7}}],
        "accessors":[{{"bufferView":0,"componentType":5126,"count":4,"type":"VEC3"}},
          {{"bufferView":1,"componentType":5126,"count":{},"type":"VEC2"}},
          {{"bufferView":2,"componentType":5123,"normalized":true,"count":4,"type":"VEC2"}},
          {{"bufferView":3,"componentType":5126,"count":4,"type":"VEC4"}}],
        "bufferViews":[{{"buffer":0,"byteLength":48}},{{"buffer":0,"byteOffset":48,"byteLength":32}},
          {{"buffer":0,"byteOffset":80,"byteLength":16}},{{"buffer":0,"byteOffset":96,"byteLength":64}}],
        "buffers":[{{"byteLength":{},"uri":"data:application/octet-stream;base64,{}"}}]}})",
        more_attributes, mode, more_material, texture, factor, more_textures, image, uv_count, bytes.size(), base64(bytes));
    return read_mesh_file(
        "a.gltf", [&](const fs::path&) { return json; }, with_uv);
  }
};

TEST(GltfMask, takes_image_factor_cutoff_and_wrapping) {
  Card card;
  card.more_material = R"(,"alphaCutoff":0.25)";
  card.factor = R"(,"baseColorFactor":[1,1,1,0.8])";
  card.more_textures = R"(,"sampler":0)";
  const MeshFile file = card.read();
  ASSERT_EQ(file.mask_images.size(), 1u);
  EXPECT_EQ(file.mask_images[0].bytes, std::string("\0\1\2", 3));
  EXPECT_FALSE(file.mask_images[0].is_gray_alpha);
  expect_words(file.mask_images[0].name, {"a.gltf", "image 0"});
  const ImportedMask& mask = file.meshes.at(0).mask;
  EXPECT_EQ(mask.image, 0u);
  EXPECT_EQ(mask.factor, 0.8f);
  EXPECT_EQ(mask.cutoff, 0.25f);
  EXPECT_EQ(mask.wrap_u, AlphaMask::Wrap::clamp);
  EXPECT_EQ(mask.wrap_v, AlphaMask::Wrap::mirror);
  EXPECT_EQ(file.meshes[0].uv, (std::vector<glm::vec2>{{0, 0}, {1, 0}, {0, 1}, {1, 1}}));
}

TEST(GltfMask, defaults_are_those_of_the_format) {
  const ImportedMask mask = Card{}.read().meshes.at(0).mask;
  EXPECT_EQ(mask.factor, 1);
  EXPECT_EQ(mask.cutoff, 0.5f);
  EXPECT_EQ(mask.wrap_u, AlphaMask::Wrap::repeat);
  EXPECT_EQ(mask.wrap_v, AlphaMask::Wrap::repeat);
}

TEST(GltfMask, other_modes_have_none) {
  Card card;
  card.mode = "OPAQUE";
  const MeshFile file = card.read();
  EXPECT_TRUE(file.mask_images.empty());
  EXPECT_FALSE(file.meshes.at(0).mask.has_image());
  EXPECT_TRUE(file.meshes[0].uv.empty()) << "nobody needs them";
  EXPECT_EQ(card.read(true).meshes.at(0).uv.size(), 4u) << "they are requested";
  card.mode = "BLEND";
  EXPECT_FALSE(card.read().meshes.at(0).mask.has_image()) << "it is glass";
}

TEST(GltfMask, coordinates_are_transformed_in_double) {
  // Offset (0, 1), a quarter turn and scale 1/2 give the lower left quarter of the image: (u, v) becomes (v/2, 1 - u/2).
  Card card;
  card.texture =
      R"({"index":0,"extensions":{"KHR_texture_transform":{"offset":[0,1],"rotation":1.5707963267948966,"scale":[0.5,0.5]}}})";
  const std::vector<glm::vec2> uv = card.read().meshes.at(0).uv;
  const glm::vec2 expected[] = {{0, 1}, {0, 0.5f}, {0.5f, 1}, {0.5f, 0.5f}};
  for (std::size_t v = 0; v < 4; ++v) EXPECT_LT(glm::length(uv.at(v) - expected[v]), 1e-7f) << v;
  // 0.1 + 3 * 0.3f is rounded once.
  card.texture = R"({"index":0,"extensions":{"KHR_texture_transform":{"offset":[0.1,0],"scale":[3,1]}}})";
  card.uv[0] = 0.3f;
  EXPECT_EQ(card.read().meshes.at(0).uv.at(0).x, static_cast<float>(0.1 + 3 * static_cast<double>(0.3f)));
}

TEST(GltfMask, the_set_of_coordinates_is_that_of_the_transform_else_of_the_texture) {
  const std::vector<glm::vec2> second = {{0, 0}, {1, 0}, {0, 0.2f}, {0, 1}};  // 13107 / 65535 is 1/5
  Card card;
  card.texture = R"({"index":0,"texCoord":1})";
  EXPECT_EQ(card.read().meshes.at(0).uv, second);
  card.texture = R"({"index":0,"texCoord":0,"extensions":{"KHR_texture_transform":{"texCoord":1}}})";
  EXPECT_EQ(card.read().meshes.at(0).uv, second);
  card.texture = R"({"index":0,"texCoord":5})";
  EXPECT_TRUE(card.read().meshes.at(0).uv.empty()) << "the importer refuses it";
}

TEST(GltfMask, an_image_may_be_in_a_buffer) {
  Card card;
  card.image = R"({"bufferView":2,"mimeType":"image/png"})";
  EXPECT_EQ(card.read().mask_images.at(0).bytes.size(), 16u);
}

TEST(GltfMask, a_missing_image_is_noted_and_the_card_is_solid) {
  Card card;
  card.image = R"({"uri":"nowhere/leaf.png"})";
  const MeshFile file = card.read();
  EXPECT_FALSE(file.meshes.at(0).mask.has_image());
  EXPECT_TRUE(has_note(file, "1 image of masks is not there ('leaf.png' is one)"));
  card.image = R"({"uri":"/"})";
  expect_words(card.read().mask_images.at(0).failure, {"is a directory"});
}

TEST(GltfMask, alpha_of_vertices_is_noted) {
  Card card;
  EXPECT_FALSE(has_note(card.read(), "color with alpha"));
  card.more_attributes = R"(,"COLOR_0":3)";
  EXPECT_TRUE(has_note(card.read(), "1 vertex of masked meshes has a color with alpha"));
}

// The file is read: a description may take the mesh for solid, and whoever uses the mask is told why there is none.
TEST(GltfMask, unknown_wrapping_and_too_few_coordinates_fail_the_mask_alone) {
  Card card;
  const auto failure = [&] {
    const MeshFile file = card.read();
    return file.mask_images.at(file.meshes.at(0).mask.image).failure;
  };
  EXPECT_EQ(failure(), "");
  card.more_textures = R"(,"sampler":1)";
  expect_words(failure(), {"a.gltf", "sampler 1", "wrapS = 7", "10497"});
  card.more_textures = "";
  card.uv_count = 3;
  expect_words(failure(), {"mesh 0, primitive 0", "4 vertices and 3 texture coordinates"});
  card.uv_count = 4;
  card.texture = R"({"index":9})";
  expect_words(failure(), {"item 9 of 'textures'"});
}

// --- OBJ

struct Folder {
  ScratchFolder scratch = ScratchFolder::temporary("gnomon_mask");
  void write(const std::string& name, const std::string& bytes) const { std::ofstream(scratch.path() / name) << bytes; }
  MeshFile read(const std::string& obj, bool with_uv = false) const {
    write("a.obj", obj);
    return read_mesh_file(
        scratch.path() / "a.obj",
        [](const fs::path& file) {
          std::ifstream in(file, std::ios::binary);
          return std::string(std::istreambuf_iterator<char>(in), {});
        },
        with_uv);
  }
};

const std::string square = "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0.25 0.75\nvt 1 0.1\nvt 1 1\nvt 0 1\n";

TEST(ObjMask, v_is_turned_around_and_a_vertex_with_two_coordinates_is_two) {
  const Folder folder;
  folder.write("leaf.png", "image");
  folder.write("a.mtl", "newmtl leaf\nmap_d leaf.png\n");
  const MeshFile file = folder.read(square + "usemtl leaf\nf 1/1 2/2 3/3\nf 1/1 3/4 4/4\n");
  const ImportedMesh& mesh = file.meshes.at(0);
  EXPECT_EQ(mesh.corners, (std::vector<std::uint32_t>{0, 1, 2, 0, 3, 4}));
  EXPECT_EQ(mesh.positions, (std::vector<glm::dvec3>{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {1, 1, 0}, {0, 1, 0}}));
  EXPECT_EQ(mesh.uv, (std::vector<glm::vec2>{{0.25f, 0.25f}, {1, static_cast<float>(1 - 0.1)}, {1, 0}, {0, 0}, {0, 0}}));
  ASSERT_EQ(file.mask_images.size(), 1u);
  EXPECT_EQ(file.mask_images[0].bytes, "image");
  EXPECT_TRUE(file.mask_images[0].is_gray_alpha);
  EXPECT_EQ(mesh.mask.cutoff, 0.5f);
  EXPECT_EQ(mesh.mask.factor, 1);
  EXPECT_TRUE(has_note(file, "1 material has a mask (map_d), and the format has no cutoff"));
}

TEST(ObjMask, without_a_mask_nothing_changes) {
  const Folder folder;
  folder.write("leaf.png", "image");
  folder.write("a.mtl", "newmtl leaf\nmap_Kd leaf.png\nd 0.5\n");
  const std::string text = square + "vt nonsense\nusemtl leaf\nf 4/1 2/2 3/3\nf 1/1 3/4 4/4\n";
  const MeshFile file = folder.read(text);
  const ImportedMesh& mesh = file.meshes.at(0);
  EXPECT_EQ(mesh.corners, (std::vector<std::uint32_t>{0, 1, 2, 3, 2, 0}));
  EXPECT_TRUE(mesh.uv.empty() && file.mask_images.empty() && file.notes.empty());
  EXPECT_TRUE(mesh.has_texture && mesh.is_transparent);
  expect_words(error_of([&] { folder.read(text, true); }), {"a.obj:10", "'nonsense' is not a number"});
}

TEST(ObjMask, coordinates_are_counted_from_both_ends_and_must_be_there) {
  const Folder folder;
  folder.write("a.mtl", "");
  EXPECT_EQ(folder.read(square + "f 1/-4 2/-3 3/-2\n", true).meshes.at(0).uv.at(0), glm::vec2(0.25f, 0.25f));
  EXPECT_EQ(folder.read(square + "f 1 2 3\n", true).meshes.at(0).uv.size(), 0u);
  const std::vector<glm::vec2> mixed = folder.read(square + "f 1/1 2//2 3/3\n", true).meshes.at(0).uv;
  EXPECT_TRUE(std::isnan(mixed.at(1).x) && mixed.at(2) == glm::vec2(1, 0));
  for (const char* number : {"5", "-5", "-9223372036854775808"})
    expect_words(error_of([&] { folder.read(square + "f 1/1 2/" + number + " 3/3\n", true); }),
                 {"corner 1", "is out of range: allowed are 1 .. 4"});
}

TEST(ObjMask, options_precede_a_name_that_may_have_blanks) {
  const Folder folder;
  folder.write("my leaf.png", "image");
  folder.write("a.mtl", "newmtl leaf\nd 0.75\nmap_d -clamp on -mm 0 1 my leaf.png\n");
  const MeshFile file = folder.read(square + "usemtl leaf\nf 1/1 2/2 3/3\n");
  EXPECT_EQ(file.mask_images.at(0).bytes, "image");
  EXPECT_EQ(file.meshes.at(0).mask.wrap_u, AlphaMask::Wrap::clamp);
  EXPECT_EQ(file.meshes[0].mask.factor, 1) << "d is that of the solid part";
  EXPECT_EQ(file.meshes[0].transmission.alpha, 0.75);
  EXPECT_TRUE(has_note(file, "1 material has a mask with options that are not used"));
}

TEST(ObjMask, a_missing_image_is_noted) {
  const Folder folder;
  folder.write("a.mtl", "newmtl leaf\nmap_d gone.png\n");
  const MeshFile file = folder.read(square + "usemtl leaf\nf 1/1 2/2 3/3\n");
  EXPECT_FALSE(file.meshes.at(0).mask.has_image());
  EXPECT_TRUE(file.meshes[0].has_texture);
  EXPECT_TRUE(has_note(file, "1 material has a mask whose image is not there and is solid ('leaf' is one)"));
}

}  // namespace alpha_mask_formats_test
