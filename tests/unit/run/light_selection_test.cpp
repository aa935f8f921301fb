#include "measure/run/light_selection.h"

#include <fmt/format.h>
#include <gnomon/error.h>
#include <gtest/gtest.h>

namespace light_selection_test {

using namespace gnomon;

/// Lights ring_1, sun, lamp (a disc), ring_2, in this order.
Scene four_lights() {
  Scene scene;
  scene.lights = {{.name = "ring_1", .kind = PointLight{}},
                  {.name = "sun", .kind = DirectionalLight{}},
                  {.name = "lamp", .kind = DiscLight{}},
                  {.name = "ring_2", .kind = PointLight{}}};
  return scene;
}

using Names = std::vector<std::string>;

/// "NAME: light light" of each row.
Names rows(const Names& words, const Scene& scene = four_lights()) {
  Names texts;
  for (const RowLights& row : row_lights(words, "four", scene))
    texts.push_back(fmt::format("{}: {}", row.name, joined(row.lights, " ")));
  return texts;
}
std::string refused(const Names& words, const Scene& scene = four_lights()) {
  try {
    row_lights(words, "four", scene);
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

TEST(light_words, nothing_asks_for_each_light) {
  EXPECT_EQ(rows({}), (Names{"ring_1: ring_1", "sun: sun", "lamp: lamp", "ring_2: ring_2"}));
  EXPECT_EQ(rows({"*"}), rows({}));
}

TEST(light_words, patterns_ask_for_each_that_is_like_them) {
  EXPECT_EQ(rows({"ring_*"}), (Names{"ring_1: ring_1", "ring_2: ring_2"}));
  EXPECT_EQ(rows({"*soft", "sun"}), (Names{"lamp: lamp", "sun: sun"}));
  EXPECT_EQ(rows({"*n*_2"}), (Names{"ring_2: ring_2"}));
}

TEST(light_words, a_plus_puts_lights_together_in_the_order_of_the_scene) {
  EXPECT_EQ(rows({"lamp+ring_1"}), (Names{"ring_1+lamp: ring_1 lamp"}));
  EXPECT_EQ(rows({"all+"}), (Names{"all+: ring_1 sun lamp ring_2"}));
  EXPECT_EQ(rows({"*hard+"}), (Names{"*hard+: ring_1 sun ring_2"}));
  EXPECT_EQ(rows({"ring_*+lamp"}), (Names{"ring_*+lamp: ring_1 lamp ring_2"}));
}

TEST(light_words, a_number_behind_the_plus_chooses_as_many_evenly) {
  EXPECT_EQ(rows({"all+2"}), (Names{"all+2: ring_1 lamp"}));
  EXPECT_EQ(rows({"*hard+3"}), (Names{"*hard+3: ring_1 sun ring_2"}));
  EXPECT_EQ(rows({"all+1", "ring_*+2", "all+4"}),
            (Names{"ring_1: ring_1", "ring_*+2: ring_1 ring_2", "all+4: ring_1 sun lamp ring_2"}));
  EXPECT_EQ(refused({"all+5"}), "lights all+5: 5 is outside 1 .. 4, which are there");
  EXPECT_EQ(refused({"ring_*+0"}), "lights ring_*+0: 0 is outside 1 .. 2, which are there");
  Scene scene = four_lights();
  scene.lights[2].name = "4";
  EXPECT_EQ(rows({"sun+4"}, scene), (Names{"sun+4: sun 4"})) << "beside a name it is a name";
}

TEST(light_words, the_same_lights_are_one_row_and_one_light_together_is_that_light) {
  EXPECT_EQ(rows({"sun+lamp", "lamp+sun", "sun", "sun"}), (Names{"sun+lamp: sun lamp", "sun: sun"}));
  EXPECT_EQ(rows({"*soft+", "lamp"}), (Names{"lamp: lamp"}));
}

TEST(light_words, what_cannot_be_is_refused_with_what_there_is) {
  EXPECT_EQ(refused({"sum"}), "scene four has no light sum; did you mean sun? It has: ring_1, sun, lamp, ring_2");
  EXPECT_EQ(refused({"sun+sum"}), "scene four has no light sum; did you mean sun? It has: ring_1, sun, lamp, ring_2");
  EXPECT_EQ(refused({"sun+sun"}), "lights sun+sun: light sun is named twice; a row has each light once");
  EXPECT_EQ(refused({"ring_*+ring_1"}), "lights ring_*+ring_1: light ring_1 is named twice; a row has each light once");
  for (const char* word : {"+", "+sun", "sun++lamp", "sun++"})
    EXPECT_NE(refused({word}).find("a name is missing beside a +"), std::string::npos) << word;
  EXPECT_EQ(refused({"spot_*"}), "scene four has no light whose name is like spot_*; it has: ring_1, sun, lamp, ring_2");
  Scene hard = four_lights();
  hard.lights.erase(hard.lights.begin() + 2);
  EXPECT_EQ(refused({"*soft+"}, hard), "scene four has no light with area, which *soft asks for; it has: ring_1, sun, ring_2");
}

TEST(light_words, a_row_has_a_bounded_number_of_lights_and_a_scene_may_have_more) {
  Scene many;
  for (std::size_t k = 0; k <= most_lights; ++k) many.lights.push_back({.name = fmt::format("l{}", k), .kind = PointLight{}});
  EXPECT_EQ(rows({}, many).size(), most_lights + 1);
  EXPECT_EQ(refused({"all+"}, many), "lights all+ of scene four are 257; a row has at most 256 lights together");
}

}  // namespace light_selection_test
