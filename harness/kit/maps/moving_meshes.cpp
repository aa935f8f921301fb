#include <gnomon/kit/maps/moving_meshes.h>

#include <algorithm>

namespace gnomon {

void MovingMeshes::build(const Scene& scene) {
  reaches_.clear();
  places_.clear();
  const auto has_reach = [](const Mesh& mesh) { return !mesh.reach.empty(); };
  if (std::ranges::any_of(scene.meshes, has_reach))
    for (const Mesh& mesh : scene.meshes) {
      reaches_.push_back(mesh.reach);
      places_.emplace_back();
      if (has_reach(mesh)) places_.back().add(mesh.positions);
    }
  moved_at_.assign(reaches_.size(), 0);
  number_ = {number_.builds + 1, 0};
}

bool MovingMeshes::update(const Scene& scene, const Changes& changes) {
  for (std::size_t m = 0; m < scene.meshes.size(); ++m) {
    const Bounds now = scene.meshes[m].reach, before = reaches_.empty() ? Bounds() : reaches_[m];
    if (now.min != before.min || now.max != before.max) return false;
    if (changes.meshes[m].kind != MeshChange::Kind::still && !moves(m)) return false;
  }
  ++number_.updates;
  for (std::size_t m = 0; m < reaches_.size(); ++m) {
    if (changes.meshes[m].kind == MeshChange::Kind::still) continue;
    places_[m] = changes.meshes[m].after;
    moved_at_[m] = number_.updates;
  }
  return true;
}

bool MovingMeshes::divide(const MeshBoxes& boxes) const {
  bool has_moving = false, has_still = false;
  for (std::size_t m = 0; m < boxes.meshes.size(); ++m)
    if (boxes.meshes[m].casts) (moves(m) ? has_moving : has_still) = true;
  return has_moving && has_still;
}

}  // namespace gnomon
