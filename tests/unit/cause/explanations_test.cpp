#include <gnomon/error.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <random>

#include "measure/cause/causes.h"

namespace explanations_test {

using namespace gnomon;

TEST(explanations, come_back_from_their_bytes) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> uniform(-10, 10);
  const auto vector = [&] { return glm::dvec3{uniform(random), uniform(random), uniform(random)}; };
  std::vector<std::optional<Explanation>> all;
  for (int k = 0; k < 60; ++k) {
    auto& why = all.emplace_back();
    if (k % 7 == 0) continue;
    why.emplace();
    why->covered = k % 2;
    why->bias = uniform(random);
    why->texel_width = std::abs(uniform(random));
    why->outline_error = std::abs(uniform(random));
    why->formula_differs = k % 4 == 1;
    if (k % 3 == 0) why->shifted = vector();
    if (k % 5 == 0) why->element = random() * (1ull << 33);
    for (int j = k % 4; j > 0; --j)
      why->taps.push_back({vector(), glm::normalize(vector()), uniform(random), j == 1 ? double(INFINITY) : uniform(random)});
    if (k >= 50 && k % 2) why->cause = fmt::format("cause_{}", k);
    if (k >= 40)
      for (int j = k % 3; j > 0; --j) why->samples.push_back({vector(), uniform(random), j == 1 ? 0.25 : 1.0});
  }
  // Without samples, or without causes of the technique's own, the bytes are those of programs without any.
  const auto first_byte = [](std::span<const std::optional<Explanation>> some) { return explanation_bytes(some)[6]; };
  EXPECT_EQ(first_byte(std::span(all).first(40)), std::byte{'3'});
  EXPECT_EQ(first_byte(std::span(all).first(50)), std::byte{'4'});
  EXPECT_EQ(first_byte(all), std::byte{'5'});
  EXPECT_EQ(explanations_from_bytes(explanation_bytes(std::span(all).first(50)))[45]->samples.size(), all[45]->samples.size());
  EXPECT_EQ(explanations_from_bytes(explanation_bytes(std::span(all).first(40)))[5]->taps.size(), all[5]->taps.size());
  const std::vector<std::byte> bytes = explanation_bytes(all);
  const auto back = explanations_from_bytes(bytes);
  ASSERT_EQ(back.size(), all.size());
  for (std::size_t k = 0; k < all.size(); ++k) {
    ASSERT_EQ(back[k].has_value(), all[k].has_value());
    if (!all[k]) continue;
    EXPECT_EQ(back[k]->covered, all[k]->covered);
    EXPECT_EQ(back[k]->bias, all[k]->bias);
    EXPECT_EQ(back[k]->texel_width, all[k]->texel_width);
    EXPECT_EQ(back[k]->outline_error, all[k]->outline_error);
    EXPECT_EQ(back[k]->formula_differs, all[k]->formula_differs);
    EXPECT_EQ(back[k]->shifted, all[k]->shifted);
    EXPECT_EQ(back[k]->element, all[k]->element);
    EXPECT_EQ(back[k]->cause, all[k]->cause);
    ASSERT_EQ(back[k]->taps.size(), all[k]->taps.size());
    for (std::size_t j = 0; j < all[k]->taps.size(); ++j) {
      EXPECT_EQ(back[k]->taps[j].origin, all[k]->taps[j].origin);
      EXPECT_EQ(back[k]->taps[j].direction, all[k]->taps[j].direction);
      EXPECT_EQ(back[k]->taps[j].weight, all[k]->taps[j].weight);
      EXPECT_EQ(back[k]->taps[j].stored, all[k]->taps[j].stored);
    }
    ASSERT_EQ(back[k]->samples.size(), all[k]->samples.size());
    for (std::size_t j = 0; j < all[k]->samples.size(); ++j) {
      EXPECT_EQ(back[k]->samples[j].place, all[k]->samples[j].place);
      EXPECT_EQ(back[k]->samples[j].weight, all[k]->samples[j].weight);
      EXPECT_EQ(back[k]->samples[j].visibility, all[k]->samples[j].visibility);
    }
  }
  EXPECT_TRUE(explanations_from_bytes(explanation_bytes({})).empty());
  // Cut anywhere, with something after the end, or of another kind: an error, never a guess.
  for (std::size_t size = 0; size < bytes.size(); size += 13)
    EXPECT_THROW(explanations_from_bytes(std::span(bytes).first(size)), Error) << size;
  std::vector<std::byte> longer = bytes, other = bytes;
  longer.emplace_back();
  EXPECT_THROW(explanations_from_bytes(longer), Error);
  other[0] ^= std::byte{1};
  EXPECT_THROW(explanations_from_bytes(other), Error);
}

TEST(explanations, that_cannot_be_traced_are_refused) {
  Explanation good;
  good.taps = {{{0, 1, 0}, {0, -1, 0}, 1, INFINITY}};
  good.samples = {{{0, 1, 0}, 1, 0}};
  const auto bytes_of = [](const Explanation& why) { return explanation_bytes(std::vector<std::optional<Explanation>>{why}); };
  EXPECT_NO_THROW(bytes_of(good));
  const std::vector<std::function<void(Explanation&)>> spoil{
      [](Explanation& e) { e.bias = NAN; },
      [](Explanation& e) { e.texel_width = -1; },
      [](Explanation& e) { e.texel_width = INFINITY; },
      [](Explanation& e) { e.shifted = glm::dvec3(0, NAN, 0); },
      [](Explanation& e) { e.taps[0].origin.z = INFINITY; },
      [](Explanation& e) { e.samples[0].place.x = NAN; },
      [](Explanation& e) { e.samples[0].weight = INFINITY; },
      [](Explanation& e) { e.samples[0].visibility = 1.5; },
      [](Explanation& e) { e.samples[0].visibility = NAN; },
      [](Explanation& e) {
        e.taps[0].direction = {0, -2, 0};
      },
      [](Explanation& e) {
        e.taps[0].direction = {NAN, 0, 0};
      },
      [](Explanation& e) { e.taps[0].weight = NAN; },
      [](Explanation& e) { e.taps[0].stored = NAN; },
  };
  for (std::size_t k = 0; k < spoil.size(); ++k) {
    Explanation bad = good;
    spoil[k](bad);
    EXPECT_THROW(bytes_of(bad), Error) << k;
  }
}

}  // namespace explanations_test
