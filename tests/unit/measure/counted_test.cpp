#include "measure/counted.h"

#include <gtest/gtest.h>

namespace counted_test {
using namespace gnomon;

TEST(Counted, a_noun_has_no_s_of_one_alone) {
  EXPECT_EQ(counted(0, "row{s}"), "0 rows");
  EXPECT_EQ(counted(1, "row{s}"), "1 row");
  EXPECT_EQ(counted(2, "row{s}"), "2 rows");
}

TEST(Counted, words_of_one_and_of_many_stand_side_by_side) {
  constexpr std::string_view words = "vert{ex|ices} of {one|several} mesh{es} {lies|lie} there";
  EXPECT_EQ(counted(1, words), "1 vertex of one mesh lies there");
  EXPECT_EQ(counted(11, words), "11 vertices of several meshes lie there");
}

TEST(Counted, words_without_a_choice_stay) {
  EXPECT_EQ(counted(1, "in all"), "1 in all");
  EXPECT_EQ(counted(3, ""), "3 ");
}

}  // namespace counted_test
