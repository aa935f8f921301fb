#include "measure/scene/scene_json.h"

#include <gtest/gtest.h>

namespace scene_json_test {
using namespace gnomon;

// The words are those of a scene file, and a float reads back as the same float.
TEST(SceneJson, has_the_keys_of_a_scene_file) {
  EXPECT_EQ(
      json_text(scene_json(Light{.name = "lamp", .kind = DiscLight{{0.1f, 2, 3}, {0, -1, 0}, 0.5f, Emits::in_front}})),
      R"({"name":"lamp","kind":"disc","center":[0.1,2,3],"normal":[0,-1,0],"radius":0.5,"one_sided":true,"intensity":1})");
  EXPECT_EQ(json_text(scene_json(Light{.name = "sun", .kind = DirectionalLight{{0.3f, -1, 0}}, .intensity = 2})),
            R"({"name":"sun","kind":"directional","direction":[0.3,-1,0],"intensity":2})");
  EXPECT_EQ(json_text(scene_json(Shape(Sphere{{1, 2, 3}, 0.25f}))), R"({"kind":"sphere","center":[1,2,3],"radius":0.25})");
  const float odd = 0.1f + 0.2f;
  EXPECT_EQ(number_json(odd).get<float>(), odd);
  EXPECT_EQ(scene_json(View{})["fov_y_degrees"], 45);
}

}  // namespace scene_json_test
