#pragma once
#include <gnomon/kit/rays.h>
#include <gnomon/technique.h>

namespace gnomon {

/// The casters of a scene for techniques that trace rays, under either truth: which one the G-buffer will have is not known
/// when a technique builds, and resolve must not build.
class RayCasters {
 public:
  void build(const Scene& scene) {
    by_shape_.emplace(scene, Truth::shape, RayScene::Which::casters);
    by_mesh_.reset();
    if (scene.has_curved_shapes()) by_mesh_.emplace(scene, Truth::mesh, RayScene::Which::casters);
  }
  const RayScene& under(Truth truth) const { return truth == Truth::mesh && by_mesh_ ? *by_mesh_ : *by_shape_; }
  /// The counts of a technique that holds nothing else.
  Counts counts(std::size_t rays) const {
    return {{"rays", static_cast<double>(rays), ""},
            {"bytes", static_cast<double>(by_shape_->bytes() + (by_mesh_ ? by_mesh_->bytes() : 0)), "byte"}};
  }

 private:
  std::optional<RayScene> by_shape_, by_mesh_;
};

}  // namespace gnomon
