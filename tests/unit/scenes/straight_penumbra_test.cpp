// straight_penumbra: its penumbra is as wide as its parameter says, by exact shares, and moves as far as its light jumps.
#include <gnomon/kit/area/area_scene.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "generated_scene.h"
#include "measure/scene/motion.h"
#include "small_world.h"

namespace straight_penumbra_test {

using namespace gnomon;
using generated::make;

constexpr int width = 640, height = 360, middle = width / 2;

/// Exact shares of a light's area that pixels of the picture see.
class Shares {
 public:
  explicit Shares(const Scene& scene)
      : scene_(scene), casters_(scene), gbuffer_(small_world::make_gbuffer(scene, scene.views[0], width, height)) {}
  double at(const Light& light, int row, int column) {
    const std::size_t i = static_cast<std::size_t>(row) * width + static_cast<std::size_t>(column);
    EXPECT_EQ(gbuffer_.mesh[i], 0u) << "the ground, column " << column;
    const LightFigure figure(light, gbuffer_.position(i), gbuffer_.normal(i));
    return casters_.seen(receiver_at(scene_, gbuffer_, i), figure, pieces_, tally_).area.best;
  }

 private:
  const Scene& scene_;
  AreaScene casters_;
  GBuffer gbuffer_;
  LightPieces pieces_;
  AreaTally tally_;
};

const Light& light_of(const Scene& scene, std::string_view name) {
  return *std::ranges::find(scene.lights, name, &Light::name);
}

// Pixel k of a penumbra of w pixels has its center at s = (2k + 1) / w - 1 of the light's half width from the middle.
TEST(StraightPenumbra, is_as_wide_as_its_parameter_in_every_row) {
  for (const int w : {4, 8, 24, 96}) {
    const Scene scene = make("straight_penumbra", fmt::format("width_px={}", w));
    Shares shares(scene);
    for (const int row : {0, 100, 180, 359})
      for (int column = middle - w; column < middle + w; ++column) {
        SCOPED_TRACE(fmt::format("{} px, row {}, column {}", w, row, column));
        const int k = column - (middle - w / 2);
        const double s = std::clamp((2 * k + 1.0) / w - 1, -1.0, 1.0);
        EXPECT_NEAR(shares.at(light_of(scene, "panel"), row, column), (1 + s) / 2, 1e-4);
        const double of_disc = 0.5 + (std::asin(s) + s * std::sqrt(1 - s * s)) / std::numbers::pi;
        EXPECT_NEAR(shares.at(light_of(scene, "lamp"), row, column), of_disc, 1e-4);
      }
  }
}

// The slab's side ends 1.75 m up and 4.25 m below the eye: it is seen at 1 - 6 / 4.25 = -0.412 m of the ground, 141.2 pixels
// left of the middle.
TEST(StraightPenumbra, the_slab_hides_none_of_the_penumbra) {
  const Scene scene = make("straight_penumbra", "width_px=96");
  const GBuffer g = small_world::make_gbuffer(scene, scene.views[0], width, height);
  for (std::size_t i = 0; i < g.size(); ++i) {
    const std::size_t column = i % width;
    ASSERT_EQ(g.mesh[i], column < 179 ? 1u : 0u) << column;
  }
}

// The light is at (-1, 4, 6), the middle of the scene at (0, 1, 0): sqrt(46) m away. Sideways is (6, 0, 1) / sqrt(37), so 5 %
// of the way are 0.05 sqrt(46) 6 / sqrt(37) = 0.3345 m across the edge, half way up to the light: as far on the ground.
TEST(StraightPenumbra, the_light_jumps_across_the_edge) {
  const Scene scene = make("straight_penumbra");
  Shares shares(scene);
  for (const char* const name : {"panel", "lamp"}) {
    const Light& light = light_of(scene, name);
    const Path jump = find_path(scene, "light_jump", light, scene.views[0]);
    const auto dark = [&](int frame) {
      double pixels = 0;
      for (int column = 240; column < 400; ++column) pixels += 1 - shares.at(light_at(jump, light, frame), 100, column);
      return pixels;
    };
    EXPECT_NEAR(dark(0), 80, 1e-3) << name;
    EXPECT_NEAR(std::abs(dark(1) - dark(0)), 100 * 0.05 * std::sqrt(46) * 6 / std::sqrt(37), 1e-2) << name;
    EXPECT_EQ(dark(80), dark(1)) << name;
  }
}

}  // namespace straight_penumbra_test
