#pragma once
#include <gnomon/kit/rays/gbuffer_maker.h>
#include <gnomon/technique.h>

#include <atomic>
#include <map>

#include "measure/answer_kind.h"
#include "measure/frame/frame_cache.h"
#include "measure/frame/pixel_truth.h"
#include "measure/frame/soft_reference.h"
#include "measure/scene/blob.h"
#include "measure/scene/channels.h"
#include "measure/scene/posed_scene.h"

namespace gnomon {

/// Whether the light has an area, and so a radiance that pictures of all light are made of.
bool has_radiance(const Light& light);

/// The answer that counts, for one light and G-buffer: the reference mask, the class of every pixel, and what blocks it.
struct Reference {
  std::span<const float> mask = {};
  std::span<const PixelClass> classes = {};
  /// Mesh of the caster nearest to the pixel's point on its way to the light; no_mesh where the pixel is lit or has none. In
  /// scenes with transmission a pixel is lit that full light would not call wrong (is_wrong).
  std::span<const std::uint32_t> nearest_caster = {};
  std::shared_ptr<const void> storage = {};
  /// 1 where the pixel is tested and a rasterizer's rounding of vertices may turn its answer over (see find_snapping), else 0.
  std::span<const std::uint8_t> snapping = {};
  int subpixel_bits = usual_subpixel_bits;  ///< of that rasterizer
  /// Behind transmission, else empty: how many surfaces the pixel's way crosses that take a part of the light, at most 254;
  /// blocked_surfaces where an opaque caster hides the light.
  std::span<const std::uint8_t> surfaces = {};
  AnswerKind kind = AnswerKind::binary;
  /// Where the answer is a fraction, else empty: `mask` is the share of its area that is seen, `irradiance` that of the
  /// irradiance, each with its standard error, and by half of its rays (see SoftReference).
  std::span<const float> irradiance = {}, error = {}, irradiance_error = {}, half = {}, irradiance_half = {},
                         caster_distance = {};
  std::span<const std::uint32_t> rays = {};
};

/// All light that surfaces send to the eye under one light with area, by random light paths (see PathPicture): linear RGB
/// radiance in W/(m2 sr), three floats a pixel, and the standard error of each.
struct GlobalReference {
  std::span<const float> radiance = {}, error = {};
  std::uint64_t rays = 0;
  std::shared_ptr<const void> storage = {};
};

/// The truth over the pixel under one light without area, see PixelShares: what a mask is compared with beside the Reference.
struct PixelTruth {
  std::span<const float> mean = {}, error = {}, half = {};
  std::span<const std::uint8_t> kept = {};
  std::shared_ptr<const void> storage = {};
};

/// Raised when a G-buffer, a reference or a class comes out differently for the same scene. Records keep it as `frames` of
/// their context: causes belong to the frames that they were found on.
int frame_version();

/// What a G-buffer is made from.
struct FrameKey {
  View view;
  int width = 0, height = 0;
  Truth truth = Truth::shape;
  std::optional<WantedPose> pose = {};  ///< that the scene is in; nothing: at rest, also of a scene without motion
};

/// What a FrameStore has not got yet.
struct MissingFrame {
  std::filesystem::path scene_file = {};    ///< with scene_bytes
  FrameKey key = {};                        ///< the G-buffer of this,
  std::optional<Light> light = {};          ///< or where it holds one the reference under it,
  std::filesystem::path gbuffer_file = {};  ///< which is seen in this G-buffer
  AreaTarget target = {};                   ///< of a light with area
  int subpixel_bits = usual_subpixel_bits;  ///< of the rasterizer whose rounding is marked
  int global_samples = 0;                   ///< above 0: its GlobalReference is missing, of so many light paths a pixel
  int pixel_rays = 0;                       ///< above 0: its PixelTruth is missing, of so many eye rays a pixel
  /// Counts pixels as they are finished, for whoever shows progress: of a reference under a light with area, of all light and
  /// of the truth over the pixel.
  std::atomic<std::size_t>* done = nullptr;
};

/// Where a FrameStore has frames made: in its own process, or where a crash costs less.
class FrameMaker {
 public:
  virtual ~FrameMaker() = default;
  virtual std::vector<std::byte> make(const MissingFrame& missing) = 0;
};

/// Rays through one scene, and the frames that they trace.
class FrameTracer final : public FrameMaker {
 public:
  explicit FrameTracer(const Scene& scene) : scene_(scene) {}
  std::vector<std::byte> make(const MissingFrame& missing) override;
  /// All casters under a truth; built on first use, and anew once the scene's meshes have moved (Scene::pose_number).
  const RayScene& casters(Truth truth) { return rays(truth, RayScene::Which::casters); }
  /// All meshes under a truth; the same as the casters where all cast.
  const RayScene& everything(Truth truth) { return rays(truth, RayScene::Which::seen); }
  /// The scene as a light finds it (ChannelScenes), and rays through that.
  const Scene& scene(const Light& light) { return channels_.of(light); }
  FrameTracer& of(const Light& light);

 private:
  /// Drops all that was made of meshes which have moved since.
  void follow_pose();
  const RayScene& rays(Truth truth, RayScene::Which which);
  /// See find_silhouettes; those of the last view are kept, for its other lights.
  std::span<const std::uint8_t> silhouettes(const MissingFrame& missing, const GBuffer& g);
  std::vector<std::byte> reference(const MissingFrame& missing, const GBuffer& g);
  std::vector<std::byte> soft_reference(const MissingFrame& missing, const GBuffer& g);
  std::vector<std::byte> global_reference(const MissingFrame& missing, const GBuffer& g);
  std::vector<std::byte> pixel_truth(const MissingFrame& missing, const GBuffer& g);

  const Scene& scene_;
  ChannelScenes channels_{scene_};
  std::map<const Scene*, std::unique_ptr<FrameTracer>> tracers_;  ///< of `channels_`
  std::map<std::pair<Truth, RayScene::Which>, RayScene> rays_;
  std::filesystem::path silhouettes_of_;  ///< the G-buffer's file
  std::vector<std::uint8_t> silhouettes_;
  // At which rays and silhouettes were made. A mesh that moves has no exact shape, also where it has not moved yet.
  std::uint64_t pose_number_ = 0;
  std::vector<bool> is_curved_;
};

/// G-buffers and references of one scene: made once, kept in a content-hashed folder, mapped by every process that needs
/// them. A file appears there whole or not at all and ends with the hash of its content, which is looked at before it is used;
/// one that was damaged is made again. FrameFiles says where they are. The scene's meshes are at rest when the store is made.
/// They may move afterwards: the scene must be in the pose of the FrameKey whenever a frame is requested, else Error is thrown.
class FrameStore {
 public:
  /// Without a maker it traces itself.
  FrameStore(const Scene& scene, std::filesystem::path folder, std::unique_ptr<FrameMaker> maker = nullptr);

  /// The scene's hash in records of rows under lights of these names; of its meshes at rest, wherever they are now.
  const std::string& scene_hash(const std::vector<std::string>& lights, WithMotion with_motion = WithMotion::no);
  /// The scene's bytes as a file, for other processes: its meshes at rest, and how they move.
  std::filesystem::path scene_file();
  std::filesystem::path gbuffer_file(const FrameKey& key);
  GBuffer gbuffer(const FrameKey& key);
  /// Under a light with area to the target. Throws Error as require_reference does.
  Reference reference(const FrameKey& key, const Light& light, const AreaTarget& target = {},
                      int subpixel_bits = usual_subpixel_bits);
  /// Under a light with area, of so many light paths a pixel; all bounces count, so that light must be traceable
  /// (untraceable_light).
  GlobalReference global_reference(const FrameKey& key, const Light& light, int samples);
  /// Under a light without area. Throws Error as require_reference does.
  PixelTruth pixel_truth(const FrameKey& key, const Light& light);
  /// As FrameTracer has them, in this process.
  const RayScene& casters(Truth truth) { return tracer_.casters(truth); }
  const RayScene& everything(Truth truth) { return tracer_.everything(truth); }
  const Scene& scene(const Light& light) { return tracer_.scene(light); }
  const RayScene& casters(Truth truth, const Light& light) { return tracer_.of(light).casters(truth); }

 private:
  std::string hash(const FrameKey& key, const Light* light, const AreaTarget& target = {},
                   int subpixel_bits = usual_subpixel_bits) const;
  /// The file of a name whose content has the frame's size and ends with its hash; it is made where there is none, from the
  /// files of the scene and of the G-buffer.
  std::filesystem::path find_or_make(const std::string& name, MissingFrame missing);
  /// Throws Error where the scene is in another pose than the key's.
  void require_pose(const FrameKey& key);

  const Scene& scene_;
  FrameFiles files_;
  std::vector<std::byte> scene_bytes_ = scene_bytes(scene_);
  std::string scene_hash_ = content_hash(scene_bytes_);                            ///< with all lights
  std::map<std::pair<std::vector<std::string>, WithMotion>, std::string> hashes_;  ///< see scene_hash
  std::uint64_t rest_number_ = scene_.pose_number;                                 ///< of the scene at rest, as it came
  std::string rest_hash_ = scene_.motion ? pose_hash(scene_) : "";                 ///< of its positions then
  std::uint64_t hashed_number_ = rest_number_;
  std::string hash_now_ = rest_hash_;  ///< of its positions at `hashed_number_`
  FrameTracer tracer_{scene_};
  std::unique_ptr<FrameMaker> maker_;  ///< null: the tracer
};

/// Writes a G-buffer for other processes.
void write_gbuffer(const std::filesystem::path& file, const GBuffer& gbuffer);
/// A G-buffer that another process wrote.
GBuffer map_gbuffer(const std::filesystem::path& file, const FrameKey& key);
/// The same in memory of our own, which nobody shortens.
GBuffer copy_gbuffer(const std::filesystem::path& file, const FrameKey& key);

/// What the reference, the technique of that role, says of scene, light and view. Where it is unsupported there is no truth to
/// score against: whoever measures calls this first and passes the reason on.
Support reference_support(const Scene& scene, const Light& light, const View& view);

/// Throws Error with scene, light and reason where that is unsupported.
void require_reference(const Scene& scene, const Light& light, const View& view);

}  // namespace gnomon
