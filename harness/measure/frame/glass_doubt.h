#pragma once
#include <gnomon/kit/geometry/box_tree.h>
#include <gnomon/kit/geometry/receiver.h>

namespace gnomon {

/// Where rounding to float32 may change which triangles with transmission a way crosses, or what they let through. The moved
/// rays of class U see opaque casters alone: through glass they would have to count, and a ray tracer's count is in doubt in
/// the very places that are looked for. Distances in double tell them. The scene must outlive it; any thread may use it.
class GlassDoubt {
 public:
  /// `extent` as of gnomon::extent(scene, light, view), meters.
  GlassDoubt(const Scene& scene, const glm::dvec4& light, double extent);
  bool empty() const { return casters_.empty(); }

  /// Of a way that no opaque caster blocks, and on which the reference found `share`: whether it passes an edge of glass, or
  /// glass one of its ends, by rho = 16 * 2^-24 * extent or less, or crosses it where within texel_rounding another texel lets
  /// through more or less by over 1/256, or is a hole, or nothing is left without a reason; and whether nothing on the way is
  /// opaque beyond doubt (t = 0), which would settle the answer.
  bool is_uncertain(const Receiver& receiver, float share) const;

 private:
  struct Caster {
    std::uint32_t mesh, triangle;
  };
  enum class Found { nothing, light, dark, doubt };
  Found at(const Receiver& receiver, const Caster& caster, const glm::dvec3& way) const;
  /// What a triangle lets through where the way meets its plane.
  Found through(const Receiver& receiver, const Caster& caster, const glm::dvec3& way) const;

  const Scene& scene_;
  glm::dvec4 light_;
  double extent_, rho_ = 16 * 0x1p-24 * extent_;
  BoxTree tree_;
  std::vector<Caster> casters_;  ///< in the order of the tree
};

}  // namespace gnomon
