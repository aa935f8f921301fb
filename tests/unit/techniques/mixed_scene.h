#pragma once
// Scenes of six kinds, one after the other, for techniques that answer at points and for those that cut triangles.
#include <gnomon/kit/geometry/shapes.h>

#include "hard_scenes.h"

namespace gnomon::exact_oracle {

constexpr int mixed_kinds = 6;

/// Soups on a grid and off it, boxes wall to wall and through each other, cycles, stacks of coplanar triangles, a fine mesh.
inline Scene mixed_scene(Random& random, std::mt19937& engine, int kind) {
  Scene scene;
  switch (kind % mixed_kinds) {
    case 0:
      scene.meshes = {hard_scenes::grid_soup(random, 60)};
      break;
    case 1:
      scene.meshes = {hard_scenes::boxes(random, 8, true)};
      break;
    case 2:
      scene.meshes = {hard_scenes::boxes(random, 8, false), hand_made::square(5, -2)};
      break;
    case 3:
      scene.meshes = {hard_scenes::cycle(1, 1), hard_scenes::cycle(2, 0.5f), hand_made::square(4, 0)};
      break;
    case 4:
      scene.meshes = {small_world::random_soup(engine, 300, 2, 0.1f, 2, 0.4f), hand_made::square(3, 0)};
      break;
    case 5:
      scene.meshes = {tessellate(Sphere{{0, 0, 0}, 1}, 24, "sphere"), hand_made::square(4, -1.5f)};
      scene.meshes[0].shape.reset();
      break;
  }
  return scene;
}

}  // namespace gnomon::exact_oracle
