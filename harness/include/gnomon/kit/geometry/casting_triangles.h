#pragma once
#include <gnomon/kit/geometry/beam.h>
#include <gnomon/kit/geometry/box_tree.h>
#include <gnomon/kit/geometry/edges.h>
#include <gnomon/kit/geometry/receiver.h>

#include <algorithm>
#include <concepts>

namespace gnomon {

/// The casting triangles of a scene, what joins them, and a tree of their boxes. Built once per scene, which must outlive it.
/// Triangles and vertices are numbered as those of the adjacency. Queries may run on many threads.
class CastingTriangles {
 public:
  CastingTriangles() = default;
  explicit CastingTriangles(const Scene& scene);

  const Scene& scene() const { return *scene_; }
  const TriangleNumbers& numbers() const { return numbers_; }
  const EdgeAdjacency& adjacency() const { return adjacency_; }
  const glm::vec3& position(std::uint32_t vertex) const { return adjacency_.positions()[vertex]; }
  /// Corner of a triangle: the first vertex at its position.
  std::uint32_t vertex(std::uint32_t triangle, int k) const {
    return adjacency_.first_at_position()[adjacency_.triangles()[triangle][k]];
  }

  /// Whether the box of a triangle for which is_part(triangle) meets a beam.
  template <std::predicate<std::uint32_t> IsPart>
  bool any_in(const Beam& beam, const IsPart& is_part) const;
  /// Triangles for which is_part(triangle) and whose box meets a box, in order.
  template <std::predicate<std::uint32_t> IsPart>
  void find_in(const Bounds& box, const IsPart& is_part, std::vector<std::uint32_t>& found) const;
  /// Calls visit(triangle) for those whose box meets the way from a point to the place `to` from it, and for some more, until
  /// one returns true; says whether one did.
  template <std::predicate<std::uint32_t> Visit>
  bool any_on_way(const glm::vec3& point, const glm::dvec3& to, const Visit& visit) const;
  std::size_t bytes() const { return numbers_.bytes() + adjacency_.bytes() + tree_.bytes() + bytes_of(triangles_); }

 private:
  Bounds bounds(std::uint32_t triangle) const {
    Bounds box;
    box.add(adjacency_.corners(triangle).points);
    return box;
  }

  const Scene* scene_ = nullptr;
  TriangleNumbers numbers_;
  EdgeAdjacency adjacency_;
  BoxTree tree_;
  std::vector<std::uint32_t> triangles_;  // in the order of the tree
};

inline CastingTriangles::CastingTriangles(const Scene& scene) : scene_(&scene), numbers_(scene), adjacency_(scene) {
  std::vector<Bounds> boxes;
  std::vector<std::uint32_t> casting;
  for (std::uint32_t t = 0; t < adjacency_.triangles().size(); ++t) {
    if (adjacency_.part_of()[t] == EdgeAdjacency::no_part) continue;
    casting.push_back(t);
    boxes.push_back(bounds(t));
  }
  tree_ = BoxTree(boxes);
  for (const std::uint32_t item : tree_.order()) triangles_.push_back(casting[item]);
}

template <std::predicate<std::uint32_t> IsPart>
bool CastingTriangles::any_in(const Beam& beam, const IsPart& is_part) const {
  bool any = false;
  tree_.each([&](const float* low, const float* high) { return beam.meets(low, high); },
             [&](std::uint32_t place) {
               if (!is_part(triangles_[place])) return false;
               const Bounds box = bounds(triangles_[place]);
               any = beam.meets(&box.min.x, &box.max.x);
               return any;
             });
  return any;
}

template <std::predicate<std::uint32_t> IsPart>
void CastingTriangles::find_in(const Bounds& box, const IsPart& is_part, std::vector<std::uint32_t>& found) const {
  found.clear();
  const auto meets = [&](const float* low, const float* high) {
    for (int k = 0; k < 3; ++k)
      if (low[k] > box.max[k] || high[k] < box.min[k]) return false;
    return true;
  };
  tree_.each(meets, [&](std::uint32_t place) {
    const Bounds own = bounds(triangles_[place]);
    if (is_part(triangles_[place]) && meets(&own.min.x, &own.max.x)) found.push_back(triangles_[place]);
    return false;
  });
  std::ranges::sort(found);
}

template <std::predicate<std::uint32_t> Visit>
bool CastingTriangles::any_on_way(const glm::vec3& point, const glm::dvec3& to, const Visit& visit) const {
  const SegmentSlabs slabs({point, glm::dvec4(glm::dvec3(point) + to, 1)});
  return tree_.any(slabs, 0.0, [&](std::uint32_t place) { return visit(triangles_[place]); });
}

}  // namespace gnomon
