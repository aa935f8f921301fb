#pragma once
#include <gnomon/error.h>
#include <gnomon/kit/random.h>

#include <atomic>
#include <optional>

#include "tiles.h"

namespace gnomon::svbsp {

/// Equal tiles over what a light sees of the casters on one face, each with a tree of its own; a single one where there are no
/// tiles.
struct Grid {
  glm::dvec2 low{0}, high{0}, step{0}, per_step{0};  ///< per_step is 1 / step
  int columns = 0, rows = 0;
  std::uint32_t first = 0;  ///< tile, of all faces

  bool is_empty() const { return columns == 0; }
  bool holds(const glm::dvec3& p) const { return p.x >= low.x && p.x <= high.x && p.y >= low.y && p.y <= high.y; }
  int column(double x) const { return std::clamp(static_cast<int>((x - low.x) * per_step.x), 0, columns - 1); }
  int row(double y) const { return std::clamp(static_cast<int>((y - low.y) * per_step.y), 0, rows - 1); }
  std::uint32_t tile(int column, int row) const { return first + static_cast<std::uint32_t>(row * columns + column); }
  double column_side(int k) const { return k == columns ? high.x : low.x + k * step.x; }
  double row_side(int k) const { return k == rows ? high.y : low.y + k * step.y; }
};

inline void shuffle(std::span<std::uint32_t> items) {
  Random random(1);
  for (std::size_t i = items.size(); i > 1; --i) std::swap(items[i - 1], items[random.below(static_cast<std::uint32_t>(i))]);
}

/// The SVBSP trees of a light: one for each tile of each face.
class Forest {
 public:
  enum class Order { tiles, bsp, face_planes };

  /// `extent` is the largest coordinate of the casters, in meters. On all threads; the outcome does not depend on their number.
  void grow(const LightSpace& space, const Pieces& pieces, const Facing& facing, Order order, Rules rules, double extent);

  /// For a point of light space: its tile's tree, or an OUT cell where there are no tiles.
  Query query(int face, const glm::dvec3& p) const {
    const Grid& grid = grids_[face];
    Query query{.x = p.x, .y = p.y, .nodes = nullptr, .link = out_cell};
    if (grid.is_empty() || !grid.holds(p)) return query;
    const std::uint32_t tile = grid.tile(grid.column(p.x), grid.row(p.y));
    query.nodes = nodes(tile).data(), query.link = roots_[tile];
    return query;
  }

  const Grid& grid(int face) const { return grids_[face]; }
  const std::vector<Node>& nodes(std::uint32_t tile) const { return bins_[tile / bin_size].nodes; }
  Link root(std::uint32_t tile) const { return roots_[tile]; }
  const Epsilons& epsilon() const { return epsilon_; }

  Tally tally() const;
  /// Of the grids.
  std::size_t tile_count() const {
    std::size_t sum = 0;
    for (const Grid& grid : grids_) sum += static_cast<std::size_t>(grid.columns) * grid.rows;
    return sum;
  }
  std::size_t node_count() const;
  std::size_t depth() const;  ///< nodes on the longest way
  std::size_t bytes() const;

 private:
  /// Tiles in a row that share a list of nodes; those of two faces never do.
  static constexpr std::uint32_t bin_size = 64;
  struct Bin {
    std::vector<Node> nodes;
    Tally tally;
    int face = 0;
  };
  static constexpr double tiles_per_piece = 64;  ///< at most on average: copies of one triangle, say, lie in all tiles

  /// Tiles of `tile_size` pieces on average; one a face where that is 0.
  void lay_grids(const Pieces& pieces, std::size_t tile_size);
  void deal(const Pieces& pieces, double thinnest);

  Grid grids_[6];
  Epsilons epsilon_;
  std::uint32_t end_ = 0;  // of the tiles
  std::vector<Bin> bins_;
  std::vector<Link> roots_;           // of each tile
  std::vector<std::uint32_t> ends_;   // of each tile's pieces, in dealt_
  std::vector<std::uint32_t> dealt_;  // pieces of the tile's face
};

inline void Forest::lay_grids(const Pieces& pieces, std::size_t tile_size) {
  std::uint32_t next = 0;
  for (int face = 0; face < 6; ++face) {
    Grid& grid = grids_[face];
    const std::span<const Piece> here = pieces.of_face(face);
    grid = {.low = glm::dvec2(INFINITY), .high = glm::dvec2(-INFINITY), .first = next};
    if (here.empty()) continue;
    glm::dvec2 lengths(0);
    double areas = 0;
    for (const Piece& piece : here) {
      const glm::dvec2 box = piece.high - piece.low;
      grid.low = glm::min(grid.low, piece.low), grid.high = glm::max(grid.high, piece.high);
      lengths += box, areas += box.x * box.y;
    }
    const glm::dvec2 size = glm::max(grid.high - grid.low, glm::dvec2(1e-200));  // of a lone piece without width
    const auto count = static_cast<double>(here.size());
    for (double wanted = tile_size > 0 ? std::min(count / static_cast<double>(tile_size), 0x1p22) : 1;; wanted /= 2) {
      const double most = std::max(wanted, 1.0);
      grid.columns = static_cast<int>(std::clamp(std::sqrt(wanted * size.x / size.y), 1.0, most));
      grid.rows = static_cast<int>(std::max(wanted / grid.columns, 1.0));
      grid.step = size / glm::dvec2(grid.columns, grid.rows);
      // A box reaches into one tile, and over as many borders as it is steps long.
      const glm::dvec2 borders = lengths / grid.step;
      if (wanted <= 1 || count + borders.x + borders.y + areas / (grid.step.x * grid.step.y) <= tiles_per_piece * count) break;
    }
    grid.per_step = 1.0 / grid.step;
    const auto tiles = static_cast<std::uint32_t>(grid.columns) * static_cast<std::uint32_t>(grid.rows);
    next += (tiles + bin_size - 1) / bin_size * bin_size;
  }
  end_ = next;
}

/// Counts, then places; which of two threads comes first changes the places within a tile, so these are sorted in the end.
inline void Forest::deal(const Pieces& pieces, double thinnest) {
  constexpr std::size_t block = 4096;
  ends_.assign(end_ + 1, 0);
  const auto for_tiles = [&](const auto& visit) {
    for (int face = 0; face < 6; ++face) {
      const Grid& grid = grids_[face];
      for_blocks(pieces.of_face(face).size(), block, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
          const Piece& piece = pieces.of_face(face)[i];
          if (is_thin(piece.polygon(), thinnest)) continue;
          const int left = grid.column(piece.low.x), right = grid.column(piece.high.x), bottom = grid.row(piece.high.y);
          for (int row = grid.row(piece.low.y); row <= bottom; ++row)
            for (int column = left; column <= right; ++column)
              visit(std::atomic_ref(ends_[grid.tile(column, row)]), static_cast<std::uint32_t>(i));
        }
      });
    }
  };
  for_tiles([](std::atomic_ref<std::uint32_t> count, std::uint32_t) { count.fetch_add(1, std::memory_order_relaxed); });
  std::uint64_t sum = 0;
  for (std::uint32_t& count : ends_) sum += std::exchange(count, static_cast<std::uint32_t>(sum));
  if (sum > 0xffffffffu) throw Error("polygons in {} tiles are beyond {}", sum, 0xffffffffu);
  dealt_.resize(sum);
  for_tiles(
      [&](std::atomic_ref<std::uint32_t> next, std::uint32_t i) { dealt_[next.fetch_add(1, std::memory_order_relaxed)] = i; });
}

inline void Forest::grow(const LightSpace& space, const Pieces& pieces, const Facing& facing, Order order, Rules rules,
                         double extent) {
  lay_grids(pieces, order == Order::tiles ? rules.tile_size : 0);
  glm::dvec2 size(0);
  for (const Grid& grid : grids_)
    if (!grid.is_empty()) size = glm::max(size, grid.high - grid.low);
  epsilon_ = rules.epsilon = space.epsilons(std::max(size.x, size.y), extent);
  rules.is_ordered = order == Order::bsp;
  deal(pieces, epsilon_.across);

  roots_.assign(end_, out_cell);
  bins_.resize(end_ / bin_size);
  for (int face = 0; face < 6; ++face)
    for (std::uint32_t tile = grids_[face].first; tile < (face < 5 ? grids_[face + 1].first : end_); tile += bin_size)
      bins_[tile / bin_size].face = face;
  for_blocks(bins_.size(), 1, [&](std::size_t b, std::size_t) {
    Bin& bin = bins_[b];
    bin.nodes.clear();
    bin.tally = {};
    const Grid& grid = grids_[bin.face];
    const std::span<const Piece> here = pieces.of_face(bin.face);
    const auto plane = [&](std::uint32_t triangle) { return facing.plane(space, bin.face, triangle); };
    Tiler tiler(space, rules, plane, bin.nodes, bin.tally);
    Builder builder(space, rules, plane, bin.nodes, bin.tally);
    for (std::uint32_t tile = static_cast<std::uint32_t>(b) * bin_size; tile < (b + 1) * bin_size; ++tile) {
      const std::span<std::uint32_t> dealt{dealt_.data() + (tile == 0 ? 0 : ends_[tile - 1]), dealt_.data() + ends_[tile]};
      if (dealt.empty()) continue;
      std::ranges::sort(dealt);
      if (order == Order::tiles) {
        const int column = static_cast<int>(tile - grid.first) % grid.columns,
                  row = static_cast<int>(tile - grid.first) / grid.columns;
        const glm::dvec2 low(grid.column_side(column), grid.row_side(row)),
            high(grid.column_side(column + 1), grid.row_side(row + 1));
        roots_[tile] = tiler.grow(here, dealt, low, high);
      } else {
        if (order == Order::face_planes) shuffle(dealt);
        builder.start();
        for (const std::uint32_t i : dealt) builder.add(here[i].polygon(), here[i].triangle, roots_[tile]);
      }
    }
  });
}

inline Tally Forest::tally() const {
  Tally sum;
  for (const Bin& bin : bins_) sum += bin.tally;
  return sum;
}

inline std::size_t Forest::node_count() const {
  std::size_t sum = 0;
  for (const Bin& bin : bins_) sum += bin.nodes.size();
  return sum;
}

inline std::size_t Forest::depth() const {
  std::size_t deepest = 0;
  std::vector<std::uint32_t> depths;
  for (const Bin& bin : bins_) {
    depths.assign(bin.nodes.size(), 1);
    for (std::size_t i = 0; i < bin.nodes.size(); ++i) {  // children come after their parents
      deepest = std::max<std::size_t>(deepest, depths[i]);
      for (const Link link : bin.nodes[i].sides)
        if (link >= 0) depths[link] = depths[i] + 1;
    }
  }
  return deepest;
}

inline std::size_t Forest::bytes() const {
  std::size_t sum = bins_.capacity() * sizeof(Bin) + roots_.capacity() * sizeof(Link) +
                    (ends_.capacity() + dealt_.capacity()) * sizeof(std::uint32_t);
  for (const Bin& bin : bins_) sum += bin.nodes.capacity() * sizeof(Node);
  return sum;
}

}  // namespace gnomon::svbsp
