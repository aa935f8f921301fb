// Pictures of frames in the page of a run.
#include "measure/picture/picture.h"
#include "measure/scratch_folder.h"
#include "report/html/html_parts.h"
#include "table_rows.h"

namespace html_frames_test {

using namespace table_rows;
using Bytes = std::vector<std::uint8_t>;

class HtmlFramesTest : public testing::Test {
 protected:
  static Record moving(const std::string& technique) {
    Record r = row(technique, 2, 0.1);
    r.path = "slide";
    r.width = 2;
    r.height = 1;
    r.mask = "masks/" + technique + ".exr";
    r.kept_frames = {.numbers = {0, 7}, .mask = "frames/" + technique, .reference = "frames/reference-0"};
    return r;
  }

  void write(const std::string& folder, int frame, const Bytes& bytes, bool has_alpha = false) const {
    write_gray_png(folder_.path() / frame_picture(folder, frame), 2, 1, bytes, has_alpha);
  }

  Json collect(const std::vector<Record>& records, bool with_pictures = true) {
    set_ = {};
    return collect_frames(folder_.path(), lay_out(records, column_names(records)), with_pictures, false, set_);
  }

  const ScratchFolder folder_ = ScratchFolder::temporary("gnomon_html_frames");
  PictureSet set_;
};

TEST_F(HtmlFramesTest, frames_are_differences_and_a_reference_that_rows_share_is_there_once) {
  for (const char* folder : {"frames/a", "frames/b"}) {
    write(folder, 0, {10, 255});
    write(folder, 7, {30, 250});
  }
  write("frames/reference-0", 0, {0, 255, 255, 128}, true);  // gray and alpha of one pixel, then of the other
  write("frames/reference-0", 7, {1, 255, 255, 0}, true);
  Record timed = moving("b");
  timed.start = 0.5;
  timed.frame_rate = 30;
  const Json rows = collect({moving("a"), timed});
  ASSERT_EQ(rows.size(), 2u);
  EXPECT_EQ(rows[0]["numbers"], Json::array({0, 7}));
  EXPECT_TRUE(rows[0]["start"].is_null());
  EXPECT_EQ(rows[0]["frame_rate"], 60);
  EXPECT_EQ(rows[1]["start"], 0.5);
  EXPECT_EQ(rows[1]["frame_rate"], 30);
  EXPECT_EQ(rows[0]["reference"], rows[1]["reference"]);
  ASSERT_EQ(set_.blobs.size(), 3u);
  EXPECT_EQ(set_.blobs[rows[0]["mask"].get<std::size_t>()], packed(Bytes{10, 255, 20, 251}));
  // First the visibilities of a frame, then its alphas.
  EXPECT_EQ(set_.blobs[rows[0]["reference"].get<std::size_t>()], packed(Bytes{0, 255, 255, 128, 1, 0, 0, 128}));
  EXPECT_TRUE(set_.notes.empty());
}

TEST_F(HtmlFramesTest, a_row_without_frames_says_why) {
  Record still = row("still", 1, 0.1), refused = refusal("refused", Status::failed, "no"), old = moving("old"),
         masks = moving("masks"), none = moving("none"), gone = moving("gone");
  refused.path = "slide";
  for (Record* const r : {&old, &masks, &none}) r->kept_frames.reset();
  old.error_picture = "errors/old.png";
  none.mask.reset();
  std::map<std::string, Json> rows;
  const std::vector<Record> records{still, refused, old, masks, none, gone};
  const Layout layout = lay_out(records, column_names(records));
  const Json all = collect(records);
  std::size_t k = 0;
  for (const Layout::Group& group : layout.groups)
    for (const Layout::Row& one : group.rows) rows[one.record->technique] = all[k++];
  EXPECT_TRUE(rows["still"].is_null());
  EXPECT_TRUE(rows["refused"].is_null());
  EXPECT_EQ(rows["old"]["reason"], "they were not kept: an older program made the row");
  EXPECT_EQ(rows["masks"]["reason"], "they were not kept: the row was run with --pictures masks");
  EXPECT_EQ(rows["none"]["reason"], "they were not kept: the row was run with --pictures none");
  EXPECT_TRUE(has(rows["gone"]["reason"], "0000.png cannot be read: there is no such file")) << rows["gone"];
  ASSERT_EQ(set_.notes.size(), 1u);
  EXPECT_TRUE(has(set_.notes[0], "no frames of soup, light point, gone: ")) << set_.notes[0];
  EXPECT_EQ(collect({gone}, false)[0]["reason"], "pictures were left out on demand");
}

TEST_F(HtmlFramesTest, more_than_a_browser_holds_is_left_out) {
  Record large = moving("large");
  large.width = large.height = 10'000;
  const std::string reason = collect({large})[0]["reason"];
  EXPECT_TRUE(has(reason, "they are 600 MB, more than the 268 MB that a page plays")) << reason;
}

}  // namespace html_frames_test
