#pragma once
#include <gnomon/kit/camera.h>

#include <algorithm>
#include <cmath>

#include "bounds.h"

namespace composite_planar {

/// One test that concerns a tile, for the pixels of one plane.
struct Entry {
  std::uint32_t tile, plane, test;
  /// Every point of the plane that the tile shows is in this test's shadow.
  bool is_whole;
};

/// The picture in square tiles, row by row, and the tests that concern each. Reused from picture to picture.
class Tiles {
 public:
  static constexpr int side = 32;  ///< pixels

  void begin(const GBuffer& gbuffer) {
    camera_ = Camera(gbuffer.view, gbuffer.width, gbuffer.height);
    clip_from_world_ = clip_from_world(gbuffer.view, gbuffer.width, gbuffer.height);
    columns_ = (gbuffer.width + side - 1) / side;
    rows_ = (gbuffer.height + side - 1) / side;
    entries_.clear();
  }

  /// The plane that the tests to come are about; its number must not be less than before.
  void begin_plane(std::uint32_t number, const glm::dvec4& plane) {
    plane_ = number;
    corners_.resize(static_cast<std::size_t>(columns_ + 1) * (rows_ + 1));
    const double eye_height = glm::dot(plane, glm::dvec4(camera_.eye, 1));
    for (int row = 0; row <= rows_; ++row)
      for (int column = 0; column <= columns_; ++column) {
        const glm::dvec3 ray = camera_.ray(std::min(column * side, camera_.width), std::min(row * side, camera_.height));
        // Not a number where the ray rises from the plane: no shadow holds such a corner.
        const double down = -glm::dot(glm::dvec3(plane), ray);
        corners_[row * (columns_ + 1) + column] = down > 0 ? camera_.eye + eye_height / down * ray : glm::dvec3(NAN);
      }
  }

  /// Enters a test in the tiles that its polygon meets as the eye sees it, a pixel wider than it is.
  void add(std::uint32_t number, const ShadowTest& test, Polygon polygon) {
    for (std::size_t i = 0; i < polygon.size(); ++i) polygon[i] = clip_from_world_ * polygon[i];
    for (const glm::dvec4& half_space :
         {glm::dvec4(1, 0, 0, 1), glm::dvec4(-1, 0, 0, 1), glm::dvec4(0, 1, 0, 1), glm::dvec4(0, -1, 0, 1)})
      polygon.clip(half_space);
    double top = INFINITY, bottom = -INFINITY;
    for (std::size_t i = 0; i < polygon.size(); ++i) {
      const glm::dvec4 p = polygon[i];
      if (!(p.w > 0)) return;  // seen from within its plane
      polygon[i] = {(1 + p.x / p.w) / 2 * camera_.width, (1 - p.y / p.w) / 2 * camera_.height, 0, 1};
      top = std::min(top, polygon[i].y);
      bottom = std::max(bottom, polygon[i].y);
    }
    if (polygon.size() == 0) return;
    const int first = tile(top - 1, rows_), last = tile(bottom + 1, rows_);
    // Whether the corners above and below a row of tiles are in the shadow, which is convex.
    above_.assign(columns_ + 1, 0);
    below_.assign(columns_ + 1, 0);
    const auto test_corners = [&](int row, int from, int to, std::vector<std::uint8_t>& inside) {
      std::ranges::fill(inside, 0);
      for (int column = from; column <= to; ++column) inside[column] = test.contains(corners_[row * (columns_ + 1) + column]);
    };
    int known_from = 0, known_to = -1;
    for (int row = first; row <= last; ++row) {
      const auto [left, right] = reach(polygon, row * side - 1, (row + 1) * side + 1);
      if (left > right) continue;
      const int from = tile(left - 1, columns_), to = tile(right + 1, columns_);
      if (row == first || from < known_from || to + 1 > known_to)
        test_corners(row, from, to + 1, above_);
      else
        std::swap(above_, below_);
      test_corners(row + 1, from, to + 1, below_);
      known_from = from;
      known_to = to + 1;
      for (int column = from; column <= to; ++column) {
        const bool is_whole = above_[column] && above_[column + 1] && below_[column] && below_[column + 1];
        entries_.push_back({static_cast<std::uint32_t>(row * columns_ + column), plane_, number, is_whole});
      }
    }
  }

  /// All entries by tile; those of a tile in the order of their planes and numbers.
  std::span<const Entry> sorted() {
    starts_.assign(static_cast<std::size_t>(columns_) * rows_ + 1, 0);
    for (const Entry& entry : entries_) ++starts_[entry.tile + 1];
    for (std::size_t i = 1; i < starts_.size(); ++i) starts_[i] += starts_[i - 1];
    sorted_.resize(entries_.size());
    for (const Entry& entry : entries_) sorted_[starts_[entry.tile]++] = entry;
    return sorted_;
  }

  std::uint32_t columns() const { return columns_; }
  std::size_t bytes() const {
    return (entries_.capacity() + sorted_.capacity()) * sizeof(Entry) + starts_.capacity() * sizeof(std::uint32_t) +
           corners_.capacity() * sizeof(glm::dvec3) + above_.capacity() + below_.capacity();
  }

 private:
  static int tile(double pixel, int count) { return std::clamp(static_cast<int>(std::floor(pixel / side)), 0, count - 1); }

  /// Least and greatest x of the polygon between two heights.
  static std::pair<double, double> reach(const Polygon& polygon, double top, double bottom) {
    double left = INFINITY, right = -INFINITY;
    for (std::size_t i = 0; i < polygon.size(); ++i) {
      const glm::dvec4 &a = polygon[i], &b = polygon[i + 1 < polygon.size() ? i + 1 : 0];
      const double low = std::max(std::min(a.y, b.y), top), high = std::min(std::max(a.y, b.y), bottom);
      if (low > high) continue;
      for (const double y : {low, high}) {
        const double share = a.y == b.y ? 0 : std::clamp((y - a.y) / (b.y - a.y), 0.0, 1.0);
        const double x = a.x + share * (b.x - a.x);
        left = std::min(left, x);
        right = std::max(right, x);
      }
    }
    return {left, right};
  }

  Camera camera_{View{}, 1, 1};
  glm::dmat4 clip_from_world_{1};
  int columns_ = 0, rows_ = 0;
  std::uint32_t plane_ = 0;
  std::vector<glm::dvec3> corners_;  ///< where the tiles' corners show the plane
  std::vector<std::uint8_t> above_, below_;
  std::vector<Entry> entries_, sorted_;
  std::vector<std::uint32_t> starts_;
};

}  // namespace composite_planar
