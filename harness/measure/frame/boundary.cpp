// Where shadow boundaries lie, and how far things are from them.
#include "measure/frame/boundary.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

namespace gnomon {

namespace {

/// For every pixel, the row of the nearest marked pixel of its column, or -1: one sweep down, one up.
std::vector<std::int32_t> nearest_rows(std::span<const std::uint8_t> marked, int width, int height) {
  std::vector<std::int32_t> rows(marked.size());
  const auto at = [width](int x, int y) { return static_cast<std::size_t>(y) * width + x; };
  tbb::parallel_for(tbb::blocked_range<int>(0, width, 64), [&](const tbb::blocked_range<int>& columns) {
    for (int y = 0; y < height; ++y)
      for (int x = columns.begin(); x < columns.end(); ++x)
        rows[at(x, y)] = marked[at(x, y)] ? y : y > 0 ? rows[at(x, y - 1)] : -1;
    for (int y = height - 2; y >= 0; --y)
      for (int x = columns.begin(); x < columns.end(); ++x) {
        const std::int32_t above = rows[at(x, y)], below = rows[at(x, y + 1)];
        if (above < 0 || (below >= 0 && below - y < y - above)) rows[at(x, y)] = below;
      }
  });
  return rows;
}

/// The lower envelope of the parabolas f[q] + (x - q)^2 of one row (Felzenszwalb and Huttenlocher 2012). In double: squares of
/// pixel coordinates above 4096 are no float32 numbers any more.
class Envelope {
 public:
  explicit Envelope(int longest) : f_(longest), end_(longest + 1), base_(longest) {}

  /// Takes the parabolas of row y, then calls use(x, q) for every x with the base q of the lowest one, -1 where there is none.
  template <class Use>
  void scan(const std::int32_t* nearest_row, int y, int n, const Use& use) {
    int k = -1;
    for (int q = 0; q < n; ++q) {
      if (nearest_row[q] < 0) continue;
      f_[q] = static_cast<double>(nearest_row[q] - y) * (nearest_row[q] - y);
      double start = -INFINITY;
      while (k >= 0) {
        const int p = base_[k];
        start = ((f_[q] + static_cast<double>(q) * q) - (f_[p] + static_cast<double>(p) * p)) / (2.0 * (q - p));
        if (start > end_[k]) break;
        --k;
      }
      base_[++k] = q;
      end_[k] = k == 0 ? -INFINITY : start;
    }
    end_[k + 1] = INFINITY;
    for (int x = 0, j = 0; x < n; ++x) {
      while (j < k && end_[j + 1] < x) ++j;
      use(x, k < 0 ? -1 : base_[j]);
    }
  }

 private:
  std::vector<double> f_, end_;  ///< end_[k]: where parabola k begins to be the lowest
  std::vector<int> base_;
};

/// Calls use(pixel, column, row) for every pixel with the marked pixel nearest to it, column -1 when there is none.
template <class Use>
void find_nearest(std::span<const std::uint8_t> marked, int width, int height, const Use& use) {
  const std::vector<std::int32_t> rows = nearest_rows(marked, width, height);
  tbb::parallel_for(tbb::blocked_range<int>(0, height, 16), [&](const tbb::blocked_range<int>& range) {
    Envelope envelope(width);
    for (int y = range.begin(); y < range.end(); ++y) {
      const std::size_t begin = static_cast<std::size_t>(y) * width;
      envelope.scan(&rows[begin], y, width, [&](int x, int q) { use(begin + x, q, q < 0 ? -1 : rows[begin + q]); });
    }
  });
}

}  // namespace

std::vector<std::uint8_t> shadow_boundary(std::span<const float> mask, std::span<const PixelClass> classes, int width,
                                          int height, AnswerKind kind) {
  std::vector<std::uint8_t> marked(mask.size(), 0);
  const auto differ = [&](float a, float b) {
    return kind == AnswerKind::transmitted ? is_wrong(a, b, kind) : is_lit(a) != is_lit(b);
  };
  const auto mark = [&](std::size_t i, std::size_t j) {
    if (differ(mask[i], mask[j]) && classes[i] > PixelClass::F && classes[j] > PixelClass::F) marked[i] = marked[j] = 1;
  };
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const std::size_t i = static_cast<std::size_t>(y) * width + x;
      if (x + 1 < width) mark(i, i + 1);
      if (y + 1 < height) mark(i, i + width);
    }
  return marked;
}

std::vector<float> distance_transform(std::span<const std::uint8_t> marked, int width, int height) {
  std::vector<float> distances(marked.size());
  find_nearest(marked, width, height, [&](std::size_t i, int column, int row) {
    const double dx = static_cast<int>(i % width) - column, dy = static_cast<int>(i / width) - row;
    distances[i] = column < 0 ? INFINITY : static_cast<float>(std::sqrt(dx * dx + dy * dy));
  });
  return distances;
}

std::vector<std::int32_t> nearest_marked(std::span<const std::uint8_t> marked, int width, int height) {
  std::vector<std::int32_t> nearest(marked.size());
  find_nearest(marked, width, height,
               [&](std::size_t i, int column, int row) { nearest[i] = column < 0 ? -1 : row * width + column; });
  return nearest;
}

}  // namespace gnomon
