#pragma once
#include <gnomon/kit/edges.h>
#include <gnomon/kit/lines.h>

#include <atomic>
#include <functional>
#include <memory>
#include <mutex>
#include <thread>
#include <vector>

#include "app/viewer/panels.h"

namespace gnomon::viewer {

/// Silhouette edges of the casters. Those that are found quickly are waited for, so that they move with the picture; others are
/// found in the background.
class SilhouetteFinder {
 public:
  explicit SilhouetteFinder(std::function<void()> changed) : changed_(std::move(changed)) {}
  ~SilhouetteFinder();

  /// Colored as in the debug layers `silhouette`. Null while they are not known for this scene and light.
  std::shared_ptr<const std::vector<Line>> find(const std::shared_ptr<const LoadedScene>& loaded, const Light& light);

 private:
  void look(std::shared_ptr<const LoadedScene> loaded, Light light);

  std::function<void()> changed_;
  std::mutex mutex_;  // of what was found
  std::shared_ptr<const std::vector<Line>> found_;
  std::shared_ptr<const LoadedScene> found_for_;
  Light found_light_;
  std::atomic<double> look_ms_ = 1e9;  // that the last look took, without the edges of its scene
  std::shared_ptr<const LoadedScene> asked_scene_;
  Light asked_;
  std::atomic<bool> is_looking_ = false;
  std::thread thread_;
  std::shared_ptr<const LoadedScene> adjacency_scene_;  // of the thread, with its edges
  EdgeAdjacency adjacency_;
  Silhouette silhouette_;
};

/// Draws over the picture: the light with its foot, the divider, the picked pixel and its shadow rays, silhouettes.
class Overlays {
 public:
  explicit Overlays(std::function<void()> changed) : finder_(std::move(changed)) {}
  void draw(const PixelRect& place, const Session& session, const Shown& shown);
  /// Whether all that the last `draw` was to show was known.
  bool is_complete() const { return is_complete_; }

 private:
  /// Where the shadow ray of the picked pixel is stopped.
  std::optional<glm::dvec3> find_blocker(const std::shared_ptr<const ReferenceState>& known, std::size_t pixel);

  SilhouetteFinder finder_;
  bool is_complete_ = true;
  std::shared_ptr<const ReferenceState> blocker_reference_;  // that `blocker_` is of
  std::size_t blocker_pixel_ = 0;
  std::optional<glm::dvec3> blocker_;
};

}  // namespace gnomon::viewer
