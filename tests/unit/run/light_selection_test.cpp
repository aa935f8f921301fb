#include "measure/run/light_selection.h"

#include <fmt/format.h>
#include <gnomon/error.h>
#include <gtest/gtest.h>

#include "glass.h"
#include "measure/scene/channels.h"

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

TEST(light_selection, nothing_asks_for_each_light) {
  EXPECT_EQ(rows({}), (Names{"ring_1: ring_1", "sun: sun", "lamp: lamp", "ring_2: ring_2"}));
  EXPECT_EQ(rows({"*"}), rows({}));
}

TEST(light_selection, patterns_ask_for_each_that_is_like_them) {
  EXPECT_EQ(rows({"ring_*"}), (Names{"ring_1: ring_1", "ring_2: ring_2"}));
  EXPECT_EQ(rows({"*soft", "sun"}), (Names{"lamp: lamp", "sun: sun"}));
  EXPECT_EQ(rows({"*n*_2"}), (Names{"ring_2: ring_2"}));
}

TEST(light_selection, a_plus_puts_lights_together_in_the_order_of_the_scene) {
  EXPECT_EQ(rows({"lamp+ring_1"}), (Names{"ring_1+lamp: ring_1 lamp"}));
  EXPECT_EQ(rows({"all+"}), (Names{"all+: ring_1 sun lamp ring_2"}));
  EXPECT_EQ(rows({"*hard+"}), (Names{"*hard+: ring_1 sun ring_2"}));
  EXPECT_EQ(rows({"ring_*+lamp"}), (Names{"ring_*+lamp: ring_1 lamp ring_2"}));
}

TEST(light_selection, a_number_behind_the_plus_chooses_as_many_evenly) {
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

TEST(light_selection, the_same_lights_are_one_row_and_one_light_together_is_that_light) {
  EXPECT_EQ(rows({"sun+lamp", "lamp+sun", "sun", "sun"}), (Names{"sun+lamp: sun lamp", "sun: sun"}));
  EXPECT_EQ(rows({"*soft+", "lamp"}), (Names{"lamp: lamp"}));
}

TEST(light_selection, what_cannot_be_is_refused_with_what_there_is) {
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

TEST(light_selection, a_row_has_a_bounded_number_of_lights_and_a_scene_may_have_more) {
  Scene many;
  for (std::size_t k = 0; k <= most_lights; ++k) many.lights.push_back({.name = fmt::format("l{}", k), .kind = PointLight{}});
  EXPECT_EQ(rows({}, many).size(), most_lights + 1);
  EXPECT_EQ(refused({"all+"}, many), "lights all+ of scene four are 257; a row has at most 256 lights together");
}

// --- glass that colors the light

/// Lights sun, lamp (a disc) and bulb, each in three channels.
Scene colored() {
  Scene scene;
  scene.meshes = {glass::with_transmission(hand_made::square(1, 1), {0.9f, 0.2f, 0.1f})};
  scene.lights = {{.name = "sun", .kind = DirectionalLight{}},
                  {.name = "lamp", .kind = DiscLight{}},
                  {.name = "bulb", .kind = PointLight{}}};
  split_lights(scene);
  return scene;
}
const std::string sun = "sun.red sun.green sun.blue", lamp = "lamp.red lamp.green lamp.blue",
                  bulb = "bulb.red bulb.green bulb.blue";

TEST(light_selection, a_colored_light_is_its_three_channels_in_one_row) {
  const Names each = {"sun: " + sun, "lamp: " + lamp, "bulb: " + bulb};
  EXPECT_EQ(rows({"sun"}, colored()), (Names{each[0]}));
  EXPECT_EQ(rows({}, colored()), each);
  EXPECT_EQ(rows({"*"}, colored()), each);
  EXPECT_EQ(rows({"*hard"}, colored()), (Names{each[0], each[2]}));
  EXPECT_EQ(rows({"*soft"}, colored()), (Names{each[1]}));
  EXPECT_EQ(rows({"*u*"}, colored()), (Names{each[0], each[2]})) << "red, green and blue are no part of the name";
}

TEST(light_selection, one_channel_of_a_light_is_a_row_of_its_own) {
  EXPECT_EQ(rows({"sun.green"}, colored()), (Names{"sun.green: sun.green"}));
  EXPECT_EQ(rows({"sun", "sun.green"}, colored()), (Names{"sun: " + sun, "sun.green: sun.green"}));
  EXPECT_EQ(rows({"*.blue"}, colored()), (Names{"sun.blue: sun.blue", "lamp.blue: lamp.blue", "bulb.blue: bulb.blue"}));
  EXPECT_EQ(rows({"lamp.red+sun.red"}, colored()), (Names{"sun.red+lamp.red: sun.red lamp.red"}));
}

TEST(light_selection, several_colored_lights_have_all_their_channels) {
  EXPECT_EQ(rows({"lamp+sun"}, colored()), (Names{"sun+lamp: " + sun + ' ' + lamp}));
  EXPECT_EQ(rows({"all+"}, colored()), (Names{"all+: " + sun + ' ' + lamp + ' ' + bulb}));
  EXPECT_EQ(rows({"*hard+"}, colored()), (Names{"*hard+: " + sun + ' ' + bulb}));
  EXPECT_EQ(rows({"*soft+"}, colored()), (Names{"lamp: " + lamp})) << "one light together is that light";
  EXPECT_EQ(rows({"all+2"}, colored()), (Names{"all+2: " + sun + ' ' + lamp})) << "two lights are counted, not channels";
  EXPECT_EQ(refused({"all+4"}, colored()), "lights all+4: 4 is outside 1 .. 3, which are there");
}

TEST(light_selection, refusals_name_whole_lights) {
  EXPECT_EQ(refused({"sum"}, colored()), "scene four has no light sum; did you mean sun? It has: sun, lamp, bulb");
  EXPECT_EQ(refused({"x*"}, colored()), "scene four has no light whose name is like x*; it has: sun, lamp, bulb");
  EXPECT_NE(refused({"sun.yellow"}, colored()).find("no light sun.yellow"), std::string::npos);
  EXPECT_NE(refused({"sun+sun"}, colored()).find("is named twice; a row has each light once"), std::string::npos);
  EXPECT_NE(refused({"sun+sun.red"}, colored()).find("light sun.red is named twice"), std::string::npos);
  EXPECT_NE(refused({"sun.red"}).find("no light sun.red"), std::string::npos) << "a gray scene has no channels";
}

}  // namespace light_selection_test
