#include "pieces.h"

#include <gnomon/kit/parallel.h>

namespace gnomon::svbsp {

namespace {

/// A polygon wound the other way about; each edge keeps its mark.
void turn_over(std::span<Corner> polygon) {
  std::ranges::reverse(polygon);
  const std::uint32_t first = polygon[0].edge;
  for (std::size_t i = 0; i + 1 < polygon.size(); ++i) polygon[i].edge = polygon[i + 1].edge;
  polygon.back().edge = first;
}

/// A plane as heights over x and y; not finite where it holds the light.
glm::dvec3 rise(const ClipPlane& plane) { return -glm::dvec3(plane.normal.x, plane.normal.y, plane.offset) / plane.normal.z; }

}  // namespace

bool is_thin(std::span<const Corner> polygon, double epsilon) {
  double area = 0, longest = 0;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const glm::dvec2 a(polygon[i].at), b(polygon[i + 1 < polygon.size() ? i + 1 : 0].at), c(polygon[0].at);
    const glm::dvec2 edge = b - a, from = a - c;
    area += from.x * edge.y - from.y * edge.x;
    longest = std::max(longest, glm::dot(edge, edge));
  }
  return !(area > 2 * epsilon * std::sqrt(longest));  // twice the area is the longest edge times the width, or more
}

void Projector::run(const ProjectedSpace& space, std::span<const Corner> world, int facing, const Visit& visit) {
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

bool Projector::clip_to_face(const ProjectedSpace& space, int face, std::span<const Corner> world) {
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

void Projector::finish(const ProjectedSpace& space, int face, int facing, const Visit& visit) {
  for (Corner& corner : seen_.corners()) {
    if (space.is_point() && !(corner.at.z > 0)) return;  // at the light itself, but for rounding
    corner.at = space.projected(corner.at);
  }
  if (space.is_clockwise(facing)) turn_over(seen_.corners());
  visit(face, seen_.corners());
}

void Pieces::make(const ProjectedSpace& space, const Facing& facing, std::size_t count,
                  const std::function<Part(std::size_t, Corner*)>& polygon_at) {
  constexpr std::size_t block_size = 4096;
  blocks_.resize((count + block_size - 1) / block_size);
  for_blocks(count, block_size, [&](std::size_t begin, std::size_t end) {
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
      projector.run(space, world, facing.signs[triangle], [&, triangle = triangle](int face, std::span<const Corner> polygon) {
        glm::dvec2 low(INFINITY), high(-INFINITY);
        double top = -INFINITY;
        for (const Corner& corner : polygon) {
          low = glm::min(low, glm::dvec2(corner.at));
          high = glm::max(high, glm::dvec2(corner.at));
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
      for (Piece& piece : block.pieces[face]) {
        piece.corners = next;
        next += piece.count;
      }
      pieces_[face].insert(pieces_[face].end(), block.pieces[face].begin(), block.pieces[face].end());
    }
  }
}

}  // namespace gnomon::svbsp
