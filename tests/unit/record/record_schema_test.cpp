// A file of today's schema, kept as it was written, and those of the schemas before.
#include <gtest/gtest.h>

#include <fstream>

#include "measure/record/record.h"
#include "places.h"

namespace record_schema_test {

using namespace gnomon;

std::vector<Record> kept(int schema) {
  return read_record_file(data_file(fmt::format("records/schema_{}.jsonl", schema))).records;
}

TEST(record, another_schema_is_refused_with_what_to_do) {
  for (const int schema : {2, 3, 4, 5, 6}) {
    try {
      kept(schema);
      FAIL() << "no error";
    } catch (const Error& error) {
      const std::string text = error.what(), said = fmt::format("schema_{0}.jsonl:1: schema = {0} is that of an older", schema);
      EXPECT_NE(text.find(said), std::string::npos) << text;
      EXPECT_NE(text.find("scripts/convert_records"), std::string::npos) << text;
    }
  }
}

TEST(record, schema_7_is_read) {
  const std::vector<Record> r = kept(7);
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
  EXPECT_EQ(r[1].answer, AnswerKind::binary);
  ASSERT_EQ(r[1].lights.size(), 1u);
  EXPECT_EQ(r[1].lights[0].name, "sun");
  EXPECT_EQ(r[1].lights[0].metrics, r[1].metrics.at(Truth::shape));
  EXPECT_EQ(r[1].lights[0].causes, r[1].causes);
  for (const Record& record : r) EXPECT_TRUE(record.unknown.empty());
}

TEST(record, a_kept_file_loses_nothing_when_it_is_written_again) {
  std::ifstream file(data_file("records/schema_7.jsonl"));
  int count = 0;
  for (std::string line; std::getline(file, line); ++count) {
    const Json before = Json::parse(line);
    const Json after = Json::parse(record_line(before.get<Record>()));
    for (const auto& [key, value] : before.items()) EXPECT_EQ(after.at(key), value) << key;
  }
  EXPECT_EQ(count, 2);
}

}  // namespace record_schema_test
