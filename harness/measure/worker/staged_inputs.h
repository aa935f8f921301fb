#pragma once
#include <gnomon/kit/gl/gl.h>

#include "measure/gl_inputs.h"

namespace gnomon {

/// What goes up to OpenGL of a worker's scene and frames: geometry by stages, the picture's outside of them, and a count of
/// what does not keep to that.
class StagedInputs {
 public:
  /// Before the clock of a stage starts. Geometry that changed is uploaded by the technique's build; what belongs to the
  /// picture is there before resolve.
  void prepare(Stage stage, const Scene& scene, const GBuffer& gbuffer) {
    if (stage == Stage::build) forget_scene(scene);
    if (stage == Stage::resolve) {
      gbuffer_textures(gbuffer, scene);
      for (const Truth sees : {Truth::shape, Truth::mesh})
        if (uses_depth_stencil(sees)) depth_stencil(scene, gbuffer, sees);
    }
    glFinish();
    before_ = uploaded_scene_bytes();
  }
  /// Does what is no technique's work and may want the triangles; they are gone after it unless they were there before.
  template <class Work>
  auto beside(const Scene& scene, const Work& work) {
    const bool was_there = uploaded_scene(scene) != nullptr;
    before_ = uploaded_scene_bytes();
    auto outcome = work();
    end_stage();
    if (!was_there) forget_scene(scene);
    return outcome;
  }
  void end_stage() { staged_ += uploaded_scene_bytes() - before_; }

  GlInputs facts(const Scene& scene, const GBuffer& gbuffer) const {
    const UploadCost picture = picture_uploads(scene, gbuffer);
    const SceneBuffers* const triangles = uploaded_scene(scene);
    return {.input_bytes = picture.bytes,
            .upload_ms = picture.ms,
            .geometry_bytes = triangles ? triangles->bytes : 0,
            .loose_bytes = uploaded_scene_bytes() - staged_};
  }

 private:
  std::uint64_t before_ = 0, staged_ = 0;  ///< bytes of triangles
};

}  // namespace gnomon
