// Glass in the files for other programs: arrays and their look-up rule, and materials of glTF that come back.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "../error_words.h"
#include "../hand_made.h"
#include "measure/exchange/gltf.h"
#include "measure/exchange/gltf_transmission.h"
#include "measure/exchange/scene_files.h"
#include "measure/scene/blob.h"
#include "measure/scene/channels.h"
#include "measure/scene/load.h"
#include "measure/scratch_folder.h"

namespace transmission_files_test {
using namespace gnomon;
using namespace error_words;

using Wrap = AlphaMask::Wrap;

std::shared_ptr<const Transmission> of(int width, int height, int channels, const std::vector<float>& values,
                                       Wrap wrap_u = Wrap::repeat, Wrap wrap_v = Wrap::repeat) {
  return std::make_shared<const Transmission>(width, height, channels, values, wrap_u, wrap_v);
}
std::shared_ptr<const Transmission> constant(const glm::vec3& share) { return std::make_shared<const Transmission>(share); }

/// A ground, and above it a pane for each transmission.
Scene panes(const std::vector<std::shared_ptr<const Transmission>>& glass) {
  Scene scene;
  scene.name = "panes";
  scene.meshes.push_back(hand_made::square(1, 0));
  for (const auto& one : glass) {
    Mesh& mesh = scene.meshes.emplace_back(hand_made::square(1, static_cast<float>(scene.meshes.size())));
    mesh.transmission = one;
    mesh.seen = false;
    for (int k = 0; k < 4 && mesh.needs_uv(); ++k) mesh.uv.emplace_back(scene.meshes.size(), 0.25f * static_cast<float>(k));
  }
  for (std::size_t m = 0; m < scene.meshes.size(); ++m) scene.meshes[m].name = fmt::format("mesh_{}", m);
  scene.lights = {hand_made::point_light({0, 9, 0})};
  scene.views = {{}};
  return scene;
}

TEST(transmission_files, a_scene_without_glass_has_the_arrays_and_facts_that_it_had) {
  const Scene scene = panes({});
  const SceneArrays all(scene);
  EXPECT_EQ(all.arrays().size(), 3u);
  for (const char* key : {"transmission", "seen"}) EXPECT_FALSE(scene_facts_json(scene)["meshes"][0].contains(key));
}

TEST(transmission_files, arrays_hold_each_transmission_once) {
  const auto texture = of(2, 1, 3, {0, 0.1f, 0.2f, 1, 0.5f, 0.75f}, Wrap::mirror, Wrap::clamp);
  const Scene scene = panes({constant(glm::vec3(0.4f)), texture, texture});
  const SceneArrays all(scene);
  const Arrays arrays = all.arrays();
  EXPECT_EQ(arrays.size(), 5u) << "no bits of masks";
  const ArrayParts &values = arrays.at("transmission_values"), &uv = arrays.at("uv");
  EXPECT_EQ(values.type, "float32");
  EXPECT_EQ(values.shape, (std::vector<std::size_t>{1 + 6}));
  EXPECT_EQ(uv.shape, (std::vector<std::size_t>{16, 2}));
  const Json meshes = scene_facts_json(scene)["meshes"];
  EXPECT_TRUE(meshes[0]["transmission"].is_null());
  EXPECT_EQ(meshes[0]["seen"], true);
  EXPECT_EQ(meshes[1]["transmission"]["first_value"], 0);
  EXPECT_EQ(meshes[2]["transmission"], meshes[3]["transmission"]);
  EXPECT_EQ(meshes[3]["transmission"], parse_json(R"({"first_value": 1, "width": 2, "height": 1, "channels": 3,
                                                      "wrap_u": "mirror", "wrap_v": "clamp"})"));
  EXPECT_EQ(meshes[3]["seen"], false);
  // The rule of docs/protocol.md, of every texel and channel.
  const auto* const numbers = reinterpret_cast<const float*>(values.parts.at(0).data());
  for (int column = 0; column < 2; ++column)
    for (int channel = 0; channel < 3; ++channel)
      EXPECT_EQ(numbers[1 + (0 * 2 + column) * 3 + channel], texture->at(column, 0)[channel]);
  EXPECT_EQ(numbers[0], 0.4f);
}

TEST(transmission_files, a_mesh_that_is_not_seen_is_said_to_be_so) {
  Scene scene = panes({});
  scene.meshes[0].seen = false;
  EXPECT_EQ(scene_facts_json(scene)["meshes"][0]["seen"], false);
  EXPECT_EQ(SceneArrays(scene).arrays().size(), 3u);
}

Scene through_gltf(const Scene& scene) {
  const ScratchFolder folder = ScratchFolder::temporary("gnomon-glass");
  write_gltf(folder.path() / "scene.gltf", scene);
  return load_scene((folder.path() / "scene.gltf").string());
}
const Mesh& named(const Scene& scene, const std::string& name) { return *std::ranges::find(scene.meshes, name, &Mesh::name); }

// A factor of the format is a decimal number that reads back as the same float32.
TEST(transmission_files, what_is_the_same_everywhere_comes_back_exactly) {
  std::vector<std::shared_ptr<const Transmission>> glass;
  for (const float share : {0.1f, 0.3f, 1.0f / 3, 0.7f, std::nextafter(1.0f, 0.0f), 1e-20f, 1.0f})
    glass.push_back(constant(glm::vec3(share)));
  glass.push_back(constant({0.9f, 0.18f, 0.09f}));
  glass.push_back(constant({0, 1, 1.0f / 3}));
  const Scene scene = panes(glass), back = through_gltf(scene);
  for (const Mesh& mesh : scene.meshes) {
    const Mesh& same = named(back, mesh.name);
    ASSERT_EQ(same.transmission == nullptr, mesh.transmission == nullptr) << mesh.name;
    if (!mesh.transmission) continue;
    EXPECT_EQ(*same.transmission, *mesh.transmission) << mesh.name;
    EXPECT_FALSE(same.seen);
    EXPECT_TRUE(same.uv.empty());
  }
}

// Values that are a byte / 255 come back; others are rounded by half a step of 1/255 at most, and of sRGB by what is written.
TEST(transmission_files, texels_come_back_rounded_to_bytes) {
  std::vector<float> bytes, others, colors;
  for (int k = 0; k < 256; ++k) {
    bytes.push_back(static_cast<float>(k / 255.0));
    others.push_back(static_cast<float>(k) / 256);
    for (int c = 0; c < 3; ++c) colors.push_back(static_cast<float>((k + 85 * c) % 256) / 255);
  }
  const Scene scene = panes({of(16, 16, 1, bytes, Wrap::mirror, Wrap::clamp), of(256, 1, 1, others), of(16, 16, 3, colors)});
  EXPECT_EQ(gltf_transmission(*scene.meshes[1].transmission).rounding, 0);
  const Scene back = through_gltf(scene);
  EXPECT_EQ(*named(back, "mesh_1").transmission, *scene.meshes[1].transmission);
  for (const std::size_t m : {2, 3}) {
    const Transmission &a = *scene.meshes[m].transmission, &b = *named(back, scene.meshes[m].name).transmission;
    ASSERT_EQ(a.values().size(), b.values().size());
    double largest = 0;
    for (std::size_t k = 0; k < a.values().size(); ++k)
      largest = std::max(largest, std::abs(double(a.values()[k]) - double(b.values()[k])));
    EXPECT_EQ(largest, gltf_transmission(a).rounding) << m;
    EXPECT_GT(largest, 0) << m;
    // A step of sRGB near 1 is 2.4 / 1.055 / 255 at most.
    EXPECT_LE(largest, (m == 2 ? 0.5 : 0.5 * 2.4 / 1.055) / 255 + 1e-7) << m;
  }
}

TEST(transmission_files, a_mask_and_a_transmission_come_back_together) {
  Scene scene = panes({of(2, 1, 1, {0.2f, 0.8f}), constant({0.25f, 0.5f, 1})});
  const std::vector<std::uint8_t> alpha = {255, 0, 0, 255, 0, 255};
  for (const std::size_t m : {1, 2}) {
    scene.meshes[m].alpha_mask = std::make_shared<const AlphaMask>(3, 2, alpha);
    scene.meshes[m].uv = {{0, 0}, {0, 1}, {1, 1}, {1, 0}};
  }
  const Scene back = through_gltf(scene);
  for (const std::size_t m : {1, 2}) {
    const Mesh &a = scene.meshes[m], &b = named(back, a.name);
    ASSERT_TRUE(b.alpha_mask && b.transmission) << m;
    EXPECT_TRUE(std::ranges::equal(a.alpha_mask->bits(), b.alpha_mask->bits()));
    EXPECT_EQ(*a.transmission, *b.transmission) << m;
  }
  scene.meshes[1].transmission = of(1, 2, 3, {0, 0.5f, 1, 1, 0, 0});
  expect_words(error_of([&] { through_gltf(scene); }), {"mesh 'mesh_1'", "an alpha mask and a transmission of colored texels"});
}

// Lights of three channels are one light each in every file, and three again when it is loaded.
TEST(transmission_files, colored_glass_has_the_lights_of_its_scene_file) {
  Scene scene = panes({constant({0.9f, 0.2f, 0.1f})});
  scene.lights.push_back(hand_made::sun({0, -1, 0}));
  split_lights(scene);
  ASSERT_EQ(scene.lights.size(), 6u);
  const Json lights = scene_facts_json(scene)["lights"];
  ASSERT_EQ(lights.size(), 2u);
  EXPECT_EQ(lights[0]["name"], "point");
  EXPECT_EQ(lights[1]["name"], "sun");
  EXPECT_EQ(names_of(through_gltf(scene).lights), names_of(scene.lights));
}

TEST(transmission_files, gltf_keeps_albedo_and_whether_it_is_seen_in_extras) {
  Scene scene = panes({of(2, 1, 1, {0.25f, 0.75f})});
  scene.meshes[1].albedo = {0.1f, 0.2f, 0.3f};
  const ScratchFolder folder = ScratchFolder::temporary("gnomon-glass");
  write_gltf(folder.path() / "scene.gltf", scene);
  const auto text = MappedFile::open(folder.path() / "scene.gltf");
  const Json gltf = parse_json(std::string(reinterpret_cast<const char*>(text->bytes().data()), text->bytes().size()));
  const Json& extras = gltf["nodes"][1]["extras"];
  EXPECT_EQ(extras["albedo"], parse_json("[0.1, 0.2, 0.3]"));
  EXPECT_EQ(extras["seen"], false);
  EXPECT_LE(extras["transmission_rounding"].get<double>(), 0.5 / 255);
  EXPECT_FALSE(gltf["nodes"][0]["extras"].contains("seen"));
  EXPECT_NE(std::ranges::find(gltf["extensionsUsed"], Json("KHR_materials_transmission")), gltf["extensionsUsed"].end());
}

}  // namespace transmission_files_test
