#pragma once
// Casters with transmission made by hand: cards, textures and rectangles.
#include <array>

#include "masked.h"

namespace gnomon::glass {

/// What float32 makes of these is what triangles of test scenes let through: nothing, some, and all.
inline constexpr std::array<float, 6> shares = {0, 0.05f, 0.25f, 0.5f, 0.9f, 1};
inline float any_share(Random& random) { return shares[random.below(static_cast<std::uint32_t>(shares.size()))]; }

inline std::shared_ptr<const Transmission> constant(const glm::vec3& share) {
  return std::make_shared<const Transmission>(share);
}
/// Gray texels, row after row.
inline std::shared_ptr<const Transmission> texels(int width, int height, std::vector<float> values,
                                                  masked::Wrap wrap_u = masked::Wrap::repeat,
                                                  masked::Wrap wrap_v = masked::Wrap::repeat) {
  return std::make_shared<const Transmission>(width, height, 1, std::move(values), wrap_u, wrap_v);
}
/// Gray, of at most so many texels a side, each one of `shares`, and of any wraps.
inline std::shared_ptr<const Transmission> any_texels(Random& random, std::uint32_t most) {
  const int width = 1 + static_cast<int>(random.below(most)), height = 1 + static_cast<int>(random.below(most));
  const masked::Wrap wrap_u = masked::wraps[random.below(3)], wrap_v = masked::wraps[random.below(3)];
  std::vector<float> values;
  for (int i = 0; i < width * height; ++i) values.push_back(any_share(random));
  return texels(width, height, std::move(values), wrap_u, wrap_v);
}

/// The mesh with its alpha mask, if any. `uv` has one place for each position, or none where the transmission is constant.
inline Mesh with_transmission(Mesh mesh, std::shared_ptr<const Transmission> transmission, std::vector<glm::vec2> uv = {}) {
  mesh.transmission = std::move(transmission);
  if (!uv.empty()) mesh.uv = std::move(uv);
  return mesh;
}
/// The same everywhere: red, green, blue.
inline Mesh with_transmission(Mesh mesh, const glm::vec3& share) { return with_transmission(std::move(mesh), constant(share)); }

/// Square of side 2 * half at a height, gray, the same everywhere. Its diagonal goes from -x, -z to +x, +z.
inline Mesh glass_card(float half, float height, float share) {
  return with_transmission(hand_made::square(half, height), glm::vec3(share));
}
/// With texels: u runs along x and v along z, `times` times the texture.
inline Mesh glass_card(float half, float height, std::shared_ptr<const Transmission> transmission, float times = 1) {
  return with_transmission(hand_made::square(half, height), std::move(transmission),
                           {{0, 0}, {0, times}, {times, times}, {times, 0}});
}

/// masked::random_cards with transmission and no mask.
inline Mesh random_glass_cards(Random& random, int count, float half, float size,
                               std::shared_ptr<const Transmission> transmission) {
  return with_transmission(masked::random_cards(random, count, half, size, nullptr), std::move(transmission));
}

/// A triangle within 0.3 units of a random center along each axis, tilted, that lets half of the light through; and the same
/// opaque. What lies in its plane 1.5 units or more aside of the center meets neither it nor its box.
struct TiltedTriangle {
  Scene scene, opaque;
  glm::dvec3 center, along, aside;  ///< the last two of one unit, in its plane
  explicit TiltedTriangle(Random& random, double unit = 1) : center(unit * random.uniform(glm::dvec3(-1), glm::dvec3(1))) {
    std::vector<glm::vec3> corners;
    for (int k = 0; k < 3; ++k) corners.emplace_back(center + unit * random.uniform(glm::dvec3(-0.3), glm::dvec3(0.3)));
    opaque.meshes = {hand_made::mesh_of(corners, {{0, 1, 2}})};
    scene.meshes = {with_transmission(opaque.meshes[0], glm::vec3(0.5f))};
    const glm::dvec3 normal = glm::normalize(opaque.meshes[0].corners(0).normal()), a(corners[0]), b(corners[1]);
    center = (a + b) / 2.0;
    along = unit * glm::normalize(b - a);
    aside = glm::cross(normal, along);
  }
  glm::vec3 at(double s, double t) const { return center + s * along + t * aside; }
};

}  // namespace gnomon::glass
