#pragma once
#include <gnomon/kit/vectorized.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <numeric>

#include "measure/picture/picture.h"

// Private to the perceptual metrics: pictures cut into tiles, and convolutions of a tile.

namespace gnomon {

/// Pixels x0 .. x1-1, y0 .. y1-1.
struct Tile {
  int x0, y0, x1, y1;
  int width() const { return x1 - x0; }
  int height() const { return y1 - y0; }
};

/// Whether two pictures of one size hold the same in the tile and in `reach` pixels around it.
inline bool is_same(const Picture& a, const Picture& b, const Tile& tile, int reach) {
  const int x0 = std::max(0, tile.x0 - reach), x1 = std::min(a.width, tile.x1 + reach);
  for (int y = std::max(0, tile.y0 - reach); y < std::min(a.height, tile.y1 + reach); ++y) {
    const std::size_t begin = (static_cast<std::size_t>(y) * a.width + x0) * 3;
    if (std::memcmp(&a.rgb[begin], &b.rgb[begin], static_cast<std::size_t>(x1 - x0) * 3) != 0) return false;
  }
  return true;
}

/// Sum over the tiles of `area` of `sum(tile)`, in parallel, added up in their order: the same on any number of threads.
template <class Sum>
double sum_over_tiles(const Tile& area, const Sum& sum) {
  constexpr int tile_width = 128, tile_height = 64;
  std::vector<Tile> tiles;
  for (int y = area.y0; y < area.y1; y += tile_height)
    for (int x = area.x0; x < area.x1; x += tile_width)
      tiles.push_back({x, y, std::min(x + tile_width, area.x1), std::min(y + tile_height, area.y1)});
  std::vector<double> sums(tiles.size());
  tbb::parallel_for(std::size_t{0}, tiles.size(), [&](std::size_t k) { sums[k] = sum(tiles[k]); });
  return std::accumulate(sums.begin(), sums.end(), 0.0);
}

/// Numbers of a rectangle, row-major.
template <class T>
struct Layer {
  int width, height;
  std::vector<T> values;
  Layer(int w, int h) : width(w), height(h), values(static_cast<std::size_t>(w) * h) {}
  T* row(int y) { return &values[static_cast<std::size_t>(y) * width]; }
  const T* row(int y) const { return &values[static_cast<std::size_t>(y) * width]; }
};

/// out[x] = sum over k of weights[k] * in[k * step + x], for x below `width`. Weights have an odd number of entries.
template <class T>
[[gnu::always_inline]] inline void convolve_line(const T* in, std::size_t step, const std::vector<T>& weights, int width,
                                                 T* out) {
  constexpr int block = 32;
  int x = 0;
  for (; x + block <= width; x += block) {
    T sums[block] = {};
    for (std::size_t k = 0; k < weights.size(); ++k) {
      const T weight = weights[k];
      const T* from = in + k * step + x;
      for (int i = 0; i < block; ++i) sums[i] += weight * from[i];
    }
    for (int i = 0; i < block; ++i) out[x + i] = sums[i];
  }
  for (; x < width; ++x) {
    T sum = 0;
    for (std::size_t k = 0; k < weights.size(); ++k) sum += weights[k] * in[k * step + x];
    out[x] = sum;
  }
}

/// Rows filtered along x, what has no whole window left away: narrower by weights.size() - 1. `margin` columns are skipped at
/// either end, where the plane is wider than this filter needs.
template <class T>
[[gnu::always_inline]] inline Layer<T> along_x(const Layer<T>& in, const std::vector<T>& weights, int margin = 0) {
  Layer<T> out(in.width - 2 * margin - static_cast<int>(weights.size()) + 1, in.height);
  for (int y = 0; y < in.height; ++y) convolve_line(in.row(y) + margin, 1, weights, out.width, out.row(y));
  return out;
}

/// The same along y.
template <class T>
[[gnu::always_inline]] inline Layer<T> along_y(const Layer<T>& in, const std::vector<T>& weights, int margin = 0) {
  Layer<T> out(in.width, in.height - 2 * margin - static_cast<int>(weights.size()) + 1);
  for (int y = 0; y < out.height; ++y)
    convolve_line(in.row(y + margin), static_cast<std::size_t>(in.width), weights, out.width, out.row(y));
  return out;
}

/// Throws Error when the sizes differ.
void require_same_size(const Picture& a, const Picture& b);

}  // namespace gnomon
