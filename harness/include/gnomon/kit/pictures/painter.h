#pragma once
#include <gnomon/kit/geometry/camera.h>
#include <gnomon/kit/geometry/clip.h>

namespace gnomon {

// Polygons as pixels, without a depth buffer.

/// Pixels `begin` to `end` - 1 of the picture, all in one row.
struct PixelSpan {
  std::size_t begin, end;
};

/// Finds the pixels whose centers a polygon covers, as seen by a camera. Spans are half open, so that of two polygons on either
/// side of an edge with the same two ends exactly one covers a center on it: no gap, no overlap. (An edge that has a corner of
/// the neighbor between its ends may miss or share a center that lies within rounding of it.) What is behind the eye is clipped
/// off; so is what is nearer to it than 1e-12 of the polygon's greatest distance along the view. Keeps its memory from one
/// polygon to the next.
class Painter {
 public:
  explicit Painter(const Camera& camera);

  /// From the top down. Corners of a convex polygon in world space, wound either way; valid until the next call.
  std::span<const PixelSpan> spans(std::span<const Corner> corners) { return spans_of(corners); }
  std::span<const PixelSpan> spans(std::span<const glm::dvec3> corners) { return spans_of(corners); }

 private:
  template <class Point>
  std::span<const PixelSpan> spans_of(std::span<const Point> corners);
  void scan();

  glm::dvec3 eye_, right_, down_, forward_;
  int width_, height_;
  glm::dvec2 guard_;  // pixels from the middle of the picture, well outside
  // Seen by the eye: pixels to the right and down from the middle, times z; and z, forward.
  Clipper polygon_;
  std::vector<glm::dvec2> places_;
  std::vector<PixelSpan> spans_;
  std::vector<std::pair<int, int>> rows_;
};

/// Calls visit(pixel index) for every pixel whose center the polygon covers, row by row from the top left.
template <class Point, class Visit>
void for_covered_pixels(Painter& painter, std::span<const Point> corners, Visit&& visit) {
  for (const PixelSpan& span : painter.spans(corners))
    for (std::size_t i = span.begin; i < span.end; ++i) visit(i);
}

}  // namespace gnomon
