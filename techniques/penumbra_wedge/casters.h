#pragma once
#include <gnomon/kit/geometry/casting_triangles.h>
#include <gnomon/kit/geometry/cut_masks.h>
#include <gnomon/kit/geometry/sure_sign.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <span>
#include <vector>

namespace gnomon::penumbra_wedge {

/// The casting triangles of a scene as layers before a light.
class Casters : public CastingTriangles {
 public:
  Casters() = default;
  explicit Casters(const Scene& scene) : Casters(CutMasks(scene)) {}
  explicit Casters(CutMasks cut) : CastingTriangles(cut.scene()), cut_(std::move(cut)), extent_(scene().bounds().extent()) {
    constexpr std::uint32_t unknown = no_mesh - 1;
    part_mesh_.assign(adjacency().parts().size(), unknown);
    std::uint32_t mesh = 0;
    for (std::uint32_t t = 0; t < adjacency().triangles().size(); ++t) {
      while (t >= numbers().end_of(mesh)) ++mesh;
      const std::uint32_t part = adjacency().part_of()[t];
      if (part != EdgeAdjacency::no_part)
        part_mesh_[part] = part_mesh_[part] == unknown || part_mesh_[part] == mesh ? mesh : no_mesh;
    }
    find_piece_corners();
  }

  double extent() const { return extent_; }
  /// Whether a triangle never shades a receiver's point; a piece of a mask as the triangle that it was cut out of.
  bool leaves_out(const NumberedReceiver& receiver, std::uint32_t triangle) const {
    const std::uint32_t source = cut_.source(triangle);
    return receiver.leaves_out(scene(), source, adjacency().corners(source).points);
  }
  /// Whether both ends of an edge are corners of the receiver's own triangle, or of its pieces.
  bool is_own_edge(const NumberedReceiver& receiver, std::uint32_t low, std::uint32_t high) const {
    const auto is_corner = [&](std::uint32_t end) {
      bool is = false;
      for (int k = 0; k < 3; ++k) is |= vertex(receiver.first_own, k) == end;
      return is;
    };
    if (is_corner(low) && is_corner(high)) return true;
    if (!cut_.is_cut()) return false;
    const auto [first, last] = cut_.pieces_of(receiver.first_own);
    const auto corners = std::span(piece_corners_).subspan(3 * (first - cut_.first_piece()), 3 * (last - first));
    return std::ranges::binary_search(corners, low) && std::ranges::binary_search(corners, high);
  }
  /// The mesh whose triangles a part consists of; no_mesh where it has those of several.
  std::uint32_t mesh_of_part(std::uint32_t part) const { return part_mesh_[part]; }

  /// Layers of a silhouette's surface between a receiver and a place of the light, `to` from its point; those that the place
  /// sees from behind, as the silhouette's light does not, count -1. Nothing where double cannot tell. `any`: one is enough.
  /// `hint`: a triangle to test first, and the last one that was crossed.
  std::optional<int> layers(const Silhouette& silhouette, const NumberedReceiver& receiver, const glm::dvec3& to, bool any,
                            std::uint32_t& hint) const {
    int sum = 0, side = 0;
    if (any && hint < silhouette.facing.size() && silhouette.facing[hint] != 0 &&
        crosses(receiver, hint, to, side) == Crossed::yes)
      return 1;
    bool is_unsure = false;
    any_on_way(receiver.point, to, [&](std::uint32_t triangle) {
      const int facing = silhouette.facing[triangle];
      if (facing == 0) return false;
      const Crossed one = crosses(receiver, triangle, to, side);
      is_unsure |= one == Crossed::unsure;
      if (one != Crossed::yes) return false;
      hint = triangle;
      sum += facing * side;
      return any;
    });
    if (is_unsure && !(any && sum != 0)) return std::nullopt;
    return any && sum != 0 ? 1 : sum;
  }
  std::size_t bytes() const { return CastingTriangles::bytes() + bytes_of(part_mesh_, piece_corners_) + cut_.bytes(); }

 private:
  enum class Crossed { no, yes, unsure };
  // As in crosses() of kit/geometry/exact.h, with the point at the origin.
  Crossed crosses(const NumberedReceiver& receiver, std::uint32_t triangle, const glm::dvec3& to, int& side) const {
    const Triangle corners = adjacency().corners(triangle);
    const glm::dvec3 p = receiver.point, u = glm::dvec3(corners.points[0]) - p, v = glm::dvec3(corners.points[1]) - p,
                     w = glm::dvec3(corners.points[2]) - p;
    double uv = 0, vw = 0, wu = 0, volume = 0;
    const int ab = sure_sign(u, v, to, uv), bc = sure_sign(v, w, to, vw);
    if (ab * bc < 0) return Crossed::no;
    const int ca = sure_sign(w, u, to, wu);
    if (ab * ca < 0 || bc * ca < 0) return Crossed::no;
    side = sure_sign(u, v, w, volume);
    // The way is met at volume / (uv + vw + wu) of it; at its end the light begins.
    const double sum = uv + vw + wu;
    if (side != 0 && ab + bc + ca != 0 && (side * (ab + bc + ca) < 0 || std::abs(volume) >= std::abs(sum) * (1 - 0x1p-40)))
      return Crossed::no;
    if (leaves_out(receiver, triangle) || is_beside(receiver, triangle, volume)) return Crossed::no;
    // A plane through the point is seen edge-on.
    if (side == 0 && orient3d_sign(corners.points[0], corners.points[1], corners.points[2], receiver.point) == 0)
      return Crossed::no;
    return side == 0 || ab * bc * ca == 0 ? Crossed::unsure : Crossed::yes;
  }
  /// Whether rounding alone tells the receiver's point from a triangle beside its own.
  bool is_beside(const NumberedReceiver& receiver, std::uint32_t triangle, double volume) const {
    if (!receiver.has_triangle()) return false;
    if (!are_neighbors(triangle, receiver.first_own)) return false;
    const double height = std::abs(volume) / glm::length(adjacency().corners(triangle).normal());
    return height <= 0x1p-21 * (gnomon::extent(receiver.point) + gnomon::extent(position(vertex(triangle, 0))));
  }

  /// Whether two triangles share a corner; pieces as those that they were cut out of, which have no vertices in common with
  /// casters any more.
  bool are_neighbors(std::uint32_t triangle, std::uint32_t own) const {
    bool are = false;
    for (int k = 0; k < 3; ++k)
      for (int j = 0; j < 3; ++j) are |= vertex(triangle, k) == vertex(own, j);
    if (!cut_.is_cut() || are) return are;
    const Triangle one = adjacency().corners(cut_.source(triangle)), other = adjacency().corners(own);
    for (const glm::vec3& a : one.points)
      for (const glm::vec3& b : other.points) are |= a == b;
    return are;
  }
  void find_piece_corners() {
    const auto first = cut_.first_piece(), end = first + static_cast<std::uint32_t>(cut_.piece_count());
    for (std::uint32_t piece = first; piece < end; ++piece)
      for (int k = 0; k < 3; ++k) piece_corners_.push_back(vertex(piece, k));
    for (std::uint32_t piece = first; piece < end;) {
      const auto next = cut_.pieces_of(cut_.source(piece)).second;
      std::ranges::sort(std::span(piece_corners_).subspan(3 * (piece - first), 3 * (next - piece)));
      piece = next;
    }
  }

  CutMasks cut_;
  double extent_ = 0;
  std::vector<std::uint32_t> part_mesh_;
  std::vector<std::uint32_t> piece_corners_;  ///< vertices of all pieces; those of the pieces of one triangle are sorted
};

}  // namespace gnomon::penumbra_wedge
