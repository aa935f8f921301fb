#pragma once
#include <gnomon/kit/bytes.h>
#include <gnomon/kit/geometry/camera.h>
#include <gnomon/kit/geometry/planar_shadow.h>
#include <gnomon/kit/gl/gl.h>

#include "receivers.h"

namespace composite_planar {

/// A convex polygon of homogeneous points, w >= 0, that is clipped in place: eight corners and one more for each half-space.
class Polygon {
 public:
  std::size_t size() const { return count_; }
  const glm::dvec4& operator[](std::size_t i) const { return corners_[i]; }
  glm::dvec4& operator[](std::size_t i) { return corners_[i]; }
  void add(const glm::dvec4& corner) { corners_[count_++] = corner; }

  /// Keeps the points x with dot(half_space, x) >= 0.
  void clip(const glm::dvec4& half_space) {
    std::array<double, room> values;
    bool is_whole = true;
    for (std::size_t i = 0; i < count_; ++i) is_whole = (values[i] = glm::dot(half_space, corners_[i])) >= 0 && is_whole;
    if (is_whole) return;
    const std::array<glm::dvec4, room> from = corners_;
    const std::size_t count = std::exchange(count_, 0);
    for (std::size_t i = 0; i < count; ++i) {
      const std::size_t next = i + 1 < count ? i + 1 : 0;
      const double here = values[i], there = values[next];
      if (here >= 0) add(from[i]);
      if ((here > 0 && there < 0) || (here < 0 && there > 0)) add(from[i] + here / (here - there) * (from[next] - from[i]));
    }
    if (count_ < 3) count_ = 0;
  }

 private:
  static constexpr std::size_t room = 24;
  std::array<glm::dvec4, room> corners_;
  std::size_t count_ = 0;
};

/// A polygon around a flat part: its corners, of a disc those of an octagon.
inline Polygon around(const FlatPart& part) {
  Polygon polygon;
  for (int k = 0; k < part.corner_count; ++k) polygon.add({part.points[k], 1});
  if (!part.is_disc()) return polygon;
  // Half a side of an octagon around a circle of radius 1.
  constexpr double t = 0.41421356237309515;
  constexpr std::array<glm::dvec2, 8> octagon{{{1, t}, {t, 1}, {-t, 1}, {-1, t}, {-1, -t}, {-t, -1}, {t, -1}, {1, -t}}};
  const glm::dvec3 u = part.points[1] - part.points[0], v = part.points[2] - part.points[0];
  for (const glm::dvec2& c : octagon) polygon.add({part.points[0] + c.x * u + c.y * v, 1});
  return polygon;
}

/// A polygon on a receiver that holds the shadow of a flat part on it, in world space with w = 1; empty where there is none.
inline Polygon bound_of(const FlatPart& part, bool is_image, const glm::dvec4& light, const Receiver& receiver) {
  Polygon polygon = around(part);
  if (!is_image) {
    polygon.clip(receiver.plane);
    const double light_height = glm::dot(receiver.plane, light);
    if (light.w != 0) polygon.clip(glm::dvec4(0, 0, 0, light_height) - light.w * receiver.plane);
    for (std::size_t i = 0; i < polygon.size(); ++i) {
      const glm::dvec4 p = polygon[i];
      polygon[i] = light_height * p - glm::dot(receiver.plane, p) * light;
      polygon[i].w = std::max(polygon[i].w, 0.0);  // on the light's horizon, but for rounding
    }
  }
  for (const glm::dvec4& side : receiver.sides) polygon.clip(side);
  for (std::size_t i = 0; i < polygon.size(); ++i) polygon[i] /= polygon[i].w;
  return polygon;
}

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
    clip_from_world_ = clip_from_world(gbuffer.view, gbuffer.width, gbuffer.height, 0);  // depths are not used
    columns_ = (gbuffer.width + side - 1) / side;
    rows_ = (gbuffer.height + side - 1) / side;
    entries_.clear();
    corners_.resize(static_cast<std::size_t>(columns_ + 1) * (rows_ + 1));
    above_.resize(columns_ + 1);
    below_.resize(columns_ + 1);
  }

  /// The plane that the tests to come are about; its number must not be less than before.
  void begin_plane(std::uint32_t number, const glm::dvec4& plane) {
    plane_ = number;
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
  std::size_t bytes() const { return bytes_of(entries_, sorted_, starts_, corners_, above_, below_); }

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
