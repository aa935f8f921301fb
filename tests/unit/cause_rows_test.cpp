#include <gnomon/error.h>
#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "measure/cause/causes.h"

namespace {

using namespace gnomon;

TEST(cause_rows, every_cause_has_one_row_in_its_order_with_a_name_a_sentence_and_a_color) {
  std::set<std::string_view> names;
  std::uint8_t next = 1;
  for (const CauseInfo& info : cause_infos()) {
    EXPECT_EQ(static_cast<std::uint8_t>(info.cause), next++);
    EXPECT_EQ(name(info.cause), info.name);
    EXPECT_TRUE(names.insert(info.name).second);
    EXPECT_TRUE(info.sentence.ends_with('.'));
  }
  EXPECT_EQ(static_cast<Cause>(next - 1), Cause::unexplained);
  EXPECT_EQ(name(Cause::none), "none");
  EXPECT_EQ(count_causes({}).size(), names.size());
}

// A run made before `formula` was a cause counted the others, and numbered those that came after it one lower.
TEST(cause_rows, numbers_in_pictures_count_the_causes_that_their_record_knows) {
  const std::vector<float> numbers{0, 1, 2, 3, 15};
  const std::vector<Cause> today = causes_from_numbers(numbers, {});
  EXPECT_EQ(today, (std::vector{Cause::none, Cause::tessellation, Cause::beyond_coverage, Cause::formula, Cause::penumbra}));
  std::map<std::string, std::uint64_t> counts = count_causes({});
  EXPECT_EQ(causes_from_numbers(numbers, counts), today);
  EXPECT_EQ(causes_from_numbers(std::vector{16.0f}, counts), std::vector{Cause::unexplained});
  counts.erase("formula");
  EXPECT_EQ(causes_from_numbers(numbers, counts),
            (std::vector{Cause::none, Cause::tessellation, Cause::beyond_coverage, Cause::missing_caster, Cause::unexplained}));
  for (const float number : {-1.0f, 0.5f, 16.0f, NAN})
    EXPECT_THROW(causes_from_numbers(std::vector{number}, counts), Error) << number;
}

// What a color looks like to people with one kind of cone missing (Machado, Oliveira and Fernandes 2009, severity 1), in CIE
// Lab.
glm::dvec3 lab(const std::array<std::uint8_t, 3>& rgb, const glm::dmat3& vision) {
  glm::dvec3 linear;
  for (int c = 0; c < 3; ++c) {
    const double v = rgb[c] / 255.0;
    linear[c] = v <= 0.04045 ? v / 12.92 : std::pow((v + 0.055) / 1.055, 2.4);
  }
  linear = glm::clamp(linear * vision, 0.0, 1.0);  // rows are stored as columns
  const glm::dmat3 xyz(0.4124, 0.3576, 0.1805, 0.2126, 0.7152, 0.0722, 0.0193, 0.1192, 0.9505);
  glm::dvec3 f = linear * xyz / glm::dvec3(0.95047, 1, 1.08883);
  for (int c = 0; c < 3; ++c) f[c] = f[c] > 0.008856 ? std::cbrt(f[c]) : 7.787 * f[c] + 16.0 / 116;
  return {116 * f.y - 16, 500 * (f.x - f.y), 200 * (f.y - f.z)};
}

TEST(cause_rows, colors_stay_apart_for_color_blind_readers_and_from_the_gray_below) {
  const glm::dmat3 visions[] = {
      glm::dmat3(1),
      {0.152286, 1.052583, -0.204868, 0.114503, 0.786281, 0.099216, -0.003882, -0.048116, 1.051998},
      {0.367322, 0.860646, -0.227968, 0.280085, 0.672501, 0.047413, -0.011820, 0.042940, 0.968881},
      {1.255528, -0.076749, -0.178779, -0.078411, 0.930809, 0.147602, 0.004733, 0.691367, 0.303900},
  };
  // A difference of 2.3 is just noticeable side by side.
  constexpr double least = 19;
  for (const glm::dmat3& vision : visions)
    for (const CauseInfo& a : cause_infos()) {
      for (const CauseInfo& b : cause_infos().subspan(static_cast<std::size_t>(a.cause)))
        EXPECT_GT(glm::distance(lab(a.color, vision), lab(b.color, vision)), least) << a.name << ' ' << b.name;
      // Right pixels have grays from 70 to 172, untested ones from 20 to 71.
      for (int gray = 20; gray <= 172; ++gray) {
        const auto g = static_cast<std::uint8_t>(gray);
        EXPECT_GT(glm::distance(lab(a.color, vision), lab({g, g, g}, vision)), least) << a.name << ' ' << gray;
      }
    }
}

}  // namespace
