#include "kit/gl/pixel_rectangles.h"

namespace gnomon {

namespace {

constexpr int strip_height = 16;
constexpr std::int64_t draw_price = 1000;  ///< pixels that could be shaded instead of one more draw

bool is_empty(const PixelRectangle& r) { return r.left >= r.right; }

std::int64_t area(const PixelRectangle& r) { return std::int64_t{r.right - r.left} * (r.bottom - r.top); }

PixelRectangle joined(const PixelRectangle& a, const PixelRectangle& b) {
  if (is_empty(a)) return b;
  if (is_empty(b)) return a;
  return {std::min(a.left, b.left), std::min(a.top, b.top), std::max(a.right, b.right), std::max(a.bottom, b.bottom)};
}

/// The smallest rectangle around what is wanted in each strip; empty where nothing is.
std::vector<PixelRectangle> strips_around(int width, int height, const std::function<bool(std::size_t)>& wanted) {
  std::vector<PixelRectangle> strips;
  for (int y = 0; y < height; ++y) {
    if (y % strip_height == 0) strips.emplace_back();
    for (int x = 0; x < width; ++x)
      if (wanted(static_cast<std::size_t>(y) * width + x)) strips.back() = joined(strips.back(), {x, y, x + 1, y + 1});
  }
  return strips;
}

}  // namespace

PixelRectangle around(const std::vector<PixelRectangle>& rectangles) {
  PixelRectangle all;
  for (const PixelRectangle& one : rectangles) all = joined(all, one);
  return all;
}

std::vector<PixelRectangle> rectangles_around(int width, int height, const std::function<bool(std::size_t)>& wanted) {
  const std::vector<PixelRectangle> strips = strips_around(width, height, wanted);
  // The cheapest way to hold the first n strips, by its last rectangle: that of strips `from` to n - 1.
  struct Way {
    std::int64_t price = 0;
    std::size_t from = 0;
    PixelRectangle last;
  };
  std::vector<Way> ways(1);
  for (std::size_t n = 1; n <= strips.size(); ++n) {
    Way best{.price = INT64_MAX, .from = 0, .last = {}};
    PixelRectangle last;
    for (std::size_t from = n; from-- > 0;) {
      last = joined(strips[from], last);
      const std::int64_t price = ways[from].price + (is_empty(last) ? 0 : area(last) + draw_price);
      if (price < best.price) best = {price, from, last};
    }
    ways.push_back(best);
  }
  std::vector<PixelRectangle> rectangles;
  for (std::size_t n = strips.size(); n > 0; n = ways[n].from)
    if (!is_empty(ways[n].last)) rectangles.push_back(ways[n].last);
  std::ranges::reverse(rectangles);
  return rectangles;
}

}  // namespace gnomon
