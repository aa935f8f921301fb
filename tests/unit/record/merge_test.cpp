#include "measure/record/merge.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <fstream>
#include <numeric>
#include <sstream>

#include "error_words.h"
#include "measure/scratch_folder.h"

namespace merge_test {

using namespace gnomon;
using error_words::error_of;
namespace fs = std::filesystem;
using Runs = std::vector<std::pair<fs::path, std::vector<Record>>>;

Record row(std::uint64_t place) {
  Record r;
  r.job = fmt::format("{:016x}", 1000 - place);  // not in the order of places
  r.suite = "quick";
  r.scene = "soup";
  r.light = r.lights.emplace_back().name = "sun";
  r.technique = "shadow_map";
  r.settings = fmt::format("resolution={}", 64 + place);
  r.place = place;
  r.status = Status::ok;
  r.support = Support::Kind::full;
  r.classes = {{"T", 100 + place}};
  const double wrong = 1.0 / static_cast<double>(place + 3);
  r.metrics[Truth::shape] = {{"error", wrong}, {"wrong_rate", wrong}, {"displacement_mean", std::nullopt}};
  r.causes = {{"acne", place}};
  r.times(Stage::resolve) = {{0.25}, {0.5}};
  r.context = {{"commit", "abc"}, {"scene_hash", "s"}, {"processor", "an abacus"}, {"threads", 2}};
  return r;
}

std::vector<Record> rows(std::uint64_t count) {
  std::vector<Record> all;
  for (std::uint64_t k = 0; k < count; ++k) all.push_back(row(k));
  return all;
}

std::string lines(const Merge& merge) {
  std::string text;
  for (const MergedRow& r : merge.rows) text += record_line(r.record);
  return text;
}
std::string lines(const std::vector<Record>& records) {
  std::string text;
  for (const Record& r : records) text += record_line(r);
  return text;
}

/// A folder of its own for each test, gone afterwards.
class MergeFolderTest : public testing::Test {
 protected:
  void write(const fs::path& path, const std::string& text) const {
    fs::create_directories((dir / path).parent_path());
    std::ofstream(dir / path, std::ios::binary) << text;
  }
  std::string text(const fs::path& path) const {
    std::ostringstream all;
    all << std::ifstream(dir / path, std::ios::binary).rdbuf();
    return all.str();
  }
  const ScratchFolder scratch = ScratchFolder::temporary("gnomon_merge");
  const fs::path& dir = scratch.path();
};

RC_GTEST_PROP(merge, any_dealing_of_rows_to_folders_in_any_order_gives_the_whole_run_back, ()) {
  const std::vector<Record> whole = rows(*rc::gen::inRange<std::uint64_t>(0, 40));
  const auto folder_count = *rc::gen::inRange<std::size_t>(1, 5);
  Runs runs(folder_count);
  for (std::size_t k = 0; k < folder_count; ++k) runs[k].first = fmt::format("part{}", k);
  for (const Record& r : whole) {
    auto& records = runs[*rc::gen::inRange<std::size_t>(0, folder_count)].second;
    records.insert(records.begin() + *rc::gen::inRange<long>(0, static_cast<long>(records.size()) + 1), r);
  }
  const Merge merge = merge_records(runs);
  RC_ASSERT(lines(merge) == lines(whole));
  RC_ASSERT(merge.duplicate_count == 0u);
  RC_ASSERT(merge.conflicts.empty());
  RC_ASSERT(merge.notes.empty());
  for (const MergedRow& r : merge.rows) {
    const auto owner = std::find_if(runs.begin(), runs.end(), [&](const auto& run) { return run.first == r.folder; });
    RC_ASSERT(std::any_of(owner->second.begin(), owner->second.end(), [&](const Record& o) { return o.job == r.record.job; }));
  }
}

TEST(merge, rows_that_only_took_other_times_are_the_same_row_and_the_first_stays) {
  Record again = row(1);
  again.times(Stage::resolve) = {{7}};
  again.seconds = 9;
  again.peak_bytes = 1;
  again.context["load_average"] = 3;
  const Runs runs = {{"a", rows(3)}, {"b", {again}}};
  const Merge merge = merge_records(runs);
  EXPECT_EQ(merge.duplicate_count, 1u);
  EXPECT_TRUE(merge.conflicts.empty());
  EXPECT_EQ(lines(merge), lines(rows(3)));
  const Merge last = merge_records(runs, true);
  EXPECT_EQ(last.rows[1].record.seconds, 9);
  EXPECT_EQ(last.rows[1].folder, "b");
}

TEST(merge, every_row_that_differs_in_what_was_measured_is_a_conflict_that_says_in_what) {
  // One change a row: each must be found, with the field and both values, and nothing else.
  struct Change {
    const char* says;
    void (*make)(Record&);
  };
  const Change changes[] = {
      {"metrics.shape.wrong_rate: 0.3333333333333333, 0.33333333333333337",
       [](Record& r) { r.metrics[Truth::shape]["wrong_rate"] = std::nextafter(1.0 / 3, 1.0); }},
      {"metrics.shape.displacement_mean: null, 2.0", [](Record& r) { r.metrics[Truth::shape]["displacement_mean"] = 2; }},
      {"metrics.shape.ssim: nothing, 1.0", [](Record& r) { r.metrics[Truth::shape]["ssim"] = 1; }},
      {R"(status: "ok", "failed")", [](Record& r) { r.status = Status::failed; }},
      {R"(support: "full", "approximate")", [](Record& r) { r.support = Support::Kind::approximate; }},
      {R"(reason: "", "why")", [](Record& r) { r.reason = "why"; }},
      {"classes.T: 100, 101", [](Record& r) { r.classes["T"] = 101; }},
      {"causes.acne: 0, 5",
       [](Record& r) {
         r.causes = {{"acne", 5}};
       }},
      {"frames.wrong_rate.0: nothing, 0.5", [](Record& r) { r.frames["wrong_rate"] = {0.5}; }},
      {R"(context.scene_hash: "s", "t")", [](Record& r) { r.context["scene_hash"] = "t"; }},
      {R"(context.commit: "abc", "abd")", [](Record& r) { r.context["commit"] = "abd"; }},
      {"parameters.resolution: nothing, 64", [](Record& r) { r.parameters["resolution"] = 64; }},
  };
  for (const Change& change : changes) {
    Record other = row(0);
    change.make(other);
    const Merge merge = merge_records(Runs{{"a", {row(0)}}, {"b", rows(3)}, {"c", {other}}});
    EXPECT_EQ(merge.duplicate_count, 1u) << change.says;
    ASSERT_EQ(merge.conflicts.size(), 1u) << change.says;
    const MergeConflict& conflict = merge.conflicts[0];
    EXPECT_EQ(conflict.title, "soup sun shadow_map:resolution=64");
    EXPECT_EQ(conflict.first, "a");
    EXPECT_EQ(conflict.second, "c");
    EXPECT_NE(std::find(conflict.differences.begin(), conflict.differences.end(), change.says), conflict.differences.end())
        << change.says << " is not among " << fmt::format("{}", fmt::join(conflict.differences, "; "));
    EXPECT_LE(conflict.differences.size(), 2u) << change.says;  // a failed row has no reason to compare
    EXPECT_EQ(merge.rows.size(), 3u);
    EXPECT_TRUE(differences(merge.rows[0].record, row(0)).empty());
    const Merge last = merge_records(Runs{{"a", {row(0)}}, {"c", {other}}}, true);
    EXPECT_TRUE(differences(last.rows[0].record, other).empty());
  }
}

TEST(merge, failed_rows_are_the_same_whatever_process_they_name) {
  Record a = row(0), b = row(0);
  a.status = b.status = Status::failed;
  a.reason = "worker 12 crashed";
  b.reason = "worker 34 crashed";
  EXPECT_TRUE(differences(a, b).empty());
}

TEST(merge, suites_stand_one_after_the_other_and_rows_without_a_place_as_given) {
  std::vector<Record> other = rows(2);
  for (Record& r : other) r.suite = "full", r.job += "f";
  std::vector<Record> old = {row(5), row(2), row(7)};
  for (Record& r : old) r.place = 0, r.suite = "old";
  const Merge merge = merge_records(Runs{{"a", {row(1)}}, {"b", other}, {"c", old}, {"d", {row(0)}}});
  std::string order;
  for (const MergedRow& r : merge.rows) order += r.record.suite + " " + r.record.settings + "; ";
  EXPECT_EQ(order,
            "quick resolution=64; quick resolution=65; full resolution=64; full resolution=65; "
            "old resolution=69; old resolution=66; old resolution=71; ");
}

TEST(merge, mixed_machines_scenes_and_holes_are_said) {
  std::vector<Record> records = rows(4);
  records[1].context["processor"] = "a slide rule";
  records[2].context["threads"] = 1;
  records[3].context["scene_hash"] = "other";
  const auto notes = [](std::vector<Record> list) {
    return fmt::format("{}", fmt::join(merge_records(Runs{{"a", std::move(list)}}).notes, "\n"));
  };
  const std::string mixed = notes(records);
  EXPECT_NE(mixed.find("different processors: a slide rule (1 row), an abacus (3 rows); their times are not comparable"),
            std::string::npos)
      << mixed;
  EXPECT_NE(mixed.find("different numbers of threads: 1 (1 row), 2 (3 rows)"), std::string::npos) << mixed;
  EXPECT_NE(mixed.find("scene soup has 2 contents"), std::string::npos) << mixed;
  Record soft = row(1);  // under another light the same scene has another hash
  soft.light = "lamp";
  soft.context["scene_hash"] = "other";
  EXPECT_EQ(notes({row(0), soft}), "");
  EXPECT_EQ(notes({row(0), row(1), row(4)}),
            "2 of the first 5 rows of suite quick are not there: a shard is missing or unfinished, or the run was filtered");
  Record absent = row(1);
  absent.context.erase("scene_hash");
  EXPECT_EQ(notes({row(0), absent}), "scene soup was there for some rows and not for a: fetch it there and --resume that run");
  EXPECT_EQ(notes(rows(5)), "");
}

TEST_F(MergeFolderTest, pictures_are_copied_byte_by_byte_and_the_folder_appears_whole) {
  Record a = row(0), b = row(1);
  a.mask = "masks/a.exr";
  b.mask = "masks/b.exr";
  b.error_picture = "errors/b.png";
  const std::string bytes("\0\xff\r\n\x1a picture", 12);
  write("x/masks/a.exr", bytes);
  write("y/masks/b.exr", "other");
  const Merge merge = merge_records(Runs{{dir / "x", {a}}, {dir / "y", {b}}});
  const fs::path out = dir / "deep/er/out/";  // parents are made; a slash at the end is nothing
  const std::size_t missing = write_merge(merge, out, [&](const fs::path& folder) {
    EXPECT_FALSE(fs::exists(out));  // nobody sees it before it is whole
    std::ofstream(folder / "table.md") << "table";
  });
  EXPECT_EQ(missing, 1u);  // errors/b.png
  EXPECT_EQ(text("deep/er/out/masks/a.exr"), bytes);
  EXPECT_EQ(text("deep/er/out/masks/b.exr"), "other");
  EXPECT_EQ(text("deep/er/out/table.md"), "table");
  EXPECT_EQ(lines(read_records(out)), lines({a, b}));
  EXPECT_EQ(std::distance(fs::directory_iterator(dir / "deep/er"), {}), 1);
}

TEST_F(MergeFolderTest, references_of_frames_that_rows_share_are_copied_once) {
  Record a = row(0), b = row(1);
  a.kept_frames = {.numbers = {0, 2}, .mask = "frames/a", .reference = "frames/reference-0"};
  b.kept_frames = {.numbers = {0, 2}, .mask = "frames/b", .reference = "frames/reference-0"};
  for (const char* name : {"x/frames/a/0000.png", "x/frames/a/0002.png", "y/frames/b/0000.png", "y/frames/b/0002.png",
                           "x/frames/reference-0/0000.png", "y/frames/reference-0/0000.png", "y/frames/reference-0/0002.png"})
    write(name, fs::path(name).filename().string());
  const Merge merge = merge_records(Runs{{dir / "x", {a}}, {dir / "y", {b}}});
  // One of a's is not there, and b's has the same name.
  EXPECT_EQ(write_merge(merge, dir / "out", [](const fs::path&) {}), 1u);
  for (const Record& r : {a, b})
    for (const std::vector<std::string>& names : {pictures(r), shared_pictures(r)})
      for (const std::string& name : names) EXPECT_EQ(text("out/" + name), fs::path(name).filename().string()) << name;
  b.mask = "frames/reference-0/0002.png";
  const auto merged = [&] {
    write_merge(merge_records(Runs{{dir / "x", {a}}, {dir / "y", {b}}}), dir / "no", [](const fs::path&) {});
  };
  EXPECT_NE(error_of(merged).find("picture frames/reference-0/0002.png is named by two rows"), std::string::npos)
      << error_of(merged);
  b.mask.reset();
  b.kept_frames->reference = "../y/frames/reference-0";
  EXPECT_NE(error_of(merged).find("picture ../y/frames/reference-0/0000.png is not a path below the run's folder"),
            std::string::npos)
      << error_of(merged);
  EXPECT_FALSE(fs::exists(dir / "no"));
}

TEST_F(MergeFolderTest, what_goes_wrong_leaves_nothing_behind) {
  Record a = row(0), twin = row(1), thief = row(2);
  a.mask = twin.mask = "masks/a.exr";
  thief.mask = "../secret";
  write("x/masks/a.exr", "a");
  write("secret", "s");
  const auto write_out = [&](const std::vector<Record>& records) {
    return error_of([&] { write_merge(merge_records(Runs{{dir / "x", records}}), dir / "out", [](const fs::path&) {}); });
  };
  EXPECT_NE(write_out({a, twin}).find("picture masks/a.exr is named by two rows"), std::string::npos);
  EXPECT_NE(write_out({a, thief}).find("picture ../secret is not a path below the run's folder"), std::string::npos);
  thief.mask = "/etc/passwd";
  EXPECT_NE(write_out({thief}).find("/etc/passwd is not a path below"), std::string::npos);
  const Merge merge = merge_records(Runs{{dir / "x", {a}}});
  EXPECT_EQ(error_of([&] { write_merge(merge, dir / "out", [](const fs::path&) { throw Error("no table"); }); }), "no table");
  EXPECT_FALSE(fs::exists(dir / "out"));
  EXPECT_EQ(std::distance(fs::directory_iterator(dir), {}), 2);  // x and secret
}

TEST_F(MergeFolderTest, a_folder_that_holds_something_is_refused) {
  write("run/records.jsonl", "");
  write("stuff/file", "");
  write("file", "");
  fs::create_directory(dir / "empty");
  EXPECT_NE(error_of([&] { require_free(dir / "run"); }).find("holds records already"), std::string::npos);
  EXPECT_NE(error_of([&] { require_free(dir / "stuff"); }).find("is not empty"), std::string::npos);
  EXPECT_NE(error_of([&] { require_free(dir / "file"); }).find("is a file"), std::string::npos);
  EXPECT_EQ(error_of([&] { require_free(dir / "new"); }), "");
  write_merge({}, dir / "empty", [](const fs::path&) {});  // an empty merge is a run without rows
  EXPECT_TRUE(read_records(dir / "empty").empty());
}

}  // namespace merge_test
