// Scores of rows: one light, several, and a path of frames.
#include "measure/row/score_row.h"

#include <gtest/gtest.h>

#include <cmath>

#include "hand_made.h"

namespace score_row_test {

using namespace gnomon;

/// A row of four pixels, all tested, whose masks the tests write.
struct Row {
  Scene scene;
  MeasuredRow measured;
  std::vector<PixelClass> classes = std::vector<PixelClass>(4, PixelClass::T);

  Row() {
    scene.meshes = {hand_made::square(4, 0)};
    for (int x = 0; x < 4; ++x) picture.set(static_cast<std::size_t>(x), {0.1f * x, 0, 0}, {0, 1, 0}, 0, 0);
    picture.gbuffer.view = {.eye = {0, 5, 1}, .target = {0, 0, 0}};
  }
  /// One light more: its mask, the reference lit everywhere, and the causes of the mask's pixels.
  void add(std::vector<float> mask, std::vector<Cause> causes) {
    MeasuredLight& light = measured.lights.emplace_back();
    light.light = {.name = fmt::format("sun_{}", std::size(measured.lights)), .kind = DirectionalLight{{0, -1, 0}}};
    Answer& answer = light.answer;
    answer.gbuffer = picture.gbuffer;
    answer.reference.mask = lit;
    answer.reference.classes = classes;
    answer.mask = std::move(mask);
    answer.causes = std::move(causes);
  }

  const std::vector<float> lit = std::vector<float>(4, 1.0f);
  hand_made::Picture picture{4, 1};
};

TEST(score_row, of_one_light_is_that_of_the_light) {
  Row row;
  row.add({1, 0, 1, 1}, {Cause::none, Cause::acne, Cause::none, Cause::none});
  put_together(row.measured, row.scene);
  const RowScore score = gnomon::score(row.measured, row.scene);
  ASSERT_EQ(std::size(score.lights), 1u);
  EXPECT_EQ(score.whole.kind, AnswerKind::binary);
  EXPECT_EQ(score.whole.metrics.at("wrong_rate"), 0.25);
  EXPECT_EQ(score.lights[0].metrics, score.whole.metrics);
  EXPECT_EQ(score.lights[0].causes, score.whole.causes);
  EXPECT_EQ(score.whole.causes->at("acne"), 1u);
  EXPECT_EQ(score.whole.cause_errors, std::nullopt) << "wrong pixels are counted";
  EXPECT_EQ(score.errors.wrong, 1u);
}

TEST(score_row, of_several_lights_counts_a_pixel_under_each_that_is_wrong) {
  Row row;
  row.add({0, 0, 1, 1}, {Cause::acne, Cause::acne, Cause::none, Cause::none});
  row.add({0, 1, 1, 1}, {Cause::crack, Cause::none, Cause::none, Cause::none});
  put_together(row.measured, row.scene);
  const RowScore score = gnomon::score(row.measured, row.scene);
  ASSERT_EQ(std::size(score.lights), 2u);
  EXPECT_EQ(score.whole.kind, AnswerKind::received);
  EXPECT_EQ(score.lights[0].metrics.at("wrong_rate"), 0.5);
  EXPECT_EQ(score.lights[1].metrics.at("wrong_rate"), 0.25);
  EXPECT_EQ(score.whole.causes->at("acne"), 2u);
  EXPECT_EQ(score.whole.causes->at("crack"), 1u);
  EXPECT_TRUE(score.whole.cause_errors);
  EXPECT_FALSE(score.lights[0].cause_errors);

  Record record;
  const Light* const lights[] = {&row.measured.lights[0].light, &row.measured.lights[1].light};
  describe_lights(record, row.scene, lights);
  EXPECT_EQ(record.answer, AnswerKind::received);
  put_score(record, score);
  EXPECT_EQ(record.lights[1].metrics, score.lights[1].metrics);
  EXPECT_EQ(record.lights[1].answer, AnswerKind::binary);
  EXPECT_EQ(record.metrics.at(Truth::shape), score.whole.metrics);
  EXPECT_EQ(record.causes, score.whole.causes);
}

TEST(score_row, without_causes_under_one_light_has_those_of_the_others) {
  Row row;
  row.add({0, 1, 1, 1}, {Cause::acne, Cause::none, Cause::none, Cause::none});
  row.add({1, 1, 1, 1}, {});
  put_together(row.measured, row.scene);
  const RowScore score = gnomon::score(row.measured, row.scene);
  EXPECT_EQ(score.lights[1].causes, std::nullopt);
  ASSERT_TRUE(score.whole.causes);
  EXPECT_EQ(score.whole.causes->at("acne"), 1u);
}

TEST(path_score, is_a_mean_where_every_frame_has_a_value_and_a_sum_of_counts) {
  PathScore path(4);
  for (int frame = 0; frame < 4; ++frame) {
    Score score{.kind = AnswerKind::fraction,
                .metrics = {{"error", 0.25 * frame}, {"instability", std::nullopt}, {"shift", 1.0}},
                .classes = {{"T", 10}},
                .causes = {{{"acne", 2}}},
                .cause_errors = {{{"acne", 0.5}}}};
    if (frame > 0) score.metrics["instability"] = 0.5;
    if (frame == 2) score.metrics["shift"] = std::nullopt;
    path.add(score);
  }
  const Score mean = path.score();
  EXPECT_EQ(mean.kind, AnswerKind::fraction);
  EXPECT_EQ(mean.metrics.at("error"), (0.25 + 0.5 + 0.75) / 4);
  EXPECT_EQ(mean.metrics.at("instability"), 0.5) << "the first frame has none before it";
  EXPECT_EQ(mean.metrics.at("shift"), std::nullopt) << "a mean over some frames would be another quantity";
  EXPECT_EQ(mean.classes.at("T"), 40u);
  EXPECT_EQ(mean.causes->at("acne"), 8u);
  EXPECT_DOUBLE_EQ(mean.cause_errors->at("acne"), 0.5);
  PathScore one(1);
  one.add({.kind = AnswerKind::binary,
           .metrics = {{"instability", std::nullopt}},
           .classes = {},
           .causes = {},
           .cause_errors = {}});
  EXPECT_EQ(one.score().metrics.at("instability"), std::nullopt);
}

}  // namespace score_row_test
