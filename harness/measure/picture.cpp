#include "measure/picture.h"

#include <gnomon/error.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "measure/blob.h"
#include "measure/image_files.h"

namespace gnomon {

namespace fs = std::filesystem;

namespace {

using Color = std::array<std::uint8_t, 3>;

std::uint8_t srgb(double linear) {
  const double x = std::clamp(linear, 0.0, 1.0);
  return static_cast<std::uint8_t>(std::lround(255 * (x <= 0.0031308 ? 12.92 * x : 1.055 * std::pow(x, 1 / 2.4) - 0.055)));
}

/// sRGB of 4096 steps of linear light: a table, because a power per channel and pixel costs more than the shading.
std::uint8_t srgb_fast(double linear) {
  static const auto table = [] {
    std::array<std::uint8_t, 4097> steps;
    for (int i = 0; i <= 4096; ++i) steps[i] = srgb(i / 4096.0);
    return steps;
  }();
  return table[static_cast<std::size_t>(std::clamp(linear, 0.0, 1.0) * 4096)];
}

constexpr Color background{24, 26, 30};

/// Colors that stay apart for color-blind readers (Okabe and Ito 2008).
struct Kind {
  Verdict verdict;
  Color color;
  const char* label;
};
constexpr Kind kinds[] = {{Verdict::false_dark, {213, 94, 0}, "false dark"},
                          {Verdict::false_lit, {86, 180, 233}, "false lit"},
                          {Verdict::beyond_coverage, {204, 121, 167}, "beyond coverage"}};

std::string percent(double share) {
  if (share == 0) return "0 %";
  return fmt::format("{:.{}f} %", 100 * share, share < 0.001 ? 4 : share < 0.1 ? 2 : 1);
}

}  // namespace

Picture shade(const Scene& scene, const GBuffer& gbuffer, const Light& light, std::span<const float> visibility) {
  Picture picture{gbuffer.width, gbuffer.height, std::vector<std::uint8_t>(gbuffer.size() * 3)};
  const glm::dvec4 l = homogeneous(light);
  for (std::size_t i = 0; i < gbuffer.size(); ++i) {
    std::uint8_t* rgb = &picture.rgb[3 * i];
    if (gbuffer.is_background(i)) {
      std::copy(background.begin(), background.end(), rgb);
      continue;
    }
    const glm::dvec3 point = gbuffer.position(i), to = to_light(l, point);
    double received = 0;
    if (in_spot_cone(light, point))
      received = std::max(0.0, glm::dot(glm::dvec3(gbuffer.normal(i)), to) / std::max(glm::length(to), 1e-300));
    const double shade = scene.ambient + light.intensity * received * visibility[i];
    for (int c = 0; c < 3; ++c) rgb[c] = srgb_fast(scene.meshes[gbuffer.mesh[i]].albedo[c] * shade);
  }
  return picture;
}

Picture draw_errors(const Scene& scene, const GBuffer& gbuffer, const Light& light, std::span<const Verdict> verdicts,
                    const Tally& tally, const std::string& title) {
  const std::vector<float> lit(gbuffer.size(), 1.0f);
  const Picture shaded = shade(scene, gbuffer, light, lit);
  constexpr int legend_height = 30;
  Picture picture{gbuffer.width, gbuffer.height + legend_height, {}};
  picture.rgb.resize(static_cast<std::size_t>(picture.width) * picture.height * 3, 255);
  for (std::size_t i = 0; i < gbuffer.size(); ++i) {
    const std::uint8_t* s = &shaded.rgb[3 * i];
    const int gray = (2 * s[0] + 5 * s[1] + s[2]) / 8;
    // Right pixels keep their shading in light gray, untested ones sink to dark gray.
    const int dimmed = verdicts[i] == Verdict::untested ? 20 + gray / 5 : 70 + gray * 2 / 5;
    Color color{static_cast<std::uint8_t>(dimmed), static_cast<std::uint8_t>(dimmed), static_cast<std::uint8_t>(dimmed)};
    for (const Kind& kind : kinds)
      if (kind.verdict == verdicts[i]) color = kind.color;
    std::copy(color.begin(), color.end(), &picture.rgb[3 * i]);
  }

  const int top = gbuffer.height;
  const auto text = [&](int x, const std::string& words) {
    return image_files().draw_text(picture.rgb, picture.width, picture.height, x, top + 20, words);
  };
  int x = 8;
  for (int k = 0; k < 3; ++k) {
    const auto count = static_cast<double>(std::ranges::count(verdicts, kinds[k].verdict));
    if (kinds[k].verdict == Verdict::beyond_coverage && count == 0) continue;
    for (int row = top + 9; row < top + 21; ++row)
      for (int column = x; column < std::min(x + 12, picture.width); ++column)
        std::copy(kinds[k].color.begin(), kinds[k].color.end(),
                  &picture.rgb[3 * (static_cast<std::size_t>(row) * picture.width + column)]);
    x += 18;
    x += text(x, fmt::format("{} {}", kinds[k].label, percent(tally.tested ? count / tally.tested : 0))) + 16;
  }
  const int title_width = image_files().draw_text({}, 0, 0, 0, 0, title);
  if (x + title_width + 8 < picture.width) text(picture.width - title_width - 8, title);
  return picture;
}

Picture draw_mask(std::span<const float> visibility, int width, int height) {
  Picture picture{width, height, std::vector<std::uint8_t>(visibility.size() * 3)};
  for (std::size_t i = 0; i < visibility.size(); ++i)
    for (int c = 0; c < 3; ++c)
      picture.rgb[3 * i + c] = static_cast<std::uint8_t>(std::lround(255 * std::clamp(visibility[i], 0.0f, 1.0f)));
  return picture;
}

Picture draw_layer(const fs::path& raw, int width, int height) {
  const auto file = MappedFile::open(raw);
  Picture picture{width, height, std::vector<std::uint8_t>(static_cast<std::size_t>(width) * height * 3)};
  if (file->bytes().size() != picture.rgb.size() * sizeof(float))
    throw Error("debug layer has {} bytes; {} are wanted", file->bytes().size(), picture.rgb.size() * sizeof(float));
  const auto* linear = reinterpret_cast<const float*>(file->bytes().data());
  for (std::size_t k = 0; k < picture.rgb.size(); ++k) picture.rgb[k] = srgb_fast(linear[k]);
  return picture;
}

void write_png(const fs::path& path, const Picture& picture) {
  image_files().write_png(path, picture.width, picture.height, picture.rgb);
}

void write_exr(const fs::path& path, int width, int height, std::span<const std::string> names,
               std::span<const std::span<const float>> channels) {
  image_files().write_exr(path, width, height, names, channels);
}

std::vector<float> read_exr(const fs::path& path, const std::string& channel, int width, int height) {
  return image_files().read_exr(path, channel, width, height);
}

}  // namespace gnomon
