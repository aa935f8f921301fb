#pragma once
#include <gnomon/kit/add_up.h>

#include "grid.h"

namespace gnomon::two_pass_object {

/// A triangle in a cell.
struct Entry {
  enum class Kind : std::uint8_t {
    absent,
    lit,
    dark,
    pieces,
    asks
  };  ///< absent: not a receiver; asks: every point is decided by exact signs
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

/// Work of making a map. `lit` and `shadowed` are the fragments that clipping leaves and takes away.
struct Work {
  std::uint64_t cells = 0, pairs_tested = 0, pairs_clipped = 0, splits = 0, lit = 0, shadowed = 0, near = 0;
  std::uint64_t hidden = 0;  ///< triangles beyond what covers their places in a cell: no fragments, for they are not clipped
  Work& operator+=(const Work& w) {
    return add_up(*this, w, &Work::cells, &Work::pairs_tested, &Work::pairs_clipped, &Work::splits, &Work::lit, &Work::shadowed,
                  &Work::near, &Work::hidden);
  }
};

}  // namespace gnomon::two_pass_object
