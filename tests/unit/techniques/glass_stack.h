#pragma once
// The stack on paper, for maps that hold what part of the light glass lets through: three cards, and a receiver behind each.
#include "glass.h"
#include "glass_maps_rig.h"

namespace glass_stack {
using namespace gnomon;

/// From above 1/2, 3/4 and 1/5 of the light pass the cards, so behind one, two and all of them there are .5, .375 and .075.
inline constexpr float passes[] = {0.5f, 0.75f, 0.2f}, heights[] = {8, 5, 3}, receiver_heights[] = {6.5f, 4, 1};
inline constexpr double left[] = {0.5, 0.375, 0.075};

inline const Light steep_sun{.name = "sun", .kind = DirectionalLight{{0.02f, -1, 0.01f}}};
inline const Light high_point{.name = "point", .kind = PointLight{{0.2f, 10, 0.3f}}};
inline const Light high_spot{.name = "spot", .kind = SpotLight{.position = {0.2f, 10, 0.3f}, .direction = {0, -1, 0}}};

inline Mesh unseen(Mesh mesh) {
  mesh.seen = mesh.receives = false;
  return mesh;
}

/// Meshes 0 to 2 are receivers, side by side, which no card but those above them takes light from. Wherever a receiver is, so
/// are the cards: no edge is near.
inline Scene stack() {
  Scene scene;
  scene.name = "stack";
  for (int k = 0; k < 3; ++k) {
    Mesh receiver = glass_maps_rig::moved(hand_made::square(0.45f, receiver_heights[k]), {static_cast<float>(k - 1), 0, 0});
    receiver.casts = false;
    scene.meshes.push_back(receiver);
  }
  for (int k = 0; k < 3; ++k) scene.meshes.push_back(unseen(glass::glass_card(4, heights[k], passes[k])));
  scene.views = {{.name = "view", .eye = {0, 13, 4}, .target = {0, 4, 0}, .fov_y_degrees = 24}};
  scene.lights = {steep_sun, high_point, high_spot};
  return scene;
}

/// Calls visit(pixel, receiver) for each pixel that shows one of the receivers; answers how many there are of the rarest.
template <class Visit>
int for_receivers(const GBuffer& gbuffer, const Visit& visit) {
  std::array<int, 3> counts{};
  for (std::size_t i = 0; i < gbuffer.size(); ++i) {
    if (gbuffer.is_background(i) || gbuffer.mesh[i] > 2) continue;
    ++counts[gbuffer.mesh[i]];
    visit(i, gbuffer.mesh[i]);
  }
  return *std::ranges::min_element(counts);
}

}  // namespace glass_stack
