#pragma once
#include <gnomon/changes.h>
#include <gnomon/kit/geometry/box_tree.h>

#include <span>

#include "field.h"

namespace gnomon::distance_field {

inline constexpr std::uint32_t no_caster = 0xffffffffu;

/// The fields of all casters of a scene, in the order of its meshes.
class Fields {
 public:
  void build(const Scene& scene, int resolution);
  /// The scene that was built, after some of its vertices moved: fields of meshes that moved are built, the others stay.
  void update(const Scene& scene, const Changes& changes, int resolution);
  /// What they will hold.
  static std::size_t planned_bytes(const Scene& scene, int resolution);

  const Scene& scene() const { return *scene_; }
  int resolution() const { return resolution_; }
  std::size_t count() const { return fields_.size(); }
  const Field& field(std::uint32_t caster) const { return fields_[caster]; }
  std::uint32_t mesh(std::uint32_t caster) const { return meshes_[caster]; }
  /// The caster of a mesh, or no_caster.
  std::uint32_t of_mesh(std::uint32_t mesh) const { return casters_[mesh]; }

  // What a trace asks (trace.h).
  const BoxTree& tree() const { return tree_; }
  double voxel(std::uint32_t caster) const { return fields_[caster].frame().voxel; }
  const Bounds& box(std::uint32_t caster) const { return boxes_[caster]; }
  double distance(std::uint32_t caster, const glm::dvec3& p) const { return fields_[caster].distance(p); }

  std::size_t sample_count() const;
  std::size_t bytes() const;

 private:
  /// Has a field of each caster with extent made by `make(mesh)`.
  template <class Make>
  void fill(const Make& make);

  const Scene* scene_ = nullptr;
  int resolution_ = 0;
  std::vector<Field> fields_;
  std::vector<std::uint32_t> meshes_;   ///< of each field
  std::vector<std::uint32_t> casters_;  ///< of each mesh
  std::vector<Bounds> boxes_;           ///< of the frames
  BoxTree tree_;                        ///< over these boxes
};

}  // namespace gnomon::distance_field
