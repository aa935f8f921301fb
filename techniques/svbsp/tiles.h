#pragma once
#include "pieces.h"

namespace gnomon::svbsp {

/// Equal tiles over what a light sees of the casters on one face, each with a tree of its own; a single one where there are no
/// tiles.
struct Grid {
  glm::dvec2 low{0}, high{0}, step{0}, per_step{0};  ///< per_step is 1 / step
  int columns = 0, rows = 0;
  std::uint32_t first = 0;  ///< tile, of all faces

  bool operator==(const Grid&) const = default;
  /// Takes the borders outwards to multiples of a power of two that is 1/64 to 1/32 of the size: a caster at the border that
  /// moves a little then changes no tile.
  void round_outwards() {
    for (int axis = 0; axis < 2; ++axis) {
      if (!(high[axis] > low[axis])) continue;
      const double unit = std::ldexp(1.0, std::ilogb(high[axis] - low[axis]) - 5);
      low[axis] = std::floor(low[axis] / unit) * unit;
      high[axis] = std::ceil(high[axis] / unit) * unit;
    }
  }
  bool is_empty() const { return columns == 0; }
  /// Borders belong to the grid, and what is as near to them as `epsilon`.
  bool holds(const glm::dvec3& p, double epsilon) const {
    return p.x >= low.x - epsilon && p.x <= high.x + epsilon && p.y >= low.y - epsilon && p.y <= high.y + epsilon;
  }
  int column(double x) const { return std::clamp(static_cast<int>((x - low.x) * per_step.x), 0, columns - 1); }
  int row(double y) const { return std::clamp(static_cast<int>((y - low.y) * per_step.y), 0, rows - 1); }
  std::uint32_t tile(int column, int row) const { return first + static_cast<std::uint32_t>(row * columns + column); }
  double column_side(int k) const { return k == columns ? high.x : low.x + k * step.x; }
  double row_side(int k) const { return k == rows ? high.y : low.y + k * step.y; }
};

/// Calls visit(tile, low, high) for the tiles of a piece's bounds, with their corners.
inline void for_tiles_of(const Piece& piece, const Grid& grid, const auto& visit) {
  const int left = grid.column(piece.low.x), right = grid.column(piece.high.x), bottom = grid.row(piece.high.y);
  for (int row = grid.row(piece.low.y); row <= bottom; ++row)
    for (int column = left; column <= right; ++column)
      visit(grid.tile(column, row), glm::dvec2(grid.column_side(column), grid.row_side(row)),
            glm::dvec2(grid.column_side(column + 1), grid.row_side(row + 1)));
}

}  // namespace gnomon::svbsp
