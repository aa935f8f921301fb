#include <gnomon/kit/pixel_groups.h>
#include <gnomon/kit/random.h>
#include <gtest/gtest.h>

#include <memory>
#include <mutex>

#include "hand_made.h"

namespace pixel_groups_test {
using namespace gnomon;

/// Points of three meshes in no order; those of mesh 0 lie on a floor with one normal.
void fill(hand_made::Picture& picture, std::uint64_t seed) {
  Random random(seed);
  for (std::size_t i = 0; i < picture.gbuffer.size(); ++i) {
    const std::uint32_t mesh = random.below(3);
    glm::vec3 point(random.uniform(glm::dvec3(-5), glm::dvec3(5))),
        normal(glm::normalize(random.uniform(glm::dvec3(0.1), glm::dvec3(1))));
    if (mesh == 0) {
      point.y = 2;
      normal = {0, 1, 0};
    }
    picture.set(i, point, normal, mesh, 0);
  }
}

TEST(pixel_groups, hold_every_pixel_that_is_asked_once_and_those_of_one_mesh_in_one_tile) {
  for (const auto& size : {std::pair(1, 1), std::pair(16, 16), std::pair(37, 21), std::pair(160, 90)}) {
    const int width = size.first, height = size.second;
    hand_made::Picture picture(width, height);
    fill(picture, 7);
    const GBuffer& g = picture.gbuffer;
    const auto is_asked = [](std::size_t i) { return i % 5 != 0; };
    std::vector<int> times(g.size(), 0);
    std::mutex mutex;
    for_pixel_groups(
        g, is_asked, [] { return std::make_unique<int>(0); },
        [&](std::span<std::uint32_t> pixels, std::size_t tile, int&) {
          const std::scoped_lock lock(mutex);
          ASSERT_FALSE(pixels.empty());
          ASSERT_LT(tile, tile_count(g));
          for (const std::uint32_t i : pixels) {
            ++times[i];
            ASSERT_EQ(g.mesh[i], g.mesh[pixels[0]]);
            ASSERT_EQ(i / width / tile_side * ((width + tile_side - 1) / tile_side) + i % width / tile_side, tile);
          }
        });
    for (std::size_t i = 0; i < times.size(); ++i) ASSERT_EQ(times[i], is_asked(i)) << i;
  }
}

TEST(pixel_groups, know_their_box_and_the_plane_that_none_is_below) {
  hand_made::Picture picture(16, 16);
  fill(picture, 8);
  const GBuffer& g = picture.gbuffer;
  std::vector<std::uint32_t> floor, rest;
  for (std::uint32_t i = 0; i < g.size(); ++i) (g.mesh[i] == 0 ? floor : rest).push_back(i);
  const PixelGroup flat = group_of(g, floor);
  ASSERT_TRUE(flat.above);
  EXPECT_EQ(flat.above->normal, glm::dvec3(0, 1, 0));
  EXPECT_EQ(flat.above->height, 2);
  EXPECT_EQ(flat.above->highest, 2);
  const PixelGroup any = group_of(g, rest);
  EXPECT_FALSE(any.above);
  for (const std::uint32_t i : rest)
    for (int k = 0; k < 3; ++k) {
      EXPECT_LE(any.box.min[k], g.position(i)[k]);
      EXPECT_GE(any.box.max[k], g.position(i)[k]);
    }
}

TEST(pixel_groups, halves_lie_on_both_sides_of_a_plane_across_the_longest_side) {
  hand_made::Picture picture(31, 1);
  fill(picture, 9);
  for (std::size_t i = 0; i < picture.gbuffer.size(); ++i) picture.value[2][i] *= 3;  // the longest side is z
  const GBuffer& g = picture.gbuffer;
  std::vector<std::uint32_t> pixels(g.size());
  for (std::uint32_t i = 0; i < g.size(); ++i) pixels[i] = i;
  const auto [some, others] = halve(g, group_of(g, pixels).box, pixels);
  EXPECT_EQ(some.size(), 15u);
  EXPECT_EQ(others.size(), 16u);
  for (const std::uint32_t a : some)
    for (const std::uint32_t b : others) EXPECT_LE(g.position(a).z, g.position(b).z);
}

}  // namespace pixel_groups_test
