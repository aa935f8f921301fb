#pragma once
#include <gnomon/kit/geometry/crossings.h>
#include <gnomon/kit/geometry/receiver.h>

namespace gnomon {

/// What techniques that decide points one by one say of a point with nothing opaque on its way to the light.
struct LightThrough {
  static constexpr std::uint32_t no_triangle = 0xffffffffu;
  float share = 1;                       ///< of the light that arrives, red of three
  std::uint32_t triangle = no_triangle;  ///< counted over the scene: of those that let least through the first; see `share`
};

/// Of the triangles with transmission that the way crosses. No triangle is named exactly where the share is 1.
inline LightThrough light_through(Crossings& crossings, const Scene& scene, const TriangleNumbers& numbers,
                                  const Segment& segment) {
  LightThrough light;
  float least = 1;
  const Crossings::Product product = crossings.product([&](std::uint32_t mesh, std::uint32_t triangle) {
    const glm::vec3 factor = transmission_at(scene.meshes[mesh], triangle, segment);
    if (factor.x < least) {
      least = factor.x;
      light.triangle = numbers.first_of(mesh) + triangle;
    }
    return factor;
  });
  light.share = static_cast<float>(product.share.x);
  return light;
}

}  // namespace gnomon
