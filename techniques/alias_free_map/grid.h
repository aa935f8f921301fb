#pragma once
#include <gnomon/gbuffer.h>
#include <gnomon/kit/bins.h>

#include "footprint.h"

namespace gnomon::alias_free_map {

/// A block of `Grid::cells` x `Grid::cells` cells with their samples, which are consecutive: row after row of cells, each row
/// from left to right. One thread owns a tile.
struct Tile {
  int face, column, row;                     ///< the first cell
  std::uint32_t first = 0, count = 0;        ///< samples that are still lit
  glm::vec2 low{INFINITY}, high{-INFINITY};  ///< a box around their places
  float z1 = -INFINITY;                      ///< the farthest z
  double reach = 0;                          ///< more than their largest distance
};

/// The view samples of a G-buffer that face the light, in a grid of cells on the faces of the light. The grid is fitted to the
/// samples, so the view decides where cells are.
class Grid {
 public:
  /// Cells of the faces, and how places become cells: monotonous in x and y, so that a box of places is a box of cells.
  struct Face {
    glm::dvec2 low{0}, cells_per_place{0}, cell_size{0};  ///< x: of columns, y: of rows
    double rounding = 0;                                  ///< more than that of any place
    int columns = 0, rows = 0, tile_columns = 0, tile_rows = 0;
    std::uint32_t first_tile = 0;
    bool empty() const { return columns == 0; }
    int column(double x) const { return clamped((x - low.x) * cells_per_place.x, columns); }
    int row(double y) const { return clamped((y - low.y) * cells_per_place.y, rows); }
    static int clamped(double v, int count) { return v > 0 ? v < count ? static_cast<int>(v) : count - 1 : 0; }
  };

  /// Takes the samples in. `resolution` squared is about the number of cells of all faces.
  void fill(const Scene& scene, const GBuffer& gbuffer, const Light& light, const LightSpace& space, int resolution) {
    face_of_.resize(gbuffer.size());
    tile_of_.resize(gbuffer.size());
    for_blocks(gbuffer.size(), block, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i)
        face_of_[i] = faces_light(scene, gbuffer, light, i) ? static_cast<std::int8_t>(space.face_of(gbuffer.position(i)))
                                                            : std::int8_t{-1};
    });
    fit(gbuffer, space, resolution);

    for_blocks(gbuffer.size(), block, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        tile_of_[i] = no_tile;
        if (face_of_[i] < 0) continue;
        const Face& f = faces_[face_of_[i]];
        const glm::dvec2 place = space[face_of_[i]].place_of(gbuffer.position(i));
        tile_of_[i] =
            f.first_tile + static_cast<std::uint32_t>(f.row(place.y) / cells_ * f.tile_columns + f.column(place.x) / cells_);
      }
    });
    sort_into_bins(gbuffer.size(), block, tiles_.size(), bins_, [&](std::size_t i, auto&& visit) {
      if (tile_of_[i] != no_tile) visit(tile_of_[i]);
    });

    std::uint32_t places = 0;
    for (std::size_t t = 0; t < tiles_.size(); ++t) {
      tiles_[t].first = places;
      places += static_cast<std::uint32_t>(bins_.of(t).size()) + lanes;
    }
    for (std::vector<double>* const values : {&x_, &y_, &z_}) resize_exactly(*values, places);
    resize_exactly(pixel_, places);
    resize_exactly(begins_, tiles_.size() * begins_per_tile());
    std::vector<Fill> fills(tiles_.size());
    for_blocks(tiles_.size(), 4, [&](std::size_t begin, std::size_t end) {
      for (std::size_t t = begin; t < end; ++t) fills[t] = sort_tile(t, gbuffer, space);
    });
    used_cells_ = longest_ = 0;
    for (const Fill& fill : fills) {
      used_cells_ += fill.used_cells;
      longest_ = std::max(longest_, fill.longest);
    }
  }

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
  void remove_dark(std::size_t t, std::span<std::uint8_t> dark) {
    Tile& tile = tiles_[t];
    std::uint32_t* const begins = cell_begins(t);
    tile.z1 = -INFINITY;
    std::uint32_t next = tile.first;
    for (std::size_t c = 0; c + 1 < begins_per_tile(); ++c) {
      const std::uint32_t begin = begins[c], end = begins[c + 1];
      begins[c] = next;
      for (std::uint32_t k = begin; k < end; ++k) {
        if (dark[k]) continue;
        x_[next] = x_[k];
        y_[next] = y_[k];
        z_[next] = z_[k];
        pixel_[next] = pixel_[k];
        dark[next++] = 0;
        tile.z1 = std::max(tile.z1, static_cast<float>(z_[k]));
      }
    }
    begins[begins_per_tile() - 1] = next;
    tile.count = next - tile.first;
  }

  std::size_t sample_count() const { return bins_.items.size(); }
  std::size_t used_cell_count() const { return used_cells_; }
  std::size_t longest_list() const { return longest_; }
  std::size_t bytes() const { return bytes_of(face_of_, tile_of_, tiles_, begins_, x_, y_, z_, pixel_) + bins_.bytes(); }

 private:
  /// Without the room beyond that growth would add; the contents are open.
  template <class Vector>
  static void resize_exactly(Vector& vector, std::size_t size) {
    if (vector.capacity() < size) vector = Vector();
    vector.resize(size);
  }
  static constexpr std::uint32_t no_tile = 0xffffffffu;
  static constexpr std::size_t block = 8192;
  /// A face gets the share of the cells that it has of the samples, and cells about as wide as high.
  void fit(const GBuffer& gbuffer, const LightSpace& space, int resolution) {
    struct Extent {
      glm::dvec2 low{INFINITY}, high{-INFINITY};
      std::size_t count = 0;
    };
    std::vector<std::array<Extent, 6>> extents((gbuffer.size() + block - 1) / block);
    for_blocks(gbuffer.size(), block, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        if (face_of_[i] < 0) continue;
        Extent& e = extents[begin / block][face_of_[i]];
        const glm::dvec2 place = space[face_of_[i]].place_of(gbuffer.position(i));
        e.low = glm::min(e.low, place);
        e.high = glm::max(e.high, place);
        ++e.count;
      }
    });
    Extent total[6];
    std::size_t samples = 0;
    for (const auto& of_block : extents)
      for (int k = 0; k < 6; ++k) {
        total[k].low = glm::min(total[k].low, of_block[k].low);
        total[k].high = glm::max(total[k].high, of_block[k].high);
        total[k].count += of_block[k].count;
        samples += of_block[k].count;
      }

    cells_ = std::clamp(resolution / 32, 4, 128);
    tiles_.clear();
    for (int k = 0; k < 6; ++k) {
      Face& f = faces_[k] = {};
      if (total[k].count == 0) continue;
      const double share = std::sqrt(static_cast<double>(total[k].count) / static_cast<double>(samples)) * resolution;
      const glm::dvec2 size = total[k].high - total[k].low;
      const double stretch = size.x > 0 && size.y > 0 ? std::clamp(std::sqrt(size.x / size.y), 0.25, 4.0) : 1;
      f.columns = std::max(1, static_cast<int>(std::lround(share * stretch)));
      f.rows = std::max(1, static_cast<int>(std::lround(share / stretch)));
      f.low = total[k].low;
      f.cells_per_place = {size.x > 0 ? f.columns / size.x : 0, size.y > 0 ? f.rows / size.y : 0};
      f.cell_size = size / glm::dvec2(f.columns, f.rows);
      f.rounding = 0x1p-40 * std::max({norm1({total[k].low, 0}), norm1({total[k].high, 0})});
      f.tile_columns = (f.columns + cells_ - 1) / cells_;
      f.tile_rows = (f.rows + cells_ - 1) / cells_;
      f.first_tile = static_cast<std::uint32_t>(tiles_.size());
      for (int row = 0; row < f.tile_rows; ++row)
        for (int column = 0; column < f.tile_columns; ++column)
          tiles_.push_back({.face = k, .column = column * cells_, .row = row * cells_});
    }
  }
  struct Fill {
    std::size_t used_cells = 0, longest = 0;
  };
  Fill sort_tile(std::size_t t, const GBuffer& gbuffer, const LightSpace& space) {
    Tile& tile = tiles_[t];
    const Face& f = faces_[tile.face];
    const LightSpaceFace& face = space[tile.face];
    const std::span<const std::uint32_t> pixels = bins_.of(t);
    std::uint32_t* const begins = cell_begins(t);
    std::fill_n(begins, begins_per_tile(), 0);
    tile.count = static_cast<std::uint32_t>(pixels.size());
    struct Sample {
      glm::dvec3 seen;
      std::uint32_t cell;
    };
    std::vector<Sample> samples(pixels.size());
    for (std::size_t k = 0; k < pixels.size(); ++k) {
      const glm::dvec3 p = face.seen(gbuffer.position(pixels[k]));
      const glm::dvec2 place = face.place(p);
      samples[k] = {p, static_cast<std::uint32_t>((f.row(place.y) - tile.row) * cells_ + f.column(place.x) - tile.column)};
      ++begins[samples[k].cell];
      tile.low = glm::min(tile.low, glm::vec2(place));
      tile.high = glm::max(tile.high, glm::vec2(place));
      tile.z1 = std::max(tile.z1, static_cast<float>(p.z));
      tile.reach = std::max(tile.reach, norm1(p));
    }
    Fill fill;
    std::uint32_t sum = tile.first;
    for (std::size_t c = 0; c < begins_per_tile(); ++c) {
      fill.used_cells += begins[c] > 0;
      fill.longest = std::max<std::size_t>(fill.longest, begins[c]);
      sum += begins[c];
      begins[c] = sum;  // the end of the cell; filling it backward makes it its begin
    }
    for (std::size_t k = pixels.size(); k-- > 0;) {
      const Sample& sample = samples[k];
      const std::uint32_t at = --begins[sample.cell];
      x_[at] = sample.seen.x;
      y_[at] = sample.seen.y;
      z_[at] = sample.seen.z;
      pixel_[at] = pixels[k];
    }
    return fill;
  }

  int cells_ = 0;
  Face faces_[6];
  std::vector<std::int8_t> face_of_;    // of each pixel; -1: it does not face the light
  std::vector<std::uint32_t> tile_of_;  // of each pixel
  Bins bins_;                           // pixels to tiles
  std::vector<Tile> tiles_;
  std::vector<std::uint32_t> begins_;
  std::vector<double> x_, y_, z_;
  std::vector<std::uint32_t> pixel_;
  std::size_t used_cells_ = 0, longest_ = 0;
};

}  // namespace gnomon::alias_free_map
