// Rows whose lights are the channels of one light, behind glass that colors it.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>

#include "hand_made.h"
#include "measure/picture/shading.h"
#include "measure/row/score_row.h"
#include "measure/score/error_picture.h"

namespace color_rows_test {

using namespace gnomon;

/// Four pixels of a white square under a sun from straight above, in three channels; what the tests do not write is lit and
/// tested.
struct Row {
  Scene scene;
  MeasuredRow measured;
  hand_made::Picture picture{4, 1};
  std::array<std::vector<PixelClass>, 6> classes;
  std::array<std::vector<float>, 6> references;
  const std::vector<std::uint8_t> no_surfaces = std::vector<std::uint8_t>(4, 0);
  const std::vector<float> errors = std::vector<float>(4, 0.001f);

  explicit Row(const std::vector<std::string>& lights = {"sun.red", "sun.green", "sun.blue"}) {
    scene.meshes = {hand_made::square(4, 0)};
    scene.meshes[0].albedo = glm::vec3(1);
    scene.ambient = 0;
    for (int x = 0; x < 4; ++x) picture.set(static_cast<std::size_t>(x), {0.1f * x, 0, 0}, {0, 1, 0}, 0, 0);
    picture.gbuffer.view = {.eye = {0, 5, 1}, .target = {0, 0, 0}};
    classes.fill(std::vector(4, PixelClass::T));
    for (const std::string& name : lights) {
      MeasuredLight& light = measured.lights.emplace_back();
      light.light = {.name = name, .kind = DirectionalLight{{0, -1, 0}}};
      light.answer.gbuffer = picture.gbuffer;
      light.answer.reference.kind = AnswerKind::transmitted;
      light.answer.reference.classes = classes[measured.lights.size() - 1];
      light.answer.reference.surfaces = no_surfaces;
      light.answer.causes.assign(4, Cause::none);
      set(measured.lights.size() - 1, {1, 1, 1, 1}, {1, 1, 1, 1});
    }
  }
  void set(std::size_t light, std::vector<float> mask, std::vector<float> reference) {
    measured.lights[light].answer.mask = std::move(mask);
    references[light] = std::move(reference);
    measured.lights[light].answer.reference.mask = references[light];
  }
  RowScore score(const MeasuredRow* before = nullptr) {
    put_together(measured, scene);
    return gnomon::score(measured, scene, before);
  }
};

double of(const Score& score, const char* metric) { return score.metrics.at(metric).value(); }

// Too light by 0.25 in red and too dark by as much in blue, at every pixel: in gray nothing is wrong. Two of three channels
// are: by (0.25 + 0 + 0.25) / 3 in the mean, and red and blue lie 0.25 - -0.25 apart.
TEST(color_rows, errors_of_opposite_sign_in_two_channels_do_not_cancel) {
  Row row;
  row.set(0, {0.75f, 0.75f, 0.75f, 0.75f}, {0.5f, 0.5f, 0.5f, 0.5f});
  row.set(2, {0.25f, 0.25f, 0.25f, 0.25f}, {0.5f, 0.5f, 0.5f, 0.5f});
  const RowScore score = row.score();
  EXPECT_EQ(score.whole.kind, AnswerKind::transmitted);
  ASSERT_EQ(std::size(score.lights), 3u);
  EXPECT_DOUBLE_EQ(of(score.whole, "error"), 0.5 / 3);
  EXPECT_DOUBLE_EQ(of(score.whole, "hue_error"), 0.5);
  EXPECT_DOUBLE_EQ(of(score.whole, "wrong_rate"), 2.0 / 3);
  EXPECT_DOUBLE_EQ(of(score.whole, "false_lit_rate"), 1.0 / 3);
  EXPECT_DOUBLE_EQ(of(score.whole, "transmittance_error_0"), 0.5 / 3) << "a channel of one light has what that light has";
  EXPECT_EQ(score.errors.tested, 4u);
  EXPECT_EQ(score.errors.wrong, 4u) << "a pixel is wrong that is in one channel";
  for (const Score& light : score.lights) EXPECT_EQ(light.metrics.at("hue_error"), std::nullopt) << "of one channel";
}

// Off by 0, 0.25 and 0.5 in red and by 0.25 everywhere in blue: means of 0.1875 (of 0, 0.25, 0.5, 0) and 0.25.
TEST(color_rows, a_metric_is_the_mean_over_the_channels) {
  Row row;
  row.set(0, {1, 0.75f, 0.5f, 1}, {1, 1, 1, 1});
  row.set(2, {0.25f, 0.25f, 0.25f, 0.25f}, {0.5f, 0.5f, 0.5f, 0.5f});
  const RowScore score = row.score();
  EXPECT_DOUBLE_EQ(of(score.whole, "error"), (0.1875 + 0.25) / 3);
  for (const auto& [metric, value] : score.whole.metrics) {
    if (metric == "hue_error") continue;
    double sum = 0;
    bool has_all = true;
    for (const Score& light : score.lights) {
      const std::optional<double> one = light.metrics.at(metric);
      has_all = has_all && one.has_value();
      sum += one.value_or(0);
    }
    ASSERT_EQ(value.has_value(), has_all) << metric;
    if (value) {
      EXPECT_DOUBLE_EQ(*value, sum / 3) << metric;
    }
  }
  // Signed: red 0, -0.25, -0.5, 0; green 0; blue -0.25: spreads of 0.25, 0.25, 0.5 and 0.25.
  EXPECT_DOUBLE_EQ(of(score.whole, "hue_error"), 1.25 / 4);
}

// The light is white without casters: three channels of a sun of 1 W/m2 are exposed as that sun is, not as one of 3.
TEST(color_rows, exposure_is_that_of_one_channel) {
  Row row, gray({"sun"});
  EXPECT_EQ(row.score().exposure, 1);
  EXPECT_EQ(row.score().exposure, gray.score().exposure);
}

// Pixel 1 is not tested in green, pixel 2 in none: hue is known of two pixels, 0 and 3, where red errs by 0.5 and not at all.
TEST(color_rows, hue_is_of_pixels_tested_in_all_channels) {
  Row row;
  row.set(0, {0.5f, 0, 0, 1}, {1, 1, 1, 1});
  row.classes[1][1] = PixelClass::U;
  for (std::size_t light = 0; light < 3; ++light) row.classes[light][2] = PixelClass::G;
  const RowScore score = row.score();
  EXPECT_DOUBLE_EQ(of(score.whole, "hue_error"), 0.25);
  EXPECT_EQ(score.whole.classes.at("T"), 3u) << "tested in one channel at least";
  EXPECT_EQ(score.whole.classes.at("G"), 1u);
  for (std::size_t light = 0; light < 3; ++light) std::ranges::fill(row.classes[light], PixelClass::U);
  EXPECT_EQ(row.score().whole.metrics.at("hue_error"), std::nullopt);
}

TEST(color_rows, rows_without_three_channels_have_no_hue) {
  for (const auto& lights : {std::vector<std::string>{"sun"}, {"sun", "lamp"}, {"sun.red"}, {"sun.red", "sun.blue"}}) {
    Row row(lights);
    EXPECT_EQ(row.score().whole.metrics.at("hue_error"), std::nullopt) << lights.back();
  }
}

// The picture of errors: pixel 0 is that of blue, which errs more than red; pixel 1 that of red, since blue, which errs more,
// is not tested there; pixel 2 that of green.
TEST(color_rows, a_pixel_shows_the_channel_that_errs_most) {
  Row row;
  row.set(0, {0.75f, 0.75f, 1, 1}, {0.5f, 0.5f, 1, 1});
  row.set(1, {1, 1, 0.125f, 1}, {1, 1, 0.875f, 1});
  row.set(2, {0, 0, 1, 1}, {0.5f, 0.5f, 1, 1});
  row.classes[2][1] = PixelClass::U;
  row.measured.lights[0].answer.causes = {Cause::acne, Cause::acne, Cause::none, Cause::none};
  row.measured.lights[1].answer.causes[2] = Cause::region;
  row.measured.lights[2].answer.causes[0] = Cause::crack;
  const RowScore score = row.score();
  const Evidence evidence = row.measured.evidence(row.scene);
  EXPECT_EQ(std::vector(evidence.mask.begin(), evidence.mask.end()), (std::vector{0.0f, 0.75f, 0.125f, 1.0f}));
  EXPECT_EQ(std::vector(evidence.reference.begin(), evidence.reference.end()), (std::vector{0.5f, 0.5f, 0.875f, 1.0f}));
  EXPECT_EQ(std::vector(evidence.causes.begin(), evidence.causes.end()),
            (std::vector{Cause::crack, Cause::acne, Cause::region, Cause::none}));
  EXPECT_EQ(score.whole.causes->at("acne"), 2u) << "counted under each channel";
  EXPECT_EQ(score.whole.causes->at("crack"), 1u);
  EXPECT_FALSE(score.whole.cause_errors) << "wrong pixels are counted";
  // Its legend names these causes, and only wrong pixels are colored.
  const Picture errors = draw_errors(evidence, "");
  const auto color_of = [](Cause cause) { return cause_infos()[static_cast<std::size_t>(cause) - 1].color; };
  EXPECT_TRUE(std::equal(errors.rgb.begin(), errors.rgb.begin() + 3, color_of(Cause::crack).begin()));
  EXPECT_EQ(errors.rgb[9], errors.rgb[10]) << "pixel 3 is right, and gray";
  EXPECT_EQ(errors.rgb[9], errors.rgb[11]);
}

// A pane lets red through and a quarter of blue: on a white floor behind it red is 1, green 0, blue the sRGB of 1/4, 137.
TEST(color_rows, a_red_pane_gives_a_red_patch) {
  Row row;
  row.set(1, {0, 1, 1, 1}, {0, 1, 1, 1});
  row.set(2, {0.25f, 1, 1, 1}, {0.25f, 1, 1, 1});
  EXPECT_EQ(of(row.score().whole, "error"), 0);
  const Picture picture = shade(row.scene, row.measured);
  EXPECT_EQ(picture.rgb[0], 255);
  EXPECT_EQ(picture.rgb[1], 0);
  EXPECT_EQ(picture.rgb[2], srgb(0.25));
  for (std::size_t k = 3; k < 12; ++k) EXPECT_EQ(picture.rgb[k], 255) << "white beside it";
  // In gray it is the mean of 1, 0 and 1/4.
  EXPECT_FLOAT_EQ(row.measured.mask()[0], 1.25f / 3);
}

// Sun and lamp give 1 W/m2 each. Red is dark under the lamp alone: half of the channel's light is missing.
TEST(color_rows, several_lights_are_together_channel_by_channel) {
  Row row({"sun.red", "sun.green", "sun.blue", "lamp.red", "lamp.green", "lamp.blue"});
  row.set(3, {0, 0, 0, 0}, {1, 1, 1, 1});
  const RowScore score = row.score();
  EXPECT_EQ(score.whole.kind, AnswerKind::received);
  EXPECT_EQ(std::size(score.lights), 6u);
  EXPECT_NEAR(of(score.whole, "error"), 0.5 / 3, 1e-12);
  EXPECT_NEAR(of(score.whole, "hue_error"), 0.5, 1e-12);
  EXPECT_NEAR(score.exposure, 0.5, 1e-12) << "2 W/m2, not 6";
  EXPECT_EQ(shade(row.scene, row.measured).rgb[0], srgb(0.5));
  EXPECT_EQ(shade(row.scene, row.measured).rgb[1], 255);
}

// Under a light with area causes are told by their part in the error: red errs by 1/2 at one pixel of four for acne, blue by
// 1/4 at two of them for crack, which is 1/8 each, and a third of that in the mean.
TEST(color_rows, causes_of_shares_add_up_to_the_error) {
  Row row;
  for (MeasuredLight& light : row.measured.lights) {
    light.answer.reference.kind = AnswerKind::fraction;
    light.answer.reference.surfaces = {};
    light.answer.reference.error = row.errors;
  }
  row.set(0, {0.5f, 1, 1, 1}, {1, 1, 1, 1});
  row.set(2, {0.75f, 0.75f, 1, 1}, {1, 1, 1, 1});
  row.measured.lights[0].answer.causes[0] = Cause::acne;
  row.measured.lights[2].answer.causes = {Cause::crack, Cause::crack, Cause::none, Cause::none};
  const RowScore score = row.score();
  EXPECT_EQ(score.whole.kind, AnswerKind::fraction);
  ASSERT_TRUE(score.whole.cause_errors);
  EXPECT_DOUBLE_EQ(score.whole.cause_errors->at("acne"), 0.125 / 3);
  EXPECT_DOUBLE_EQ(score.whole.cause_errors->at("crack"), 0.125 / 3);
  EXPECT_DOUBLE_EQ(of(score.whole, "error"), 0.25 / 3);
}

// Red turns from 1 to 1/2 at one pixel of four between two frames, and the reference stays: a quarter in one of three channels.
TEST(color_rows, each_channel_is_compared_with_its_own_frame_before) {
  Row before, now;
  now.set(0, {0.5f, 1, 1, 1}, {1, 1, 1, 1});
  before.score();
  EXPECT_DOUBLE_EQ(of(now.score(&before.measured).whole, "instability"), 0.25 / 3);
}

// The record is read back: its answer is that of the light, and causes are shares of what all channels test.
TEST(color_rows, the_record_has_three_lights_and_the_answer_of_one) {
  Row row;
  row.set(0, {0, 1, 1, 1}, {1, 1, 1, 1});
  row.measured.lights[0].answer.causes[0] = Cause::acne;
  row.scene.meshes[0].transmission = std::make_shared<const Transmission>(glm::vec3(1, 0.5f, 0.25f));
  Record record;
  record.light = "sun";
  std::vector<const Light*> lights;
  for (const MeasuredLight& light : row.measured.lights) lights.push_back(&light.light);
  describe_lights(record, row.scene, lights);
  EXPECT_EQ(record.answer, AnswerKind::transmitted);
  EXPECT_EQ(record.light_kind, "directional");
  put_score(record, row.score());
  record.status = Status::ok;
  EXPECT_EQ(record.answer, AnswerKind::transmitted);
  EXPECT_DOUBLE_EQ(cause_shares(record)->at("acne"), 1.0 / 12);
  EXPECT_DOUBLE_EQ(*record.metric("wrong_rate"), 1.0 / 12);
  const Record read = Json(record).get<Record>();
  EXPECT_EQ(read.answer, AnswerKind::transmitted);
  EXPECT_EQ(light_names(read), (std::vector<std::string>{"sun.red", "sun.green", "sun.blue"}));
  EXPECT_EQ(read.lights[1].metrics, record.lights[1].metrics);
  // Channels of two lights are several lights.
  record.lights[2].name = "lamp.blue";
  EXPECT_EQ(row_answer(record), AnswerKind::received);
}

// Pages of a run share one reference among rows: in gray, half of the light of a channel is a sixth of all.
TEST(color_rows, in_gray_channels_are_so_many_lights) {
  Row row;
  row.set(0, {0.5f, 1, 1, 1}, {1, 1, 1, 1});
  put_together(row.measured, row.scene, true);
  EXPECT_TRUE(row.measured.together->channels.empty());
  EXPECT_NEAR(row.measured.together->mask[0], 2.5 / 3, 1e-7);
  EXPECT_EQ(row.measured.together->reference[0], 1);
}

}  // namespace color_rows_test
