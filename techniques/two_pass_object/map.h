#pragma once
#include "cell.h"

namespace gnomon::two_pass_object {

/// A triangle in a cell.
struct Entry {
  /// absent: not a receiver; exact: every point is decided by exact signs.
  enum class Kind : std::uint8_t { absent, lit, dark, pieces, exact };
  std::uint32_t triangle;
  std::uint32_t first_piece = 0, first_near = 0;
  std::uint16_t piece_count = 0, near_count = 0;
  std::uint16_t clips = 0;  ///< casters that took something away, up to 65535
  Kind kind = Kind::absent;
};

/// A lit piece: a box around its places, and planes that it lies inside, by their marks.
struct LitPiece {
  float u0, v0, u1, v1;
  std::uint32_t first_mark, mark_count;
};

/// Some neighboring cells of the grid, with the triangles and lit pieces in them.
struct Patch {
  std::vector<Node> nodes;
  std::vector<Entry> entries;  ///< of each leaf, by triangle
  std::vector<LitPiece> pieces;
  std::vector<std::uint32_t> marks;
  std::vector<std::uint32_t> near;  ///< casters so near to a receiver's plane that exact signs decide for each point
  std::size_t bytes() const { return bytes_of(nodes, entries, pieces, marks, near); }
  void fit() {
    nodes.shrink_to_fit();
    entries.shrink_to_fit();
    pieces.shrink_to_fit();
    marks.shrink_to_fit();
    near.shrink_to_fit();
  }
};

/// How points were decided.
struct PointWork {
  std::uint64_t points = 0, exact = 0;  ///< points located; those decided by exact signs of the triangles in their cell
  PointWork& operator+=(const PointWork& w) { return add_up(*this, w, &PointWork::points, &PointWork::exact); }
};

/// The triangles as the light sees them, in the cells of a grid whose crowded cells have grids of their own, and in each cell
/// the lit pieces of what it holds.
class LightMap {
 public:
  static constexpr std::uint32_t none = 0xffffffffu;
  void clear() {
    patches_.clear();
    roots_.clear();
    work_ = {};
  }
  void make(const Triangles& triangles, double cell_triangles);

  bool is_lit(const Triangles& triangles, const NumberedReceiver& receiver, PointWork& work) const;
  /// The first triangle in the point's cell that shades it, or `none`.
  std::uint32_t shading(const Triangles& triangles, const NumberedReceiver& receiver) const;
  /// Casters that took something from the point's triangle in its cell; 0 where it is not found.
  std::uint32_t clips_at(const Triangles& triangles, const NumberedReceiver& receiver) const;

  /// Calls visit(face, cell, footprints) for all cells of a patch.
  using LeafVisitor = std::function<void(int face, const Node& cell, std::span<const Footprint* const> footprints)>;
  void for_leaves(const Triangles& triangles, std::size_t patch, const LeafVisitor& visit) const;
  std::size_t patch_count() const { return patches_.size(); }
  const Work& work() const { return work_; }
  std::size_t bytes() const;

 private:
  static constexpr std::size_t patch_cells = 64;
  struct Face {
    Node node;
    std::uint32_t first_root = 0, first_patch = 0;
    double margin = 0;
  };
  struct Place {
    const Patch* patch = nullptr;  ///< null where the light sees no triangle
    const Node* cell = nullptr;
    int face = 0;
    PlaceAndDepth seen{};
    std::span<const Entry> entries() const { return {patch->entries.data() + cell->first, cell->count}; }
    /// Null where the cell does not have the triangle.
    const Entry* find(std::uint32_t triangle) const;
  };
  Place find(const Triangles& triangles, const glm::dvec3& point) const;

  Face faces_[6];
  std::vector<std::uint32_t> roots_;  ///< node of each cell of the first division
  std::vector<Patch> patches_;
  Work work_;
};

}  // namespace gnomon::two_pass_object
