#pragma once
#include "device/bare_pass.h"
#include "device/context.h"
#include "device/stopwatch.h"
#include "measure/worker/technique_device.h"

namespace gnomon {

/// State of the card that draws, found by the name of what draws: WorkerGl::card.
std::optional<Json> card_in_json(std::string_view renderer);

/// The OpenGL context of this process. It counts the triangles that no stage uploads.
class OpenGlDevice final : public TechniqueDevice {
 public:
  /// Makes the context of the process, if there is none yet. Throws Error where no device gives one.
  OpenGlDevice();

  std::optional<WorkerGl> description() const override;
  std::optional<Json> card() const override;
  bool has_own_memory() const override { return !info_.is_software(); }
  Support within_limits(const Scene& scene, int width, int height) const override;
  void finish() override;
  DeviceStopwatch* stopwatch() override { return stopwatch_ ? &*stopwatch_ : nullptr; }
  void prepare(Stage stage, const Scenes& scenes, const GBuffer& gbuffer) override;
  void end_stage() override;
  void forget(const Scenes& scenes) override;
  std::optional<GlInputs> inputs(const Scenes& scenes, const GBuffer& gbuffer) const override;
  FloorRequest::Reply draw_floor(Floor floor, const Scene& scene, const GBuffer& gbuffer, int times) override;
  void forget_floor() override { bare_pass_.reset(); }
  void upload(const Scene& scene, const GBuffer& gbuffer, VisibilityMask& mask) override;
  void fill(VisibilityMask& mask, float value) override;
  void settle() override;

 private:
  void count_staged();
  FloorRequest::Reply time_floor(int times);

  const GlInfo& info_;
  std::optional<GlStopwatch> stopwatch_;
  std::optional<BarePass> bare_pass_;
  std::uint64_t before_ = 0, staged_ = 0;  ///< bytes of triangles: uploaded before the stage, by stages in all
};

}  // namespace gnomon
