#pragma once
#include <gnomon/changes.h>

namespace gnomon {

/// A homogeneous point's shadow at infinity: (L_w X - L_xyz, 0), the direction in which light that passes X goes on.
inline glm::dvec4 extruded(const glm::dvec3& x, const glm::dvec4& light) { return {light.w * x - glm::dvec3(light), 0}; }

/// Edge of the outline that a light sees of the casters: the surface ends or folds here, and a side quad starts. Ends are
/// vertices of the scene, each the first one at its position, low < high. `count` is the sum over the triangles at the edge of
/// the direction, +1 for low to high, in which they run along it when turned counter-clockwise seen from the light: never 0,
/// and 2 where two layers of an open surface fold. The side quad for count > 0 is high, low, low at infinity, high at
/// infinity, counter-clockwise seen from outside the volume (Lengyel's Table 10.1); for count < 0 the other way about.
struct SilhouetteEdge {
  std::uint32_t low, high;
  std::int32_t count;
  std::uint32_t part;
};

/// What a light sees of the casters: the surface whose shadow volume is the set of all points behind it, and its outline.
struct Silhouette {
  glm::dvec4 light{0};
  /// Of each triangle of the scene: +1 counter-clockwise seen from the light, -1 clockwise; 0 where the triangle takes no part:
  /// not casting, edge-on, or of the half of a closed body that the other half covers.
  std::vector<std::int8_t> facing;
  std::vector<SilhouetteEdge> edges;                ///< in a fixed order: those of regular edges first, by their ends
  std::size_t regular_count = 0;                    ///< of the edges
  std::vector<std::int8_t> halves;                  ///< of each part of an adjacency that can follow a motion; else empty
  std::vector<std::vector<SilhouetteEdge>> blocks;  ///< scratch
  std::size_t bytes() const;
};

/// Which vertices of the casters are one.
enum class Joins {
  in_this_pose,  ///< those at equal positions now, across meshes
  in_every_pose  ///< those that the scene's motion never parts (kit/geometry/joined_vertices.h); without motion the same
};

/// Triangles of which some may face a light otherwise than before an update: first <= t < end.
struct Refaced {
  std::uint32_t first = 0, end = 0;
  bool empty() const { return first >= end; }
};

/// Which casting triangles of a scene share an edge; built once per scene. Triangles and vertices are counted over the whole
/// scene, mesh after mesh. A triangle two corners of which are one vertex, as a pose may have made them, has no edges and no
/// part: those beside it share an edge. Any other triangle without area is edge-on to every light.
///
/// With Joins::in_every_pose it depends on no pose, and `move` brings it to another one. Several vertices may then be at one
/// position for a while. An edge between two of them is no edge of an outline, and an outline that passes a triangle without
/// area may run along one line forth and back; it is closed all the same.
class EdgeAdjacency {
 public:
  EdgeAdjacency() = default;
  explicit EdgeAdjacency(const Scene& scene, Joins joins = Joins::in_this_pose);

  /// Whether `move` can follow these changes: each mesh that moved has a rig, by which its vertices are joined, or casts not.
  bool can_follow(const Changes& changes) const;
  /// Meshes, rising: those that moved, and those whose vertices are joined with theirs.
  using Moved = std::vector<std::uint32_t>;
  /// Takes positions from the scene that it was built of, in another pose: afterwards it is what building there gives. Time
  /// grows with the triangles of the meshes that moved. `can_follow(changes)`.
  Moved move(const Scene& scene, const Changes& changes);
  /// Whether several vertices may be at one position.
  bool has_meeting_vertices() const { return joins_by_rigs_; }

  /// An edge of two triangles that run along it in opposite directions.
  struct Edge {
    std::uint32_t low, high;
    std::uint32_t first, second;  ///< the triangle that runs from low to high, and the other
  };
  /// Any other edge: open, of three or more triangles, or of two wound against each other.
  struct IrregularEdge {
    std::uint32_t low, high;
    std::uint32_t first_side, side_count;  ///< of `sides()`
  };
  /// A triangle at an irregular edge, times two, plus one where it runs from low to high.
  using Side = std::uint32_t;

  /// Triangles connected by edges.
  struct Part {
    Bounds bounds;
    bool closed = true;  ///< every edge is regular, and no triangle has an alpha mask
    double volume = 0;   ///< signed, cubic meters; positive when wound counter-clockwise seen from outside; if closed
  };
  /// Which triangles of a part take part in its shadow volume: both, or those of one facing. Half of a closed body is enough
  /// for a light outside its bounds: what blocks light there enters the body before it leaves it.
  enum class Half : std::int8_t { clockwise = -1, both = 0, counter_clockwise = 1 };
  Half half(const Part& part, const glm::dvec4& light) const;

  /// On all threads. Every sign is exact, for a light of float32 numbers as `homogeneous` gives it; the outcome never depends
  /// on the number of threads. Reuses the memory of `out`.
  void find_silhouette(const glm::dvec4& light, Silhouette& out) const;
  /// The same where `out` is what that gave before the last `move`, which returned `moved`. Under the very same light it is
  /// found anew for the meshes that moved alone, and for all where a body's half changed: half(). `out.blocks` is then empty.
  Refaced find_silhouette(const glm::dvec4& light, const Moved& moved, Silhouette& out) const;

  struct Depth {
    std::int64_t volumes = 0;  ///< shadow volumes around the point, that is, triangles taking part between it and the light
    bool degenerate = false;   ///< the way to the light goes through an edge or vertex, or the point lies on a triangle
  };
  /// How deep in shadow a point of space lies. Exact; on all threads; time grows with the triangles of the meshes in the way.
  Depth depth_at(const glm::vec3& point, const Silhouette& silhouette) const;

  std::span<const glm::vec3> positions() const { return positions_; }
  std::span<const glm::uvec3> triangles() const { return triangles_; }  ///< vertices as the meshes name them
  Triangle corners(std::size_t triangle) const {
    const glm::uvec3& t = triangles_[triangle];
    return {{positions_[t.x], positions_[t.y], positions_[t.z]}};
  }
  /// Of each triangle; no_part where it does not cast, or two of its corners are one vertex.
  std::span<const std::uint32_t> part_of() const { return part_of_; }
  std::span<const Part> parts() const { return parts_; }
  std::span<const Edge> edges() const { return edges_; }
  std::span<const IrregularEdge> irregular_edges() const { return irregular_; }
  std::span<const Side> sides() const { return sides_; }
  /// The first of the vertices that are one with each vertex; a vertex itself where its mesh does not cast.
  std::span<const std::uint32_t> first_at_position() const { return first_at_position_; }
  std::size_t bytes() const;

  static constexpr std::uint32_t no_part = 0xffffffffu;

 private:
  /// Planes of the triangles, normal and offset by coordinate: quick to sweep over. All zero where float32 tells too little, so
  /// that no sign is taken from them.
  struct Planes {
    std::vector<float> x, y, z, offset;
  };
  struct MeshTriangles {
    std::uint32_t first = 0, count = 0;
    bool casts = true, has_holes = false;
    Bounds bounds = {};
    std::uint32_t first_vertex = 0, vertex_count = 0;
    bool has_rig = false;
    std::uint32_t group = 0;  ///< the first of the meshes whose vertices are joined, one with the next; if it joins by rigs
  };
  struct HalfEdges;
  struct JoinedEdges;
  /// Whether two corners of a casting triangle are one vertex.
  bool is_collapsed(std::uint32_t triangle) const;
  HalfEdges find_half_edges() const;
  void join_edges();
  void find_parts();
  void add_bounds(const MeshTriangles& mesh);
  void add_volumes(const MeshTriangles& mesh);
  void find_planes(std::size_t first, std::size_t count);
  void find_groups();
  /// Of each part.
  std::vector<std::int8_t> halves_under(const glm::dvec4& light) const;
  void find_facing(std::size_t first, std::size_t count, const glm::dvec4& light, const std::vector<std::int8_t>& halves,
                   std::vector<std::int8_t>& facing) const;
  int count_at(const Edge& edge, std::span<const std::int8_t> facing) const { return facing[edge.first] - facing[edge.second]; }
  int count_at(const IrregularEdge& edge, std::span<const std::int8_t> facing) const;
  std::uint32_t part_at(const Edge& edge) const { return part_of_[edge.first]; }
  std::uint32_t part_at(const IrregularEdge& edge) const { return part_of_[sides_[edge.first_side] / 2]; }
  /// Appends those of some edges that are on the outline.
  template <class AnyEdge>
  void add_outline(std::span<const AnyEdge> some, std::span<const std::int8_t> facing,
                   std::vector<SilhouetteEdge>& outline) const;
  /// Appends an outline, with the edges at vertices of the meshes that moved found anew among all edges.
  template <class AnyEdge>
  void add_moved(std::span<const AnyEdge> all, std::span<const SilhouetteEdge> before, const Moved& moved,
                 std::span<const std::int8_t> facing, std::vector<SilhouetteEdge>& outline) const;
  /// Sign of the triangle's plane at a homogeneous point: +1 where it sees the triangle counter-clockwise.
  int side(std::uint32_t triangle, const glm::dvec4& point) const;

  std::vector<glm::vec3> positions_;
  std::vector<glm::uvec3> triangles_;
  std::vector<MeshTriangles> meshes_;
  std::vector<std::uint32_t> first_at_position_;
  std::vector<std::uint32_t> part_of_;
  std::vector<Part> parts_;
  std::vector<Edge> edges_;
  std::vector<IrregularEdge> irregular_;
  std::vector<Side> sides_;
  Planes planes_;
  double extent_ = 0;           // largest coordinate
  bool joins_by_rigs_ = false;  // Joins::in_every_pose of a scene with motion
};

/// At least as many shadow volumes as overlap at any point of space, from the outline alone: how often it winds around a
/// point of the light's image. Where a first quick bound is over `enough` (what the asker can count), finer ones are tried
/// until one column of the image is over it, too; so a result above `enough` is the quick one. Time grows with the edges, times
/// the columns that they span where the quick bound is over.
std::int64_t bound_depth(const EdgeAdjacency& adjacency, const Silhouette& silhouette, std::int64_t enough);

/// The boxes of a casting mesh's connected parts, where every part is closed and wound counter-clockwise seen from outside:
/// light from outside of a box never reaches the inside of its part. Empty otherwise.
std::vector<Bounds> solid_parts(const Mesh& mesh);
/// Of each mesh.
using SolidParts = std::vector<std::vector<Bounds>>;
SolidParts solid_parts(const Scene& scene);
inline std::size_t bytes_of(const SolidParts& parts) {
  std::size_t bytes = 0;
  for (const std::vector<Bounds>& mesh : parts) bytes += mesh.size() * sizeof(Bounds);
  return bytes;
}

}  // namespace gnomon
