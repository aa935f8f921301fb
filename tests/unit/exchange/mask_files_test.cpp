// What other programs get of alpha masks: arrays with a look-up rule, PNGs, and materials of glTF.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstring>

#include "../hand_made.h"
#include "measure/exchange/gltf.h"
#include "measure/exchange/mask_png.h"
#include "measure/exchange/scene_files.h"
#include "measure/picture/picture.h"
#include "measure/scene/blob.h"
#include "measure/scene/load.h"
#include "measure/scratch_folder.h"

namespace mask_files_test {
using namespace gnomon;

/// 40 texels a row take two words. Texel (x, y) is solid where 3 divides x + 2 y.
std::shared_ptr<const AlphaMask> wide_mask() {
  std::vector<std::uint8_t> alpha;
  for (int y = 0; y < 3; ++y)
    for (int x = 0; x < 40; ++x) alpha.push_back((x + 2 * y) % 3 == 0 ? 200 : 100);
  return std::make_shared<const AlphaMask>(40, 3, alpha, 1.0f, 0.625f, AlphaMask::Wrap::mirror, AlphaMask::Wrap::clamp);
}

/// A ground, a card of a mask of one word, and two of the wide one.
Scene masked_scene() {
  Scene scene;
  scene.name = "masked";
  for (int height = 0; height < 4; ++height) scene.meshes.push_back(hand_made::square(1, static_cast<float>(height)));
  const std::vector<std::uint8_t> one = {255};
  scene.meshes[1].alpha_mask = std::make_shared<const AlphaMask>(1, 1, one);
  scene.meshes[2].alpha_mask = scene.meshes[3].alpha_mask = wide_mask();
  for (std::size_t m = 1; m < 4; ++m)
    for (int k = 0; k < 4; ++k) scene.meshes[m].uv.emplace_back(m, 0.25f * static_cast<float>(k));
  scene.lights = {hand_made::point_light({0, 9, 0})};
  scene.views = {{}};
  return scene;
}

TEST(mask_files, a_scene_without_masks_has_the_arrays_and_facts_that_it_had) {
  Scene scene;
  scene.meshes = {hand_made::square(1, 0)};
  const SceneArrays all(scene);
  EXPECT_EQ(all.arrays().size(), 3u);
  EXPECT_FALSE(scene_facts_json(scene)["meshes"][0].contains("alpha_mask"));
}

TEST(mask_files, arrays_hold_uv_and_each_mask_once) {
  const Scene scene = masked_scene();
  const SceneArrays all(scene);
  const Arrays arrays = all.arrays();
  const ArrayParts &uv = arrays.at("uv"), &bits = arrays.at("alpha_mask_bits");
  EXPECT_EQ(uv.type, "float32");
  EXPECT_EQ(uv.shape, (std::vector<std::size_t>{16, 2}));
  const auto* const places = reinterpret_cast<const float*>(uv.parts.at(0).data());
  for (int k = 0; k < 8; ++k) EXPECT_EQ(places[k], 0) << k;  // of the ground
  EXPECT_EQ(places[2 * 7], 1);                               // the last vertex of mesh 1
  EXPECT_EQ(places[2 * 7 + 1], 0.75f);
  EXPECT_EQ(bits.type, "uint32");
  EXPECT_EQ(bits.shape, (std::vector<std::size_t>{1 + 3 * 2}));
  const Json meshes = scene_facts_json(scene)["meshes"];
  EXPECT_TRUE(meshes[0]["alpha_mask"].is_null());
  EXPECT_EQ(meshes[1]["alpha_mask"]["first_word"], 0);
  EXPECT_EQ(meshes[2]["alpha_mask"], meshes[3]["alpha_mask"]);
  EXPECT_EQ(
      meshes[3]["alpha_mask"],
      parse_json(R"({"first_word": 1, "width": 40, "height": 3, "wrap_u": "mirror", "wrap_v": "clamp", "cutoff": 0.625})"));
  // The rule of docs/protocol.md, of every texel.
  const auto* const words = reinterpret_cast<const std::uint32_t*>(bits.parts.at(0).data());
  for (int row = 0; row < 3; ++row)
    for (int column = 0; column < 40; ++column)
      EXPECT_EQ(words[1 + row * 2 + column / 32] >> (column % 32) & 1, (column + 2 * row) % 3 == 0) << column << ' ' << row;
}

void expect_is_mask(const std::filesystem::path& png, const AlphaMask& mask) {
  const std::vector<float> alpha = read_exr(png, "A", mask.width(), mask.height());
  const std::vector<float> gray = read_exr(png, "Y", mask.width(), mask.height());
  for (int y = 0, i = 0; y < mask.height(); ++y)
    for (int x = 0; x < mask.width(); ++x, ++i) {
      ASSERT_EQ(alpha[i], mask.is_solid(x, y) ? 1 : 0) << x << ' ' << y;
      ASSERT_EQ(gray[i], 1);
    }
}

// A block of the stream has 65535 bytes at most: these take one, two and many.
TEST(mask_files, a_png_has_the_bits_as_its_alpha) {
  const ScratchFolder folder = ScratchFolder::temporary("gnomon-masks");
  for (const int side : {1, 7, 200, 513}) {
    std::vector<std::uint8_t> alpha;
    for (int i = 0; i < side * side; ++i) alpha.push_back(static_cast<std::uint8_t>(i * 37 % 251));
    const AlphaMask mask(side, side, alpha);
    write_file(folder.path() / "mask.png", mask_png(mask));
    expect_is_mask(folder.path() / "mask.png", mask);
  }
}

TEST(mask_files, gltf_has_a_material_of_mode_mask_for_each_card_and_one_image_a_mask) {
  const Scene scene = masked_scene();
  const ScratchFolder folder = ScratchFolder::temporary("gnomon-masks");
  write_gltf(folder.path() / "scene.gltf", scene);
  const auto text = MappedFile::open(folder.path() / "scene.gltf"), numbers = MappedFile::open(folder.path() / "scene.bin");
  const Json gltf = parse_json(std::string(reinterpret_cast<const char*>(text->bytes().data()), text->bytes().size()));
  EXPECT_EQ(gltf["images"].size(), 2u);
  EXPECT_FALSE(gltf["materials"][0].contains("alphaMode"));
  const Json &material = gltf["materials"][3], &primitive = gltf["meshes"][3]["primitives"][0];
  EXPECT_EQ(material["alphaMode"], "MASK");
  EXPECT_EQ(material["alphaCutoff"], 0.5);
  const Json& texture = gltf["textures"][material["pbrMetallicRoughness"]["baseColorTexture"]["index"].get<std::size_t>()];
  const Json& sampler = gltf["samplers"][texture["sampler"].get<std::size_t>()];
  EXPECT_EQ(sampler, parse_json(R"({"magFilter": 9728, "minFilter": 9728, "wrapS": 33648, "wrapT": 33071})"));
  const auto bytes_of = [&](std::size_t view) {
    const Json& entry = gltf["bufferViews"][view];
    return numbers->bytes().subspan(entry["byteOffset"].get<std::size_t>(), entry["byteLength"].get<std::size_t>());
  };
  const Json& image = gltf["images"][texture["source"].get<std::size_t>()];
  EXPECT_EQ(image["mimeType"], "image/png");
  write_file(folder.path() / "mask.png", bytes_of(image["bufferView"].get<std::size_t>()));
  expect_is_mask(folder.path() / "mask.png", *scene.meshes[3].alpha_mask);
  const Json& places = gltf["accessors"][primitive["attributes"]["TEXCOORD_0"].get<std::size_t>()];
  EXPECT_EQ(places["type"], "VEC2");
  EXPECT_EQ(places["count"], 4);
  EXPECT_EQ(gltf["bufferViews"][places["bufferView"].get<std::size_t>()]["byteOffset"].get<std::size_t>() % 4, 0u);
  const auto uv = bytes_of(places["bufferView"].get<std::size_t>());
  ASSERT_EQ(uv.size(), 4 * sizeof(glm::vec2));
  EXPECT_EQ(std::memcmp(uv.data(), scene.meshes[3].uv.data(), uv.size()), 0);
}

/// x, y, z, u, v of each corner of a mesh's triangles, sorted: an importer may order vertices anew.
std::vector<std::array<float, 5>> corners_of(const Mesh& mesh) {
  std::vector<std::array<float, 5>> corners;
  for (const glm::uvec3& triangle : mesh.triangles)
    for (int k = 0; k < 3; ++k) {
      const glm::vec3 point = mesh.positions[triangle[k]];
      const glm::vec2 uv = mesh.uv[triangle[k]];
      corners.push_back({point.x, point.y, point.z, uv.x, uv.y});
    }
  std::ranges::sort(corners);
  return corners;
}

TEST(mask_files, gltf_comes_back_through_the_importer) {
  Scene scene = masked_scene();
  for (std::size_t m = 0; m < scene.meshes.size(); ++m) scene.meshes[m].name = fmt::format("mesh_{}", m);
  const ScratchFolder folder = ScratchFolder::temporary("gnomon-masks");
  write_gltf(folder.path() / "scene.gltf", scene);
  const Scene back = load_scene((folder.path() / "scene.gltf").string());
  ASSERT_EQ(back.meshes.size(), scene.meshes.size());
  for (const Mesh& mesh : scene.meshes) {
    const auto same = std::ranges::find(back.meshes, mesh.name, &Mesh::name);
    ASSERT_NE(same, back.meshes.end()) << mesh.name;
    const bool has_holes = mesh.alpha_mask && mesh.alpha_mask->coverage() < 1;
    ASSERT_EQ(same->alpha_mask != nullptr, has_holes) << mesh.name;  // one without a hole is left out
    if (!has_holes) continue;
    EXPECT_TRUE(std::ranges::equal(same->alpha_mask->bits(), mesh.alpha_mask->bits())) << mesh.name;
    EXPECT_EQ(same->alpha_mask->wrap_u(), mesh.alpha_mask->wrap_u());
    EXPECT_EQ(same->alpha_mask->wrap_v(), mesh.alpha_mask->wrap_v());
    EXPECT_EQ(corners_of(*same), corners_of(mesh)) << mesh.name;
  }
}

}  // namespace mask_files_test
