// Silhouette edges for the picture. Edge adjacency of a large scene takes a while, so another thread finds it.
#include <chrono>

#include "app/viewer/overlays.h"

namespace gnomon::viewer {

namespace {

constexpr double quick_ms = 6;  // the window may wait for so long

}  // namespace

SilhouetteFinder::~SilhouetteFinder() {
  if (thread_.joinable()) thread_.join();
}

std::shared_ptr<const std::vector<Line>> SilhouetteFinder::find(const std::shared_ptr<const LoadedScene>& loaded,
                                                                const Light& light) {
  if (!is_looking_ && (asked_scene_ != loaded || !are_same(asked_, light))) {
    if (thread_.joinable()) thread_.join();
    const bool is_quick = adjacency_scene_ == loaded && look_ms_ < quick_ms;
    asked_scene_ = loaded;
    asked_ = light;
    is_looking_ = true;
    thread_ = std::thread([this, loaded, light] { look(loaded, light); });
    if (is_quick) thread_.join();
  }
  const std::lock_guard lock(mutex_);
  return found_for_ == loaded && are_same(found_light_, light) ? found_ : nullptr;
}

void SilhouetteFinder::look(std::shared_ptr<const LoadedScene> loaded, Light light) {
  auto start = std::chrono::steady_clock::now();
  auto lines = std::make_shared<std::vector<Line>>();
  try {
    if (adjacency_scene_ != loaded) {
      adjacency_ = EdgeAdjacency(loaded->scene);
      adjacency_scene_ = loaded;
      start = std::chrono::steady_clock::now();
    }
    adjacency_.find_silhouette(homogeneous(light), silhouette_);
    *lines = silhouette_lines(adjacency_, silhouette_);
  } catch (const std::exception&) {
    lines->clear();  // no memory for them: an overlay is not worth the window
    adjacency_scene_.reset();
  }
  {
    const std::lock_guard lock(mutex_);
    found_ = std::move(lines);
    found_for_ = std::move(loaded);
    found_light_ = light;
  }
  look_ms_ = std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
  is_looking_ = false;
  changed_();
}

}  // namespace gnomon::viewer
