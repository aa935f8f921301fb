#pragma once
#include "triangles.h"

namespace gnomon::two_pass_object {

/// Mark of an edge that a caster's plane made: 8 * triangle + 2 * plane + 2, plane 3 being its own; one more where the polygon
/// is on the inner side. 0 are the triangle's own edges and the borders of cells. `triangle` is below 2^29 - 1.
inline std::uint32_t mark_of(std::uint32_t triangle, unsigned plane) { return 8 * (triangle + 1) + 2 * plane; }
struct Mark {
  std::uint32_t triangle;
  int plane;
  bool is_inner;
  explicit Mark(std::uint32_t mark) : triangle(mark / 8 - 1), plane(static_cast<int>(mark / 2 % 4)), is_inner(mark % 2 != 0) {}
};

/// Whether a polygon lies on the outer side of one of the planes, but for epsilon.
inline bool is_outside(std::span<const Corner> polygon, std::span<const ClipPlane> planes, double epsilon) {
  return std::ranges::any_of(planes, [&](const ClipPlane& plane) {
    return std::ranges::all_of(polygon, [&](const Corner& corner) { return plane.at(corner.at) <= epsilon; });
  });
}

/// Convex lit pieces of one polygon, from which shadows are taken away, one caster after the other.
class Pieces {
 public:
  struct Piece {
    std::uint32_t first, count;
  };

  void start(std::span<const Corner> polygon) {
    used_ = 0;
    pieces_.clear();
    add(polygon);
  }
  std::size_t size() const { return pieces_.size(); }
  std::span<const Corner> operator[](std::size_t i) const { return {corners_.data() + pieces_[i].first, pieces_[i].count}; }

  /// Cuts made, and pieces that went dark.
  struct Cut {
    std::uint32_t splits = 0, shadowed = 0;
  };

  /// Takes away what lies on the inner side of all planes, plane after plane. A piece of which nothing lies there stays as it
  /// is. Calls dark(corners) with each part that is taken away.
  Cut take(std::span<const ClipPlane> planes, std::uint32_t triangle, double epsilon, const auto& dark) {
    Cut cut;
    const std::size_t before = pieces_.size();
    std::size_t kept = 0;
    for (std::size_t i = 0; i < before; ++i) {
      const Piece piece = pieces_[i];
      const std::size_t used = used_, added = pieces_.size();
      if (take(piece, planes, triangle, epsilon)) {
        cut.splits += static_cast<std::uint32_t>(pieces_.size() - added);
        ++cut.shadowed;
        dark(std::span<const Corner>(clipper_.corners()));
      } else {
        used_ = used;
        pieces_.resize(added);
        pieces_[kept++] = piece;
      }
    }
    const auto begin = pieces_.begin();
    if (kept < before) pieces_.erase(begin + static_cast<std::ptrdiff_t>(kept), begin + static_cast<std::ptrdiff_t>(before));
    return cut;
  }

  /// The part of a polygon on the inner side of all planes; empty when none is.
  std::span<const Corner> part_inside(std::span<const Corner> polygon, std::span<const ClipPlane> planes, double epsilon) {
    clipper_.start(polygon);
    for (const ClipPlane& plane : planes)
      if (!has_inside(clipper_.keep_positive(plane, epsilon))) return {};
    return clipper_.corners();
  }

 private:
  void add(std::span<const Corner> polygon) {
    if (corners_.size() < used_ + polygon.size()) corners_.resize(2 * (used_ + polygon.size()));
    std::ranges::copy(polygon, corners_.data() + used_);
    pieces_.push_back({static_cast<std::uint32_t>(used_), static_cast<std::uint32_t>(polygon.size())});
    used_ += polygon.size();
  }

  /// Whether anything is taken away; what is, the clipper holds then.
  bool take(const Piece& piece, std::span<const ClipPlane> planes, std::uint32_t triangle, double epsilon) {
    const std::span<const Corner> whole(corners_.data() + piece.first, piece.count);
    // Most pieces lie outside one plane as they are; cutting by the others first would be in vain.
    if (is_outside(whole, planes, epsilon)) return false;
    clipper_.start(whole);
    for (std::size_t k = 0; k < planes.size(); ++k) {
      const std::uint32_t mark = mark_of(triangle, static_cast<unsigned>(k));
      const Lies lies = clipper_.keep_positive(planes[k], epsilon, mark);
      if (!has_inside(lies)) return false;
      if (lies != Lies::across) continue;
      for (Corner& corner : clipper_.corners())
        if (corner.edge == mark) corner.edge = mark + 1;
      add(clipper_.cut_off());
    }
    return true;
  }

  std::vector<Corner> corners_;
  std::size_t used_ = 0;
  std::vector<Piece> pieces_;
  Clipper clipper_;
};

}  // namespace gnomon::two_pass_object
