#include "forest.h"

#include <gnomon/error.h>
#include <gnomon/kit/parallel.h>
#include <gnomon/kit/random.h>

#include <atomic>
#include <cmath>

#include "tiles.h"

namespace gnomon::svbsp {

constexpr std::size_t piece_block = 4096;

void Forest::lay_grids(const Pieces& pieces, std::size_t tile_size) {
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

template <class Visit>
void Forest::for_tiles_of(const Piece& piece, const Grid& grid, const Visit& visit) {
  const int left = grid.column(piece.low.x), right = grid.column(piece.high.x), bottom = grid.row(piece.high.y);
  for (int row = grid.row(piece.low.y); row <= bottom; ++row)
    for (int column = left; column <= right; ++column)
      visit(grid.tile(column, row), glm::dvec2(grid.column_side(column), grid.row_side(row)),
            glm::dvec2(grid.column_side(column + 1), grid.row_side(row + 1)));
}

void Forest::find_covers(const Pieces& pieces, double epsilon, std::uint64_t very_many) {
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

/// Counts, then places; which of two threads comes first changes the places within a tile, so these are sorted in the end.
void Forest::sort_into_tiles(const Pieces& pieces, double thinnest, std::uint64_t very_many) {
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
  for_tiles(
      [&](std::atomic_ref<std::uint32_t> next, std::uint32_t i) { sorted_[next.fetch_add(1, std::memory_order_relaxed)] = i; });
}

void Forest::grow(const ProjectedSpace& space, const Pieces& pieces, const Facing& facing, Order order, Rules rules,
                  double extent) {
  lay_grids(pieces, order == Order::tiles ? rules.tile_size : 0);
  glm::dvec2 size(0);
  for (const Grid& grid : grids_)
    if (!grid.is_empty()) size = glm::max(size, grid.high - grid.low);
  epsilon_ = rules.epsilon = space.epsilons(std::max(size.x, size.y), extent);
  rules.is_ordered = order == Order::bsp;
  sort_into_tiles(pieces, epsilon_.across, rules.very_many);

  roots_.assign(end_, out_cell);
  bins_.resize(end_ / bin_size);
  for (int face = 0; face < 6; ++face)
    for (std::uint32_t tile = grids_[face].first; tile < (face < 5 ? grids_[face + 1].first : end_); tile += bin_size)
      bins_[tile / bin_size].face = face;
  for_blocks(bins_.size(), 1, [&](std::size_t bin, std::size_t) { grow_bin(bin, space, pieces, facing, order, rules); });
}

void Forest::grow_bin(std::size_t b, const ProjectedSpace& space, const Pieces& pieces, const Facing& facing, Order order,
                      const Rules& rules) {
  Bin& bin = bins_[b];
  bin.nodes.clear();
  bin.work = {};
  const Grid& grid = grids_[bin.face];
  const std::span<const Piece> here = pieces.of_face(bin.face);
  const auto plane = [&](std::uint32_t triangle) { return facing.plane(space, bin.face, triangle); };
  Tiler tiler(space, rules, plane, bin.nodes, bin.work);
  Builder builder(space, rules, plane, bin.nodes, bin.work);
  for (std::uint32_t tile = static_cast<std::uint32_t>(b) * bin_size; tile < (b + 1) * bin_size; ++tile) {
    const std::span<std::uint32_t> items{sorted_.data() + (tile == 0 ? 0 : ends_[tile - 1]), sorted_.data() + ends_[tile]};
    if (items.empty()) continue;
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
  }
}

TreeWork Forest::work() const {
  TreeWork sum;
  sum.hidden = covered_;
  for (const Bin& bin : bins_) sum += bin.work;
  return sum;
}

std::size_t Forest::node_count() const {
  std::size_t sum = 0;
  for (const Bin& bin : bins_) sum += bin.nodes.size();
  return sum;
}

std::size_t Forest::depth() const {
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

std::size_t Forest::bytes() const {
  std::size_t sum = bytes_of(bins_, roots_, ends_, sorted_, covers_);
  for (const Bin& bin : bins_) sum += bytes_of(bin.nodes);
  return sum;
}

}  // namespace gnomon::svbsp
