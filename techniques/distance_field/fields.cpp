#include "fields.h"

#include <gnomon/kit/geometry/refit.h>

#include <utility>

namespace gnomon::distance_field {

template <class Make>
void Fields::fill(const Make& make) {
  std::vector<Field> fields;
  std::vector<std::uint32_t> meshes, casters(scene_->meshes.size(), no_caster);
  std::vector<Bounds> boxes;
  for (std::uint32_t m = 0; m < scene_->meshes.size(); ++m) {
    if (!scene_->meshes[m].casts) continue;
    Field field = make(m);
    if (field.frame().empty()) continue;
    casters[m] = static_cast<std::uint32_t>(fields.size());
    meshes.push_back(m);
    boxes.push_back(field.frame().bounds());
    fields.push_back(std::move(field));
  }
  fields_ = std::move(fields);
  meshes_ = std::move(meshes);
  casters_ = std::move(casters);
  tree_ = BoxTree(boxes);
  boxes_ = std::move(boxes);
}

void Fields::build(const Scene& scene, int resolution) {
  scene_ = &scene;
  resolution_ = resolution;
  fields_.clear();
  fill([&](std::uint32_t m) { return Field(scene.meshes[m], resolution); });
}

void Fields::update(const Scene& scene, const Changes& changes, int resolution) {
  if (resolution != resolution_ || scene_ != &scene) return build(scene, resolution);
  if (!has_moved_caster(scene, changes)) return;
  fill([&](std::uint32_t m) {
    if (has_moved(changes, m) || casters_[m] == no_caster) return Field(scene.meshes[m], resolution);
    return std::move(fields_[casters_[m]]);
  });
}

std::size_t Fields::planned_bytes(const Scene& scene, int resolution) {
  std::size_t samples = 0;
  for (const Mesh& mesh : scene.meshes)
    if (mesh.casts) samples += Frame(mesh, resolution).sample_count();
  return samples * sizeof(std::uint16_t);
}

std::size_t Fields::sample_count() const {
  std::size_t sum = 0;
  for (const Field& field : fields_) sum += field.frame().sample_count();
  return sum;
}

std::size_t Fields::bytes() const {
  std::size_t sum = bytes_of(fields_, meshes_, casters_, boxes_) + tree_.bytes();
  for (const Field& field : fields_) sum += field.bytes();
  return sum;
}

}  // namespace gnomon::distance_field
