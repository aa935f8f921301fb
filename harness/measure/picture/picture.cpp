#include "measure/picture/picture.h"

#include <gnomon/error.h>

#include <algorithm>
#include <cassert>

#include "measure/picture/image_files.h"
#include "measure/picture/legend.h"
#include "measure/picture/shading.h"

namespace gnomon {

namespace fs = std::filesystem;

Picture shade(const Scene& scene, const GBuffer& gbuffer, const Light& light, std::span<const float> visibility) {
  Picture picture{gbuffer.width, gbuffer.height, std::vector<std::uint8_t>(gbuffer.size() * 3)};
  const std::vector<double> received = received_light(gbuffer, light);
  const SrgbSteps& steps = srgb_steps();
  for (std::size_t i = 0; i < gbuffer.size(); ++i) {
    Color color = background_srgb;
    if (!gbuffer.is_background(i))
      color = shaded_srgb(steps, scene.meshes[gbuffer.mesh[i]].albedo, scene.ambient + received[i] * visibility[i]);
    std::ranges::copy(color, &picture.rgb[3 * i]);
  }
  return picture;
}

Picture draw_mask(std::span<const float> visibility, int width, int height) {
  Picture picture{width, height, std::vector<std::uint8_t>(visibility.size() * 3)};
  for (std::size_t i = 0; i < visibility.size(); ++i)
    for (int c = 0; c < 3; ++c) picture.rgb[3 * i + c] = mask_gray(visibility[i]);
  return picture;
}

Picture draw_layer(std::span<const float> linear, int width, int height, const DebugLayer& layer) {
  assert(linear.size() == static_cast<std::size_t>(width) * height * 3);
  PictureLegend legend(width);
  legend.add_sentence(layer.sentence, 3);
  for (const Swatch& s : layer.legend) legend.add(Color{srgb(s.color.r), srgb(s.color.g), srgb(s.color.b)}, s.name);
  Picture picture{width, height + legend.height(), {}};
  picture.rgb.resize(static_cast<std::size_t>(width) * picture.height * 3, 255);
  const SrgbSteps& steps = srgb_steps();
  for (std::size_t k = 0; k < linear.size(); ++k) picture.rgb[k] = srgb_fast(steps, linear[k]);
  legend.draw(picture, height);
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
