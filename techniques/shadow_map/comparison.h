#pragma once
#include <gnomon/kit/light_camera.h>
#include <gnomon/technique.h>

#include <span>

// How a shadow map decides a point, in double.
namespace gnomon::shadow_map {

/// An image, and the texels of all images of its camera, row after row.
struct DepthTexels {
  const LightCamera& camera;
  const LightImage& image;
  std::span<const float> depths;
};

/// In the order of the parameter's choices.
enum class Bias { constant, slope, normal_offset, receiver_plane };

/// How a point is compared with texels; as the parameters of the same names say.
struct Comparison {
  Bias bias;
  double depth_bias, slope_bias, normal_offset;
  int radius;  ///< of the filter, texels
};

/// What the resolve shader does with one point. `center` is the texel that the shader looked up: shader and explanation may
/// differ where stored and expected depth agree to float32 rounding, but for the texel.
Explanation explain(const DepthTexels& texels, const Comparison& comparison, const glm::dvec3& point, const glm::dvec3& normal,
                    const glm::ivec2& center);

}  // namespace gnomon::shadow_map
