#include "surfaces.h"

#include <gnomon/kit/geometry/edges.h>

#include <algorithm>

namespace gnomon::radiosity {

double longest_side(const Scene& scene) {
  const Bounds bounds = scene.bounds();
  const glm::vec3 sides = bounds.max - bounds.min;
  return std::max({sides.x, sides.y, sides.z});
}

void Surfaces::build(const Scene& of, double patch_size) {
  scene = &of;
  size = longest_side(of);
  faces.emplace(of);
  patches.emplace(*faces, patch_size * size);
  casters.emplace(of, Truth::mesh, RayScene::Which::casters);
  all.emplace(of, Truth::mesh, RayScene::Which::all);
  solid_parts = gnomon::solid_parts(of);
}

}  // namespace gnomon::radiosity
