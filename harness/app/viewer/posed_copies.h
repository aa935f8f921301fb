#pragma once
#include <deque>
#include <memory>
#include <string>

#include "measure/frame/frame.h"

namespace gnomon::viewer {

// Poses of a scene that is looked at. The workers move their own scene in place. The viewer never does: frames of several poses
// are shown at once, so that each pose is a copy, which stays while a frame of it is there.

/// A copy of a scene in a pose, with what rays need of it. Any thread may read it.
class PosedCopy {
 public:
  /// Throws Error as pose() does.
  PosedCopy(const Scene& at_rest, const RowPose& at);

  const Scene& scene() const { return scene_; }
  const std::string& hash() const { return hash_; }  ///< pose_hash
  // As FrameTracer has them. They are made with the copy.
  const Scene& scene(const Light& light) const { return tracer_->scene(light); }
  const RayScene& everything(Truth truth) const { return tracer_->everything(truth); }
  const RayScene& casters(Truth truth, const Light& light) const { return tracer_->of(light).casters(truth); }

 private:
  Scene scene_;
  std::string hash_;
  std::unique_ptr<FrameTracer> tracer_;
};

/// The copies that were made last, for one thread.
class PosedCopies {
 public:
  static constexpr std::size_t most = 4;

  /// The scene at that time; remembered or made. Copies of another scene are dropped.
  std::shared_ptr<const PosedCopy> of(const std::shared_ptr<const Scene>& at_rest, const RowPose& at);
  void clear() { copies_.clear(); }
  std::size_t size() const { return copies_.size(); }

 private:
  struct Known {
    std::shared_ptr<const Scene> at_rest;
    std::string animation;
    double seconds;
    std::shared_ptr<const PosedCopy> copy;
  };
  std::deque<Known> copies_;  ///< the newest first
};

/// Whether meshes are at the same places: the animation and its time are the same. Their rows may differ.
bool are_same_time(const std::optional<RowPose>& a, const std::optional<RowPose>& b);

/// The pose by itself, as a still has it: a row of one frame.
RowPose as_still(const RowPose& at);

}  // namespace gnomon::viewer
