#pragma once
#include <gnomon/kit/gl/gl.h>
#include <gnomon/kit/pictures/layers.h>

namespace gnomon {

// Shadow volumes counted by the rasterizer. A technique draws the faces of its volumes, each wound counter-clockwise seen from
// outside, between `begin` and `write_mask`; what is counted at a pixel is how many volumes hold its point, modulo 256 in the
// stencil buffer and without wrapping in a wide count.

/// Where faces are counted: before the surface (z-pass) or behind it (z-fail, which needs both caps).
enum class CountWhere { before_surface, behind_surface };

/// What the faces of one draw are counted as.
enum class VolumeFace { side, light_cap, dark_cap };

/// One vertex shader with what its faces are needed for: counting in the stencil, in 32 bits, and being looked at. The vertex
/// source declares `position_snippet`. With `own_mesh`, a face leaves alone the pixels of the mesh that the uniform `int
/// own_mesh` names (plus one), since a convex body casts no shadow on the side of its own surface that faces the light; the ids
/// of the G-buffer must be bound then.
struct VolumeProgram {
  Program stencil, wide, layer;
  VolumeProgram() = default;
  VolumeProgram(std::string_view title, std::string_view vertex, bool own_mesh = false);
  /// Calls set(program) for all three.
  template <class Set>
  void each(Set&& set) const {
    for (const Program* program : {&stencil, &wide, &layer}) set(*program);
  }
};

/// What n surfaces that each let `transmission` of the light through leave of it together: its powers for n = 0, 1, 2 and so
/// on, computed in double and rounded once to float32. Ends at n = most, or at the first power that is 0.
std::vector<float> powers_of(float transmission, std::size_t most);

class VolumeCounter {
 public:
  enum class Pass { stencil, wide, layer };
  /// How many volumes the stencil counts.
  static constexpr int stencil_limit = 255;

  /// Makes programs and the framebuffer.
  void setup();
  /// Clears the count to `start` and sets the state that draws count in. In Pass::layer, faces in front of the surface are
  /// gathered for `layer_faces`, whatever `where` says. In the other passes nothing is counted far from all pixels of
  /// `gbuffer` that show a receiver. Sizes are those of `depth`. Bind nothing to texture unit 3.
  void begin(const DepthStencil& depth, const GBufferTextures& gbuffer, Pass pass, CountWhere where, int start = 0);
  /// Puts the program of this pass in use and says what is drawn next. `reversed`: faces are wound clockwise seen from outside.
  void use(const VolumeProgram& program, VolumeFace face, bool reversed = false) const;
  /// Ends a pass that makes no mask: lets go of the depth texture.
  void end() const;
  /// Ends counting: mask 0 where the count is not zero and the pixel faces the light, else 1. Not in Pass::layer.
  void write_mask(const GBufferTextures& gbuffer, const Light& light, VisibilityMask& mask);
  /// Ends counting: multiplies the mask by powers[count] where the pixel faces the light. `powers` holds floats, see
  /// powers_of, and the last one stands for larger counts. Not in Pass::layer.
  void multiply_mask(const GBufferTextures& gbuffer, const Light& light, const Buffer& powers, VisibilityMask& mask);

  /// After a wide pass, by pixel: the count, and how many faces were counted to get it.
  struct WideCount {
    float count, faces;
  };
  std::vector<WideCount> wide_counts() const;
  /// The same summed up: faces counted at all pixels, and the largest count at any.
  struct Work {
    double fill = 0, deepest = 0;
  };
  Work work() const;
  /// After a layer pass, by pixel.
  std::vector<VolumeFaces> layer_faces() const;

  /// Frees what wide and layer passes gather in.
  void drop_pictures();
  /// Of what the last wide pass gathered in.
  std::size_t wide_bytes() const { return wide_.bytes; }

 private:
  Program mask_program_, wide_mask_program_, glass_program_, wide_glass_program_;
  Framebuffer framebuffer_;
  GLuint depth_stencil_ = 0;  // of the last `begin`
  Texture wide_, layer_;
  Pass pass_ = Pass::stencil;
  CountWhere where_ = CountWhere::before_surface;
};

}  // namespace gnomon
