#pragma once
#include <gnomon/kit/add_up.h>
#include <gnomon/kit/geometry/box_tree.h>
#include <gnomon/kit/geometry/holes.h>
#include <gnomon/kit/geometry/receiver.h>

namespace gnomon::crow_counting {

/// The work of questions to masked casters.
struct MaskWork {
  std::uint64_t points = 0, tests = 0;  ///< asked; triangles met by the boxes around them
  MaskWork& operator+=(const MaskWork& other) { return add_up(*this, other, &MaskWork::points, &MaskWork::tests); }
};

/// The casters with alpha masks. The outline of a card says nothing of its holes, whose borders are thousands of edges. So none
/// of their triangles takes part in outlines and caps: each has a volume of its own, less what its holes let through, and
/// whether that holds a point is decided for each point by exact signs and the exact texel.
class MaskedCasters {
 public:
  static constexpr std::uint32_t none = 0xffffffffu;

  /// The scene must outlive it.
  void build(const Scene& scene, const TriangleNumbers& numbers) {
    scene_ = &scene;
    casters_.clear();
    tree_ = {};
    std::vector<Caster> found;
    std::vector<Bounds> bounds;
    for (std::uint32_t m = 0; m < scene.meshes.size(); ++m) {
      const Mesh& mesh = scene.meshes[m];
      if (!mesh.casts || !mesh.alpha_mask) continue;
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
  bool empty() const { return casters_.empty(); }

  /// A triangle that is solid on the way from a point to the light, counted over the scene, or `none`.
  std::uint32_t on_way(const NumberedReceiver& receiver, const glm::dvec4& light, MaskWork& work) const {
    const Segment segment{receiver.point, light};
    std::uint32_t found = none;
    ++work.points;
    tree_.any(SegmentSlabs(segment), 0, [&](std::uint32_t place) {
      const Caster& caster = casters_[place];
      ++work.tests;
      if (crosses(segment, caster.corners) == Crossing::none) return false;
      if (receiver.leaves_out(*scene_, caster.number, caster.corners.points)) return false;
      if (!is_solid_at(scene_->meshes[caster.mesh], caster.triangle, segment)) return false;
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
  BoxTree tree_;
  std::vector<Caster> casters_;  // in the order of the tree
};

}  // namespace gnomon::crow_counting
