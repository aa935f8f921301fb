#pragma once
#include <gnomon/kit/geometry/exact.h>
#include <gnomon/kit/pictures/layers.h>
#include <gnomon/kit/pictures/painter.h>
#include <gnomon/kit/pictures/surface_detail.h>

#include <algorithm>
#include <functional>

#include "bsp.h"

namespace gnomon::svbsp {

// Pictures by the regular BSP tree: width * height * 3 floats, linear RGB in 0 .. 1.

/// Paints the parts of one polygon over what is there.
class DetailBrush {
 public:
  /// Twice the triangle, counted over the scene, plus one where it is lit; or `nothing`.
  using Paint = std::uint32_t;
  static constexpr Paint nothing = 0xffffffffu;

  DetailBrush(const Camera& camera, std::size_t size) : pixels(size, nothing), painter_(camera) {}
  /// Corners of a convex part in world space, wound either way.
  template <class Point>
  void paint(std::span<const Point> corners, bool is_lit) {
    for_covered_pixels(painter_, corners, [this, is_lit](std::size_t i) { pixels[i] = 2 * triangle + is_lit; });
  }
  std::vector<Paint> pixels;
  std::uint32_t triangle = 0;  ///< that is painted now

 private:
  Painter painter_;
};

/// Gives the lit and shadowed parts of a polygon of the tree to the brush.
using DetailOf = std::function<void(const BspPolygon& polygon, DetailBrush& brush)>;

/// The debug layer `bsp`, which `paint_bsp` draws: all visible points and the polygons of the tree that they lie in, like
/// `paint_splits`.
inline DebugLayer bsp_layer() {
  const std::vector<Swatch> borders = splits_layer().legend;
  return {"bsp",
          "The polygons of the regular BSP tree of the scene, without shadows: the edges of triangles, and where planes of the "
          "tree split them.",
          {borders[0], borders[2]}};
}

inline std::vector<float> paint_bsp(const Scene& scene, const GBuffer& gbuffer, const Light& light, const Bsp& bsp) {
  std::vector<const BspPolygon*> sorted;
  for (const BspPolygon& polygon : bsp.polygons()) sorted.push_back(&polygon);
  std::ranges::stable_sort(sorted, {}, [](const BspPolygon* p) { return p->triangle; });
  const TriangleNumbers numbers(scene);
  SurfaceDetail detail;
  for (const BspPolygon* const polygon : sorted) {
    const std::uint32_t mesh = numbers.mesh_of(polygon->triangle);
    const auto first = static_cast<std::uint32_t>(detail.corners.size());
    detail.polygons.push_back({mesh, polygon->triangle - numbers.first_of(mesh), true, first, polygon->count});
    for (const Corner& corner : bsp.corners(*polygon)) detail.corners.push_back(corner.at);
  }
  return paint_division(scene, gbuffer, light, detail);
}

/// The debug layer `painter`, which `paint_back_to_front` draws.
inline DebugLayer painter_layer() {
  return {"painter",
          "The polygons with their surface detail, drawn back to front through the BSP tree, without a depth buffer; shaded by "
          "the light, darker in shadow."};
}

/// The second pass of object precision: the polygons of the tree with their surface detail, back to front from the eye, each
/// painted over what it hides; no depth is compared. Each polygon is painted whole first, as lit. Then detail_of paints its
/// parts, if the mesh receives and the eye sees the side that is turned to the light. Away from edges the picture is
/// `shaded_layer` of that shadow on the meshes, to rounding in float32. Of the G-buffer only view and size are used.
inline std::vector<float> paint_back_to_front(const Scene& scene, const GBuffer& gbuffer, const Light& light, const Bsp& bsp,
                                              const DetailOf& detail_of) {
  const TriangleNumbers numbers(scene);
  const Camera camera(gbuffer.view, gbuffer.width, gbuffer.height);
  const glm::dvec4 eye(glm::dvec3(gbuffer.view.eye), 1), l = homogeneous(light);
  DetailBrush canvas(camera, gbuffer.size());
  bsp.back_to_front(eye, [&](std::span<const BspPolygon> coplanar) {
    for (const BspPolygon& polygon : coplanar) {
      const auto [a, b, c] = triangle_of(scene, numbers, polygon.triangle).points;
      const int seen = orient3d_sign(a, b, c, eye);
      if (seen == 0) continue;
      canvas.triangle = polygon.triangle;
      canvas.paint(bsp.corners(polygon), true);
      if (scene.meshes[numbers.mesh_of(polygon.triangle)].receives && orient3d_sign(a, b, c, l) == seen)
        detail_of(polygon, canvas);
    }
  });

  std::vector<float> picture(gbuffer.size() * 3);
  for (std::size_t i = 0; i < gbuffer.size(); ++i) {
    glm::vec3 color = background_color();
    if (const DetailBrush::Paint paint = canvas.pixels[i]; paint != DetailBrush::nothing) {
      const Triangle triangle = triangle_of(scene, numbers, paint / 2);
      const glm::dvec3 a(triangle.points[0]), across = triangle.normal();
      const glm::dvec3 ray =
          camera.ray(static_cast<double>(i % gbuffer.width) + 0.5, static_cast<double>(i / gbuffer.width) + 0.5);
      const double along = glm::dot(across, ray);
      const glm::dvec3 point = camera.eye + ray * (glm::dot(across, a - camera.eye) / along);
      const glm::dvec3 normal = glm::normalize(along > 0 ? -across : across);
      color = shaded_color(scene.meshes[numbers.mesh_of(paint / 2)], light, point, normal, paint % 2 ? 1.0f : 0.0f);
    }
    for (int c = 0; c < 3; ++c) picture[3 * i + c] = color[c];
  }
  return picture;
}

}  // namespace gnomon::svbsp
