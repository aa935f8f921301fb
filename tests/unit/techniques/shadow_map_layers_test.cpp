// What the pictures of a shadow map show.
#include <gnomon/kit/gl/gl.h>
#include <gtest/gtest.h>

#include "device/context.h"
#include "measure/conformance/gl_state.h"
#include "small_world.h"

extern "C" void gnomon_technique_shadow_map(gnomon::Registry&);

namespace shadow_map_layers_test {

using namespace small_world;

class ShadowMapLayers : public testing::Test {
 protected:
  ShadowMapLayers() { process_context(); }
  void TearDown() override { EXPECT_EQ(state_differences(), std::vector<std::string>{}); }

  /// The square |x|, |z| <= half around a point.
  static Mesh square(const glm::vec3& middle, float half, bool casts = true) {
    Mesh mesh = ground(half, middle.y, casts);
    for (glm::vec3& p : mesh.positions) p.x += middle.x, p.z += middle.z;
    return mesh;
  }
  static GBuffer from_above(const Scene& scene, float height, float tangent, int width, int height_pixels) {
    const View view{.eye = {0, height, 0},
                    .target = {0, 0, 0},
                    .up = {0, 0, -1},
                    .fov_y_degrees = static_cast<float>(glm::degrees(2 * std::atan(double(tangent))))};
    return make_gbuffer(scene, view, width, height_pixels);
  }
  static std::vector<float> picture(const Scene& scene, const Light& light, const GBuffer& g, const std::string& layer,
                                    const std::string& settings = "resolution=64") {
    return run(gnomon_technique_shadow_map, settings, scene, light, g).technique->draw_debug(layer);
  }
  static glm::dvec3 color(const std::vector<float>& p, std::size_t i) { return {p[3 * i], p[3 * i + 1], p[3 * i + 2]}; }
  static glm::dvec3 swatch(const std::string& layer, const std::string& name) {
    Registry registry;
    gnomon_technique_shadow_map(registry);
    for (const DebugLayer& known : registry.technique("shadow_map").make()->debug_layers())
      for (const Swatch& s : known.legend)
        if (known.name == layer && s.name == name) return s.color;
    throw Error("{} has no swatch {}", layer, name);
  }
  static bool is_a_tone_of(const glm::dvec3& color, const glm::dvec3& swatch) {
    return glm::length(color) > 0 && glm::distance(glm::normalize(color), glm::normalize(swatch)) < 1e-5;
  }
};

const Light down{.name = "sun", .kind = DirectionalLight{{0, -1, 0}}};

// A square of side 1 over a ground of side 4, both casting: 1/16 of the image is near, the rest far. Looking down, -z is up and
// +x to the right: the square at (1, -1), half of the ground's half side, has its middle a quarter of the image from top and
// right.
TEST_F(ShadowMapLayers, the_map_is_upright_not_mirrored_and_stretched_to_what_is_stored) {
  Scene scene;
  scene.meshes = {ground(2), square({1, 1, -1}, 0.5f)};
  const GBuffer g = from_above(scene, 9, 0.5f, 96, 64);
  const auto map = picture(scene, down, g, "map", "resolution=512");
  const double near = std::pow(0.2, 2.2), far = std::pow(0.82, 2.2);
  double near_count = 0, far_count = 0;
  glm::dvec2 middle(0), low(1e9), high(-1e9);
  for (std::size_t i = 0; i < g.size(); ++i) {
    const glm::dvec3 c = color(map, i);
    const glm::dvec2 at(static_cast<double>(i % 96) + 0.5, static_cast<double>(i / 96) + 0.5);
    const bool is_near = std::abs(c.r - near) < 0.02 || c.r < near, is_far = std::abs(c.r - far) < 1e-3;
    near_count += is_near && c.r == c.g && c.g == c.b, far_count += is_far;
    if (c.r == c.g && c.g == c.b) low = glm::min(low, at - 0.5), high = glm::max(high, at + 0.5);
    if (is_near && c.r == c.g && c.g == c.b) middle += at;
  }
  // Proportions are kept: the ground is a square, but for the margin of a texel or two.
  EXPECT_NEAR(high.x - low.x, 64, 1.5);
  EXPECT_NEAR(high.y - low.y, 64, 1.5);
  EXPECT_NEAR(low.x, 16, 1.5);
  EXPECT_NEAR(near_count / (near_count + far_count), 1 / 16.0, 0.02) << "lines where depth jumps are as dark";
  middle = (middle / near_count - low) / (high - low);
  EXPECT_NEAR(middle.x, 0.75, 0.02);
  EXPECT_NEAR(middle.y, 0.25, 0.02);
}

// Around a point light six images of 3 x 2 cells; the one that looks down is the first of the lower row. Seen from (0, 4, 0),
// the ground fills its image, and the square is to the right and above.
TEST_F(ShadowMapLayers, six_images_lie_on_a_sheet_in_frames) {
  Scene scene;
  scene.meshes = {ground(2), square({1, 1, -1}, 0.5f)};
  const GBuffer g = from_above(scene, 9, 0.5f, 96, 64);
  const auto map = picture(scene, {.name = "point", .kind = PointLight{{0, 4, 0}}}, g, "map", "resolution=512");
  glm::dvec2 middle(0);
  int near_count = 0;
  const char* const faces[] = {"+x", "-x", "+y", "-y", "+z", "-z"};
  int framed[6] = {};
  for (std::size_t i = 0; i < g.size(); ++i) {
    const int x = static_cast<int>(i % 96), y = static_cast<int>(i / 96), cell = y / 32 * 3 + x / 32;
    const glm::dvec3 c = color(map, i);
    for (int f = 0; f < 6; ++f)
      if (is_a_tone_of(c, swatch("map", faces[f]))) {
        EXPECT_EQ(cell, f);
        ++framed[f];
      }
    const bool is_gray = c.r == c.g && c.g == c.b;
    if (is_gray) {
      EXPECT_EQ(cell, 3) << "only the image that looks down is drawn";
    }
    if (is_gray && c.r < 0.1) ++near_count, middle += glm::dvec2(x % 32 + 0.5, y % 32 + 0.5);
  }
  for (const int count : framed) EXPECT_GT(count, 40);
  ASSERT_GT(near_count, 10);
  middle /= near_count;
  EXPECT_GT(middle.x, 19);
  EXPECT_LT(middle.y, 13);
}

// A ground of side 2 in 64 texels less one on either side: 31 texels a meter. At 10 pixels a meter a texel is 0.32 pixels long,
// at 100 it is 3.2 pixels and checkered: along a row the tone changes every 3.2 pixels.
TEST_F(ShadowMapLayers, texels_have_the_size_that_they_have_on_the_surface) {
  Scene scene;
  scene.meshes = {ground(1)};
  const GBuffer coarse = from_above(scene, 4, 0.5f, 80, 40), fine = from_above(scene, 4, 0.05f, 80, 40);
  const auto small = picture(scene, down, coarse, "texels"), large = picture(scene, down, fine, "texels");
  int seen = 0;
  for (std::size_t i = 0; i < coarse.size(); ++i) {
    if (!coarse.is_background(i)) {
      EXPECT_TRUE(is_a_tone_of(color(small, i), swatch("texels", "to 1/2 pixel"))) << i;
      ++seen;
    }
    EXPECT_TRUE(is_a_tone_of(color(large, i), swatch("texels", "to 4"))) << i;
  }
  EXPECT_EQ(seen, 20 * 20);
  int changes = 0, changes_down = 0;
  for (int x = 0; x + 1 < 80; ++x) changes += std::abs(large[3 * (80 * 20 + x)] - large[3 * (80 * 20 + x + 1)]) > 0.1;
  for (int y = 0; y + 1 < 40; ++y) changes_down += std::abs(large[3 * (80 * y + 40)] - large[3 * (80 * (y + 1) + 40)]) > 0.1;
  EXPECT_NEAR(changes, 79 / 3.226, 1.01);
  EXPECT_NEAR(changes_down, 39 / 3.226, 1.01);
}

// Where light falls 60 degrees off the normal a texel as long as wide is twice as long on the surface.
TEST_F(ShadowMapLayers, the_longer_way_of_a_texel_counts) {
  Scene scene;
  scene.meshes = {ground(1)};
  const GBuffer g = from_above(scene, 4, 0.05f, 80, 40);
  const Light slanted{.name = "sun", .kind = DirectionalLight{{std::sqrt(3.0f), -1, 0}}};
  // The image shows 2 by 1 meters in 62 by 62 texels: on the ground 0.0323 by 0.0323 m again, 3.2 pixels both ways.
  const auto fitted = picture(scene, slanted, g, "texels");
  EXPECT_TRUE(is_a_tone_of(color(fitted, 80 * 20 + 40), swatch("texels", "to 4")));
  // Height in the image is (x + sqrt(3) y) / 2: from -1/2 to 1/2 on the ground, and 3/2 at the top of a wall that is 4 /
  // sqrt(3) high at x = -1. 2 by 2 meters are shown then: on the ground 0.0323 by 0.0645 m, 6.5 pixels.
  scene.meshes.push_back(make_mesh({{-1, 0, -1}, {-1, 0, 1}, {-1, 4 / std::sqrt(3.0f), -1}}, {{0, 1, 2}}));
  const GBuffer with_wall = from_above(scene, 4, 0.05f, 80, 40);
  const auto wider = picture(scene, slanted, with_wall, "texels");
  EXPECT_TRUE(is_a_tone_of(color(wider, 80 * 20 + 40), swatch("texels", "to 8")));
}

// Images are fitted to what casts: beyond the square's surroundings the ground is in none, and lit.
TEST_F(ShadowMapLayers, receivers_beside_the_map_are_shown_as_such) {
  Scene scene;
  scene.meshes = {ground(2, 0, false), square({0, 1, 0}, 0.25f)};
  const GBuffer g = from_above(scene, 9, 0.25f, 80, 40);
  for (const Light& light : {down, Light{.name = "point", .kind = PointLight{{0, 6, 0}}}}) {
    const auto texels = picture(scene, light, g, "texels");
    const auto at = [&](double x, double z) {
      // 40 pixels over 4.5 meters at the ground.
      return color(texels, 80 * static_cast<std::size_t>(20 + z * 40 / 4.5) + static_cast<std::size_t>(40 + x * 40 / 4.5));
    };
    EXPECT_TRUE(is_a_tone_of(at(1.5, 1), swatch("texels", "not in the map: lit")));
    EXPECT_TRUE(is_a_tone_of(at(-0.6, -1), swatch("texels", "not in the map: lit")));
    EXPECT_FALSE(is_a_tone_of(at(0, 0), swatch("texels", "not in the map: lit")));
  }
}

// The pyramid that looks down from a meter above the ground leaves a square of side 2; around it are the four that look aside.
TEST_F(ShadowMapLayers, images_that_meet_on_a_surface_have_rims) {
  Scene scene;
  scene.meshes = {ground(4)};
  const GBuffer g = from_above(scene, 9, 0.5f, 80, 40);
  const auto texels = picture(scene, {.name = "point", .kind = PointLight{{0, 1, 0}}}, g, "texels");
  for (const char* const face : {"+x", "-x", "-y", "+z", "-z"}) {
    int count = 0;
    for (std::size_t i = 0; i < g.size(); ++i) count += is_a_tone_of(color(texels, i), swatch("texels", face));
    EXPECT_GT(count, 8) << face;
  }
}

}  // namespace shadow_map_layers_test
