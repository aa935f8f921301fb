#pragma once
#include "measure/frame/frame.h"
#include "measure/json.h"

namespace gnomon {

/// A frame as a request to a worker describes it; see worker.h.
struct AskedFrame {
  FrameKey key;
  std::vector<Light> lights;
  std::string lit_by;    ///< differs between any two choices of lights: relight is out of date when it changes
  bool is_free = false;  ///< light and view need not be the scene's
};

/// Width, height and truth. Throws Error when a picture cannot be so large.
void set_size_and_truth(FrameKey& key, const Json& request);
/// Throws Error, or what Json and containers throw, on a request that makes no sense.
AskedFrame asked_frame(const Json& request, const Scene& scene);
/// The scene in a file of scene_bytes.
Scene scene_in(const std::string& file);

}  // namespace gnomon
