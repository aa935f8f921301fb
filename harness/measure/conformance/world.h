#pragma once
#include <gnomon/kit/rays.h>
#include <gnomon/technique.h>

#include <memory>
#include <string>
#include <vector>

#include "measure/frame/classify.h"
#include "measure/frame/gbuffer_maker.h"

namespace gnomon::conformance {

/// A rule cannot be asked, for a reason that is not the technique's.
class CannotAsk : public Error {
  using Error::Error;
};

/// "box_city:count=12". Throws CannotAsk where this program was built without the generator.
Scene generated_scene(const std::string& reference);

/// A scene, and what rays say of it under the truth of the geometry that a technique sees.
class World {
 public:
  World(Scene the_scene, Truth the_truth);
  World(const World&) = delete;

  GBuffer gbuffer(const View& view, int width = 96, int height = 54) const;
  GBuffer gbuffer() const { return gbuffer(scene.views[0]); }

  struct Truthful {
    std::vector<float> mask;
    std::vector<PixelClass> classes;
    std::vector<float> error;  ///< standard errors under a light with area, else empty
  };
  /// Under a light with area the share that the technique estimates.
  Truthful reference(const GBuffer& gbuffer, const Light& light, LightShareKind estimates = LightShareKind::area) const;

  const Scene scene;
  const Truth truth;

 private:
  RayScene everything_, casters_;
};

/// The lights of a generated scene, `point` and `sun`, and one of each other kind around the point light.
std::vector<Light> lights_of_all_kinds(const Scene& scene);

/// "sun (directional)", for messages.
std::string title(const Light& light);

}  // namespace gnomon::conformance
