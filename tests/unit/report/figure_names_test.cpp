#include "report/figure/figure_names.h"

#include <gtest/gtest.h>

namespace figure_names_test {

using namespace gnomon;
using Names = std::vector<std::string>;

TEST(figure_names, what_all_settings_share_is_said_once) {
  const ShortNames one = without_shared({"map:size=1,pcf=3", "map:size=1,pcf=5"});
  EXPECT_EQ(one.heading, "map: size=1");
  EXPECT_EQ(one.names, (Names{"pcf=3", "pcf=5"}));
  const ShortNames techniques = without_shared({"map:size=1,pcf=3", "moments:size=1"});
  EXPECT_EQ(techniques.heading, "size=1");
  EXPECT_EQ(techniques.names, (Names{"map: pcf=3", "moments"}));
}

TEST(figure_names, no_setting_loses_its_name) {
  // Without its technique the first one would have none.
  const ShortNames defaults = without_shared({"map", "map:size=1"});
  EXPECT_EQ(defaults.heading, "");
  EXPECT_EQ(defaults.names, (Names{"map", "map:size=1"}));
  EXPECT_EQ(without_shared({"map:size=1"}).names, Names{"map:size=1"});
  EXPECT_EQ(without_shared({"map:size=1", "map:size=1"}).names, (Names{"map:size=1", "map:size=1"}));
  EXPECT_EQ(without_shared({}).names, Names{});
  EXPECT_EQ(without_shared({"shadow map, large", "map:points=1,2,3"}).names, (Names{"shadow map, large", "map:points=1,2,3"}));
}

TEST(figure_names, parameters_are_said_once) {
  const ShortNames one = values_alone({"map:alpha=mips,size=1,pcf=3", "map:alpha=mips,size=2,pcf=5"});
  EXPECT_EQ(one.heading, "map: alpha=mips; size, pcf");
  EXPECT_EQ(one.names, (Names{"1, 3", "2, 5"}));
  const ShortNames two = values_alone({"map:size=1,pcf=3", "moments:bits=16", "rays"});
  EXPECT_EQ(two.heading, "map: size, pcf; moments: bits");
  EXPECT_EQ(two.names, (Names{"map: 1, 3", "moments: 16", "rays"}));
  // A value without its parameter would not say of which of them it is.
  EXPECT_EQ(values_alone({"map:size=1", "map:pcf=3"}).names, (Names{"size=1", "pcf=3"}));
}

}  // namespace figure_names_test
