#include "widths.h"

#include <gnomon/kit/area/light_shape.h>
#include <gnomon/kit/parallel.h>

#include <algorithm>
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

void Widths::find_edges(const GBuffer& gbuffer, const RayPlanes& rays) {
  // The taps of five levels reach 2 (1 + 2 + 4 + 8 + 16) = 62 pixels, within four tiles.
  constexpr int side = 16, reach = 4;
  constexpr std::uint8_t lit = 1, dark = 2;
  const int width = gbuffer.width, height = gbuffer.height, columns = (width + side - 1) / side,
            rows = (height + side - 1) / side;
  const auto at = [&](int column, int row) { return static_cast<std::size_t>(row) * columns + column; };
  found_.resize(static_cast<std::size_t>(columns) * rows);
  found_beside_.resize(found_.size());
  strength_.resize(gbuffer.size());
  for_blocks(static_cast<std::size_t>(rows), 1, [&](std::size_t begin, std::size_t end) {
    for (int row = static_cast<int>(begin); row < static_cast<int>(end); ++row) {
      std::fill_n(&found_[at(0, row)], columns, std::uint8_t{0});
      for (int y = row * side; y < std::min((row + 1) * side, height); ++y)
        for (int x = 0; x < width; ++x) {
          const std::size_t i = static_cast<std::size_t>(y) * width + x;
          found_[at(x / side, row)] |= (rays.seen[i] > 0 ? lit : 0) | (rays.seen[i] < rays.asked[i] ? dark : 0);
        }
      for (int column = 0; column < columns; ++column) {
        std::uint8_t all = 0;
        for (int k = std::max(column - reach, 0); k <= std::min(column + reach, columns - 1); ++k) all |= found_[at(k, row)];
        found_beside_[at(column, row)] = all;
      }
    }
  });
  for_blocks(static_cast<std::size_t>(rows), 1, [&](std::size_t begin, std::size_t end) {
    for (int row = static_cast<int>(begin); row < static_cast<int>(end); ++row)
      for (int column = 0; column < columns; ++column) {
        std::uint8_t all = 0;
        for (int k = std::max(row - reach, 0); k <= std::min(row + reach, rows - 1); ++k) all |= found_beside_[at(column, k)];
        const int first = column * side, count = std::min(side, width - first);
        for (int y = row * side; y < std::min((row + 1) * side, height); ++y)
          std::fill_n(&strength_[static_cast<std::size_t>(y) * width + first], count, all == (lit | dark) ? 1.0f : 0.0f);
      }
  });
}

void Widths::Half::make(const FilterGuides& fine, const RayPlanes& rays, std::span<const float> fine_strength) {
  guides.halve(fine);
  const std::size_t size = static_cast<std::size_t>(guides.width()) * guides.height();
  for (UnsetVector<float>* plane : {&dark, &distance, &strength}) plane->resize(size);
  for_blocks(static_cast<std::size_t>(guides.height()), 8, [&](std::size_t begin, std::size_t end) {
    for (int y = static_cast<int>(begin); y < static_cast<int>(end); ++y)
      for (int x = 0; x < guides.width(); ++x) {
        const std::size_t to = static_cast<std::size_t>(y) * guides.width() + x;
        float count = 0, sum_dark = 0, sum_distance = 0, most = 0;
        for (int k = 0; k < 4; ++k) {
          const int fine_x = 2 * x + k % 2, fine_y = 2 * y + k / 2;
          if (fine_x >= fine.width() || fine_y >= fine.height() || !fine.joins(fine_x, fine_y, guides, {x, y})) continue;
          const std::size_t from = static_cast<std::size_t>(fine_y) * fine.width() + fine_x;
          count += 1;
          sum_dark += rays.dark[from];
          sum_distance += rays.distance[from];
          most = std::max(most, fine_strength[from]);
        }
        dark[to] = count > 0 ? sum_dark / count : 0;
        distance[to] = count > 0 ? sum_distance / count : 0;
        strength[to] = most;
      }
  });
}

std::optional<std::size_t> Widths::Half::place_of(const FilterGuides& fine, int x, int y) const {
  const auto found = [&](int column, int row) { return fine.joins(x, y, guides, {column, row}); };
  const int own_column = x / 2, own_row = y / 2;
  const auto place = [&](int column, int row) { return static_cast<std::size_t>(row) * guides.width() + column; };
  if (found(own_column, own_row)) return place(own_column, own_row);
  for (int row = std::max(own_row - 1, 0); row <= std::min(own_row + 1, guides.height() - 1); ++row)
    for (int column = std::max(own_column - 1, 0); column <= std::min(own_column + 1, guides.width() - 1); ++column)
      if (found(column, row)) return place(column, row);
  return std::nullopt;
}

void Widths::make(const FilterGuides& guides, const GBuffer& gbuffer, const Light& light, int rays_per_pixel,
                  GuidedFilter& filter, RayPlanes& rays) {
  sigma_.resize(gbuffer.size());
  find_edges(gbuffer, rays);
  const LightShape shape(light);
  const float enough = enough_dark * static_cast<float>(rays_per_pixel);
  const auto take = [&](std::size_t i, float distance, float dark) {
    const LampSize lamp = lamp_size(shape, gbuffer.position(i));
    const float meters =
        penumbra_width(static_cast<float>(lamp.half_width), static_cast<float>(lamp.distance), distance / dark);
    const int x = static_cast<int>(i % gbuffer.width), y = static_cast<int>(i / gbuffer.width);
    sigma_[i] = sigma_of_width(meters / guides.footprint(x, y));
  };
  const auto for_pixels = [&](const auto& work) {
    for_blocks(sigma_.size(), 1024, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) work(i);
    });
  };
  const std::array<std::span<float>, 1> numerators{rays.distance};
  filter.run(guides, atrous_rule, 0, 1, {.denominators = rays.dark, .numerators = numerators}, strength_);
  for_pixels([&](std::size_t i) {
    sigma_[i] = rays.faces[i] && strength_[i] > 0 ? open : 0;
    if (sigma_[i] == open && rays.dark[i] >= enough) take(i, rays.distance[i], rays.dark[i]);
  });

  half_.make(guides, rays, strength_);
  const std::array<std::span<float>, 1> half_numerators{half_.distance};
  for (int level = 1; level < most_filter_levels; ++level) {
    half_.filter.run(half_.guides, atrous_rule, level - 1, level, {.denominators = half_.dark, .numerators = half_numerators},
                     half_.strength);
    const bool is_last = level + 1 == most_filter_levels;
    for_pixels([&](std::size_t i) {
      if (sigma_[i] != open) return;
      const int x = static_cast<int>(i % gbuffer.width), y = static_cast<int>(i / gbuffer.width);
      const std::optional<std::size_t> at = half_.place_of(guides, x, y);
      const float dark = at ? half_.dark[*at] : 0;
      if (dark >= enough || (is_last && dark > 0))
        take(i, half_.distance[*at], dark);
      else if (is_last)
        sigma_[i] = 0;
    });
  }
}

}  // namespace gnomon::denoised_rays
