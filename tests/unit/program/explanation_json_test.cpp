#include "measure/program/explanation_json.h"

#include <gnomon/error.h>
#include <gtest/gtest.h>

#include <cmath>

namespace explanation_json_test {
using namespace gnomon;

TEST(ExplanationJson, reads_what_is_there_and_keeps_the_defaults_of_what_is_not) {
  const auto all = explanations_from_json(parse_json(R"([null, {}, {"covered": false, "bias": 0.5, "texel_width": 0.25,
      "shifted": [1, 2, 3], "element": 7, "outline_error": 0.125, "formula_differs": true, "cause": "off_screen",
      "taps": [{"origin": [0, 1, 0], "direction": [0, -1, 0], "weight": 0.75, "stored": null}, {"stored": 2}],
      "samples": [{"place": [4, 5, 6], "weight": 1, "visibility": 0.5}]}])"));
  ASSERT_EQ(all.size(), 3u);
  EXPECT_FALSE(all[0]);
  EXPECT_TRUE(all[1]->covered && all[1]->taps.empty() && !all[1]->shifted && !all[1]->element && !all[1]->formula_differs);
  const Explanation& e = *all[2];
  EXPECT_FALSE(e.covered);
  EXPECT_EQ(e.bias, 0.5);
  EXPECT_EQ(e.texel_width, 0.25);
  EXPECT_EQ(*e.shifted, glm::dvec3(1, 2, 3));
  EXPECT_EQ(*e.element, 7u);
  EXPECT_EQ(e.outline_error, 0.125);
  EXPECT_TRUE(e.formula_differs);
  EXPECT_EQ(e.cause, "off_screen");
  EXPECT_TRUE(all[1]->cause.empty());
  ASSERT_EQ(e.taps.size(), 2u);
  EXPECT_EQ(e.taps[0].direction, glm::dvec3(0, -1, 0));
  EXPECT_TRUE(std::isinf(e.taps[0].stored));
  EXPECT_EQ(e.taps[1].stored, 2);
  ASSERT_EQ(e.samples.size(), 1u);
  EXPECT_EQ(e.samples[0].place, glm::dvec3(4, 5, 6));
  EXPECT_EQ(e.samples[0].visibility, 0.5);
}

TEST(ExplanationJson, says_what_is_wrong_and_where) {
  const std::pair<const char*, const char*> wrong[] = {
      {R"({})", "a list is wanted"},
      {R"([1])", "explanations[0] is number; an object is wanted"},
      {R"([{"cover": true}])", "explanations[0] has no key cover"},
      {R"([null, {"covered": 1}])", "explanations[1].covered = 1 is neither true nor false"},
      {R"([{"bias": "big"}])", "explanations[0].bias = \"big\" is no number"},
      {R"([{"taps": {}}])", "explanations[0].taps is no list"},
      {R"([{"taps": [{"origin": [1, 2]}]}])", "explanations[0].taps[0].origin = [1,2] is no list of three numbers"},
      {R"([{"cause": 3}])", "explanations[0].cause = 3 is no name of a cause"},
      {R"([{"element": -1}])", "explanations[0].element = -1 is no number of an element"},
  };
  for (const auto& [text, says] : wrong) {
    try {
      explanations_from_json(parse_json(text));
      ADD_FAILURE() << text;
    } catch (const Error& error) {
      EXPECT_NE(std::string(error.what()).find(says), std::string::npos) << error.what();
    }
  }
}

}  // namespace explanation_json_test
