#pragma once
// Alpha masks and cards with holes made by hand.
#include <gnomon/kit/random.h>

#include <array>
#include <string_view>

#include "hand_made.h"

namespace gnomon::masked {

using Wrap = AlphaMask::Wrap;
inline constexpr std::array<Wrap, 3> wraps = {Wrap::repeat, Wrap::mirror, Wrap::clamp};

/// Rows of texels, '#' where solid.
inline std::shared_ptr<const AlphaMask> mask_of(const std::vector<std::string_view>& rows, Wrap wrap_u = Wrap::repeat,
                                                Wrap wrap_v = Wrap::repeat) {
  std::vector<std::uint8_t> alpha;
  for (const std::string_view row : rows)
    for (const char texel : row) alpha.push_back(texel == '#' ? 255 : 0);
  return std::make_shared<const AlphaMask>(static_cast<int>(rows[0].size()), static_cast<int>(rows.size()), alpha, 1.0f, 0.5f,
                                           wrap_u, wrap_v);
}

/// Set where column + row is even.
inline std::shared_ptr<const AlphaMask> checker(int width, int height) {
  std::vector<std::uint8_t> alpha;
  for (int i = 0; i < width * height; ++i) alpha.push_back((i % width + i / width) % 2 == 0 ? 255 : 0);
  return std::make_shared<const AlphaMask>(width, height, alpha);
}

/// Every texel solid or a hole by chance.
inline std::shared_ptr<const AlphaMask> random_mask(Random& random, int width, int height, Wrap wrap_u = Wrap::repeat,
                                                    Wrap wrap_v = Wrap::repeat) {
  std::vector<std::uint8_t> alpha;
  for (int i = 0; i < width * height; ++i) alpha.push_back(random.below(2) ? 255 : 0);
  return std::make_shared<const AlphaMask>(width, height, alpha, 1.0f, 0.5f, wrap_u, wrap_v);
}

/// One of at most so many texels a side, and of any wraps.
inline std::shared_ptr<const AlphaMask> any_mask(Random& random, std::uint32_t most) {
  // One number after the other: the arguments of a call are drawn in another order by each compiler.
  const int width = 1 + static_cast<int>(random.below(most)), height = 1 + static_cast<int>(random.below(most));
  const Wrap wrap_u = wraps[random.below(3)], wrap_v = wraps[random.below(3)];
  return random_mask(random, width, height, wrap_u, wrap_v);
}

inline Mesh with_mask(Mesh mesh, std::shared_ptr<const AlphaMask> mask, std::vector<glm::vec2> uv) {
  mesh.alpha_mask = std::move(mask);
  mesh.uv = std::move(uv);
  return mesh;
}

/// The triangle of the vectors on paper: 4 m along x and along z from (0, 2, 0), and u and v with them from 0 to 1. The way
/// from (1, 0, 1) to (3, 6, 2) meets it at (5/3, 2, 4/3): u = 5/12, v = 1/3.
inline Mesh triangle_on_paper(std::shared_ptr<const AlphaMask> mask) {
  return with_mask(hand_made::mesh_of({{0, 2, 0}, {4, 2, 0}, {0, 2, 4}}, {{0, 1, 2}}), std::move(mask),
                   {{0, 0}, {1, 0}, {0, 1}});
}

/// Square of side 2 * half at a height; u runs along x and v along z, `times` times the mask.
inline Mesh card(float half, float height, std::shared_ptr<const AlphaMask> mask, float times = 1) {
  return with_mask(hand_made::square(half, height), std::move(mask), {{0, 0}, {0, times}, {times, times}, {times, 0}});
}

/// Rectangles of two triangles each, anywhere in a cube, turned anyhow, with uv up to +-2.
inline Mesh random_cards(Random& random, int count, float half, float size, std::shared_ptr<const AlphaMask> mask) {
  std::vector<glm::vec3> positions;
  std::vector<glm::uvec3> triangles;
  std::vector<glm::vec2> uv;
  for (int i = 0; i < count; ++i) {
    const glm::dvec3 corner = random.uniform(glm::dvec3(-half, 0.2 * half, -half), glm::dvec3(half));
    const glm::dvec3 along = random.uniform(glm::dvec3(-size), glm::dvec3(size)),
                     aside = random.uniform(glm::dvec3(-size), glm::dvec3(size));
    const auto first = static_cast<std::uint32_t>(positions.size());
    for (const glm::dvec3& p : {corner, corner + along, corner + along + aside, corner + aside}) {
      positions.emplace_back(p);
      const double u = random.uniform(-2, 2), v = random.uniform(-2, 2);
      uv.emplace_back(u, v);
    }
    triangles.push_back({first, first + 1, first + 2});
    triangles.push_back({first, first + 2, first + 3});
  }
  return with_mask(hand_made::mesh_of(std::move(positions), std::move(triangles)), std::move(mask), std::move(uv));
}

}  // namespace gnomon::masked
