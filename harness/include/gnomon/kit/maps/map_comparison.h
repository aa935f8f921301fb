#pragma once
#include <gnomon/kit/maps/bias_presets.h>
#include <gnomon/kit/maps/light_map.h>
#include <gnomon/kit/maps/map_filter.h>

namespace gnomon {

// How a point is compared with the depths that a light camera stored: bias and filter, for techniques that differ in which
// images they draw. The shader decides; the same in double explains.

/// As the parameters of the same names say, times the reach of the filter; of a preset its own numbers.
struct MapComparison {
  /// In the order of the parameter's choices, which ends with the presets.
  enum class Bias { constant, slope, normal_offset, receiver_plane, adaptive, preset };
  Bias bias;
  double depth_bias, slope_bias, normal_offset;
  MapFilter filter;
  double meters = 0;  ///< of a preset along the light ray; of adaptive its epsilon, see bias_presets.h
  BiasForm form{};    ///< of a preset, and how the normal offset is meant

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

/// A point, and where the shader looked it up.
struct ExplainedPoint {
  glm::dvec3 position, normal;
  glm::dvec2 place;               ///< in texels
  glm::ivec2 pixel{0};            ///< that it is seen in
  bool is_decided_early = false;  ///< by the five texels of MapFilter::first_texels
};

/// What the shader does with one point. Shader and explanation may differ where stored and expected depth agree to float32
/// rounding, but for the texels.
Explanation explain_comparison(const DepthTexels& texels, const MapComparison& comparison, const ExplainedPoint& point);

/// GLSL: compiled for one bias and one filter by the head, after that of the light map. `comparison_constants` are beside those
/// of the light map. The snippet offers
///
///   ComparedPoint ask(vec4 surface, vec4 facet)   of position_here and normal_here: chooses the image
///   float compared(ComparedPoint point)           the answer: 1 where the point is none to decide
///   bool is_decided_early                         of the last answer: by the five texels
///
/// and in `ComparedPoint` the `position`, in texels, where the point is looked up.
std::string comparison_head(const MapComparison& comparison);
std::string comparison_constants(LightProjection projection, LightImages images = LightImages::faces);
extern const std::string_view comparison_snippet;
/// Sets camera, light and the constants.
void set_comparison(const Program& program, const Light& light, const LightCamera& camera, const MapComparison& comparison);

}  // namespace gnomon
