#pragma once
#include "small_world.h"

// Scenes for whoever looks at maps.
namespace map_scenes {
using namespace gnomon;

/// Loose triangles and a box over a ground: casters at every height, before and beside each other.
inline Scene soup_over_ground(unsigned seed) {
  std::mt19937 random(seed);
  Scene scene;
  scene.meshes = {small_world::ground(3), small_world::random_soup(random, 25, 1.5f, 0.6f, 2.0f, 0.6f),
                  small_world::box({-2.5f, 0, -2.5f}, {-1.5f, 1, -1.2f})};
  return scene;
}

}  // namespace map_scenes
