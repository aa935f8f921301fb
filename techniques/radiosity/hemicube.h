#pragma once
#include <gnomon/kit/gl/gl.h>

#include <span>
#include <vector>

#include "division.h"

namespace gnomon::radiosity {

/// What a point sees of a half-space, drawn on the upper half of a cube around it (Cohen and Greenberg 1985): one square on
/// top, four half squares around. The delta factor of a texel is the form factor from the point to it.
class Hemicube {
 public:
  static GlLimits needs(int resolution) { return {.texture_size = 3 * resolution}; }
  void setup();
  /// What will be seen: the undivided elements of a division, by their place in `elements`.
  void show(const Division& division, std::span<const std::uint32_t> elements);
  /// The form factor from a point to each of the elements shown is added to `shares`, by place; the result is the share that
  /// meets none of them. `normal` is unit, `resolution` the texels of the top's side.
  double look(const glm::dvec3& from, const glm::dvec3& normal, int resolution, std::span<double> shares);

  /// Rows of `resolution` texels of the last look: the top, then the sides right, left, up and down, each from its upper border
  /// to the horizon. A texel holds the place of an element, plus 1, or 0.
  const std::vector<std::uint32_t>& texels() const { return ids_; }
  /// Delta factors of these texels.
  const std::vector<float>& delta_factors() const { return deltas_; }
  std::size_t bytes() const { return ids_texture_.bytes + depth_.bytes + vertices_.bytes + bytes_of(ids_, deltas_); }

 private:
  void fit(int resolution);
  Program program_;
  Framebuffer framebuffer_;
  Texture ids_texture_, depth_;
  VertexArray vertex_array_;
  Buffer vertices_;
  std::size_t vertex_count_ = 0;
  /// Meters: a power of two, a millionth of the size of what is shown, which is as near as float32 can tell.
  double near_plane_ = 1;
  int resolution_ = 0;
  std::vector<std::uint32_t> ids_;
  std::vector<float> deltas_;
};

/// The delta factors of a hemicube, in the order of Hemicube::texels.
std::vector<float> delta_factors(int resolution);

}  // namespace gnomon::radiosity
