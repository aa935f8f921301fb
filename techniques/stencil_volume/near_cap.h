#pragma once
#include <gnomon/kit/geometry/camera.h>
#include <gnomon/kit/volumes/volume_faces.h>

namespace stencil_volume {
using namespace gnomon;

/// Casters between the light and the near plane, thrown onto that plane from the light. `clip_from_world` holds the projection.
inline const std::string near_cap_vertex = std::string(position_snippet) + R"(
uniform vec4 plane;            // near plane, turned to the light
uniform float light_height;    // of the homogeneous light over it
uniform float light_w;
out float gl_ClipDistance[2];
void main() {
  float height = dot(plane.xyz, position) + plane.w;
  gl_ClipDistance[0] = height;
  gl_ClipDistance[1] = light_height - height * light_w;
  gl_Position = place(vec4(position, 1));
}
)";

/// Draws the light caps that are bound to the drawer, between light and near plane, thrown onto the plane: M = (P.L) I - L P^T,
/// as for planar projected shadows. `program` has near_cap_vertex.
inline void draw_near_cap(const VolumeProgram& program, const FaceDrawer& drawer, const VolumeCounter& counter,
                          const GBuffer& gbuffer, const Scene& scene, const glm::dvec4& light) {
  const Camera camera(gbuffer.view, gbuffer.width, gbuffer.height);
  const double near_plane = gbuffer_textures(gbuffer, scene).near_plane;
  glm::dvec4 plane(camera.forward, -glm::dot(camera.forward, camera.eye) - near_plane);
  const bool behind = glm::dot(plane, light) < 0;  // the light looks the eye's way
  if (behind) plane = -plane;
  const double height = glm::dot(plane, light);
  const glm::dmat4 projected = height * glm::dmat4(1) - glm::outerProduct(light, plane);
  const glm::dmat4 clip = clip_from_world(gbuffer, scene) * projected;
  program.each([&](const Program& p) {
    p.set("clip_from_world", glm::mat4(clip));
    p.set("plane", glm::vec4(plane));
    p.set("light_height", static_cast<float>(height));
    p.set("light_w", static_cast<float>(light.w));
  });
  glEnable(GL_CLIP_DISTANCE0);
  glEnable(GL_CLIP_DISTANCE1);
  // Seen with the light they keep their turn, seen against it they change it.
  drawer.draw_light_caps(counter, program, !behind);
  glDisable(GL_CLIP_DISTANCE0);
  glDisable(GL_CLIP_DISTANCE1);
}

}  // namespace stencil_volume
