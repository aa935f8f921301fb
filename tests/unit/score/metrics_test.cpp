#include "measure/score/metrics.h"

#include <gnomon/error.h>
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>
#include <unistd.h>

#include <cmath>
#include <numbers>
#include <set>

#include "measure/frame/boundary.h"
#include "measure/score/memory_score.h"
#include "measure/score/over_time.h"
#include "measure/score/score.h"

namespace metrics_test {

using namespace gnomon;

/// A picture drawn with one letter a pixel: classes B F G S U T; `.` lit and `#` dark; `x` marked.
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

Evidence evidence(int width, int height, std::span<const PixelClass> classes, std::span<const float> reference,
                  std::span<const float> mask) {
  return {.width = width, .height = height, .classes = classes, .reference = reference, .mask = mask, .causes = {}};
}

std::optional<double> metric(const Scoring& scoring, std::string_view name) {
  for (const MetricInfo& info : metric_infos())
    if (info.name == name) return info.value(scoring);
  ADD_FAILURE() << "no metric " << name;
  return std::nullopt;
}
std::optional<double> metric(const Evidence& e, std::string_view name) { return metric(Scoring(e), name); }

// Rows of five. Wrong pixels: (1,1) is T, dark for lit: false dark. (3,1) is T, lit for dark: false lit.
// (2,2) is U, (1,3) is S, (3,3) is G: wrong, but not tested. (0,0) is B and (4,0) is F: whatever they hold counts nowhere.
const std::vector<PixelClass> classes = classes_of("BTTTFTTTTTTTUTTTSTGTTTTTT");
const std::vector<float> reference = mask_of("........#................");
const std::vector<float> mask = mask_of("#...#.#.....#...#.#......");

TEST(metrics, tally_counts_tested_and_facing_pixels_apart) {
  const Evidence e = evidence(5, 5, classes, reference, mask);
  const Scoring s(e);
  const ErrorCounts t = s.error_counts();
  EXPECT_EQ(t.facing, 23u);  // 25 less one B and one F
  EXPECT_EQ(t.tested, 20u);  // less U, S and G
  EXPECT_EQ(t.wrong, 2u);
  EXPECT_EQ(t.wrong_facing, 5u);
  EXPECT_EQ(t.false_dark, 1u);
  EXPECT_EQ(t.false_lit, 1u);
  EXPECT_EQ(t.error_sum, 2);
  EXPECT_DOUBLE_EQ(*metric(s, "wrong_rate"), 2.0 / 20);
  EXPECT_DOUBLE_EQ(*metric(s, "wrong_rate_all"), 5.0 / 23);
  EXPECT_DOUBLE_EQ(*metric(s, "false_dark_rate"), 1.0 / 20);
  EXPECT_DOUBLE_EQ(*metric(s, "false_lit_rate"), 1.0 / 20);
  EXPECT_DOUBLE_EQ(*metric(s, "error"), 2.0 / 20);
  EXPECT_DOUBLE_EQ(*metric(s, "tested_share"), 20.0 / 23);
}

// One half is dark: wrong where the reference is lit.
TEST(metrics, wrong_is_on_the_other_side_of_one_half) {
  const std::vector<PixelClass> all(4, PixelClass::T);
  const std::vector<float> truth{1, 1, 0, 0}, answer{0.5f, 0.51f, 0.5f, 0.51f};
  const Evidence e = evidence(4, 1, all, truth, answer);
  for (int i = 0; i < 4; ++i) EXPECT_EQ(e.is_wrong(i), is_lit(answer[i]) != is_lit(truth[i])) << i;
  const ErrorCounts t = Scoring(e).error_counts();
  EXPECT_EQ(t.wrong, 2u);
  EXPECT_EQ(t.false_dark, 1u);
  EXPECT_EQ(t.false_lit, 1u);
  EXPECT_NEAR(*metric(e, "error"), (0.5 + 0.49 + 0.5 + 0.51) / 4, 1e-7);
}

TEST(metrics, nothing_tested_leaves_rates_undefined) {
  const std::vector<PixelClass> background(4, PixelClass::B);
  const std::vector<float> lit(4, 1.0f);
  const Evidence e = evidence(2, 2, background, lit, lit);
  for (const char* name : {"wrong_rate", "wrong_rate_all", "false_dark_rate", "error", "tested_share", "wrong_rate_edge_0_1",
                           "wrong_rate_edge_8_up", "penumbra_error_mean"})
    EXPECT_EQ(metric(e, name), std::nullopt) << name;
  EXPECT_EQ(metric(e, "displacement_mean"), 0) << "no boundary on either side: nothing is displaced";
}

TEST(metrics, rows_have_unique_names_a_direction_and_a_sentence) {
  std::set<std::string_view> names;
  for (const MetricInfo& info : metric_infos()) {
    EXPECT_TRUE(names.insert(info.name).second) << info.name;
    EXPECT_FALSE(info.name.empty());
    EXPECT_TRUE(info.sentence.ends_with('.')) << info.name;
    EXPECT_FALSE(std::islower(info.sentence.front())) << info.name;
    EXPECT_TRUE(info.better == "lower" || info.better == "higher" || info.better.empty()) << info.name;
    EXPECT_EQ(info.value == nullptr, info.of >= MetricInfo::Of::row) << info.name;
  }
  const Metrics of_a_frame = measure_metrics(Scoring(Evidence{}));
  EXPECT_EQ(of_a_frame.size() + no_metrics_over_time().size() + MemoryScore().metrics().size(), names.size());
  for (const auto& [metric, value] : no_metrics_over_time()) EXPECT_FALSE(of_a_frame.contains(metric)) << metric;
}

TEST(metrics, instability_alone_is_of_two_frames) {
  for (const MetricInfo& info : metric_infos())
    EXPECT_EQ(info.of == MetricInfo::Of::two_frames, info.name == "instability") << info.name;
  EXPECT_EQ(metric_is_of("instability"), MetricInfo::Of::two_frames);
  EXPECT_EQ(metric_is_of("temporal_sd"), MetricInfo::Of::row);
  EXPECT_EQ(metric_is_of("of another version"), MetricInfo::Of::frame);
}

/// Lit left of `edge`, dark from it on.
std::vector<float> half_plane(int width, int height, int edge) {
  std::vector<float> lit_left;
  for (int i = 0; i < width * height; ++i) lit_left.push_back(i % width < edge ? 1.0f : 0.0f);
  return lit_left;
}

TEST(metrics, wrong_rates_by_distance_look_at_their_own_pixels_only) {
  // 40 columns, the shadow begins at column 20: 19 and 20 are beside the boundary, at distance 0, and column 20 + d is at d.
  // Columns by distance: 0 .. 1 four, 2 two, 3 and 4 four, 5 .. 8 eight, beyond 8 twenty-two. One column of each is wrong: the
  // last one that belongs to it, and the first one beyond 8.
  constexpr int w = 40, h = 10;
  const std::vector<PixelClass> all(w * h, PixelClass::T);
  const auto truth = half_plane(w, h, 20);
  auto answer = truth;
  for (int y = 0; y < h; ++y)
    for (const int d : {1, 2, 4, 8, 9}) answer[y * w + 20 + d] = 1;
  const Evidence e = evidence(w, h, all, truth, answer);
  EXPECT_EQ(metric(e, "wrong_rate_edge_0_1"), 1.0 / 4);
  EXPECT_EQ(metric(e, "wrong_rate_edge_1_2"), 1.0 / 2);
  EXPECT_EQ(metric(e, "wrong_rate_edge_2_4"), 1.0 / 4);
  EXPECT_EQ(metric(e, "wrong_rate_edge_4_8"), 1.0 / 8);
  EXPECT_EQ(metric(e, "wrong_rate_edge_8_up"), 1.0 / 22);
  // Without a boundary everything is beyond.
  const std::vector<float> lit(w * h, 1.0f);
  const Evidence open = evidence(w, h, all, lit, answer);
  EXPECT_EQ(metric(open, "wrong_rate_edge_0_1"), std::nullopt);
  EXPECT_EQ(metric(open, "wrong_rate_edge_8_up"), metric(open, "wrong_rate"));
}

/// A floor at y = 0 with arrays of its own, seen from above: pixel x is the point (x, 0, 0).
struct Floor {
  std::vector<float> px, zero, ny;
  std::vector<std::uint32_t> mesh;
  GBuffer gbuffer;
  explicit Floor(int n) : zero(n, 0.0f), ny(n, 1.0f), mesh(n, 0) {
    for (int x = 0; x < n; ++x) px.push_back(static_cast<float>(x));
    gbuffer.width = n, gbuffer.height = 1;
    gbuffer.px = px, gbuffer.py = zero, gbuffer.pz = zero;
    gbuffer.nx = zero, gbuffer.ny = ny, gbuffer.nz = zero;
    gbuffer.mesh = gbuffer.triangle = mesh;
  }
};

TEST(metrics, wrong_rates_by_angle_follow_the_elevation_of_the_light) {
  // The light is 1 above the floor at x = 0, so that it meets pixel x at atan(1 / x): 90 degrees at 0, 45 at 1, 26.6 at 2,
  // 11.3 at 5, 9.46 at 6. Pixels 0 | 1 | 2 .. 5 | 6 .. 9 fill the bins from above; 1, 3 and 9 are wrong.
  const Floor floor(10);
  const Light light{.name = "point", .kind = PointLight{{0, 1, 0}}};
  const std::vector<PixelClass> all(10, PixelClass::T);
  const auto truth = mask_of(".........."), answer = mask_of(".#.#.....#");
  Evidence e = evidence(10, 1, all, truth, answer);
  EXPECT_EQ(metric(e, "wrong_rate_angle_60_90"), std::nullopt) << "no G-buffer, no angle";
  e.gbuffer = &floor.gbuffer;
  e.light = &light;
  EXPECT_EQ(metric(e, "wrong_rate_angle_60_90"), 0);
  EXPECT_EQ(metric(e, "wrong_rate_angle_30_60"), 1);
  EXPECT_EQ(metric(e, "wrong_rate_angle_10_30"), 0.25);
  EXPECT_EQ(metric(e, "wrong_rate_angle_2_10"), 0.25);
}

TEST(metrics, instability_counts_what_changes_in_the_technique_alone) {
  // Eight pixels, the last of class U in the first frame: seven count. The reference's edge moves from 4 to 5; so pixel 4
  // changes in both. Pixel 1 changes in the technique alone: unstable. Pixel 6 is wrong in both frames: no change. Pixel 2
  // stays where the reference changes nothing.
  const auto then_classes = classes_of("TTTTTTTU"), now_classes = classes_of("TTTTTTTT");
  const auto then_truth = mask_of("....####"), then = mask_of("....##.#");
  const auto now_truth = mask_of(".....###"), now = mask_of(".#...#..");
  const Evidence before = evidence(8, 1, then_classes, then_truth, then);
  Evidence e = evidence(8, 1, now_classes, now_truth, now);
  EXPECT_EQ(metric(e, "instability"), std::nullopt) << "nothing before";
  e.previous = &before;
  EXPECT_EQ(metric(e, "instability"), 1.0 / 7);
}

TEST(displacement, an_edge_moved_by_k_pixels_is_displaced_by_k) {
  // The dark rims are the columns 20 and 20 + k: every pixel of either is k from the other, so mean and percentile are k.
  constexpr int w = 40, h = 7;
  const std::vector<PixelClass> all(w * h, PixelClass::T);
  for (const int k : {-9, -1, 0, 1, 2, 15}) {
    const auto truth = half_plane(w, h, 20), moved = half_plane(w, h, 20 + k);
    const Displacement d = Scoring(evidence(w, h, all, truth, moved)).displacement();
    EXPECT_DOUBLE_EQ(d.mean.value(), std::abs(k));
    EXPECT_DOUBLE_EQ(d.p95.value(), std::abs(k));
  }
}

TEST(displacement, a_missing_shadow_has_no_displacement) {
  const std::vector<PixelClass> all(100, PixelClass::T);
  const auto shadow = half_plane(10, 10, 5), none = half_plane(10, 10, 10);
  EXPECT_EQ(Scoring(evidence(10, 10, all, shadow, none)).displacement().mean, std::nullopt);
  EXPECT_EQ(Scoring(evidence(10, 10, all, none, shadow)).displacement().p95, std::nullopt);
}

TEST(displacement, the_95th_percentile_tells_a_small_far_shadow_from_a_shifted_edge) {
  // The edge is right for all 100 rows: 200 distances of 0. One false dark pixel 10 from the edge adds one distance of 10:
  // the mean is 10/201, the percentile still 0.
  constexpr int w = 40, h = 100;
  const std::vector<PixelClass> all(w * h, PixelClass::T);
  const auto truth = half_plane(w, h, 20);
  auto speckled = truth;
  speckled[50 * w + 10] = 0;
  const Displacement d = Scoring(evidence(w, h, all, truth, speckled)).displacement();
  EXPECT_DOUBLE_EQ(d.mean.value(), 10.0 / 201);
  EXPECT_EQ(d.p95, 0);
}

// --- soft shadows: a penumbra along x, from lit to dark over `width` pixels around `middle` ------------------------------

constexpr int soft_width = 80, soft_height = 30;
const std::vector<PixelClass> soft_classes(soft_width* soft_height, PixelClass::T);

std::vector<float> ramp(double middle, double width, double degrees = 0) {
  const double c = std::cos(degrees * std::numbers::pi / 180), s = std::sin(degrees * std::numbers::pi / 180);
  std::vector<float> v;
  for (int y = 0; y < soft_height; ++y)
    for (int x = 0; x < soft_width; ++x)
      v.push_back(static_cast<float>(std::clamp(0.5 - ((x - middle) * c + (y - soft_height / 2) * s) / width, 0.0, 1.0)));
  return v;
}

Evidence soft(const std::vector<float>& truth, const std::vector<float>& answer) {
  return evidence(soft_width, soft_height, soft_classes, truth, answer);
}

TEST(soft_shadows, are_measured_only_where_the_reference_is_soft) {
  const auto truth = half_plane(soft_width, soft_height, 40), answer = ramp(40, 10);
  for (const MetricInfo& info : metric_infos())
    if (info.name.starts_with("penumbra") || info.name.starts_with("outside") || info.name.starts_with("umbra")) {
      EXPECT_EQ(info.value(Scoring(soft(truth, answer))), std::nullopt) << info.name;
      EXPECT_TRUE(metric(soft(answer, truth), "penumbra_error_mean").has_value());
    }
}

TEST(soft_shadows, an_equal_mask_has_no_error_and_every_ratio_is_one) {
  const auto truth = ramp(40.3, 10, 20);
  const Evidence e = soft(truth, truth);
  for (const char* name : {"penumbra_error_mean", "penumbra_error_rms", "outside_error_mean", "outside_error_rms"})
    EXPECT_EQ(metric(e, name), 0) << name;
  for (const char* name : {"umbra_area_ratio", "penumbra_area_ratio", "penumbra_width_ratio"})
    EXPECT_EQ(metric(e, name), 1) << name;
  EXPECT_EQ(metric(e, "penumbra_shift"), 0);
}

TEST(soft_shadows, areas_and_errors_of_ramps_are_those_on_paper) {
  // Middle 39.5, width 10: V(x) = 0.5 - (x - 39.5) / 10 at the columns 35 .. 44 is 0.95, 0.85 ... 0.05: ten columns of
  // penumbra, 45 and on dark. Width 20: columns 30 .. 49: 0.975 ... 0.025: twenty; umbra from 50: 30 columns to the
  // reference's 35.
  const auto truth = ramp(39.5, 10), answer = ramp(39.5, 20);
  const Evidence e = soft(truth, answer);
  EXPECT_DOUBLE_EQ(*metric(e, "penumbra_area_ratio"), 2);
  EXPECT_DOUBLE_EQ(*metric(e, "umbra_area_ratio"), 30.0 / 35);
  // |difference| at distance u = 0.5, 1.5 ... from the middle: u/20 up to u = 4.5, then 0.5 - u/20 up to 9.5, on both sides.
  // The band holds columns 33 .. 46, u up to 6.5.
  double sum = 0, squares = 0, out = 0;
  for (double u = 0.5; u < 7; ++u) {
    const double d = u < 5 ? u / 20 : 0.5 - u / 20;
    sum += d, squares += d * d;
  }
  for (double u = 7.5; u < 10; ++u) out += 0.5 - u / 20;
  EXPECT_NEAR(*metric(e, "penumbra_error_mean"), sum / 7, 1e-6);
  EXPECT_NEAR(*metric(e, "penumbra_error_rms"), std::sqrt(squares / 7), 1e-6);
  EXPECT_NEAR(*metric(e, "outside_error_mean"), 2 * out / (soft_width - 14), 1e-6);
}

TEST(soft_shadows, noise_is_what_a_median_removes) {
  // A straight ramp is its own median. One pixel in nine off by 0.1 is always outvoted: of the pixels whose window is inside,
  // a ninth leave 0.1 and the rest what the median of 25 values moves by the outliers, less than one step of the ramp (0.02).
  const auto truth = ramp(40, 50);
  EXPECT_NEAR(*metric(soft(truth, truth), "penumbra_noise"), 0, 1e-6);
  auto noisy = truth;
  for (int y = 0; y < soft_height; y += 3)
    for (int x = 0; x < soft_width; x += 3) noisy[y * soft_width + x] = std::max(0.0f, noisy[y * soft_width + x] - 0.1f);
  EXPECT_NEAR(*metric(soft(truth, noisy), "penumbra_noise"), 0.1 / 3, 0.01);
}

TEST(boundary, both_sides_are_marked_and_only_pixels_that_face_the_light) {
  // The step between column 1 and 2 marks both; where one of the two is of class B or F there is no boundary.
  const auto marked = shadow_boundary(mask_of("..##..##..##"), classes_of("TTTTTFTTGUST"), 4, 3);
  EXPECT_EQ(marked, marks_of(".xx......xx."));
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

RC_GTEST_PROP(nearest_marked, names_a_marked_pixel_at_the_least_distance, ()) {
  const int w = *rc::gen::inRange(1, 24), h = *rc::gen::inRange(1, 24), one_in = *rc::gen::inRange(1, 60);
  const auto marked = *rc::gen::container<std::vector<std::uint8_t>>(
      w * h, rc::gen::map(rc::gen::inRange(0, one_in), [](int draw) { return static_cast<std::uint8_t>(draw == 0); }));
  const std::vector<float> distance = distance_transform(marked, w, h);
  const std::vector<std::int32_t> nearest = nearest_marked(marked, w, h);
  for (int i = 0; i < w * h; ++i) {
    RC_ASSERT((nearest[i] < 0) == std::isinf(distance[i]));
    if (nearest[i] < 0) continue;
    RC_ASSERT(marked[nearest[i]] == 1);
    RC_ASSERT(static_cast<float>(std::hypot(i % w - nearest[i] % w, i / w - nearest[i] / w)) == distance[i]);
  }
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

}  // namespace metrics_test
