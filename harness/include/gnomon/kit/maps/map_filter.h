#pragma once
#include <gnomon/kit/gl/gl.h>
#include <gnomon/kit/maps/light_camera.h>

namespace gnomon {

/// Which texels are compared for one point. Mirrored by the shader: kit/maps/map_comparison.h.
struct MapFilter {
  /// In the order of the parameter's choices.
  enum class Kind { nearest, pcf, disc, bilinear, optimized, bicubic, rotated, revectorized };
  Kind kind = Kind::nearest;
  int radius = 0;  ///< texels; of pcf, disc, optimized (1 .. most_optimized) and rotated
  // Of rotated: so many places of a spiral, turned by the noise of one frame after the other.
  int taps = 8, first_frame = 0, frames = 1;
  int search = 16;           ///< of revectorized: texels that an edge is followed by, either way
  bool bails_early = false;  ///< five texels decide where they agree, of those that have a loop

  static constexpr int most_optimized = 3, most_taps = 64;
  /// More than four texels, in a loop of the shader.
  bool has_loop() const { return kind != Kind::nearest && kind != Kind::bilinear && kind != Kind::revectorized; }
  /// Texels that a comparison may lie beside the one that holds the point.
  int margin() const;
  /// How far the centers of compared texels may be from the point, in half diagonals of a texel. Depths of a plane spread by so
  /// much more than inside one texel, and biases grow with it.
  double reach() const;
  /// For a point at this place, in texels, seen in this pixel, which noise depends on. Weights sum to 1. Of revectorized the
  /// place is that of the texel whose answer the point has.
  std::vector<WeightedTexel> texels(const glm::dvec2& place, const glm::ivec2& pixel = {}) const;
  /// The five that decide where they agree, and how far the outer four are from the middle along both axes.
  std::vector<WeightedTexel> first_texels(const glm::dvec2& place) const;
  int first_step() const;
  /// Place k of rotated, in texels from the point, before it is turned.
  glm::dvec2 spiral(int k) const;
  /// Weights of optimized along one axis, without their sum: of texel k from the border, 0 .. radius.
  static std::span<const float> kernel(int radius);
};

/// GLSL: compiled for one kind of filter by the head. The snippet follows comparison_snippet, whose `compared` it is. Of
/// revectorized that leaves the place of the deciding texel in `decided_at`.
std::string filter_head(const MapFilter& filter);
extern const std::string_view filter_snippet;
/// Sets its uniforms.
void set_filter(const Program& program, const MapFilter& filter);

}  // namespace gnomon
