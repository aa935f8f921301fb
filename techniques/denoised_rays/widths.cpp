#include "widths.h"

#include <gnomon/kit/area/light_shape.h>
#include <gnomon/kit/parallel.h>

#include <array>
#include <cmath>

namespace gnomon::denoised_rays {

namespace {

/// Part of the rays around a pixel that must be dark before its neighborhood grows no further.
constexpr float enough_dark = 1.0f / 8;
constexpr float open = -1;  ///< sigma of a pixel whose neighborhood still grows

LampSize lamp_size(const LightShape& shape, const glm::dvec3& point) {
  const glm::dvec3 way = shape.center - point;
  const double distance = glm::length(way);
  double area = shape.radius * shape.radius;
  if (shape.form == LightShape::Form::rectangle) area = glm::length(glm::cross(shape.half_u, shape.half_v));
  if (shape.is_flat() && distance > 0) area *= std::abs(glm::dot(shape.front(), way)) / distance;
  return {distance, std::sqrt(area)};
}

}  // namespace

LampSize lamp_size(const Light& light, const glm::dvec3& point) { return lamp_size(LightShape(light), point); }

double width_of_sigma(double sigma) { return 12 * std::pow(sigma / 1.8, 1.5); }

void Widths::make(const FilterGuides& guides, const GBuffer& gbuffer, const Light& light, int rays_per_pixel,
                  GuidedFilter& filter, RayPlanes& rays) {
  sigma_.resize(gbuffer.size());
  const LightShape shape(light);
  const std::array<std::span<float>, 1> numerators{rays.distance};
  const FilterPlanes planes{.denominators = rays.dark, .numerators = numerators};
  const float enough = enough_dark * static_cast<float>(rays_per_pixel);
  const auto take = [&](std::size_t i) {
    const LampSize lamp = lamp_size(shape, gbuffer.position(i));
    const float caster = rays.distance[i] / rays.dark[i];
    const float meters = penumbra_width(static_cast<float>(lamp.half_width), static_cast<float>(lamp.distance), caster);
    const int x = static_cast<int>(i % gbuffer.width), y = static_cast<int>(i / gbuffer.width);
    return sigma_of_width(meters / guides.footprint(x, y));
  };
  for_blocks(sigma_.size(), 4096, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) sigma_[i] = rays.faces[i] ? open : 0;
  });
  for (int level = 0; level < most_filter_levels; ++level) {
    filter.run(guides, atrous_rule, level, level + 1, planes);
    const bool is_last = level + 1 == most_filter_levels;
    for_blocks(sigma_.size(), 1024, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        if (sigma_[i] != open) continue;
        if (rays.dark[i] >= enough || (is_last && rays.dark[i] > 0))
          sigma_[i] = take(i);
        else if (is_last)
          sigma_[i] = 0;
      }
    });
  }
}

}  // namespace gnomon::denoised_rays
