// What `describe` shows of glass.
#include <gtest/gtest.h>

#include "../hand_made.h"
#include "measure/scene/channels.h"
#include "report/scene_description.h"

namespace scene_transmission_test {
using namespace gnomon;

bool has(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

Scene panes() {
  Scene scene;
  for (int height = 0; height < 4; ++height) scene.meshes.push_back(hand_made::square(1, static_cast<float>(height)));
  scene.lights = {hand_made::point_light({0, 9, 0})};
  scene.views = {{}};
  return scene;
}

TEST(scene_transmission, is_described_with_its_meshes_and_shares) {
  Scene scene = panes();
  EXPECT_FALSE(has(describe_text("panes.toml", scene), "transmission"));
  const auto glass = std::make_shared<const Transmission>(2, 1, 1, std::vector<float>{0.25f, 0.75f}, AlphaMask::Wrap::mirror);
  scene.meshes[1].name = "pane";
  scene.meshes[1].transmission = scene.meshes[2].transmission = glass;
  scene.meshes[1].uv = scene.meshes[2].uv = std::vector<glm::vec2>(4);
  scene.meshes[1].seen = false;
  scene.meshes[3].transmission = std::make_shared<const Transmission>(glm::vec3(0.1f, 0.2f, 0.6f));
  const std::string text = describe_text("panes.toml", scene);
  for (const char* word : {"2 x 1", "mirror repeat", "0.25", "0.5", "0.75", "pane", "1 x 1", "0.1", "0.3", "0.6"})
    EXPECT_TRUE(has(text, word)) << word << " in\n" << text;
  const Json meshes = describe_json("panes.toml", scene)["meshes"];
  EXPECT_EQ(meshes[1]["transmission"],
            parse_json(R"({"width": 2, "height": 1, "channels": 1, "wrap_u": "mirror", "wrap_v": "repeat",
                           "least": 0.25, "mean": 0.5, "most": 0.75})"));
  EXPECT_EQ(meshes[1]["seen"], false);
  EXPECT_EQ(meshes[2]["seen"], true);
  EXPECT_EQ(meshes[1]["closed"], false);
  EXPECT_EQ(meshes[3]["transmission"]["channels"], 3);
}

TEST(scene_transmission, that_colors_the_light_leaves_the_lights_as_their_file_has_them) {
  Scene scene = panes();
  scene.meshes[1].transmission = std::make_shared<const Transmission>(glm::vec3(0.1f, 0.2f, 0.6f));
  split_lights(scene);
  ASSERT_EQ(scene.lights.size(), 3u);
  EXPECT_FALSE(has(describe_text("panes.toml", scene), "point."));
  const Json lights = describe_json("panes.toml", scene)["lights"];
  ASSERT_EQ(lights.size(), 1u);
  EXPECT_EQ(lights[0]["name"], "point");
}

TEST(scene_transmission, meshes_without_it_are_described_as_before) {
  Scene scene = panes();
  for (const char* key : {"transmission", "seen"}) EXPECT_FALSE(describe_json("panes.toml", scene)["meshes"][1].contains(key));
  scene.meshes[1].seen = false;
  const Json meshes = describe_json("panes.toml", scene)["meshes"];
  EXPECT_EQ(meshes[1]["seen"], false);
  EXPECT_FALSE(meshes[1].contains("transmission"));
  EXPECT_FALSE(meshes[0].contains("seen"));
}

}  // namespace scene_transmission_test
