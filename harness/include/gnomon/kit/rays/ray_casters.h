#pragma once
#include <gnomon/kit/geometry/refit.h>
#include <gnomon/kit/rays/rays.h>
#include <gnomon/kit/shared.h>

namespace gnomon {

/// A scene and its casters, or all of its meshes, for techniques that trace rays, under either truth: which one the G-buffer
/// will have is not known when a technique builds, and resolve must not build.
class RayCasters {
 public:
  void build(const Scene& scene, RayScene::Which which = RayScene::Which::casters) {
    scene_ = &scene;
    which_ = which;
    trees_ = follows_animation(scene) ? RayScene::Trees::moving : RayScene::Trees::fixed;
    by_shape_.emplace(scene, Truth::shape, which, trees_);
    by_mesh_.reset();
    if (scene.has_curved_shapes()) by_mesh_.emplace(scene, Truth::mesh, which, trees_);
  }
  /// As Technique::update: the scene that was built, after some of its vertices moved.
  void update(const Scene& scene, const Changes& changes) {
    const bool is_of_row = trees_ == RayScene::Trees::moving;
    if (is_of_row != follows_animation(scene) || scene.has_curved_shapes() != by_mesh_.has_value()) return build(scene, which_);
    by_shape_->update(changes);
    if (by_mesh_) by_mesh_->update(changes);
  }
  const RayScene& under(Truth truth) const { return truth == Truth::mesh && by_mesh_ ? *by_mesh_ : *by_shape_; }
  const Scene& scene() const { return *scene_; }
  double bytes() const { return static_cast<double>(by_shape_->bytes() + (by_mesh_ ? by_mesh_->bytes() : 0)); }

 private:
  const Scene* scene_ = nullptr;
  RayScene::Which which_ = RayScene::Which::casters;
  RayScene::Trees trees_ = RayScene::Trees::fixed;
  std::optional<RayScene> by_shape_, by_mesh_;
};

/// The counts of a technique that holds nothing else.
inline Counts ray_counts(const Shared<RayCasters>& casters, std::size_t rays) {
  return {{"rays", static_cast<double>(rays), ""}, {"bytes", casters.own(casters->bytes()), "byte"}};
}

}  // namespace gnomon
