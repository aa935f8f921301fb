// What `describe` shows of scenes that move.
#include <gtest/gtest.h>

#include "../moving_file.h"
#include "report/scene_description.h"

namespace scene_motion_test {
using namespace gnomon;
using namespace moving_file;

bool has(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

TEST(scene_motion, is_described_with_its_tracks_keys_and_meshes) {
  Scene scene = imported(bending());
  add(walking(), scene);
  scene.lights = {{"a", PointLight{{0, 5, 0}}}};
  scene.views = {{}};
  const std::string text = describe_text("folk.gltf", scene);
  for (const char* part : {"animation", "bend", "bender", "walk", "walker"})
    EXPECT_TRUE(has(text, part)) << part << '\n' << text;
  const Json animations = describe_json("folk.gltf", scene)["animations"];
  ASSERT_EQ(animations.size(), 2u);
  EXPECT_EQ(animations[0], Json({{"name", "bend"}, {"seconds", 1.0}, {"tracks", 2}, {"keys", 4}, {"meshes", {0}}}));
  EXPECT_EQ(animations[1], Json({{"name", "walk"}, {"seconds", 1.0}, {"tracks", 1}, {"keys", 2}, {"meshes", {1}}}));

  scene.motion = nullptr;
  EXPECT_FALSE(has(describe_text("folk.gltf", scene), "animation"));
  EXPECT_EQ(describe_json("folk.gltf", scene)["animations"], Json::array());
}

}  // namespace scene_motion_test
