#pragma once
#include <gnomon/kit/bytes.h>

#include <functional>
#include <utility>
#include <vector>

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

  ClipPlane plane(const ProjectedSpace& space, int face, std::uint32_t triangle) const {
    return space.plane(face, triangles[triangle].points, signs[triangle]);
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
bool is_thin(std::span<const Corner> polygon, double epsilon);

/// Takes convex polygons to light space.
class Projector {
 public:
  using Visit = std::function<void(int face, std::span<const Corner> polygon)>;
  /// Calls visit with the parts on each face, seen counter-clockwise, of a polygon of the world whose winding the light sees as
  /// `facing` says.
  void run(const ProjectedSpace& space, std::span<const Corner> world, int facing, const Visit& visit);

 private:
  /// Into the pyramid of a face: before the light, and not farther across than that, to either side.
  bool clip_to_face(const ProjectedSpace& space, int face, std::span<const Corner> world);
  void finish(const ProjectedSpace& space, int face, int facing, const Visit& visit);

  Clipper seen_;
};

/// The pieces of casters, face by face.
class Pieces {
 public:
  /// A triangle, and a part of it as corners in the world; no corners: left out.
  using Part = std::pair<std::uint32_t, std::span<const Corner>>;
  /// Of `count` polygons: polygon_at(i, scratch) gives each, perhaps in `scratch`, which has room for a triangle. On all
  /// threads; the order of pieces is that of the polygons.
  void make(const ProjectedSpace& space, const Facing& facing, std::size_t count,
            const std::function<Part(std::size_t i, Corner* scratch)>& polygon_at);

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
