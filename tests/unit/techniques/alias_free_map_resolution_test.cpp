// The alias-free map: what the resolution of its grid changes, and what it does not.
#include <fmt/format.h>
#include <gnomon/registry.h>
#include <gtest/gtest.h>

#include "hard_scenes.h"

extern "C" void gnomon_technique_alias_free_map(gnomon::Registry& registry);

namespace gnomon::alias_free_map_resolution_test {

// More cells leave fewer samples to test, and never another answer.
TEST(AliasFreeMap, all_resolutions_agree) {
  std::mt19937 engine(7);
  Random random(7);
  for (int round = 0; round < 3; ++round) {
    const auto [scene, gbuffer, lights] = hard_scenes::viewed(random, engine);
    for (const Light& light : lights) {
      SCOPED_TRACE(fmt::format("round {}, {} light", round, light.name));
      const auto run = [&, &scene = scene, &gbuffer = gbuffer](const std::string& settings) {
        return small_world::run(gnomon_technique_alias_free_map, settings, scene, light, gbuffer);
      };
      const auto expected = run("");
      double before = INFINITY;
      for (const int resolution : {16, 17, 100, 333, 1024, 4096}) {
        const auto done = run(fmt::format("resolution={}", resolution));
        EXPECT_EQ(done.mask, expected.mask) << resolution;
        const double tests = small_world::value(done.technique->counts(), "sample_tests");
        if (resolution == 16 || resolution == 100 || resolution == 1024) {
          EXPECT_LT(tests, before);
          before = tests;
        }
      }
    }
  }
}

}  // namespace gnomon::alias_free_map_resolution_test
