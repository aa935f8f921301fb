#pragma once
#include <gnomon/technique.h>

#include <span>

#include "faces.h"

// What the resolve shader does with one point, in double.
namespace gnomon::shadow_map {

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

/// Axis distance of a stored depth; infinity where nothing is stored.
double axis_distance(const Face& face, double depth);

/// `center` is the texel that the shader looked up: shader and explanation may differ where stored and expected depth agree to
/// float32 rounding, but for the texel.
Explanation explain(const Image& image, const Comparison& comparison, const glm::dvec3& point, const glm::dvec3& normal,
                    const glm::ivec2& center);

}  // namespace gnomon::shadow_map
