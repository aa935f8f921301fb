#include "measure/record/record_members.h"

#include <gtest/gtest.h>

#include "measure/json.h"

namespace record_members_test {
using namespace gnomon;

constexpr std::string_view heavy[] = {"metrics", "causes"};
std::string without(std::string_view line) { return without_members(line, heavy); }

TEST(record_members, those_members_are_left_out_and_the_others_are_as_they_were) {
  EXPECT_EQ(without(R"({"job":"a","metrics":{"x":[1,{"y":"}"}]},"seconds":1.5})"), R"({"job":"a","seconds":1.5})");
  EXPECT_EQ(without(R"({"metrics":[],"job":"\"},{\\","causes":null})"), R"({"job":"\"},{\\"})");
  EXPECT_EQ(without(R"({"causes":0})"), "{}");
  EXPECT_EQ(without(R"({"lights":[{"metrics":1}],"notes":"causes"})"), R"({"lights":[{"metrics":1}],"notes":"causes"})")
      << "of the record itself alone";
}

// Whatever the members are, a parser finds the same in what is left.
TEST(record_members, what_is_left_is_what_a_parser_would_leave) {
  const std::string line =
      R"({"job":"a b","causes":{"edge":1},"empty":{},"deep":[[[{"k":"v,\"]"}]]],"metrics":"{","number":-1.5e-3,"last":[true,null]})";
  Json expected = parse_json(line);
  for (const std::string_view key : heavy) expected.erase(std::string(key));
  EXPECT_EQ(parse_json(without(line)), expected);
}

TEST(record_members, what_is_no_object_is_as_it_was) {
  for (const std::string_view line :
       {"", "{", "{}", "[1]", "text", R"({"metrics")", R"({"metrics":)", R"({"metrics":[1})", R"({"metrics":1])",
        R"({"metrics":"1)", R"({"metrics":1,)", R"({"metrics":1,causes:2})", R"({ "metrics":1})"})
    EXPECT_EQ(without(line), line);
}

}  // namespace record_members_test
