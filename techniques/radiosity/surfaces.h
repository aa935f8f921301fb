#pragma once
#include <gnomon/kit/geometry/edges.h>
#include <gnomon/kit/rays/rays.h>
#include <gnomon/scene.h>

#include <algorithm>
#include <optional>

#include "division.h"

namespace gnomon::radiosity {

/// Of the scene's box, meters.
inline double longest_side(const Scene& scene) {
  const Bounds bounds = scene.bounds();
  const glm::vec3 sides = bounds.max - bounds.min;
  return std::max({sides.x, sides.y, sides.z});
}

/// What a scene is made of, the same for every light.
struct Surfaces {
  /// `patch_size` as a share of the longest side of the scene's box.
  void build(const Scene& of, double patch_size) {
    scene = &of;
    size = longest_side(of);
    faces.emplace(of);
    patches.emplace(*faces, patch_size * size);
    casters.emplace(of, Truth::mesh, RayScene::Which::casters);
    all.emplace(of, Truth::mesh, RayScene::Which::all);
    solid_parts = gnomon::solid_parts(of);
  }

  const Scene* scene = nullptr;
  std::optional<Faces> faces;
  std::optional<Division> patches;  ///< not divided further
  std::optional<RayScene> casters;  ///< what hides a lamp
  std::optional<RayScene> all;      ///< what light between surfaces meets
  SolidParts solid_parts;
  double size = 0;  ///< longest side of the scene's box, meters
};

}  // namespace gnomon::radiosity
