// Scenes with glass from files and descriptions: what lets how much through, and what is seen.
#include <gnomon/kit/geometry/holes.h>
#include <gnomon/kit/geometry/shapes.h>
#include <gtest/gtest.h>

#include "error_words.h"
#include "glass_folder.h"
#include "measure/scene/byte_shares.h"

namespace transmission_load_test {

using namespace gnomon;
using namespace error_words;
using namespace glass_folder;

// --- glTF

// Transmission 0.9 of the color (1, 0.2, 0.1); behind (0.1, 0.8, 0.2) the product; half of it blended: 1/2 + t/2.
TEST(TransmissionLoad, colors_of_gltf_are_those_on_paper) {
  const Folder folder;
  const auto first = folder.of_gltf(thin("[1,0.2,0.1,1]"));
  EXPECT_EQ(values(first), (std::vector<float>{0.9f, 0.18f, 0.09f}));
  EXPECT_EQ(folder.of_gltf(thin("[1,0.2,0.1,0.5]"))->at(0, 0), first->at(0, 0)) << "an opaque material has the alpha 1";
  EXPECT_EQ(folder.of_gltf(thin("[1,0.2,0.1,0.5]", R"(,"alphaMode":"BLEND")"))->at(0, 0), glm::vec3(0.95f, 0.59f, 0.545f));
  const Scene second = folder.read(plane + "transmission = [0.1, 0.8, 0.2]\n");
  const glm::dvec3 product = glm::dvec3(first->at(0, 0)) * glm::dvec3(second.meshes.at(0).transmission->at(0, 0));
  const glm::dvec3 on_paper(0.09, 0.144, 0.018);
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(product[c], on_paper[c], 2.1 * 0x1p-24 * on_paper[c]) << "two factors, rounded once";
}

TEST(TransmissionLoad, blend_is_one_minus_alpha_of_each_byte) {
  const Folder folder;
  Bytes texels;
  for (int a = 0; a < 256; ++a) texels.insert(texels.end(), {9, static_cast<std::uint8_t>(a)});
  folder.write("0.png", png(16, 2, texels));
  const auto glass = folder.of_gltf(
      R"("alphaMode":"BLEND","pbrMetallicRoughness":{"baseColorFactor":[1,1,1,0.3],"baseColorTexture":{"index":0}})");
  ASSERT_EQ(glass->channels(), 1);
  for (int a = 0; a < 256; ++a)
    EXPECT_EQ(glass->at(a % 16, a / 16).x, static_cast<float>(1 - 0.3 * (a / 255.0))) << a << ": rounded once";
  EXPECT_EQ(values(folder.of_gltf(R"("alphaMode":"BLEND","pbrMetallicRoughness":{"baseColorFactor":[1,1,1,0.7]})")),
            std::vector<float>{static_cast<float>(1 - 0.7)});
}

// t = transmission * red of its image * (1 - blue of the metal's image) * color as sRGB.
TEST(TransmissionLoad, images_of_gltf_are_combined_on_the_finer_grid) {
  const Folder folder;
  folder.write("0.png", png(1, 3, {255, 128, 0}));
  folder.write("1.png", png(2, 3, {255, 7, 7, 51, 9, 9}));
  folder.write("2.png", png(1, 3, {7, 7, 51, 9, 9, 255}));
  const auto glass = folder.of_gltf(
      R"("extensions":{"KHR_materials_transmission":{"transmissionFactor":0.5,"transmissionTexture":{"index":1}}},
         "pbrMetallicRoughness":{"baseColorTexture":{"index":0},"baseColorFactor":[1,0.5,1,1],
                                 "metallicFactor":0.5,"metallicRoughnessTexture":{"index":2}})");
  ASSERT_EQ(glass->width(), 2);
  ASSERT_EQ(glass->height(), 2);
  for (int y = 0; y < 2; ++y)
    for (int x = 0; x < 2; ++x) {
      const double through = 0.5 * (x == 0 ? 1 : 0.2) * (1 - 0.5 * (y == 0 ? 0.2 : 1));
      const glm::vec3 expected(through, through * 0.5 * srgb_shares()[128], 0);
      EXPECT_LT(glm::length(glass->at(x, y) - expected), 1e-7f) << x << ' ' << y;
    }
  EXPECT_NEAR(srgb_shares()[128], 0.21586, 1e-5);  // ((128/255 + 0.055) / 1.055)^2.4
}

// The grid of a texture of which all texels are full is not that of the result.
TEST(TransmissionLoad, a_white_image_changes_nothing) {
  const Folder folder;
  folder.write("0.png", png(3, 2, Bytes(6, 255)));
  EXPECT_EQ(values(folder.of_gltf(
                R"("extensions":{"KHR_materials_transmission":{"transmissionFactor":0.9}},
                   "pbrMetallicRoughness":{"baseColorTexture":{"index":0},"metallicFactor":0})")),
            std::vector<float>{0.9f});
}

TEST(TransmissionLoad, a_metal_and_a_full_alpha_are_opaque) {
  const Folder folder;
  EXPECT_FALSE(folder.of_gltf(R"("extensions":{"KHR_materials_transmission":{"transmissionFactor":1}})"));
  const Scene metal = folder.read(gltf);
  EXPECT_TRUE(metal.meshes[0].seen);
  EXPECT_TRUE(has_note(metal, "a.gltf: 1 mesh is of transparent material of which no texel lets light through"));
  EXPECT_TRUE(has_note(metal, "1 material has KHR_materials_transmission and a metallicFactor of 1"));
  folder.write_gltf(R"("alphaMode":"BLEND","pbrMetallicRoughness":{"baseColorFactor":[1,1,1,0]})");
  const Scene nothing = folder.read(gltf);
  EXPECT_EQ(values(nothing), std::vector<float>{1});
  EXPECT_TRUE(has_note(nothing, "a.gltf: 1 mesh lets all light through; it stops none"));
}

TEST(TransmissionLoad, a_mask_decides_where_the_glass_of_gltf_is) {
  const Folder folder;
  folder.write("0.png", png(2, 2, {255, 255, 255, 0}));
  folder.write_gltf(R"("alphaMode":"MASK","pbrMetallicRoughness":{"baseColorTexture":{"index":0},"metallicFactor":0},
      "extensions":{"KHR_materials_transmission":{"transmissionFactor":0.9}})");
  const Scene scene = folder.read(gltf);
  ASSERT_TRUE(scene.meshes.at(0).alpha_mask);
  EXPECT_EQ(scene.meshes[0].alpha_mask->coverage(), 0.5);
  EXPECT_EQ(values(scene), std::vector<float>{0.9f});
  EXPECT_FALSE(folder.read(gltf + "transmission = false\n").has_transmission());
  EXPECT_EQ(values(folder.read(gltf + "masks = false\n")), std::vector<float>{0.9f});
}

TEST(TransmissionLoad, notes_on_textures_speak_of_those_that_are_not_used) {
  const Folder folder;
  const char* const unused = "textures, which are not used";
  const std::string blend = R"("alphaMode":"BLEND","pbrMetallicRoughness":{"baseColorTexture":{"index":0},"baseColorFactor":)";
  folder.write_gltf(blend + "[1,1,1,1]}");
  const Scene missing = folder.read(gltf);
  EXPECT_FALSE(missing.meshes.at(0).transmission);
  EXPECT_TRUE(has_note(missing, "1 image of transmission is not there ('0.png' is one)"));
  EXPECT_TRUE(has_note(missing, "1 material of alphaMode BLEND has an alpha of 1 without the image; it is opaque"));
  EXPECT_FALSE(has_note(missing, unused));
  folder.write_gltf(blend + "[1,1,1,0.5]}");
  const Scene half = folder.read(gltf);
  EXPECT_EQ(values(half), std::vector<float>{0.5f});
  EXPECT_FALSE(has_note(half, "it is opaque") || has_note(half, unused));
  folder.write("0.png", png(1, 2, {9, 255}));
  EXPECT_EQ(values(folder.read(gltf)), std::vector<float>{0.5f});
  EXPECT_FALSE(has_note(folder.read(gltf), unused)) << "it was read, and is the same everywhere";
  EXPECT_TRUE(has_note(folder.read(gltf + "transmission = false\n"), unused));
}

// --- OBJ and what a description says of a file

TEST(TransmissionLoad, an_obj_lets_one_minus_d_through_and_is_not_seen) {
  const Folder folder;
  Scene scene = folder.read(pane);
  EXPECT_EQ(values(scene), std::vector<float>{0.75f});
  EXPECT_FALSE(scene.meshes[0].seen);
  EXPECT_TRUE(scene.meshes[0].uv.empty());
  EXPECT_FALSE(scene.meshes[0].is_closed());
  EXPECT_TRUE(scene.notes.empty()) << scene.notes.front();
  finish_scene(scene, "test");
  EXPECT_TRUE(folder.read(pane + "seen = true\n").meshes.at(0).seen);
  EXPECT_EQ(values(folder.read(pane + "transmission = true\n")), std::vector<float>{0.75f});
}

TEST(TransmissionLoad, a_description_replaces_or_drops_what_a_file_says) {
  const Folder folder;
  EXPECT_EQ(values(folder.read(pane + "transmission = 0.3\n")), std::vector<float>{0.3f});
  EXPECT_EQ(values(folder.read(pane + "transmission = [0, 0.5, 1]\n")), (std::vector<float>{0, 0.5f, 1}));
  const Scene textured = folder.read(pane + "transmission = \"half.png\"\n");
  EXPECT_EQ(values(textured), (std::vector<float>{0.2f, 0.8f}));
  // Straight down at the left and the right half.
  const auto through = [&](double x) {
    const std::uint32_t triangle = 0.1 < x ? 0 : 1;  // cut from (-1, -1) to (1, 1)
    return transmission_along(textured.meshes.at(0), triangle, {x, 0.1, 5}, {0, 0, -1}).x;
  };
  EXPECT_EQ(through(-0.5), 0.2f);
  EXPECT_EQ(through(0.5), 0.8f);
  for (const char* keys : {"transmission = false\n", "transmission = 0\n"}) {
    const Scene opaque = folder.read(pane + keys);
    EXPECT_FALSE(opaque.meshes.at(0).transmission) << keys;
    EXPECT_TRUE(opaque.meshes[0].seen) << keys;
  }
  EXPECT_TRUE(has_note(folder.read(pane + "transmission = false\n"), "2 triangles are of transparent material"));
  folder.write("pane.mtl", "newmtl pane\n");
  EXPECT_EQ(values(folder.read(pane + "transmission = \"half.png\"\n")), (std::vector<float>{0.2f, 0.8f}));
}

TEST(TransmissionLoad, a_masked_obj_transmits_where_it_is_solid) {
  const Folder folder;
  folder.write("pane.mtl", "newmtl pane\nd 0.25\nmap_d leaf.png\n");
  folder.write("leaf.png", png(2, 1, {255, 0}));
  const Scene scene = folder.read(pane + "transmission = \"half.png\"\n");
  EXPECT_EQ(scene.meshes.at(0).alpha_mask->coverage(), 0.5);
  EXPECT_EQ(values(scene), (std::vector<float>{0.2f, 0.8f}));
  EXPECT_EQ(values(folder.read(pane)), std::vector<float>{0.75f});
  EXPECT_EQ(scene.meshes[0].uv.size(), 4u);
}

TEST(TransmissionLoad, a_mask_beside_a_transmission_is_noted) {
  const Folder folder;
  folder.write("leaf.png", png(2, 1, {255, 0}));
  const std::string both = "mask = \"leaf.png\"\ntransmission = 0.5\n", solid = "a mask and a transmission; what is solid";
  EXPECT_TRUE(has_note(folder.read(plane + both), "it has a mask and a transmission; what is solid of it transmits"));
  EXPECT_TRUE(has_note(folder.read(pane + both), "pane.obj: 1 mesh has " + solid));
  EXPECT_FALSE(has_note(folder.read(plane + "transmission = 0.5\n" + pane), solid));
  folder.write("pane.mtl", "newmtl pane\nd 0.25\nmap_d leaf.png\n");
  EXPECT_FALSE(has_note(folder.read(pane), solid)) << "the reader of the format has noted it";
}

TEST(TransmissionLoad, equal_glass_is_one_object) {
  const Folder folder;
  const Scene scene =
      folder.read(plane + "transmission = \"half.png\"\n" + pane + "transmission = \"half.png\"\n" + pane + pane);
  EXPECT_EQ(scene.meshes.at(0).transmission, scene.meshes.at(1).transmission);
  EXPECT_EQ(scene.meshes.at(2).transmission, scene.meshes.at(3).transmission);
}

TEST(TransmissionLoad, exact_duplicates_are_merged_and_others_stay) {
  const Folder folder;
  folder.write("pane.obj",
               "mtllib pane.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 0\nv 0 0 1\nusemtl pane\nf 1 2 3\nf 3 2 4\nf 1 2 5\n");
  const Scene scene = folder.read(pane);
  EXPECT_EQ(scene.meshes.at(0).triangles.size(), 2u) << "the second is the first from behind";
  EXPECT_TRUE(has_note(scene, "pane.obj: 1 triangle of meshes that let light through is an exact duplicate of another"));
  EXPECT_EQ(folder.read(pane + "transmission = false\n").meshes.at(0).triangles.size(), 3u);
}

// --- shapes of descriptions

TEST(TransmissionLoad, shapes_take_a_number_three_or_a_plane_an_image) {
  const Folder folder;
  const Scene gray = folder.read(plane + "transmission = 0.4\n");
  EXPECT_EQ(values(gray), std::vector<float>{0.4f});
  EXPECT_TRUE(!gray.meshes.at(0).seen && gray.meshes[0].shape && gray.meshes[0].uv.empty());
  EXPECT_TRUE(folder.read(plane + "transmission = 0.4\nseen = true\n").meshes.at(0).seen);
  EXPECT_EQ(values(folder.read(plane + "transmission = [0.25, 0.25, 0.25]\n")), std::vector<float>{0.25f});
  folder.write("colors.png", png(1, 3, {51, 102, 255, 0, 0, 0}));
  EXPECT_EQ(values(folder.read(plane + "transmission = \"colors.png\"\n")), (std::vector<float>{0.2f, 0.4f, 1, 0, 0, 0}));
  const Scene opaque = folder.read(plane + "transmission = 0\n");
  EXPECT_TRUE(opaque.meshes.at(0).seen && !opaque.meshes[0].transmission);
  folder.write("black.png", png(1, 1, {0}));
  EXPECT_TRUE(
      has_note(folder.read(plane + "transmission = \"black.png\"\n"), "its transmission black.png lets no light through"));
  EXPECT_TRUE(has_note(folder.read(plane + "transmission = 1\n"), "it lets all light through"));
}

TEST(TransmissionLoad, a_plane_shows_its_image_upright_from_the_side_of_its_normal) {
  const Folder folder;
  const Mesh mesh = folder.read(plane + "transmission = \"half.png\"\n").meshes.at(0);
  ASSERT_EQ(mesh.uv.size(), mesh.positions.size());
  for (std::size_t v = 0; v < mesh.uv.size(); ++v)
    EXPECT_EQ(mesh.uv[v], glm::vec2((mesh.positions[v].x + 1) / 2, (1 - mesh.positions[v].y) / 2)) << v;
}

TEST(TransmissionLoad, a_curved_shape_of_glass_is_its_triangles) {
  const Folder folder;
  Scene scene = folder.read(sphere + "transmission = 0.5\n");
  EXPECT_TRUE(scene.meshes.at(0).shape);
  finish_scene(scene, "here");
  EXPECT_FALSE(scene.meshes.at(0).shape);
  EXPECT_TRUE(has_note(scene, "has a transmission: its triangles are taken, not its exact shape"));
}

TEST(TransmissionLoad, a_generated_mesh_must_have_a_place_for_each_vertex) {
  const Folder folder;
  Scene scene = folder.read(plane + "transmission = \"half.png\"\n");
  scene.meshes[0].uv.pop_back();
  expect_words(error_of([&] { finish_scene(scene, "here"); }), {"3 of its 4 vertices", "its transmission", "here"});
}

}  // namespace transmission_load_test
