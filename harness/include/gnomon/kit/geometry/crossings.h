#pragma once
#include <gnomon/kit/geometry/holes.h>

#include <algorithm>
#include <concepts>

namespace gnomon {

/// The triangles with transmission that a way crosses, and what is left of the light behind them. A product in double depends
/// on the order of its factors, and a tree of boxes has none: everybody sorts by mesh and triangle, counts each once, which a
/// ray tracer may report twice, and multiplies in that order. So all exact answers are the same, bit for bit.
class Crossings {
 public:
  struct Crossed {
    std::uint32_t mesh, triangle;
    auto operator<=>(const Crossed&) const = default;
  };

  void clear() { crossed_.clear(); }
  bool empty() const { return crossed_.empty(); }
  void add(std::uint32_t mesh, std::uint32_t triangle) { crossed_.push_back({mesh, triangle}); }
  /// Takes out those of which `is_out` says so.
  template <std::predicate<const Crossed&> IsOut>
  void erase_if(const IsOut& is_out) {
    std::erase_if(crossed_, is_out);
  }
  std::span<const Crossed> sorted() {
    if (crossed_.size() > 1) {
      std::ranges::sort(crossed_);
      crossed_.erase(std::unique(crossed_.begin(), crossed_.end()), crossed_.end());
    }
    return crossed_;
  }

  struct Product {
    glm::dvec3 share{1};  ///< red, green, blue; 0 exactly behind an opaque texel
    int surfaces = 0;     ///< crossed, those that let everything through left out
  };
  /// `transmission(mesh, triangle)` is what each lets through: three floats in 0 .. 1.
  template <std::invocable<std::uint32_t, std::uint32_t> Transmission>
  Product product(const Transmission& transmission) {
    Product result;
    for (const Crossed& crossed : sorted()) {
      const glm::vec3 factor = transmission(crossed.mesh, crossed.triangle);
      if (factor == glm::vec3(1)) continue;
      result.share *= glm::dvec3(factor);
      ++result.surfaces;
    }
    return result;
  }
  /// Along a segment, exactly (transmission_at).
  Product product(const Scene& scene, const Segment& segment) {
    return product(
        [&](std::uint32_t mesh, std::uint32_t triangle) { return transmission_at(scene.meshes[mesh], triangle, segment); });
  }

 private:
  std::vector<Crossed> crossed_;
};

}  // namespace gnomon
