#include "analysis/seams.h"

#include <gtest/gtest.h>

#include "analysis_rows.h"
#include "measure/score/metrics.h"

namespace seams_test {

using namespace analysis_rows;

/// With these errors and shares of the bins.
Record with_seams(std::vector<std::optional<double>> errors, std::vector<std::optional<double>> shares) {
  Record r = row("cascaded_map", 1, 1, 0.1);
  Metrics& metrics = r.metrics[Truth::shape];
  std::size_t k = 0;
  for (const std::string& bin : seam_bin_names()) {
    metrics[fmt::format("{}{}", seam_error_prefix, bin)] = errors[k];
    metrics[fmt::format("{}{}", seam_share_prefix, bin)] = shares[k++];
  }
  return r;
}

TEST(seams, bins_are_those_of_the_metrics_from_near_to_far) {
  EXPECT_EQ(seam_bin_names(), (std::vector<std::string>{"0_1", "1_2", "2_4", "4_8", "8_16", "16_32", "32_64", "64_up"}));
}

// Up to 8 px lie 1/16 + 1/16 + 1/8 + 1/4 = 1/2 of the pixels, and their parts of the error are 0.4 / 16 + 0.4 / 16 + 0.2 / 8 +
// 0.1 / 4 = 0.1; the rest makes 0.1 * 1/2 = 0.05: two thirds lie near.
TEST(seams, near_pixels_have_their_share_and_their_part_of_the_error) {
  const Record r =
      with_seams({0.4, 0.4, 0.2, 0.1, 0.1, 0.1, std::nullopt, 0.1}, {0.0625, 0.0625, 0.125, 0.25, 0.25, 0.125, 0, 0.125});
  const std::vector<SeamErrors> rows = find_seams(std::vector{row("embree_rays", 1, 1, 0), r});
  ASSERT_EQ(rows.size(), 1u) << "rays have no seams";
  EXPECT_DOUBLE_EQ(rows[0].near_share.value(), 0.5);
  EXPECT_DOUBLE_EQ(rows[0].near_part.value(), 0.1 / 0.15);
  EXPECT_EQ(rows[0].errors[6], std::nullopt);
}

TEST(seams, a_row_without_an_error_has_no_part_of_it) {
  const std::vector<std::optional<double>> none(8, 0.0), even(8, 0.125);
  EXPECT_EQ(find_seams(std::vector{with_seams(none, even)})[0].near_part, std::nullopt);
  std::vector<std::optional<double>> gap(8, 0.1);
  gap[7] = std::nullopt;
  EXPECT_EQ(find_seams(std::vector{with_seams(gap, even)})[0].near_part, std::nullopt) << "some frame leaves the bin empty";
}

TEST(seams, records_without_seams_are_refused_with_what_has_them) {
  try {
    find_seams(std::vector{row("embree_rays", 1, 1, 0)});
    FAIL();
  } catch (const Error& problem) {
    EXPECT_NE(std::string(problem.what()).find("cascaded_map"), std::string::npos) << problem.what();
  }
}

}  // namespace seams_test
