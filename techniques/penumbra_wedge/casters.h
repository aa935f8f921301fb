#pragma once
#include <gnomon/kit/geometry/beam.h>
#include <gnomon/kit/geometry/box_tree.h>
#include <gnomon/kit/geometry/edges.h>
#include <gnomon/kit/geometry/receiver.h>

namespace gnomon::penumbra_wedge {

/// The casting triangles of a scene in a tree, and what joins them. Built once per scene, which must outlive it. Queries may
/// run on many threads.
class Casters {
 public:
  Casters() = default;
  explicit Casters(const Scene& scene);

  const Scene& scene() const { return *scene_; }
  const TriangleNumbers& numbers() const { return numbers_; }
  const EdgeAdjacency& adjacency() const { return adjacency_; }
  double extent() const { return extent_; }
  const glm::vec3& position(std::uint32_t vertex) const { return adjacency_.positions()[vertex]; }
  /// Corner of a triangle: the first vertex at its position.
  std::uint32_t vertex(std::uint32_t triangle, int k) const {
    return adjacency_.first_at_position()[adjacency_.triangles()[triangle][k]];
  }
  /// The mesh whose triangles a part consists of; no_mesh where it has those of several.
  std::uint32_t mesh_of_part(std::uint32_t part) const { return part_mesh_[part]; }

  bool has_triangles(const Silhouette& silhouette, const Beam& beam) const;
  /// Triangles of a silhouette whose box meets a box, in order.
  void find_triangles(const Silhouette& silhouette, const Bounds& box, std::vector<std::uint32_t>& found) const;

  /// Layers of a silhouette's surface between a receiver and a place of the light, `to` from its point; those that the place
  /// sees from behind, as the silhouette's light does not, count -1. Nothing where double cannot tell. `any`: one is enough.
  /// `hint`: a triangle to be asked first, and the last one that was crossed.
  std::optional<int> layers(const Silhouette& silhouette, const NumberedReceiver& receiver, const glm::dvec3& to, bool any,
                            std::uint32_t& hint) const;
  std::size_t bytes() const;

 private:
  enum class Crossed { no, yes, unsure };
  Crossed crosses(const NumberedReceiver& receiver, std::uint32_t triangle, const glm::dvec3& to, int& side) const;
  /// Whether rounding alone tells the receiver's point from a triangle beside its own.
  bool is_beside(const NumberedReceiver& receiver, std::uint32_t triangle, double volume) const;

  const Scene* scene_ = nullptr;
  double extent_ = 0;
  TriangleNumbers numbers_;
  EdgeAdjacency adjacency_;
  std::vector<std::uint32_t> part_mesh_;
  BoxTree tree_;
  std::vector<std::uint32_t> triangles_;  // in the order of the tree
};

}  // namespace gnomon::penumbra_wedge
