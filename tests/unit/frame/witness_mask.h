#pragma once
// Masks that foreign renderers made: tests/witness/README.md says how to read them.
#include <fmt/format.h>
#include <gnomon/kit/rays/gbuffer_maker.h>
#include <gnomon/kit/rays/rays.h>

#include <algorithm>
#include <filesystem>

#include "measure/frame/classify.h"
#include "measure/picture/picture.h"
#include "measure/scene/load.h"
#include "places.h"

namespace gnomon {

/// A renderer, by its folder, and the geometry that it renders.
struct WitnessInfo {
  std::string_view id;
  Truth truth;
};
inline constexpr WitnessInfo pov_ray{"pov_ray", Truth::shape}, cycles{"cycles", Truth::mesh};

/// Shares of the light, empty where the file is missing or of another size.
inline std::vector<float> read_witness(const WitnessInfo& witness, std::string_view scene, std::string_view light, int width,
                                       int height) {
  const std::string file = tree_file(fmt::format("tests/witness/{}/{}_{}_{}x{}.png", witness.id, scene, light, width, height));
  if (!std::filesystem::exists(file) || image_files().exr_size(file) != std::pair(width, height)) return {};
  return read_exr(file, "Y", width, height);  // a picture of any format
}

/// What a witness saw, as the reference sees it.
struct WitnessedFrame {
  /// `reference` as load_scene takes it.
  WitnessedFrame(const std::string& reference, const std::string& light_name, Truth truth, int width, int height)
      : scene(load_scene(reference)),
        light(*std::ranges::find(scene.lights, light_name, &Light::name)),
        casters(scene, truth, RayScene::Which::casters),
        everything(scene, truth, RayScene::Which::seen),
        gbuffer(make_gbuffer(scene, everything, scene.views[0], width, height, truth)),
        silhouettes(find_silhouettes(everything, gbuffer)) {}

  Scene scene;
  Light light;
  RayScene casters, everything;
  GBuffer gbuffer;
  std::vector<std::uint8_t> silhouettes;
};

}  // namespace gnomon
