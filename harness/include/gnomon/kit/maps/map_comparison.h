#pragma once
#include <gnomon/kit/maps/light_map.h>

namespace gnomon {

// How a point is compared with the depths that a light camera stored: bias and filter, for techniques that differ in which
// images they draw. The shader decides; the same in double explains.

/// Which texels are compared for one point. Mirrored by the shader.
struct MapFilter {
  enum class Kind { nearest, pcf, disc, bilinear };  ///< in the order of the parameter's choices
  Kind kind = Kind::nearest;
  int radius = 0;  ///< texels; of pcf and disc

  /// Texels that a comparison may lie beside the one that holds the point.
  int margin() const;
  /// How far the centers of compared texels may be from the point, in half diagonals of a texel. Depths of a plane spread by so
  /// much more than inside one texel, and biases grow with it.
  double reach() const;
  /// For a point at this place, in texels. Weights sum to 1.
  std::vector<WeightedTexel> texels(const glm::dvec2& place) const;
};

/// As the parameters of the same names say, times the reach of the filter.
struct MapComparison {
  enum class Bias { constant, slope, normal_offset, receiver_plane };  ///< in the order of the parameter's choices
  Bias bias;
  double depth_bias, slope_bias, normal_offset;
  MapFilter filter;

  /// Texels that a look-up may leave the fitted window by: the filter, the normal offset, and one for rounding.
  int margin() const;
  /// Beside those of the light map.
  static constexpr int constant_count = 1;
};

/// An image, and the texels of all images of its camera, row after row.
struct DepthTexels {
  const LightCamera& camera;
  const LightImage& image;
  std::span<const float> depths;
};

/// What the shader does with one point. `place` is where the shader looked it up, in texels: shader and explanation may differ
/// where stored and expected depth agree to float32 rounding, but for the texels.
Explanation explain_comparison(const DepthTexels& texels, const MapComparison& comparison, const glm::dvec3& point,
                               const glm::dvec3& normal, const glm::dvec2& place);

/// GLSL: compiled for one bias and one filter by the head, after that of the light map. `comparison_constants` are beside those
/// of the light map. The snippet offers
///
///   ComparedPoint ask(vec4 surface, vec4 facet)   of position_here and normal_here: chooses the image
///   float compared(ComparedPoint point)           the answer: 1 where the point is none to decide
///
/// and in `ComparedPoint` the `position`, in texels, where the point is looked up.
std::string comparison_head(const MapComparison& comparison);
std::string comparison_constants(LightProjection projection, LightImages images = LightImages::faces);
extern const std::string_view comparison_snippet;
/// Sets camera, light and the constants.
void set_comparison(const Program& program, const Light& light, const LightCamera& camera, const MapComparison& comparison);

}  // namespace gnomon
