#pragma once
#include <gnomon/kit/geometry/box_tree.h>
#include <gnomon/kit/geometry/holes.h>

namespace gnomon {

/// A surface of glass on a ray: its distance from the ray's origin in units of the direction, and what it lets through.
struct GlassCrossing {
  double distance;
  double transmission;  ///< red; below 1
};

/// What part of the light the first surfaces of a list let through, those nearer than a distance.
double share_before(std::span<const GlassCrossing> list, double distance);

/// A texel that a look-up reads: the exact list of the ray through its center, to the depth of the look-up.
struct GlassTexel {
  glm::ivec3 texel;  ///< column, row, layer
  double weight;
  double share;  ///< product of the list, 0 .. 1
};

/// The glass of a scene, for exact lists along rays: what maps approximate. In double; holes and texels as `is_solid_along` and
/// `transmission_along` find them. The scene must outlive it.
class GlassLists {
 public:
  explicit GlassLists(const Scene& scene);
  /// All surfaces on a ray, nearest first. Two triangles of a mesh whose common edge the ray goes through count once.
  std::vector<GlassCrossing> along(const glm::dvec3& origin, const glm::dvec3& direction) const;

 private:
  struct Caster {
    Triangle corners;
    std::uint32_t mesh, triangle;
  };
  const Scene* scene_;
  BoxTree tree_;
  std::vector<Caster> casters_;  // in the tree's order
};

}  // namespace gnomon
