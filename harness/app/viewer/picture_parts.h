#pragma once
#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "app/viewer/posed_copies.h"
#include "measure/cause/causes.h"
#include "measure/frame/frame.h"
#include "measure/scene/channels.h"
#include "measure/score/metrics.h"
#include "measure/score/together.h"

namespace gnomon::viewer {

// What the engine makes and the window shows. Everything here is made once, then only read, by any thread.

/// A scene that is looked at, with what rays need of it.
struct LoadedScene {
  std::string reference;  ///< what `--scene` calls it
  Scene scene;
  std::shared_ptr<FrameStore> store = nullptr;  ///< of `scene`, for its rays and its file; the engine's
};

/// In color: a mask for each channel, empty where no light is of that channel. All are empty where the picture is gray.
using ChannelMasks = std::array<std::vector<float>, std::size(all_channels)>;

/// What the eye sees of a scene under a light, or several together: the input of techniques.
struct Frame {
  std::uint64_t number = 0;                           ///< counts up from 1
  std::shared_ptr<const LoadedScene> loaded;          ///< at rest, as the workers opened it
  std::optional<WantedPose> pose = {};                ///< that the meshes are in; nothing: at rest
  std::shared_ptr<const PosedCopy> posed = nullptr;   ///< of `loaded` in that pose; null at rest
  Light light;                                        ///< of several the one that can be moved
  std::vector<Light> lights;                          ///< two at least, in the scene's order; empty where `light` is alone
  GBuffer gbuffer;                                    ///< with its view; smaller than the picture while something moves
  std::shared_ptr<const std::filesystem::path> file;  ///< of the G-buffer, for workers; goes with the last frame that has it
  int picture_width = 0, picture_height = 0;
  /// As received_light gives it, of all lights; one a pixel. A light of several channels counts once.
  std::vector<double> received;
  double exposure = 1;  ///< of the shaded picture; see exposure_of

  /// What is seen: in the frame's pose.
  const Scene& scene() const { return posed ? posed->scene() : loaded->scene; }
  std::shared_ptr<const Scene> shared_scene() const {
    using Shared = std::shared_ptr<const Scene>;
    return posed ? Shared(posed, &posed->scene()) : Shared(loaded, &loaded->scene);
  }
  /// As one of its lights finds it, and what rays meet there; made with the scene, so that any thread may call.
  const Scene& scene(const Light& under) const { return posed ? posed->scene(under) : loaded->store->scene(under); }
  const RayScene& casters(const Light& under, Truth truth) const {
    return posed ? posed->casters(truth, under) : loaded->store->casters(truth, under);
  }
  const RayScene& casters(const Light& under) const { return casters(under, gbuffer.truth); }
  const RayScene& everything(Truth truth) const { return posed ? posed->everything(truth) : loaded->store->everything(truth); }
  std::optional<RowPose> at() const { return pose ? std::optional(pose->at) : std::nullopt; }
  bool is_together() const { return !lights.empty(); }
  std::span<const Light> all_lights() const { return is_together() ? lights : std::span(&light, 1); }
  /// Of the light that can be moved, in all_lights.
  std::size_t chosen() const;
  /// Whether masks have values between lit and umbra: under a light with area, and under several lights.
  bool has_shares() const { return kind() != AnswerKind::binary; }
  AnswerKind kind() const { return whole_lights(lights).size() > 1 ? AnswerKind::received : answer_kind(scene(), light); }
  bool is_full() const { return gbuffer.width == picture_width && gbuffer.height == picture_height; }
};

/// The reference at a frame, as far as it is computed. Until it is finished, its mask may have fewer pixels than the frame.
struct ReferenceState {
  std::shared_ptr<const Frame> frame;
  int width = 0, height = 0;   ///< of `mask`
  std::vector<float> mask;     ///< width * height; of several lights the share of the light that they would give
  ChannelMasks channels = {};  ///< in color, as `mask`
  /// Under a light with area, with the classes: `mask` is the share of its area that is seen, `irradiance` that of the
  /// irradiance, each with its standard error. Else empty.
  std::vector<float> error, irradiance, irradiance_error, half, irradiance_half;
  std::vector<PixelClass> classes;            ///< empty until computed; then the mask has the frame's size
  std::vector<std::uint32_t> nearest_caster;  ///< empty until computed; see Reference
  /// The same view and light on the meshes, where the scene has curved shapes and they count; null until computed.
  std::shared_ptr<const ReferenceState> on_mesh;
  /// Of several lights together, each, without its frame and with classes; empty until computed. Then `mask`, `error`,
  /// `irradiance`, `irradiance_error` and `classes` are those of a Together, and the rest is empty.
  std::vector<std::shared_ptr<const ReferenceState>> lights;
  bool is_complete = false;  ///< nothing more will come for this frame
  std::string why_not;       ///< there is none, because the reference does not support the light; else empty
};

/// Milliseconds of the last time that each stage was done, by Stage. Of build and update only the one that was done last.
using StageTimes = std::array<std::optional<double>, std::size(stage_names)>;

/// What a technique answered.
struct SideAnswer {
  std::shared_ptr<const Frame> frame;
  std::vector<float> mask;                ///< of several lights the share of the light that they would give
  std::vector<std::vector<float>> masks;  ///< of several lights, each; else empty
  ChannelMasks channels = {};             ///< in color, as `mask`
  StageTimes stage_ms;
  Support support = Support::full();

  /// Under light k of the frame's.
  std::span<const float> mask_under(std::size_t k) const { return masks.empty() ? mask : masks[k]; }
};

/// An answer against the reference of its frame.
struct Verdict {
  std::shared_ptr<const SideAnswer> answer;
  std::shared_ptr<const ReferenceState> reference;  ///< with classes
  LightShareKind estimates = LightShareKind::area;  ///< what the answer is compared with under a light with area
  std::shared_ptr<const Together> together;         ///< of several lights; with their causes once these are found
  ErrorCounts errors;                               ///< `error_sum` is the mean error of all channels times `tested`
  std::optional<double> error_floor;                ///< under a light with area: what the reference's own noise makes
  std::optional<double> constant_error;             ///< of the best constant mask
  std::optional<double> received_error;             ///< of several lights: rms error of the light received, as a share of that
  bool has_causes = false;                          ///< they are found
  std::vector<Cause> causes;                        ///< empty until then
  std::vector<CauseInfo> own_causes;                ///< of the technique
  std::map<std::string, std::uint64_t> cause_counts;
  /// The technique tells the parts of its error, but not of this frame: it remembers frames of which nobody asked it for them.
  bool lacks_parts = false;
};

/// The share that counts for what estimates this one.
inline std::span<const float> share_of(const ReferenceState& reference, LightShareKind estimates) {
  return estimates == LightShareKind::irradiance && !reference.irradiance.empty() ? reference.irradiance : reference.mask;
}

/// What a mask under one light is judged by, without causes. The reference has its frame.
inline Evidence evidence_of(int width, int height, std::span<const float> mask, const ReferenceState& reference,
                            LightShareKind estimates) {
  const bool is_irradiance = estimates == LightShareKind::irradiance;
  return {.width = width,
          .height = height,
          .classes = reference.classes,
          .reference = share_of(reference, estimates),
          .mask = mask,
          .causes = {},
          .light = &reference.frame->light,
          .reference_error = is_irradiance ? reference.irradiance_error : reference.error,
          .reference_half = is_irradiance ? reference.irradiance_half : reference.half,
          .kind = reference.frame->kind()};
}

/// How the mean error of a technique at a frame falls with its parameter `samples`, as far as it is measured.
struct SampleCurve {
  std::shared_ptr<const Frame> frame;
  std::vector<double> samples, error;  ///< mean of |mask - reference| over the tested pixels
  double error_floor = 0;              ///< the part of it that the reference's own noise makes
  bool is_complete = false;            ///< nothing more will come
  std::string why_not = {};            ///< it ended early for this reason; else empty
};

/// A debug layer as a technique drew it.
struct LayerPicture {
  std::shared_ptr<const Frame> frame;
  std::shared_ptr<const SideAnswer> answer;  ///< that it was drawn for
  DebugLayer layer;
  std::vector<float> rgb;  ///< linear, 3 a pixel of the frame's G-buffer
};

}  // namespace gnomon::viewer
