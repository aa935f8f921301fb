// Silhouette edges for the picture. Edge adjacency of a large scene takes a while, so another thread finds it.
#include <chrono>

#include "app/viewer/overlays.h"

namespace gnomon::viewer {

namespace {

constexpr double quick_ms = 6;  // a search that takes no longer is waited for

}  // namespace

SilhouetteFinder::~SilhouetteFinder() {
  if (thread_.joinable()) thread_.join();
}

std::shared_ptr<const std::vector<Line>> SilhouetteFinder::find(const std::shared_ptr<const LoadedScene>& loaded,
                                                                const Light& light) {
  if (!is_searching_ && (searched_scene_ != loaded || !are_same(searched_light_, light))) {
    if (thread_.joinable()) thread_.join();
    const bool is_quick = adjacency_scene_ == loaded && search_ms_ < quick_ms;
    searched_scene_ = loaded;
    searched_light_ = light;
    is_searching_ = true;
    thread_ = std::thread([this, loaded, light] { search(loaded, light); });
    if (is_quick) thread_.join();
  }
  const std::lock_guard lock(mutex_);
  return found_for_ == loaded && are_same(found_light_, light) ? found_ : nullptr;
}

void SilhouetteFinder::search(std::shared_ptr<const LoadedScene> loaded, Light light) {
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
    lines->clear();  // out of memory: the window goes on without silhouettes
    adjacency_scene_.reset();
  }
  {
    const std::lock_guard lock(mutex_);
    found_ = std::move(lines);
    found_for_ = std::move(loaded);
    found_light_ = light;
  }
  search_ms_ = std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
  is_searching_ = false;
  changed_();
}

}  // namespace gnomon::viewer
