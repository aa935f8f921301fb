// Silhouette edges for the picture. Edge adjacency of a large scene takes a while, so another thread finds it.
#include "app/viewer/overlays.h"

namespace gnomon::viewer {

SilhouetteFinder::~SilhouetteFinder() {
  if (thread_.joinable()) thread_.join();
}

std::shared_ptr<const std::vector<SilhouetteFinder::Segment>> SilhouetteFinder::find(
    const std::shared_ptr<const LoadedScene>& loaded, const Light& light) {
  if (!is_looking_ && (asked_scene_ != loaded || !are_same(asked_, light))) {
    if (thread_.joinable()) thread_.join();
    asked_scene_ = loaded;
    asked_ = light;
    is_looking_ = true;
    thread_ = std::thread([this, loaded, light] { look(loaded, light); });
  }
  const std::lock_guard lock(mutex_);
  return found_for_ == loaded ? found_ : nullptr;
}

void SilhouetteFinder::look(std::shared_ptr<const LoadedScene> loaded, Light light) {
  if (adjacency_scene_ != loaded) {
    adjacency_ = EdgeAdjacency(loaded->scene);
    adjacency_scene_ = loaded;
  }
  adjacency_.find_silhouette(homogeneous(light), silhouette_);
  auto segments = std::make_shared<std::vector<Segment>>();
  for (const SilhouetteEdge& edge : silhouette_.edges)
    segments->push_back({adjacency_.positions()[edge.low], adjacency_.positions()[edge.high]});
  {
    const std::lock_guard lock(mutex_);
    found_ = std::move(segments);
    found_for_ = std::move(loaded);
  }
  is_looking_ = false;
  changed_();
}

}  // namespace gnomon::viewer
