#include <gtest/gtest.h>

#include "analysis/motion.h"
#include "analysis_rows.h"
#include "report/analysis/analysis_table.h"

namespace path_errors_test {

using namespace analysis_rows;

TEST(path_errors, ranges_are_over_the_frames_where_the_metric_is_defined) {
  Record r = row("a", 1, 1, 0.2);
  r.path = "camera_slide";
  r.frames = {{"instability", {std::nullopt, 0.1, 0.3}}, {"error", {0.2, 0.1, 0.3}}};
  const std::vector<PathErrors> motions = find_motion(std::vector{r, row("still", 1, 1, 0.1)});
  ASSERT_EQ(motions.size(), 1u);
  EXPECT_EQ(motions[0].frames, 3u);
  EXPECT_DOUBLE_EQ(motions[0].instability->mean, 0.2);
  EXPECT_EQ(motions[0].instability->greatest, 0.3);
  EXPECT_EQ(motions[0].instability->worst, 2u);
  EXPECT_DOUBLE_EQ(motions[0].error->mean, 0.2);
  EXPECT_EQ(motions[0].error->least, 0.1);
  EXPECT_THROW(find_motion(std::vector{row("still", 1, 1, 0.1)}), Error);
  EXPECT_THROW(find_motion(std::vector{r}, "wrong_rat"), Error);
}

TEST(path_errors, errors_over_time_are_those_of_the_record) {
  Record of_light = row("a", 1, 1, 0.2), of_camera = of_light;
  of_light.path = "light_slide";
  of_camera.path = "camera_slide";
  for (Record* r : {&of_light, &of_camera}) r->frames = {{"error", {0.2, 0.1}}};
  of_light.metrics[Truth::shape]["flicker_1_15"] = 0.25;
  of_light.metrics[Truth::shape]["false_flips"] = 3;
  of_camera.metrics[Truth::shape]["flicker_1_15"] = std::nullopt;
  const std::vector<Record> records{of_light, of_camera};
  const std::vector<PathErrors> motions = find_motion(records);
  const std::vector<std::string> names = names_over_time();
  ASSERT_EQ(motions[0].over_time.size(), names.size());
  for (std::size_t k = 0; k < names.size(); ++k) EXPECT_EQ(motions[0].over_time[k], of_light.metric(names[k])) << names[k];
  EXPECT_TRUE(motions[0].has_over_time());
  EXPECT_FALSE(motions[1].has_over_time());

  // People get a table of their own, of the rows that have them; programs get columns of the one table.
  const std::string text = analyze(records, "motion", {}, Format::terminal);
  EXPECT_NE(text.find("Along paths: errors over time"), text.npos) << text;
  EXPECT_NE(text.find("25.0"), text.npos) << text;
  const std::string csv = analyze(records, "motion", {}, Format::csv);
  EXPECT_NE(csv.find("error_frame,flicker_1_60,flicker_1_15,flicker_1_4,temporal_sd,false_flips,late_flips,steady_share"),
            csv.npos)
      << csv;
  const std::vector<Record> still{of_camera};
  EXPECT_EQ(analyze(still, "motion", {}, Format::terminal).find("over time"), std::string::npos);
  EXPECT_EQ(analyze(still, "motion", {}, Format::csv).find("flicker"), std::string::npos);
}

}  // namespace path_errors_test
