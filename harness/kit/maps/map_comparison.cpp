#include <gnomon/kit/maps/map_comparison.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace gnomon {

int MapFilter::margin() const {
  switch (kind) {
    case Kind::pcf:
      return radius;
    case Kind::disc:
      return radius + 1;
    case Kind::bilinear:
      return 1;
    default:
      return 0;
  }
}

// The point is up to half a texel from the middle of its own, along both axes; that of a disc is its center.
double MapFilter::reach() const {
  switch (kind) {
    case Kind::pcf:
      return 2 * radius + 1;
    case Kind::disc:
      return (radius + 0.5) * std::numbers::sqrt2;
    case Kind::bilinear:
      return 2;
    default:
      return 1;
  }
}

std::vector<WeightedTexel> MapFilter::texels(const glm::dvec2& place) const {
  const glm::ivec2 own(glm::floor(place));
  std::vector<WeightedTexel> texels;
  double sum = 0;
  const auto add = [&](const glm::ivec2& texel, double weight) {
    texels.push_back({texel, weight});
    sum += weight;
  };
  if (kind == Kind::bilinear) {
    const glm::dvec2 corner = glm::floor(place - 0.5), share = place - 0.5 - corner;
    for (int k = 0; k < 4; ++k) {
      const glm::ivec2 aside(k % 2, k / 2);
      const glm::dvec2 near = glm::mix(1.0 - share, share, glm::dvec2(aside));
      add(glm::ivec2(corner) + aside, near.x * near.y);
    }
  } else {
    const int m = margin();
    for (int y = -m; y <= m; ++y)
      for (int x = -m; x <= m; ++x) {
        const glm::ivec2 texel = own + glm::ivec2(x, y);
        const double distance = glm::distance(glm::dvec2(texel) + 0.5, place);
        add(texel, kind == Kind::disc ? glm::clamp(radius + 0.5 - distance, 0.0, 1.0) : 1);
      }
  }
  for (WeightedTexel& one : texels) one.weight /= sum;
  return texels;
}

int MapComparison::margin() const {
  const int offset = bias == Bias::normal_offset ? static_cast<int>(std::ceil(normal_offset)) : 0;
  return filter.margin() + offset + 1;
}

Explanation explain_comparison(const DepthTexels& texels, const MapComparison& comparison, const glm::dvec3& point,
                               const glm::dvec3& normal, const glm::dvec2& place) {
  const LightImage& image = texels.image;
  Explanation why;
  glm::dvec3 q = image.seen(point);
  const glm::dvec3 n = image.turned(normal);
  const glm::dvec3 ray = image.is_perspective ? q / q.z : glm::dvec3(0, 0, 1);
  const double facing = -glm::dot(n, ray);
  const glm::dvec2 width = image.texel_width(q);
  why.texel_width = std::max(width.x, width.y);
  double axis_bias = comparison.depth_bias * why.texel_width;
  if (comparison.bias == MapComparison::Bias::slope)
    axis_bias += comparison.slope_bias * glm::length(width) / 2 * glm::length(glm::cross(n, ray)) / (facing * glm::length(ray));
  if (comparison.bias == MapComparison::Bias::receiver_plane) {
    const double error = texels.camera.rounding * (image.is_perspective ? 1 + q.z * q.z / (image.near * image.far) : 1);
    axis_bias += (error + why.texel_width / 128) / facing;
  }
  if (comparison.bias == MapComparison::Bias::normal_offset) {
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

}  // namespace gnomon
