// Tables of what triangles let through: what is refused, what is kept once, and what a texel holds.
#include <gnomon/transmission.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "error_words.h"
#include "glass.h"
#include "small_world.h"

namespace gnomon::transmission_test {

using error_words::error_of;
using error_words::expect_words;
using Wrap = Transmission::Wrap;

std::string refused(int width, int height, int channels, std::size_t count, float value = 0.5f) {
  return error_of([&] { Transmission(width, height, channels, std::vector<float>(count, value)); });
}

TEST(transmission, sides_channels_and_counts_out_of_range_are_refused) {
  EXPECT_EQ(refused(2, 3, 1, 6), "");
  EXPECT_EQ(refused(2, 3, 3, 18), "");
  expect_words(refused(0, 3, 1, 0), {"side of 0 texels", "1 .. 16384"});
  expect_words(refused(3, -1, 1, 3), {"side of -1 texels", "1 .. 16384"});
  expect_words(refused(16385, 1, 1, 16385), {"side of 16385 texels", "1 .. 16384"});
  for (const int channels : {0, 2, 4, -3})
    expect_words(refused(1, 1, channels, 4), {"1 or 3 channels", std::to_string(channels)});
  expect_words(refused(2, 3, 1, 5), {"2 x 3", "5 numbers", "not 6"});
  expect_words(refused(2, 3, 3, 6), {"2 x 3", "6 numbers", "not 18"});
  // 8192 * 8192 = 2^26 numbers are the most. Refused before the values are looked at, of which there are none here.
  expect_words(refused(8192, 8193, 1, 0), {"8192 x 8193", std::to_string(8192u * 8193), "at most 67108864"});
  expect_words(refused(8192, 4096, 3, 0), {"8192 x 4096", std::to_string(8192u * 4096 * 3), "at most 67108864"});
  const auto wrap = static_cast<Wrap>(3);
  expect_words(error_of([&] { Transmission(1, 1, 1, {0.5f}, wrap); }), {"wrap of 3", "0 .. 2"});
  expect_words(error_of([&] { Transmission(1, 1, 1, {0.5f}, Wrap::clamp, wrap); }), {"wrap of 3", "0 .. 2"});
}

TEST(transmission, a_value_outside_0_to_1_is_refused_wherever_it_is) {
  constexpr float nan = std::numeric_limits<float>::quiet_NaN();
  for (const float bad :
       {-0.25f, std::nextafter(1.0f, 2.0f), -std::numeric_limits<float>::denorm_min(), nan, INFINITY, -INFINITY})
    for (std::size_t at = 0; at < 12; ++at) {
      std::vector<float> values(12, 0.5f);
      values[at] = bad;
      expect_words(error_of([&] { Transmission(2, 2, 3, values); }), {"0 .. 1"});
      expect_words(error_of([&] { Transmission(4, 3, 1, values); }), {"0 .. 1"});
      if (at < 3) expect_words(error_of([&] { Transmission(glm::vec3(values[0], values[1], values[2])); }), {"0 .. 1"});
    }
  expect_words(refused(1, 1, 1, 1, -0.25f), {"transmission of -0.25", "0 .. 1"});
}

TEST(transmission, equal_channels_are_kept_once) {
  const Transmission gray(2, 1, 3, {0.25f, 0.25f, 0.25f, 0.75f, 0.75f, 0.75f});
  EXPECT_EQ(gray.channels(), 1);
  EXPECT_FALSE(gray.is_colored());
  EXPECT_FALSE(gray.is_constant());
  EXPECT_TRUE(std::ranges::equal(gray.values(), std::vector{0.25f, 0.75f}));
  EXPECT_EQ(gray, Transmission(2, 1, 1, {0.25f, 0.75f}));
  EXPECT_EQ(gray.at(0, 0), glm::vec3(0.25f));
  EXPECT_EQ(gray.at(1, 0), glm::vec3(0.75f));
  EXPECT_EQ(gray.bytes(), 8u);
  // One number that differs keeps all three channels.
  for (std::size_t at = 0; at < 6; ++at) {
    std::vector<float> values = {0.25f, 0.25f, 0.25f, 0.75f, 0.75f, 0.75f};
    values[at] = 0.5f;
    const Transmission colored(2, 1, 3, values);
    EXPECT_TRUE(colored.is_colored()) << at;
    EXPECT_TRUE(std::ranges::equal(colored.values(), values)) << at;
  }
}

TEST(transmission, equal_texels_are_kept_once_and_lose_their_wraps) {
  const Transmission gray(3, 2, 1, std::vector<float>(6, 0.25f), Wrap::mirror, Wrap::clamp);
  EXPECT_TRUE(gray.is_constant());
  EXPECT_EQ(gray, Transmission(glm::vec3(0.25f)));
  const Transmission colored(2, 2, 3, {0.1f, 0.2f, 0.3f, 0.1f, 0.2f, 0.3f, 0.1f, 0.2f, 0.3f, 0.1f, 0.2f, 0.3f});
  EXPECT_TRUE(colored.is_constant());
  EXPECT_TRUE(colored.is_colored());
  EXPECT_EQ(colored, Transmission(glm::vec3(0.1f, 0.2f, 0.3f)));
  // Equal texels of equal channels: one number.
  EXPECT_EQ(Transmission(2, 2, 3, std::vector<float>(12, 0.5f)).values().size(), 1u);
  for (std::size_t at = 0; at < 6; ++at) {
    std::vector<float> values(6, 0.25f);
    values[at] = 0.5f;
    const Transmission textured(3, 2, 1, values, Wrap::mirror, Wrap::clamp);
    EXPECT_FALSE(textured.is_constant()) << at;
    EXPECT_EQ(textured.wrap_u(), Wrap::mirror);
    EXPECT_EQ(textured.wrap_v(), Wrap::clamp);
    EXPECT_EQ(textured.width(), 3);
    EXPECT_EQ(textured.height(), 2);
  }
}

// Minus zero as a factor would make a share of minus zero, and two tables of nothing would differ in their bits.
TEST(transmission, minus_zero_is_zero) {
  const Transmission nothing(glm::vec3(-0.0f, 0.0f, -0.0f));
  EXPECT_EQ(nothing.channels(), 1);
  EXPECT_FALSE(std::signbit(nothing.values()[0]));
}

/// Of copies of the image side by side, every other one turned when mirrored.
int copied(int texel, int size, Wrap wrap) {
  if (wrap == Wrap::clamp) return std::clamp(texel, 0, size - 1);
  const int copy = static_cast<int>(std::floor(static_cast<double>(texel) / size)), within = texel - copy * size;
  return wrap == Wrap::mirror && copy % 2 != 0 ? size - 1 - within : within;
}

TEST(transmission, texels_are_wrapped_as_those_of_masks) {
  Random random(5);
  for (int round = 0; round < 30; ++round) {
    const auto glass = glass::any_texels(random, 5);
    for (int row = -11; row < 12; ++row)
      for (int column = -11; column < 12; ++column) {
        const int x = copied(column, glass->width(), glass->wrap_u()), y = copied(row, glass->height(), glass->wrap_v());
        EXPECT_EQ(glass->at_wrapped(column, row), glm::vec3(glass->values()[static_cast<std::size_t>(y * glass->width() + x)]));
      }
  }
}

TEST(transmission, a_mesh_with_it_is_open_and_needs_places_for_texels) {
  Mesh box = small_world::box({0, 0, 0}, {1, 1, 1});
  EXPECT_TRUE(box.is_closed());
  box = glass::with_transmission(box, glm::vec3(0.5f));
  EXPECT_FALSE(box.is_closed());
  EXPECT_FALSE(box.needs_uv());
  box.transmission = glass::texels(2, 1, {0.5f, 1});
  EXPECT_TRUE(box.needs_uv());
  Scene scene;
  scene.meshes = {box};
  EXPECT_TRUE(scene.has_transmission());
  EXPECT_FALSE(scene.has_colored_transmission());
  scene.meshes[0].transmission = glass::constant({0.5f, 0.5f, 0.25f});
  EXPECT_TRUE(scene.has_colored_transmission());
  scene.meshes[0].casts = false;
  EXPECT_FALSE(scene.has_transmission());
  EXPECT_FALSE(scene.has_colored_transmission());
}

}  // namespace gnomon::transmission_test
