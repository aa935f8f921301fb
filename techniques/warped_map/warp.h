#pragma once
#include <gnomon/kit/maps/light_camera.h>

namespace gnomon::warped_map {

// A warp shows the window of an image in perspective, from a center below its low end: near y = 0 texels are small, at the far
// end large. The distance of the center from the low end determines how much: infinity is no warp.

/// Wimmer, Scherzer and Purgathofer 2004: the distance that spreads the error of perspective evenly between two depths of the
/// eye, where the light shines at this angle to the view; in meters, as the eye measures.
inline double light_space_perspective_distance(double near, double far, double sine) {
  return (near + std::sqrt(near * far)) / sine;
}

/// Martin and Tan 2004: the distance at which what lies within `focus` of a window `length` long takes 80 % of the image.
/// Infinity where it does so anyway, with a focus of 0.8 and more.
///
/// With the center at n below the low end, f(y) = a + b / (y + n) maps 0 to -1 and `length` to 1; f(focus) = 0.6 gives n.
inline double trapezoidal_distance(double length, double focus) {
  constexpr double line = 0.6;  // 80 % of the way from -1 to 1
  const double rest = (1 + line) * length - 2 * focus;
  return rest > 0 ? (1 - line) * length * focus / rest : INFINITY;
}

/// A range of numbers; without any, low > high.
struct Span {
  double low = INFINITY, high = -INFINITY;
  void add(double value) { add({value, value}); }
  void add(const Span& other) {
    low = std::min(low, other.low);
    high = std::max(high, other.high);
  }
  double length() const { return high - low; }
};

/// What a window shows, in rows: bounds of x at both ends of each.
class Rows {
 public:
  Rows(double low, double high, int count) : low_(low), step_(std::max((high - low) / count, 1e-300)), bounds_(count) {}
  void add(const glm::dvec2& window) {
    bounds_[static_cast<std::size_t>(std::clamp((window.y - low_) / step_, 0.0, double(bounds_.size() - 1)))].add(window.x);
  }
  void add(const Rows& other) {
    for (std::size_t i = 0; i < bounds_.size(); ++i) bounds_[i].add(other.bounds_[i]);
  }
  /// Corners of all rows that show something: their hull contains whatever was added.
  std::vector<glm::dvec2> corners() const {
    std::vector<glm::dvec2> corners;
    for (std::size_t i = 0; i < bounds_.size(); ++i)
      if (bounds_[i].low <= bounds_[i].high)
        for (const double y : {low_ + step_ * double(i), low_ + step_ * double(i + 1)})
          for (const double x : {bounds_[i].low, bounds_[i].high}) corners.push_back({x, y});
    return corners;
  }

 private:
  double low_, step_;
  std::vector<Span> bounds_;
};

/// How much of an image's x the corners take, seen from this x.
inline Span seen_from(const LightImage& image, const std::vector<glm::dvec2>& corners, double x) {
  Span span;
  for (const glm::dvec2& corner : corners) span.add((corner.x - x) / image.divisor(corner));
  return span;
}

/// The x from which they take least: a maximum less a minimum of linear functions is convex.
inline double best_center(const LightImage& image, const std::vector<glm::dvec2>& corners, Span among) {
  for (int round = 0; round < 40; ++round) {
    const double a = among.low + among.length() / 3, b = among.high - among.length() / 3;
    if (seen_from(image, corners, a).length() < seen_from(image, corners, b).length())
      among.high = b;
    else
      among.low = a;
  }
  return (among.low + among.high) / 2;
}

/// Gives an image the warp of a center at this distance from the lowest of the corners, and fits it to them: `margin` of its
/// `resolution` texels stay free on each side. The center is farther where texels would be finer than float32 window
/// coordinates.
inline void warp(LightImage& image, const std::vector<glm::dvec2>& corners, double distance, int resolution, int margin) {
  Span x, y;
  for (const glm::dvec2& corner : corners) {
    x.add(corner.x);
    y.add(corner.y);
  }
  const double inner = resolution - 2.0 * margin, length = y.length();
  // Texels below the float32 resolution of window coordinates would be noise.
  const auto least = [length](const Span& span) {
    return std::max(0x1p-40 * length, 0x1p-20 * std::max({std::abs(span.low), std::abs(span.high), span.length()}));
  };
  for (;; distance *= 2) {
    // Row 0, a margin below the low end, is at the pivot, so divisors are 1 and more: with e = y.low - pivot.y it is
    // e (n + length) / ((n - e) length) of the image's inner rows below it, for a center at the distance n.
    const double below = margin * length / (inner * (1 + length / distance)), e = below / (1 + below / distance);
    image.pivot = {0, y.low - e};
    image.lean = 1 / (distance - e);
    image.pivot.x = best_center(image, corners, x);
    const Span across = seen_from(image, corners, image.pivot.x);
    const auto along = [&](double v) { return (v - image.pivot.y) / image.divisor({0, v}); };
    const Span down{along(y.low), along(y.high)};
    const glm::dvec2 texel = glm::dvec2(across.length(), down.length()) / inner, smallest(least(x), least(y));
    if (glm::any(glm::lessThan(texel, smallest)) && distance < 0x1p20 * length) continue;
    image.scale = 1.0 / glm::max(texel, smallest);
    image.offset = resolution / 2.0 - glm::dvec2(across.low + across.high, down.low + down.high) / 2.0 * image.scale;
    return;
  }
}

}  // namespace gnomon::warped_map
