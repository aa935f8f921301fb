#include <gnomon/error.h>
#include <gtest/gtest.h>

#include <set>

#include "measure/cause/causes.h"
#include "measure/cause/color_vision.h"

namespace cause_rows_test {

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
  const std::vector<float> numbers{0, 4, 5, 6, 19};
  const std::vector<Cause> today = causes_from_numbers(numbers, {});
  EXPECT_EQ(today, (std::vector{Cause::none, Cause::tessellation, Cause::beyond_coverage, Cause::formula, Cause::region}));
  std::map<std::string, std::uint64_t> counts = count_causes({});
  EXPECT_EQ(causes_from_numbers(numbers, counts), today);
  EXPECT_EQ(causes_from_numbers(std::vector{31.0f}, counts), std::vector{Cause::unexplained});
  // Before lights with area had causes, the last but one was `penumbra`, which no pixel of a hard shadow has.
  std::map<std::string, std::uint64_t> older{{"penumbra", 0}};
  // It knew neither whole masks nor the width of filters, nor that an edge may be of no rasterizer.
  for (const CauseInfo& info : cause_infos())
    if (info.cause >= Cause::tessellation && info.cause != Cause::filter_width && info.cause != Cause::edge &&
        (info.cause < Cause::reference_error || info.cause == Cause::unexplained))
      older[std::string(info.name)] = 0;
  EXPECT_EQ(causes_from_numbers(std::vector{14.0f, 16.0f}, older), (std::vector{Cause::region, Cause::unexplained}));
  older.erase("formula");
  EXPECT_EQ(causes_from_numbers(std::vector{2.0f, 3.0f, 15.0f}, older),
            (std::vector{Cause::beyond_coverage, Cause::missing_caster, Cause::unexplained}));
  for (const float number : {-1.0f, 0.5f, 16.0f, NAN})
    EXPECT_THROW(causes_from_numbers(std::vector{number}, older), Error) << number;
}

TEST(cause_rows, colors_stay_apart_for_color_blind_readers_and_from_the_gray_below) {
  // A difference of 2.3 is just noticeable side by side. Lights with area have twice as many causes: theirs are nearer, and so
  // are those of a whole mask, of which a picture has one.
  const auto is_soft = [](const CauseInfo& of) {
    return of.cause < Cause::tessellation || (of.cause >= Cause::reference_error && of.cause < Cause::unexplained);
  };
  for (const glm::dmat3& vision : color_vision::visions)
    for (const CauseInfo& a : cause_infos()) {
      for (const CauseInfo& b : cause_infos().subspan(static_cast<std::size_t>(a.cause)))
        EXPECT_GT(glm::distance(color_vision::lab(a.color, vision), color_vision::lab(b.color, vision)),
                  is_soft(a) || is_soft(b) ? 14 : 19)
            << a.name << ' ' << b.name;
      // Right pixels have grays from 70 to 172, untested ones from 20 to 71.
      for (int gray = 20; gray <= 172; ++gray) {
        const auto g = static_cast<std::uint8_t>(gray);
        EXPECT_GT(glm::distance(color_vision::lab(a.color, vision), color_vision::lab({g, g, g}, vision)), is_soft(a) ? 14 : 19)
            << a.name << ' ' << gray;
      }
    }
}

}  // namespace cause_rows_test
