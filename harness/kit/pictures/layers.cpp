#include <gnomon/kit/pictures/layers.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

namespace gnomon {

namespace {

/// Linear light of the colors that the page shows as sRGB 24, 26, 30.
constexpr glm::dvec3 background{0.0091, 0.0103, 0.0130};

void put(std::vector<float>& picture, std::size_t i, const glm::dvec3& color) {
  for (int c = 0; c < 3; ++c) picture[3 * i + c] = static_cast<float>(std::clamp(color[c], 0.0, 1.0));
}

double luminance(const glm::dvec3& color) { return glm::dot(color, glm::dvec3(0.2126, 0.7152, 0.0722)); }

/// Linear light of a color given in sRGB bytes (IEC 61966-2-1).
glm::dvec3 linear(int r, int g, int b) {
  const auto channel = [](double byte) {
    const double x = byte / 255;
    return x <= 0.04045 ? x / 12.92 : std::pow((x + 0.055) / 1.055, 2.4);
  };
  return {channel(r), channel(g), channel(b)};
}

/// Values up to `last` that are above the last of the class before.
struct HeatClass {
  Swatch swatch;
  float last;
};

/// The few layers that most pixels have differ in hue: 1 dark blue, 2 green, 3 magenta, 4 violet. From 5 on the hue goes on
/// from blue over green to yellow. Each is lighter than the one before, so that classes differ in gray, too. In CIE L*a*b* the
/// first three lie 68 apart, 32 to people without one kind of cone; any two classes 18, or 11.
const std::vector<HeatClass> heat_classes{{{"1", linear(27, 37, 96)}, 1},
                                          {{"2", linear(28, 116, 14)}, 2},
                                          {{"3", linear(193, 0, 188)}, 3},
                                          {{"4", linear(128, 75, 254)}, 4},
                                          {{"5-8", linear(43, 130, 159)}, 8},
                                          {{"9-16", linear(29, 169, 151)}, 16},
                                          {{"17-32", linear(48, 199, 86)}, 32},
                                          {{"33-64", linear(117, 208, 67)}, 64},
                                          {{"65-128", linear(169, 217, 55)}, 128},
                                          {{"129-256", linear(193, 253, 12)}, 256},
                                          {{"257 and more", linear(245, 253, 122)}, std::numeric_limits<float>::infinity()}};

const Swatch negative{"negative", linear(220, 48, 39)};

const glm::dvec3& heat(float value) {
  const float whole = std::round(value);
  return std::ranges::find_if(heat_classes, [whole](const HeatClass& c) { return whole <= c.last; })->swatch.color;
}

/// Front sides, back sides, light caps, dark caps. One front and one back side mix to a nearly neutral haze.
const Swatch front{"entered", linear(235, 125, 20)}, back{"left", linear(30, 190, 210)},
    light_cap{"light cap", linear(250, 225, 70)}, dark_cap{"dark cap", linear(190, 70, 220)};

/// The lines of a hatching are one pixel wide and this far apart along a row.
constexpr int hatch_step = 8;

}  // namespace

glm::vec3 background_color() { return background; }

glm::vec3 shaded_color(const Mesh& mesh, const Light& light, const glm::dvec3& point, const glm::dvec3& normal,
                       float visibility) {
  const glm::dvec3 to = to_light(homogeneous_of_center(light), point);
  double received = 0;
  if (in_spot_cone(light, point)) received = std::max(0.0, glm::dot(normal, to) / std::max(glm::length(to), 1e-300));
  // Two thirds of the color are taken out and the brightest white is held at half, so that what is drawn over it stands out.
  const glm::dvec3 albedo = mesh.albedo;
  const glm::dvec3 muted = glm::mix(glm::dvec3(luminance(albedo)), albedo, 1 / 3.0);
  return glm::clamp(muted * (0.06 + 0.44 * received * visibility), 0.0, 1.0);
}

std::vector<float> shaded_layer(const Scene& scene, const GBuffer& gbuffer, const Light& light, std::span<const float> mask) {
  assert(mask.size() == gbuffer.size());
  std::vector<float> picture(gbuffer.size() * 3);
  for (std::size_t i = 0; i < gbuffer.size(); ++i) {
    glm::vec3 color = background;
    if (!gbuffer.is_background(i))
      color = shaded_color(scene.meshes[gbuffer.mesh[i]], light, gbuffer.position(i), gbuffer.normal(i), mask[i]);
    put(picture, i, color);
  }
  return picture;
}

std::vector<float> heat_layer(const GBuffer& gbuffer, std::span<const float> values) {
  assert(values.size() == gbuffer.size());
  std::vector<float> picture(gbuffer.size() * 3);
  const glm::dvec3 eye = gbuffer.view.eye;
  const auto color = [&](std::size_t i) {
    if (values[i] > 0) return heat(values[i]);
    if (values[i] < 0) return negative.color;
    if (gbuffer.is_background(i)) return background;
    // Lit from the eye: no light is given here, and the picture has to show only the shapes.
    const glm::dvec3 to_eye = glm::normalize(eye - glm::dvec3(gbuffer.position(i)));
    return glm::dvec3(0.02 + 0.10 * std::abs(glm::dot(glm::dvec3(gbuffer.normal(i)), to_eye)));
  };
  for (std::size_t i = 0; i < gbuffer.size(); ++i) put(picture, i, color(i));
  return picture;
}

glm::dvec3 negative_heat() { return negative.color; }

std::vector<Swatch> heat_legend() {
  std::vector<Swatch> legend;
  for (const HeatClass& c : heat_classes) legend.push_back(c.swatch);
  return legend;
}

std::vector<DebugLayer> volume_layers() {
  const Swatch both{"entered and left", (front.color + back.color) / 2.0};
  std::vector<Swatch> counts = heat_legend();
  counts.push_back(negative);
  return {{"volumes",
           "Faces of the shadow volumes between the eye and the surface: translucent sides, where a volume is entered or left, "
           "and hatched caps.",
           {front, back, both, light_cap, dark_cap}},
          {"counts", "Shadow volumes around each visible point: gray none, else colors as in the legend.", counts}};
}

void paint_volumes(std::span<const VolumeFaces> faces, int width, std::span<float> picture) {
  assert(picture.size() == 3 * faces.size() && width > 0 && faces.size() % width == 0);
  constexpr double left_by_side = 0.75, left_by_cap = 0.5;
  for (std::size_t i = 0; i < faces.size(); ++i) {
    const auto blend = [&](const glm::dvec3& color, double left) {
      for (int c = 0; c < 3; ++c) {
        float& channel = picture[3 * i + c];
        channel = static_cast<float>(left * channel + (1 - left) * color[c]);
      }
    };
    const auto left = [](double by_one, float count) { return std::pow(by_one, std::max(0.0f, count)); };
    // Each kind of side hides what it would hide alone; what is hidden is shared out among their colors in that proportion.
    const double left_by_front = left(left_by_side, faces[i].front_sides),
                 left_by_back = left(left_by_side, faces[i].back_sides);
    if (const double hidden = 2 - left_by_front - left_by_back; hidden > 0)
      blend(((1 - left_by_front) * front.color + (1 - left_by_back) * back.color) / hidden, left_by_front * left_by_back);

    const int x = static_cast<int>(i % width), y = static_cast<int>(i / width);
    if ((x + y) % hatch_step == 0) blend(light_cap.color, left(left_by_cap, faces[i].light_caps));
    if ((x - y) % hatch_step == 0) blend(dark_cap.color, left(left_by_cap, faces[i].dark_caps));
  }
}

}  // namespace gnomon
