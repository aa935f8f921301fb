#include <gtest/gtest.h>

#include "measure/record/record.h"
#include "measure/scene/blob.h"
#include "measure/scratch_folder.h"

namespace withdraw_test {

using namespace gnomon;

Record measured(const std::string& light_kind, Json frames) {
  Record record;
  record.job = light_kind + frames.dump();
  record.scene = "fence";
  record.technique = "unshadowed";
  record.light_kind = light_kind;
  record.status = Status::ok;
  record.support = Support::Kind::full;
  record.metrics[Truth::shape]["wrong_rate"] = 0.25;
  record.classes["T"] = 7;
  record.causes.emplace();
  record.mask = "masks/a.exr";
  if (!frames.is_null()) record.context["frames"] = frames;
  return record;
}

// Old runs scored lights with area against the hard shadow of their center: what is read back has no number of it.
TEST(withdraw, reading_drops_scores_against_the_center_of_a_light_with_area) {
  const ScratchFolder folder = ScratchFolder::temporary("gnomon_withdraw");
  std::string lines;
  for (const char* kind : {"rect", "disc", "sphere"})
    for (const Json& frames : {Json(), Json(5)}) lines += record_line(measured(kind, frames));
  const std::size_t withdrawn = 6;
  for (const char* kind : {"point", "directional", "spot", ""}) lines += record_line(measured(kind, Json(5)));
  lines += record_line(measured("rect", Json(6)));  // of a program whose reference knows them
  write_file(records_file(folder.path()), lines);
  const std::vector<Record> records = read_record_file(records_file(folder.path())).records;
  ASSERT_EQ(records.size(), withdrawn + 5);
  for (std::size_t k = 0; k < records.size(); ++k) {
    const Record& record = records[k];
    EXPECT_EQ(record.status == Status::unsupported, k < withdrawn) << k;
    EXPECT_EQ(record.metric("wrong_rate").has_value(), k >= withdrawn) << k;
    if (k >= withdrawn) continue;
    EXPECT_NE(record.reason.find("the light has an area"), std::string::npos) << record.reason;
    EXPECT_TRUE(record.classes.empty() && !record.causes && !record.mask);
  }
}

TEST(withdraw, leaves_what_was_asked) {
  Record record = measured("point", Json(5));
  withdraw(record, "no answer");
  EXPECT_EQ(record.status, Status::unsupported);
  EXPECT_EQ(record.support, Support::Kind::unsupported);
  EXPECT_EQ(record.reason, "no answer");
  EXPECT_EQ(record.scene, "fence");
  EXPECT_EQ(record.context["frames"], 5);
  EXPECT_TRUE(record.metrics.empty());
}

TEST(withdraw, records_of_before_the_metric_error_are_read_with_it) {
  const ScratchFolder folder = ScratchFolder::temporary("gnomon_error");
  Record old = measured("point", Json(5)), mesh = measured("sun", Json(5)), today = measured("spot", Json(8));
  Record soft = measured("disc", Json(8));
  old.metrics[Truth::mesh]["wrong_rate"] = std::nullopt;
  old.frames = {{"wrong_rate", {0.5, std::nullopt}}, {"instability", {std::nullopt, 0.1}}};
  mesh.metrics = {{Truth::mesh, {{"flip", 0.1}}}};
  today.metrics[Truth::shape]["error"] = 0.5;
  write_file(records_file(folder.path()), record_line(old) + record_line(mesh) + record_line(today) + record_line(soft));
  const std::vector<Record> records = read_record_file(records_file(folder.path())).records;
  ASSERT_EQ(records.size(), 4u);
  EXPECT_EQ(records[0].metric("error"), 0.25);
  EXPECT_TRUE(records[0].metrics.at(Truth::mesh).contains("error"));
  EXPECT_EQ(records[0].metric(Truth::mesh, "error"), std::nullopt) << "no pixel was tested";
  EXPECT_EQ(records[0].frames.at("error"), old.frames.at("wrong_rate"));
  EXPECT_FALSE(records[1].metrics.at(Truth::mesh).contains("error")) << "there is no wrong rate either";
  EXPECT_EQ(records[2].metric("error"), 0.5) << "what is there stays";
  EXPECT_EQ(records[3].metric("error"), std::nullopt) << "under a light with area it is no wrong rate";
}

}  // namespace withdraw_test
