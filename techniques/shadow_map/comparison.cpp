#include "comparison.h"

#include <algorithm>

namespace gnomon::shadow_map {

Explanation explain(const DepthTexels& texels, const Comparison& comparison, const glm::dvec3& point, const glm::dvec3& normal,
                    const glm::dvec2& place) {
  const LightImage& image = texels.image;
  Explanation why;
  glm::dvec3 q = image.seen(point);
  const glm::dvec3 n = image.turned(normal);
  const glm::dvec3 ray = image.is_perspective ? q / q.z : glm::dvec3(0, 0, 1);
  const double facing = -glm::dot(n, ray);
  const glm::dvec2 width = image.texel_width(q.z);
  why.texel_width = std::max(width.x, width.y);
  double axis_bias = comparison.depth_bias * why.texel_width;
  if (comparison.bias == Bias::slope)
    axis_bias += comparison.slope_bias * glm::length(width) / 2 * glm::length(glm::cross(n, ray)) / (facing * glm::length(ray));
  if (comparison.bias == Bias::receiver_plane) {
    const double error = texels.camera.rounding * (image.is_perspective ? 1 + q.z * q.z / (image.near * image.far) : 1);
    axis_bias += (error + why.texel_width / 128) / facing;
  }
  if (comparison.bias == Bias::normal_offset) {
    const double z = q.z;
    q += n * (comparison.normal_offset * why.texel_width);
    why.shifted = image.to_world(q);
    axis_bias += z - q.z;  // what the look-up point is nearer to the light by
  }
  why.bias = axis_bias * glm::length(ray);
  // A point that nothing shadows may be looked up beside the image; where something does, its shadow is not in there.
  why.covered = texels.camera.holds(glm::ivec2(glm::floor(place)));
  for (const auto& [texel, weight] : comparison.filter.texels(place))
    if (weight > 0) why.taps.push_back(texels.camera.tap(image, texels.depths, texel, weight));
  return why;
}

}  // namespace gnomon::shadow_map
