#include "paint_bsp.h"

#include <gnomon/kit/exact.h>
#include <gnomon/kit/layers.h>
#include <gnomon/kit/painter.h>
#include <gnomon/kit/receiver.h>
#include <gnomon/kit/surface_detail.h>

#include <algorithm>

namespace gnomon::svbsp {

namespace {

/// What is painted on a pixel: twice the triangle, counted over the scene, plus one where it is lit.
using Paint = std::uint32_t;
constexpr Paint nothing = 0xffffffffu;

class Canvas final : public DetailBrush {
 public:
  Canvas(const Camera& camera, std::size_t size) : painter_(camera), pixels(size, nothing) {}
  void paint(std::span<const glm::dvec3> corners, bool is_lit) override { put(corners, is_lit); }
  void paint(std::span<const Corner> corners, bool is_lit) override { put(corners, is_lit); }

 private:
  template <class Point>
  void put(std::span<const Point> corners, bool is_lit) {
    for_covered_pixels(painter_, corners, [this, is_lit](std::size_t i) { pixels[i] = 2 * triangle + is_lit; });
  }
  Painter painter_;

 public:
  std::vector<Paint> pixels;
  std::uint32_t triangle = 0;  ///< that is painted now
};

}  // namespace

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
  struct Triangle {
    const Mesh& mesh;
    glm::vec3 a, b, c;
  };
  const auto triangle_of = [&](std::uint32_t number) {
    const std::uint32_t m = numbers.mesh_of(number);
    const Mesh& mesh = scene.meshes[m];
    const glm::uvec3& t = mesh.triangles[number - numbers.first_of(m)];
    return Triangle{mesh, mesh.positions[t.x], mesh.positions[t.y], mesh.positions[t.z]};
  };

  const Camera camera(gbuffer.view, gbuffer.width, gbuffer.height);
  const glm::dvec4 eye(glm::dvec3(gbuffer.view.eye), 1), l = homogeneous(light);
  Canvas canvas(camera, gbuffer.size());
  bsp.back_to_front(eye, [&](std::span<const BspPolygon> coplanar) {
    for (const BspPolygon& polygon : coplanar) {
      const Triangle face = triangle_of(polygon.triangle);
      const int seen = orient3d_sign(face.a, face.b, face.c, eye);
      if (seen == 0) continue;
      canvas.triangle = polygon.triangle;
      canvas.paint(bsp.corners(polygon), true);
      if (face.mesh.receives && orient3d_sign(face.a, face.b, face.c, l) == seen) detail_of(polygon, canvas);
    }
  });

  std::vector<float> picture(gbuffer.size() * 3);
  for (std::size_t i = 0; i < gbuffer.size(); ++i) {
    glm::vec3 color = background_color();
    if (const Paint paint = canvas.pixels[i]; paint != nothing) {
      const Triangle face = triangle_of(paint / 2);
      const glm::dvec3 a(face.a), across = glm::cross(glm::dvec3(face.b) - a, glm::dvec3(face.c) - a);
      const glm::dvec3 ray =
          camera.ray(static_cast<double>(i % gbuffer.width) + 0.5, static_cast<double>(i / gbuffer.width) + 0.5);
      const double along = glm::dot(across, ray);
      const glm::dvec3 point = camera.eye + ray * (glm::dot(across, a - camera.eye) / along);
      const glm::dvec3 normal = glm::normalize(along > 0 ? -across : across);
      color = shaded_color(face.mesh, light, point, normal, paint % 2 ? 1.0f : 0.0f);
    }
    for (int c = 0; c < 3; ++c) picture[3 * i + c] = color[c];
  }
  return picture;
}

}  // namespace gnomon::svbsp
