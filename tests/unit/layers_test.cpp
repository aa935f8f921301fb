#include <gnomon/kit/layers.h>
#include <gtest/gtest.h>

#include "small_world.h"

namespace {

using namespace small_world;

using Color = glm::vec3;

Color color(const std::vector<float>& picture, std::size_t i) {
  return {picture[3 * i], picture[3 * i + 1], picture[3 * i + 2]};
}

/// Three by three pixels on the ground from straight above; the last row is background.
GBuffer nine_pixels() {
  struct Storage {
    std::vector<float> x{-1, 0, 1, -1, 0, 1, 0, 0, 0}, zero = std::vector<float>(9), z{-1, -1, -1, 0, 0, 0, 0, 0, 0};
    std::vector<float> up{1, 1, 1, 1, 1, 1, 0, 0, 0};
    std::vector<std::uint32_t> mesh{0, 0, 0, 0, 0, 0, no_mesh, no_mesh, no_mesh}, triangle = std::vector<std::uint32_t>(9);
  };
  const auto s = std::make_shared<Storage>();
  const View view{.eye = {0, 5, 0}, .target = {0, 0, 0}, .up = {0, 0, -1}};
  return {view, Truth::mesh, 3, 3, s->x, s->zero, s->z, s->zero, s->up, s->zero, s->mesh, s->triangle, s};
}

/// CIE 1976 difference of two linear sRGB colors; 2.3 is just noticed.
double difference(const Color& a, const Color& b) {
  const auto lab = [](const Color& rgb) {
    const glm::dvec3 c = rgb;
    // Of XYZ, each over its value for white.
    const glm::dvec3 xyz((0.4124 * c.r + 0.3576 * c.g + 0.1805 * c.b) / 0.9505, 0.2126 * c.r + 0.7152 * c.g + 0.0722 * c.b,
                         (0.0193 * c.r + 0.1192 * c.g + 0.9505 * c.b) / 1.089);
    const auto f = [](double t) { return t > 0.008856 ? std::cbrt(t) : 7.787 * t + 16.0 / 116; };
    return glm::dvec3(116 * f(xyz.y) - 16, 500 * (f(xyz.x) - f(xyz.y)), 200 * (f(xyz.y) - f(xyz.z)));
  };
  return glm::distance(lab(a), lab(b));
}

double luminance(const Color& c) { return 0.2126 * c.r + 0.7152 * c.g + 0.0722 * c.b; }

TEST(layers, shaded_layer_is_albedo_by_angle_and_mask) {
  Scene scene;
  scene.meshes.push_back(ground(2));
  scene.meshes[0].albedo = {0.5f, 0.5f, 0.5f};
  const GBuffer g = nine_pixels();
  // At 60 degrees from the vertical the ground receives one half: 0.5 (0.06 + 0.44 / 2) = 0.14; in shadow 0.5 * 0.06 = 0.03.
  const Light sun{.name = "sun", .kind = DirectionalLight{{std::sqrt(3.0f), -1, 0}}};
  const std::vector<float> mask{1, 0, 0.5f, 1, 1, 1, 1, 1, 1};
  const std::vector<float> picture = shaded_layer(scene, g, sun, mask);
  ASSERT_EQ(picture.size(), 27u);
  for (int c = 0; c < 3; ++c) {
    EXPECT_NEAR(picture[c], 0.14, 1e-6);
    EXPECT_NEAR(picture[3 + c], 0.03, 1e-6);
    EXPECT_NEAR(picture[6 + c], 0.085, 1e-6) << "half of it is lit";
    EXPECT_LT(picture[18 + c], 0.02) << "the background is dark";
  }
}

TEST(layers, shaded_layer_keeps_a_third_of_the_color_and_half_of_the_light) {
  Scene scene;
  scene.meshes.push_back(ground(2));
  scene.meshes[0].albedo = {1, 0, 0};
  const std::vector<float> lit(9, 1.0f);
  // Red of luminance 0.2126: the muted color is 2/3 of that in every channel and 1/3 of red on top; straight light gives 0.5.
  const Light sun{.name = "sun", .kind = DirectionalLight{{0, -1, 0}}};
  const Color red = color(shaded_layer(scene, nine_pixels(), sun, lit), 0);
  EXPECT_NEAR(red.r, 0.5 * (2 * 0.2126 / 3 + 1 / 3.0), 1e-6);
  EXPECT_NEAR(red.g, 0.5 * (2 * 0.2126 / 3), 1e-6);
  EXPECT_FLOAT_EQ(red.g, red.b);
  // Outside a spot light's cone only the ambient share of 0.06 is left.
  const Light spot{.name = "spot", .kind = SpotLight{{0, 1, 0}, {0, -1, 0}, 1, 2}};
  EXPECT_NEAR(color(shaded_layer(scene, nine_pixels(), spot, lit), 0).r, 0.06 * (2 * 0.2126 / 3 + 1 / 3.0), 1e-6);
}

TEST(layers, heat_layer_tells_small_numbers_apart_and_grows_lighter) {
  const GBuffer g = nine_pixels();
  for (const float largest : {2.0f, 4.0f, 8.0f}) {
    std::vector<float> values(9);
    for (std::size_t i = 0; i < 9; ++i) values[i] = std::min(static_cast<float>(i), largest);
    const std::vector<float> picture = heat_layer(g, values);
    for (std::size_t i = 1; i <= static_cast<std::size_t>(largest); ++i) {
      EXPECT_GT(difference(color(picture, i - 1), color(picture, i)), 3 * 2.3) << i << " of " << largest;
      if (i == 1) continue;  // zero is gray and no step of the scale
      EXPECT_GT(luminance(color(picture, i)), luminance(color(picture, i - 1))) << i << " of " << largest;
    }
    const Color most = color(picture, static_cast<std::size_t>(largest));
    EXPECT_GT(most.r, 0.9);
    EXPECT_GT(most.g, 0.7);
    EXPECT_LT(most.b, 0.1) << "yellow";
  }
}

TEST(layers, heat_layer_leaves_zero_gray_and_shows_negative_values_red) {
  const GBuffer g = nine_pixels();
  const std::vector<float> values{0, -1, -300, 0, 0, 0, 0, 1, -1};
  const std::vector<float> picture = heat_layer(g, values);
  const auto is_gray = [](const Color& c) { return c.r == c.g && c.g == c.b; };
  EXPECT_TRUE(is_gray(color(picture, 0)));
  // Seen straight from above: 0.02 + 0.10.
  EXPECT_NEAR(color(picture, 4).r, 0.12, 1e-6);
  EXPECT_LT(color(picture, 6).g, 0.02) << "the background is dark";
  EXPECT_GT(color(picture, 7).r, 0.9) << "unless it has a value";
  for (const std::size_t i : {1, 2, 8}) {
    EXPECT_GT(color(picture, i).r, 0.6);
    EXPECT_LT(color(picture, i).g, 0.05);
    EXPECT_LT(color(picture, i).b, 0.05);
  }
  // Without any value the picture is the scene alone, and no division by zero shows.
  for (const float channel : heat_layer(g, std::vector<float>(9))) EXPECT_TRUE(channel >= 0 && channel < 0.2);
}

TEST(layers, painted_volumes_hide_a_fifth_by_each_face_whatever_the_order) {
  // Over white, blue's channel under n orange faces is 0.8^n + (1 - 0.8^n) b, b the blue of orange: after one, two, three faces
  // the picture's share is 0.8, 0.64, 0.512.
  std::vector<VolumeFaces> faces(4);
  for (int n = 0; n < 4; ++n) faces[n].front_sides = static_cast<float>(n);
  std::vector<float> picture(12, 1.0f);
  paint_volumes(faces, picture);
  EXPECT_EQ(picture[2], 1.0f) << "no face, no change";
  const double b = 1 - (1 - picture[5]) / 0.2;
  EXPECT_NEAR(picture[8], 0.64 + 0.36 * b, 1e-6);
  EXPECT_NEAR(picture[11], 0.512 + 0.488 * b, 1e-6);

  // Painting two and then one is the same as three at once.
  std::vector<float> twice(3, 1.0f);
  paint_volumes(std::span(faces).subspan(2, 1), twice);
  paint_volumes(std::span(faces).subspan(1, 1), twice);
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(twice[c], picture[9 + c], 1e-6);
}

TEST(layers, painted_kinds_mix_by_what_each_hides_alone) {
  std::vector<VolumeFaces> faces(6);
  faces[0].front_sides = faces[1].back_sides = faces[2].light_caps = faces[3].dark_caps = 1;
  faces[4] = {.front_sides = 1, .back_sides = 1, .light_caps = 1, .dark_caps = 1};
  faces[5] = {.front_sides = 1000};
  std::vector<float> picture(18, 0.0f);
  paint_volumes(faces, picture);
  // One face of each kind: 1 - 0.8^4 = 0.5904 is hidden, in equal parts; one alone shows 0.2 of its color over black.
  for (int c = 0; c < 3; ++c) {
    const double mean = (picture[c] + picture[3 + c] + picture[6 + c] + picture[9 + c]) / (4 * 0.2);
    EXPECT_NEAR(picture[12 + c], 0.5904 * mean, 1e-6);
    EXPECT_NEAR(picture[15 + c], picture[c] / 0.2, 1e-5) << "very many are the color itself";
  }
  // The four colors are told apart: hues are orange, blue, yellow, violet.
  for (int a = 0; a < 4; ++a)
    for (int b = 0; b < a; ++b) EXPECT_GT(difference(color(picture, a), color(picture, b)), 10 * 2.3) << a << " " << b;
}

}  // namespace
