// Glass that colors the light, as techniques meet it: the mask under a channel of a light is that of the scene in this channel,
// bit for bit, whoever shares what between the objects of several channels; and what arrives is what is derived on paper.
#include <fmt/format.h>

#include <fstream>

#include "area_lights.h"
#include "glass_maps_rig.h"
#include "glass_masks.h"
#include "measure/frame/frame.h"
#include "measure/scene/channels.h"
#include "measure/scene/load.h"
#include "measure/scratch_folder.h"
#include "measure/worker/worker_client.h"
#include "places.h"

namespace colored_glass_test {

using namespace gnomon;
using glass_maps_rig::moved;
using glass_masks::from_above;
using glass_masks::unseen;

constexpr int width = 48, height = 36;

/// Two panes of constant color, one over the other, a gray one beside them, and an opaque card, over a ground. Nine lights:
/// sun, point and rect in three channels each.
Scene panes() {
  Scene scene;
  scene.name = "panes";
  scene.meshes = {hand_made::square(3, 0),
                  unseen(moved(glass::with_transmission(hand_made::square(1, 2), {0.9f, 0.18f, 0.09f}), {-0.4f, 0, 0})),
                  unseen(moved(glass::with_transmission(hand_made::square(1, 1), {0.1f, 0.8f, 0.2f}), {0.4f, 0, 0.2f})),
                  unseen(moved(glass::glass_card(0.4f, 1.5f, 0.5f), {-1, 0, -1})),
                  unseen(moved(hand_made::square(0.3f, 0.5f), {1.2f, 0, 1}))};
  scene.lights = {hand_made::sun({0.2f, -1, 0.1f}), hand_made::point_light({0.4f, 5, -0.3f}),
                  rect({0.3f, 5, -0.2f}, {0.4f, 0, 0}, {0, 0, 0.4f})};
  scene.views = {from_above};
  split_lights(scene);
  return scene;
}
/// The same with texels of any colors, and with holes.
Scene stained_panes() {
  Scene scene = panes();
  std::vector<float> colors;
  Random random(5);
  for (int i = 0; i < 4 * 4 * 3; ++i) colors.push_back(glass::any_share(random));
  const auto stained = std::make_shared<const Transmission>(4, 4, 3, colors);
  for (const std::size_t m : {1, 2})
    scene.meshes[m] = glass::with_transmission(scene.meshes[m], stained, {{0, 0}, {0, 1}, {1, 1}, {1, 0}});
  scene.meshes[2].alpha_mask = masked::checker(3, 3);
  return scene;
}

bool has_parameter(const std::string& id, std::string_view name) {
  const auto technique = registry().technique(id).make();
  return std::ranges::any_of(technique->parameters(), [&](const Parameter* one) { return one->name() == name; });
}
/// Small maps, few rays; of hard shadows a technique that multiplies.
std::string quick_settings(const std::string& id) {
  std::vector<std::string> settings;
  if (has_parameter(id, "resolution")) settings.push_back("resolution=512");
  if (has_parameter(id, "samples")) settings.push_back("samples=4");
  if (has_parameter(id, "of")) settings.push_back("of=alias_free_map");
  return joined(settings, ",");
}

class ColoredGlass : public glass_maps_rig::TestRig, public testing::WithParamInterface<std::string> {
 protected:
  /// Masks of a worker on a colored scene under all its lights together, beside masks of the scenes in one channel, a fresh
  /// object for each. Answers how many lights are supported, and how many channels of one light differ from its red.
  struct Found {
    int supported = 0, colored = 0;
  };
  static Found compare(const std::string& id, const Scene& scene) {
    const ScratchFolder folder = ScratchFolder::temporary("gnomon_colored");
    FrameStore frames(scene, folder.path() / "frames");
    const FrameKey key{.view = scene.views[0], .width = width, .height = height, .truth = Truth::mesh};
    const std::string settings = quick_settings(id);
    WorkerClient worker({.threads = 0, .plugins = {}, .program = tested_program()}, folder.path() / "w", 120);
    worker.load({.scene_file = frames.scene_file(), .technique = id, .settings = settings});
    FrameRequest request{.gbuffer_file = frames.gbuffer_file(key), .width = width, .height = height, .truth = key.truth};
    request.seen = SceneLightAndView{.lights = {0, 1, 2, 3, 4, 5, 6, 7, 8}};
    const FrameReply reply = worker.frame(request);
    EXPECT_EQ(reply.lights.size(), scene.lights.size());
    const std::vector<float> masks = worker.mask();
    EXPECT_EQ(masks.size(), scene.lights.size() * width * height);

    const GBuffer g = frames.gbuffer(key);
    const Scene gray[] = {in_channel(scene, Channel::red), in_channel(scene, Channel::green), in_channel(scene, Channel::blue)};
    Found found;
    std::vector<float> red;
    for (std::size_t k = 0; k < scene.lights.size(); ++k) {
      const Light& light = scene.lights[k];
      const Support alone = support(id.c_str(), settings, gray[k % 3], light);
      EXPECT_EQ(reply.lights.at(k).kind(), alone.kind()) << light.name;
      EXPECT_EQ(reply.lights.at(k).why(), alone.why()) << light.name;
      if (!alone) continue;
      const std::vector<float> mask(masks.begin() + k * g.size(), masks.begin() + (k + 1) * g.size());
      EXPECT_EQ(mask, run(id.c_str(), settings, gray[k % 3], light, g).mask) << light.name;
      ++found.supported;
      if (k % 3 == 0) red = mask;
      found.colored += mask != red;
    }
    return found;
  }
};

std::vector<std::string> with_glass() {
  std::vector<std::string> ids;
  for (const TechniqueEntry& entry : registry().techniques())
    if (std::ranges::find(entry.about.handles, Feature::transmission) != entry.about.handles.end()) ids.push_back(entry.id);
  return ids;
}
/// Those that multiply exactly, all under lights without area.
std::vector<std::string> exact() {
  return {"alias_free_map", "crow_counting", "embree_rays", "exact_rays", "shadow_volume_tree"};
}
std::string name_of(const testing::TestParamInfo<std::string>& info) { return info.param; }

INSTANTIATE_TEST_SUITE_P(All, ColoredGlass, testing::ValuesIn(with_glass()), name_of);

TEST_P(ColoredGlass, a_mask_under_a_channel_is_that_of_the_scene_in_this_channel) {
  const Found found = compare(GetParam(), panes());
  EXPECT_GE(found.supported, 3) << "all channels of a light";
  EXPECT_EQ(found.supported % 3, 0) << "or none of them";
  const bool multiplies = !has_parameter(GetParam(), "glass") && GetParam() != "unshadowed";
  EXPECT_EQ(found.colored, multiplies ? found.supported * 2 / 3 : 0) << "green and blue are masks of their own, or all are one";
}

const char* const pane_gltf = R"({"asset":{"version":"2.0"},"extensionsUsed":["KHR_materials_transmission"],
  "nodes":[{"mesh":0}],"meshes":[{"primitives":[{"material":0,"indices":1,"attributes":{"POSITION":0}}]}],
  "materials":[{"extensions":{"KHR_materials_transmission":{"transmissionFactor":0.9}},
                "pbrMetallicRoughness":{"metallicFactor":0,"baseColorFactor":[1,0.2,0.1,0.5]})";
const char* const pane_gltf_end = R"(}],"buffers":[{"uri":"pane.bin","byteLength":60}],
  "bufferViews":[{"buffer":0,"byteLength":48},{"buffer":0,"byteOffset":48,"byteLength":12}],
  "accessors":[{"bufferView":0,"componentType":5126,"count":4,"type":"VEC3","min":[-1,0,-1],"max":[1,0,1]},
               {"bufferView":1,"componentType":5123,"count":6,"type":"SCALAR"}]})";

/// A scene of files: over a floor a pane of glTF, |x + 0.5| and |z| below 1, and a described one, |x - 0.5| and |z| below 1.
/// `more` goes to the material of glTF.
Scene loaded(const ScratchFolder& folder, const char* more) {
  const auto write = [&](const char* name, const std::string& bytes) {
    std::ofstream(folder.path() / name, std::ios::binary) << bytes;
  };
  const float corners[] = {-1, 0, -1, -1, 0, 1, 1, 0, 1, 1, 0, -1};
  const std::uint16_t triangles[] = {0, 1, 2, 0, 2, 3};
  write("pane.bin", std::string(reinterpret_cast<const char*>(corners), sizeof(corners)) +
                        std::string(reinterpret_cast<const char*>(triangles), sizeof(triangles)));
  write("pane.gltf", std::string(pane_gltf) + more + pane_gltf_end);
  write("panes.toml",
        "[[shape]]\nkind = \"plane\"\ncenter = [0, 0, 0]\nnormal = [0, 1, 0]\nsize = [6, 6]\n"
        "[[mesh]]\nfile = \"pane.gltf\"\ntranslate = [-0.5, 2, 0]\n"
        "[[shape]]\nkind = \"plane\"\ncenter = [0.5, 1, 0]\nnormal = [0, 1, 0]\nsize = [2, 2]\ntransmission = [0.1, 0.8, 0.2]\n"
        "[[light]]\nname = \"sun\"\nkind = \"directional\"\ndirection = [0, -1, 0]\n"
        "[[view]]\nname = \"main\"\neye = [0.3, 7, 1.5]\ntarget = [0.1, 0, 0]\n");
  return load_scene((folder.path() / "panes.toml").string());
}

class ExactColoredGlass : public ColoredGlass {
 protected:
  /// Compares masks of a loaded scene with `first` behind the pane of glTF, `second` behind the other, and their product behind
  /// both. A pixel within 0.02 m of an edge or a diagonal is not compared.
  static void expect_products(const std::string& id, const char* more, const glm::dvec3& first) {
    const ScratchFolder folder = ScratchFolder::temporary("gnomon_panes");
    const Scene scene = loaded(folder, more);
    ASSERT_EQ(scene.lights.size(), 3u);
    EXPECT_EQ(scene.lights[1].name, "sun.green");
    const GBuffer g = glass_masks::seen_of(scene, scene.views[0], width, height);
    const glm::dvec3 second(0.1, 0.8, 0.2);
    ChannelScenes channels(scene);
    for (std::size_t k = 0; k < 3; ++k) {
      const Light& light = scene.lights[k];
      const small_world::Run found = run(id.c_str(), "", channels.of(light), light, g);
      std::array<int, 4> counts{};
      for (std::size_t i = 0; i < g.size(); ++i) {
        const glm::vec3 p = g.position(i);
        const auto is_near = [](float a, float b) { return std::abs(a - b) < 0.02f; };
        if (g.is_background(i) || is_near(std::abs(p.z), 1)) continue;
        if (std::ranges::any_of(std::array{-1.5f, -0.5f, 0.5f, 1.5f}, [&](float x) { return is_near(p.x, x); })) continue;
        if (is_near(std::abs(p.x + 0.5f), std::abs(p.z)) || is_near(std::abs(p.x - 0.5f), std::abs(p.z))) continue;
        const bool is_first = std::abs(p.x + 0.5f) < 1 && std::abs(p.z) < 1;
        const bool is_second = std::abs(p.x - 0.5f) < 1 && std::abs(p.z) < 1;
        ++counts[2 * is_first + is_second];
        const double expected = (is_first ? first[k] : 1) * (is_second ? second[k] : 1);
        // Two factors and their product, each rounded once, by at most 2^-24 of itself.
        ASSERT_NEAR(found.mask[i], expected, 3.1 * 0x1p-24 * expected) << light.name << " at " << p.x << ", " << p.z;
      }
      EXPECT_GT(std::ranges::min(counts), 20) << light.name;
    }
  }
};
INSTANTIATE_TEST_SUITE_P(All, ExactColoredGlass, testing::ValuesIn(exact()), name_of);

TEST_P(ExactColoredGlass, so_is_one_behind_texels_and_holes) {
  const Found found = compare(GetParam(), stained_panes());
  EXPECT_EQ(found.colored, found.supported * 2 / 3) << "green and blue of each light are masks of their own";
}

// Transmission 0.9 of the color (1, 0.2, 0.1), then (0.1, 0.8, 0.2): (0.09, 0.144, 0.018) is left.
TEST_P(ExactColoredGlass, two_panes_let_the_product_of_each_channel_through) {
  expect_products(GetParam(), "", {0.9, 0.18, 0.09});
}

// Half of the pane covers: 1 - 0.5 + 0.5 * (0.9, 0.18, 0.09).
TEST_P(ExactColoredGlass, half_covered_glass_is_the_mean_of_it_and_of_nothing) {
  expect_products(GetParam(), R"(,"alphaMode":"BLEND")", {0.95, 0.59, 0.545});
}

}  // namespace colored_glass_test
