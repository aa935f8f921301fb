// How much surface lies in shadow, and how much is wrong: pixels weighted by the area that they cover in the scene.
#include <gnomon/kit/geometry/camera.h>
#include <gnomon/kit/parallel.h>

#include <numeric>

#include "measure/score/metrics.h"

namespace gnomon {

namespace {

/// Sum over the pixels of the area that each covers times weight(i).
template <class Weight>
double area_of(const GBuffer& gbuffer, const Weight& weight) {
  const Camera camera(gbuffer.view, gbuffer.width, gbuffer.height);
  const auto width = static_cast<std::size_t>(gbuffer.width), height = static_cast<std::size_t>(gbuffer.height);
  std::vector<double> rows(height, 0.0);  // added up in order: the same on any number of threads
  for_blocks(height, 16, [&](std::size_t begin, std::size_t end) {
    for (std::size_t y = begin; y < end; ++y)
      for (std::size_t i = y * width; i < (y + 1) * width; ++i)
        if (const double w = weight(i); w > 0) rows[y] += pixel_area(camera, gbuffer, i) * w;
  });
  return std::accumulate(rows.begin(), rows.end(), 0.0);
}

}  // namespace

double pixel_area(const Camera& camera, const GBuffer& gbuffer, std::size_t i) {
  // The ray through image point (u, v), in units of the image plane at distance 1, is r = forward + u right + v up. It meets
  // the plane n.(X - P) = 0 at X = eye + r h / (n.r) with h = n.(P - eye). With a = n.r, linear in u and v,
  //   dX/du x dX/dv = +- n h^2 / a^3,
  // whose integral over the square of side s around the pixel's center is s^2 h^2 a0 / (a1 a2 a3 a4): a at the center, and at
  // the corners.
  if (gbuffer.is_background(i)) return 0;
  const double half = camera.tan_y / camera.height;  // of s; pixels are square
  const auto width = static_cast<std::size_t>(camera.width);
  const glm::dvec3 normal = gbuffer.normal(i);
  const double h = glm::dot(normal, glm::dvec3(gbuffer.position(i)) - camera.eye);
  const double a =
      std::abs(glm::dot(normal, camera.ray(static_cast<double>(i % width) + 0.5, static_cast<double>(i / width) + 0.5)));
  const double across = std::abs(glm::dot(normal, camera.right)) * half, along = std::abs(glm::dot(normal, camera.up)) * half;
  const double sum = across + along, difference = across - along;
  // Distances go as 1 / a: from 1 / (a + sum) to 1 / (a - sum).
  if (!(a >= 2 * sum) || a == 0) return 0;
  return 4 * half * half * h * h * a / ((a * a - sum * sum) * (a * a - difference * difference));
}

double shadow_area(const GBuffer& gbuffer, std::span<const PixelClass> classes, std::span<const float> mask) {
  return area_of(gbuffer, [&](std::size_t i) { return classes[i] == PixelClass::T ? 1 - static_cast<double>(mask[i]) : 0.0; });
}

double wrong_area(const Evidence& e) {
  return area_of(*e.gbuffer, [&](std::size_t i) { return e.classes[i] == PixelClass::T && e.is_wrong(i) ? 1.0 : 0.0; });
}

}  // namespace gnomon
