#pragma once
#include <gnomon/kit/geometry/clip.h>
#include <gnomon/kit/geometry/receiver.h>
#include <gnomon/kit/unset_vector.h>

namespace gnomon::svbsp {

/// A triangle of the scene, or a part of one: convex, wound as the triangle is.
struct BspPolygon {
  std::uint32_t triangle;  ///< counted over the scene, mesh after mesh
  /// Corners of the tree, see Bsp::corners(). Corner::edge is 0 on the triangle's own edges, 1 on those that cuts made.
  std::uint32_t first, count;
};

/// A triangle of a scene, by its number over all meshes.
inline Triangle triangle_of(const Scene& scene, const TriangleNumbers& numbers, std::uint32_t number) {
  const std::uint32_t mesh = numbers.mesh_of(number);
  return scene.meshes[mesh].corners(number - numbers.first_of(mesh));
}

/// What a tree is made by.
struct BspOptions {
  /// Which polygon's plane divides a cell's polygons: that of the first one in the order of the scene; of the one, among
  /// `candidates`, that cuts the fewest others, then the one that divides them most evenly; or the one with the least of 8 x
  /// cuts + difference of the sides.
  enum class Choice { balanced, fewest_splits, first };  ///< in the order of svbsp.split
  Choice choice = Choice::balanced;
  /// Whether planes across an axis, through the middle of a cell's polygons, are candidates too. They need hold no polygon. Not
  /// with `first`.
  bool free_cuts = true;
  std::uint32_t candidates = 8;  ///< at least 1; evenly spaced in the list of the cell's polygons
  std::uint32_t sample = 48;     ///< at least 1; polygons on which a candidate is tried, evenly spaced
};

/// A BSP tree of all triangles of a scene, casters or not (Fuchs, Kedem and Naylor 1980). Each node has a plane and the
/// polygons that lie in it, its coplanar set; what crosses the plane is cut. Triangles of zero area are left out.
///
/// Planes and cuts are in double. A corner within epsilon = 1e-10 of the scene's largest coordinate counts as on a plane: far
/// above what rounding makes of a plane and of points on it (below 2e-11), far below what float32 coordinates tell apart
/// (6e-8). Whether a triangle lies in the plane of another, and else on which side if all of it is within epsilon, is decided
/// exactly.
class Bsp {
 public:
  Bsp() = default;
  /// On all threads; the outcome does not depend on their number. Without free cuts a convex mesh of n triangles is a chain of
  /// nearly n nodes, and takes time like n^2.
  explicit Bsp(const Scene& scene, const BspOptions& options = {});

  std::span<const Corner> corners(const BspPolygon& polygon) const { return {corners_.data() + polygon.first, polygon.count}; }
  /// All of them, each coplanar set in a row.
  std::span<const BspPolygon> polygons() const { return polygons_; }

  /// Calls visit(std::span<const BspPolygon>) for every coplanar set, so that nothing in a later set hides a part of an earlier
  /// one from `from`: a homogeneous point, w = 1, or the direction to a point infinitely far away, w = 0.
  void front_to_back(const glm::dvec4& from, const auto& visit) const { walk(from, 1, visit); }
  /// The same sets the other way about.
  void back_to_front(const glm::dvec4& from, const auto& visit) const { walk(from, 0, visit); }

  std::size_t node_count() const { return nodes_.size(); }
  std::size_t split_count() const { return split_count_; }  ///< polygons cut, each into two
  std::size_t depth() const { return depth_; }              ///< nodes on the longest way from the root
  double epsilon() const { return epsilon_; }               ///< meters
  std::size_t bytes() const { return bytes_of(nodes_, polygons_, corners_); }

 private:
  struct Builder;
  static constexpr std::uint32_t none = 0xffffffffu;
  struct Node {
    ClipPlane plane;            ///< zero where there are no children
    std::uint32_t children[2];  ///< on its negative and positive side, or none
    std::uint32_t first, count;
  };

  /// In order: the child on the side of `from` when near is 1, on the other one when it is 0; the node; the other child.
  void walk(const glm::dvec4& from, unsigned near, const auto& visit) const {
    std::vector<std::uint32_t> way;  // nodes to come back to; the lowest bit is the child that is done by then
    way.reserve(depth_);
    std::uint32_t next = nodes_.empty() ? none : 0;
    for (;;) {
      while (next != none) {
        const Node& node = nodes_[next];
        const glm::dvec3& n = node.plane.normal;
        const bool is_positive = n.x * from.x + n.y * from.y + n.z * from.z + node.plane.offset * from.w > 0;
        const unsigned child = is_positive ? near : 1 - near;
        way.push_back(next << 1 | child);
        next = node.children[child];
      }
      if (way.empty()) return;
      const Node& node = nodes_[way.back() >> 1];
      next = node.children[1 - (way.back() & 1)];
      way.pop_back();
      if (node.count > 0) visit(std::span<const BspPolygon>(polygons_.data() + node.first, node.count));
    }
  }

  UnsetVector<Node> nodes_;  ///< the root first, children after their parents
  UnsetVector<BspPolygon> polygons_;
  UnsetVector<Corner> corners_;
  std::size_t split_count_ = 0, depth_ = 0;
  double epsilon_ = 0;
};

}  // namespace gnomon::svbsp
