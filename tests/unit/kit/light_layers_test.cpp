// The pictures of depth images and of their texels, against rectangles and lengths by hand.
#include <gnomon/kit/maps/light_layers.h>
#include <gtest/gtest.h>

#include "small_world.h"

namespace light_layers_test {
using namespace gnomon;

constexpr int width = 96, height = 64;
const Light down{.name = "sun", .kind = DirectionalLight{{0, -1, 0}}};

/// The rectangle |x| <= half_x, |z| <= half_z at y = 0.
Scene floor_of(float half_x, float half_z) {
  Scene scene;
  scene.meshes = {small_world::ground(1)};
  for (glm::vec3& p : scene.meshes[0].positions) p *= glm::vec3(half_x, 1, half_z);
  return scene;
}

GBuffer from_above(const Scene& scene, float eye, float tangent) {
  return small_world::make_gbuffer(scene,
                                   {.eye = {0, eye, 0},
                                    .target = {0, 0, 0},
                                    .up = {0, 0, -1},
                                    .fov_y_degrees = static_cast<float>(glm::degrees(2 * std::atan(double(tangent))))},
                                   width, height);
}

std::vector<LookUp> look_ups_of(const LightCamera& camera, const Scene& scene, const Light& light, const GBuffer& g) {
  std::vector<LookUp> look_ups(g.size());
  for (std::size_t i = 0; i < g.size(); ++i) {
    if (!faces_light(scene, g, light, i)) continue;
    const auto [face, q] = camera.space.seen(g.position(i));
    const LightImage& image = camera.images[face];
    look_ups[i] = {static_cast<int>(face), glm::ivec2(glm::floor(image.place(q) * image.scale + image.offset))};
  }
  return look_ups;
}

glm::dvec3 color(const std::vector<float>& picture, std::size_t i) {
  return {picture[3 * i], picture[3 * i + 1], picture[3 * i + 2]};
}

glm::dvec3 swatch(const char* layer, const std::string& name) {
  for (const DebugLayer& known : map_layers())
    for (const Swatch& s : known.legend)
      if (known.name == layer && s.name == name) return s.color;
  throw Error("{} has no swatch {}", layer, name);
}

bool is_a_tone_of(const glm::dvec3& color, const glm::dvec3& swatch) {
  return glm::length(color) > 0 && glm::distance(glm::normalize(color), glm::normalize(swatch)) < 1e-5;
}

// As large as the sheet allows with its proportions kept: what is four times as wide as high fills the width, what is as much
// higher the height. The sheet shows x to the right and -z up.
TEST(light_layers, an_image_keeps_its_proportions_and_fills_the_sheet) {
  for (const auto& [half_x, half_z] : {std::pair(4.0f, 1.0f), std::pair(1.0f, 4.0f), std::pair(0.02f, 0.01f)}) {
    const LightCamera camera = fit_to_scene(down, mesh_boxes(floor_of(half_x, half_z)), 64, 1);
    ASSERT_EQ(camera.images.size(), 1u);
    const std::vector<float> depths(64 * 64, 0.5f);
    const auto picture = paint_map(camera, width, height, [&](std::size_t) { return std::span<const float>(depths); });
    glm::ivec2 low(width, height), high(-1);
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < width; ++x)
        if (color(picture, static_cast<std::size_t>(y) * width + x) != glm::dvec3(background_color()))
          low = glm::min(low, glm::ivec2(x, y)), high = glm::max(high, glm::ivec2(x, y));
    const glm::dvec2 size = glm::dvec2(high - low + 1), extent(half_x, half_z);
    const double fill = std::min(width / extent.x, height / extent.y);
    EXPECT_NEAR(size.x, extent.x * fill, 1) << half_x << " x " << half_z;
    EXPECT_NEAR(size.y, extent.y * fill, 1) << half_x << " x " << half_z;
    EXPECT_NEAR(low.x + high.x, width - 1, 1);
    EXPECT_NEAR(low.y + high.y, height - 1, 1);
  }
}

// From straight above a plane all texels are of one size: 31 a meter of a floor of side 2 in 62 texels. Where one is longer
// than a pixel every other one is darker, the more the longer it is, up to two pixels.
TEST(light_layers, texels_have_the_color_of_their_length_and_are_checkered_where_they_show) {
  const Scene scene = floor_of(1, 1);
  const LightCamera camera = fit_to_scene(down, mesh_boxes(scene), 64, 1);
  const std::vector<float> lit(std::size_t{width} * height, 1.0f);
  for (const auto& [tangent, name] :
       {std::pair(0.6f, "to 1/2 pixel"), std::pair(0.3f, "to 1"), std::pair(0.2f, "to 2"), std::pair(0.1f, "to 4"),
        std::pair(0.05f, "to 8"), std::pair(0.02f, "to 16"), std::pair(0.01f, "more")}) {
    const GBuffer g = from_above(scene, 4, tangent);
    const std::vector<LookUp> look_ups = look_ups_of(camera, scene, down, g);
    const auto picture = paint_texels(camera, scene, g, down, look_ups, lit);
    const double length = 2.0 / 62 / (2 * 4 * tangent / height), darker = 1 - 0.4 * std::clamp(length - 1, 0.0, 1.0);
    double brightness[2] = {0, 0};
    for (std::size_t i = 0; i < g.size(); ++i) {
      if (look_ups[i].image < 0) continue;
      EXPECT_TRUE(is_a_tone_of(color(picture, i), swatch("texels", name))) << tangent << ", " << i;
      const glm::dvec3 to_eye = glm::normalize(glm::dvec3(0, 4, 0) - glm::dvec3(g.position(i)));
      const int parity = (look_ups[i].texel.x + look_ups[i].texel.y) % 2;
      const double share = color(picture, i).r / swatch("texels", name).r / (0.65 + 0.35 * to_eye.y);
      if (brightness[parity] == 0) brightness[parity] = share;
      EXPECT_NEAR(share, brightness[parity], 1e-4);
    }
    if (brightness[0] > 0 && brightness[1] > 0) {
      EXPECT_NEAR(brightness[1] / brightness[0], darker, 0.02) << tangent;
    }
  }
}

// Two pixels before another image's points begin, in any of four ways within the picture.
TEST(light_layers, rims_are_two_pixels_wide_and_end_with_the_picture) {
  const Scene scene = floor_of(4, 4);
  const Light lamp{.name = "point", .kind = PointLight{{0.3f, 1, 0.2f}}};
  const LightCamera camera = fit_to_scene(lamp, mesh_boxes(scene), 64, 1);
  const GBuffer g = from_above(scene, 9, 0.28f);
  const std::vector<LookUp> look_ups = look_ups_of(camera, scene, lamp, g);
  const std::vector<float> lit(g.size(), 1.0f);
  const auto picture = paint_texels(camera, scene, g, lamp, look_ups, lit);
  const char* const faces[] = {"+x", "-x", "+y", "-y", "+z", "-z"};
  int rims = 0, at_border = 0;
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const std::size_t i = static_cast<std::size_t>(y) * width + x;
      bool is_rim = false;
      for (const glm::ivec2& way : {glm::ivec2(2, 0), glm::ivec2(-2, 0), glm::ivec2(0, 2), glm::ivec2(0, -2)}) {
        const int u = x + way.x, v = y + way.y;
        if (u >= 0 && v >= 0 && u < width && v < height)
          is_rim |= look_ups[static_cast<std::size_t>(v) * width + u].image != look_ups[i].image;
      }
      EXPECT_EQ(is_a_tone_of(color(picture, i), swatch("texels", faces[look_ups[i].image])), is_rim) << x << ", " << y;
      rims += is_rim;
      at_border += is_rim && (x < 2 || y < 2 || x >= width - 2 || y >= height - 2);
    }
  EXPECT_GT(rims, 200);
  EXPECT_GT(at_border, 4);
}

}  // namespace light_layers_test
