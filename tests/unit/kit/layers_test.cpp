#include <gnomon/kit/pictures/layers.h>
#include <gtest/gtest.h>

#include <stdexcept>

#include "measure/cause/color_vision.h"
#include "small_world.h"

namespace layers_test {

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

TEST(layers, heat_classes_are_told_apart_and_grow_lighter) {
  const std::vector<Swatch> legend = heat_legend();
  std::vector<std::string> names;
  for (const Swatch& s : legend) names.push_back(s.name);
  EXPECT_EQ(names, (std::vector<std::string>{"1", "2", "3", "4", "5-8", "9-16", "17-32", "33-64", "65-128", "129-256",
                                             "257 and more"}));
  for (std::size_t i = 1; i < legend.size(); ++i) {
    EXPECT_GT(luminance(legend[i].color), 1.1 * luminance(legend[i - 1].color)) << legend[i].name;
    for (std::size_t k = 0; k < i; ++k)
      EXPECT_GT(difference(legend[i].color, legend[k].color), 7 * 2.3) << legend[i].name << ", " << legend[k].name;
  }
  // From dark blue to yellow.
  const glm::dvec3 first = legend.front().color, last = legend.back().color;
  EXPECT_TRUE(first.b > 5 * first.r && first.b > 5 * first.g && luminance(first) < 0.05);
  EXPECT_TRUE(last.r > 4 * last.b && last.g > 4 * last.b && luminance(last) > 0.7);
}

// In most scenes a point lies in few shadow volumes: their counts have to be told apart at a glance, by people who lack a kind
// of cone, too, and from the red of what is negative.
TEST(layers, the_first_three_heat_classes_and_negative_values_look_different_to_everybody) {
  const auto bytes = [](const glm::dvec3& color) {
    std::array<std::uint8_t, 3> srgb;
    for (int c = 0; c < 3; ++c) {
      const double v = color[c];
      srgb[c] =
          static_cast<std::uint8_t>(std::lround(255 * (v <= 0.0031308 ? 12.92 * v : 1.055 * std::pow(v, 1 / 2.4) - 0.055)));
    }
    return srgb;
  };
  const std::vector<Swatch> legend = heat_legend();
  for (const glm::dmat3& vision : color_vision::visions) {
    const bool has_all_cones = &vision == color_vision::visions;
    const auto apart = [&](const glm::dvec3& a, const glm::dvec3& b) {
      return glm::distance(color_vision::lab(bytes(a), vision), color_vision::lab(bytes(b), vision));
    };
    for (std::size_t i = 0; i < legend.size(); ++i) {
      EXPECT_GT(apart(legend[i].color, negative_heat()), has_all_cones ? 90 : 17) << legend[i].name;
      for (std::size_t k = 0; k < i; ++k)
        EXPECT_GT(apart(legend[i].color, legend[k].color), i < 3 ? (has_all_cones ? 60 : 30) : (has_all_cones ? 18 : 10))
            << legend[i].name << ", " << legend[k].name;
    }
  }
}

TEST(layers, heat_layer_gives_a_value_the_color_of_its_class) {
  const std::vector<Swatch> legend = heat_legend();
  // The first and the last of each class, then values that are not whole: they have the class of the rounded value, and one
  // above 0 is at least in that of 1.
  const std::vector<std::pair<float, std::size_t>> expected{
      {1, 0},     {2, 1},    {3, 2},    {4, 3},    {5, 4},    {8, 4},    {9, 5},       {16, 5},      {17, 6},
      {32, 6},    {33, 7},   {64, 7},   {65, 8},   {128, 8},  {129, 9},  {256, 9},     {257, 10},    {1e30f, 10},
      {1e-9f, 0}, {0.4f, 0}, {1.4f, 0}, {1.5f, 1}, {8.4f, 4}, {8.5f, 5}, {256.25f, 9}, {256.5f, 10}, {4.75f, 4}};
  const GBuffer g = nine_pixels();
  for (std::size_t first = 0; first < expected.size(); first += 9) {
    std::vector<float> values;
    for (std::size_t i = 0; i < 9; ++i) values.push_back(expected[first + i].first);
    const std::vector<float> picture = heat_layer(g, values);
    for (std::size_t i = 0; i < 9; ++i)
      EXPECT_EQ(color(picture, i), Color(legend[expected[first + i].second].color)) << expected[first + i].first;
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
  EXPECT_EQ(color(picture, 7), Color(heat_legend()[0].color)) << "unless it has a value";
  for (const std::size_t i : {1, 2, 8}) {
    EXPECT_GT(color(picture, i).r, 0.6);
    EXPECT_LT(color(picture, i).g, 0.05);
    EXPECT_LT(color(picture, i).b, 0.05);
  }
  // Without any value the picture is the scene alone, and no division by zero shows.
  for (const float channel : heat_layer(g, std::vector<float>(9))) EXPECT_TRUE(channel >= 0 && channel < 0.2);
}

/// The color of that name in the legend of a layer of shadow volumes.
Color named(const std::string& layer, const std::string& name) {
  for (const DebugLayer& known : volume_layers())
    for (const Swatch& s : known.legend)
      if (known.name == layer && s.name == name) return s.color;
  throw std::invalid_argument(layer + " has no color " + name);
}

void expect_color(const Color& is, const Color& wanted, const std::string& where) {
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(is[c], wanted[c], 1e-5) << where << ", channel " << c;
}

TEST(layers, painted_sides_hide_a_quarter_by_each_face_whatever_the_order) {
  // Over white, a channel under n orange faces is 0.75^n + (1 - 0.75^n) b, b the channel of orange: after one, two, three faces
  // the picture's share is 0.75, 0.5625, 0.421875.
  std::vector<VolumeFaces> faces(5);
  for (int n = 0; n < 4; ++n) faces[n].front_sides = static_cast<float>(n);
  faces[4].front_sides = 1000;
  std::vector<float> picture(15, 1.0f);
  paint_volumes(faces, 5, picture);
  const Color orange = named("volumes", "entered"), white(1);
  EXPECT_EQ(color(picture, 0), white) << "no face, no change";
  expect_color(color(picture, 1), 0.75f * white + 0.25f * orange, "one face");
  expect_color(color(picture, 2), 0.5625f * white + 0.4375f * orange, "two faces");
  expect_color(color(picture, 3), 0.421875f * white + 0.578125f * orange, "three faces");
  expect_color(color(picture, 4), orange, "very many are the color itself");

  // Painting two and then one is the same as three at once.
  std::vector<float> twice(3, 1.0f);
  paint_volumes(std::span(faces).subspan(2, 1), 1, twice);
  paint_volumes(std::span(faces).subspan(1, 1), 1, twice);
  expect_color(color(twice, 0), color(picture, 3), "two and one");
}

TEST(layers, painted_sides_mix_by_what_each_kind_hides_alone) {
  const Color orange = named("volumes", "entered"), teal = named("volumes", "left"),
              both = named("volumes", "entered and left");
  // One of each kind hides 1 - 0.75^2 = 0.4375, in equal parts. Two front sides hide 0.4375 alone and one back side 0.25: of
  // the 1 - 0.75^3 = 0.578125 hidden, 0.4375 / 0.6875 are orange.
  const std::vector<VolumeFaces> faces{
      {.back_sides = 1}, {.front_sides = 1, .back_sides = 1}, {.front_sides = 2, .back_sides = 1}};
  std::vector<float> picture(9, 0.0f);
  paint_volumes(faces, 3, picture);
  expect_color(color(picture, 0), 0.25f * teal, "back side");
  expect_color(color(picture, 1), 0.4375f * both, "one of each");
  expect_color(color(picture, 1), 0.21875f * (orange + teal), "one of each");
  expect_color(color(picture, 2), 0.578125f * (0.4375f * orange + 0.25f * teal) / 0.6875f, "two and one");
  // The mixture is nearly gray: its channels are within a third of each other, while those of its parts are far apart.
  EXPECT_LT(std::max({both.r, both.g, both.b}), 4.0 / 3 * std::min({both.r, both.g, both.b}));
  EXPECT_GT(orange.r, 50 * orange.b);
  EXPECT_GT(teal.b, 20 * teal.r);
}

TEST(layers, painted_colors_are_told_apart) {
  for (const DebugLayer& layer : volume_layers())
    for (const Swatch& a : layer.legend)
      for (const Swatch& b : layer.legend)
        if (&a < &b) {
          EXPECT_GT(difference(a.color, b.color), 7 * 2.3) << layer.name << ": " << a.name << ", " << b.name;
        }
}

TEST(layers, painted_caps_are_lines_over_an_untouched_picture) {
  constexpr int width = 37, height = 24;
  const Color gray(0.25f);
  const auto painted = [&](const VolumeFaces& everywhere) {
    const std::vector<VolumeFaces> faces(width * height, everywhere);
    std::vector<float> picture(3 * faces.size(), gray.r);
    paint_volumes(faces, width, picture);
    return picture;
  };
  const std::vector<float> light = painted({.light_caps = 1}), dark = painted({.dark_caps = 2});
  const Color on_light = 0.5f * (gray + named("volumes", "light cap"));
  const Color on_dark = 0.25f * gray + 0.75f * named("volumes", "dark cap");
  for (int y = 0; y < height; ++y) {
    int light_in_row = 0, dark_in_row = 0;
    for (int x = 0; x < width; ++x) {
      const int i = y * width + x;
      const bool is_light = color(light, i) != gray, is_dark = color(dark, i) != gray;
      if (is_light) expect_color(color(light, i), on_light, "light cap");
      if (is_dark) expect_color(color(dark, i), on_dark, "dark caps");
      light_in_row += is_light, dark_in_row += is_dark;
      // A line goes on in the next row: that of light caps to the left, that of dark caps to the right.
      if (y + 1 == height) continue;
      if (x > 0) {
        EXPECT_EQ(is_light, color(light, i + width - 1) != gray) << x << ' ' << y;
      }
      if (x + 1 < width) {
        EXPECT_EQ(is_dark, color(dark, i + width + 1) != gray) << x << ' ' << y;
      }
    }
    // A line at every eighth pixel: 4 or 5 in 37.
    for (const int found : {light_in_row, dark_in_row}) EXPECT_TRUE(found == 4 || found == 5) << "row " << y;
  }
  // Between the lines sides show as without caps.
  const std::vector<float> sides = painted({.front_sides = 1}),
                           all = painted({.front_sides = 1, .light_caps = 3, .dark_caps = 3});
  int changed = 0;
  for (int i = 0; i < width * height; ++i) changed += color(sides, i) != color(all, i);
  EXPECT_NEAR(changed, width * height * (1 / 4.0 - 1 / 32.0), width) << "where the lines cross, they count once";
}

}  // namespace layers_test
