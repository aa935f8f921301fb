// Scenes with alpha masks from files: images of every kind, sharing, duplicates, descriptions, and what is refused.
#include <gnomon/kit/geometry/holes.h>
#include <gnomon/kit/geometry/shapes.h>
#include <gtest/gtest.h>
#include <zlib.h>

#include <cmath>
#include <fstream>

#include "error_words.h"
#include "measure/scene/base_scene.h"
#include "measure/scene/load.h"
#include "measure/scratch_folder.h"

namespace alpha_mask_load_test {

using namespace gnomon;
using namespace error_words;
namespace fs = std::filesystem;

std::string big_endian(std::uint32_t value) {
  std::string bytes;
  for (int shift = 24; shift >= 0; shift -= 8) bytes += static_cast<char>(value >> shift & 255);
  return bytes;
}
std::string chunk(const std::string& kind, const std::string& data) {
  const std::string body = kind + data;
  const auto crc = crc32(0, reinterpret_cast<const Bytef*>(body.data()), static_cast<uInt>(body.size()));
  return big_endian(static_cast<std::uint32_t>(data.size())) + body + big_endian(static_cast<std::uint32_t>(crc));
}
/// A PNG of whole bytes a row. `type`: 0 gray, 2 RGB, 3 palette, 4 gray and alpha, 6 RGB and alpha. `extra`: chunks before the
/// pixels.
std::string png(std::uint32_t width, std::uint32_t height, int bits, int type, const std::string& pixels,
                const std::string& extra = "") {
  std::string rows;
  const std::size_t row = pixels.size() / height;
  for (std::size_t y = 0; y < height; ++y) rows += '\0' + pixels.substr(y * row, row);
  uLongf size = compressBound(static_cast<uLong>(rows.size()));
  std::string packed(size, '\0');
  compress(reinterpret_cast<Bytef*>(packed.data()), &size, reinterpret_cast<const Bytef*>(rows.data()),
           static_cast<uLong>(rows.size()));
  packed.resize(size);
  const std::string header =
      big_endian(width) + big_endian(height) + std::string{static_cast<char>(bits), static_cast<char>(type), 0, 0, 0};
  return "\x89PNG\r\n\x1a\n" + chunk("IHDR", header) + extra + chunk("IDAT", packed) + chunk("IEND", "");
}
/// Gray and alpha.
std::string png_of(std::uint32_t width, const std::vector<int>& alpha) {
  std::string pixels;
  for (const int a : alpha) pixels += std::string{char(77), static_cast<char>(a)};
  return png(width, static_cast<std::uint32_t>(alpha.size()) / width, 8, 4, pixels);
}

const std::string card =
    "mtllib card.mtl\nv -1 -1 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nusemtl leaf\nf 1/1 2/2 3/3 4/4\n";
const std::string plane = "[[shape]]\nkind = \"plane\"\ncenter = [0, 0, 0]\nnormal = [0, 0, 1]\nsize = [2, 2]\n";

/// A folder with card.obj, which names leaf.png as its mask.
struct Folder {
  ScratchFolder scratch = ScratchFolder::temporary("gnomon_masks");
  Folder() {
    write("card.obj", card);
    write("card.mtl", "newmtl leaf\nmap_d leaf.png\n");
    write("leaf.png", png_of(2, {255, 0, 0, 255}));
  }
  fs::path path(const std::string& name) const { return scratch.path() / name; }
  void write(const std::string& name, const std::string& bytes) const { std::ofstream(path(name), std::ios::binary) << bytes; }
  /// The scene of a description; with `[[mesh]] file = "card.obj"` before it.
  Scene read(const std::string& toml) const {
    write("test.toml", toml);
    return read_scene_toml(path("test.toml"));
  }
  Scene read_card(const std::string& keys) const { return read("[[mesh]]\nfile = \"card.obj\"\n" + keys); }
  std::string error(const std::string& toml) const {
    return error_of([&] { read(toml); });
  }
  std::string card_error(const std::string& keys) const {
    return error_of([&] { read_card(keys); });
  }
};

/// The mask's bits as text, row after row: # is solid.
std::string bits(const Scene& scene, std::size_t mesh = 0) {
  const AlphaMask* mask = scene.meshes.at(mesh).alpha_mask.get();
  std::string text;
  for (int y = 0; mask && y < mask->height(); ++y)
    for (int x = 0; x < mask->width(); ++x) text += mask->is_solid(x, y) ? '#' : '.';
  return text;
}

TEST(AlphaMaskLoad, the_mask_of_an_obj_is_its_image_with_the_top_row_first) {
  const Folder folder;
  Scene scene = folder.read_card("");
  EXPECT_EQ(bits(scene), "#..#");
  // From (x, y, 5) straight down to the card: the upper left quarter is solid, the upper right a hole.
  const Mesh& mesh = scene.meshes.at(0);
  const auto is_solid = [&](double x, double y) {
    const std::uint32_t triangle = y < x ? 0 : 1;  // cut from (-1, -1) to (1, 1)
    return is_solid_along(mesh, triangle, {x, y, 5}, {0, 0, -1});
  };
  EXPECT_TRUE(is_solid(-0.5, 0.5) && is_solid(0.5, -0.5));
  EXPECT_TRUE(!is_solid(0.5, 0.7) && !is_solid(-0.5, -0.7));
  EXPECT_FALSE(mesh.is_closed());
  EXPECT_FALSE(has_note(scene, "textures"));
  finish_scene(scene, "test");
}

TEST(AlphaMaskLoad, images_of_every_kind_are_read) {
  const Folder folder;
  const std::string keys = plane + "mask = \"a.png\"\n";
  const auto read = [&](const std::string& image) {
    folder.write("a.png", image);
    return bits(folder.read(keys));
  };
  EXPECT_EQ(read(png_of(2, {127, 128})), ".#") << "gray and alpha; 128 / 255 is the first of 0.5 or more";
  EXPECT_EQ(read(png(2, 1, 8, 6, std::string("\0\0\0\xff\xff\xff\xff\0", 8))), "#.") << "alpha counts, not color";
  EXPECT_EQ(read(png(2, 1, 16, 4, std::string("\0\0\x80\0\0\0\x7f\0", 8))), "#.") << "16 bits";
  EXPECT_EQ(read(png(2, 1, 8, 0, "\xff\x01")), "#.") << "gray alone";
  EXPECT_EQ(read(png(2, 1, 8, 2, "\xff\xff\xff\x10\x10\x10")), "#.") << "brightness";
  EXPECT_EQ(read(png(2, 1, 8, 3, std::string("\0\1", 2), chunk("PLTE", "abcdef") + chunk("tRNS", "\x09"))), ".#") << "palette";
  EXPECT_EQ(read(png_of(1, {9})), ".") << "1 x 1";
}

TEST(AlphaMaskLoad, cutoff_is_that_of_the_description) {
  const Folder folder;
  folder.write("leaf.png", png_of(2, {50, 51}));
  EXPECT_EQ(bits(folder.read_card("cutoff = 0.2\n")), ".#") << "51 / 255 >= 0.2f in float32";
  EXPECT_EQ(bits(folder.read(plane + "mask = \"leaf.png\"\ncutoff = 0.2\n")), ".#");
  for (const char* cutoff : {"nan", "-0.1", "1.1"})
    expect_words(folder.card_error(std::string("cutoff = ") + cutoff + "\n"),
                 {"mesh.cutoff", cutoff, "within 0 .. 1", "test.toml:3"});
  folder.write("card.mtl", "newmtl leaf\n");
  expect_words(folder.card_error("cutoff = 0.2\n"), {"card.obj", "has no mesh with a mask"});
  expect_words(folder.error(plane + "cutoff = 0.2\n"), {"plane.cutoff", "allowed without a mask"});
}

TEST(AlphaMaskLoad, a_plane_shows_its_image_upright_from_the_side_of_its_normal) {
  const Folder folder;
  folder.write("a.png", png_of(2, {255, 0, 0, 0}));
  const Mesh mesh = folder.read(plane + "mask = \"a.png\"\n").meshes.at(0);
  ASSERT_EQ(mesh.uv.size(), mesh.positions.size());
  for (std::size_t v = 0; v < mesh.uv.size(); ++v)
    EXPECT_EQ(mesh.uv[v], glm::vec2((mesh.positions[v].x + 1) / 2, (1 - mesh.positions[v].y) / 2)) << v;
  EXPECT_TRUE(mesh.shape);
}

TEST(AlphaMaskLoad, a_description_replaces_or_drops_masks) {
  const Folder folder;
  folder.write("other.png", png_of(3, {255, 0, 255}));
  EXPECT_EQ(bits(folder.read_card("mask = \"other.png\"\n")), "#.#");
  folder.write("card.mtl", "newmtl leaf\n");
  EXPECT_EQ(bits(folder.read_card("mask = \"other.png\"\n")), "#.#") << "a file without masks has coordinates all the same";
  folder.write("card.mtl", "newmtl leaf\nmap_d leaf.png\n");
  folder.write("leaf.png", "damaged");
  const Scene solid = folder.read_card("masks = false\n");
  EXPECT_FALSE(solid.meshes.at(0).alpha_mask);
  EXPECT_TRUE(solid.meshes[0].uv.empty());
  EXPECT_EQ(solid.meshes[0].positions.size(), 4u);
  EXPECT_TRUE(has_note(solid, "2 triangles have textures, which are not used"));
  expect_words(folder.card_error("masks = false\nmask = \"other.png\"\n"), {"mesh.masks = false", "beside mask"});
}

TEST(AlphaMaskLoad, a_scale_makes_the_mask_finer) {
  const Folder folder;
  const Scene scene = folder.read_card("mask_scale = 3\n");
  EXPECT_EQ(scene.meshes.at(0).alpha_mask->width(), 6);
  EXPECT_EQ(scene.meshes[0].alpha_mask->height(), 6);
  expect_words(folder.card_error("mask_scale = 9000\n"), {"card.obj: mesh", "width", "18000", "16384", "leaf.png"});
  expect_words(folder.card_error("mask_scale = 0\n"), {"mesh.mask_scale = 0"});
}

TEST(AlphaMaskLoad, equal_masks_are_one_object) {
  const Folder folder;
  folder.write("same.png", png_of(2, {255, 0, 0, 255}));
  const std::string mesh = "[[mesh]]\nfile = \"card.obj\"\n";
  const Scene scene = folder.read(plane + "mask = \"same.png\"\n" + mesh + mesh + mesh + "cutoff = 0.25\n");
  ASSERT_EQ(scene.meshes.size(), 4u);
  EXPECT_EQ(scene.meshes[0].alpha_mask, scene.meshes[1].alpha_mask);
  EXPECT_EQ(scene.meshes[1].alpha_mask, scene.meshes[2].alpha_mask);
  EXPECT_NE(scene.meshes[2].alpha_mask, scene.meshes[3].alpha_mask);
}

TEST(AlphaMaskLoad, exact_duplicates_are_merged_and_others_stay) {
  const Folder folder;
  // The same triangle again, from behind, and with other coordinates.
  folder.write("card.obj", card + "f 1/1 2/2 3/3\nf 3/3 2/2 1/1\nf 1/2 2/1 3/3\n");
  Scene scene = folder.read_card("");
  const Mesh& mesh = scene.meshes.at(0);
  EXPECT_EQ(mesh.triangles.size(), 3u);
  EXPECT_EQ(mesh.positions.size(), 6u) << "two of the corners have two places";
  EXPECT_EQ(mesh.uv.size(), 6u);
  EXPECT_TRUE(has_note(scene, "card.obj: 2 triangles of masked meshes are exact duplicates"));
  const Scene solid = folder.read_card("masks = false\n");
  EXPECT_EQ(solid.meshes.at(0).triangles.size(), 5u);
  EXPECT_EQ(solid.meshes[0].positions.size(), 4u);
}

TEST(AlphaMaskLoad, masks_without_a_hole_and_without_alpha_are_noted) {
  const Folder folder;
  folder.write("leaf.png", png_of(1, {255}));
  EXPECT_TRUE(has_note(folder.read_card(""), "card.obj: 1 mesh has a mask without a hole; it is solid"));
  EXPECT_FALSE(folder.read_card("").has_alpha_masks());
  EXPECT_TRUE(has_note(folder.read(plane + "mask = \"leaf.png\"\n"), "its mask leaf.png has no hole"));
  folder.write("leaf.png", png_of(1, {0}));
  EXPECT_TRUE(has_note(folder.read_card(""), "1 mesh has a mask without a solid texel; it stops no light"));
}

TEST(AlphaMaskLoad, brightness_is_no_alpha_in_gltf) {
  const Folder folder;
  std::string bytes;
  for (const float number : {0.f, 0.f, 0.f, 1.f, 0.f, 0.f, 0.f, 1.f, 0.f})  // corners; as pairs, their first six numbers are uv
    bytes.append(reinterpret_cast<const char*>(&number), sizeof(number));
  folder.write("a.bin", bytes);
  folder.write("a.gltf", R"({"asset":{"version":"2.0"},"nodes":[{"mesh":0}],
    "meshes":[{"primitives":[{"material":0,"attributes":{"POSITION":0,"TEXCOORD_0":1}}]}],
    "materials":[{"alphaMode":"MASK","pbrMetallicRoughness":{"baseColorTexture":{"index":0}}}],
    "textures":[{"source":0}],"images":[{"uri":"leaf.png"}],"buffers":[{"uri":"a.bin","byteLength":36}],
    "bufferViews":[{"buffer":0,"byteLength":36}],
    "accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3"},
                 {"bufferView":0,"componentType":5126,"count":3,"type":"VEC2"}]})");
  const std::string mesh = "[[mesh]]\nfile = \"a.gltf\"\n";
  EXPECT_EQ(bits(folder.read(mesh)), "#..#");
  folder.write("leaf.png", png(2, 1, 8, 0, std::string("\0\xff", 2)));
  const Scene solid = folder.read(mesh);
  EXPECT_FALSE(solid.has_alpha_masks());
  EXPECT_TRUE(has_note(solid, "a.gltf: 1 mesh has a mask whose image has no alpha; it is solid"));
  EXPECT_EQ(bits(folder.read(mesh + "mask = \"leaf.png\"\n")), ".#") << "a description takes brightness";
}

TEST(AlphaMaskLoad, refuses_images_that_it_cannot_read) {
  const Folder folder;
  const auto refusal = [&](const std::string& image) {
    folder.write("leaf.png", image);
    const std::string of_mesh = folder.card_error(""), of_plane = folder.error(plane + "mask = \"leaf.png\"\n");
    expect_words(of_mesh, {"card.obj: mesh 'card'", "leaf.png", "masks = false", "test.toml:2"});
    expect_words(of_plane, {"leaf.png", "test.toml:6"});
    return of_mesh;
  };
  expect_words(refusal("no image at all"), {"cannot be read"});
  expect_words(refusal(""), {"is empty"});
  const std::string good = png_of(2, {255, 0, 0, 255});
  refusal(good.substr(0, good.size() / 2));
  const auto declaring = [&](std::uint32_t width, std::uint32_t height) {
    const std::string header = big_endian(width) + big_endian(height) + std::string{8, 4, 0, 0, 0};
    return good.substr(0, 8) + chunk("IHDR", header) + good.substr(8 + 25);
  };
  expect_words(refusal(declaring(16385, 1)), {"is 16385x1", "1 .. 16384"});
  expect_words(refusal(declaring(16384, 16384)), {"declares 16384x16384 pixels in", "bytes"});
  for (const std::string& keys : {plane, std::string("[[mesh]]\nfile = \"card.obj\"\n")}) {
    expect_words(folder.error(keys + "mask = \"gone.png\"\n"), {"gone.png", "does not exist"});
    expect_words(folder.error(keys + "mask = \"\"\n"), {".mask = '' is not the name of a file"});
    expect_words(folder.error(keys + "mask = \".\"\n"), {"is a directory, not an image"});
    expect_words(folder.error(keys + "mask = \"card.obj\"\n"), {"card.obj", "is a mesh file, not an image"});
  }
}

TEST(AlphaMaskLoad, masks_of_the_largest_size_are_read) {
  const Folder folder;
  std::vector<int> alpha(AlphaMask::most_texels);
  alpha[AlphaMask::most_texels - 1] = 255;
  folder.write("leaf.png", png_of(AlphaMask::most_texels, alpha));
  const Scene scene = folder.read_card("");
  EXPECT_EQ(scene.meshes.at(0).alpha_mask->width(), AlphaMask::most_texels);
  EXPECT_TRUE(scene.meshes[0].alpha_mask->is_solid(AlphaMask::most_texels - 1, 0));
}

TEST(AlphaMaskLoad, refuses_meshes_without_sound_coordinates) {
  const Folder folder;
  const auto refusal = [&](const std::string& from, const std::string& to) {
    std::string text = card;
    text.replace(text.find(from), from.size(), to);
    folder.write("card.obj", text);
    return folder.card_error("");
  };
  expect_words(refusal("4/4", "4"), {"card.obj: mesh 'card', vertex 3", "has no texture coordinates", "masks = false"});
  expect_words(refusal("f 1/1 2/2 3/3 4/4", "f 1 2 3 4"), {"mesh 'card', vertex 0", "has no texture coordinates"});
  expect_words(refusal("vt 0 1", "vt 1e30 1"), {"mesh 'card', vertex 3", "uv = (1e+30, 0)", "-1048576 .. 1048576"});
  expect_words(refusal("vt 0 1", "vt 1048577 1"), {"mesh 'card', vertex 3", "1048577"});
  EXPECT_EQ(refusal("vt 0 1", "vt 1048576 1"), "");
  folder.write(
      "a.stl",
      "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\nendsolid a\n");
  expect_words(folder.error("[[mesh]]\nfile = \"a.stl\"\nmask = \"leaf.png\"\n"),
               {"a.stl: mesh", "vertex 0", "has no texture coordinates"});
}

TEST(AlphaMaskLoad, shapes_other_than_planes_have_no_mask) {
  const Folder folder;
  const std::string sphere = "[[shape]]\nkind = \"sphere\"\ncenter = [0, 1, 0]\nradius = 1\n";
  expect_words(folder.error(sphere + "mask = \"leaf.png\"\n"), {"sphere.mask", "a plane alone may have a mask", "test.toml:5"});
}

TEST(AlphaMaskLoad, a_generated_mesh_must_have_a_place_for_each_vertex) {
  const Folder folder;
  Scene scene = folder.read_card("");
  scene.meshes[0].uv.pop_back();
  expect_words(error_of([&] { finish_scene(scene, "here"); }), {"3 of its 4 vertices", "here"});
  scene.meshes[0].uv.emplace_back(NAN, 0);
  expect_words(error_of([&] { finish_scene(scene, "here"); }), {"vertex 3", "uv = (nan, 0)", "here"});
}

TEST(AlphaMaskLoad, a_curved_shape_with_a_mask_is_its_triangles) {
  Scene scene;
  scene.meshes = {tessellate(Disc{}, 16, "leaf")};
  scene.meshes[0].alpha_mask = std::make_shared<const AlphaMask>(2, 1, std::vector<std::uint8_t>{0, 255});
  scene.meshes[0].uv.resize(scene.meshes[0].positions.size());
  finish_scene(scene, "here");
  EXPECT_FALSE(scene.meshes[0].shape);
  ASSERT_EQ(scene.notes.size(), 1u);
  EXPECT_NE(scene.notes[0].find("'leaf' has an alpha mask"), std::string::npos);
}

}  // namespace alpha_mask_load_test
