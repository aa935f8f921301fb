// The debug layers of radiosity in an empty closed room, where what they show is known.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <set>

#include "device/context.h"
#include "small_world.h"

extern "C" void gnomon_technique_radiosity(gnomon::Registry&);

namespace radiosity_layers_test {
using namespace gnomon;

/// A box 2 m wide, seen from inside, with a lamp below its ceiling that shines down.
class RadiosityLayers : public testing::Test {
 protected:
  RadiosityLayers() {
    process_context();
    scene.meshes.push_back(small_world::box({-1, 0, -1}, {1, 2, 1}));
    scene.meshes[0].albedo = {0.6f, 0.4f, 0.2f};
    scene.views = {{.eye = {0.9f, 1, 0.9f}, .target = {-1, 1, -1}, .fov_y_degrees = 100}};
    gbuffer = small_world::make_gbuffer(scene, scene.views[0], width, height);
  }
  std::vector<float> draw(const std::string& settings, const char* layer) {
    return small_world::run(gnomon_technique_radiosity, settings, scene, lamp, gbuffer).technique->draw_debug(layer);
  }
  glm::vec3 color(const std::vector<float>& picture, std::size_t i) const {
    return {picture[3 * i], picture[3 * i + 1], picture[3 * i + 2]};
  }
  /// Calls use(pixel) where the eye sees the floor, or the ceiling.
  template <class Use>
  void for_each_at(float y, const Use& use) const {
    int count = 0;
    for (std::size_t i = 0; i < gbuffer.size(); ++i)
      if (std::abs(gbuffer.position(i).y - y) < 1e-4f) use(i), ++count;
    EXPECT_GT(count, 100);
  }

  static constexpr int width = 80, height = 60;
  Scene scene;
  GBuffer gbuffer;
  const Light lamp{
      .name = "lamp",
      .kind = RectLight{.center = {0, 1.9f, 0}, .half_u = {0.3f, 0, 0}, .half_v = {0, 0, 0.3f}, .emits = Emits::in_front}};
};

/// With patches as long as the room each surface that is seen is one patch, of one tone but for its borders.
TEST_F(RadiosityLayers, patches_have_a_tone_each) {
  const auto tones = [&](const char* settings) {
    std::map<std::array<float, 3>, int> counts;
    const std::vector<float> picture = draw(settings, "patches");
    for (std::size_t i = 0; i < gbuffer.size(); ++i) ++counts[{picture[3 * i], picture[3 * i + 1], picture[3 * i + 2]}];
    return std::ranges::count_if(counts, [](const auto& one) { return one.second >= 20; });
  };
  const auto whole = tones("patch_size=1,levels=0"), quarters = tones("patch_size=0.5,levels=0");
  std::set<std::array<float, 3>> normals;
  for (std::size_t i = 0; i < gbuffer.size(); ++i)
    normals.insert({gbuffer.normal(i).x, gbuffer.normal(i).y, gbuffer.normal(i).z});
  const auto seen = static_cast<std::ptrdiff_t>(normals.size());
  EXPECT_GE(whole, seen);
  EXPECT_LE(whole, 2 * seen);
  EXPECT_GT(quarters, whole);
}

/// Nothing casts, so nothing is divided; and a lamp that shines down leaves nothing unshot on the ceiling, but on the floor, in
/// the color of its albedo.
TEST_F(RadiosityLayers, unshot_light_lies_where_the_lamp_shines) {
  const std::vector<float> unshot = draw("patch_size=0.2", "unshot"), levels = draw("patch_size=0.2", "subdivision");
  const std::vector<float> undivided = draw("patch_size=0.2,levels=0", "subdivision");
  EXPECT_EQ(levels, undivided);
  for_each_at(2, [&](std::size_t i) { EXPECT_EQ(color(unshot, i), glm::vec3(0)); });
  for_each_at(0, [&](std::size_t i) {
    const glm::vec3 c = color(unshot, i);
    EXPECT_GT(c.z, 0);
    if (c.x < 1) {
      EXPECT_NEAR(c.z / c.x, 0.2f / 0.6f, 1e-4f);
    }
  });
}

/// Of the patch that is picked on the floor the others of the floor get nothing, all of one color, and those of the ceiling get
/// some; itself it is white.
TEST_F(RadiosityLayers, form_factors_are_those_of_the_picked_patch) {
  const std::vector<float> picture = draw("patch_size=0.25,levels=0,pick_x=0.5,pick_y=0.95", "form_factors");
  std::set<std::array<float, 3>> floor, ceiling;
  for_each_at(0, [&](std::size_t i) { floor.insert({picture[3 * i], picture[3 * i + 1], picture[3 * i + 2]}); });
  for_each_at(2, [&](std::size_t i) { ceiling.insert({picture[3 * i], picture[3 * i + 1], picture[3 * i + 2]}); });
  EXPECT_TRUE(floor.contains({1, 1, 1}));
  floor.erase({1, 1, 1});
  EXPECT_FALSE(ceiling.contains({1, 1, 1}));
  for (const auto& color : floor) EXPECT_FALSE(ceiling.contains(color));
}

/// In a closed room every texel sees a surface: the cross of the unfolded hemicube has the room's hue throughout, the corners
/// beside it none.
TEST_F(RadiosityLayers, the_hemicube_of_a_closed_room_has_no_hole) {
  const std::vector<float> picture = draw("patch_size=0.25,levels=0,pick_x=0.5,pick_y=0.95", "hemicube");
  int seen = 0;
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      // In units of half the height, from the middle: the cross is |x| < 1/2 or |y| < 1/2, both below 1.
      const double across = std::abs(x + 0.5 - width / 2.0) / (height / 2.0),
                   along = std::abs(y + 0.5 - height / 2.0) / (height / 2.0);
      const double nearer = std::min(across, along), farther = std::max(across, along);
      const glm::vec3 c = color(picture, static_cast<std::size_t>(y) * width + x);
      if (nearer > 0.55 || farther > 1.05) {
        EXPECT_EQ(c, glm::vec3(0.02f));
      }
      if (nearer > 0.45 || farther > 0.95) continue;
      ++seen;
      EXPECT_NEAR(c.y / c.x, 0.4f / 0.6f, 1e-4f) << x << ", " << y;
      EXPECT_GE(c.x, 0.6f * 0.6f - 1e-4f);
    }
  EXPECT_GT(seen, 1500);
  // Along each arm one patch follows the other: the floor's patch sees four of a wall from below to above.
  for (const glm::ivec2 way : {glm::ivec2(1, 0), glm::ivec2(-1, 0), glm::ivec2(0, 1), glm::ivec2(0, -1)}) {
    std::set<std::array<float, 3>> tones;
    for (int k = height / 4 + 1; k < height / 2 - 1; ++k) {
      const std::size_t i = static_cast<std::size_t>(height / 2 + way.y * k) * width + width / 2 + way.x * k;
      tones.insert({picture[3 * i], picture[3 * i + 1], picture[3 * i + 2]});
    }
    EXPECT_GE(tones.size(), 2u) << way.x << ", " << way.y;
  }
}

}  // namespace radiosity_layers_test
