#pragma once
// What a surface detail must be: a division of every triangle that faces the light, and one that says the truth. The first can
// be seen from the polygons alone, the second can not.
#include <gnomon/technique.h>

#include <map>
#include <numeric>
#include <set>

#include "questions.h"

namespace gnomon {

/// The plane of a triangle: coordinates in it, in which the triangle is wound counter-clockwise.
struct Flat {
  glm::dvec3 origin, u, v, n;
  explicit Flat(const Triangle& triangle) : origin(triangle.points[0]) {
    const glm::dvec3 edge = glm::dvec3(triangle.points[1]) - origin, other = glm::dvec3(triangle.points[2]) - origin;
    u = glm::normalize(edge), n = glm::normalize(glm::cross(edge, other)), v = glm::cross(n, u);
  }
  glm::dvec2 at(const glm::dvec3& p) const { return {glm::dot(p - origin, u), glm::dot(p - origin, v)}; }
};

using Outline = std::vector<glm::dvec2>;  ///< counter-clockwise

inline double cross(const glm::dvec2& a, const glm::dvec2& b) { return a.x * b.y - a.y * b.x; }

/// How far `p` is to the left of all edges, at least; edges shorter than `tolerance` have no direction, and an outline of such
/// edges alone no depth: 0.
inline double depth_in(const Outline& outline, const glm::dvec2& p, double tolerance) {
  double depth = INFINITY;
  for (std::size_t i = 0; i < outline.size(); ++i) {
    const glm::dvec2 edge = outline[(i + 1) % outline.size()] - outline[i];
    if (glm::length(edge) > tolerance) depth = std::min(depth, cross(edge, p - outline[i]) / glm::length(edge));
  }
  return depth < INFINITY ? depth : 0;
}

inline double area(const Outline& outline) {
  double twice = 0;
  for (std::size_t i = 2; i < outline.size(); ++i) twice += cross(outline[i - 1] - outline[0], outline[i] - outline[0]);
  return twice / 2;
}

inline glm::dvec2 middle(const Outline& outline) {
  return std::accumulate(outline.begin(), outline.end(), glm::dvec2(0)) / static_cast<double>(outline.size());
}

inline double length_around(const Outline& outline) {
  double length = 0;
  for (std::size_t i = 0; i < outline.size(); ++i) length += glm::distance(outline[i], outline[(i + 1) % outline.size()]);
  return length;
}

/// Whether an edge of `a` has all of `b` on its outer side.
inline bool separates(const Outline& a, const Outline& b, double tolerance) {
  for (std::size_t i = 0; i < a.size(); ++i) {
    const glm::dvec2 edge = a[(i + 1) % a.size()] - a[i];
    const double reach = tolerance * glm::length(edge);
    if (glm::length(edge) > tolerance &&
        std::ranges::all_of(b, [&](const glm::dvec2& p) { return cross(edge, p - a[i]) <= reach; }))
      return true;
  }
  return false;
}

/// The polygons of a surface detail by triangle, flat.
class Division {
 public:
  struct Part {
    Outline outline;
    bool is_lit;
  };

  /// Adds a fault for every polygon that is none, or none of its triangle's.
  Division(const Scene& scene, const SurfaceDetail& detail, double tolerance, std::set<std::string>& faults)
      : tolerance_(tolerance) {
    std::pair<std::uint32_t, std::uint32_t> last{0, 0};
    for (const DetailPolygon& polygon : detail.polygons) {
      const std::pair key{polygon.mesh, polygon.triangle};
      if (key < last) faults.insert("polygons are not in the order of their triangles");
      last = key;
      if (polygon.mesh >= scene.meshes.size() || polygon.triangle >= scene.meshes[polygon.mesh].triangles.size() ||
          polygon.count < 3 || polygon.first + polygon.count > detail.corners.size()) {
        faults.insert("a polygon has no triangle or no corners");
        continue;
      }
      const Triangle triangle = questions::corners(scene.meshes[polygon.mesh], polygon.triangle);
      const Flat flat(triangle);
      const Outline whole{flat.at(triangle.points[0]), flat.at(triangle.points[1]), flat.at(triangle.points[2])};
      Part part{{}, polygon.is_lit};
      for (std::uint32_t i = polygon.first; i < polygon.first + polygon.count; ++i) {
        const glm::dvec3& corner = detail.corners[i];
        if (std::abs(glm::dot(flat.n, corner - flat.origin)) > tolerance) faults.insert("a corner is off its plane");
        part.outline.push_back(flat.at(corner));
        if (depth_in(whole, part.outline.back(), tolerance) < -tolerance) faults.insert("a corner is out of its triangle");
      }
      for (const glm::dvec2& corner : part.outline)
        if (depth_in(part.outline, corner, tolerance) < -tolerance)
          faults.insert("a polygon is not convex, or wound against its triangle");
      parts_[key].push_back(std::move(part));
    }
  }

  /// Adds a fault for every triangle that is not divided although it should be, or is although it should not, for polygons that
  /// overlap, and for areas that do not add up. Polygons that do not overlap and whose areas add up cover their triangle.
  void check(const Scene& scene, const Light& light, std::set<std::string>& faults) const {
    for (std::uint32_t m = 0; m < scene.meshes.size(); ++m)
      for (std::uint32_t t = 0; t < scene.meshes[m].triangles.size(); ++t) {
        const Triangle triangle = questions::corners(scene.meshes[m], t);
        const glm::vec3* p = triangle.points;
        const bool is_wanted = scene.meshes[m].receives && orient3d_sign(p[0], p[1], p[2], homogeneous(light)) != 0;
        const auto found = parts_.find({m, t});
        if (is_wanted != (found != parts_.end()))
          faults.insert(is_wanted ? "a triangle is left out" : "a triangle needs no detail and has one");
        if (!is_wanted || found == parts_.end()) continue;
        const std::vector<Part>& parts = found->second;
        double sum = 0, around = 0;
        for (std::size_t i = 0; i < parts.size(); ++i) {
          sum += area(parts[i].outline), around += length_around(parts[i].outline);
          for (std::size_t j = 0; j < i; ++j) {
            const Outline &a = parts[i].outline, &b = parts[j].outline;
            if (std::min(length_around(a), length_around(b)) > 4 * tolerance_ && !separates(a, b, tolerance_) &&
                !separates(b, a, tolerance_))
              faults.insert("two polygons overlap");
          }
        }
        const Flat flat(triangle);
        const Outline whole{flat.at(p[0]), flat.at(p[1]), flat.at(p[2])};
        if (std::abs(sum - area(whole)) > tolerance_ * around) faults.insert("areas do not add up");
      }
  }

  /// What the polygons at a point say, those within the tolerance included unless they are no thicker than that themselves:
  /// lit, dark, or, where none or both kinds are there, nothing.
  std::optional<bool> is_lit(const Scene& scene, std::uint32_t mesh, std::uint32_t triangle, const glm::vec3& point) const {
    const auto found = parts_.find({mesh, triangle});
    if (found == parts_.end()) return std::nullopt;
    const glm::dvec2 place = Flat(questions::corners(scene.meshes[mesh], triangle)).at(point);
    bool lit = false, dark = false;
    for (const Part& part : found->second)
      if (depth_in(part.outline, place, tolerance_) >= -tolerance_ &&
          depth_in(part.outline, middle(part.outline), tolerance_) > tolerance_)
        (part.is_lit ? lit : dark) = true;
    return lit != dark ? std::optional(lit) : std::nullopt;
  }

  std::size_t triangles() const { return parts_.size(); }

 private:
  double tolerance_;
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::vector<Part>> parts_;
};

/// What a set of faults reads, for messages.
inline std::string listed(const std::set<std::string>& faults) { return fmt::format("{}", fmt::join(faults, "; ")); }

}  // namespace gnomon
