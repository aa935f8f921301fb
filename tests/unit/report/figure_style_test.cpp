#include "report/figure/figure_style.h"

#include <gnomon/error.h>
#include <gtest/gtest.h>

#include <cmath>
#include <glm/glm.hpp>
#include <set>
#include <vector>

#include "report/figure/figure_axis.h"

namespace figure_style_test {

using namespace gnomon;

/// Linear RGB of "#0072b2" by the curve of sRGB (IEC 61966-2-1).
glm::dvec3 linear(std::string_view color) {
  glm::dvec3 rgb;
  for (int k = 0; k < 3; ++k) {
    const double value = std::stoi(std::string(color.substr(1 + 2 * k, 2)), nullptr, 16) / 255.0;
    rgb[k] = value <= 0.04045 ? value / 12.92 : std::pow((value + 0.055) / 1.055, 2.4);
  }
  return rgb;
}

glm::dvec3 product(const double (&rows)[3][3], const glm::dvec3& v) {
  glm::dvec3 result;
  for (int k = 0; k < 3; ++k) result[k] = glm::dot(glm::dvec3(rows[k][0], rows[k][1], rows[k][2]), v);
  return result;
}

/// CIE L*a*b* of 1976 with the white of sRGB: its own primaries at 1, 1, 1.
glm::dvec3 lab(const glm::dvec3& rgb) {
  constexpr double xyz[3][3] = {
      {0.4124564, 0.3575761, 0.1804375}, {0.2126729, 0.7151522, 0.0721750}, {0.0193339, 0.1191920, 0.9503041}};
  const glm::dvec3 share = product(xyz, glm::clamp(rgb, 0.0, 1.0)) / product(xyz, glm::dvec3(1));
  glm::dvec3 f;
  for (int k = 0; k < 3; ++k) f[k] = share[k] > 216.0 / 24389 ? std::cbrt(share[k]) : (24389.0 / 27 * share[k] + 16) / 116;
  return {116 * f.y - 16, 500 * (f.x - f.y), 200 * (f.y - f.z)};
}

enum class Eyes { all_cones, no_green, no_red };

/// What people without a kind of cones see (Vienot, Brettel and Mollon 1999): the other two and what those would have been on
/// the plane through black, white, blue and yellow.
glm::dvec3 seen(const glm::dvec3& rgb, Eyes eyes) {
  if (eyes == Eyes::all_cones) return rgb;
  constexpr double to_cones[3][3] = {{17.8824, 43.5161, 4.11935}, {3.45565, 27.1554, 3.86714}, {0.0299566, 0.184309, 1.46709}};
  glm::dvec3 cones = product(to_cones, rgb);
  if (eyes == Eyes::no_green) cones.y = 0.494207 * cones.x + 1.24827 * cones.z;
  if (eyes == Eyes::no_red) cones.x = 2.02344 * cones.y - 2.52581 * cones.z;
  const auto& m = to_cones;
  const glm::dmat3 columns(glm::dvec3(m[0][0], m[1][0], m[2][0]), glm::dvec3(m[0][1], m[1][1], m[2][1]),
                           glm::dvec3(m[0][2], m[1][2], m[2][2]));
  return glm::inverse(columns) * cones;
}

double distance(std::string_view a, std::string_view b, Eyes eyes) {
  return glm::distance(lab(seen(linear(a), eyes)), lab(seen(linear(b), eyes)));
}

TEST(figure_style, distances_of_known_colors) {
  // Black and white: only L* differs, by 100. sRGB's red is L* 53.24, a* 80.09, b* 67.20.
  EXPECT_NEAR(distance("#000000", "#ffffff", Eyes::all_cones), 100, 1e-9);
  EXPECT_NEAR(glm::distance(lab(linear("#ff0000")), glm::dvec3(53.24, 80.09, 67.20)), 0, 0.05);
  // Grays stay what they are without green cones; this red and this green, far apart for others, come near each other.
  EXPECT_NEAR(distance("#000000", "#ffffff", Eyes::no_green), 100, 0.1);
  EXPECT_GT(distance("#c04040", "#6f7d00", Eyes::all_cones), 60);
  EXPECT_LT(distance("#c04040", "#6f7d00", Eyes::no_green), 20);
}

TEST(figure_style, every_two_colors_are_told_apart_by_any_eyes) {
  std::vector<std::string_view> all(figure_colors.begin(), figure_colors.end());
  all.insert(all.end(), {ink_color, faint_color, "#ffffff"});
  for (const Eyes eyes : {Eyes::all_cones, Eyes::no_green, Eyes::no_red})
    for (std::size_t a = 0; a < all.size(); ++a)
      for (std::size_t b = 0; b < a; ++b)
        EXPECT_GE(distance(all[a], all[b], eyes), 20) << all[a] << " " << all[b] << " eyes " << static_cast<int>(eyes);
}

TEST(figure_style, no_two_series_are_alike) {
  std::set<std::pair<std::string_view, int>> seen;
  for (std::size_t k = 0; k < most_series; ++k) {
    const SeriesStyle style = series_style(k);
    EXPECT_TRUE(seen.emplace(style.color, style.mark).second) << k;
    // Neighbors differ in the shape too, so that a print without colors tells them apart.
    EXPECT_NE(style.mark, series_style(k + 1).mark) << k;
  }
  std::set<int> marks;
  for (std::size_t k = 0; k < most_marks; ++k) marks.insert(series_mark(k));
  for (std::size_t k = 0; k < most_references; ++k) marks.insert(reference_mark(k));
  EXPECT_EQ(marks.size(), most_marks + most_references);
  EXPECT_NO_THROW(require_series(most_series, "settings"));
  EXPECT_THROW(require_series(most_series + 1, "settings"), Error);
}

TEST(figure_style, steps_of_tics_are_round_and_few_enough) {
  EXPECT_DOUBLE_EQ(linear_step(0, 10, 5), 2);
  EXPECT_DOUBLE_EQ(linear_step(0, 10, 4), 5);
  EXPECT_DOUBLE_EQ(linear_step(-1, 1, 4), 0.5);
  EXPECT_DOUBLE_EQ(linear_step(0, 9e4, 3), 5e4);
  EXPECT_DOUBLE_EQ(linear_step(3, 3, 4), 1);  // one value: any step
}

TEST(figure_style, names_of_tics_are_those_that_are_drawn) {
  EXPECT_EQ(names_of_tics("('0.1' 0.1, '' 0.2 1, '1k' 1000)"), (std::vector<std::string>{"0.1", "1k"}));
  EXPECT_EQ(names_of_tics(""), std::vector<std::string>{});
  EXPECT_EQ(linear_names(-0.3, 1.1, 0.5), (std::vector<std::string>{"0", "0.5", "1"}));
  EXPECT_EQ(linear_names(0, 0.0006, 0.0002), (std::vector<std::string>{"0", "0.0002", "0.0004", "0.0006"}));
}

TEST(figure_style, labels_lie_beside_one_another) {
  // Three marks on one spot, and one at the corner.
  const std::vector<PanelPoint> marks{{2, 2}, {2, 2}, {2, 2}, {0, 0}};
  const std::vector<std::string> labels{"1", "2", "10", "11"};
  const PanelGrid grid{.width_cm = 5, .height_cm = 4};
  const std::vector<PanelPoint> offsets = label_offsets(marks, labels, marks, grid);
  ASSERT_EQ(offsets.size(), 4u);
  for (std::size_t a = 0; a < 4; ++a) {
    const PanelPoint at{marks[a].x + offsets[a].x, marks[a].y + offsets[a].y};
    EXPECT_GT(at.x, 0);
    EXPECT_GT(at.y, 0);
    for (std::size_t b = 0; b < a; ++b) {
      const double across = std::abs(at.x - marks[b].x - offsets[b].x), up = std::abs(at.y - marks[b].y - offsets[b].y);
      // As wide as their texts, 0.3 cm high.
      EXPECT_TRUE(across >= 0.5 * (FigureScript::text_cm(labels[a]) + FigureScript::text_cm(labels[b])) - 1e-9 ||
                  up >= 0.3 - 1e-9)
          << a << " " << b;
    }
  }
}

}  // namespace figure_style_test
