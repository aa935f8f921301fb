#pragma once
#include <gnomon/kit/geometry/camera.h>
#include <gnomon/kit/rays/rays.h>

namespace gnomon {

/// What the eye sees through one point of the image: as a pixel of a G-buffer says it, rounded to float32.
struct SurfacePoint {
  std::uint32_t mesh = no_mesh, triangle = 0;
  glm::vec3 position{0}, normal{0};
};
/// Through image point (x, y) in pixels; centers are at +0.5.
SurfacePoint surface_through(const Scene& scene, const RayScene& everything, const Camera& camera, Truth truth, double x,
                             double y);

/// Primary visibility through pixel centers, on all threads. `everything` holds all meshes under `truth`. Positions are
/// recomputed in double: on a triangle, where the pixel's ray cuts its plane; on a curved shape, on the shape itself.
GBuffer make_gbuffer(const Scene& scene, const RayScene& everything, const View& view, int width, int height, Truth truth);

}  // namespace gnomon
