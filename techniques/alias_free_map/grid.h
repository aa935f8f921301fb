#pragma once
#include <gnomon/gbuffer.h>
#include <gnomon/kit/bins.h>

#include <array>

#include "footprint.h"

namespace gnomon::alias_free_map {

/// A block of `Grid::cells` x `Grid::cells` cells with their samples, which are consecutive: row after row of cells, each row
/// from left to right. One thread owns a tile.
struct Tile {
  int face, column, row;                                                               ///< the first cell
  std::uint32_t first = 0, count = 0;                                                  ///< samples that are still lit
  float x0 = INFINITY, x1 = -INFINITY, y0 = INFINITY, y1 = -INFINITY, z1 = -INFINITY;  ///< a box around them and the farthest z
  double reach = 0;                                                                    ///< more than their largest distance
};

/// The view samples of a G-buffer that face the light, in a grid of cells on the faces of the light. The grid is fitted to the
/// samples, so the view decides where cells are.
class Grid {
 public:
  /// Cells of the faces, and how places become cells: monotonous in x and y, so that a box of places is a box of cells.
  struct Face {
    double x0 = 0, y0 = 0, columns_per_x = 0, rows_per_y = 0, column_width = 0, row_height = 0;
    double rounding = 0;  ///< more than that of any place
    int columns = 0, rows = 0, tile_columns = 0, tile_rows = 0;
    std::uint32_t first_tile = 0;
    bool empty() const { return columns == 0; }
    int column(double x) const { return clamped((x - x0) * columns_per_x, columns); }
    int row(double y) const { return clamped((y - y0) * rows_per_y, rows); }
    static int clamped(double v, int count) { return v > 0 ? v < count ? static_cast<int>(v) : count - 1 : 0; }
  };

  /// Takes the samples in. `resolution` squared is about the number of cells of all faces.
  void fill(const Scene& scene, const GBuffer& gbuffer, const Light& light, const LightSpace& space, int resolution);

  int cells() const { return cells_; }
  const Face& face(int k) const { return faces_[k]; }
  std::span<const Tile> tiles() const { return tiles_; }
  Tile& tile(std::size_t k) { return tiles_[k]; }
  /// Of the cells of a tile, row after row: the first sample of each; one more ends the last.
  std::uint32_t* cell_begins(std::size_t tile) { return begins_.data() + tile * begins_per_tile(); }
  std::size_t begins_per_tile() const { return static_cast<std::size_t>(cells_) * cells_ + 1; }

  /// Of the samples. Reading `lanes` of them from anywhere in a tile stays in the tile's memory.
  static constexpr std::uint32_t lanes = 4;
  double* x() { return x_.data(); }
  double* y() { return y_.data(); }
  double* z() { return z_.data(); }
  std::uint32_t* pixel() { return pixel_.data(); }
  std::size_t capacity() const { return x_.size(); }  ///< places of samples

  /// Forgets the samples of a tile for which dark[sample] is set.
  void remove_dark(std::size_t tile, std::span<std::uint8_t> dark);

  std::size_t sample_count() const { return bins_.items.size(); }
  std::size_t used_cell_count() const { return used_cells_; }
  std::size_t longest_list() const { return longest_; }
  std::size_t bytes() const { return bytes_of(face_of_, tile_of_, tiles_, begins_, x_, y_, z_, pixel_) + bins_.bytes(); }

 private:
  static constexpr std::uint32_t no_tile = 0xffffffffu;
  static constexpr std::size_t block = 8192;
  void fit(const GBuffer& gbuffer, const LightSpace& space, int resolution);
  struct Fill {
    std::size_t used_cells = 0, longest = 0;
  };
  Fill sort_tile(std::size_t tile, const GBuffer& gbuffer, const LightSpace& space);

  int cells_ = 0;
  Face faces_[6];
  std::vector<std::int8_t> face_of_;    // of each pixel; -1: not asked
  std::vector<std::uint32_t> tile_of_;  // of each pixel
  Bins bins_;                           // pixels to tiles
  std::vector<Tile> tiles_;
  std::vector<std::uint32_t> begins_;
  std::vector<double> x_, y_, z_;
  std::vector<std::uint32_t> pixel_;
  std::size_t used_cells_ = 0, longest_ = 0;
};

}  // namespace gnomon::alias_free_map
