#pragma once
#include <gnomon/kit/maps/glass_setting.h>
#include <gnomon/kit/maps/light_space.h>
#include <gnomon/technique.h>

namespace gnomon {

// The camera of a light: one image for a directional light and for a narrow spot, six around a point light and a wide spot.
// Each image is fitted to what casters and receivers share, or to what a view shows of it; kit/maps/light_map.h draws it.

/// What light cameras read of a scene.
struct MeshBox {
  Bounds bounds;  ///< with room for rounding: a flat mesh has a box with an inside
  bool casts, receives;
};
struct MeshBoxes {
  std::vector<MeshBox> meshes;
  double extent = 0;  ///< largest coordinate of the scene, meters
};
/// Casters with transmission cast where they are taken for opaque.
MeshBoxes mesh_boxes(const Scene& scene, GlassAs glass = GlassAs::opaque);
/// Diagonal of the box of what all meshes reach, meters: the same in all frames of a row whose meshes move. 0 where there is
/// none.
double diagonal_of(const Scene& scene);

/// A face of the light and its image. Window coordinates of a point are its place on the face; texel coordinates are
/// window * scale + offset, row 0 on top. A warped image is seen in perspective: its texels are largest where window.y is, and
/// their coordinates are (window - pivot) / (1 + lean * (window.y - pivot.y)) * scale + offset.
struct LightImage : LightSpaceFace {
  glm::dvec2 scale{1}, offset{0};
  glm::dvec2 pivot{0};
  double lean = 0;                       ///< 0: not warped; all of a warped image lies at window.y >= pivot.y
  double near = 0, far = 0;              ///< along the axis, meters; casters outside are clamped to it
  std::vector<std::uint32_t> casters{};  ///< indices of the meshes to draw; none: nothing to draw and nothing to look up
  int layer = -1;                        ///< of the texture that holds the images of a camera; -1: it has no casters

  bool operator==(const LightImage&) const = default;
  /// What a warped image divides by: 1 at the pivot, larger where texels are.
  double divisor(const glm::dvec2& window) const { return 1 + lean * (window.y - pivot.y); }
  glm::dvec2 texel_of(const glm::dvec2& window) const { return (window - pivot) / divisor(window) * scale + offset; }
  glm::dvec2 window_of(const glm::dvec2& texel) const;
  /// How texel coordinates change when window coordinates do, by a small step.
  glm::dvec2 texel_step(const glm::dvec2& window, const glm::dvec2& step) const;
  /// World width of a texel across the axis at a point of the face's frame: of the box around it, for one of a warped image
  /// leans.
  glm::dvec2 texel_width(const glm::dvec3& q) const;
  double largest_texel(const glm::dvec3& q) const { return std::max(texel_width(q).x, texel_width(q).y); }
  /// Reversed depth: near / z, or linear; 1 at `near`, 0 at infinity or `far`. A warped image stores it over its divisor. Of
  /// points less `shift`.
  glm::dmat4 clip_from_world(int resolution, const glm::dvec3& shift = glm::dvec3(0)) const;
  /// Axis distance of a depth, in a warped image after its divisor is taken away; infinity where nothing is stored.
  double axis_distance(double depth) const;
  /// For explanations: the ray through a place, in texels, and a surface stored there at axis distance z.
  Tap tap(const glm::dvec2& place, double z, double weight) const;
  /// How long a way along the light ray through a point is that takes 1 along the axis.
  double stretch(const glm::dvec3& point) const { return is_perspective ? glm::length(seen(point)) / seen(point).z : 1; }
};

/// Widest half-angle of a spot light that one image serves.
inline constexpr float widest_spot_degrees = 60;

/// Whether a light without area looks through the six faces of a cube: a point light, and a spot that is wider than that.
bool looks_through_cube(const Light& light);

/// The faces of a light without area around a scene. A cube's faces that look against an axis are mirrored: they only exchange
/// axes. Points between faces fall on the first of x, y, z.
LightSpace light_space_of(const Light& light, const MeshBoxes& boxes);

/// What of some points is seen through a face: a rectangle of window coordinates and a range of axis distance.
struct LightExtent {
  glm::dvec2 low{INFINITY}, high{-INFINITY};
  double near = INFINITY, far = -INFINITY;
  bool empty() const { return near > far; }
  void add(const glm::dvec2& window, double z) { add({window, window, z, z}); }
  void add(const LightExtent& e) {
    low = glm::min(low, e.low);
    high = glm::max(high, e.high);
    near = std::min(near, e.near);
    far = std::max(far, e.far);
  }
};

/// What of a solid box is seen through a face; where rays start at the light, within |x|, |y| <= tangent * z.
LightExtent seen_of(const LightSpaceFace& face, const Bounds& box, double tangent);

/// How a picture is divided by depth, each slice with an image of its own; of lights with one face.
struct ViewSlices {
  static constexpr int most = 4;
  glm::dvec3 eye{0}, axis{0};  ///< depth is measured along the axis, unit, from the eye
  std::vector<double> ends{};  ///< where all slices but the last one end, ascending, meters
  /// Over how much depth before its end each of these is blended with the next, meters; empty: none is.
  std::vector<double> overlaps{};

  bool operator==(const ViewSlices&) const = default;
  double depth_of(const glm::dvec3& point) const { return glm::dot(axis, point - eye); }
  int slice_of(const glm::dvec3& point) const {
    return static_cast<int>(std::ranges::lower_bound(ends, depth_of(point)) - ends.begin());
  }
  double overlap(int slice) const { return overlaps.empty() ? 0 : overlaps[static_cast<std::size_t>(slice)]; }
};

/// What images a camera has: one for each face of the light; one for each slice of the picture, up to ViewSlices::most; one
/// that is warped. Slices and warps are of lights with one face.
enum class LightImages { faces, slices, warped };

/// A texel that counts for a point, and its share of the answer.
struct WeightedTexel {
  glm::ivec2 texel;
  double weight;
};

/// The images of a light, each `resolution` texels square: one for each of its faces, or for each slice of a picture.
struct LightCamera {
  LightSpace space{};
  std::vector<LightImage> images{};
  int resolution = 0, layer_count = 0;
  double rounding = 0;  ///< float32 error of an axis distance that a shader computes, meters
  ViewSlices slices{};
  /// What is subtracted from vertices before they are transformed, which float32 does exactly near it; zero changes no bit.
  glm::vec3 shift{0};

  /// Images of equal cameras are drawn alike.
  bool operator==(const LightCamera&) const = default;
  bool is_cube() const { return space.face_count() == 6; }
  /// The image that a point is looked up in.
  int image_of(const glm::dvec3& point) const { return is_cube() ? space.face_of(point) : slices.slice_of(point); }
  /// Whether a texel lies on the image.
  bool holds(const glm::ivec2& texel) const;
  /// Those of an image among the texels of all layers, row after row; none where it is not drawn.
  std::span<const float> texels_of(const LightImage& image, std::span<const float> all) const;
  /// A texel of an image, for explanations: the ray through its center, and what is stored there; infinity where nothing is,
  /// and beside the image. `depths` are those of all layers, row after row, as read_texels gives them.
  Tap tap(const LightImage& image, std::span<const float> depths, const glm::ivec2& texel, double weight) const;
};

/// Fitted to the scene: each image holds all that casters and receivers share. `margin` texels are kept free on each side, so
/// that no tap of a point on the face falls off the image: neighboring faces of a cube overlap by that much, and no tap ever
/// has to cross a seam.
LightCamera fit_to_scene(const Light& light, const MeshBoxes& boxes, int resolution, int margin);

/// Fitted to a picture: each image holds the receiving points of the G-buffer that face the light, and of the casters what may
/// lie before them. Costs a pass over the points on all threads. `radius` is that of a ball around the light: points count
/// that face any of it.
LightCamera fit_to_view(const Light& light, const MeshBoxes& boxes, const GBuffer& gbuffer, int resolution, int margin,
                        double radius = 0);

/// The receiving points of a picture that face the light, row after row: for fits of one's own.
std::vector<glm::dvec3> points_facing(const Light& light, const MeshBoxes& boxes, const GBuffer& gbuffer);

/// For Technique::image_parts: the image that each pixel is looked up in, from 1 on; 0 where it does not face the light.
/// Nothing of a camera with one image. Next to a seam the shader's float32 may say otherwise than this does in double.
std::vector<std::uint32_t> parts_of(const LightCamera& camera, const Scene& scene, const GBuffer& gbuffer, const Light& light);

/// Whether images take all of the extents that they are given, or what casters share with them.
enum class FitWindow { shared, whole };
/// Fitted to what receives: an image for each of the extents, which are those of the faces of the light's space, or of the
/// slices of a picture through its only face.
LightCamera fit_to_extents(const Light& light, const LightSpace& space, const MeshBoxes& boxes,
                           std::span<const LightExtent> receivers, int resolution, int margin,
                           FitWindow window = FitWindow::shared);

}  // namespace gnomon
