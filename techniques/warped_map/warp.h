#pragma once
#include <gnomon/kit/maps/light_camera.h>

#include <vector>

namespace gnomon::warped_map {

// A warp shows the window of an image in perspective, from a center below its low end: near y = 0 texels are small, at the far
// end large. The distance of the center from the low end says how much: infinity is no warp.

/// Wimmer, Scherzer and Purgathofer 2004: the distance that spreads the error of perspective evenly between two depths of the
/// eye, where the light shines at this angle to the view; in meters, as the eye measures.
double light_space_perspective_distance(double near, double far, double sine);

/// Martin and Tan 2004: the distance at which what lies within `focus` of a window `length` long takes 80 % of the image.
/// Infinity where it does so anyway, with a focus of 0.8 and more.
double trapezoidal_distance(double length, double focus);

/// What a window shows, in rows: bounds of x at both ends of each.
class Rows {
 public:
  Rows(double low, double high, int count);
  void add(const glm::dvec2& window);
  void add(const Rows& other);
  /// Corners of all rows that show something: whatever was added lies in their hull.
  std::vector<glm::dvec2> corners() const;

 private:
  double low_, step_;
  std::vector<glm::dvec2> bounds_;  ///< lowest and highest x
};

/// Gives an image the warp of a center at this distance from the lowest of the corners, and fits it to them: `margin` of its
/// `resolution` texels stay free on each side. The center is farther where texels would be finer than float32 window
/// coordinates.
void warp(LightImage& image, const std::vector<glm::dvec2>& corners, double distance, int resolution, int margin);

}  // namespace gnomon::warped_map
