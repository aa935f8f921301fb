// Files of earlier versions: kept as they were written, read for ever.
#include <gtest/gtest.h>

#include <fstream>

#include "measure/record/record.h"
#include "places.h"

namespace record_schema_test {

using namespace gnomon;

std::vector<Record> kept(int schema) {
  return read_record_file(data_file(fmt::format("records/schema_{}.jsonl", schema))).records;
}

TEST(record, schema_1_is_read) {
  const std::vector<Record> r = kept(1);
  ASSERT_EQ(r.size(), 4u);
  EXPECT_EQ(r[0].status, Status::ok);
  EXPECT_EQ(r[0].support, Support::Kind::full);
  EXPECT_EQ(r[0].label, "shadow_map 256");
  EXPECT_EQ(r[0].parameters.at("resolution"), 256);
  EXPECT_EQ(r[0].times(Stage::resolve).size(), 5u);
  EXPECT_EQ(r[0].times(Stage::resolve)[3], (std::vector{2.831549, 2.774424, 2.890426}));
  EXPECT_EQ(r[0].metric("wrong_rate"), 0.006676107626947198);
  EXPECT_EQ(r[0].metric(Truth::mesh, "wrong_rate"), 0.006676107626947198);
  EXPECT_EQ(r[0].classes.at("T"), 197720u);
  EXPECT_EQ(r[0].gl->upload_ms, 6.4626);
  EXPECT_EQ(r[0].peak_bytes, 129851392u);
  EXPECT_EQ(r[0].context.at("commit"), "88830df456");
  EXPECT_EQ(r[1].support, Support::Kind::approximate);
  EXPECT_EQ(r[1].reason, "7.41 % of the receiving area lies on no receiver plane; pixels there are not covered");
  EXPECT_EQ(r[2].status, Status::unsupported);
  EXPECT_EQ(r[2].scene_facts->boundary_edges, 3000u);
  EXPECT_TRUE(r[2].metrics.empty());
  EXPECT_EQ(r[3].status, Status::failed);
  EXPECT_EQ(r[3].support, std::nullopt);
  EXPECT_EQ(r[3].reason, "hung in build: no answer within 60 s");
  EXPECT_EQ(r[3].unknown.at("mood"), "gloomy");
  // What came with schema 2 is missing, and does not look measured.
  for (const Record& record : r) {
    EXPECT_TRUE(record.path.empty() && record.stop.empty() && record.iterations.empty() && record.frames.empty());
    EXPECT_EQ(record.causes, std::nullopt);
    EXPECT_EQ(record.place, 0u);
  }
}

TEST(record, schema_2_is_read) {
  const std::vector<Record> r = kept(2);
  ASSERT_EQ(r.size(), 2u);
  EXPECT_EQ(r[0].path, "light_slide");
  EXPECT_EQ(r[0].frames.at("wrong_rate").size(), 16u);
  EXPECT_EQ(r[0].frames.at("wrong_rate")[3], 0.0005219206680584551);
  EXPECT_EQ(r[0].frames.at("instability")[0], std::nullopt);  // nothing comes before the first frame
  EXPECT_EQ(r[0].frames.at("instability")[1], 0);
  EXPECT_EQ(r[0].metric(Truth::shape, "wrong_rate"), 0.0006197807933194155);
  EXPECT_EQ(r[0].metric(Truth::mesh, "wrong_rate"), 0.0005065103388796977);
  EXPECT_EQ(r[0].causes->at("edge_resolution"), 28u);
  EXPECT_EQ(r[0].causes->at("unexplained"), 0u);
  EXPECT_EQ(r[0].iterations.at("build"), 50u);
  EXPECT_EQ(r[0].stop, "fixed");
  EXPECT_EQ(r[0].times(Stage::relight)[1], (std::vector{2.109483, 1.816646}));
  EXPECT_EQ(r[1].path, "");
  EXPECT_EQ(r[1].place, 3u);
  EXPECT_EQ(r[1].light_kind, "directional");
  EXPECT_EQ(r[1].classes.at("T"), 3790u);
  EXPECT_EQ(r[1].causes->at("tessellation"), 1u);
  EXPECT_EQ(r[1].metric("wrong_rate"), 11.0 / 3790);  // the causes' pixels over the tested ones
  EXPECT_TRUE(r[1].frames.empty());
  for (const Record& record : r) EXPECT_TRUE(record.unknown.empty());
}

TEST(record, files_of_every_schema_lose_nothing_when_they_are_written_again) {
  for (const int schema : {1, 2}) {
    std::ifstream file(data_file(fmt::format("records/schema_{}.jsonl", schema)));
    int count = 0;
    for (std::string line; std::getline(file, line); ++count) {
      const Json before = Json::parse(line);
      const Json after = Json::parse(record_line(before.get<Record>()));
      EXPECT_EQ(after.at("schema"), record_schema);
      for (const auto& [key, value] : before.items())
        if (key != "schema") {
          EXPECT_EQ(after.at(key), value) << schema << " " << key;
        }
    }
    EXPECT_GT(count, 0);
  }
}

}  // namespace record_schema_test
