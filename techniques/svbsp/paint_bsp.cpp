#include "paint_bsp.h"

#include <gnomon/kit/geometry/exact.h>
#include <gnomon/kit/pictures/layers.h>
#include <gnomon/kit/pictures/surface_detail.h>

#include <algorithm>

namespace gnomon::svbsp {

DebugLayer bsp_layer() {
  const std::vector<Swatch> borders = splits_layer().legend;
  return {"bsp",
          "The polygons of the regular BSP tree of the scene, without shadows: the edges of triangles, and where planes of the "
          "tree split them.",
          {borders[0], borders[2]}};
}

std::vector<float> paint_bsp(const Scene& scene, const GBuffer& gbuffer, const Light& light, const Bsp& bsp) {
  std::vector<const BspPolygon*> sorted;
  for (const BspPolygon& polygon : bsp.polygons()) sorted.push_back(&polygon);
  std::ranges::stable_sort(sorted, {}, [](const BspPolygon* p) { return p->triangle; });
  const TriangleNumbers numbers(scene);
  SurfaceDetail detail;
  for (const BspPolygon* const polygon : sorted) {
    const std::uint32_t mesh = numbers.mesh_of(polygon->triangle);
    detail.polygons.push_back({.mesh = mesh,
                               .triangle = polygon->triangle - numbers.first_of(mesh),
                               .is_lit = true,
                               .first = static_cast<std::uint32_t>(detail.corners.size()),
                               .count = polygon->count});
    for (const Corner& corner : bsp.corners(*polygon)) detail.corners.push_back(corner.at);
  }
  return paint_division(scene, gbuffer, light, detail);
}

DebugLayer painter_layer() {
  return {"painter",
          "The polygons with their surface detail, drawn back to front through the BSP tree, without a depth buffer; shaded by "
          "the light, darker in shadow."};
}

std::vector<float> paint_back_to_front(const Scene& scene, const GBuffer& gbuffer, const Light& light, const Bsp& bsp,
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
      const Triangle face = triangle_of(scene, numbers, paint / 2);
      const glm::dvec3 a(face.points[0]), across = glm::cross(glm::dvec3(face.points[1]) - a, glm::dvec3(face.points[2]) - a);
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
