#pragma once
#include "measure/frame/frame.h"
#include "measure/worker/protocol.h"

namespace gnomon {

/// A frame as a request to a worker describes it.
struct RequestedFrame {
  FrameKey key;
  std::vector<Light> lights;
  std::string lit_by;    ///< differs between any two choices of lights: when it changes, relight is out of date
  bool is_free = false;  ///< light and view need not be the scene's
};

/// Throws Error when a picture cannot be so large.
void check_size(int width, int height);
/// Throws Error, or what containers throw, on a request that makes no sense.
RequestedFrame requested_frame(const GoRequest& request, const Scene& scene);
/// support_together of a frame's lights, in whose words the channels of a light that are alike are that light.
Support support_of_row(const std::vector<Light>& lights, const std::vector<Support>& supports);
inline std::optional<RowPose> row_pose(const std::optional<WantedPose>& wanted) {
  return wanted ? std::optional(wanted->at) : std::nullopt;
}
/// Throws Error, with both hashes, where the positions are others than that program's: masks of different scenes would be
/// compared. `scene` is its name.
void require_hash(PosedScene& posed, const std::optional<WantedPose>& wanted, const std::string& scene);
/// The scene in a file of scene_bytes.
Scene scene_in(const std::string& file);

/// References that a worker makes instead of serving a technique; all requests are of one scene.
class RequestedTraces {
 public:
  bool is_empty() const { return !tracer_; }
  /// Throws Error, or what containers throw, on a request that makes no sense.
  Done make(const TraceRequest& request);

 private:
  Scene scene_;  ///< in the pose of the last request
  std::optional<PosedScene> posed_;
  std::optional<FrameTracer> tracer_;
};

}  // namespace gnomon
