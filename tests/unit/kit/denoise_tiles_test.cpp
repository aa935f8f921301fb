// Tiles, local means and moments over frames, against numbers worked out by hand.
#include <gnomon/error.h>
#include <gnomon/kit/denoise/tiles.h>
#include <gtest/gtest.h>

#include <cmath>

#include "kit/denoise_pictures.h"

namespace gnomon::denoise_tiles_test {

using denoise_pictures::Shares;
using denoise_pictures::Wall;

struct Vector {
  TileMoments before;
  float current, mean, history;
  double length, variance, blend, out;
};

TEST(denoise_tiles, steps_are_those_worked_out_by_hand) {
  const Vector vectors[] = {{{.5f, 4.75f, 20}, 1, .5f, .5f, 21, .249405, .05, .525},
                            {{1, 0, 20}, 0, .2f, 1, 9.435908, 1.050255, .05, .38},
                            {{0, 0, 0}, 1, .5f, 0, .818731, 15.181269, .950076, .962557}};
  for (const Vector& v : vectors) {
    const TileStep step = tile_step(v.before, v.current, v.mean, v.history);
    EXPECT_NEAR(step.moments.length, v.length, 2e-6 * v.length);
    EXPECT_NEAR(step.variance, v.variance, 2e-6 * v.variance);
    EXPECT_NEAR(step.blend, v.blend, 1e-6);
    EXPECT_NEAR(step.blended(v.current, v.history), v.out, 1e-6);
  }
}

TEST(denoise_tiles, twin_is_held_to_the_same_interval) {
  const TileStep step = tile_step({.mean = 1, .squares = 0, .length = 20}, 0, .2f, 1);  // 0 .. .4, blend .05
  EXPECT_NEAR(step.blended(.3f, .1f), .1 + .05 * .2, 1e-6);
  EXPECT_NEAR(step.blended(.3f, .9f), .4 - .05 * .1, 1e-6);
}

TEST(denoise_tiles, last_step_darkens) {
  EXPECT_NEAR(darkened(.5f, 0), .435275, 1e-6);
  EXPECT_EQ(darkened(.5f, .25f), .5f);
}

TEST(denoise_tiles, mean_has_17_taps_both_ways) {
  const Wall wall(64, 64);
  Shares shares(wall.size());
  shares.numerators[wall.at(30, 30)] = 1;
  TileMap map;
  map.make(wall.guides(), shares.numerators, shares.denominators);
  EXPECT_NEAR(map.mean()[wall.at(30, 30)], .110829 * .110829, 3e-7);
  EXPECT_NEAR(map.mean()[wall.at(38, 30)], .110829 * .010357, 3e-7);
  EXPECT_NEAR(map.mean()[wall.at(22, 22)], .010357 * .010357, 1e-8);
  EXPECT_EQ(map.mean()[wall.at(39, 30)], 0);
}

TEST(denoise_tiles, mean_at_the_border_is_that_of_the_pixels_that_count) {
  Wall wall(40, 40);
  Shares shares(wall.size(), .7f);
  shares.numerators[wall.at(20, 20)] = 50;
  wall.faces[wall.at(20, 20)] = 0;
  TileMap map;
  map.make(wall.guides(), shares.numerators, shares.denominators);
  for (const float mean : map.mean()) ASSERT_NEAR(mean, .7f, 1e-6);
}

TEST(denoise_tiles, pixel_spoils_the_tiles_around_it) {
  const Wall wall(64, 60);
  TileMap map;
  for (const bool is_spoiled : {false, true}) {
    Shares shares(wall.size(), 1);
    if (is_spoiled) shares.numerators[wall.at(20, 20)] = .5f;
    map.make(wall.guides(), shares.numerators, shares.denominators);
    // It is in word column 2 and word row 5. Tile row r looks at word rows 2r - 2 .. 2r + 3: those of 1, 2, 3.
    for (int y = 0; y < 60; ++y)
      for (int x = 0; x < 64; ++x) {
        const bool is_near = is_spoiled && x / 8 >= 1 && x / 8 <= 3 && y / 8 >= 1 && y / 8 <= 3;
        ASSERT_EQ(map.is_uniform(x, y), !is_near) << x << ' ' << y;
        ASSERT_EQ(map.strength()[wall.at(x, y)], is_near ? 1 : 0);
      }
  }
}

TEST(denoise_tiles, dark_tiles_are_uniform_and_pixels_that_do_not_count_do_not_matter) {
  Wall wall(64, 60);
  Shares shares(wall.size());
  shares.numerators[wall.at(20, 20)] = 1;
  wall.faces[wall.at(20, 20)] = 0;
  TileMap map;
  map.make(wall.guides(), shares.numerators, shares.denominators);
  EXPECT_TRUE(map.is_uniform(20, 20));
  wall.faces[wall.at(20, 20)] = 1;
  shares.numerators[wall.at(20, 20)] = shares.denominators[wall.at(20, 20)] = 0;  // nothing asked: it may be lit
  map.make(wall.guides(), shares.numerators, shares.denominators);
  EXPECT_FALSE(map.is_uniform(20, 20));
}

TEST(denoise_tiles, planes_of_another_size_are_refused) {
  const Wall wall(16, 16);
  Shares shares(wall.size()), small(3);
  EXPECT_THROW(TileMap().make(wall.guides(), small.numerators, shares.denominators), Error);
}

}  // namespace gnomon::denoise_tiles_test
