#pragma once
// Small scenes and G-buffers made by hand, for tests whose answers are derived on paper.
#include <gnomon/gbuffer.h>

#include <vector>

namespace gnomon::hand_made {

/// A G-buffer that owns its arrays.
struct Picture {
  std::vector<float> value[6];
  std::vector<std::uint32_t> mesh, triangle;
  GBuffer gbuffer;

  Picture(int width, int height, Truth truth = Truth::mesh) {
    const std::size_t size = static_cast<std::size_t>(width) * height;
    for (auto& v : value) v.assign(size, 0);
    mesh.assign(size, no_mesh);
    triangle.assign(size, 0);
    gbuffer.truth = truth;
    gbuffer.width = width;
    gbuffer.height = height;
    std::span<const float>* targets[] = {&gbuffer.px, &gbuffer.py, &gbuffer.pz, &gbuffer.nx, &gbuffer.ny, &gbuffer.nz};
    for (int k = 0; k < 6; ++k) *targets[k] = value[k];
    gbuffer.mesh = mesh;
    gbuffer.triangle = triangle;
  }
  Picture(const Picture&) = delete;
  void set(std::size_t i, const glm::vec3& point, const glm::vec3& normal, std::uint32_t m, std::uint32_t t) {
    for (int k = 0; k < 3; ++k) {
      value[k][i] = point[k];
      value[3 + k][i] = normal[k];
    }
    mesh[i] = m;
    triangle[i] = t;
  }
};

inline Mesh mesh_of(std::vector<glm::vec3> positions, std::vector<glm::uvec3> triangles) {
  Mesh mesh;
  mesh.positions = std::move(positions);
  mesh.triangles = std::move(triangles);
  finish(mesh);
  return mesh;
}

/// Square of side 2 * half at a height, facing up: triangles 0 and 1.
inline Mesh square(float half, float height) {
  return mesh_of({{-half, height, -half}, {-half, height, half}, {half, height, half}, {half, height, -half}},
                 {{0, 1, 2}, {0, 2, 3}});
}

inline Light point_light(const glm::vec3& position) { return {.name = "point", .kind = PointLight{position}}; }
inline Light sun(const glm::vec3& direction) { return {.name = "sun", .kind = DirectionalLight{direction}}; }

}  // namespace gnomon::hand_made
