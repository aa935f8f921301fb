#pragma once
#include <gnomon/kit/gl.h>
#include <gnomon/scene.h>

#include <algorithm>
#include <cmath>

namespace stencil_volume {
using namespace gnomon;

/// Where the eye lies among the shadow volumes of single triangles, worst case first.
enum class EyePlace {
  outside,
  near_plane,  ///< outside, but within reach of the near rectangle
  inside,
  boundary,  ///< within rounding of a boundary: inside for one rounding, outside for another
};

/// In double, with a tolerance of 2^-20 of the scene's extent (16 float32 roundings of its largest coordinate): the volume of a
/// triangle is what lies behind its plane and inside the three planes through its edges and the light.
inline EyePlace eye_place(const Scene& scene, const Light& light, const View& view) {
  const glm::dvec4 l = homogeneous(light);
  const glm::dvec3 eye(view.eye);
  const double tolerance = 0x1p-20 * extent(scene, light, view);
  // Half the diagonal of the widest view is below 16 near planes for every field of view up to 170 degrees.
  const double reach = 16 * double(near_plane) + tolerance;
  EyePlace worst = EyePlace::outside;
  for (const Mesh& mesh : scene.meshes) {
    if (!mesh.casts) continue;
    for (const glm::uvec3& t : mesh.triangles) {
      const glm::dvec3 p[3] = {mesh.positions[t.x], mesh.positions[t.y], mesh.positions[t.z]};
      const glm::dvec3 normal = glm::cross(p[1] - p[0], p[2] - p[0]);
      const double turn = glm::dot(normal, to_light(l, p[0]));
      if (turn == 0) continue;
      const double sign = turn > 0 ? 1 : -1;
      // Heights of the eye over the four planes, positive inside.
      double least = -sign * glm::dot(normal, eye - p[0]) / glm::length(normal);
      for (int k = 0; k < 3 && least > -reach; ++k) {
        const glm::dvec3 &a = p[k], &b = p[(k + 1) % 3];
        const glm::dvec3 side = glm::cross(b - a, to_light(l, a));
        least = std::min(least, -sign * glm::dot(side, eye - a) / glm::length(side));
      }
      if (least <= -reach) continue;
      worst = std::max(worst, least > tolerance    ? EyePlace::inside
                              : least < -tolerance ? EyePlace::near_plane
                                                   : EyePlace::boundary);
    }
  }
  return worst;
}

}  // namespace stencil_volume
