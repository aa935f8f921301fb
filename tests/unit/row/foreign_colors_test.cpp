// Masks of another program under a light that glass colors: three channels are one row.
#include <gtest/gtest.h>

#include <numeric>

#include "../hand_made.h"
#include "measure/row/foreign_row.h"
#include "measure/scene/channels.h"
#include "measure/scene/names.h"
#include "measure/scratch_folder.h"

namespace foreign_colors_test {

using namespace gnomon;

/// The sun shines straight down through a pane on a ground; the eye sees the ground alone.
class ForeignColors : public testing::Test {
 protected:
  static Scene pane() {
    Scene scene;
    scene.name = "pane";
    scene.meshes = {hand_made::square(4, 0), hand_made::square(1, 2)};
    scene.meshes[1].transmission = std::make_shared<const Transmission>(glm::vec3(0.75f, 0.5f, 0.25f));
    scene.meshes[1].seen = false;
    scene.lights = {hand_made::sun({0, -1, 0})};
    scene.views = {{.name = "view", .eye = {0, 6, 3}, .target = {0, 0, 0}}};
    split_lights(scene);
    return scene;
  }
  /// The references as masks, one of each channel of a picture.
  std::vector<ForeignMask> references() {
    std::vector<ForeignMask> masks;
    for (std::size_t k = 0; k < 3; ++k) {
      const Reference reference = frames_.reference(key_, scene_.lights[k]);
      masks.push_back({scene_.lights[k], std::string(1, "RGB"[k]), {reference.mask.begin(), reference.mask.end()}});
    }
    return masks;
  }
  Record row(const std::vector<ForeignMask>& masks) {
    return foreign_row(scene_, "pane.toml", frames_, key_, masks,
                       {.technique = "mine", .label = "Mine", .file = "mine.png", .told_ms = {}})
        .record;
  }

  const Scene scene_ = pane();
  const ScratchFolder folder_ = ScratchFolder::temporary("gnomon-foreign");
  FrameStore frames_{scene_, folder_.path()};
  const FrameKey key_{scene_.views[0], 48, 27, Truth::shape};
};

TEST_F(ForeignColors, the_references_are_one_row_without_error) {
  const Record record = row(references());
  EXPECT_EQ(record.light, "sun");
  EXPECT_EQ(names_of(record.lights), names_of(scene_.lights));
  EXPECT_EQ(record.answer, AnswerKind::transmitted);
  EXPECT_EQ(record.context["foreign"]["channel"], "R, G, B");
  EXPECT_EQ(record.context["scene_hash"], frames_.scene_hash({"sun.red", "sun.green", "sun.blue"}));
  EXPECT_EQ(record.metric("error"), 0);
  EXPECT_EQ(record.metric("hue_error"), 0);
}

// Red is lit everywhere: behind the pane it is off by 1 - 0.75, the others by nothing.
TEST_F(ForeignColors, an_error_of_one_channel_counts_a_third_and_changes_the_hue) {
  std::vector<ForeignMask> masks = references();
  std::ranges::fill(masks[0].values, 1.0f);
  const Record record = row(masks);
  std::size_t behind = 0, tested = 0, behind_all = 0, tested_all = 0;
  const Reference red = frames_.reference(key_, scene_.lights[0]), green = frames_.reference(key_, scene_.lights[1]),
                  blue = frames_.reference(key_, scene_.lights[2]);
  for (std::size_t i = 0; i < red.mask.size(); ++i) {
    if (red.classes[i] != PixelClass::T) continue;
    ++tested;
    behind += red.mask[i] == 0.75f;
    if (green.classes[i] != PixelClass::T || blue.classes[i] != PixelClass::T) continue;
    ++tested_all;
    behind_all += red.mask[i] == 0.75f;
  }
  ASSERT_GT(behind_all, 50u);
  const double error = 0.25 * static_cast<double>(behind) / static_cast<double>(tested);
  EXPECT_NEAR(*record.lights[0].metrics.at("error"), error, 1e-7);
  EXPECT_EQ(record.lights[1].metrics.at("error"), 0);
  EXPECT_NEAR(*record.metric("error"), error / 3, 1e-7);
  EXPECT_NEAR(*record.metric("hue_error"), 0.25 * static_cast<double>(behind_all) / static_cast<double>(tested_all), 1e-7);
}

TEST_F(ForeignColors, a_channel_alone_is_a_row_of_its_own) {
  const std::vector<ForeignMask> masks = references();
  const Record record = row({masks[1]});
  EXPECT_EQ(record.light, "sun.green");
  EXPECT_EQ(std::size(record.lights), 1u);
  EXPECT_EQ(record.context["foreign"]["channel"], "G");
  EXPECT_EQ(record.metric("error"), 0);
  EXPECT_EQ(record.metric("hue_error"), std::nullopt);
  // Under another channel's light the same mask is wrong.
  EXPECT_GT(*row({{masks[0].light, "G", masks[1].values}}).metric("error"), 0.005);
}

}  // namespace foreign_colors_test
