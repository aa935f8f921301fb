// What `describe` shows of casters with holes.
#include <gtest/gtest.h>

#include "../hand_made.h"
#include "report/listing.h"
#include "report/pages.h"
#include "report/scene_description.h"

namespace scene_masks_test {
using namespace gnomon;

bool has(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

TEST(scene_masks, are_described_with_their_meshes_and_coverage) {
  Scene scene;
  scene.meshes = {hand_made::square(1, 0), hand_made::square(1, 1), hand_made::square(1, 2)};
  scene.lights = {hand_made::point_light({0, 9, 0})};
  scene.views = {{}};
  EXPECT_FALSE(has(describe_text("cards.toml", scene), "alpha mask"));
  EXPECT_FALSE(describe_json("cards.toml", scene)["meshes"][1].contains("alpha_mask"));
  const std::vector<std::uint8_t> alpha = {255, 0, 0, 0, 0, 0, 0, 255};
  scene.meshes[1].name = "card";
  scene.meshes[1].alpha_mask = scene.meshes[2].alpha_mask = std::make_shared<const AlphaMask>(4, 2, alpha);
  scene.meshes[1].uv = scene.meshes[2].uv = std::vector<glm::vec2>(4);
  const std::string text = describe_text("cards.toml", scene);
  EXPECT_TRUE(has(text, "4 x 2")) << text;
  EXPECT_TRUE(has(text, "repeat repeat")) << text;
  EXPECT_TRUE(has(text, "25 %")) << text;
  const Json meshes = describe_json("cards.toml", scene)["meshes"];
  EXPECT_FALSE(meshes[0].contains("alpha_mask"));
  EXPECT_EQ(meshes[2]["alpha_mask"]["coverage"], 0.25);
  EXPECT_EQ(meshes[2]["closed"], false);
}

TEST(scene_masks, are_named_where_a_technique_handles_them) {
  TechniqueEntry entry = registry().technique("svbsp");
  for (const bool handles : {false, true}) {
    entry.about.handles = handles ? std::span<const Feature>(with_alpha_masks) : std::span<const Feature>();
    EXPECT_EQ(list_json({&entry, 1})[0]["handles"], handles ? Json({"alpha_masks"}) : Json::array());
    EXPECT_TRUE(has(technique_page(entry), handles ? "| Handles | `alpha_masks` |" : "| Handles | - |"));
    EXPECT_EQ(has(describe_text(entry), "alpha_masks"), handles);
  }
}

}  // namespace scene_masks_test
