#pragma once
#include <gnomon/kit/light_space.h>
#include <gnomon/scene.h>

#include <vector>

// The light's depth images: six faces of a cube around a point light (or a wide spot), one image for a narrow spot or a
// directional light. Each is fitted to casters and receivers, never to the view.
namespace gnomon::shadow_map {

/// Bounding box of a mesh.
struct MeshBox {
  Bounds bounds;
  bool casts, receives;
};

/// A face of the light and its image. Window coordinates of a point are its place on the face; texel coordinates are
/// window * scale + offset, row 0 on top.
struct Face : LightFace {
  glm::dvec2 scale{1}, offset{0};
  double near = 0, far = 0;              ///< along the axis, meters; casters outside are clamped to it
  std::vector<std::uint32_t> casters{};  ///< indices of the meshes to draw; none: nothing to draw and nothing to look up

  /// World width of a texel across the axis at axis distance z.
  glm::dvec2 texel_width(double z) const { return (is_perspective ? z : 1) / scale; }
  /// Reversed depth: near / z, or linear; 1 at `near`, 0 at infinity or `far`.
  glm::dmat4 clip_from_world(int resolution) const;
};

/// Widest half-angle of a spot light that one image serves.
inline constexpr float widest_spot_degrees = 60;

/// The faces of a light around a scene. A cube's faces that look against an axis are mirrored: they only exchange axes. Points
/// between faces fall as in the shader, in the order x, y, z.
LightSpace space_of(const Light& light, const std::vector<MeshBox>& boxes);

/// One image or six, fitted to what its casters and receivers share. `margin` texels are kept free on each side, so that no tap
/// of a point on the face falls off the image: neighboring cube faces overlap by that much, and no tap ever has to cross a
/// seam.
std::vector<Face> fit_faces(const Light& light, const LightSpace& space, const std::vector<MeshBox>& boxes, int resolution,
                            int margin);

}  // namespace gnomon::shadow_map
