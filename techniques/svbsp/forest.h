#pragma once
#include <cmath>

#include "builder.h"

namespace gnomon::svbsp {

/// Equal tiles over what a light sees of the casters on one face, each with a tree of its own; a single one where there are no
/// tiles.
struct Grid {
  glm::dvec2 low{0}, high{0}, step{0}, per_step{0};  ///< per_step is 1 / step
  int columns = 0, rows = 0;
  std::uint32_t first = 0;  ///< tile, of all faces

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

/// The SVBSP trees of a light: one for each tile of each face.
class Forest {
 public:
  enum class Order { tiles, bsp, face_planes };

  /// `extent` is the largest coordinate of the casters, in meters. On all threads; the outcome does not depend on their number.
  void grow(const ProjectedSpace& space, const Pieces& pieces, const Facing& facing, Order order, Rules rules, double extent);

  /// For a point of light space: its tile's tree, or an OUT cell where there are no tiles. A cut at the border of a face
  /// rounds, and so may end the tiles just before a point on that border.
  Query query(int face, const glm::dvec3& p) const {
    const Grid& grid = grids_[face];
    Query query{.x = p.x, .y = p.y, .nodes = nullptr, .link = out_cell};
    if (grid.is_empty() || !grid.holds(p, epsilon_.across)) return query;
    const std::uint32_t tile = grid.tile(grid.column(p.x), grid.row(p.y));
    query.nodes = nodes(tile).data();
    query.link = roots_[tile];
    return query;
  }

  const Grid& grid(int face) const { return grids_[face]; }
  const std::vector<Node>& nodes(std::uint32_t tile) const { return bins_[tile / bin_size].nodes; }
  Link root(std::uint32_t tile) const { return roots_[tile]; }
  const Epsilons& epsilon() const { return epsilon_; }

  TreeWork work() const;
  /// Tiles of all grids.
  std::size_t tile_count() const {
    std::size_t sum = 0;
    for (const Grid& grid : grids_) sum += static_cast<std::size_t>(grid.columns) * grid.rows;
    return sum;
  }
  /// Pieces left out of tiles because one covers the tile before them.
  std::uint64_t covered_count() const { return covered_; }
  std::size_t node_count() const;
  std::size_t depth() const;  ///< nodes on the longest way
  std::size_t bytes() const;

 private:
  /// Tiles in a row that share a list of nodes; those of two faces never do.
  static constexpr std::uint32_t bin_size = 64;
  struct Bin {
    std::vector<Node> nodes;
    TreeWork work;
    int face = 0;
  };
  static constexpr double tiles_per_piece = 64;  ///< at most on average: copies of one triangle, say, lie in all tiles

  /// Tiles with `tile_size` pieces on average; one tile for each face where that is 0.
  void lay_grids(const Pieces& pieces, std::size_t tile_size);
  void sort_into_tiles(const Pieces& pieces, double thinnest, std::uint64_t very_many);
  /// Calls visit(tile, low, high) for the tiles of a piece's bounds, with their corners.
  template <class Visit>
  static void for_tiles_of(const Piece& piece, const Grid& grid, const Visit& visit);
  /// Where pieces lie in very many tiles, most are behind others: finds what covers each tile.
  void find_covers(const Pieces& pieces, double epsilon, std::uint64_t very_many);
  bool is_covered(std::uint32_t tile, double nearest) const {
    return !covers_.empty() && nearest < covers_[tile] - 1e-12 * std::abs(covers_[tile]);
  }
  void grow_bin(std::size_t bin, const ProjectedSpace& space, const Pieces& pieces, const Facing& facing, Order order,
                const Rules& rules);

  Grid grids_[6];
  Epsilons epsilon_;
  std::uint32_t end_ = 0;  // of the tiles
  std::vector<Bin> bins_;
  std::vector<Link> roots_;            // of each tile
  std::vector<std::uint32_t> ends_;    // of each tile's pieces, in sorted_
  std::vector<std::uint32_t> sorted_;  // pieces of the tile's face
  std::vector<double> covers_;         // of each tile: z of what covers all of it, where that is farthest; or empty
  std::uint64_t covered_ = 0;
};

}  // namespace gnomon::svbsp
