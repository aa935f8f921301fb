#pragma once
#include <gnomon/kit/rays/gbuffer_maker.h>
#include <gnomon/kit/rays/rays.h>

#include "measure/frame/classify.h"

namespace shape_world {
using namespace gnomon;

/// What the eye sees of a scene of shapes, and what rays through the shapes say.
struct ShapeWorld {
  Scene scene;
  RayScene everything, casters;
  GBuffer gbuffer;
  ShapeWorld(Scene the_scene, const View& view, int width, int height)
      : scene(std::move(the_scene)),
        everything(scene, Truth::shape, RayScene::Which::seen),
        casters(scene, Truth::shape, RayScene::Which::casters),
        gbuffer(make_gbuffer(scene, everything, view, width, height, Truth::shape)) {}

  std::vector<float> reference(const Light& light) const {
    std::vector<float> mask(gbuffer.size());
    trace_shadows(casters, scene, gbuffer, light, mask);
    return mask;
  }
  std::vector<PixelClass> classes(const Light& light, std::span<const float> reference) const {
    return classify(scene, casters, gbuffer, light, reference, find_silhouettes(everything, gbuffer));
  }
};

}  // namespace shape_world
