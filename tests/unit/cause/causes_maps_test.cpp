#include <fmt/ranges.h>
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <cmath>
#include <random>

#include "cause_world.h"
#include "small_world.h"

namespace causes_maps_test {

using namespace gnomon;
using namespace gnomon::cause_world;

/// Maps of every kind over random soups: whatever they get wrong has a name. Returns what is not as it should be.
std::string complaint(std::uint32_t seed, bool midpoint = false) {
  std::mt19937 random(seed);
  const auto uniform = [&](double low, double high) { return std::uniform_real_distribution<double>(low, high)(random); };
  Scene scene;
  scene.meshes = {small_world::ground(5)};
  for (int m = 0; m < 3; ++m) scene.meshes.push_back(small_world::random_soup(random, 12, 3, 0.1f, 3, 1));
  const bool is_point = random() % 2 == 0;
  const Light light = is_point ? hand_made::point_light({uniform(-3, 3), uniform(5, 9), uniform(-3, 3)})
                               : hand_made::sun({uniform(-1.5, 1.5), -1, uniform(-1.5, 1.5)});
  World world(std::move(scene), light, {.eye = {2, 5, 8}, .target = {0, 0, 0}, .up = {0, 1, 0}});
  TestMap::Settings settings;
  settings.texel = std::exp(uniform(std::log(0.01), std::log(0.6)));
  settings.bias = random() % 4 == 0 ? 0 : settings.texel * std::exp(uniform(-2, 4));
  settings.slope_bias = random() % 2 == 0 ? 0 : uniform(0, 3);
  settings.radius = random() % 3 == 0 ? static_cast<int>(random() % 3) : 0;
  settings.normal_offset = random() % 3 == 0 ? uniform(0.5, 3) : 0;
  settings.receiver_plane = random() % 3 == 0;
  settings.second = random() % 5 == 0;
  settings.midpoint = midpoint;
  const TestMap map(world.scene, world.casters, light, settings);
  world.take(map);
  const Causes causes = world.causes(map);
  std::uint64_t sum = 0;
  for (const auto& [cause, count] : causes) sum += count;
  // And a map that stores the nearest surface believes what it stores.
  if (sum == world.wrong() && !causes.contains("unexplained") &&
      (settings.second || midpoint || !causes.contains("leak_representation")))
    return "";
  return fmt::format("seed {} texel {} bias {} slope {} radius {} offset {} plane {} second {} point {}: {} of {}", seed,
                     settings.texel, settings.bias, settings.slope_bias, settings.radius, settings.normal_offset,
                     settings.receiver_plane, settings.second, is_point, fmt::join(causes, " "), world.wrong());
}

RC_GTEST_PROP(causes, maps_of_random_soups_leave_nothing_unexplained, ()) {
  const std::string found = complaint(*rc::gen::inRange(0u, 1u << 30));
  RC_LOG() << found;
  RC_ASSERT(found.empty());
}

// What these store lies on no surface.
TEST(causes, maps_of_midpoints_leave_nothing_unexplained) {
  for (std::uint32_t seed = 1; seed <= 30; ++seed) EXPECT_EQ(complaint(seed, true), "");
}

TEST(causes, a_rare_map_of_a_random_soup) { EXPECT_EQ(complaint(394124438), ""); }

}  // namespace causes_maps_test
