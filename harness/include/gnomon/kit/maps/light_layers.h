#pragma once
#include <gnomon/kit/maps/light_camera.h>
#include <gnomon/kit/pictures/layers.h>

#include <functional>

// The debug layers `map` and `texels` of techniques with a light camera: its depth images as the light sees them, and
// its texels on the surfaces that they decide.
namespace gnomon {

std::vector<DebugLayer> map_layers(LightImages images = LightImages::faces);

/// The depth images: one alone, six on a sheet of 3 x 2 (+x -x +y, -y +z -z), slices on one of 2 x 2. `depths` gives those of
/// an image.
std::vector<float> paint_map(const LightCamera& light_camera, int width, int height,
                             const std::function<std::span<const float>(std::size_t image)>& depths);

/// What a pixel looked up: its image, and its texel there. -1: it does not face the light.
struct LookUp {
  int image = -1;
  glm::ivec2 texel{-1};
};

/// `look_ups` and `mask` are of the same resolve. An image that is not drawn gives texels outside 0 .. resolution - 1.
std::vector<float> paint_texels(const LightCamera& light_camera, const Scene& scene, const GBuffer& gbuffer, const Light& light,
                                std::span<const LookUp> look_ups, std::span<const float> mask);

}  // namespace gnomon
