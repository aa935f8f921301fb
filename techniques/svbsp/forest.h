#pragma once
#include <gnomon/error.h>
#include <gnomon/kit/random.h>

#include <array>
#include <atomic>

#include "builder.h"
#include "tiles.h"

namespace gnomon::svbsp {

/// The SVBSP trees of a light: one for each tile of each face.
class Forest {
 public:
  enum class Order { tiles, bsp, face_planes };  ///< as svbsp.order has them

  /// Marks the tiles where something will have moved, before its pieces are made anew.
  void leave(const Pieces& pieces, const Moved& moved) {
    touched_.assign(end_, 0);
    touch(pieces, moved);
  }

  /// `extent` is the largest coordinate of the casters, in meters. On all threads; the outcome does not depend on their number.
  /// Where it is known what moved, and `leave` was told before, the trees of tiles in which nothing moved stay. They are those
  /// that would be grown.
  void grow(const ProjectedSpace& space, const Pieces& pieces, const Facing& facing, Order order, Rules rules, double extent,
            const Moved& moved = {}) {
    rules.is_followed &= order == Order::tiles;
    const std::array<Grid, 6> grids = grids_;
    lay_grids(pieces, order == Order::tiles ? rules.tile_size : 0, rules.is_followed);
    glm::dvec2 size(0);
    for (const Grid& grid : grids_)
      if (!grid.is_empty()) size = glm::max(size, grid.high - grid.low);
    epsilon_ = rules.epsilon = space.epsilons(std::max(size.x, size.y), extent);
    rules.is_ordered = order == Order::bsp;
    bool keeps = rules.is_followed && !moved.empty() && !touched_.empty() && grids_ == grids && rules == rules_;
    keeps &= covers_.empty();
    sort_into_tiles(pieces, epsilon_.across, rules.very_many);
    keeps &= covers_.empty();
    rules_ = rules;

    kept_count_ = 0;
    if (keeps) {
      touch(pieces, moved);
      kept_count_ = tile_count() - static_cast<std::size_t>(std::ranges::count(touched_, 1));
    } else {
      touched_.clear();
      roots_.assign(end_, out_cell);
      tiles_.resize(rules.is_followed ? end_ : 0);
    }
    bins_.resize(end_ / bin_size);
    for (int face = 0; face < 6; ++face)
      for (std::uint32_t tile = grids_[face].first; tile < (face < 5 ? grids_[face + 1].first : end_); tile += bin_size)
        bins_[tile / bin_size].face = face;
    for_blocks(bins_.size(), 1, [&](std::size_t bin, std::size_t) { grow_bin(bin, space, pieces, facing, order, rules); });
    touched_.clear();
  }

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

  TreeWork work() const {
    TreeWork sum;
    sum.hidden = covered_;
    for (const Bin& bin : bins_) sum += bin.work;
    return sum;
  }
  /// Tiles of all grids.
  std::size_t tile_count() const {
    std::size_t sum = 0;
    for (const Grid& grid : grids_) sum += static_cast<std::size_t>(grid.columns) * grid.rows;
    return sum;
  }
  /// Tiles that the last growth kept as they were.
  std::size_t kept_tile_count() const { return kept_count_; }
  /// Pieces left out of tiles because one covers the tile before them.
  std::uint64_t covered_count() const { return covered_; }
  std::size_t node_count() const {
    std::size_t sum = 0;
    for (const Bin& bin : bins_) sum += bin.nodes.size();
    return sum;
  }
  /// Nodes on the longest way.
  std::size_t depth() const {
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

  std::size_t bytes() const {
    std::size_t sum = bytes_of(bins_, roots_, tiles_, ends_, sorted_, covers_);
    for (const Bin& bin : bins_) sum += bytes_of(bin.nodes);
    return sum;
  }

 private:
  /// Tiles in a row that share a list of nodes; those of two faces never do.
  static constexpr std::uint32_t bin_size = 64;
  static constexpr std::size_t piece_block = 4096;
  struct Bin {
    std::vector<Node> nodes;
    TreeWork work;
    int face = 0;
  };
  /// What is remembered of a tile where the scene moves.
  struct Tile {
    std::size_t first = 0;  ///< node of its bin; its nodes are those up to the next tile's
    TreeWork work;
  };
  static constexpr double tiles_per_piece = 64;  ///< at most on average: copies of one triangle, say, lie in all tiles

  void touch(const Pieces& pieces, const Moved& moved) {
    for (int face = 0; face < 6; ++face)
      for (const Piece& piece : pieces.of_face(face))
        if (moved(piece.triangle))
          for_tiles_of(piece, grids_[face],
                       [&](std::uint32_t tile, const glm::dvec2&, const glm::dvec2&) { touched_[tile] = 1; });
  }

  /// Tiles with `tile_size` pieces on average; one tile for each face where that is 0.
  void lay_grids(const Pieces& pieces, std::size_t tile_size, bool is_followed) {
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
        grid.low = glm::min(grid.low, piece.low);
        grid.high = glm::max(grid.high, piece.high);
        lengths += box;
        areas += box.x * box.y;
      }
      if (is_followed) grid.round_outwards();
      const glm::dvec2 size = glm::max(grid.high - grid.low, glm::dvec2(1e-200));  // of a lone piece without width
      const auto count = static_cast<double>(here.size());
      for (double wanted = tile_size > 0 ? std::min(count / static_cast<double>(tile_size), 0x1p22) : 1;; wanted /= 2) {
        const double most = std::max(wanted, 1.0);
        grid.columns = static_cast<int>(std::clamp(std::sqrt(wanted * size.x / size.y), 1.0, most));
        grid.rows = static_cast<int>(std::max(wanted / grid.columns, 1.0));
        grid.step = size / glm::dvec2(grid.columns, grid.rows);
        // A box reaches into one tile, and over as many borders as it is steps long.
        const glm::dvec2 borders = lengths / grid.step;
        const double reached = count + borders.x + borders.y + areas / (grid.step.x * grid.step.y);
        if (wanted <= 1 || reached <= tiles_per_piece * count) break;
      }
      grid.per_step = 1.0 / grid.step;
      const auto tiles = static_cast<std::uint32_t>(grid.columns) * static_cast<std::uint32_t>(grid.rows);
      next += (tiles + bin_size - 1) / bin_size * bin_size;
    }
    end_ = next;
  }

  /// Counts, then places; which of two threads comes first changes the places within a tile, so these are sorted in the end.
  void sort_into_tiles(const Pieces& pieces, double thinnest, std::uint64_t very_many) {
    find_covers(pieces, 4 * thinnest, very_many);
    ends_.assign(end_ + 1, 0);
    std::atomic<std::uint64_t> covered = 0;
    const auto for_tiles = [&](const auto& visit) {
      for (int face = 0; face < 6; ++face)
        for_blocks(pieces.of_face(face).size(), piece_block, [&](std::size_t begin, std::size_t end) {
          std::uint64_t left_out = 0;
          for (std::size_t i = begin; i < end; ++i) {
            const Piece& piece = pieces.of_face(face)[i];
            if (is_thin(piece.polygon(), thinnest)) continue;
            for_tiles_of(piece, grids_[face], [&](std::uint32_t tile, const glm::dvec2& low, const glm::dvec2& high) {
              if (is_covered(tile, piece.nearest(low, high)))
                ++left_out;
              else
                visit(std::atomic_ref(ends_[tile]), static_cast<std::uint32_t>(i));
            });
          }
          covered += left_out;
        });
    };
    for_tiles([](std::atomic_ref<std::uint32_t> count, std::uint32_t) { count.fetch_add(1, std::memory_order_relaxed); });
    covered_ = covered;
    std::uint64_t sum = 0;
    for (std::uint32_t& count : ends_) sum += std::exchange(count, static_cast<std::uint32_t>(sum));
    if (sum > 0xffffffffu) throw Error("polygons in {} tiles are beyond {}", sum, 0xffffffffu);
    sorted_.resize(sum);
    for_tiles([&](std::atomic_ref<std::uint32_t> next, std::uint32_t i) {
      sorted_[next.fetch_add(1, std::memory_order_relaxed)] = i;
    });
  }

  /// Where pieces lie in very many tiles, most are behind others: finds what covers each tile.
  void find_covers(const Pieces& pieces, double epsilon, std::uint64_t very_many) {
    covers_.clear();
    std::uint64_t sum = 0;
    for (int face = 0; face < 6; ++face)
      for (const Piece& piece : pieces.of_face(face)) {
        const Grid& grid = grids_[face];
        sum += static_cast<std::uint64_t>(grid.column(piece.high.x) - grid.column(piece.low.x) + 1) *
               static_cast<std::uint64_t>(grid.row(piece.high.y) - grid.row(piece.low.y) + 1);
      }
    if (sum <= very_many) return;
    covers_.assign(end_, -INFINITY);
    for (int face = 0; face < 6; ++face)
      for_blocks(pieces.of_face(face).size(), piece_block, [&](std::size_t begin, std::size_t end) {
        std::vector<glm::dvec3> sides;  // of a piece: at least epsilon inside of it dot(side, (x, y, 1)) is positive
        for (const Piece& piece : pieces.of_face(face).subspan(begin, end - begin)) {
          sides.clear();
          for (std::size_t i = 0; i < piece.count; ++i) {
            const glm::dvec2 a(piece.corners[i].at), along = glm::dvec2(piece.corners[(i + 1) % piece.count].at) - a;
            const glm::dvec2 inward = glm::dvec2(-along.y, along.x) / glm::length(along);
            sides.emplace_back(inward, -glm::dot(inward, a) - epsilon);
          }
          for_tiles_of(piece, grids_[face], [&](std::uint32_t tile, const glm::dvec2& low, const glm::dvec2& high) {
            const auto least = [&](const glm::dvec3& rise) {
              return std::min(rise.x * low.x, rise.x * high.x) + std::min(rise.y * low.y, rise.y * high.y) + rise.z;
            };
            if (!std::ranges::all_of(sides, [&](const glm::dvec3& side) { return least(side) > 0; })) return;
            const std::atomic_ref cover(covers_[tile]);
            const double farthest = least(piece.rise);
            for (double known = cover; farthest > known && !cover.compare_exchange_weak(known, farthest);) {
            }
          });
        }
      });
  }

  bool is_covered(std::uint32_t tile, double nearest) const {
    return !covers_.empty() && nearest < covers_[tile] - 1e-12 * std::abs(covers_[tile]);
  }
  void grow_bin(std::size_t number, const ProjectedSpace& space, const Pieces& pieces, const Facing& facing, Order order,
                const Rules& rules) {
    const std::uint32_t first = static_cast<std::uint32_t>(number) * bin_size;
    const bool keeps = !touched_.empty();
    if (keeps && std::none_of(&touched_[first], &touched_[first] + bin_size, [](std::uint8_t touched) { return touched; }))
      return;
    Bin& bin = bins_[number];
    std::vector<Node> before;
    if (keeps) before.swap(bin.nodes);
    bin.nodes.clear();
    bin.work = {};
    TreeWork work;  // of one tile
    const Grid& grid = grids_[bin.face];
    const std::span<const Piece> here = pieces.of_face(bin.face);
    const auto plane = [&](std::uint32_t triangle) { return facing.plane(space, bin.face, triangle); };
    Tiler tiler(space, rules, plane, bin.nodes, work);
    Builder builder(space, rules, plane, bin.nodes, work);
    for (std::uint32_t tile = first; tile < first + bin_size; ++tile) {
      if (keeps && touched_[tile] == 0) {
        keep(tile, before, bin);
        continue;
      }
      roots_[tile] = out_cell;
      if (rules.is_followed) tiles_[tile] = {bin.nodes.size(), {}};
      const std::span<std::uint32_t> items{sorted_.data() + (tile == 0 ? 0 : ends_[tile - 1]), sorted_.data() + ends_[tile]};
      if (items.empty()) continue;
      work = {};
      std::ranges::sort(items);
      if (order == Order::tiles) {
        const int column = static_cast<int>(tile - grid.first) % grid.columns,
                  row = static_cast<int>(tile - grid.first) / grid.columns;
        const glm::dvec2 low(grid.column_side(column), grid.row_side(row)),
            high(grid.column_side(column + 1), grid.row_side(row + 1));
        roots_[tile] = tiler.grow(here, items, low, high);
      } else {
        if (order == Order::face_planes) Random(1).shuffle(items);
        builder.start();
        for (const std::uint32_t i : items) builder.add(here[i].polygon(), here[i].triangle, roots_[tile]);
      }
      bin.work += work;
      if (rules.is_followed) tiles_[tile].work = work;
    }
  }

  /// Takes over the tree of a tile from the nodes that its bin had before.
  void keep(std::uint32_t tile, const std::vector<Node>& before, Bin& bin) {
    const std::size_t first = tiles_[tile].first, last = (tile + 1) % bin_size == 0 ? before.size() : tiles_[tile + 1].first;
    const Link shift = next_link(bin.nodes) - static_cast<Link>(first);
    for (std::size_t i = first; i < last; ++i) {
      bin.nodes.push_back(before[i]);
      for (Link& link : bin.nodes.back().sides)
        if (link >= 0) link += shift;
    }
    if (roots_[tile] >= 0) roots_[tile] += shift;
    tiles_[tile].first = bin.nodes.size() - (last - first);
    bin.work += tiles_[tile].work;
  }

  std::array<Grid, 6> grids_;
  Rules rules_;  // of the last growth
  Epsilons epsilon_;
  std::uint32_t end_ = 0;  // of the tiles
  std::vector<Bin> bins_;
  std::vector<Link> roots_;            // of each tile
  std::vector<Tile> tiles_;            // of each tile, where the scene moves
  std::vector<std::uint8_t> touched_;  // of each tile, whether something in it moved; empty where all are grown
  std::vector<std::uint32_t> ends_;    // of each tile's pieces, in sorted_
  std::vector<std::uint32_t> sorted_;  // pieces of the tile's face
  std::vector<double> covers_;         // of each tile: z of what covers all of it, where that is farthest; or empty
  std::uint64_t covered_ = 0;
  std::size_t kept_count_ = 0;
};

}  // namespace gnomon::svbsp
