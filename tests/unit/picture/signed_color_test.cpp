#include "measure/picture/signed_color.h"

#include <gtest/gtest.h>

#include <limits>

#include "measure/cause/color_vision.h"

namespace signed_color_test {

using namespace gnomon;
using color_vision::lab;
using color_vision::visions;

TEST(signed_color, runs_from_end_to_end_through_its_colors) {
  const std::span<const Color> colors = signed_colors();
  ASSERT_EQ(colors.size() % 2, 1u) << "one stands for no difference";
  const std::size_t last = colors.size() - 1;
  for (const double full : difference_scales)
    for (std::size_t k = 0; k <= last; ++k)
      EXPECT_EQ(signed_color(full * (2.0 * static_cast<double>(k) / static_cast<double>(last) - 1), full), colors[k])
          << full << ' ' << k;
  // Half way between two neighbors is their mean, rounded.
  const Color half = signed_color(-1 + 1.0 / static_cast<double>(last), 1);
  for (std::size_t c = 0; c < 3; ++c) EXPECT_NEAR(half[c], (colors[0][c] + colors[1][c]) / 2.0, 0.51);
}

TEST(signed_color, ends_where_the_scale_ends_and_is_that_of_zero_for_what_is_no_number) {
  EXPECT_EQ(signed_color(-0.5, 0.1), signed_colors().front());
  EXPECT_EQ(signed_color(0.5, 0.1), signed_colors().back());
  EXPECT_EQ(signed_color(std::numeric_limits<double>::infinity(), 1), signed_colors().back());
  EXPECT_EQ(signed_color(std::numeric_limits<double>::quiet_NaN(), 1), signed_color(0, 1));
}

TEST(signed_color, sides_can_be_told_apart_with_any_cones_and_sizes_without_colors) {
  for (const glm::dmat3& vision : visions) {
    double before = 0;
    for (const double size : {0.05, 0.25, 0.5, 0.75, 1.0}) {
      const glm::dvec3 dark = lab(signed_color(-size, 1), vision), light = lab(signed_color(size, 1), vision);
      // 2.3 is just noticeable; a twentieth of the scale is a tenth of the way to colors 40 apart and more.
      EXPECT_GT(glm::distance(dark, light), size < 0.1 ? 5 : 20) << size;
      if (size > 0.1) {
        EXPECT_LT(std::max(dark.x, light.x), before - 5) << size << ": the larger the darker";
        EXPECT_NEAR(dark.x, light.x, 13) << size << ": on both sides alike";
      }
      before = std::min(dark.x, light.x);
    }
    EXPECT_GT(lab(signed_color(0, 1), vision).x, 94) << "nearly white";
  }
}

TEST(contours, inks_can_be_told_apart_and_seen_over_every_color) {
  for (const glm::dmat3& vision : visions) {
    const glm::dvec3 inks[] = {lab(reference_ink.core, vision), lab(technique_inks[0].core, vision),
                               lab(technique_inks[1].core, vision)};
    for (int a = 0; a < 3; ++a)
      for (int b = 0; b < a; ++b) EXPECT_GT(glm::distance(inks[a], inks[b]), 30) << a << ' ' << b;
    // Over a gray of any lightness one of both, core or casing, stands out.
    for (const ContourInk& ink : {reference_ink, technique_inks[0], technique_inks[1]})
      EXPECT_GT(std::abs(lab(ink.core, vision).x - lab(ink.casing, vision).x), 55);
  }
}

}  // namespace signed_color_test
