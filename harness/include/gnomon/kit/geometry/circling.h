#pragma once
// Motions of generated scenes that come back to where they started.
#include <gnomon/scene.h>

#include <cmath>
#include <numbers>

namespace gnomon {

/// The weights cos(w t) - 1 and sin(w t), w = 2 pi / `period`, of two morph targets A and B: a vertex is away from its place by
/// cos(w t) A + sin(w t) B - A. It goes around an ellipse, which is a line where A and B are parallel. One period of cubic keys
/// with exact tangents: the weights are off by less than 4e-6, (2 pi / 32)^4 / 384.
inline Track circling_weights(std::uint32_t node, double period) {
  constexpr int key_count = 32;
  const double speed = 2 * std::numbers::pi / period;
  Track track{node, Track::Property::weights, Track::Interpolation::cubic, {}, {}};
  for (int k = 0; k <= key_count; ++k) {
    const double angle = 2 * std::numbers::pi * (k % key_count) / key_count;  // the last key is the first to the bit
    const double c = std::cos(angle), s = std::sin(angle);
    track.times.push_back(period * k / key_count);
    for (const double value : {-speed * s, speed * c, c - 1, s, -speed * s, speed * c}) track.values.push_back(value);
  }
  return track;
}

/// The rig of a mesh of the scene whose vertices are, before it moves, where they are.
inline Rig rig_at_rest(const Scene& scene, std::uint32_t mesh, std::uint32_t node) {
  Rig rig;
  rig.mesh = mesh;
  rig.node = node;
  for (const glm::vec3& p : scene.meshes[mesh].positions) rig.base.emplace_back(p);
  return rig;
}

}  // namespace gnomon
