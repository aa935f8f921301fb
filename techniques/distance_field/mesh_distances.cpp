#include "mesh_distances.h"

#include <algorithm>
#include <cmath>

namespace gnomon::distance_field {

namespace {

/// Where the side from `below` to `above` the plane meets it.
glm::dvec2 crossing(const glm::vec3& below, const glm::vec3& above, double z) {
  const glm::dvec3 low(below), way = glm::dvec3(above) - low;
  return glm::dvec2(low) + (z - low.z) / way.z * glm::dvec2(way);
}

}  // namespace

MeasuredTriangle::MeasuredTriangle(const Triangle& triangle) : corners_(triangle) {
  const glm::dvec3 a(triangle.points[0]), b(triangle.points[1]), c(triangle.points[2]);
  const glm::dvec3 across = glm::cross(b - a, c - a);
  const glm::dvec3 squares(glm::dot(b - a, b - a), glm::dot(c - b, c - b), glm::dot(a - c, a - c));
  for (int k = 0; k < 3; ++k) inverses_[k] = squares[k] > 0 ? 1 / squares[k] : 0;
  // Of a lower one the normal would not be right to 1e-8.
  const double area = glm::length(across);
  if (area > 1e-8 * std::max({squares.x, squares.y, squares.z})) normal_ = across / area;
}

double MeasuredTriangle::square_below(double least, const glm::dvec3& p) const {
  const glm::vec3* const points = corners_.points;
  const glm::dvec3 off[] = {p - glm::dvec3(points[0]), p - glm::dvec3(points[1]), p - glm::dvec3(points[2])};
  const double height = glm::dot(normal_, off[0]);
  if (height * height >= least) return INFINITY;
  const bool is_flat = normal_ == glm::dvec3(0);
  // The nearest point is the foot of the perpendicular, or on a side that has the foot beyond it.
  double best = INFINITY;
  bool is_above = true;
  for (int k = 0; k < 3; ++k) {
    const glm::dvec3 side = off[k] - off[(k + 1) % 3];
    if (!is_flat && glm::dot(glm::cross(side, off[k]), normal_) >= 0) continue;
    is_above = false;
    const double share = std::clamp(glm::dot(off[k], side) * inverses_[k], 0.0, 1.0);
    const glm::dvec3 to = off[k] - share * side;
    best = std::min(best, glm::dot(to, to));
  }
  return is_above ? height * height : best;
}

std::optional<Cut> cut_at(const Triangle& triangle, double z) {
  const glm::vec3* const p = triangle.points;
  const bool above[] = {p[0].z > z, p[1].z > z, p[2].z > z};
  if (above[0] == above[1] && above[1] == above[2]) return std::nullopt;
  Cut cut{};
  for (int k = 0; k < 3; ++k) {
    const int next = (k + 1) % 3;
    if (!above[k] && above[next]) cut.from = crossing(p[k], p[next], z);
    if (above[k] && !above[next]) cut.to = crossing(p[next], p[k], z);
  }
  return cut;
}

std::optional<Passage> passage_at(const Cut& cut, double y) {
  const bool starts_above = cut.from.y > y, ends_above = cut.to.y > y;
  if (starts_above == ends_above) return std::nullopt;
  const double share = (y - cut.from.y) / (cut.to.y - cut.from.y);
  return Passage{cut.from.x + share * (cut.to.x - cut.from.x), ends_above ? 1 : -1};
}

MeshDistances::MeshDistances(const Mesh& mesh) {
  std::vector<Bounds> boxes(mesh.triangles.size());
  for (std::size_t t = 0; t < boxes.size(); ++t) boxes[t].add(mesh.corners(t).points);
  tree_ = BoxTree(boxes);
  triangles_.reserve(boxes.size());
  for (const std::uint32_t item : tree_.order()) triangles_.emplace_back(mesh.corners(item));
}

double MeshDistances::to_nearest(const glm::dvec3& p, std::uint32_t& near) const {
  double best = triangles_[near].square_below(INFINITY, p);
  tree_.each([&](const float* lower, const float* upper) { return square_to_box(p, lower, upper) < best; },
             [&](std::uint32_t place) {
               if (const double square = triangles_[place].square_below(best, p); square < best) {
                 best = square;
                 near = place;
               }
               return false;
             });
  return std::sqrt(best);
}

// For a point q within `radius` of p and the triangle nearest to it: |p - triangle| <= |q - triangle| + radius
// <= |p - nearest to p| + 2 radius.
bool MeshDistances::find_near(const glm::dvec3& p, double radius, std::size_t most, std::vector<std::uint32_t>& places,
                              std::uint32_t& near) const {
  const double reach = (to_nearest(p, near) + 2 * radius) * (1 + 1e-9), square = reach * reach;
  places.clear();
  tree_.each([&](const float* lower, const float* upper) { return square_to_box(p, lower, upper) < square; },
             [&](std::uint32_t place) {
               if (triangles_[place].square_below(square, p) < square) places.push_back(place);
               return places.size() > most;
             });
  return places.size() <= most;
}

double MeshDistances::to_nearest_of(std::span<const std::uint32_t> places, const glm::dvec3& p) const {
  double best = INFINITY;
  for (const std::uint32_t place : places) best = std::min(best, triangles_[place].square_below(best, p));
  return std::sqrt(best);
}

int MeshDistances::winding(const glm::dvec3& p) const {
  int sum = 0;
  const auto may_pass = [&](const float* lower, const float* upper) {
    return lower[0] <= p.x && lower[1] <= p.y && p.y <= upper[1] && lower[2] <= p.z && p.z <= upper[2];
  };
  tree_.each(may_pass, [&](std::uint32_t place) {
    const std::optional<Cut> cut = cut_at(triangles_[place].corners(), p.z);
    const std::optional<Passage> passage = cut ? passage_at(*cut, p.y) : std::nullopt;
    if (passage && passage->x < p.x) sum += passage->winding;
    return false;
  });
  return sum;
}

}  // namespace gnomon::distance_field
