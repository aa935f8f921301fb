#include <gtest/gtest.h>

#include <cmath>

#include "measure/score/metrics.h"
#include "measure/score/score.h"

namespace gnomon::radiosity_error_test {

/// Two pixels that show surfaces, and one of background whose numbers are nonsense.
struct Pictures {
  std::vector<PixelClass> classes{PixelClass::T, PixelClass::B, PixelClass::F};
  std::vector<float> mask{1, 1, 1}, picture, reference{3, 0, 0, 9, 9, 9, 0, 4, 0}, error = std::vector<float>(9, 0.0f);
  std::optional<double> radiosity_error() const {
    const Evidence evidence{.width = 3,
                            .height = 1,
                            .classes = classes,
                            .reference = mask,
                            .mask = mask,
                            .causes = {},
                            .global_picture = picture,
                            .global_reference = reference,
                            .global_error = error};
    return measure_metric(Scoring(evidence), "radiosity_error");
  }
};

// The reference's squares sum to 9 + 16 = 25 without the background.
TEST(RadiosityError, is_the_root_of_squares_over_those_of_the_reference) {
  Pictures p;
  p.picture = {3, 0, 0, 0, 0, 0, 0, 4, 0};
  EXPECT_EQ(p.radiosity_error(), 0);
  p.picture = std::vector<float>(9, 0.0f);
  EXPECT_EQ(p.radiosity_error(), 1);
  p.picture = {3, 1, 0, 0, 0, 0, 2, 2, 0};
  EXPECT_DOUBLE_EQ(p.radiosity_error().value(), 3.0 / 5);
}

TEST(RadiosityError, leaves_out_what_noise_of_the_reference_adds) {
  Pictures p;
  p.picture = {3, 1, 0, 0, 0, 0, 2, 2, 0};
  p.error = {2, 0, 0, 7, 7, 7, 0, 1, 0};
  EXPECT_DOUBLE_EQ(p.radiosity_error().value(), 2.0 / 5);
  p.error[0] = 3;
  EXPECT_EQ(p.radiosity_error(), 0);
}

TEST(RadiosityError, is_not_defined_without_a_picture_or_without_light) {
  Pictures p;
  EXPECT_EQ(p.radiosity_error(), std::nullopt);
  p.picture = std::vector<float>(9, 0.0f);
  p.reference = p.picture;
  EXPECT_EQ(p.radiosity_error(), std::nullopt);
}

}  // namespace gnomon::radiosity_error_test
