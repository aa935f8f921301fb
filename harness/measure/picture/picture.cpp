#include "measure/picture/picture.h"

#include <gnomon/kit/irradiance.h>
#include <gnomon/kit/parallel.h>

#include <cassert>
#include <cmath>

#include "measure/part_file.h"
#include "measure/picture/legend.h"

namespace gnomon {

namespace fs = std::filesystem;

std::uint8_t srgb(double linear) {
  const double x = std::clamp(linear, 0.0, 1.0);
  return static_cast<std::uint8_t>(std::lround(255 * (x <= 0.0031308 ? 12.92 * x : 1.055 * std::pow(x, 1 / 2.4) - 0.055)));
}

const SrgbSteps& srgb_steps() {
  static const SrgbSteps table = [] {
    SrgbSteps steps;
    for (int i = 0; i <= 4096; ++i) steps[i] = srgb(i / 4096.0);
    return steps;
  }();
  return table;
}

std::vector<double> received_light(const GBuffer& gbuffer, const Light& light) {
  std::vector<double> received(gbuffer.size());
  for_blocks(received.size(), 4096, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      if (!gbuffer.is_background(i)) received[i] = irradiance(light, gbuffer.position(i), gbuffer.normal(i));
  });
  return received;
}

std::string percent(double share) { return fmt::format("{:.{}f} %", 100 * share, share < 0.001 ? 4 : share < 0.1 ? 2 : 1); }

double exposure_of(const Scene& scene, const GBuffer& gbuffer, std::span<const double> received) {
  if (gbuffer.view.exposure > 0) return gbuffer.view.exposure;
  std::vector<double> lit;
  std::ranges::copy_if(received, std::back_inserter(lit), [](double irradiance) { return irradiance > 0; });
  if (lit.empty()) return 1;
  const auto bright = lit.begin() + static_cast<std::ptrdiff_t>(lit.size() - 1 - lit.size() / 10);
  std::ranges::nth_element(lit, bright);
  return (scene.ambient < 1 ? 1 - scene.ambient : 1) / *bright;
}

namespace {

/// Under the exposed light that `light_at` gives for a pixel, white or by channel.
template <class LightAt>
Picture shade_under(const Scene& scene, const GBuffer& gbuffer, const LightAt& light_at) {
  Picture picture{gbuffer.width, gbuffer.height, std::vector<std::uint8_t>(gbuffer.size() * 3)};
  const SrgbSteps& steps = srgb_steps();
  for (std::size_t i = 0; i < gbuffer.size(); ++i) {
    Color color = background_srgb;
    if (!gbuffer.is_background(i)) color = shaded_srgb(steps, scene.meshes[gbuffer.mesh[i]].albedo, light_at(i));
    std::ranges::copy(color, &picture.rgb[3 * i]);
  }
  return picture;
}

}  // namespace

Picture shade(const Scene& scene, const GBuffer& gbuffer, const Light& light, std::span<const float> visibility) {
  return shade(scene, gbuffer, received_light(gbuffer, light), visibility);
}

Picture shade(const Scene& scene, const GBuffer& gbuffer, std::span<const double> received, std::span<const float> shares,
              double white) {
  const double exposure = exposure_of(scene, gbuffer, received);
  return shade_under(scene, gbuffer,
                     [&](std::size_t i) { return (scene.ambient + exposure * received[i] * shares[i]) / white; });
}

Picture shade(const Scene& scene, const GBuffer& gbuffer, const std::array<ChannelLight, 3>& channels, double exposure) {
  return shade_under(scene, gbuffer, [&](std::size_t i) {
    glm::dvec3 light(scene.ambient);
    for (int c = 0; c < 3; ++c)
      if (!channels[c].received.empty()) light[c] += exposure * channels[c].received[i] * channels[c].shares[i];
    return light;
  });
}

double brightest(const Scene& scene, const GBuffer& gbuffer, std::span<const double> received) {
  const double exposure = exposure_of(scene, gbuffer, received);
  double most = 0;
  for (std::size_t i = 0; i < gbuffer.size(); ++i) {
    if (gbuffer.is_background(i)) continue;
    const glm::vec3& albedo = scene.meshes[gbuffer.mesh[i]].albedo;
    most = std::max(most, std::max({albedo.x, albedo.y, albedo.z}) * (scene.ambient + exposure * received[i]));
  }
  return most;
}

Picture draw_mask(std::span<const float> visibility, int width, int height) {
  Picture picture{width, height, std::vector<std::uint8_t>(visibility.size() * 3)};
  for (std::size_t i = 0; i < visibility.size(); ++i)
    for (int c = 0; c < 3; ++c) picture.rgb[3 * i + c] = mask_gray(visibility[i]);
  return picture;
}

Picture with_legend(Picture picture, const PictureLegend& legend) {
  const int top = picture.height;
  picture.legend_height = legend.height();
  picture.height += picture.legend_height;
  picture.rgb.resize(static_cast<std::size_t>(picture.width) * picture.height * 3, 255);
  legend.draw(picture, top);
  return picture;
}

Picture draw_soft_mask(std::span<const float> visibility, int width, int height) {
  std::vector<Color> grays(256);
  for (std::size_t k = 0; k < grays.size(); ++k) grays[k].fill(static_cast<std::uint8_t>(k));
  PictureLegend legend(width);
  legend.add(std::nullopt, "share of the light that is seen:");
  legend.add_ramp("0 umbra", std::move(grays), "1 lit");
  Picture picture = with_legend(draw_mask(visibility, width, height), legend);
  // Lit pixels are as white as the legend: a line marks the end of the picture.
  std::fill_n(picture.rgb.begin() + static_cast<std::ptrdiff_t>(visibility.size()) * 3, 3 * width, std::uint8_t{150});
  return picture;
}

Picture draw_color_mask(const std::array<std::span<const float>, 3>& channels, int width, int height) {
  const std::vector<float> dark(static_cast<std::size_t>(width) * height);
  Picture picture = draw_soft_mask(dark, width, height);
  for (std::size_t c = 0; c < channels.size(); ++c)
    for (std::size_t i = 0; i < channels[c].size(); ++i) picture.rgb[3 * i + c] = mask_gray(channels[c][i]);
  return picture;
}

Picture draw_layer(std::span<const float> linear, int width, int height, const DebugLayer& layer) {
  assert(linear.size() == static_cast<std::size_t>(width) * height * 3);
  PictureLegend legend(width);
  legend.add_sentence(layer.sentence, 3);
  for (const Swatch& s : layer.legend) legend.add(Color{srgb(s.color.r), srgb(s.color.g), srgb(s.color.b)}, s.name);
  Picture picture{width, height, std::vector<std::uint8_t>(linear.size())};
  const SrgbSteps& steps = srgb_steps();
  for (std::size_t k = 0; k < linear.size(); ++k) picture.rgb[k] = srgb_fast(steps, linear[k]);
  return with_legend(std::move(picture), legend);
}

void write_png(const fs::path& path, const Picture& picture) {
  make_way(path);
  image_files().write_png(path, picture);
}

void write_gray_png(const fs::path& path, int width, int height, std::span<const std::uint8_t> values, bool has_alpha) {
  assert(values.size() == static_cast<std::size_t>(width) * height * (has_alpha ? 2 : 1));
  make_way(path);
  image_files().write_gray_png(path, width, height, values, has_alpha);
}

void write_exr(const fs::path& path, int width, int height, std::span<const std::string> names,
               std::span<const std::span<const float>> channels) {
  make_way(path);
  image_files().write_exr(path, width, height, names, channels);
}

}  // namespace gnomon
