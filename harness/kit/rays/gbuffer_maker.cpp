#include <gnomon/kit/rays/gbuffer_maker.h>
#include <tbb/parallel_for.h>

namespace gnomon {

namespace {

struct GBufferArrays {
  std::vector<float> px, py, pz, nx, ny, nz;
  std::vector<std::uint32_t> mesh, triangle;
  explicit GBufferArrays(std::size_t n) : px(n), py(n), pz(n), nx(n), ny(n), nz(n), mesh(n, no_mesh), triangle(n) {}
};

/// Position and unit normal, either way round.
struct Surface {
  glm::dvec3 position, normal;
};

Surface on_triangle(const Mesh& mesh, std::uint32_t triangle, const Camera& camera, const glm::dvec3& ray, double t) {
  const Triangle corners = mesh.corners(triangle);
  const glm::dvec3 a = corners.points[0], normal = glm::normalize(corners.normal());
  const double slope = glm::dot(normal, ray);
  // Edge-on to the eye within double rounding, the plane gives no distance: keep the ray tracer's.
  if (std::abs(slope) > 1e-9 * glm::length(ray)) t = glm::dot(normal, a - camera.eye) / slope;
  return {camera.eye + t * ray, normal};
}

/// Moves a point of the ray onto the shape along the normal: the ray tracer's t is rounded to float32.
Surface on_shape(const Shape& shape, const glm::dvec3& point, const glm::dvec3& normal) {
  if (const auto* sphere = std::get_if<Sphere>(&shape)) {
    const glm::dvec3 outward = glm::normalize(point - glm::dvec3(sphere->center));
    return {glm::dvec3(sphere->center) + static_cast<double>(sphere->radius) * outward, outward};
  }
  if (const auto* disc = std::get_if<Disc>(&shape)) {
    const glm::dvec3 n = glm::normalize(glm::dvec3(disc->normal));
    return {point - glm::dot(point - glm::dvec3(disc->center), n) * n, n};
  }
  const auto& cone = std::get<Cone>(shape);
  const glm::dvec3 axis = glm::normalize(glm::dvec3(cone.axis)), base = cone.base;
  if (glm::dot(normal, axis) < -0.999999) return {point - glm::dot(point - base, axis) * axis, -axis};
  // Distance to the lateral surface in the half-plane through the axis: h (r - R) + R z over the slant length.
  const double along = glm::dot(point - base, axis), slant = std::hypot<double>(cone.radius, cone.height);
  const glm::dvec3 radial = point - base - along * axis;
  const double r = glm::length(radial);
  if (r == 0) return {point, normal};
  const glm::dvec3 outward = (static_cast<double>(cone.height) * radial / r + static_cast<double>(cone.radius) * axis) / slant;
  const double distance = (cone.height * (r - cone.radius) + cone.radius * along) / slant;
  return {point - distance * outward, outward};
}

}  // namespace

SurfacePoint surface_through(const Scene& scene, const RayScene& everything, const Camera& camera, Truth truth, double x,
                             double y) {
  const glm::dvec3 ray = camera.ray(x, y);
  const RayScene::Hit hit = everything.closest(camera.eye, ray);
  if (hit.mesh == no_mesh) return {};
  const Mesh& mesh = scene.meshes[hit.mesh];
  Surface surface = truth == Truth::shape && mesh.has_curved_shape()
                        ? on_shape(*mesh.shape, camera.eye + hit.t * ray, hit.normal)
                        : on_triangle(mesh, hit.triangle, camera, ray, hit.t);
  if (glm::dot(surface.normal, ray) > 0) surface.normal = -surface.normal;
  return {hit.mesh, hit.triangle, glm::vec3(surface.position), glm::vec3(surface.normal)};
}

GBuffer make_gbuffer(const Scene& scene, const RayScene& everything, const View& view, int width, int height, Truth truth) {
  const Camera camera(view, width, height);
  auto arrays = std::make_shared<GBufferArrays>(static_cast<std::size_t>(width) * height);
  tbb::parallel_for(0, height, [&](int y) {
    for (int x = 0; x < width; ++x) {
      const SurfacePoint point = surface_through(scene, everything, camera, truth, x + 0.5, y + 0.5);
      if (point.mesh == no_mesh) continue;
      const std::size_t i = static_cast<std::size_t>(y) * width + x;
      arrays->px[i] = point.position.x;
      arrays->py[i] = point.position.y;
      arrays->pz[i] = point.position.z;
      arrays->nx[i] = point.normal.x;
      arrays->ny[i] = point.normal.y;
      arrays->nz[i] = point.normal.z;
      arrays->mesh[i] = point.mesh;
      arrays->triangle[i] = point.triangle;
    }
  });
  const GBufferArrays& a = *arrays;
  return {view, truth, width, height, a.px, a.py, a.pz, a.nx, a.ny, a.nz, a.mesh, a.triangle, arrays};
}

}  // namespace gnomon
