#include <gnomon/kit/pixel_groups.h>

#include <cmath>

namespace gnomon {

PixelGroup group_of(const GBuffer& gbuffer, std::span<const std::uint32_t> pixels) {
  PixelGroup group;
  bool is_flat = true;
  const glm::dvec3 normal = gbuffer.normal(pixels[0]);
  double height = INFINITY, highest = -INFINITY;
  for (const std::uint32_t i : pixels) {
    const glm::vec3 p = gbuffer.position(i);
    group.box.add(p);
    is_flat &= glm::dvec3(gbuffer.normal(i)) == normal;
    height = std::min(height, glm::dot(normal, glm::dvec3(p)));
    highest = std::max(highest, glm::dot(normal, glm::dvec3(p)));
  }
  if (is_flat) group.above = {normal, height, highest};
  return group;
}

std::pair<std::span<std::uint32_t>, std::span<std::uint32_t>> halve(const GBuffer& gbuffer, const Bounds& box,
                                                                    std::span<std::uint32_t> pixels) {
  const glm::vec3 size = box.max - box.min;
  const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
  const auto before = [&](std::uint32_t a, std::uint32_t b) {
    const float at_a = gbuffer.position(a)[axis], at_b = gbuffer.position(b)[axis];
    return at_a != at_b ? at_a < at_b : a < b;
  };
  const std::size_t half = pixels.size() / 2;
  std::nth_element(pixels.begin(), pixels.begin() + static_cast<std::ptrdiff_t>(half), pixels.end(), before);
  return {pixels.first(half), pixels.subspan(half)};
}

std::size_t tile_count(const GBuffer& gbuffer) {
  const auto along = [](int size) { return static_cast<std::size_t>((size + tile_side - 1) / tile_side); };
  return along(gbuffer.width) * along(gbuffer.height);
}

}  // namespace gnomon
