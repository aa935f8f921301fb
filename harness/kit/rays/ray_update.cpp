// Trees of Embree follow vertices that move: docs/decisions/refit.md.
#include <gnomon/kit/geometry/refit.h>

#include <algorithm>

#include "kit/rays/ray_body.h"
#include "kit/rays/ray_frame.h"

namespace gnomon {

bool RayScene::Body::can_follow(const Changes& changes) const {
  if (trees == Trees::fixed || traced_scale(*source, still_extent) != scale) return false;
  for (std::uint32_t index = 0; index < source->meshes.size(); ++index)
    if (has_moved(changes, index) && source->meshes[index].reach.empty()) return false;
  // A mesh has its exact shape as long as no animation moves it.
  const auto is_shape = [&](std::uint32_t index) { return truth == Truth::shape && source->meshes[index].has_curved_shape(); };
  const auto stands = [&](const auto& shape) { return is_shape(shape->mesh) && !has_moved(changes, shape->mesh); };
  const auto has_triangles = [&](const TracedMesh& traced) {
    return !is_shape(traced.mesh) && traced.moves == !source->meshes[traced.mesh].reach.empty();
  };
  return std::ranges::all_of(shapes, stands) && std::ranges::all_of(meshes, has_triangles);
}

bool RayScene::Body::follow(const Changes& changes) {
  if (!can_follow(changes)) return false;
  is_joined = std::make_unique<std::once_flag>();
  bool has_any_moved = false;
  for (TracedMesh& traced : meshes) {
    if (!has_moved(changes, traced.mesh)) continue;
    refit(traced, changes.meshes[traced.mesh]);
    has_any_moved = true;
  }
  if (!has_any_moved) return true;
  bytes_of_one_thread.reset();
  commit();
  return true;
}

void RayScene::Body::refit(TracedMesh& traced, const MeshChange& change) {
  const Mesh& mesh = source->meshes[traced.mesh];
  RTCGeometry geometry = rtcGetGeometry(scene, traced.mesh);
  write(mesh, change.first, change.count,
        static_cast<glm::vec3*>(rtcGetGeometryBufferData(geometry, RTC_BUFFER_TYPE_VERTEX, 0)));
  rtcUpdateGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0);
  bool is_built = is_decayed(traced.sample.refit(mesh), traced.built_cost);
  if (std::vector<std::uint32_t> degenerate = degenerate_triangles(mesh); degenerate != traced.degenerate) {
    traced.degenerate = std::move(degenerate);
    set_triangles(geometry, mesh, traced.degenerate);
    is_built = true;
  }
  if (is_built) {
    // Embree refits where vertices alone were updated. Where triangles were, it builds this mesh's tree anew, and no other's.
    rtcUpdateGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0);
    traced.sample = TreeSample(mesh);
    traced.built_cost = traced.sample.cost();
  }
  rtcCommitGeometry(geometry);
}

void RayScene::update(const Changes& changes) {
  if (changes.empty() || body_->follow(changes)) return;
  body_ = Body::built(*body_->source, body_->truth, body_->which, body_->trees);
}

}  // namespace gnomon
