#pragma once
#include <gnomon/kit/geometry/edges.h>
#include <gnomon/kit/gl/gl.h>

#include <cmath>

namespace stencil_volume {
using namespace gnomon;

/// How many shadow volumes hold the eye. Where its way to the light goes exactly through an edge, triangles beside the edge
/// cannot be distinguished, and a point a rounding away is tested instead.
inline std::int64_t volumes_at(const EdgeAdjacency& adjacency, const glm::vec3& eye, const Silhouette& silhouette) {
  constexpr glm::vec3 asides[] = {{0, 0, 0},   {3, 5, 7},  {-5, 3, -2}, {2, -7, 3},
                                  {-3, -2, 5}, {7, 2, -3}, {-2, 7, 2},  {5, -3, -7}};
  double largest = extent(eye);
  for (const EdgeAdjacency::Part& part : adjacency.parts()) largest = std::max(largest, part.bounds.extent());
  const auto rounding = static_cast<float>(largest * 0x1p-24);
  EdgeAdjacency::Depth depth;
  for (const glm::vec3& aside : asides) {
    depth = adjacency.depth_at(eye + aside * rounding, silhouette);
    if (!depth.degenerate) break;
  }
  return depth.volumes;
}

/// Whether the light lies between two distances along a view's axis, as far as float32 tells. From a light in the near plane
/// the near rectangle is a line, and nothing can be thrown onto it.
inline bool is_between(const glm::dvec4& light, const View& view, double nearest, double farthest) {
  const glm::dvec3 eye(view.eye), forward = glm::normalize(glm::dvec3(view.target) - eye);
  const glm::dvec4 across(forward, -glm::dot(forward, eye));
  const double size = glm::length(glm::dvec3(light)) + std::abs(light.w * (across.w - farthest)), slack = 0x1p-16 * size;
  const double along = glm::dot(across, light);
  return along - light.w * nearest > -slack && along - light.w * farthest < slack;
}

/// Where the eye lies among the shadow volumes.
struct EyePlace {
  bool inside = false;          ///< of some volume
  bool near_rectangle = false;  ///< a face of a volume is within reach of the near rectangle, wherever it may be
  bool light_beside = false;    ///< the light may lie in the plane of the near rectangle
  bool boundary = false;        ///< within rounding of a face: for one rounding inside, for another outside
};

/// Among the volumes of two sets of casters.
inline EyePlace both(const EyePlace& a, const EyePlace& b) {
  return {.inside = a.inside || b.inside,
          .near_rectangle = a.near_rectangle || b.near_rectangle,
          .light_beside = a.light_beside || b.light_beside,
          .boundary = a.boundary || b.boundary};
}

/// In double. Rounding is taken as 2^-16 of the scene's extent, 256 float32 roundings of its largest coordinate: a side quad
/// seen so nearly edge-on was seen to be off by 2^-18 of it.
class EyePlaceFinder {
 public:
  EyePlaceFinder(const Scene& scene, const Light& light, const View& view)
      : adjacency_(scene, Joins::in_every_pose),
        light_(homogeneous(light)),
        eye_(view.eye),
        tan_y_(std::tan(glm::radians(double(view.fov_y_degrees)) / 2)),
        rounding_(0x1p-16 * extent(scene, light, view)),
        farthest_near_plane_(GBufferTextures::near_share * farthest(scene, view)) {
    place_.light_beside = is_between(light_, view, 0, farthest_near_plane_);
    adjacency_.find_silhouette(light_, silhouette_);
    place_.inside = volumes_at(adjacency_, view.eye, silhouette_) > 0;
    for (const SilhouetteEdge& edge : silhouette_.edges) meet_side(at(edge.low), at(edge.high));
    for (std::size_t t = 0; t < silhouette_.facing.size(); ++t)
      if (silhouette_.facing[t] != 0) meet_cap(adjacency_.triangles()[t]);
  }
  const EyePlace& place() const { return place_; }

 private:
  glm::dvec3 at(std::uint32_t vertex) const { return adjacency_.positions()[vertex]; }
  /// Along the view's axis: no point that it shows is farther.
  static double farthest(const Scene& scene, const View& view) {
    const Bounds box = scene.bounds();
    if (box.empty()) return 0;
    const glm::dvec3 eye = view.eye, forward = glm::normalize(glm::dvec3(view.target) - eye);
    const glm::dvec3 middle = (glm::dvec3(box.min) + glm::dvec3(box.max)) / 2.0, half = glm::dvec3(box.max) - middle;
    return std::max(glm::dot(forward, middle - eye) + glm::dot(glm::abs(forward), half), 0.0);
  }
  /// From the eye to a corner of the near rectangle of a picture up to four times as wide as high.
  double reach() const { return farthest_near_plane_ * std::sqrt(1 + 17 * tan_y_ * tan_y_) + rounding_; }

  void meet(double distance) {
    place_.near_rectangle |= distance <= reach();
    place_.boundary |= distance <= rounding_;
  }

  /// The distance to a convex face is at least that to its plane, and to each half-plane that it lies in.
  void meet_side(const glm::dvec3& a, const glm::dvec3& b) {
    const glm::dvec3 away_a = -to_light(light_, a), away_b = -to_light(light_, b), normal = glm::cross(b - a, away_a);
    const double size = glm::length(normal);
    if (size == 0) return;  // the edge points to the light: no face
    const glm::dvec3 n = normal / size;
    double distance = std::abs(glm::dot(n, eye_ - a));
    if (distance > reach()) return;
    // Outward in the plane of the face: beyond the edge toward the light, beyond the ray from a, beyond the ray from b.
    const glm::dvec3 toward = glm::cross(n, b - a), inward = glm::dot(toward, away_a) > 0 ? toward : -toward;
    distance = std::max(distance, -glm::dot(glm::normalize(inward), eye_ - a));
    for (const auto& [p, other, away] : {std::tuple(a, b, away_a), std::tuple(b, a, away_b)}) {
      const glm::dvec3 across = glm::cross(n, away), outward = glm::dot(across, other - p) > 0 ? -across : across;
      if (glm::length(outward) > 0) distance = std::max(distance, glm::dot(glm::normalize(outward), eye_ - p));
    }
    meet(distance);
  }

  void meet_cap(const glm::uvec3& triangle) {
    const glm::dvec3 p[3] = {at(triangle.x), at(triangle.y), at(triangle.z)};
    const glm::dvec3 normal = glm::cross(p[1] - p[0], p[2] - p[0]), n = normal / glm::length(normal);
    double distance = std::abs(glm::dot(n, eye_ - p[0]));
    for (int k = 0; k < 3 && distance <= reach(); ++k)
      distance = std::max(distance, glm::dot(glm::normalize(glm::cross(p[(k + 1) % 3] - p[k], n)), eye_ - p[k]));
    meet(distance);
  }

  EdgeAdjacency adjacency_;
  Silhouette silhouette_;
  glm::dvec4 light_;
  glm::dvec3 eye_;
  double tan_y_, rounding_, farthest_near_plane_;
  EyePlace place_;
};

}  // namespace stencil_volume
