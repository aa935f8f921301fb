#include <gtest/gtest.h>

#include "measure/score/metrics.h"
#include "measure/score/score.h"
#include "small_world.h"

namespace seam_bins_test {
using namespace gnomon;

constexpr std::string_view bins[] = {"0_1", "1_2", "2_4", "4_8", "8_16", "16_32", "32_64", "64_up"};

/// A picture that is right everywhere, with what its pixels show left out.
struct Row {
  int width, height;
  std::vector<PixelClass> classes;
  std::vector<float> reference, mask;
  std::vector<std::uint32_t> parts;
  const GBuffer* gbuffer = nullptr;

  Row(int w, int h)
      : width(w), height(h), classes(w * h, PixelClass::T), reference(w * h, 1.0f), mask(reference), parts(w * h, 1) {}
  Evidence evidence() const {
    return {.width = width,
            .height = height,
            .classes = classes,
            .reference = reference,
            .mask = mask,
            .causes = {},
            .gbuffer = gbuffer,
            .parts = parts};
  }
  std::optional<double> metric(const std::string& name) const {
    const Evidence e = evidence();
    return measure_metric(Scoring(e), name);
  }
  std::optional<double> error(std::string_view bin) const { return metric(fmt::format("{}{}", seam_error_prefix, bin)); }
  std::optional<double> share(std::string_view bin) const { return metric(fmt::format("{}{}", seam_share_prefix, bin)); }
};

/// One row of 100 pixels; the second part begins at column 50.
Row two_parts() {
  Row row(100, 1);
  std::fill(row.parts.begin() + 50, row.parts.end(), 2u);
  return row;
}

// Columns 49 and 50 are beside the seam, at distance 0, and 49 - d and 50 + d are at d. Columns by distance: 0 and 1 four, 2
// two, 3 and 4 four, 5 .. 8 eight, 9 .. 16 sixteen, 17 .. 32 thirty-two, 33 .. 49 thirty-four. Columns 50 .. 53 are off by a
// quarter: at 0 and 1, at 2, at 3.
TEST(seam_bins, errors_and_shares_are_those_of_their_own_columns) {
  Row row = two_parts();
  std::fill(row.mask.begin() + 50, row.mask.begin() + 54, 0.75f);
  const double shares[] = {0.04, 0.02, 0.04, 0.08, 0.16, 0.32, 0.34, 0};
  const double errors[] = {0.125, 0.125, 0.0625, 0, 0, 0, 0};
  double sum = 0;
  for (std::size_t k = 0; k < std::size(bins); ++k) {
    EXPECT_DOUBLE_EQ(row.share(bins[k]).value(), shares[k]) << bins[k];
    if (k < std::size(errors)) {
      EXPECT_DOUBLE_EQ(row.error(bins[k]).value(), errors[k]) << bins[k];
    }
    sum += row.share(bins[k]).value() * row.error(bins[k]).value_or(0);
  }
  EXPECT_EQ(row.error("64_up"), std::nullopt) << "no pixel is as far";
  EXPECT_DOUBLE_EQ(sum, row.metric("error").value()) << "bins add up to the error";
}

TEST(seam_bins, parts_that_no_light_reaches_make_no_seam) {
  for (const auto& spoil : {+[](Row& row) { row.classes[50] = PixelClass::F; }, +[](Row& row) { row.parts[50] = 0; }}) {
    Row row = two_parts();
    spoil(row);
    EXPECT_EQ(row.share("64_up"), 1);
    EXPECT_EQ(row.error("0_1"), std::nullopt);
  }
}

TEST(seam_bins, a_technique_of_one_part_has_none) {
  Row row = two_parts();
  row.parts.clear();
  for (const std::string_view bin : bins) {
    EXPECT_EQ(row.share(bin), std::nullopt);
    EXPECT_EQ(row.error(bin), std::nullopt);
  }
}

TEST(seam_bins, names_tell_what_no_mask_decides) {
  for (const MetricInfo& info : metric_infos())
    EXPECT_EQ(is_of_seams(info.name), info.name.find("_seam_") != info.name.npos || info.name.starts_with("seam_"));
}

/// A plate half a meter thick, a meter above a ground, from straight above: its sides are not seen, and its top covers the
/// middle of the picture.
struct Plate {
  Scene scene;
  GBuffer gbuffer;
  Plate() {
    scene.meshes = {small_world::ground(4), small_world::box({-1, 1, -1}, {1, 1.5f, 1})};
    gbuffer = small_world::make_gbuffer(
        scene, {.eye = {0, 5, 0}, .target = {0, 0, 0}, .up = {0, 0, -1}, .fov_y_degrees = 2 * 26.565051f}, 40, 40);
  }
};

// Ground and top lie 1.5 m apart in height, and a pixel is at most 5 / 40 m wide: what one plane would show in the next pixel
// is not what the other shows. Without the surfaces the same numbers are a seam around the top.
TEST(seam_bins, where_depth_jumps_parts_make_no_seam) {
  const Plate plate;
  Row row(40, 40);
  for (std::size_t i = 0; i < row.parts.size(); ++i) row.parts[i] = plate.gbuffer.mesh[i] + 1;
  EXPECT_GT(row.share("0_1").value(), 0);
  row.gbuffer = &plate.gbuffer;
  EXPECT_EQ(row.share("64_up"), 1);
}

// Parts meet at x = 0 on either surface, between columns 19 and 20: four columns of forty are up to 1 px from there.
TEST(seam_bins, on_one_surface_parts_meet_in_a_seam) {
  const Plate plate;
  Row row(40, 40);
  row.gbuffer = &plate.gbuffer;
  for (std::size_t i = 0; i < row.parts.size(); ++i) row.parts[i] = plate.gbuffer.px[i] < 0 ? 1 : 2;
  EXPECT_DOUBLE_EQ(row.share("0_1").value(), 4.0 / 40);
  EXPECT_DOUBLE_EQ(row.share("16_32").value(), 6.0 / 40);
}

}  // namespace seam_bins_test
