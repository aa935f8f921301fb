#pragma once
#include <gnomon/kit/bases/light_objects.h>

#include <deque>

#include "measure/scene/channels.h"
#include "measure/worker/requested_frame.h"
#include "measure/worker/shared_count.h"
#include "measure/worker/technique_device.h"

namespace gnomon {

/// A technique on its scene, and the frame that it answers: pose, lights, view and G-buffer. It does stages, and records which
/// of them are up to date. Of one process: its device and its progress are the process's.
class TechniqueFrame {
 public:
  TechniqueFrame() = default;
  TechniqueFrame(const TechniqueFrame&) = delete;
  TechniqueFrame& operator=(const TechniqueFrame&) = delete;
  ~TechniqueFrame();

  /// Another technique or scene. All else needs one; a frame comes before relight.
  OpenRequest::Reply open(const TechniqueEntry& entry, const OpenRequest& request);
  bool is_open() const { return objects_.has_value(); }
  /// What a parameter spoils is out of date from then on; the rest stays.
  SetRequest::Reply set(const std::string& settings);
  /// Moves the scene's meshes to the frame's pose first: all answers about the scene are about that. Where they move
  /// within a row update is the next stage, in another row build.
  GoRequest::Reply go_to(const GoRequest& request);

  /// Does all stages up to this one, once, that are out of date.
  void bring_up(Stage last);
  /// Does this stage so many times, those before it untimed where they are out of date. An update where nothing has moved since
  /// the last one gets changes that are empty.
  TimeRequest::Reply time_stage(const TimeRequest& request);
  /// The bare pass of the data sheet, so many times in a row.
  FloorRequest::Reply floor(int times);

  const Scene& scene() const { return scene_; }
  const GBuffer& gbuffer() const { return gbuffer_; }
  const TechniqueEntry& entry() const { return *entry_; }
  LightObjects& objects() { return *objects_; }
  /// Of each of the frame's lights.
  std::deque<VisibilityMask>& masks() { return masks_; }
  /// The object of one of the frame's lights; null where that casts no shadows.
  Technique* object_of(std::size_t light);
  void require_pixel(std::uint32_t pixel) const;
  const TechniqueDevice& device() const { return *device_; }
  /// What was uploaded to it.
  std::optional<GlInputs> device_inputs() { return device_->inputs(scenes(), gbuffer_); }

 private:
  struct StageTime {
    double harness_ms;
    std::optional<double> own_ms;  ///< by the technique's own clock, where it has one
  };

  /// All that is of the scene before.
  void forget_frame();
  /// Stages after this one are out of date.
  void keep_up_to(Stage stage) { fresh_ = std::min(fresh_, static_cast<int>(stage)); }
  void pose(const std::optional<WantedPose>& wanted);
  /// Makes a mask for each light, and an object for each that the technique supports. Returns its support of each.
  std::vector<Support> hold_objects(const FrameKey& key);
  /// Does one stage; the later ones are out of date then.
  StageTime time(Stage stage);
  /// Calls the stage of all objects that do it. Milliseconds of all by the technique's own clock.
  std::optional<double> call(Stage stage, const Changes& changes);
  /// Those that objects are built on; before there is a frame the scene itself.
  TechniqueDevice::Scenes scenes();

  Scene scene_;                      ///< in the frame's pose
  std::optional<PosedScene> posed_;  ///< moves it; what it tells of changes is since the last build or update
  std::optional<ChannelScenes> channels_;
  const TechniqueEntry* entry_ = nullptr;
  std::string settings_;
  std::optional<LightObjects> objects_;
  std::unique_ptr<TechniqueDevice> device_ = std::make_unique<TechniqueDevice>();  ///< that draws
  std::optional<SharedCount> progress_;                                            ///< of the stage under way
  std::string lit_by_;                          ///< of the lights that the technique was given last
  std::unique_ptr<std::vector<Light>> lights_;  ///< those lights
  std::deque<VisibilityMask> masks_;            ///< of each
  std::vector<std::size_t> lit_;                ///< the light of each object
  std::map<std::string, GBuffer> gbuffers_;     ///< by file: one for each view and truth
  GBuffer gbuffer_;
  int fresh_ = -1;  ///< last stage that is up to date
};

}  // namespace gnomon
