#include "mesh_distances.h"

#include <algorithm>
#include <cmath>

namespace gnomon::distance_field {

namespace {

double square_to_segment(const glm::dvec3& p, const glm::dvec3& a, const glm::dvec3& b) {
  const glm::dvec3 way = b - a, to = p - a;
  const double length = glm::dot(way, way);
  const double share = length > 0 ? std::clamp(glm::dot(to, way) / length, 0.0, 1.0) : 0;
  const glm::dvec3 off = to - share * way;
  return glm::dot(off, off);
}

/// Where the side from `below` to `above` the plane meets it.
glm::dvec2 crossing(const glm::vec3& below, const glm::vec3& above, double z) {
  const glm::dvec3 low(below), way = glm::dvec3(above) - low;
  return glm::dvec2(low) + (z - low.z) / way.z * glm::dvec2(way);
}

}  // namespace

double square_to_triangle(const glm::dvec3& p, const Triangle& triangle) {
  const glm::dvec3 a(triangle.points[0]), b(triangle.points[1]), c(triangle.points[2]);
  const glm::dvec3 n = glm::cross(b - a, c - a);
  const double square = glm::dot(n, n);
  if (square > 0 && glm::dot(glm::cross(b - a, p - a), n) >= 0 && glm::dot(glm::cross(c - b, p - b), n) >= 0 &&
      glm::dot(glm::cross(a - c, p - c), n) >= 0) {
    const double height = glm::dot(n, p - a);
    return height * height / square;
  }
  return std::min({square_to_segment(p, a, b), square_to_segment(p, b, c), square_to_segment(p, c, a)});
}

double square_to_box(const glm::dvec3& p, const float* lower, const float* upper) {
  double sum = 0;
  for (int k = 0; k < 3; ++k) {
    const double off = std::max({lower[k] - p[k], 0.0, p[k] - upper[k]});
    sum += off * off;
  }
  return sum;
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
  for (const std::uint32_t item : tree_.order()) triangles_.push_back(mesh.corners(item));
}

double MeshDistances::to_nearest(const glm::dvec3& p, std::uint32_t& near) const {
  double best = square_to_triangle(p, triangles_[near]);
  tree_.each([&](const float* lower, const float* upper) { return square_to_box(p, lower, upper) < best; },
             [&](std::uint32_t place) {
               if (const double square = square_to_triangle(p, triangles_[place]); square < best) {
                 best = square;
                 near = place;
               }
               return false;
             });
  return std::sqrt(best);
}

int MeshDistances::winding(const glm::dvec3& p) const {
  int sum = 0;
  const auto may_pass = [&](const float* lower, const float* upper) {
    return lower[0] <= p.x && lower[1] <= p.y && p.y <= upper[1] && lower[2] <= p.z && p.z <= upper[2];
  };
  tree_.each(may_pass, [&](std::uint32_t place) {
    const std::optional<Cut> cut = cut_at(triangles_[place], p.z);
    const std::optional<Passage> passage = cut ? passage_at(*cut, p.y) : std::nullopt;
    if (passage && passage->x < p.x) sum += passage->winding;
    return false;
  });
  return sum;
}

}  // namespace gnomon::distance_field
