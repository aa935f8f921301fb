#pragma once
#include <gnomon/kit/geometry/camera.h>
#include <gnomon/kit/geometry/edges.h>
#include <gnomon/technique.h>

namespace gnomon {

// Lines over a picture: width * height * 3 floats, linear RGB in 0 .. 1, of what a G-buffer shows.

/// From one point of the world straight to another.
struct Line {
  glm::dvec3 from, to;
  glm::vec3 color;
};

/// Draws lines into a picture of the G-buffer's size. Parts that no surface hides are two pixels wide, in their color; hidden
/// parts are dotted, one pixel wide and half transparent. A part that lies beneath a surface by less than a thousandth of its
/// distance from the eye counts as lying on it, so that edges of surfaces, and of the triangles inscribed in a curve, are
/// visible. What is behind the eye is clipped off. Visible parts are drawn over hidden ones, later lines over earlier ones.
void draw_lines(std::span<const Line> lines, const GBuffer& gbuffer, std::span<float> picture);

/// Which points the eye of a G-buffer sees, by the same rule. For lines that a window draws itself, a few points of each, where
/// deciding pixel by pixel would take too long.
class SeenPoints {
 public:
  explicit SeenPoints(const GBuffer& gbuffer) : gbuffer_(gbuffer), camera_(gbuffer.view, gbuffer.width, gbuffer.height) {}
  /// Whether the point is in the picture and not hidden at its pixel or one of the eight around it: an outline lies beside its
  /// mesh as often as on it.
  bool operator()(const glm::dvec3& point) const;

 private:
  const GBuffer& gbuffer_;
  Camera camera_;
};

/// The edges of a silhouette as lines, colored by how many side quads start there: the absolute value of SilhouetteEdge::count.
std::vector<Line> silhouette_lines(const EdgeAdjacency& adjacency, const Silhouette& silhouette);

/// The color of an edge where `count` side quads start, 1 at least.
glm::vec3 silhouette_color(int count);

/// The debug layer `silhouette`: silhouette lines over `shaded_layer`.
DebugLayer silhouette_layer();

}  // namespace gnomon
