#include "faces.h"

#include <algorithm>
#include <map>
#include <utility>

namespace gnomon::radiosity {

namespace {

using Edge = std::pair<std::uint32_t, std::uint32_t>;
Edge edge_of(std::uint32_t a, std::uint32_t b) { return {std::min(a, b), std::max(a, b)}; }

/// Whether q is the fourth corner of the parallelogram that has p opposite to it, and a and b between.
bool closes(const glm::dvec3& p, const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& q) {
  const double size = std::max({extent(p), extent(a), extent(b), extent(q)});
  return extent(a + b - p - q) <= 4 * 0x1p-24 * size;
}

}  // namespace

glm::dvec2 Face::place_of(const glm::dvec3& point) const {
  const glm::dvec3 across = glm::cross(u, v), to = point - corner;
  const double square = glm::dot(across, across);
  return {glm::dot(glm::cross(to, v), across) / square, glm::dot(glm::cross(u, to), across) / square};
}

Faces::Faces(const Scene& scene) {
  for (std::uint32_t m = 0; m < scene.meshes.size(); ++m) add_mesh(scene.meshes[m], m);
}

void Faces::add_mesh(const Mesh& mesh, std::uint32_t index) {
  const std::vector<std::uint32_t> same = weld(mesh.positions);
  // The first triangle at each edge that has no partner yet, and its corner opposite to that edge.
  struct Open {
    std::uint32_t triangle, corner;
  };
  std::multimap<Edge, Open> open;
  constexpr std::uint32_t alone = 0xffffffffu;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> partner(mesh.triangles.size(), {alone, 0});
  const auto corner_of = [&](std::uint32_t t, std::uint32_t k) {
    return glm::dvec3(mesh.positions[mesh.triangles[t][static_cast<int>(k % 3)]]);
  };
  // Nothing lies on a triangle without area, and it sends nothing.
  const auto has_area = [&](std::uint32_t t) {
    const auto [a, b, c] = mesh.corners(t).points;
    return !is_degenerate(a, b, c);
  };
  // partner[t]: the other triangle, and the corner of t opposite to the edge that they share.
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    if (!has_area(t)) continue;
    const auto vertex = [&](std::uint32_t k) { return same[mesh.triangles[t][static_cast<int>(k % 3)]]; };
    for (std::uint32_t k = 0; k < 3 && partner[t].first == alone; ++k) {
      const auto [begin, end] = open.equal_range(edge_of(vertex(k + 1), vertex(k + 2)));
      for (auto it = begin; it != end; ++it) {
        const auto [other, corner] = it->second;
        if (partner[other].first != alone) continue;
        // Wound alike, two triangles run along their common edge in opposite ways.
        if (mesh.positions[mesh.triangles[other][static_cast<int>((corner + 1) % 3)]] !=
            mesh.positions[mesh.triangles[t][static_cast<int>((k + 2) % 3)]])
          continue;
        if (!closes(corner_of(t, k), corner_of(t, k + 1), corner_of(t, k + 2), corner_of(other, corner))) continue;
        partner[t] = {other, k};
        partner[other] = {t, corner};
        break;
      }
    }
    if (partner[t].first == alone)
      for (std::uint32_t k = 0; k < 3; ++k) open.insert({edge_of(vertex(k + 1), vertex(k + 2)), {t, k}});
  }
  first_.push_back(static_cast<std::uint32_t>(face_of_.size()));
  face_of_.resize(face_of_.size() + mesh.triangles.size());
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto [other, opposite] = partner[t];
    if (other < t || !has_area(t)) continue;  // the face is there already, or there is none
    const glm::dvec3 corner = corner_of(t, opposite);
    Face face{.corner = corner, .u = corner_of(t, opposite + 1) - corner, .v = corner_of(t, opposite + 2) - corner};
    face.normal = glm::normalize(glm::cross(face.u, face.v));
    face.is_triangle = other == alone;
    face.mesh = index;
    face.triangles = {t, face.is_triangle ? t : other};
    for (const std::uint32_t member : face.triangles)
      face_of_[first_[index] + member] = static_cast<std::uint32_t>(faces_.size());
    faces_.push_back(face);
  }
}

}  // namespace gnomon::radiosity
