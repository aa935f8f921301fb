#pragma once
#include <gnomon/gbuffer.h>
#include <gnomon/kit/bytes.h>
#include <gnomon/kit/geometry/exact.h>

namespace gnomon {

/// A point whose light is queried, and the surface it lies on: the one place that says what of that surface cannot shade it.
///
/// The point's coordinates are rounded and then taken as exact, so in general it is not on the plane of its own triangle. Where
/// rounding has put it behind that plane, as the light sees it, the triangle lies between the two, and so does every other
/// triangle in the plane. None of them casts a shadow there: the own triangle, and every caster exactly coplanar with it, never
/// shades the point. On an exact sphere, cone or disc there is no own triangle, and the whole own mesh is left out: these
/// bodies are convex, so none shades a point of its own surface that faces the light.
struct Receiver {
  static constexpr std::uint32_t whole_mesh = 0xffffffffu;
  glm::vec3 point{0};
  std::uint32_t mesh = no_mesh;         ///< no_mesh: a point in space, everything may shade it
  std::uint32_t triangle = whole_mesh;  ///< of that mesh; whole_mesh: no triangle of the mesh shades the point

  bool has_triangle() const { return mesh != no_mesh && triangle != whole_mesh; }
  /// Whether a triangle of a mesh is the own one, or of a mesh left out whole.
  bool is_own(std::uint32_t other_mesh, std::uint32_t other_triangle) const {
    return mesh != no_mesh && other_mesh == mesh && (triangle == whole_mesh || other_triangle == triangle);
  }
  /// Whether the point has a triangle of its own and these three corners lie exactly in its plane.
  bool is_coplanar(const Scene& scene, const glm::vec3* corners) const;
};

/// The receiver of a pixel that shows a surface.
inline Receiver receiver_at(const Scene& scene, const GBuffer& gbuffer, std::size_t i) {
  const std::uint32_t mesh = gbuffer.mesh[i];
  const bool is_on_shape = gbuffer.truth == Truth::shape && mesh != no_mesh && scene.meshes[mesh].has_curved_shape();
  return {gbuffer.position(i), mesh, is_on_shape ? Receiver::whole_mesh : gbuffer.triangle[i]};
}

/// A receiver for those who count triangles over the scene.
struct NumberedReceiver : Receiver {
  std::uint32_t first_own = 0, own_count = 0;  ///< one triangle, or a whole mesh
  bool is_own(std::uint32_t number) const { return number - first_own < own_count; }
  /// All of the rule. Computes exact signs only where the numbers do not settle it.
  bool leaves_out(const Scene& scene, std::uint32_t number, const glm::vec3* corners) const {
    return is_own(number) || is_coplanar(scene, corners);
  }
};

/// Numbers of the triangles of a scene, counted mesh after mesh.
class TriangleNumbers {
 public:
  TriangleNumbers() = default;
  explicit TriangleNumbers(const Scene& scene);
  std::uint32_t first_of(std::size_t mesh) const { return first_[mesh]; }
  std::uint32_t end_of(std::size_t mesh) const { return first_[mesh + 1]; }
  std::uint32_t mesh_of(std::uint32_t number) const;
  /// `on_surface` as `receiver_at` gives it.
  NumberedReceiver numbered(const Receiver& on_surface) const {
    const std::uint32_t mesh = on_surface.mesh;
    if (mesh == no_mesh) return {on_surface, 0, 0};
    if (on_surface.triangle == Receiver::whole_mesh) return {on_surface, first_of(mesh), end_of(mesh) - first_of(mesh)};
    return {on_surface, first_of(mesh) + on_surface.triangle, 1};
  }
  std::size_t bytes() const { return bytes_of(first_); }

 private:
  std::vector<std::uint32_t> first_;  // of each mesh; the last is the number of all triangles
};

}  // namespace gnomon
