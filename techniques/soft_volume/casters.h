#pragma once
#include <gnomon/kit/geometry/casting_triangles.h>
#include <gnomon/kit/geometry/cut_masks.h>

namespace gnomon::soft_volume {

/// The way from a receiver's point to a place of a light: whether a caster is between.
enum class Way { clear, blocked, unsure };

/// The last coplanarity answers: two numbers of triangles and the answer.
class CoplanarCache {
 public:
  template <class Test>
  bool is_coplanar(std::uint32_t own, std::uint32_t other, const Test& test) {
    Entry& entry = entries_[(own * 31 + other) % entries_.size()];
    if (entry.own != own || entry.other != other) entry = {own, other, test()};
    return entry.answer;
  }

 private:
  static constexpr std::uint32_t none = 0xffffffffu;
  struct Entry {
    std::uint32_t own = none, other = none;
    bool answer = false;
  };
  std::array<Entry, 256> entries_;
};

/// An edge of the casters that may be a silhouette edge. Ends are vertices of the adjacency, low < high.
struct CasterEdge {
  std::uint32_t low, high;
  std::uint32_t first, second;  ///< of a regular edge: the triangle that runs from low to high, and the other
};

/// The casting triangles of a scene with their planes, and their edges in a tree whose nodes store which way the triangles at
/// their edges face. A piece of a mask has its own edges, and the plane of the triangle that it was cut out of: so edges
/// between two pieces of a triangle are no silhouette edges for any point.
class Casters : public CastingTriangles {
 public:
  Casters() = default;
  explicit Casters(const Scene& scene) : Casters(CutMasks(scene)) {}
  explicit Casters(CutMasks cut);

  /// Edges that a beam meets and that may be silhouette edges for a point in `from`, the beam's box of points. Numbers of
  /// `edge`; regular ones first. Says how many of these.
  std::size_t find_edges(const Beam& beam, const Bounds& from, std::vector<std::uint32_t>& found) const;
  /// The same for a part of these points, of the edges that were found for all of them, `wide`.
  std::size_t narrow_edges(const Beam& beam, const Bounds& from, std::span<const std::uint32_t> wide,
                           std::vector<std::uint32_t>& found) const;

  const CasterEdge& edge(std::uint32_t number) const { return edges_[number]; }
  bool is_regular(std::uint32_t number) const { return number < regular_count_; }

  /// What a point sees of a triangle: +1 its corners counter-clockwise, -1 clockwise; 0 edge-on, or left out for this receiver.
  int facing(const NumberedReceiver& receiver, std::uint32_t triangle, CoplanarCache& cache) const;
  /// The sum over the triangles at an edge of their facing, each times the direction, +1 for low to high, in which it runs
  /// along the edge: how many triangles more are crossed on one side of the edge than on the other, as the point sees it.
  int multiplicity(const NumberedReceiver& receiver, std::uint32_t edge, CoplanarCache& cache) const;
  /// Whether a triangle blocks the way from the receiver's point to the place that far off. `hint`: a triangle to test first,
  /// and the one that blocked. Unsure: an edge is met, as double sees it, and nothing else blocks.
  Way way(const NumberedReceiver& receiver, const glm::dvec3& to, CoplanarCache& cache, std::uint32_t& hint) const;

  /// A unit normal and an offset: dot(normal, p) + offset is the height of p over the triangle, meters. Zero where the triangle
  /// is too thin for double.
  const glm::dvec4& plane(std::uint32_t triangle) const { return planes_[triangle]; }
  std::size_t bytes() const {
    return CastingTriangles::bytes() + irregular_tree_.bytes() + bytes_of(planes_, edges_, sides_, nodes_) + cut_.bytes();
  }

 private:
  /// A box of edges, and a cone of the normals at them: an axis and the largest angle from it.
  struct Node {
    float low[3], high[3];
    float axis[3] = {}, cosine = -1, sine = 0;
    std::uint32_t skip = 0, first = 0, count = 0;
  };
  struct Builder;
  static glm::dvec3 middle_of(const Bounds& box) { return 0.5 * (glm::dvec3(box.min) + glm::dvec3(box.max)); }
  /// A box of points, in the form that the tests of edges use.
  struct Viewers {
    glm::dvec3 middle, half;
    double slack;  ///< of a height over a plane: more than rounding may have put a point off its own
    explicit Viewers(const Bounds& box)
        : middle(middle_of(box)), half(0.5 * (glm::dvec3(box.max) - glm::dvec3(box.min))), slack(0x1p-18 * extent(middle)) {}
  };
  /// Whether both triangles of a regular edge face all points alike.
  bool faces_alike(const Viewers& from, std::uint32_t edge) const;
  bool meets(const Beam& beam, std::uint32_t edge) const;
  void add_edges();
  void find_planes();
  Way crosses(const NumberedReceiver& receiver, std::uint32_t triangle, const glm::dvec3& to, CoplanarCache& cache) const;

  CutMasks cut_;
  std::vector<glm::dvec4> planes_;
  std::vector<CasterEdge> edges_;  // regular ones in the order of the tree, then the others in that of the adjacency
  std::uint32_t regular_count_ = 0;
  std::vector<EdgeAdjacency::Side> sides_;  // of irregular edges, as the adjacency has them
  std::vector<Node> nodes_;
  BoxTree irregular_tree_;
};

}  // namespace gnomon::soft_volume
