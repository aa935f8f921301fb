#pragma once
#include <gnomon/kit/rays/gbuffer_maker.h>
#include <gnomon/kit/rays/rays.h>
#include <gnomon/technique.h>

#include <optional>
#include <string>
#include <vector>

#include "measure/frame/frame.h"

namespace gnomon::conformance {

/// A rule cannot be checked, for a reason outside the technique.
class CannotAsk : public Error {
  using Error::Error;
};

/// "box_city:count=12". Throws CannotAsk where this program was built without the generator.
Scene generated_scene(const std::string& reference);

/// A card whose alpha mask is a checker of 8 x 8 texels, over a ground: a scene that only techniques that handle alpha masks
/// are checked on.
Scene checkered_card();
/// Two cards that let parts of the light through, one of 8 x 8 texels, and a small opaque one over a ground: a scene that only
/// techniques that handle transmission are checked on.
Scene glass_cards();

/// The frames of a scene in the folder of references, see World.
FrameStore frames_of(const Scene& scene);

/// A scene, and its reference under the truth of the geometry that a technique sees.
///
/// References are kept for other processes in the folder $GNOMON_CONFORMANCE_FRAMES, where that is set, in a separate subfolder
/// for each build of the program. Whoever sets it empties it (tests/CMakeLists.txt). Without it each process makes its own.
class World {
 public:
  /// Width and height of pictures are divided by `part`.
  World(Scene the_scene, Truth the_truth, int part = 1);
  World(const World&) = delete;

  GBuffer gbuffer(const View& view, int width = 96, int height = 54) const;
  GBuffer gbuffer() const { return gbuffer(scene.views[0]); }

  struct Truthful {
    std::vector<float> mask;
    std::vector<PixelClass> classes;
    std::vector<float> error;  ///< standard errors under a light with area, else empty
  };
  /// Under a light with area the share that the technique estimates.
  Truthful reference(const GBuffer& gbuffer, const Light& light, LightShareKind estimates = LightShareKind::area);

  const Scene scene;
  const Truth truth;

 private:
  int part_;
  RayScene everything_;
  std::optional<FrameStore> frames_;  ///< made with the first reference
};

/// A copy of what was found, of a light with area the share that the technique estimates.
World::Truthful truthful(const Reference& found, const Light& light, LightShareKind estimates);

/// The lights of a generated scene, `point` and `sun`, and one of each other kind around the point light.
std::vector<Light> lights_of_all_kinds(const Scene& scene);

/// "sun (directional)", for messages.
std::string title(const Light& light);

}  // namespace gnomon::conformance
