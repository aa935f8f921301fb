#pragma once
#include <gnomon/kit/geometry/edges.h>
#include <gnomon/kit/rays/rays.h>
#include <gnomon/scene.h>

#include <optional>
#include <vector>

#include "division.h"

namespace gnomon::radiosity {

/// What a scene is made of, the same for every light.
struct Surfaces {
  /// `patch_size` as a share of the longest side of the scene's box.
  void build(const Scene& scene, double patch_size);

  const Scene* scene = nullptr;
  std::optional<Faces> faces;
  std::optional<Division> patches;  ///< not divided further
  std::optional<RayScene> casters;  ///< what hides a lamp
  std::optional<RayScene> all;      ///< what light between surfaces meets
  SolidParts solid_parts;
  double size = 0;  ///< longest side of the scene's box, meters
};
double longest_side(const Scene& scene);

}  // namespace gnomon::radiosity
