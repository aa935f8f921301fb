#pragma once
#include <gnomon/kit/geometry/edges.h>
#include <gnomon/kit/geometry/holes.h>
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

/// The share of a patch that is solid, found at the middles of 32 x 32 parts of it; 1 without an alpha mask.
inline double solid_share(const Scene& scene, const Division& division, const Element& patch) {
  constexpr int side = 32;
  const Face& face = division.face_of(patch);
  const Mesh& mesh = scene.meshes[face.mesh];
  if (!mesh.alpha_mask) return 1;
  int asked = 0, solid = 0;
  for (int j = 0; j < side; ++j)
    for (int i = 0; i < side; ++i) {
      const glm::dvec2 in((i + 0.5) / side, (j + 0.5) / side);
      if (face.is_triangle && in.x + in.y > 1) continue;
      const glm::dvec2 place = patch.low + patch.step * in;
      ++asked;
      solid += is_solid_along(mesh, face.triangle_at(place), face.at(place), face.normal);
    }
  return static_cast<double>(solid) / asked;
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
    all.emplace(of, Truth::mesh, RayScene::Which::seen);
    solid_parts = gnomon::solid_parts(of);
    solid_shares.clear();
    if (!of.has_alpha_masks()) return;
    for (std::size_t p = 0; p < patches->patch_count(); ++p)
      solid_shares.push_back(static_cast<float>(radiosity::solid_share(of, *patches, patches->elements()[p])));
  }
  /// Of what comes to a patch, the share that does not go through its holes.
  double solid_share(std::size_t patch) const { return solid_shares.empty() ? 1 : solid_shares[patch]; }

  const Scene* scene = nullptr;
  std::optional<Faces> faces;
  std::optional<Division> patches;  ///< not divided further
  std::optional<RayScene> casters;  ///< what hides a lamp
  std::optional<RayScene> all;      ///< what light between surfaces meets
  SolidParts solid_parts;
  std::vector<float> solid_shares;  ///< of each patch; empty where no mesh has holes
  double size = 0;                  ///< longest side of the scene's box, meters
};

}  // namespace gnomon::radiosity
