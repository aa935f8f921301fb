#pragma once
#include <gnomon/kit/light_space.h>
#include <gnomon/technique.h>

#include <span>

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
  /// Axis distance of a stored depth; infinity where nothing is stored.
  double axis_distance(double depth) const;
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

/// A face with its texels, row after row.
struct Image {
  const Face& face;
  int resolution;
  std::span<const float> depths;
};

/// In the order of the parameter's choices.
enum class Bias { constant, slope, normal_offset, receiver_plane };

/// How a point is compared with texels; as the parameters of the same names say.
struct Comparison {
  Bias bias;
  double depth_bias, slope_bias, normal_offset;
  double rounding;  ///< float32 error of a depth, meters
  int radius;       ///< of the filter, texels
};

/// Whether a texel lies on the image.
bool is_inside(const glm::ivec2& texel, int resolution);

/// What the resolve shader does with one point, in double. `center` is the texel that the shader looked up: shader and
/// explanation may differ where stored and expected depth agree to float32 rounding, but for the texel.
Explanation explain(const Image& image, const Comparison& comparison, const glm::dvec3& point, const glm::dvec3& normal,
                    const glm::ivec2& center);

}  // namespace gnomon::shadow_map
