#include <gtest/gtest.h>
#include <sys/resource.h>

#include <csignal>
#include <fstream>
#include <sstream>

#include "measure/record/record.h"
#include "measure/scratch_folder.h"
#include "record/record_example.h"

namespace record_file_test {

using namespace gnomon;
using record_example::example;
namespace fs = std::filesystem;

/// A folder of its own for each test, gone afterwards.
class RecordFileTest : public testing::Test {
 protected:
  void write(const std::string& text) const { std::ofstream(records_file(dir), std::ios::binary) << text; }
  std::string text() const {
    std::ostringstream all;
    all << std::ifstream(records_file(dir), std::ios::binary).rdbuf();
    return all.str();
  }

  const ScratchFolder scratch = ScratchFolder::temporary("gnomon_record");
  const fs::path& dir = scratch.path();
};

TEST_F(RecordFileTest, a_newer_schema_is_refused_with_file_and_line) {
  Json newer = example();
  newer["schema"] = record_schema + 1;
  write(record_line(example("1")) + newer.dump() + "\n");
  try {
    read_records(dir);
    FAIL() << "no error";
  } catch (const Error& error) {
    const std::string said = fmt::format("records.jsonl:2: schema = {} is that of a newer program", record_schema + 1);
    EXPECT_NE(std::string(error.what()).find(said), std::string::npos) << error.what();
  }
}

TEST_F(RecordFileTest, what_was_appended_is_read_in_order) {
  RecordWriter writer(dir);
  for (const char* job : {"1", "2", "3"}) writer.append(example(job));
  writer.close();
  const std::vector<Record> records = read_records(dir);
  ASSERT_EQ(records.size(), 3u);
  EXPECT_EQ(records[0].job + records[1].job + records[2].job, "123");
}

TEST_F(RecordFileTest, job_that_ran_again_counts_once_by_its_last_line) {
  Record first = example("1"), again = example("1");
  first.status = Status::failed;
  write(record_line(first) + record_line(example("2")) + record_line(again));
  const std::vector<Record> records = read_records(dir);
  ASSERT_EQ(records.size(), 2u);
  EXPECT_EQ(records[0].job, "1");
  EXPECT_EQ(records[0].status, Status::ok);
}

TEST_F(RecordFileTest, unfinished_last_line_is_left_out_with_a_note_wherever_it_was_cut) {
  const std::string whole = record_line(example("1")), cut = record_line(example("2"));
  for (const std::size_t length : {std::size_t{1}, cut.size() / 2, cut.size() - 2}) {
    write(whole + cut.substr(0, length));
    const RecordFile file = read_record_file(records_file(dir));
    EXPECT_EQ(file.records.size(), 1u);
    ASSERT_EQ(file.notes.size(), 1u);
    EXPECT_NE(file.notes[0].find("records.jsonl:2: the last line is unfinished"), std::string::npos);
  }
  write(whole + cut.substr(0, cut.size() - 1));  // only the newline is missing
  EXPECT_EQ(read_record_file(records_file(dir)).records.size(), 2u);
}

TEST_F(RecordFileTest, torn_line_in_the_middle_is_an_error_with_file_and_line) {
  const std::string line = record_line(example());
  write(line + line.substr(0, 40) + "\n" + line);
  try {
    read_records(dir);
    FAIL() << "no error";
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("records.jsonl:2: not a record"), std::string::npos) << error.what();
  }
}

TEST_F(RecordFileTest, folder_without_records_is_an_error_and_an_empty_file_is_not) {
  EXPECT_THROW(read_records(dir), Error);
  write("");
  EXPECT_TRUE(read_records(dir).empty());
}

TEST_F(RecordFileTest, writer_mends_the_line_of_a_killed_run_before_it_appends) {
  const std::string whole = record_line(example("1")), cut = record_line(example("2")), next = record_line(example("3"));
  write(whole + cut.substr(0, cut.size() / 2));
  RecordWriter(dir).append(example("3"));
  EXPECT_EQ(text(), whole + next);
  write(whole + cut.substr(0, cut.size() - 1));
  RecordWriter(dir).append(example("3"));
  EXPECT_EQ(text(), whole + cut + next);
}

TEST_F(RecordFileTest, unfinished_line_longer_than_a_block_is_found_whole) {
  Record large = example("2");
  large.reason = std::string(20000, 'x');
  const std::string whole = record_line(example("1")), cut = record_line(large);
  write(whole + cut.substr(0, 15000));
  RecordWriter{dir};
  EXPECT_EQ(text(), whole);
}

TEST_F(RecordFileTest, second_writer_on_the_same_folder_is_refused) {
  RecordWriter first(dir);
  EXPECT_THROW(RecordWriter{dir}, Error);
  first.close();
  EXPECT_NO_THROW(RecordWriter{dir});
}

TEST_F(RecordFileTest, replaced_records_are_there_at_once_and_stay_the_writers) {
  RecordWriter writer(dir);
  for (const char* job : {"1", "2", "3"}) writer.append(example(job));
  writer.replace(std::vector{example("2")});
  EXPECT_EQ(text(), record_line(example("2")));
  EXPECT_THROW(RecordWriter{dir}, Error) << "the new file is locked like the old one";
  writer.append(example("4"));
  EXPECT_EQ(text(), record_line(example("2")) + record_line(example("4")));
  writer.close();
  EXPECT_NO_THROW(RecordWriter{dir});
  EXPECT_EQ(std::distance(fs::directory_iterator(dir), fs::directory_iterator()), 1) << "nothing else is left in the folder";
}

TEST_F(RecordFileTest, device_in_place_of_the_file_is_refused) {
  fs::create_symlink("/dev/full", records_file(dir));
  try {
    const RecordWriter writer(dir);
    FAIL() << "no error";
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("it is there and no regular file"), std::string::npos) << error.what();
  }
  EXPECT_TRUE(fs::is_symlink(records_file(dir)));
}

TEST_F(RecordFileTest, write_that_fits_only_in_part_is_taken_back) {
  RecordWriter writer(dir);
  writer.append(example("1"));
  const std::string before = text();
  rlimit old{};
  ASSERT_EQ(getrlimit(RLIMIT_FSIZE, &old), 0);
  const auto old_handler = std::signal(SIGXFSZ, SIG_IGN);
  const rlimit tight{before.size() + 50, old.rlim_max};  // the next line is longer than 50 bytes
  ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &tight), 0);
  try {
    writer.append(example("2"));
    ADD_FAILURE() << "no error";
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("the record of shadow_map 2 could not be written: only 50 of "), std::string::npos)
        << error.what();
  }
  setrlimit(RLIMIT_FSIZE, &old);
  std::signal(SIGXFSZ, old_handler);
  EXPECT_EQ(text(), before);
  EXPECT_NO_THROW(writer.append(example("2")));
  EXPECT_EQ(read_records(dir).size(), 2u);
}

}  // namespace record_file_test
