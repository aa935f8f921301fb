#pragma once
#include <gnomon/kit/gl/gl.h>

namespace gnomon {

// Passes over the pixels of a picture. What the fragments of a pass are given:
//
//   samplers   0 gbuffer_position, 1 gbuffer_normal, 2 gbuffer_ids, by `bind_gbuffer`; 3 light_map, by kit/maps/light_map.h;
//              the technique's own from 4 on
//   functions  of `gbuffer_snippet` and `faces_light_snippet`
//   images     0 the mask, 1 gbuffer_position, 2 gbuffer_normal, 3 gbuffer_ids, for a mask_program that is a compute shader
//   constants  that the technique declares (PassConstants), and those of `faces_light_constants`: light, spot
//
// Names that begin with gbuffer_, light_ or flat_ are the kit's.

/// What all fragments of a pass read alike, declared as in GLSL: "vec3 origin, axis; vec4 window[6];". Under llvmpipe every
/// pixel pays some six cycles for each float of a uniform, and nothing for what the corners of its triangle hand on flat: a
/// matrix takes half as long as the whole rest of a pass. So constants are uniforms of the vertex shader, set by name as ever,
/// and fragments see them under the same names as flat inputs. OpenGL promises room for fifteen vec4, a vec3 or a row of a
/// matrix counted as one.
struct PassConstants {
  std::string vertex;    ///< declares the uniforms, and `void hand_on()`, which the vertex shader calls
  std::string fragment;  ///< declares what fragments read
  std::string compute;  ///< of a pass without a vertex shader: uniforms, and `void hand_on()`, which copies them for its caller
  explicit PassConstants(std::string_view declarations);
};

/// A program for `draw_full_screen` and `draw_receivers`.
Program pass_program(std::string_view title, std::string_view constants, std::string_view fragment);

/// Vertex shader of passes without constants.
extern const std::string_view full_screen_vertex;
/// One triangle that covers the viewport, with the program in use. Leaves no vertex array bound.
void draw_full_screen();

/// Attaches the mask's texture to the framebuffer, binds that, and makes every pixel 1 that `draw_receivers` will not touch.
void begin_mask(const Framebuffer& framebuffer, unsigned texture, const GBufferTextures& gbuffer);
/// Draws the pixels that show receivers, and few others: the rest costs nothing. The fragment shader handles the background
/// pixels that a rectangle contains. Leaves the scissor test off.
void draw_receivers(const GBufferTextures& gbuffer);

/// begin_mask and draw_receivers, into a mask's texture or another one of the G-buffer's size, with a program whose constants
/// and textures from unit 3 on are set. Binds the G-buffer, and lets go of the texture at the end.
void draw_mask(const Program& program, const Framebuffer& framebuffer, unsigned texture, const GBufferTextures& gbuffer);

/// What runs the GLSL that answers the pixels of a mask.
enum class MaskPass {
  fragment,  ///< fragments of a triangle that covers the picture
  compute,   ///< invocations of a compute shader, which store into the mask's image
};
inline constexpr std::string_view name(MaskPass by) { return by == MaskPass::fragment ? "fragment" : "compute"; }
/// Of techniques with a parameter `pass`.
inline constexpr MaskPass default_mask_pass = MaskPass::fragment;
/// What a device must have for it.
GlLimits mask_pass_needs(MaskPass by);
/// A program for the `draw_mask` below. `answer` is GLSL that may call the functions of `gbuffer_snippet`, and offers
///
///   float visibility_here()   the answer of a pixel, of those that show no receiver 1
///
/// It means the same to both: no derivatives, no level of detail that is not written out, no gl_FragCoord. Both compute the
/// same numbers where a compiler rounds each product and sum, and where none is below 2^-126 but 0.
Program mask_program(std::string_view title, std::string_view constants, std::string_view answer, MaskPass by);
/// The answer of a mask_program, into an R32F texture of the G-buffer's size. Constants and textures from unit 3 on are set.
void draw_mask(const Program& program, MaskPass by, const Framebuffer& framebuffer, unsigned texture,
               const GBufferTextures& gbuffer);

/// The mask that draw(texture) draws, in memory: for questions after resolve.
template <class Draw>
std::vector<float> read_mask(const GBuffer& gbuffer, const Draw& draw) {
  const StateGuard guard;
  VisibilityMask mask(gbuffer.width, gbuffer.height);
  draw(mask.texture());
  const std::span<const float> pixels = mask.read();
  return {pixels.begin(), pixels.end()};
}

/// Binds position, normal, ids to texture units 0, 1, 2.
void bind_gbuffer(const GBufferTextures& textures);
/// Fragment shader code: the samplers, and what they hold at the pixel, without more cost than a fetch:
/// `vec4 position_here()`, w = 1 where not background; `vec4 normal_here()`, w = 1 where the mesh receives;
/// `uvec2 ids_here()`, mesh + 1 and triangle; `vec2 pixel_here()`, column and row.
extern const std::string_view gbuffer_snippet;

/// Constants and fragment shader code: `bool faces_light(vec4 position, vec4 normal)`, which means what gnomon::faces_light
/// means, in float32: within rounding (2^-21) of the horizon and of the cone's edge it says false, so that no pixel of class F
/// is ever taken for one to decide. `vec4 light` is homogeneous; `vec4 spot` is the unit axis and the squared cosine of the
/// outer half-angle, rounded up, and zero for lights without a cone. Both are set by `set_light`.
extern const std::string_view faces_light_constants, faces_light_snippet;
void set_light(const Program& program, const Light& light);

/// Frees what this part holds; called by release_inputs.
void release_passes();

}  // namespace gnomon
