// Lights that options name, where glass colors the light.
#include <gtest/gtest.h>

#include "app/app.h"
#include "measure/scene/names.h"

namespace chosen_lights_test {

using namespace gnomon;
using namespace gnomon::app;

std::vector<Light> lights(const std::vector<std::string>& names) {
  std::vector<Light> lights;
  for (const std::string& name : names) lights.push_back({.name = name, .kind = PointLight{}});
  return lights;
}

using Names = std::vector<std::string>;

Names chosen_names(const std::vector<Light>& of, const Names& names) {
  Names result;
  for (const Light* light : chosen(of, names)) result.push_back(light->name);
  return result;
}

TEST(chosen_lights, a_whole_light_is_its_channels_and_a_channel_itself) {
  const std::vector<Light> colored = lights({"sun.red", "sun.green", "sun.blue", "sun_2.red", "sun_2.green", "sun_2.blue"});
  EXPECT_EQ(chosen_names(colored, {}), names_of(colored));
  EXPECT_EQ(chosen_names(colored, {"sun"}), Names({"sun.red", "sun.green", "sun.blue"}));
  EXPECT_EQ(chosen_names(colored, {"sun.green"}), Names({"sun.green"}));
  EXPECT_EQ(chosen_names(colored, {"sun_2", "sun.red"}), Names({"sun.red", "sun_2.red", "sun_2.green", "sun_2.blue"}));
  EXPECT_EQ(chosen_names(colored, {"red"}), Names());
  EXPECT_EQ(chosen_names(lights({"sun", "red", "lamp"}), {"lamp", "sun"}), Names({"sun", "lamp"}));
}

TEST(chosen_lights, channels_are_grouped_where_all_three_are_there) {
  const auto groups = [](const Names& names) { return by_whole_light(names, std::identity()); };
  using Groups = std::vector<Names>;
  EXPECT_EQ(groups({}), Groups());
  EXPECT_EQ(groups({"a", "b", "c", "d"}), Groups({{"a"}, {"b"}, {"c"}, {"d"}}));
  EXPECT_EQ(groups({"a.red", "a.green", "a.blue", "b.red", "b.green", "b.blue"}),
            Groups({{"a.red", "a.green", "a.blue"}, {"b.red", "b.green", "b.blue"}}));
  EXPECT_EQ(groups({"a.red", "a.blue", "b.red", "b.green", "b.blue", "c.green"}),
            Groups({{"a.red"}, {"a.blue"}, {"b.red", "b.green", "b.blue"}, {"c.green"}}));
}

}  // namespace chosen_lights_test
