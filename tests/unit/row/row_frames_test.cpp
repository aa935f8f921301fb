#include "measure/row/row_frames.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "measure/scratch_folder.h"

namespace row_frames_test {

using namespace gnomon;
namespace fs = std::filesystem;

TEST(row_frames, keeps_all_frames_of_a_short_path_and_120_of_a_long_one) {
  EXPECT_EQ(kept_frame_numbers(1), std::vector{0});
  EXPECT_EQ(kept_frame_numbers(4), (std::vector{0, 1, 2, 3}));
  EXPECT_EQ(kept_frame_numbers(120).back(), 119);
  for (const int count : {121, 239, 300, 100'000}) {
    const std::vector<int> numbers = kept_frame_numbers(count);
    ASSERT_EQ(numbers.size(), 120u);
    EXPECT_EQ(numbers.front(), 0);
    EXPECT_EQ(numbers.back(), count - 1);
    std::vector<int> steps;
    for (std::size_t k = 1; k < numbers.size(); ++k) steps.push_back(numbers[k] - numbers[k - 1]);
    const auto [least, most] = std::ranges::minmax(steps);
    EXPECT_GE(least, 1) << count;
    EXPECT_LE(most - least, 1) << count;
  }
}

TEST(row_frames, a_share_is_the_nearest_step) {
  EXPECT_EQ(byte_of_share(0), 0);
  EXPECT_EQ(byte_of_share(1), 255);
  EXPECT_EQ(byte_of_share(0.5f), 128);  // 127.5 goes up
  EXPECT_EQ(byte_of_share(1 / 255.0f), 1);
  EXPECT_EQ(byte_of_share(0.4f / 255.0f), 0);
}

/// Rows of two techniques with the same references, 2 x 2 pixels, one of each alpha and two tested.
class RowFramesTest : public testing::Test {
 protected:
  static Record record(const std::string& technique) {
    Record r;
    r.job = technique + "0123456789abcdef";
    r.scene = "soup";
    r.light = r.lights.emplace_back().name = "sun";
    r.technique = technique;
    r.path = "slide";
    r.width = r.height = 2;
    return r;
  }

  static constexpr PixelClass classes[] = {PixelClass::F, PixelClass::S, PixelClass::T, PixelClass::T};
  static MeasuredRow frame(std::vector<float> mask, std::vector<float> reference) {
    MeasuredRow row;
    MeasuredLight& light = row.lights.emplace_back();
    light.light.name = "sun";
    light.answer.gbuffer.width = light.answer.gbuffer.height = 2;
    const auto kept = std::make_shared<std::vector<float>>(std::move(reference));
    light.answer.reference.mask = *kept;
    light.answer.reference.storage = kept;
    light.answer.reference.classes = classes;
    light.answer.mask = std::move(mask);
    return row;
  }

  std::vector<float> channel(const std::string& folder, int number, const char* name) const {
    return read_exr(folder_.path() / frame_picture(folder, number), name, 2, 2);
  }
  /// Names of what is in the folder of frames.
  std::vector<std::string> names() const {
    std::vector<std::string> all;
    for (const fs::directory_entry& entry : fs::directory_iterator(folder_.path() / "frames"))
      all.push_back(entry.path().filename().string());
    std::ranges::sort(all);
    return all;
  }

  const ScratchFolder folder_ = ScratchFolder::temporary("gnomon_row_frames");
  Scene scene_;
};

TEST_F(RowFramesTest, files_hold_mask_and_reference_with_the_classes_as_alpha) {
  Record r = record("a");
  RowFrames kept(r, folder_.path(), 2);
  kept.add(0, frame({0, 1, 0.2f, 1}, {0, 0, 0.4f, 1}), scene_);
  kept.add(1, frame({1, 1, 1, 1}, {0, 1, 0, 0}), scene_);
  EXPECT_EQ(r.kept_frames->reference, "");
  kept.finish();
  EXPECT_EQ(r.kept_frames->numbers, (std::vector{0, 1}));
  EXPECT_EQ(channel(r.kept_frames->mask, 0, "Y"), (std::vector{0.0f, 1.0f, 51 / 255.0f, 1.0f}));
  EXPECT_EQ(channel(r.kept_frames->reference, 0, "Y"), (std::vector{0.0f, 0.0f, 102 / 255.0f, 1.0f}));
  EXPECT_EQ(channel(r.kept_frames->reference, 1, "A"), (std::vector{0.0f, 128 / 255.0f, 1.0f, 1.0f}));
  EXPECT_EQ(pictures(r), (std::vector{r.kept_frames->mask + "/0000.png", r.kept_frames->mask + "/0001.png"}));
  EXPECT_EQ(shared_pictures(r).size(), 2u);
  EXPECT_EQ(names().size(), 2u);
}

TEST_F(RowFramesTest, rows_of_the_same_references_share_them_and_one_that_goes_leaves_them) {
  std::vector<Record> rows{record("a"), record("b"), record("c")};
  for (Record& r : rows) {
    RowFrames kept(r, folder_.path(), 2);
    const float lit = r.technique == "c" ? 1 : 0;  // whose references are others, in one pixel of one frame
    kept.add(0, frame({0, 0, 0, 0}, {0, 0, 0, 0}), scene_);
    kept.add(1, frame({0, 0, 0, 0}, {0, 0, 0, lit}), scene_);
    kept.finish();
  }
  EXPECT_EQ(rows[0].kept_frames->reference, rows[1].kept_frames->reference);
  EXPECT_NE(rows[0].kept_frames->reference, rows[2].kept_frames->reference);
  EXPECT_EQ(names().size(), 5u);
  remove_pictures(rows[0], folder_.path());
  EXPECT_FALSE(fs::exists(folder_.path() / rows[0].kept_frames->mask));
  for (const std::string& picture : shared_pictures(rows[1])) EXPECT_TRUE(fs::exists(folder_.path() / picture)) << picture;
  EXPECT_EQ(names().size(), 4u);
}

TEST_F(RowFramesTest, a_row_that_ends_early_leaves_no_references) {
  Record r = record("a");
  {
    RowFrames kept(r, folder_.path(), 2);
    kept.add(0, frame({0, 0, 0, 0}, {0, 0, 0, 0}), scene_);
  }
  EXPECT_EQ(names(), std::vector<std::string>{fs::path(r.kept_frames->mask).filename().string()});
  remove_pictures(r, folder_.path());
  EXPECT_TRUE(names().empty());
  forget_results(r);
  EXPECT_FALSE(r.kept_frames);
}

}  // namespace row_frames_test
