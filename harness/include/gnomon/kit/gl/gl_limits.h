#pragma once
#include <gnomon/technique.h>

namespace gnomon {

/// What an OpenGL device can do at most, or what a technique needs of it: nothing where it is 0. OpenGL 4.5 promises less of
/// some than the drivers at hand have.
struct GlLimits {
  std::int64_t varying_components = 0;       ///< floats from a vertex to the pixels; an output takes four, whatever its size
  std::int64_t vertex_storage_blocks = 0;    ///< buffers that a vertex shader reads; 0 is allowed
  std::int64_t fragment_storage_blocks = 0;  ///< the same of a fragment shader
  std::int64_t compute_storage_blocks = 0;   ///< the same of a compute shader
  std::int64_t storage_bindings = 0;         ///< places for such buffers
  std::int64_t storage_block_bytes = 0;      ///< of one such buffer
  std::int64_t work_group_size = 0;          ///< invocations of a compute shader
  std::int64_t work_groups = 0;              ///< side by side
  std::int64_t texture_size = 0;             ///< texels of a side that can be drawn to
  std::int64_t texture_layers = 0;
  std::int64_t subpixel_bits = 0;  ///< vertices are rounded to 2^-bits pixels
};

/// A limit by its name: what GNOMON_GL_LIMITS and reasons call it.
struct GlLimit {
  std::string_view name;
  std::int64_t GlLimits::*value;
};
std::span<const GlLimit> gl_limit_list();

/// The greater of each.
GlLimits most_of(const GlLimits& a, const GlLimits& b);

/// Of the present context, as it said when it was made, but no more than GNOMON_GL_LIMITS says ("texture_size=1024,..."; for
/// tests). Null without a context.
const GlLimits* gl_limits();
/// Unsupported where the present context has not got all that is needed, with the first limit that is too small; full without a
/// context: before drawing, `supports` is called again where there is one.
Support within_limits(const GlLimits& needed);
/// Of a buffer whose size is known only now. Throws Error where a shader cannot read so large a one.
void require_storage_block(std::size_t bytes);

/// For whoever makes and destroys contexts. The first throws Error when GNOMON_GL_LIMITS names no limit, or one that is not
/// there.
void ask_gl_limits();
void forget_gl_limits();

}  // namespace gnomon
