#pragma once
#include <gnomon/kit/geometry/edges.h>
#include <gnomon/kit/pictures/lines.h>

#include <atomic>
#include <functional>
#include <memory>
#include <mutex>
#include <thread>
#include <vector>

#include "app/viewer/panels.h"

namespace gnomon::viewer {

/// Finds the silhouette edges of the casters in a thread of its own. Where the last search was quick, the next one is waited
/// for, so that the edges move with the picture.
class SilhouetteFinder {
 public:
  explicit SilhouetteFinder(std::function<void()> changed) : changed_(std::move(changed)) {}
  ~SilhouetteFinder();

  /// The edges for this scene and light, colored as in the debug layers `silhouette`. Null while they are not found yet; then
  /// `changed` is called when they are.
  std::shared_ptr<const std::vector<Line>> find(const std::shared_ptr<const Scene>& scene, const Light& light);

 private:
  void search(std::shared_ptr<const Scene> scene, Light light);

  std::function<void()> changed_;
  std::mutex mutex_;  // guards the three members below
  std::shared_ptr<const std::vector<Line>> found_;
  std::shared_ptr<const Scene> found_for_;
  Light found_light_;
  std::atomic<double> search_ms_ = 1e9;  // that the last search took, without the edge adjacency of its scene
  std::shared_ptr<const Scene> searched_scene_;
  Light searched_light_;
  std::atomic<bool> is_searching_ = false;
  std::thread thread_;
  // Only the thread uses these.
  std::shared_ptr<const Scene> adjacency_scene_;  // that `adjacency_` is of
  EdgeAdjacency adjacency_;
  Silhouette silhouette_;
};

/// Draws over the picture: the light with its foot, the divider, the picked pixel and its shadow rays, silhouettes.
class Overlays {
 public:
  explicit Overlays(std::function<void()> changed) : finder_(std::move(changed)) {}
  void draw(const PixelRect& place, const Session& session, const PanelData& shown);
  /// Whether the last `draw` drew all that was to be shown; silhouettes may still be missing.
  bool is_complete() const { return is_complete_; }

 private:
  SilhouetteFinder finder_;
  bool is_complete_ = true;
};

}  // namespace gnomon::viewer
