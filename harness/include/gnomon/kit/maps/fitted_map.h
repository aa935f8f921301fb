#pragma once
#include <gnomon/kit/maps/compared_map.h>

namespace gnomon {

/// One image for each face of the light, fitted to the scene or to each picture.
///
/// Defaults: the bias with the lowest mean wrong rate in suite shadow_map_defaults; results/shadow_map_defaults has the sweep.
class FittedMap : public ComparedMap {
  Choice fit = Choice(this, "fit", "scene", {"scene", "view"}, Stage::relight,
                      "Images hold all that casters and receivers share, or what the picture shows of it: then each resolve "
                      "fits and draws them anew, and pays for it.");

 protected:
  FittedMap() : ComparedMap({.bias = "slope", .depth_bias = 0.25, .slope_bias = 1}) {}

 private:
  std::optional<LightCamera> fitted_to_scene(const Light& light, const MeshBoxes& boxes, int margin) const override {
    if (fit.is("view")) return std::nullopt;
    return fit_to_scene(light, boxes, image_resolution(), margin);
  }
  LightCamera fitted_to_view(const Light& light, const MeshBoxes& boxes, const GBuffer& gbuffer, int margin) const override {
    return fit_to_view(light, boxes, gbuffer, image_resolution(), margin);
  }
};

}  // namespace gnomon
