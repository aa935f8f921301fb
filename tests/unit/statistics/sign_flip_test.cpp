#include "measure/statistics/sign_flip.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>

namespace sign_flip_test {

using namespace gnomon;

SignFlips flipped(const std::vector<double>& differences) { return flip_signs(differences); }

TEST(sign_flip, p_is_the_share_of_signs_that_lead_as_far) {
  // Of the eight sums of +-1 +-2 +-3 two are as far from 0 as 6.
  const SignFlips of_three = flipped({1, 2, 3});
  EXPECT_EQ(of_three.mean, 2);
  EXPECT_EQ(of_three.p, 0.25);
  EXPECT_FALSE(of_three.center);
  EXPECT_EQ(of_three.drawn, 0u);
  EXPECT_EQ(flipped({3, -1}).p, 1);  // 2, 4, -4, -2
  EXPECT_EQ(flipped({1, 0}).p, 1);   // a zero says nothing
  EXPECT_EQ(flipped({0, 0, 0, 0, 0, 0, 0}).p, 1);
  EXPECT_EQ(flipped({}).p, 1);
  // In floating point 0.1 + 0.2 + 0.3 depends on the order: both ends count all the same.
  EXPECT_EQ(flipped({0.1, 0.2, 0.3}).p, 0.25);
  EXPECT_EQ(flipped({0.3, 0.2, 0.1}).p, 0.25);
}

TEST(sign_flip, the_center_of_six_lies_between_the_least_and_the_greatest) {
  // 63 means of subsets make 64 intervals, each with a chance of 1/64: one may be left out at either end.
  const SignFlips of_six = flipped({1, 2, 3, 4, 5, 6});
  EXPECT_EQ(of_six.p, 2.0 / 64);
  ASSERT_TRUE(of_six.center);
  EXPECT_EQ(*of_six.center, (Estimate{3.5, 1, 6}));
  EXPECT_FALSE(flipped({1, 2, 3, 4, 5}).center);
}

RC_GTEST_PROP(sign_flip, zero_is_outside_the_interval_where_the_test_refuses_it, ()) {
  std::vector<double> differences;
  const int count = *rc::gen::inRange(6, 12);
  for (int k = 0; k < count; ++k) differences.push_back(*rc::gen::inRange(-4, 10));
  const SignFlips test = flip_signs(differences);
  RC_ASSERT(test.center.has_value());
  RC_ASSERT(test.center->low <= test.mean && test.mean <= test.center->high);
  RC_ASSERT((test.center->low > 0 || test.center->high < 0) == (test.p <= 0.05));
}

TEST(sign_flip, of_many_differences_flips_are_drawn) {
  // Sums of 20 signs as far as 14 - 6: twice P(14 or more of 20) = 2 * 60460 / 2^20.
  std::vector<double> differences(20, 1);
  std::fill_n(differences.begin(), 6, -1);
  const SignFlips test = flip_signs(differences);
  EXPECT_EQ(test.drawn, usual_flips);
  EXPECT_NEAR(test.p, 2 * 60460 / 0x1p20, 0.005);
  EXPECT_EQ(flip_signs(differences).p, test.p);
  EXPECT_EQ(flip_signs(std::vector<double>(40, 1), 999).p, 0.001);  // one more than those that were drawn
}

}  // namespace sign_flip_test
