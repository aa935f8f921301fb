// Errors behind casters that let a part of the light through.
#include <gtest/gtest.h>

#include <cmath>

#include "measure/score/metrics.h"
#include "measure/score/score.h"

namespace gnomon::metrics_glass_test {

/// One row of pixels behind 0, 1, 2, 3, 4, 5 and 9 surfaces, an opaque one and an untested one.
struct Row {
  std::vector<PixelClass> classes = std::vector<PixelClass>(8, PixelClass::T);
  std::vector<float> reference{1, 1, 0.5f, 0.5f, 0.5f, 0.25f, 0.25f, 0}, mask = reference;
  std::vector<std::uint8_t> surfaces{0, 1, 2, 3, 4, 5, 9, blocked_surfaces};
  Row() {
    classes.push_back(PixelClass::U);
    for (auto* floats : {&reference, &mask}) floats->push_back(1);
    mask.back() = 0;
    surfaces.push_back(0);
  }
  Evidence evidence(AnswerKind kind = AnswerKind::transmitted) const {
    Evidence e{.width = static_cast<int>(mask.size()),
               .height = 1,
               .classes = classes,
               .reference = reference,
               .mask = mask,
               .causes = {}};
    if (kind == AnswerKind::transmitted) e.surfaces = surfaces;
    e.kind = kind;
    return e;
  }
  std::optional<double> metric(std::string_view name, AnswerKind kind = AnswerKind::transmitted) const {
    const Evidence e = evidence(kind);
    return measure_metric(Scoring(e), name);
  }
};

TEST(metrics_glass, a_right_mask_has_no_error_and_other_answers_have_none_of_these) {
  const Row row;
  for (const char* name : {"transmittance_error_rms", "transmittance_error_p95", "transmittance_error_at_jumps",
                           "transmittance_error_off_jumps", "transmittance_error_0", "transmittance_error_1",
                           "transmittance_error_2", "transmittance_error_3_4", "transmittance_error_5_up", "wrong_rate"}) {
    // In so short a row all pixels are within two of a jump.
    const bool is_defined = std::string_view(name) != "transmittance_error_off_jumps";
    EXPECT_EQ(row.metric(name), is_defined ? std::optional(0.0) : std::nullopt) << name;
    EXPECT_EQ(row.metric(name, AnswerKind::binary).has_value(), std::string_view(name) == "wrong_rate") << name;
  }
}

// k steps at pixel k: bins have the means of theirs. Five steps are less than 1/20, six are more.
TEST(metrics_glass, errors_are_told_by_the_number_of_surfaces) {
  constexpr double step = 0.0095;
  Row row;
  for (std::size_t k = 0; k < 8; ++k) row.mask[k] += static_cast<float>(step * static_cast<double>(k) * (k < 2 ? -1 : 1));
  const double squares = 1 + 4 + 9 + 16 + 25 + 36 + 49;
  EXPECT_NEAR(*row.metric("error"), 28 * step / 8, 1e-7);
  EXPECT_NEAR(*row.metric("transmittance_error_rms"), step * std::sqrt(squares / 8), 1e-7);
  EXPECT_NEAR(*row.metric("transmittance_error_p95"), 6.65 * step, 1e-6);  // 0.95 of 7 steps
  EXPECT_NEAR(*row.metric("transmittance_error_0"), 0, 1e-7);
  EXPECT_NEAR(*row.metric("transmittance_error_1"), step, 1e-7);
  EXPECT_NEAR(*row.metric("transmittance_error_2"), 2 * step, 1e-7);
  EXPECT_NEAR(*row.metric("transmittance_error_3_4"), 3.5 * step, 1e-7);
  EXPECT_NEAR(*row.metric("transmittance_error_5_up"), 5.5 * step, 1e-7);
  EXPECT_EQ(row.metric("wrong_rate"), 2.0 / 8);
  EXPECT_EQ(row.metric("wrong_rate", AnswerKind::binary), 0.0);
}

TEST(metrics_glass, what_is_within_two_pixels_of_a_jump_is_apart) {
  Row row;
  row.reference.assign(9, 1);
  for (std::size_t k = 5; k < 9; ++k) row.reference[k] = 0.9f;
  row.mask = row.reference;
  row.mask[0] -= 0.04f;
  row.mask[4] -= 0.02f;
  // The jump is between pixels 4 and 5: 2 .. 7 are near it, 0 and 1 are not; 8 is not tested.
  EXPECT_NEAR(*row.metric("transmittance_error_at_jumps"), 0.02 / 6, 1e-7);
  EXPECT_NEAR(*row.metric("transmittance_error_off_jumps"), 0.04 / 2, 1e-7);
  for (std::size_t k = 5; k < 9; ++k) row.reference[k] = 0.96f;  // no jump
  EXPECT_FALSE(row.metric("transmittance_error_at_jumps"));
}

// An edge between any two shares is displaced by as much as the mask's is: 1 to 0.75, and 0.4 to 0.1, by two pixels.
TEST(metrics_glass, displacement_is_between_edges_of_any_shares) {
  for (const auto& [light, dark] : {std::pair(1.0f, 0.75f), {0.4f, 0.1f}}) {
    Row row;
    for (std::size_t k = 0; k < 8; ++k) {
      row.reference[k] = k < 3 ? light : dark;
      row.mask[k] = k < 5 ? light : dark;
    }
    row.classes.back() = PixelClass::B;
    EXPECT_EQ(row.metric("displacement_mean"), 2.0) << light;
    row.mask = row.reference;
    EXPECT_EQ(row.metric("displacement_mean"), 0.0) << light;
  }
}

// Half the light behind a sheet is no penumbra.
TEST(metrics_glass, glass_has_no_penumbra) {
  Row row;
  for (const char* name : {"penumbra_error_mean", "outside_error_mean", "penumbra_noise", "penumbra_area_ratio"})
    EXPECT_FALSE(row.metric(name)) << name;
}

TEST(metrics_glass, a_pixel_is_wrong_that_is_off_by_more_than_a_twentieth) {
  for (const auto& [mask, reference, expected] : {std::tuple(0.5f, 0.375f, true),
                                                  {0.42f, 0.375f, false},
                                                  {0.33f, 0.375f, false},
                                                  {0.0f, 0.06f, true},
                                                  {1.0f, 0.94f, true},
                                                  {1.0f, 0.96f, false}}) {
    EXPECT_EQ(is_wrong(mask, reference, AnswerKind::transmitted), expected) << mask << ' ' << reference;
    EXPECT_FALSE(is_wrong(mask, reference, AnswerKind::binary));
  }
}

}  // namespace gnomon::metrics_glass_test
