#include "measure/metrics.h"

#include <gnomon/error.h>
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>
#include <unistd.h>

#include <cmath>
#include <set>

#include "measure/score.h"

namespace {

using namespace gnomon;

/// A picture drawn with one letter a pixel: classes B F G S U T; `.` lit and `#` dark; `x` not covered.
std::vector<PixelClass> classes_of(std::string_view drawing) {
  std::vector<PixelClass> classes;
  for (const char c : drawing) classes.push_back(static_cast<PixelClass>(std::string_view("BFGSUT").find(c)));
  return classes;
}
std::vector<float> mask_of(std::string_view drawing) {
  std::vector<float> mask;
  for (const char c : drawing) mask.push_back(c == '#' ? 0.0f : 1.0f);
  return mask;
}
std::vector<std::uint8_t> marks_of(std::string_view drawing) {
  std::vector<std::uint8_t> marks;
  for (const char c : drawing) marks.push_back(c == 'x');
  return marks;
}

std::optional<double> metric(const Tally& tally, std::string_view name) {
  for (const MetricInfo& info : metric_infos())
    if (info.name == name) return info.value(tally);
  ADD_FAILURE() << "no metric " << name;
  return std::nullopt;
}

// Rows of five. Wrong pixels: (1,1) is T, dark for lit: false dark. (3,1) is T, lit for dark: false lit, and not covered.
// (2,2) is U, (1,3) is S, (3,3) is G: wrong, but not tested. (0,0) is B and (4,0) is F: whatever they hold counts nowhere.
const std::vector<PixelClass> classes = classes_of("BTTTFTTTTTTTUTTTSTGTTTTTT");
const std::vector<float> reference = mask_of("........#................");
const std::vector<float> mask = mask_of("#...#.#.....#...#.#......");
const std::vector<std::uint8_t> uncovered = marks_of(".......xx................");

TEST(metrics, tally_counts_tested_and_facing_pixels_apart) {
  const Tally t = tally({5, 5, classes, reference, mask, uncovered});
  EXPECT_EQ(t.facing, 23u);  // 25 less one B and one F
  EXPECT_EQ(t.tested, 20u);  // less U, S and G
  EXPECT_EQ(t.wrong, 2u);
  EXPECT_EQ(t.wrong_facing, 5u);
  EXPECT_EQ(t.false_dark, 1u);
  EXPECT_EQ(t.false_lit, 1u);
  EXPECT_EQ(t.beyond_coverage, 1u);  // the right pixel that is not covered either is no error
  EXPECT_EQ(t.error_sum, 2);
  EXPECT_DOUBLE_EQ(*metric(t, "wrong_rate"), 2.0 / 20);
  EXPECT_DOUBLE_EQ(*metric(t, "wrong_rate_all"), 5.0 / 23);
  EXPECT_DOUBLE_EQ(*metric(t, "false_dark_rate"), 1.0 / 20);
  EXPECT_DOUBLE_EQ(*metric(t, "false_lit_rate"), 1.0 / 20);
  EXPECT_DOUBLE_EQ(*metric(t, "beyond_coverage"), 1.0 / 20);
  EXPECT_DOUBLE_EQ(*metric(t, "error_mean"), 2.0 / 20);
  EXPECT_DOUBLE_EQ(*metric(t, "tested_share"), 20.0 / 23);
}

TEST(metrics, verdicts_name_every_tested_pixel_and_only_those) {
  const std::vector<Verdict> v = verdicts({5, 5, classes, reference, mask, uncovered});
  for (std::size_t i = 0; i < v.size(); ++i) {
    const Verdict due = i == 6                        ? Verdict::false_dark
                        : i == 8                      ? Verdict::beyond_coverage
                        : classes[i] == PixelClass::T ? Verdict::right
                                                      : Verdict::untested;
    EXPECT_EQ(v[i], due) << i;
  }
  EXPECT_EQ(verdicts({5, 5, classes, reference, mask, {}})[8], Verdict::false_lit) << "covers all";
}

TEST(metrics, wrong_is_off_by_more_than_one_half) {
  const std::vector<PixelClass> all(4, PixelClass::T);
  const std::vector<float> truth{1, 1, 0, 0}, answer{0.5f, 0.49f, 0.5f, 0.51f};
  const Tally t = tally({4, 1, all, truth, answer, {}});
  EXPECT_EQ(t.wrong, 2u);
  EXPECT_EQ(t.false_dark, 1u);
  EXPECT_EQ(t.false_lit, 1u);
  EXPECT_NEAR(*metric(t, "error_mean"), (0.5 + 0.51 + 0.5 + 0.51) / 4, 1e-7);
}

TEST(metrics, nothing_tested_leaves_rates_undefined) {
  const std::vector<PixelClass> background(4, PixelClass::B);
  const std::vector<float> lit(4, 1.0f);
  const Tally t = tally({2, 2, background, lit, lit, {}});
  for (const char* name : {"wrong_rate", "wrong_rate_all", "false_dark_rate", "error_mean", "tested_share"})
    EXPECT_EQ(metric(t, name), std::nullopt) << name;
  EXPECT_EQ(metric(t, "displacement_mean"), 0) << "no boundary on either side: nothing is displaced";
}

TEST(metrics, rows_have_unique_names_a_direction_and_a_sentence) {
  std::set<std::string_view> names;
  for (const MetricInfo& info : metric_infos()) {
    EXPECT_TRUE(names.insert(info.name).second) << info.name;
    EXPECT_FALSE(info.name.empty());
    EXPECT_TRUE(info.sentence.ends_with('.')) << info.name;
    EXPECT_FALSE(std::islower(info.sentence.front())) << info.name;
    EXPECT_TRUE(info.better == "lower" || info.better == "higher" || info.better.empty()) << info.name;
    EXPECT_TRUE(info.value != nullptr);
  }
  EXPECT_EQ(measure_metrics(Tally{}).size(), names.size());
}

/// Lit left of `edge`, dark from it on.
std::vector<float> half_plane(int width, int height, int edge) {
  std::vector<float> lit_left;
  for (int i = 0; i < width * height; ++i) lit_left.push_back(i % width < edge ? 1.0f : 0.0f);
  return lit_left;
}

TEST(displacement, an_edge_moved_by_k_pixels_is_displaced_by_k) {
  // The dark rims are the columns 20 and 20 + k: every pixel of either is k from the other, so mean and percentile are k.
  constexpr int w = 40, h = 7;
  const std::vector<PixelClass> all(w * h, PixelClass::T);
  for (const int k : {-9, -1, 0, 1, 2, 15}) {
    const auto truth = half_plane(w, h, 20), moved = half_plane(w, h, 20 + k);
    const Tally t = tally({w, h, all, truth, moved, {}});
    EXPECT_DOUBLE_EQ(t.displacement_mean.value(), std::abs(k));
    EXPECT_DOUBLE_EQ(t.displacement_p95.value(), std::abs(k));
  }
}

TEST(displacement, a_missing_shadow_has_no_displacement) {
  const std::vector<PixelClass> all(100, PixelClass::T);
  const auto shadow = half_plane(10, 10, 5), none = half_plane(10, 10, 10);
  EXPECT_EQ(tally({10, 10, all, shadow, none, {}}).displacement_mean, std::nullopt);
  EXPECT_EQ(tally({10, 10, all, none, shadow, {}}).displacement_p95, std::nullopt);
}

TEST(displacement, the_95th_percentile_tells_a_small_far_shadow_from_a_shifted_edge) {
  // The edge is right for all 100 rows: 200 distances of 0. One false dark pixel 10 from the edge adds one distance of 10:
  // the mean is 10/201, the percentile still 0.
  constexpr int w = 40, h = 100;
  const std::vector<PixelClass> all(w * h, PixelClass::T);
  const auto truth = half_plane(w, h, 20);
  auto speckled = truth;
  speckled[50 * w + 10] = 0;
  const Tally t = tally({w, h, all, truth, speckled, {}});
  EXPECT_DOUBLE_EQ(t.displacement_mean.value(), 10.0 / 201);
  EXPECT_EQ(t.displacement_p95, 0);
}

TEST(boundary, both_sides_are_marked_and_only_pixels_that_face_the_light) {
  // The step between column 1 and 2 marks both; where one of the two is of class B or F there is no boundary.
  const auto marked = shadow_boundary(mask_of("..##"
                                              "..##"
                                              "..##"),
                                      classes_of("TTTT"
                                                 "TFTT"
                                                 "GUST"),
                                      4, 3);
  EXPECT_EQ(marked, marks_of(".xx."
                             "...."
                             ".xx."));
  // Diagonal neighbors do not count: the dark corner marks itself and its two 4-neighbors.
  EXPECT_EQ(shadow_boundary(mask_of("#........"), classes_of("TTTTTTTTT"), 3, 3), marks_of("xx.x....."));
  // The last pixel of a row and the first of the next are no neighbors.
  EXPECT_EQ(shadow_boundary(mask_of("..##"), classes_of("TTTT"), 4, 1), marks_of(".xx."));
  EXPECT_EQ(shadow_boundary(mask_of("..##"), classes_of("TTTT"), 2, 2), marks_of("xxxx"));
}

RC_GTEST_PROP(distance_transform, equals_the_nearest_marked_pixel_by_brute_force, ()) {
  const int w = *rc::gen::inRange(1, 24), h = *rc::gen::inRange(1, 24), one_in = *rc::gen::inRange(1, 60);
  const auto marked = *rc::gen::container<std::vector<std::uint8_t>>(
      w * h, rc::gen::map(rc::gen::inRange(0, one_in), [](int draw) { return static_cast<std::uint8_t>(draw == 0); }));
  const std::vector<float> distance = distance_transform(marked, w, h);
  for (int i = 0; i < w * h; ++i) {
    int least = INT_MAX;
    for (int j = 0; j < w * h; ++j)
      if (marked[j]) least = std::min(least, (i % w - j % w) * (i % w - j % w) + (i / w - j / w) * (i / w - j / w));
    // Squares below 2^24 and one correctly rounded root: equal, not near.
    RC_ASSERT(distance[i] == (least == INT_MAX ? INFINITY : static_cast<float>(std::sqrt(static_cast<double>(least)))));
  }
}

TEST(distance_transform, none_marked_is_infinite_and_all_marked_is_zero) {
  for (const float d : distance_transform(std::vector<std::uint8_t>(35, 0), 7, 5)) EXPECT_EQ(d, INFINITY);
  for (const float d : distance_transform(std::vector<std::uint8_t>(35, 1), 7, 5)) EXPECT_EQ(d, 0);
}

TEST(distance_transform, is_exact_in_pictures_whose_squares_exceed_float32) {
  // 16000^2 has 28 bits: in float32 the parabolas of neighbors at the far end could not be told apart.
  constexpr int w = 16384;
  std::vector<std::uint8_t> marked(w, 0);
  for (int x = 16000; x < w; x += 3) marked[x] = 1;
  const std::vector<float> distance = distance_transform(marked, w, 1);
  for (int x = 16000; x < w - 3; ++x) EXPECT_EQ(distance[x], (x - 16000) % 3 == 0 ? 0 : 1) << x;
  EXPECT_EQ(distance[0], 16000);
}

TEST(score, class_counts_name_every_class) {
  const auto counts = class_counts(classes);
  EXPECT_EQ(counts.size(), 6u);
  EXPECT_EQ(counts.at("B") + counts.at("F") + counts.at("G") + counts.at("S") + counts.at("U"), 5u);
  EXPECT_EQ(counts.at("T"), 20u);
}

TEST(score, a_mask_file_of_the_wrong_size_or_with_a_wild_value_is_refused) {
  const auto file = std::filesystem::temp_directory_path() / fmt::format("gnomon_mask_{}", getpid());
  const auto written = [&](const std::vector<float>& values) {
    write_file(file, std::as_bytes(std::span(values)));
    return read_mask_file(file, 3);
  };
  EXPECT_EQ(written({0, 0.5f, 1}), (std::vector<float>{0, 0.5f, 1}));
  EXPECT_THROW(written({0, 1}), Error);
  EXPECT_THROW(written({0, 1, 1, 1}), Error);
  for (const float wild : {-0.001f, 1.001f, NAN, INFINITY}) EXPECT_THROW(written({0, wild, 1}), Error) << wild;
  std::filesystem::remove(file);
}

}  // namespace
