#pragma once
#include <gnomon/changes.h>
#include <gnomon/kit/add_up.h>
#include <gnomon/kit/geometry/box_tree.h>
#include <gnomon/kit/geometry/crossings.h>
#include <gnomon/kit/geometry/receiver.h>

namespace gnomon::crow_counting {

/// The work of questions to single casters, and what they find.
struct SingleWork {
  std::uint64_t points = 0, tests = 0;  ///< tested; triangles met by the boxes around them
  Crossings glass;                      ///< of the last question
  SingleWork& operator+=(const SingleWork& other) { return add_up(*this, other, &SingleWork::points, &SingleWork::tests); }
};

/// The casters with alpha masks or transmission. The outline of a card says nothing of its holes, whose borders are thousands
/// of edges, and a count of volumes says nothing of what each lets through. So none of their triangles takes part in outlines
/// and caps: each has a volume of its own, less what its holes let through, and whether that holds a point is decided for each
/// point by exact signs and the exact texel.
class SingleCasters {
 public:
  static constexpr std::uint32_t none = 0xffffffffu;

  static bool is_single(const Mesh& mesh) { return mesh.alpha_mask || mesh.transmission; }

  /// The scene must outlive it.
  void build(const Scene& scene, const TriangleNumbers& numbers) {
    scene_ = &scene;
    casters_.clear();
    tree_ = {};
    has_transmission_ = scene.has_transmission();
    std::vector<Caster> found;
    std::vector<Bounds> bounds;
    for (std::uint32_t m = 0; m < scene.meshes.size(); ++m) {
      const Mesh& mesh = scene.meshes[m];
      if (!mesh.casts || !is_single(mesh)) continue;
      for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
        found.push_back({mesh.corners(t), m, t, numbers.first_of(m) + t});
        bounds.emplace_back().add(found.back().corners.points);
      }
    }
    if (found.empty()) return;
    tree_ = BoxTree(bounds);
    casters_.reserve(found.size());
    for (const std::uint32_t i : tree_.order()) casters_.push_back(found[i]);
  }
  /// Builds where one of them moved.
  void update(const Scene& scene, const TriangleNumbers& numbers, const Changes& changes) {
    for (std::size_t m = 0; m < scene.meshes.size(); ++m) {
      const Mesh& mesh = scene.meshes[m];
      if (changes.meshes[m].kind != MeshChange::Kind::still && mesh.casts && is_single(mesh)) return build(scene, numbers);
    }
  }
  bool empty() const { return casters_.empty(); }
  bool has_transmission() const { return has_transmission_; }

  /// An opaque triangle that is solid on the way from a point to the light, counted over the scene, or `none`. `work.glass`
  /// becomes the solid triangles with transmission on the way; where an opaque one is found, some.
  std::uint32_t on_way(const NumberedReceiver& receiver, const glm::dvec4& light, SingleWork& work) const {
    const Segment segment{receiver.point, light};
    std::uint32_t found = none;
    ++work.points;
    work.glass.clear();
    tree_.any(SegmentSlabs(segment), 0, [&](std::uint32_t place) {
      const Caster& caster = casters_[place];
      ++work.tests;
      if (crosses(segment, caster.corners) == Crossing::none) return false;
      if (receiver.leaves_out(*scene_, caster.number, caster.corners.points)) return false;
      const Mesh& mesh = scene_->meshes[caster.mesh];
      if (!is_solid_at(mesh, caster.triangle, segment)) return false;
      if (mesh.transmission) {
        work.glass.add(caster.mesh, caster.triangle);
        return false;
      }
      found = caster.number;
      return true;
    });
    return found;
  }

  std::size_t bytes() const { return tree_.bytes() + bytes_of(casters_); }

 private:
  struct Caster {
    Triangle corners;
    std::uint32_t mesh, triangle;
    std::uint32_t number;  ///< of the triangle, counted over the scene
  };

  const Scene* scene_ = nullptr;
  bool has_transmission_ = false;
  BoxTree tree_;
  std::vector<Caster> casters_;  // in the order of the tree
};

}  // namespace gnomon::crow_counting
