#pragma once
#include <gnomon/kit/geometry/cut_masks.h>
#include <gnomon/kit/parallel.h>

#include <functional>

#include "tree.h"

namespace gnomon::svbsp {

/// A triangle of the scene.
struct SceneTriangle : Triangle {
  std::uint32_t mesh;
};

/// How the light sees the triangles of a scene.
struct Facing {
  std::span<const SceneTriangle> triangles;
  std::span<const std::int8_t> signs;  ///< orient3d_sign of the corners and the light; 0 edge-on
  const CutMasks* masks = nullptr;     ///< of the scene; null where none is cut

  /// A piece of a mask has the plane of the triangle that it was cut out of, so that all pieces are in one plane.
  ClipPlane plane(const ProjectedSpace& space, int face, std::uint32_t triangle) const {
    const std::uint32_t source = masks ? masks->source(triangle) : triangle;
    return space.plane(face, triangles[source].points, signs[source]);
  }
};

/// Which triangles moved since pieces and trees were made of them, where nothing else changed; empty: nothing is known.
struct Moved {
  std::span<const SceneTriangle> triangles;
  std::span<const std::uint8_t> meshes;  ///< of each whether it moved

  bool empty() const { return meshes.empty(); }
  bool operator()(std::uint32_t triangle) const { return meshes[triangles[triangle].mesh] != 0; }
  /// Whether one of the triangles begin .. end moved.
  bool any(std::size_t begin, std::size_t end) const {
    return std::ranges::any_of(triangles.subspan(begin, end - begin),
                               [&](const SceneTriangle& triangle) { return meshes[triangle.mesh] != 0; });
  }
};

/// The part of a convex polygon that lies on one face of light space, seen counter-clockwise there.
struct Piece {
  const Corner* corners;
  std::uint32_t count;
  std::uint32_t triangle;
  glm::dvec2 low, high;  ///< bounds
  glm::dvec3 rise;       ///< z is dot(rise, (x, y, 1)) on its plane
  double top;            ///< greatest z of its corners

  std::span<const Corner> polygon() const { return {corners, count}; }
  /// No point of it between two corners of a box is nearer to the light.
  double nearest(const glm::dvec2& low, const glm::dvec2& high) const {
    const double plane = std::max(rise.x * low.x, rise.x * high.x) + std::max(rise.y * low.y, rise.y * high.y) + rise.z;
    return plane < top ? plane : top;
  }
};

/// Whether a polygon of light space is no wider than epsilon: it has no inside to speak of, and rounding decides which side of
/// its edges that is.
inline bool is_thin(std::span<const Corner> polygon, double epsilon) {
  double area = 0, longest = 0;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const glm::dvec2 a(polygon[i].at), b(polygon[i + 1 < polygon.size() ? i + 1 : 0].at), c(polygon[0].at);
    const glm::dvec2 edge = b - a, from = a - c;
    area += from.x * edge.y - from.y * edge.x;
    longest = std::max(longest, glm::dot(edge, edge));
  }
  return !(area > 2 * epsilon * std::sqrt(longest));  // twice the area is the longest edge times the width, or more
}

/// A polygon wound the other way about; each edge keeps its mark.
inline void turn_over(std::span<Corner> polygon) {
  std::ranges::reverse(polygon);
  const std::uint32_t first = polygon[0].edge;
  for (std::size_t i = 0; i + 1 < polygon.size(); ++i) polygon[i].edge = polygon[i + 1].edge;
  polygon.back().edge = first;
}

/// A plane as heights over x and y; not finite where it holds the light.
inline glm::dvec3 rise_of(const ClipPlane& plane) {
  return -glm::dvec3(plane.normal.x, plane.normal.y, plane.offset) / plane.normal.z;
}

/// Takes convex polygons to light space.
class Projector {
 public:
  using Visit = std::function<void(int face, std::span<const Corner> polygon)>;
  /// Calls visit with the parts on each face, seen counter-clockwise, of a polygon of the world whose winding the light sees as
  /// `facing` says.
  void run(const ProjectedSpace& space, std::span<const Corner> world, int facing, const Visit& visit) {
    int face = space.face_of(world[0].at);
    bool is_on_one = true;
    for (const Corner& corner : world.subspan(1)) is_on_one &= space.face_of(corner.at) == face;
    if (is_on_one) {
      seen_.start();
      for (const Corner& corner : world) seen_.add({space.seen(face, corner.at), corner.edge});
      return finish(space, face, facing, visit);
    }
    for (face = 0; face < space.face_count(); ++face)
      if (clip_to_face(space, face, world)) finish(space, face, facing, visit);
  }

 private:
  /// Into the pyramid of a face: before the light, and not farther across than that, to either side.
  bool clip_to_face(const ProjectedSpace& space, int face, std::span<const Corner> world) {
    seen_.start();
    double reach = 0;
    for (const Corner& corner : world) {
      const glm::dvec3 at = space.seen(face, corner.at), a = glm::abs(at);
      seen_.add({at, corner.edge});
      reach = std::max({reach, a.x, a.y, a.z});
    }
    const double error = 0x1p-48 * reach;  // of what cuts make; neighbors may so overlap, or leave a gap, by as much
    for (const glm::dvec3& normal : {glm::dvec3(1, 0, 1), glm::dvec3(-1, 0, 1), glm::dvec3(0, 1, 1), glm::dvec3(0, -1, 1)})
      if (!has_inside(seen_.keep_positive({normal, 0}, error, shadow_cut))) return false;
    return true;
  }

  void finish(const ProjectedSpace& space, int face, int facing, const Visit& visit) {
    for (Corner& corner : seen_.corners()) {
      if (space.is_point() && !(corner.at.z > 0)) return;  // at the light itself, but for rounding
      corner.at = space.projected(corner.at);
    }
    if (space.is_clockwise(facing)) turn_over(seen_.corners());
    visit(face, seen_.corners());
  }

  Clipper seen_;
};

/// The pieces of casters, face by face.
class Pieces {
 public:
  /// A triangle, and a part of it as corners in the world; no corners: left out.
  using Part = std::pair<std::uint32_t, std::span<const Corner>>;
  /// Of `count` polygons: polygon_at(i, scratch) gives each, perhaps in `scratch`, which has room for a triangle. On all
  /// threads; the order of pieces is that of the polygons. Where it is known what moved, polygon i is triangle i, and blocks of
  /// them in which nothing moved stay.
  void make(const ProjectedSpace& space, const Facing& facing, std::size_t count,
            const std::function<Part(std::size_t i, Corner* scratch)>& polygon_at, const Moved& moved = {}) {
    constexpr std::size_t block_size = 4096;
    blocks_.resize((count + block_size - 1) / block_size);
    for_blocks(count, block_size, [&](std::size_t begin, std::size_t end) {
      if (!moved.empty() && !moved.any(begin, end)) return;
      Block& block = blocks_[begin / block_size];
      for (int face = 0; face < 6; ++face) {
        block.pieces[face].clear();
        block.corners[face].clear();
      }
      Projector projector;
      Corner scratch[3];
      for (std::size_t i = begin; i < end; ++i) {
        const auto [triangle, world] = polygon_at(i, scratch);
        if (world.empty()) continue;
        projector.run(space, world, facing.signs[triangle], [&, triangle = triangle](int face, std::span<const Corner> seen) {
          glm::dvec2 low(INFINITY), high(-INFINITY);
          double top = -INFINITY;
          for (const Corner& corner : seen) {
            low = glm::min(low, glm::dvec2(corner.at));
            high = glm::max(high, glm::dvec2(corner.at));
            top = std::max(top, corner.at.z);
          }
          block.pieces[face].push_back({nullptr, static_cast<std::uint32_t>(seen.size()), triangle, low, high,
                                        rise_of(facing.plane(space, face, triangle)), top});
          block.corners[face].insert(block.corners[face].end(), seen.begin(), seen.end());
        });
      }
    });
    for (int face = 0; face < 6; ++face) {
      pieces_[face].clear();
      for (Block& block : blocks_) {
        const Corner* next = block.corners[face].data();
        for (Piece& piece : block.pieces[face]) {
          piece.corners = next;
          next += piece.count;
        }
        pieces_[face].insert(pieces_[face].end(), block.pieces[face].begin(), block.pieces[face].end());
      }
    }
  }
  std::span<const Piece> of_face(int face) const { return pieces_[face]; }
  std::size_t bytes() const {
    std::size_t sum = 0;
    for (int face = 0; face < 6; ++face) {
      sum += bytes_of(pieces_[face]);
      for (const Block& block : blocks_) sum += bytes_of(block.corners[face], block.pieces[face]);
    }
    return sum;
  }

 private:
  struct Block {
    std::vector<Corner> corners[6];  ///< of the pieces on each face, in their order
    std::vector<Piece> pieces[6];
  };
  std::vector<Block> blocks_;
  std::vector<Piece> pieces_[6];
};

}  // namespace gnomon::svbsp
