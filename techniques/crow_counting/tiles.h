#pragma once
#include <gnomon/kit/bytes.h>

#include "polygon.h"

namespace gnomon::crow_counting {

/// What the points of a tile of pixels have in common, seen from the start: a box of the picture plane z = 1, a range of z and
/// the largest distance.
struct Tile {
  double x0 = INFINITY, x1 = -INFINITY, y0 = INFINITY, y1 = -INFINITY, z0 = INFINITY, z1 = 0, farthest = 0;
  std::uint32_t undecided = 0;  ///< pixels

  static constexpr double margin = 0x1p-18;     ///< around each point, of its largest coordinate
  static constexpr double narrowest = 0x1p-20;  ///< share of its distance that a point must be in front of the start

  /// A point that is not clearly in front of the start makes the tile boundless: nothing is then left out for it.
  ///
  /// The box has a margin, so that the tile also holds the place where the way from a point to the light leaves the point's own
  /// surface. P is at most sqrt(3) / 2 * 2^-24 max|P| off that surface, and the way to a light 1 / 32 rad or more above it
  /// takes 32 times as much: 28 * 2^-24 max|P| < 2^-18 max|P|. Lower lights: unresolved_points.h.
  void add(const glm::dvec3& p, double largest_coordinate) {
    const double distance = glm::length(p);
    ++undecided;
    if (p.z > narrowest * distance) {
      const double beside = margin * largest_coordinate / p.z, x = p.x / p.z, y = p.y / p.z;
      add(Tile{x - beside, x + beside, y - beside, y + beside, p.z, p.z, distance, 0});
    } else {
      add(Tile{-INFINITY, INFINITY, -INFINITY, INFINITY, 0, INFINITY, distance, 0});
    }
  }
  void add(const Tile& t) {
    x0 = std::min(x0, t.x0);
    x1 = std::max(x1, t.x1);
    y0 = std::min(y0, t.y0);
    y1 = std::max(y1, t.y1);
    z0 = std::min(z0, t.z0);
    z1 = std::max(z1, t.z1);
    farthest = std::max(farthest, t.farthest);
    undecided += t.undecided;
  }

  bool misses(const Outline& o) const { return o.x0 > x1 || o.x1 < x0 || o.y0 > y1 || o.y1 < y0 || o.z0 > z1; }

  /// Whether no way to a point of the tile crosses the polygon, by each of its planes alone. A linear function of (x, y, 1) is
  /// largest in a corner of the box. In a boundless tile comparisons of infinities that are not a number are false.
  bool misses(const Polygon& polygon) const {
    const auto largest = [&](const glm::dvec3& n) { return n.x * (n.x > 0 ? x1 : x0) + n.y * (n.y > 0 ? y1 : y0) + n.z; };
    const double rise = largest(polygon.plane), reach = rise * (rise > 0 ? z1 : z0) - polygon.distance;
    if (reach < -(polygon.slack + 2 * relative_error * farthest)) return true;
    const double error = 2 * relative_error * farthest / z0;
    return largest(polygon.inside[0]) < -error || largest(polygon.inside[1]) < -error || largest(polygon.inside[2]) < -error;
  }
};

/// Tiles of tiles: level 0 has 8 x 8 pixels, each next one twice as many on a side.
class Pyramid {
 public:
  static constexpr int leaf = 8;

  /// Shape of the tiles for a picture; the top level has at most 128 tiles, of 64 x 64 pixels or more.
  void fit(int width, int height) {
    if (width == width_ && height == height_) return;
    width_ = width;
    height_ = height;
    levels_.clear();
    for (int side = leaf;; side *= 2) {
      const int columns = (width + side - 1) / side, rows = (height + side - 1) / side;
      levels_.push_back({columns, rows, std::vector<Tile>(static_cast<std::size_t>(columns) * rows)});
      if (side >= 8 * leaf && columns * rows <= 128) break;
    }
  }
  /// Calls visit(pixel) for the pixels of a tile of level 0.
  void for_pixels(int column, int row, const auto& visit) const {
    for (int y = row * leaf; y < std::min(row * leaf + leaf, height_); ++y)
      for (int x = column * leaf; x < std::min(column * leaf + leaf, width_); ++x)
        visit(static_cast<std::size_t>(y) * width_ + x);
  }
  /// Joins the tiles of level 0 to those above.
  void join() {
    for (std::size_t level = 1; level < levels_.size(); ++level) {
      Level &upper = levels_[level], &lower = levels_[level - 1];
      std::ranges::fill(upper.tiles, Tile{});
      for (int y = 0; y < lower.rows; ++y)
        for (int x = 0; x < lower.columns; ++x) upper.at(x / 2, y / 2).add(lower.at(x, y));
    }
  }

  struct Level {
    int columns, rows;
    std::vector<Tile> tiles;
    Tile& at(int x, int y) { return tiles[static_cast<std::size_t>(y) * columns + x]; }
  };
  int top() const { return static_cast<int>(levels_.size()) - 1; }
  Level& level(int k) { return levels_[k]; }
  std::size_t bytes() const {
    std::size_t sum = 0;
    for (const Level& level : levels_) sum += bytes_of(level.tiles);
    return sum;
  }

 private:
  int width_ = 0, height_ = 0;
  std::vector<Level> levels_;
};

}  // namespace gnomon::crow_counting
