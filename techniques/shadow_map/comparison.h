#pragma once
#include <gnomon/kit/light_camera.h>
#include <gnomon/technique.h>

#include <span>

#include "filter.h"

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

/// How a point is compared with texels; as the parameters of the same names say, times the reach of the filter.
struct Comparison {
  Bias bias;
  double depth_bias, slope_bias, normal_offset;
  Filter filter;
};

/// What the resolve shader does with one point. `place` is where the shader looked it up, in texels: shader and explanation may
/// differ where stored and expected depth agree to float32 rounding, but for the texels.
Explanation explain(const DepthTexels& texels, const Comparison& comparison, const glm::dvec3& point, const glm::dvec3& normal,
                    const glm::dvec2& place);

}  // namespace gnomon::shadow_map
