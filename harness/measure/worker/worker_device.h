#pragma once
#include <gnomon/kit/gl/gl.h>

#include <set>

#include "device/bare_pass.h"
#include "device/context.h"
#include "device/stopwatch.h"
#include "measure/worker/protocol.h"

namespace gnomon {

// The device of a worker that draws: its state, bare passes and uploads.

/// State of the card: name, driver, graphics_mhz and so on. Nothing where the processor draws, or it is unknown.
std::optional<Json> card_json(const GlInfo& info);

/// A frame's bare pass, drawn once before it is timed: drivers compile at the first draw.
class TimedBarePass {
 public:
  TimedBarePass(Floor floor, const Scene& scene, const GBuffer& gbuffer);
  /// So many times in a row, 1 .. most_floor_times, by the host's clock and by that of the device.
  FloorRequest::Reply time(int times, DeviceStopwatch* stopwatch) const;

 private:
  BarePass pass_;
};

/// Uploads of a worker's scene and frames to OpenGL: geometry by stages, the picture's outside of them, and a count of those
/// that break this rule.
class StagedInputs {
 public:
  /// Before the clock of a stage starts. All geometry is uploaded by the technique's build, positions that moved by its update,
  /// which finds the rest where it was; the inputs of the picture are uploaded before resolve.
  void prepare(Stage stage, const std::set<const Scene*>& scenes, const GBuffer& gbuffer) {
    for (const Scene* const scene : scenes) {
      if (stage == Stage::build) forget_scene(*scene);
      if (stage != Stage::resolve) continue;
      gbuffer_textures(gbuffer, *scene);
      for (const Truth sees : {Truth::shape, Truth::mesh})
        if (uses_depth_stencil(sees)) depth_stencil(*scene, gbuffer, sees);
    }
    glFinish();
    before_ = uploaded_scene_bytes();
  }
  /// Does work that is no technique's and may need the triangles; they are gone after it unless they were there before.
  template <class Work>
  auto beside(const Scene& scene, const Work& work) {
    const bool was_there = uploaded_scene(scene) != nullptr;
    before_ = uploaded_scene_bytes();
    auto outcome = work();
    end_stage();
    if (!was_there) forget_scene(scene);
    return outcome;
  }
  void forget(const std::set<const Scene*>& scenes) {
    for (const Scene* const scene : scenes) forget_scene(*scene);
  }
  void end_stage() { staged_ += uploaded_scene_bytes() - before_; }

  GlInputs facts(const std::set<const Scene*>& scenes, const GBuffer& gbuffer) const {
    UploadCost pictures;
    std::uint64_t geometry = 0;
    for (const Scene* const scene : scenes) {
      const UploadCost picture = picture_uploads(*scene, gbuffer);
      pictures = {pictures.bytes + picture.bytes, pictures.ms + picture.ms};
      if (const SceneBuffers* const triangles = uploaded_scene(*scene)) geometry += triangles->bytes;
    }
    return {.input_bytes = pictures.bytes,
            .upload_ms = pictures.ms,
            .geometry_bytes = geometry,
            .loose_bytes = uploaded_scene_bytes() - staged_};
  }

 private:
  std::uint64_t before_ = 0, staged_ = 0;  ///< bytes of triangles
};

}  // namespace gnomon
