// Bits of alpha masks: the threshold, the words, the wraps and the finer grid.
#include <gnomon/alpha_mask.h>
#include <gnomon/error.h>
#include <gtest/gtest.h>

#include <cmath>

#include "masked.h"
#include "rational_holes.h"

namespace gnomon::alpha_mask_test {

using Wrap = AlphaMask::Wrap;

/// All 256 bytes in a row: which are solid, from the first one on.
int first_solid(float factor, float cutoff) {
  std::vector<std::uint8_t> bytes(256);
  for (int k = 0; k < 256; ++k) bytes[k] = static_cast<std::uint8_t>(k);
  const AlphaMask mask(256, 1, bytes, factor, cutoff);
  int first = 0;
  while (first < 256 && !mask.is_solid(first, 0)) ++first;
  for (int k = first; k < 256; ++k) EXPECT_TRUE(mask.is_solid(k, 0)) << k;
  EXPECT_DOUBLE_EQ(mask.coverage(), (256 - first) / 256.0);
  return first;
}

// 127 / 255 is below 0.5 and 128 / 255 above it. 160 / 255 * 0.8 = 0.50196 and 159 / 255 * 0.8 = 0.49882. 51 / 255 is the
// float32 that 0.2f is, though 255 * 0.2f = 51.00000076 is above 51.
TEST(alpha_mask, a_texel_is_solid_by_one_comparison_in_float32) {
  EXPECT_EQ(first_solid(1, 0.5f), 128);
  EXPECT_EQ(first_solid(0.8f, 0.5f), 160);
  EXPECT_EQ(first_solid(1, 0.2f), 51);
  EXPECT_EQ(first_solid(1, 0), 0);
  EXPECT_EQ(first_solid(0, 0), 0);
  EXPECT_EQ(first_solid(1, 1), 255);
  EXPECT_EQ(first_solid(0.5f, 0.6f), 256);
}

// Alpha 0.3 below a cutoff of 0.5 is a hole: the truth is light everywhere.
TEST(alpha_mask, a_constant_alpha_below_the_cutoff_is_all_hole) {
  const std::vector<std::uint8_t> alpha(64, 77);
  EXPECT_EQ(AlphaMask(8, 8, alpha).coverage(), 0);
  EXPECT_EQ(AlphaMask(8, 8, alpha, 1, 0.3f).coverage(), 1);
}

TEST(alpha_mask, bits_are_those_of_the_bytes_at_every_width) {
  Random random(1);
  for (const int width : {1, 2, 31, 32, 33, 63, 64, 65, 100}) {
    std::vector<std::uint8_t> alpha;
    for (int i = 0; i < width * 3; ++i) alpha.push_back(static_cast<std::uint8_t>(random.below(256)));
    const AlphaMask mask(width, 3, alpha);
    EXPECT_EQ(mask.bits().size(), std::size_t(mask.words()) * 3);
    EXPECT_TRUE(std::ranges::equal(mask.alpha(), alpha));
    int solid = 0;
    for (int y = 0; y < 3; ++y)
      for (int x = 0; x < width; ++x) {
        EXPECT_EQ(mask.is_solid(x, y), alpha[y * width + x] >= 128) << width << ": " << x << ' ' << y;
        solid += mask.is_solid(x, y);
      }
    EXPECT_DOUBLE_EQ(mask.coverage(), solid / (3.0 * width));
  }
}

TEST(alpha_mask, texels_beside_the_image_are_wrapped_in_integers) {
  struct Row {
    std::int64_t texel;
    int repeat, mirror, clamp;
  };
  constexpr Row rows[] = {{-9, 0, 2, 0}, {-4, 2, 2, 0}, {-3, 0, 2, 0}, {-1, 2, 0, 0}, {0, 0, 0, 0},
                          {2, 2, 2, 2},  {3, 0, 2, 2},  {5, 2, 0, 2},  {6, 0, 0, 2},  {3'000'000'000'001, 1, 1, 2}};
  for (const Row& row : rows) {
    EXPECT_EQ(AlphaMask::wrapped(row.texel, 3, Wrap::repeat), row.repeat) << row.texel;
    EXPECT_EQ(AlphaMask::wrapped(row.texel, 3, Wrap::mirror), row.mirror) << row.texel;
    EXPECT_EQ(AlphaMask::wrapped(row.texel, 3, Wrap::clamp), row.clamp) << row.texel;
  }
  for (const int size : {1, 2, 3, 7, 16384})
    for (const Wrap wrap : masked::wraps)
      for (std::int64_t texel = -50; texel <= 50; ++texel)
        EXPECT_EQ(AlphaMask::wrapped(texel, size, wrap), rational_holes::wrapped(mpz_class(long(texel)), size, wrap))
            << texel << " of " << size;
}

TEST(alpha_mask, each_axis_has_a_wrap_of_its_own) {
  const auto mask = masked::mask_of({"#..", "..."}, Wrap::repeat, Wrap::clamp);
  EXPECT_TRUE(mask->is_solid_wrapped(-3, -5));
  EXPECT_TRUE(mask->is_solid_wrapped(3, 0));
  EXPECT_FALSE(mask->is_solid_wrapped(0, 7));
  EXPECT_FALSE(mask->is_solid_wrapped(-1, 0));
}

// Two texels, 0 and 255, four times finer. The centers are at 1/8, 3/8, ... 15/8 texel, those of the image at 1/2 and 3/2:
// alpha is 0, 0, 1/8, 3/8, 5/8, 7/8, 1, 1. Repeated, the first two lie between 255 and 0: 3/8 and 1/8; mirrored, 0 is its own
// neighbor.
TEST(alpha_mask, a_finer_mask_is_bilinear_at_the_centers_of_its_texels) {
  const std::uint8_t alpha[] = {0, 255};
  const auto bytes = [&](Wrap wrap) {
    const AlphaMask mask(2, 1, alpha, 1, 0.2f, wrap, Wrap::clamp, 4);
    EXPECT_EQ(mask.width(), 8);
    EXPECT_EQ(mask.height(), 4);
    for (int y = 0; y < 4; ++y)
      for (int x = 0; x < 8; ++x) {
        EXPECT_EQ(mask.alpha()[8 * y + x], mask.alpha()[x]) << x << ' ' << y;
        EXPECT_EQ(mask.is_solid(x, y), mask.alpha()[x] > 51) << x << ' ' << y;
      }
    return std::vector<std::uint8_t>(mask.alpha().begin(), mask.alpha().begin() + 8);
  };
  EXPECT_EQ(bytes(Wrap::clamp), (std::vector<std::uint8_t>{0, 0, 32, 96, 159, 223, 255, 255}));
  EXPECT_EQ(bytes(Wrap::mirror), (std::vector<std::uint8_t>{0, 0, 32, 96, 159, 223, 255, 255}));
  EXPECT_EQ(bytes(Wrap::repeat), (std::vector<std::uint8_t>{96, 32, 32, 96, 159, 223, 223, 159}));
}

// Between the centers alpha is s - 1/2 at s texels: 3/4 at s = 5/4, the column 80 of 64 a texel.
TEST(alpha_mask, the_border_of_a_finer_mask_is_the_isoline_of_the_cutoff) {
  const std::uint8_t alpha[] = {0, 255};
  const AlphaMask mask(2, 1, alpha, 1, 0.75f, Wrap::clamp, Wrap::clamp, 64);
  for (int x = 0; x < mask.width(); ++x) EXPECT_EQ(mask.is_solid(x, 0), x >= 80) << x;
}

TEST(alpha_mask, a_scale_of_one_changes_nothing) {
  const std::uint8_t alpha[] = {0, 100, 200, 255};
  const AlphaMask mask(2, 2, alpha, 1, 0.5f, Wrap::repeat, Wrap::repeat, 1);
  EXPECT_TRUE(std::ranges::equal(mask.alpha(), alpha));
}

TEST(alpha_mask, what_is_out_of_range_is_refused_with_its_value) {
  const auto complaint = [](int width, int height, std::size_t bytes, float factor, float cutoff, int scale) -> std::string {
    try {
      AlphaMask(width, height, std::vector<std::uint8_t>(bytes), factor, cutoff, Wrap::repeat, Wrap::repeat, scale);
    } catch (const Error& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_EQ(complaint(16384, 1, 16384, 1, 0.5f, 1), "");
  EXPECT_EQ(complaint(1, 16384, 16384, 0, 1, 1), "");
  EXPECT_EQ(complaint(0, 4, 0, 1, 0.5f, 1), "a mask's width of 0 texels is not within 1 .. 16384");
  EXPECT_EQ(complaint(4, 16385, 4 * 16385, 1, 0.5f, 1), "a mask's height of 16385 texels is not within 1 .. 16384");
  EXPECT_EQ(complaint(4, -1, 4, 1, 0.5f, 1), "a mask's height of -1 texels is not within 1 .. 16384");
  EXPECT_EQ(complaint(2, 2, 4, 1, 0.5f, 16384), "a mask's width of 32768 texels is not within 1 .. 16384");
  EXPECT_EQ(complaint(2, 2, 4, 1, 0.5f, 0), "a mask's scale of 0 is not within 1 .. 16384");
  EXPECT_EQ(complaint(2, 2, 5, 1, 0.5f, 1), "a mask of 2 x 2 texels has 5 bytes of alpha, not 4");
  EXPECT_EQ(complaint(2, 2, 4, 1, 1.5f, 1), "a mask's cutoff of 1.5 is not within 0 .. 1");
  EXPECT_EQ(complaint(2, 2, 4, -1, 0.5f, 1), "a mask's factor of -1 is not within 0 .. 1");
  EXPECT_NE(complaint(2, 2, 4, 1, NAN, 1), "");
  EXPECT_NE(complaint(2, 2, 4, NAN, 0.5f, 1), "");
}

// However its triangles meet.
TEST(alpha_mask, a_surface_with_holes_has_no_inside) {
  Mesh body = hand_made::mesh_of({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}});
  ASSERT_TRUE(body.facts.closed());
  EXPECT_TRUE(body.is_closed());
  body.alpha_mask = masked::mask_of({"#"});
  EXPECT_FALSE(body.is_closed());
  Scene scene;
  EXPECT_FALSE(scene.has_alpha_masks());
  scene.meshes = {body};
  EXPECT_TRUE(scene.has_alpha_masks());
}

}  // namespace gnomon::alpha_mask_test
