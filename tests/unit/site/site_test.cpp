#include "report/site/site.h"

#include <gtest/gtest.h>

#include <cmath>

#include "measure/picture/picture.h"
#include "measure/scene/blob.h"
#include "measure/scratch_folder.h"
#include "report/site/page.h"
#include "report/site/pictures.h"
#include "report/site/source.h"
#include "unit/report/table_rows.h"

namespace site_test {

using namespace gnomon;
using namespace gnomon::site;
namespace fs = std::filesystem;
using table_rows::has;

class SiteTest : public testing::Test {
 protected:
  static Record row(const std::string& technique, const std::string& scene, double error, const std::string& suite = "small") {
    Record r = table_rows::row(technique, 1, error, scene);
    r.suite = suite;
    r.job += suite;
    r.lights.emplace_back().name = "point";
    r.times(Stage::relight) = {{1}, {2}, {3}, {2}, {1}};  // as many processes as resolve has
    return r;
  }

  fs::path folder(const std::string& name, const std::vector<Record>& records) const {
    const fs::path dir = scratch_.path() / name;
    std::string lines;
    for (const Record& record : records) lines += record_line(record);
    write_file(dir / "records.jsonl", lines);
    return dir;
  }

  fs::path submission(const std::string& name, const std::string& machine, const std::string& division = "default") const {
    const fs::path dir = folder(name, {row("a", "soup", 0.1), row("a", "bunny", 0.1)});
    write_file(dir / "submission.json", json_text({{"schema", "gnomon-submission-1"},
                                                   {"edition", {{"name", "2027"}, {"hash", "0123"}}},
                                                   {"division", division},
                                                   {"name", machine}}));
    return dir;
  }

  std::string error_of(const std::vector<fs::path>& dirs) const {
    try {
      read_sources(dirs);
    } catch (const Error& error) {
      return error.what();
    }
    return "";
  }

  const ScratchFolder scratch_ = ScratchFolder::temporary("gnomon_site");
};

TEST_F(SiteTest, machines_are_named_by_submissions_and_else_by_what_records_say) {
  const Sources sources = read_sources(std::vector{folder("run", {row("a", "soup", 0.1)}), submission("s", "my-machine")});
  ASSERT_EQ(sources.machines.size(), 2u);
  EXPECT_EQ(sources.machines[0].title, "an abacus, a renderer");
  EXPECT_EQ(sources.machines[1].title, "my-machine");
  EXPECT_EQ(sources.entries[1].suite, "edition 2027");
  EXPECT_EQ(sources.entries[1].division, "default");
}

TEST_F(SiteTest, suites_of_a_folder_are_entries_and_twins_are_told_apart) {
  const Sources sources = read_sources(std::vector{folder("one", {row("a", "soup", 0.1), row("a", "soup", 0.1, "other")}),
                                                   folder("two", {row("a", "soup", 0.2)})});
  ASSERT_EQ(sources.entries.size(), 3u);
  EXPECT_EQ(sources.machines.size(), 1u);
  EXPECT_TRUE(has(sources.entries[0].title, "folder one"));
  EXPECT_TRUE(has(sources.entries[1].title, "folder two"));
  EXPECT_EQ(sources.entries[2].suite, "other");
}

TEST_F(SiteTest, bad_folders_are_refused_in_words) {
  EXPECT_TRUE(has(error_of({scratch_.path() / "nowhere"}), "nowhere"));
  EXPECT_TRUE(has(error_of({folder("empty", {})}), "no records"));
  const fs::path dir = submission("s1", "m");
  EXPECT_TRUE(has(error_of({dir, dir / "."}), "one folder"));
  EXPECT_TRUE(has(error_of({dir, submission("s2", "m")}), "both submissions of 'm'"));
  EXPECT_EQ(error_of({dir, submission("s3", "m", "tuned")}), "");
  EXPECT_TRUE(has(error_of({submission("s4", "../m")}), "a-z"));
  EXPECT_TRUE(has(error_of({submission("s5", "m", "best")}), "division 'best'"));
  write_file(dir / "submission.json", std::string("[1"));
  EXPECT_TRUE(has(error_of({dir}), "no JSON object"));
  write_file(dir / "submission.json", std::string("{\"schema\":\"gnomon-submission-9\"}"));
  EXPECT_TRUE(has(error_of({dir}), "gnomon-submission-9"));
  write_file(dir / "records.jsonl", std::string("{\"schema\":999}\n"));
  EXPECT_TRUE(has(error_of({dir}), "schema"));
}

TEST_F(SiteTest, a_submission_that_is_a_link_is_refused) {
  const fs::path dir = folder("linked", {row("a", "soup", 0.1)});
  write_file(scratch_.path() / "elsewhere.json", std::string("{}"));
  fs::create_symlink(scratch_.path() / "elsewhere.json", dir / "submission.json");
  EXPECT_TRUE(has(error_of({dir}), "no regular file"));
}

TEST_F(SiteTest, pictures_come_from_the_folder_alone) {
  const fs::path dir = folder("run", {});
  write_file(dir / "masks/a.exr", std::string("x"));
  write_file(scratch_.path() / "secret", std::string("x"));
  fs::create_directory_symlink(scratch_.path(), dir / "out");
  EXPECT_TRUE(file_of(dir, "masks/a.exr"));
  for (const char* const name : {"../secret", "masks/../../secret", "out/secret", "masks", "", "none"})
    EXPECT_FALSE(file_of(dir, name)) << name;
  EXPECT_FALSE(file_of(dir, (scratch_.path() / "secret").string()));
  EXPECT_FALSE(file_of(dir, std::nullopt));
}

TEST(MadeSmall, is_the_mean_of_the_pixels_that_it_covers) {
  const Picture picture{.width = 4, .height = 2, .rgb = {0,  0,  0,  10, 10, 10, 255, 0, 0, 255, 0, 0,  //
                                                         20, 20, 20, 30, 30, 30, 255, 0, 0, 255, 0, 0}};
  const Picture small = made_small(picture, 2);
  EXPECT_EQ(small.width, 2);
  EXPECT_EQ(small.height, 1);
  EXPECT_EQ(small.rgb, (std::vector<std::uint8_t>{15, 15, 15, 255, 0, 0}));
  EXPECT_EQ(made_small(picture, 9).rgb, picture.rgb);
}

TEST_F(SiteTest, pages_of_a_hostile_run_hold_its_text_as_text) {
  const std::string evil = "<script>bad</script>";
  Record worst = row(evil, "soup\"><img src=x onerror=bad>", 0.2);
  worst.label = evil;
  worst.reason = evil;
  worst.view = evil;
  worst.context["processor"] = evil;
  Record failed = table_rows::refusal(evil, Status::failed, evil);
  failed.suite = evil;
  failed.lights.emplace_back().name = evil;
  const fs::path dir = folder("run", {row("a", "soup", 0.1), worst, failed});
  const fs::path out = scratch_.path() / "site";
  fs::create_directories(out);
  if (assets().site.empty()) GTEST_SKIP() << "built without scripts";
  make_site({.dirs = {dir}}, out);
  std::size_t pages = 0;
  for (const auto& entry : fs::recursive_directory_iterator(out)) {
    if (entry.path().extension() != ".html") continue;
    ++pages;
    const std::string html = small_file(entry.path(), 1 << 24);
    EXPECT_FALSE(has(html, "<script>bad")) << entry.path();
    EXPECT_FALSE(has(html, "<img src=x")) << entry.path();
  }
  EXPECT_GE(pages, 10u);
  EXPECT_TRUE(fs::exists(out / site_file));
}

TEST_F(SiteTest, two_machines_are_compared_to_the_last_bit) {
  std::vector<Record> first{row("a", "soup", 0.1), row("b", "soup", 0.2)}, second = first;
  for (Record& record : second) record.context["processor"] = "another";
  second[1].metrics[Truth::shape]["error"] = std::nextafter(0.2, 1.0);
  const fs::path out = scratch_.path() / "site";
  fs::create_directories(out);
  if (assets().site.empty()) GTEST_SKIP() << "built without scripts";
  make_site({.dirs = {folder("a", first), folder("b", second)}}, out);
  const std::string html = small_file(out / "differences/small.html", 1 << 20);
  EXPECT_TRUE(has(html, ">same<")) << html;
  EXPECT_TRUE(has(html, "differ: 1")) << html;
  EXPECT_TRUE(has(html, "1 of 2 rows have the same numbers"));
}

}  // namespace site_test
