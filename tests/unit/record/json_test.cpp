#include "measure/json.h"

#include <gtest/gtest.h>

#include <ctime>

namespace json_test {

using namespace gnomon;

Json without(Json value, const std::string& key) {
  if (value.is_object()) value.erase(key);
  if (value.is_structured())
    for (Json& part : value) part = without(part, key);
  return value;
}

TEST(json, members_of_a_key_are_left_out_wherever_they_stand) {
  for (const char* const text :
       {"1", "\"extras\"", "[]", "{}", "null", R"({"extras": 1})", R"({"extras": {"extras": [1, {"a": 2}]}, "a": 3})",
        R"([{"a": [1, -2, 3.5, true, null, "x"], "extras": [[[]]], "b": {"extras": "y", "c": {}}}, [], {"extras": null}])",
        R"({"a": 1, "extras": 2, "a": {"b": 3}})"})
    EXPECT_EQ(parse_json(text, "extras"), without(parse_json(text), "extras")) << text;
  EXPECT_EQ(json_text(parse_json(R"({"b": 1, "extras": {}, "a": 2})", "extras")), R"({"b":1,"a":2})");
}

TEST(json, what_is_none_is_refused_with_or_without_a_key) {
  for (const char* const text : {"", "[", "{\"a\": }", "[1,]", "{} {}", "{\"extras\": [}", "nul"}) {
    EXPECT_THROW(parse_json(text), Json::exception) << text;
    EXPECT_THROW(parse_json(text, "extras"), Json::exception) << text;
  }
}

TEST(json, leaving_out_a_key_takes_no_longer_for_each_element_in_a_long_list) {
  const auto seconds = [](std::size_t count) {
    std::string text = "[{}";
    for (std::size_t k = 1; k < count; ++k) text += ",{}";
    text += "]";
    const std::clock_t start = std::clock();
    EXPECT_EQ(parse_json(text, "extras").size(), count);
    return static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
  };
  // Eight times as many may take 24 times as long: 8 is the straight line, 64 the square.
  const double few = seconds(20'000), many = seconds(160'000);
  EXPECT_LT(many, 24 * few + 0.1);
}

}  // namespace json_test
