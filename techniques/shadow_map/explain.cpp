#include "explain.h"

#include <algorithm>
#include <cmath>

namespace gnomon::shadow_map {

double axis_distance(const Face& face, double depth) {
  if (depth == 0) return INFINITY;
  return face.is_perspective ? face.near / depth : face.far - depth * (face.far - face.near);
}

namespace {

bool is_inside(const glm::ivec2& texel, int resolution) {
  return glm::all(glm::greaterThanEqual(texel, glm::ivec2(0))) && glm::all(glm::lessThan(texel, glm::ivec2(resolution)));
}

/// The ray through the center of a texel, and what is stored there; infinity also off the image.
Tap tap_of(const Image& image, const glm::ivec2& texel, double weight) {
  const Face& face = image.face;
  const glm::dvec2 window = (glm::dvec2(texel) + 0.5 - face.offset) / face.scale;
  const double z = is_inside(texel, image.resolution)
                       ? axis_distance(face, image.depths[std::size_t(texel.y) * image.resolution + texel.x])
                       : INFINITY;
  if (!face.is_perspective) return {face.to_world({window, face.near}), face.axis(2), weight, z - face.near};
  const glm::dvec3 through(window, 1);
  return {face.origin, glm::normalize(through * face.light_from_world), weight, z * glm::length(through)};
}

}  // namespace

Explanation explain(const Image& image, const Comparison& comparison, const glm::dvec3& point, const glm::dvec3& normal,
                    const glm::ivec2& center) {
  const Face& face = image.face;
  Explanation why;
  glm::dvec3 q = face.seen(point);
  const glm::dvec3 n = face.turned(normal);
  const glm::dvec3 ray = face.is_perspective ? q / q.z : glm::dvec3(0, 0, 1);
  const double facing = -glm::dot(n, ray);
  const glm::dvec2 width = face.texel_width(q.z);
  why.texel_width = std::max(width.x, width.y);
  double axis_bias = comparison.depth_bias * why.texel_width;
  if (comparison.bias == Bias::slope)
    axis_bias += comparison.slope_bias * glm::length(width) / 2 * glm::length(glm::cross(n, ray)) / (facing * glm::length(ray));
  if (comparison.bias == Bias::receiver_plane) {
    const double error = comparison.rounding * (face.is_perspective ? 1 + q.z * q.z / (face.near * face.far) : 1);
    axis_bias += (error + why.texel_width / 128) / facing;
  }
  if (comparison.bias == Bias::normal_offset) {
    const double z = q.z;
    q += n * (comparison.normal_offset * why.texel_width);
    why.shifted = face.to_world(q);
    axis_bias += z - q.z;  // what the look-up point is nearer to the light by
  }
  why.bias = axis_bias * glm::length(ray);
  // A point that nothing shadows may be looked up beside the image; where something does, its shadow is not in there.
  why.covered = is_inside(center, image.resolution);
  const int r = comparison.radius;
  for (int y = -r; y <= r; ++y)
    for (int x = -r; x <= r; ++x)
      why.taps.push_back(tap_of(image, center + glm::ivec2(x, y), 1.0 / ((2 * r + 1) * (2 * r + 1))));
  return why;
}

}  // namespace gnomon::shadow_map
