#pragma once
#include <gnomon/kit/rays/rays.h>
#include <gnomon/kit/shared.h>

namespace gnomon {

/// A scene and its casters, or all of its meshes, for techniques that trace rays, under either truth: which one the G-buffer
/// will have is not known when a technique builds, and resolve must not build.
class RayCasters {
 public:
  void build(const Scene& scene, RayScene::Which which = RayScene::Which::casters) {
    scene_ = &scene;
    by_shape_.emplace(scene, Truth::shape, which);
    by_mesh_.reset();
    if (scene.has_curved_shapes()) by_mesh_.emplace(scene, Truth::mesh, which);
  }
  const RayScene& under(Truth truth) const { return truth == Truth::mesh && by_mesh_ ? *by_mesh_ : *by_shape_; }
  const Scene& scene() const { return *scene_; }
  double bytes() const { return static_cast<double>(by_shape_->bytes() + (by_mesh_ ? by_mesh_->bytes() : 0)); }

 private:
  const Scene* scene_ = nullptr;
  std::optional<RayScene> by_shape_, by_mesh_;
};

/// The counts of a technique that holds nothing else.
inline Counts ray_counts(const Shared<RayCasters>& casters, std::size_t rays) {
  return {{"rays", static_cast<double>(rays), ""}, {"bytes", casters.own(casters->bytes()), "byte"}};
}

}  // namespace gnomon
