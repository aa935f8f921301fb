#include "division.h"

#include <algorithm>
#include <cmath>

namespace gnomon::radiosity {

namespace {

/// Of `count` cells of the unit interval that with x, and how far x lies into it.
std::pair<std::uint32_t, double> cell(double x, std::uint32_t count) {
  const double scaled = std::clamp(x, 0.0, 1.0) * count;
  const double index = std::min(std::floor(scaled), count - 1.0);
  return {static_cast<std::uint32_t>(index), scaled - index};
}

}  // namespace

glm::uvec2 Division::grid_of(const Face& face, double size) {
  const auto parts = [&](double length) {
    return static_cast<std::uint32_t>(std::clamp(std::ceil(length / size - 1e-6), 1.0, 65535.0));
  };
  if (face.is_triangle)
    return glm::uvec2(parts(std::max({glm::length(face.u), glm::length(face.v), glm::length(face.u - face.v)})));
  return {parts(glm::length(face.u)), parts(glm::length(face.v))};
}

double Division::patch_count(const Faces& faces, double size) {
  double sum = 0;
  for (const Face& face : faces.all()) {
    const glm::uvec2 grid = grid_of(face, size);
    sum += double(grid.x) * grid.y;
  }
  return sum;
}

Division::Division(const Faces& faces, double size) : faces_(&faces) {
  for (std::uint32_t f = 0; f < faces.size(); ++f) {
    const glm::uvec2 grid = grid_of(faces[f], size);
    const glm::dvec2 step = 1.0 / glm::dvec2(grid);
    grids_.push_back({static_cast<std::uint32_t>(elements_.size()), grid.x, grid.y});
    const auto add = [&](const glm::dvec2& low, const glm::dvec2& of_step) {
      elements_.push_back({.face = f, .patch = static_cast<std::uint32_t>(elements_.size()), .low = low, .step = of_step});
    };
    for (std::uint32_t j = 0; j < grid.y; ++j) {
      if (!faces[f].is_triangle) {
        for (std::uint32_t i = 0; i < grid.x; ++i) add(glm::dvec2(i, j) * step, step);
        continue;
      }
      // A row of a triangle: upright and turned ones by turns.
      for (std::uint32_t i = 0; i + j < grid.x; ++i) {
        add(glm::dvec2(i, j) * step, step);
        if (i + j + 1 < grid.x) add(glm::dvec2(i + 1, j + 1) * step, -step);
      }
    }
  }
  patch_count_ = elements_.size();
  for (Element& element : elements_) add_nodes(element);
}

std::array<glm::dvec3, 4> Division::outline(const Element& element) const {
  const Face& face = face_of(element);
  const auto at = [&](double s, double t) { return face.at(element.low + element.step * glm::dvec2(s, t)); };
  if (face.is_triangle) return {at(0, 0), at(1, 0), at(0, 1), at(0, 1)};
  return {at(0, 0), at(1, 0), at(1, 1), at(0, 1)};
}

void Division::add_nodes(Element& element) {
  const bool is_triangle = face_of(element).is_triangle;
  const glm::dvec2 center = element.low + element.step * (is_triangle ? 1.0 / 3 : 0.5);
  element.center = static_cast<std::uint32_t>(nodes_.size());
  nodes_.push_back({face_of(element).at(center), element.face, center});
  for (int k = 0; k < (is_triangle ? 3 : 4); ++k)
    element.corners[k] = corner_node(element, element.low + element.step * glm::dvec2(k & 1, k >> 1), center);
}

std::uint32_t Division::corner_node(const Element& element, const glm::dvec2& place, const glm::dvec2& center) {
  // Corners are multiples of the finest step, so that neighbors of other levels share them.
  const Grid& grid = grids_[element.face];
  const auto key_part = [](double x, std::uint32_t count) {
    return static_cast<std::uint32_t>(std::llround(x * count * (1u << most_levels)));
  };
  const CornerKey key{element.face, key_part(place.x, grid.columns), key_part(place.y, grid.rows)};
  const auto found = corner_at_.find(key);
  if (found != corner_at_.end()) return found->second;
  // On the border, where another surface may begin, half of what it sees is undecided: a little inside it is not.
  const Face& face = face_of(element);
  constexpr double border = 1e-9, inside = 1.0 / 64;
  const bool is_on_border = place.x < border || place.y < border ||
                            (face.is_triangle ? place.x + place.y > 1 - border : std::max(place.x, place.y) > 1 - border);
  const glm::dvec2 moved = is_on_border ? glm::mix(place, center, inside) : place;
  const auto index = static_cast<std::uint32_t>(nodes_.size());
  nodes_.push_back({face.at(moved), element.face, moved});
  corner_at_.emplace(key, index);
  return index;
}

void Division::divide(std::uint32_t index) {
  const auto first = static_cast<std::uint32_t>(elements_.size());
  const Element parent = elements_[index];
  const glm::dvec2 half = parent.step / 2.0;
  for (int k = 0; k < 4; ++k) {
    Element child{.face = parent.face,
                  .patch = parent.patch,
                  .low = parent.low + half * glm::dvec2(k & 1, k >> 1),
                  .step = half,
                  .level = parent.level + 1};
    // The fourth of a triangle lies in the middle, turned around.
    if (k == 3 && face_of(parent).is_triangle) child.step = -half;
    add_nodes(child);
    elements_.push_back(child);
  }
  elements_[index].first_child = first;
}

std::uint32_t Division::element_at(std::uint32_t face, glm::dvec2 place) const {
  const Grid& grid = grids_[face];
  const bool is_triangle = (*faces_)[face].is_triangle;
  if (is_triangle) {
    place = glm::max(place, 0.0);
    if (const double sum = place.x + place.y; sum > 1) place /= sum;
  }
  auto [i, in_column] = cell(place.x, grid.columns);
  const auto [j, in_row] = cell(place.y, grid.rows);
  glm::dvec2 in(in_column, in_row);
  std::uint32_t at = grid.first;
  if (is_triangle) {
    const std::uint32_t n = grid.columns;
    if (i + j >= n) i = n - 1 - j;  // on the long side, by rounding
    const bool is_turned = in.x + in.y > 1 && i + j + 1 < n;
    at += j * (2 * n - j) + 2 * i + is_turned;
    if (is_turned) in = 1.0 - in;
  } else {
    at += j * grid.columns + i;
  }
  while (elements_[at].is_divided()) {
    in *= 2;
    const bool right = in.x >= 1, up = in.y >= 1 && !(is_triangle && right);
    if (is_triangle && !right && !up && in.x + in.y > 1) {
      in = 1.0 - in;
      at = elements_[at].first_child + 3;
    } else {
      in -= glm::dvec2(right, up);
      at = elements_[at].first_child + right + 2 * up;
    }
  }
  return at;
}

std::array<double, 4> Division::weights(const Element& element, const glm::dvec2& place) const {
  const glm::dvec2 in = glm::clamp((place - element.low) / element.step, 0.0, 1.0);
  if (!face_of(element).is_triangle) return {(1 - in.x) * (1 - in.y), in.x * (1 - in.y), (1 - in.x) * in.y, in.x * in.y};
  const double rest = std::max(1 - in.x - in.y, 0.0), sum = rest + in.x + in.y;
  return {rest / sum, in.x / sum, in.y / sum, 0};
}

}  // namespace gnomon::radiosity
