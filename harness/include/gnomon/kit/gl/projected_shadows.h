#pragma once
#include <gnomon/kit/geometry/plane_projection.h>
#include <gnomon/kit/gl/gl.h>

namespace gnomon {

/// Writes `darkened`; with blending, multiplies by it.
inline constexpr std::string_view shadow_fragment = R"(
uniform float darkened;
layout(location = 0) out float visibility;
void main() {
#ifdef MASKED
  if (in_hole()) discard;
#endif
  visibility = darkened;
}
)";

/// What the triangle lets through at its place, to be multiplied by.
inline std::string glass_fragment() {
  return std::string(transmission_fragment_snippet) + R"(
layout(location = 0) out float visibility;
void main() {
#ifdef MASKED
  if (in_hole()) discard;
#endif
  visibility = transmission_here();
}
)";
}

/// A vertex shader of casters for glass_fragment. GLASS is defined in it.
inline std::string glass_vertex(const std::string& vertex) {
  return std::string(transmission_vertex_snippet) + "#define GLASS\n#define main place_caster\n" + vertex + R"(
#undef main
void main() {
  place_caster();
  hand_on_transmission();
}
)";
}

/// The shadows that casters throw, flattened by a vertex shader such as projection_vertex, into a picture of one channel of
/// float32 that holds 1 where there is none. Opaque casters write `darkened`; glass multiplies by what each triangle lets
/// through. Products commute but for rounding. The rasterizer gives a pixel on the edge of two triangles to one of them, so
/// that a surface counts once there; a thin box is two surfaces and counts twice.
struct ShadowPrograms {
  CasterPrograms opaque, glass;
  ShadowPrograms() = default;
  ShadowPrograms(std::string title, std::string vertex)
      : opaque(title, vertex, shadow_fragment), title_(std::move(title)), vertex_(std::move(vertex)) {}
  /// For `build`: compiles those of glass at the first scene that has some, whose device has room for it.
  void fit(const Scene& scene) {
    opaque.fit(scene);
    if (!scene.has_transmission()) return;
    if (!glass.solid()) glass = CasterPrograms(title_ + " of glass", glass_vertex(vertex_), glass_fragment());
    glass.fit(scene);
  }
  /// Of both.
  void set(const char* uniform, const auto& value) const {
    opaque.set(uniform, value);
    if (glass.solid()) glass.set(uniform, value);
  }
  /// Draws meshes that have a transmission. Leaves blending on, for products.
  void draw_glass(const SceneBuffers& buffers, const std::vector<std::uint32_t>& meshes) const {
    buffers.bind_transmissions();
    glEnable(GL_BLEND);
    glBlendFunc(GL_ZERO, GL_SRC_COLOR);
    buffers.draw(meshes, glass);
  }

 private:
  std::string title_, vertex_;
};

}  // namespace gnomon
