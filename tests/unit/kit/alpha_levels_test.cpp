// Levels of a mask's alpha, what shaders read of them, and what maps drawn by them hold.
#include <gnomon/kit/maps/light_map.h>
#include <gtest/gtest.h>

#include "device/context.h"
#include "masked.h"
#include "measure/conformance/gl_state.h"

namespace alpha_levels_test {
using namespace gnomon;
using enum AlphaRule;
using masked::Wrap;

std::shared_ptr<const AlphaMask> constant(int side, int byte) {
  const std::vector<std::uint8_t> alpha(std::size_t(side) * side, static_cast<std::uint8_t>(byte));
  return std::make_shared<const AlphaMask>(side, side, alpha);
}

/// Any byte at every texel.
std::shared_ptr<const AlphaMask> gray_mask(Random& random, int width, int height, float factor, float cutoff) {
  std::vector<std::uint8_t> alpha;
  for (int i = 0; i < width * height; ++i) alpha.push_back(static_cast<std::uint8_t>(random.below(256)));
  const Wrap wrap_u = masked::wraps[random.below(3)], wrap_v = masked::wraps[random.below(3)];
  return std::make_shared<const AlphaMask>(width, height, alpha, factor, cutoff, wrap_u, wrap_v);
}

// Level 1 of four texels, one of them set, is their mean, 1/4: below the cutoff, so nothing is left of the quarter that was
// solid. Doubled it passes, and all is solid.
TEST(AlphaLevels, one_texel_of_four_vanishes_or_fills_the_level) {
  const auto mask = masked::mask_of({"#.", ".."});
  const auto box = alpha_levels(*mask, mips), kept = alpha_levels(*mask, mips_kept);
  ASSERT_EQ(box.size(), 2u);
  EXPECT_EQ(box[0].alpha, (std::vector<float>{1, 0, 0, 0}));
  EXPECT_EQ(box[1].alpha, std::vector<float>{0.25f});
  EXPECT_EQ(box[0].coverage(1, 0.5f), 0.25);
  EXPECT_EQ(box[1].coverage(1, 0.5f), 0);
  ASSERT_EQ(kept.size(), 2u);
  EXPECT_EQ(kept[0].alpha, box[0].alpha);
  EXPECT_EQ(kept[1].alpha, std::vector<float>{0.5f});
  EXPECT_EQ(kept[1].coverage(1, 0.5f), 1);
}

// Of a chessboard all levels are 1/2, which passes: 1/2 of the texels is solid, then all. To keep 1/2 with equal texels is to
// keep all, and 1/2 is the least alpha with which they pass.
TEST(AlphaLevels, a_chessboard_fills_up) {
  for (const AlphaRule rule : {mips, mips_kept}) {
    const auto levels = alpha_levels(*masked::checker(8, 8), rule);
    ASSERT_EQ(levels.size(), 4u);
    EXPECT_EQ(levels[0].coverage(1, 0.5f), 0.5);
    for (int l = 1; l < 4; ++l) {
      EXPECT_EQ(levels[l].width, 8 >> l);
      for (const float alpha : levels[l].alpha) EXPECT_EQ(alpha, 0.5f);
      EXPECT_EQ(levels[l].coverage(1, 0.5f), 1);
    }
  }
}

// Five texels become two, each over two and a half: (1 + 1 + 1/2) / 2.5 = 1 and (1/2 + 0 + 0) / 2.5 = 1/5; three rows become
// one; 2 x 1 becomes 1 x 1.
TEST(AlphaLevels, odd_sides_are_divided_by_area) {
  const auto levels = alpha_levels(*masked::mask_of({"###..", "###..", "###.."}), mips);
  ASSERT_EQ(levels.size(), 3u);
  EXPECT_EQ(levels[1].width, 2);
  EXPECT_EQ(levels[1].height, 1);
  EXPECT_NEAR(levels[1].alpha[0], 1, 1e-6);
  EXPECT_NEAR(levels[1].alpha[1], 0.2, 1e-6);
  ASSERT_EQ(levels[2].alpha.size(), 1u);
  EXPECT_NEAR(levels[2].alpha[0], 0.6, 1e-6);
}

TEST(AlphaLevels, every_level_has_the_mean_of_the_first) {
  Random random(1);
  for (int round = 0; round < 50; ++round) {
    const int width = 1 + static_cast<int>(random.below(40)), height = 1 + static_cast<int>(random.below(40));
    const auto levels = alpha_levels(*gray_mask(random, width, height, 1, 0.5f), mips);
    std::vector<double> means;
    for (const AlphaLevel& level : levels) {
      double sum = 0;
      for (const float alpha : level.alpha) sum += alpha;
      means.push_back(sum / double(level.alpha.size()));
      EXPECT_NEAR(means.back(), means[0], 1e-5) << width << " x " << height;
    }
    EXPECT_EQ(levels.back().alpha.size(), 1u);
  }
}

// As large a share passes as of level 0, or more; and with a hundred-thousandth less alpha a smaller one would. A factor of 0
// lets nothing pass but a cutoff of 0, which lets all pass.
TEST(AlphaLevels, levels_that_keep_their_share_have_the_least_alpha) {
  Random random(2);
  for (int round = 0; round < 300; ++round) {
    const int width = 1 + static_cast<int>(random.below(24)), height = 1 + static_cast<int>(random.below(24));
    const float factor = random.below(8) == 0 ? 0 : static_cast<float>(random.uniform(0.3, 1));
    const float cutoff = random.below(8) == 0 ? 0 : static_cast<float>(random.uniform(0, 1));
    const auto levels = alpha_levels(*gray_mask(random, width, height, factor, cutoff), mips_kept);
    const double share = levels[0].coverage(factor, cutoff);
    for (AlphaLevel level : std::span(levels).subspan(1)) {
      EXPECT_GE(level.coverage(factor, cutoff), share) << width << " x " << height << ' ' << factor << ' ' << cutoff;
      for (const float alpha : level.alpha) EXPECT_TRUE(alpha >= 0 && alpha <= 1);
      if (share == 0 || cutoff == 0) continue;
      for (float& alpha : level.alpha) alpha *= 1 - 1e-5f;
      EXPECT_LT(level.coverage(factor, cutoff), share) << width << " x " << height << ' ' << factor << ' ' << cutoff;
    }
  }
}

// 64 x 64 texels have 4096 + 1024 + ... + 1 = 5461 in seven levels. Beside them are eight words of facts, and the first word of
// each level.
TEST(AlphaLevels, bytes_are_those_of_what_a_rule_reads) {
  Scene scene;
  scene.meshes = {hand_made::square(3, 0), masked::card(1, 1, masked::checker(64, 64))};
  EXPECT_EQ(alpha_bytes(scene, texel), 0u);
  EXPECT_EQ(alpha_bytes(scene, mips), 4u * (5461 + 7 + 8));
  EXPECT_EQ(alpha_bytes(scene, mips_kept), 4u * (5461 + 7 + 8));
  EXPECT_EQ(alpha_bytes(scene, hashed), 4u * (4096 + 1 + 8));
  EXPECT_TRUE(alpha_levels(*scene.meshes[1].alpha_mask, texel).empty());
  EXPECT_EQ(alpha_levels(*scene.meshes[1].alpha_mask, hashed).size(), 1u);
  scene.meshes.resize(1);
  for (const AlphaRule rule : {texel, mips, mips_kept, hashed}) EXPECT_EQ(alpha_bytes(scene, rule), 0u);
}

// --- drawn ---------------------------------------------------------------------------------------------------------------

class AlphaImages : public testing::Test {
 protected:
  AlphaImages() { process_context(); }
  void TearDown() override {
    EXPECT_EQ(state_differences(), std::vector<std::string>{});
    release_inputs();
  }
};

const Light down{.kind = DirectionalLight{{0, -1, 0}}}, aslant{.kind = DirectionalLight{{0.4f, -1, 0.2f}}};

/// A card of 2 m at height 1 in an image of a directional light, where the ground only receives. `times` as of masked::card; u
/// and v begin at -times / 2, so that half of the places are negative.
struct Drawn {
  Scene scene;
  DepthImages images;
  LightCamera camera;
  float times;

  Drawn(std::shared_ptr<const AlphaMask> mask, float times, const Light& light, int resolution) : times(times) {
    scene.meshes = {hand_made::square(3, 0), masked::card(1, 1, std::move(mask), times)};
    scene.meshes[0].casts = false;
    for (glm::vec2& place : scene.meshes[1].uv) place -= times / 2;
    for (Mesh& mesh : scene.meshes) finish(mesh);
    images.setup();
    images.build(scene);
    camera = fit_to_scene(light, images.boxes(), resolution, 2);
  }
  const AlphaMask& mask() const { return *scene.meshes[1].alpha_mask; }
  /// Of every texel, whether the card is stored.
  std::vector<bool> stored(AlphaRule rule) {
    const StateGuard guard;
    images.use_alpha(rule);
    Texture texture;
    images.draw(camera, texture, DepthImages::Faces::lit, images.hole_test());
    std::vector<bool> stored;
    for (const float depth : read_texels<float>(texture, GL_DEPTH_COMPONENT)) stored.push_back(depth > 0);
    return stored;
  }
  /// u and v where the ray of a place, in texels of the image, meets the card's plane.
  glm::dvec2 uv(const glm::dvec2& texel) const {
    const LightImage& image = camera.images[0];
    const glm::dvec3 at = image.to_world(glm::dvec3(image.window_of(texel), 0)), along = image.axis(2);
    const glm::dvec3 met = at + along * ((1 - at.y) / along.y);
    return glm::dvec2(met.x, met.z) / 2.0 * double(times);
  }
  /// Calls visit(index, uv of the center) for the texels whose neighbors all meet the card.
  template <class Visit>
  void for_inner(const Visit& visit) const {
    for (int y = 1; y + 1 < camera.resolution; ++y)
      for (int x = 1; x + 1 < camera.resolution; ++x) {
        const glm::dvec2 corners[] = {uv({x - 1, y - 1}), uv({x + 2, y - 1}), uv({x - 1, y + 2}), uv({x + 2, y + 2})};
        const bool is_inner = std::ranges::all_of(corners, [&](const glm::dvec2& corner) {
          return std::max(std::abs(corner.x), std::abs(corner.y)) < double(times) / 2;
        });
        if (is_inner) visit(std::size_t(y) * camera.resolution + x, uv({x + 0.5, y + 0.5}));
      }
  }
};

// Repeated, mirrored and clamped, on both sides of 0. A place within 1/1000 of a texel's edge may round to its neighbor.
TEST_F(AlphaImages, the_bit_is_that_of_the_wrapped_texel) {
  Random random(6);
  int compared = 0;
  for (const Light& light : {down, aslant})
    for (const Wrap wrap_u : masked::wraps)
      for (const Wrap wrap_v : masked::wraps) {
        Drawn drawn(masked::random_mask(random, 13, 10, wrap_u, wrap_v), 5, light, 128);
        const std::vector<bool> stored = drawn.stored(texel);
        int wrong = 0;
        drawn.for_inner([&](std::size_t i, const glm::dvec2& uv) {
          const glm::dvec2 place = uv * glm::dvec2(13, 10), from_edge = glm::abs(place - glm::round(place));
          if (std::min(from_edge.x, from_edge.y) < 1e-3) return;
          const glm::dvec2 low = glm::floor(place);
          const bool is_solid =
              drawn.mask().is_solid_wrapped(static_cast<std::int64_t>(low.x), static_cast<std::int64_t>(low.y));
          ++compared;
          wrong += stored[i] != is_solid;
        });
        EXPECT_EQ(wrong, 0) << int(wrap_u) << ' ' << int(wrap_v);
      }
  EXPECT_GT(compared, 100000);
}

double bilinear(const AlphaMask& mask, const AlphaLevel& level, const glm::dvec2& uv) {
  const glm::dvec2 place = uv * glm::dvec2(level.width, level.height) - 0.5, low = glm::floor(place), share = place - low;
  double sum = 0;
  for (int j = 0; j < 2; ++j)
    for (int i = 0; i < 2; ++i) {
      const int column = AlphaMask::wrapped(static_cast<std::int64_t>(low.x) + i, level.width, mask.wrap_u());
      const int row = AlphaMask::wrapped(static_cast<std::int64_t>(low.y) + j, level.height, mask.wrap_v());
      sum += (i ? share.x : 1 - share.x) * (j ? share.y : 1 - share.y) * level.alpha[std::size_t(row) * level.width + column];
    }
  return sum;
}

/// By the formulas of OpenGL; `x` and `y` are what u and v change by from texel to texel of the image.
double trilinear(const AlphaMask& mask, std::span<const AlphaLevel> levels, const glm::dvec2& uv, const glm::dvec2& x,
                 const glm::dvec2& y) {
  const glm::dvec2 size(mask.width(), mask.height());
  const double longer = std::max(glm::length(x * size), glm::length(y * size));
  const double level = std::clamp(std::log2(longer), 0.0, double(levels.size() - 1)), finer = std::floor(level);
  const auto coarser = std::min(static_cast<std::size_t>(finer) + 1, levels.size() - 1);
  return std::lerp(bilinear(mask, levels[static_cast<std::size_t>(finer)], uv), bilinear(mask, levels[coarser], uv),
                   level - finer);
}

// A texel of the image is from 1/20 to some 10 texels of the mask. Where alpha passes the cutoff by less than 1/128 rounding
// may decide.
TEST_F(AlphaImages, shaders_filter_alpha_as_a_sampler_does) {
  Random random(3);
  int solid = 0, compared = 0;
  for (const AlphaRule rule : {mips, mips_kept})
    for (const Light& light : {down, aslant})
      for (const float times : {0.5f, 3.0f, 9.0f, 30.0f, 100.0f}) {
        Drawn drawn(gray_mask(random, 13, 10, 0.9f, 0.45f), times, light, 128);
        const auto levels = alpha_levels(drawn.mask(), rule);
        const std::vector<bool> stored = drawn.stored(rule);
        const glm::dvec2 x = drawn.uv({1, 0}) - drawn.uv({0, 0}), y = drawn.uv({0, 1}) - drawn.uv({0, 0});
        int wrong = 0;
        drawn.for_inner([&](std::size_t i, const glm::dvec2& uv) {
          const double over = 0.9 * trilinear(drawn.mask(), levels, uv, x, y) - 0.45;
          if (std::abs(over) < 1.0 / 128) return;
          ++compared;
          solid += over > 0;
          wrong += stored[i] != (over > 0);
        });
        EXPECT_EQ(wrong, 0) << int(rule) << ' ' << times;
      }
  EXPECT_GT(compared, 50000);
  EXPECT_GT(solid, compared / 10);
  EXPECT_LT(solid, compared - compared / 10);
}

// Finer texels than the image's: all of a quarter's holes, or none.
TEST_F(AlphaImages, far_away_a_quarter_is_nothing_or_all) {
  Drawn drawn(masked::mask_of({"#.", ".."}), 200, down, 64);
  const std::vector<bool> by_mips = drawn.stored(mips), by_kept = drawn.stored(mips_kept);
  int count = 0;
  drawn.for_inner([&](std::size_t i, const glm::dvec2&) {
    ++count;
    EXPECT_FALSE(by_mips[i]);
    EXPECT_TRUE(by_kept[i]);
  });
  EXPECT_GT(count, 500);
}

// Alpha 77 / 255 = 0.302, cutoff 1/2: the bits say that nothing is solid; of random thresholds 0.302 are passed.
TEST_F(AlphaImages, random_thresholds_keep_the_mean_of_alpha) {
  for (const Light& light : {down, aslant})
    for (const float times : {1.0f, 40.0f}) {
      Drawn drawn(constant(4, 77), times, light, 256);
      const std::vector<bool> by_texel = drawn.stored(texel), by_hash = drawn.stored(hashed);
      int count = 0, solid = 0, alike = 0;
      drawn.for_inner([&](std::size_t i, const glm::dvec2&) {
        ++count;
        EXPECT_FALSE(by_texel[i]);
        solid += by_hash[i];
        alike += by_hash[i] == by_hash[i + 1];
      });
      EXPECT_GT(count, 10000);
      EXPECT_NEAR(double(solid) / count, 0.302, 0.02);
      // Neighbors that were independent would agree with probability 0.58; grain of a texel or so, by a little more.
      EXPECT_LT(double(alike) / count, 0.85);
      EXPECT_EQ(by_hash, drawn.stored(hashed)) << "the same each time";
    }
}

// Thresholds lie over 0 and are 1 at most.
TEST_F(AlphaImages, random_thresholds_decide_nothing_where_alpha_is_0_or_1) {
  Random random(4);
  for (const Light& light : {down, aslant}) {
    Drawn drawn(masked::random_mask(random, 16, 16), 3, light, 256);
    EXPECT_EQ(drawn.stored(hashed), drawn.stored(texel));
  }
}

// What another rule reads goes; for the texel's there is nothing.
TEST_F(AlphaImages, one_rule_at_a_time_is_held) {
  Drawn drawn(masked::checker(8, 8), 1, down, 64);
  const std::size_t before = drawn.images.bytes();
  for (const AlphaRule rule : {mips, hashed, texel, mips_kept, texel}) {
    drawn.images.use_alpha(rule);
    EXPECT_EQ(drawn.images.bytes(), before + alpha_bytes(drawn.scene, rule));
    EXPECT_EQ(drawn.images.hole_test().rule, rule);
  }
  drawn.scene.meshes[1].alpha_mask = nullptr;
  drawn.images.build(drawn.scene, mips);
  EXPECT_EQ(drawn.images.bytes(), before);
  EXPECT_EQ(drawn.images.hole_test().rule, texel) << "no mask is there";
}

}  // namespace alpha_levels_test
