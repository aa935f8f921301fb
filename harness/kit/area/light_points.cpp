#include <gnomon/error.h>
#include <gnomon/kit/area/light_points.h>
#include <gnomon/kit/area/light_shape.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace gnomon {

namespace {

/// Of a square, by latitude and longitude: z is as likely anywhere (Archimedes).
glm::dvec3 on_unit_sphere(double x, double y) {
  const double z = 1 - 2 * y, across = std::sqrt(std::max(0.0, 1 - z * z)), angle = 2 * std::numbers::pi * x;
  return {across * std::cos(angle), across * std::sin(angle), z};
}

}  // namespace

std::vector<std::string_view> pattern_names() { return {"random", "stratified", "low_discrepancy", "interleaved"}; }

PatternPlaces::PatternPlaces(std::string_view pattern, int count, std::uint64_t seed)
    : pattern_(pattern), count_(static_cast<std::uint32_t>(count)), scramble_(seed), random_(seed) {
  columns_ = std::max(1u, static_cast<std::uint32_t>(std::sqrt(static_cast<double>(count))));
}

Squares PatternPlaces::next(std::uint32_t group) {
  if (pattern_ != "random" && pattern_ != "stratified") return scramble_.of_first(group);
  Squares squares;
  for (std::uint32_t k = 0; k < 16; ++k) {
    const double x = random_.uniform(0, 1), y = random_.uniform(0, 1);
    const glm::dvec2 place =
        pattern_ == "stratified" ? in_stratum(std::min(16 * group + k, count_ - 1), x, y) : glm::dvec2(x, y);
    squares.x[k] = static_cast<float>(place.x);
    squares.y[k] = static_cast<float>(place.y);
  }
  return squares;
}

/// Of `count` cells of equal area, in columns of equal or nearly equal numbers of cells: a column is as wide as it has cells.
glm::dvec2 PatternPlaces::in_stratum(std::uint32_t index, double x, double y) const {
  const std::uint32_t column = static_cast<std::uint32_t>(std::uint64_t{index} * columns_ / count_);
  const auto first_of = [&](std::uint32_t c) {
    return static_cast<std::uint32_t>((std::uint64_t{c} * count_ + columns_ - 1) / columns_);
  };
  const double first = first_of(column), next = first_of(column + 1);
  return {(first + x * (next - first)) / count_, (index - first + y) / (next - first)};
}

std::vector<glm::vec3> light_points(const Light& light, std::string_view pattern, int count, std::uint64_t seed) {
  if (!has_area(light))
    throw Error("light {} has no area: there are no points to choose of a {} light", light.name, kind_name(light));
  std::vector<glm::vec3> points;
  points.reserve(static_cast<std::size_t>(count));
  PatternPlaces places(pattern, count, seed);
  // A flat light's figure is that for a point before its front, on its axis; one half side away, so that nothing is rounded
  // off.
  const LightShape shape(light);
  std::optional<LightFigure> figure;
  glm::dvec3 before(0);
  if (shape.is_flat()) {
    const double reach = std::max({shape.radius, glm::length(shape.half_u), glm::length(shape.half_v)});
    before = shape.center + reach * shape.front();
    figure.emplace(light, before, -shape.front());
  }
  for (std::uint32_t group = 0; points.size() < static_cast<std::size_t>(count); ++group) {
    const Squares squares = places.next(group), on_light = figure ? places_on(*figure, squares) : squares;
    for (std::size_t k = 0; k < 16 && points.size() < static_cast<std::size_t>(count); ++k) {
      const glm::dvec2 place(on_light.x[k], on_light.y[k]);
      points.emplace_back(figure ? before + figure->at(2.0 * place - 1.0)
                                 : shape.center + shape.radius * on_unit_sphere(place.x, place.y));
    }
  }
  return points;
}

bool has_far_side(const Light& light) {
  if (!has_area(light)) return false;
  const LightShape shape(light);
  return !shape.is_flat() && shape.radius > 0x1p-18 * extent(shape.center);
}

PointWeights::PointWeights(const Light& light, const glm::dvec3& position, const glm::dvec3& normal)
    : position_(position), normal_(normal) {
  const LightFigure figure(light, position, normal);
  is_seen_ = figure.is_seen();
  if (is_seen_ && has_far_side(light)) {
    const LightShape sphere(light);
    const double distance = glm::length(figure.center());
    center_ = sphere.center;
    axis_ = figure.center() / distance;
    per_distance_ = 1 / distance;
    per_radius_ = 1.0 / sphere.radius;
  }
}

}  // namespace gnomon
