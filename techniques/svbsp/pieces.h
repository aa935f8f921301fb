#pragma once
#include <gnomon/kit/parallel.h>

#include <vector>

#include "tree.h"

namespace gnomon::svbsp {

/// A triangle of the scene.
struct SceneTriangle {
  glm::vec3 corners[3];
  std::uint32_t mesh;
};

/// A polygon wound the other way about; each edge keeps its mark.
inline void turn_over(std::vector<Corner>& polygon) {
  std::ranges::reverse(polygon);
  const std::uint32_t first = polygon[0].edge;
  for (std::size_t i = 0; i + 1 < polygon.size(); ++i) polygon[i].edge = polygon[i + 1].edge;
  polygon.back().edge = first;
}

/// How the light sees the triangles of a scene.
struct Facing {
  std::span<const SceneTriangle> triangles;
  std::span<const std::int8_t> signs;  ///< orient3d_sign of the corners and the light; 0 edge-on

  ClipPlane plane(const LightSpace& space, int face, std::uint32_t triangle) const {
    return space.plane(face, triangles[triangle].corners, signs[triangle]);
  }
};

/// A plane as heights over x and y; not finite where it holds the light.
inline glm::dvec3 rise(const ClipPlane& plane) {
  return -glm::dvec3(plane.normal.x, plane.normal.y, plane.offset) / plane.normal.z;
}

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

/// Takes convex polygons to light space.
class Projector {
 public:
  /// Calls visit(face, polygon) with the parts on each face, seen counter-clockwise, of a polygon of the world whose winding
  /// the light sees as `facing` says.
  template <class Visit>
  void run(const LightSpace& space, std::span<const Corner> world, int facing, Visit&& visit) {
    int face = space.face_of(world[0].at);
    bool is_on_one = true;
    for (const Corner& corner : world.subspan(1)) is_on_one &= space.face_of(corner.at) == face;
    if (is_on_one) {
      seen_.clear();
      for (const Corner& corner : world) seen_.push_back({space.seen(face, corner.at), corner.edge});
      return finish(space, face, facing, visit);
    }
    for (face = 0; face < space.face_count(); ++face)
      if (clip_to_face(space, face, world)) finish(space, face, facing, visit);
  }

 private:
  /// Into the pyramid of a face: before the light, and not farther across than that, to either side.
  bool clip_to_face(const LightSpace& space, int face, std::span<const Corner> world) {
    seen_.clear();
    double reach = 0;
    for (const Corner& corner : world) {
      seen_.push_back({space.seen(face, corner.at), corner.edge});
      const glm::dvec3 a = glm::abs(seen_.back().at);
      reach = std::max({reach, a.x, a.y, a.z});
    }
    const double error = 0x1p-48 * reach;  // of what cuts make; neighbors may so overlap, or leave a gap, by as much
    for (const glm::dvec3& normal : {glm::dvec3(1, 0, 1), glm::dvec3(-1, 0, 1), glm::dvec3(0, 1, 1), glm::dvec3(0, -1, 1)}) {
      values_.resize(seen_.size());
      const Lies lies = classify(seen_, {normal, 0}, error, values_.data());
      if (lies == Lies::positive) continue;
      if (lies != Lies::across) return false;
      inside_.resize(seen_.size() + 1), outside_.resize(seen_.size() + 1);
      const CutCounts cut = cut_polygon(seen_, values_.data(), error, shadow_cut, outside_.data(), inside_.data());
      inside_.resize(cut.positive);
      std::swap(seen_, inside_);
    }
    return true;
  }

  template <class Visit>
  void finish(const LightSpace& space, int face, int facing, Visit& visit) {
    for (Corner& corner : seen_) {
      if (space.is_point() && !(corner.at.z > 0)) return;  // at the light itself, but for rounding
      corner.at = space.projected(corner.at);
    }
    if (space.is_clockwise(facing)) turn_over(seen_);
    visit(face, std::span<const Corner>(seen_));
  }

  std::vector<Corner> seen_, inside_, outside_;
  std::vector<double> values_;
};

/// The pieces of casters, face by face.
class Pieces {
 public:
  /// Of `count` polygons: polygon_at(i, scratch) gives the triangle, and its part as a span of corners in the world; nothing
  /// where it is empty. On all threads; the order of pieces is that of the polygons.
  template <class PolygonAt>
  void make(const LightSpace& space, const Facing& facing, std::size_t count, const PolygonAt& polygon_at);

  std::span<const Piece> of_face(int face) const { return pieces_[face]; }
  std::size_t bytes() const {
    std::size_t sum = 0;
    for (int face = 0; face < 6; ++face) {
      sum += pieces_[face].capacity() * sizeof(Piece);
      for (const Block& block : blocks_)
        sum += block.corners[face].capacity() * sizeof(Corner) + block.pieces[face].capacity() * sizeof(Piece);
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

template <class PolygonAt>
void Pieces::make(const LightSpace& space, const Facing& facing, std::size_t count, const PolygonAt& polygon_at) {
  constexpr std::size_t block_size = 4096;
  blocks_.resize((count + block_size - 1) / block_size);
  for_blocks(count, block_size, [&](std::size_t begin, std::size_t end) {
    Block& block = blocks_[begin / block_size];
    for (int face = 0; face < 6; ++face) block.pieces[face].clear(), block.corners[face].clear();
    Projector projector;
    Corner scratch[3];
    for (std::size_t i = begin; i < end; ++i) {
      const auto [triangle, world] = polygon_at(i, scratch);
      if (world.empty()) continue;
      projector.run(space, world, facing.signs[triangle], [&](int face, std::span<const Corner> polygon) {
        glm::dvec2 low(INFINITY), high(-INFINITY);
        double top = -INFINITY;
        for (const Corner& corner : polygon) {
          low = glm::min(low, glm::dvec2(corner.at)), high = glm::max(high, glm::dvec2(corner.at));
          top = std::max(top, corner.at.z);
        }
        block.pieces[face].push_back({nullptr, static_cast<std::uint32_t>(polygon.size()), triangle, low, high,
                                      rise(facing.plane(space, face, triangle)), top});
        block.corners[face].insert(block.corners[face].end(), polygon.begin(), polygon.end());
      });
    }
  });
  for (int face = 0; face < 6; ++face) {
    pieces_[face].clear();
    for (Block& block : blocks_) {
      const Corner* next = block.corners[face].data();
      for (Piece& piece : block.pieces[face]) piece.corners = next, next += piece.count;
      pieces_[face].insert(pieces_[face].end(), block.pieces[face].begin(), block.pieces[face].end());
    }
  }
}

}  // namespace gnomon::svbsp
