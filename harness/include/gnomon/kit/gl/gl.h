#pragma once
#include <epoxy/gl.h>
#include <gnomon/kit/gl/gl_limits.h>

#include <algorithm>

namespace gnomon {

// All of this needs a current OpenGL 4.5 core context in the house state: the defaults of OpenGL, but clip control upper left,
// zero to one. Gnomon uses one context at a time, from one thread.

// --- Objects: move-only owners of one GL name ------------------------------------------------------------------------------

/// `Delete` is the function of OpenGL that deletes it: of one name, or of an array of names.
template <auto& Delete>
class GlObject {
 public:
  GlObject() = default;
  explicit GlObject(GLuint name) : name_(name) {}
  GlObject(GlObject&& other) noexcept : name_(std::exchange(other.name_, 0)) {}
  GlObject& operator=(GlObject&& other) noexcept {
    std::swap(name_, other.name_);
    return *this;
  }
  ~GlObject() {
    if (name_ == 0) return;
    if constexpr (requires { Delete(name_); })
      Delete(name_);
    else
      Delete(1, &name_);
  }
  GLuint name() const { return name_; }
  explicit operator bool() const { return name_ != 0; }

 private:
  GLuint name_ = 0;
};

using Framebuffer = GlObject<glDeleteFramebuffers>;
using VertexArray = GlObject<glDeleteVertexArrays>;
Framebuffer make_framebuffer();
VertexArray make_vertex_array();

/// Immutable storage of `bytes` bytes; `data` may be null. At least four bytes are allocated.
struct Buffer : GlObject<glDeleteBuffers> {
  Buffer() = default;
  Buffer(const void* data, std::size_t bytes, GLbitfield flags = 0);
  std::size_t bytes = 0;
};

/// Texels along one side of a level whose level 0 has `texels`: half as many in each, rounded down, at least one.
inline int level_size(int texels, int level) { return std::max(texels >> level, 1); }

/// Nearest filtering, of several levels that of the nearest one; clamped to the edge; an array when it has layers. Throws Error
/// when there is no memory for it.
struct Texture : GlObject<glDeleteTextures> {
  Texture() = default;
  Texture(GLenum format, int width, int height, int layers = 0, int levels = 1);
  /// Becomes a texture of this format and size unless it is one; the old one goes before the new one comes.
  void fit(GLenum new_format, int new_width, int new_height, int new_layers = 0, int new_levels = 1);
  GLenum format = 0;
  int width = 0, height = 0, layers = 0, levels = 0;
  std::size_t bytes = 0;  ///< of all levels
};

/// The texels of one level of a texture as the floats of `format`, read back.
template <class Texel>
std::vector<Texel> read_texels(const Texture& texture, GLenum format, int level = 0) {
  std::vector<Texel> texels(std::size_t(level_size(texture.width, level)) * level_size(texture.height, level) *
                            std::max(texture.layers, 1));
  const auto bytes = static_cast<GLsizei>(texels.size() * sizeof(Texel));
  glGetTextureImage(texture.name(), level, format, GL_FLOAT, bytes, texels.data());
  return texels;
}

/// A linked program. Sources come without their version line. Throws Error with the log and the numbered source.
class Program : public GlObject<glDeleteProgram> {
 public:
  Program() = default;
  Program(std::string_view title, std::initializer_list<std::pair<GLenum, std::string_view>> shaders);
  Program(std::string_view title, std::string_view vertex, std::string_view fragment)
      : Program(title, {{GL_VERTEX_SHADER, vertex}, {GL_FRAGMENT_SHADER, fragment}}) {}
  static Program compute(std::string_view title, std::string_view source) { return {title, {{GL_COMPUTE_SHADER, source}}}; }

  /// Of an array also by element: "window" or "window[0]", "window[3]".
  bool uses(std::string_view uniform) const { return find(uniform) >= 0; }
  /// Sets a uniform by name, which is looked up in what linking left: no call of the driver. Throws Error on a name that the
  /// program does not use.
  void set(const char* uniform, int value) const;
  void set(const char* uniform, float value) const;
  void set(const char* uniform, const glm::vec2& value) const;
  void set(const char* uniform, const glm::vec3& value) const;
  void set(const char* uniform, const glm::vec4& value) const;
  void set(const char* uniform, const glm::mat3& value) const;
  void set(const char* uniform, const glm::mat4& value) const;
  /// The first elements of an array.
  void set(const char* uniform, std::span<const glm::vec4> values) const;
  /// The same where the program uses the uniform: which ones a variant uses is the compiler's affair.
  template <class Value>
  void set_if_used(const char* uniform, const Value& value) const {
    if (uses(uniform)) set(uniform, value);
  }

 private:
  struct Uniform {
    std::string name;
    GLint location;
  };
  void list_uniforms();
  /// -1: the program does not use it.
  GLint find(std::string_view uniform) const;
  GLint location(std::string_view uniform) const;
  std::string title_;
  std::vector<Uniform> uniforms_;  // by name
};

// --- Cameras ---------------------------------------------------------------------------------------------------------------

/// Depth of every view is reversed: near_plane / distance along the axis, 1 at the near plane, 0 at infinity, where points
/// with w = 0 lie exactly. Clear it to 0; nearer is greater. Float32 then resolves 2^-24 of the distance everywhere, so a near
/// plane has only to lie before what is seen. Texel (x,y) of a render target is pixel (x,y) of the G-buffer.
glm::dmat4 clip_from_world(const View& view, int width, int height, double near_plane);
/// The same with the near plane of the G-buffer's textures, as its depth is drawn.
glm::dmat4 clip_from_world(const GBuffer& gbuffer, const Scene& scene);

/// Vertex shader code that every geometry pass uses, so that equal points get equal pixels and depths in all passes:
/// attribute 0 `vec3 position`, `uniform mat4 clip_from_world`, `vec4 place(vec4 world)`, `invariant gl_Position`.
extern const std::string_view position_snippet;

// --- Inputs, owned here ----------------------------------------------------------------------------------------------------

struct MeshRange {
  std::uint32_t first_vertex = 0, first_triangle = 0, triangle_count = 0;
  bool casts = true, receives = true;
  bool has_holes = false;     ///< has an alpha mask
  bool lets_through = false;  ///< has a transmission
};

/// What decides whether a fragment of a caster with an alpha mask lies in a hole: the bit of its texel, which is the truth, or
/// what others do. They read alpha, which AlphaLevels makes.
enum class AlphaRule {
  texel,      ///< the bit of the texel
  mips,       ///< alpha between the texels of two levels, against the cutoff
  mips_kept,  ///< the same of levels of which as many texels pass the cutoff as of the first
  hashed,     ///< alpha of the texel, against a threshold that is a hash of the place
};
/// A rule and the storage buffer that it reads; 0, and the bits of the scene, for the texel's.
struct HoleTest {
  AlphaRule rule = AlphaRule::texel;
  GLuint alpha = 0;
};

/// All meshes one after the other. `triangles` holds three uint32 a triangle, counted over the whole scene (base vertex 0).
struct SceneBuffers {
  Buffer positions;          ///< tightly packed vec3 float, the very floats of the Scene
  Buffer triangles;          ///< uint32
  VertexArray vertex_array;  ///< attribute 0 = position, and the element buffer; those below where there is a buffer
  Buffer uv;                 ///< vec2 float, attribute 2: places in alpha masks and transmissions; empty where none count
  Buffer mask_of;            ///< int32, attribute 3: the number of the vertex's alpha mask; -1: it has none
  Buffer masks;              ///< what in_hole() reads for AlphaRule::texel; empty where no mesh has one
  Buffer transmission_of;    ///< int32, attribute 4: the number of the vertex's transmission; -1: it has none
  Buffer transmissions;      ///< what transmission_here() reads; empty where no mesh has one
  std::vector<MeshRange> meshes;
  std::size_t bytes = 0;
  /// Draws the triangles of these meshes, in order, by one call; neighbors are drawn as one. Leaves no vertex array bound.
  void draw(const std::vector<std::uint32_t>& which) const;
  /// For masked programs of the test's rule. Nothing where no mesh has an alpha mask.
  void bind_masks(const HoleTest& test = {}) const;
  /// For programs with `transmission_fragment_snippet`. Nothing where no mesh has a transmission.
  void bind_transmissions() const;
  /// Draws with the one program those without holes, then with the other those that have some: drivers decide depth early only
  /// where no fragment is discarded. Leaves the one for solid triangles current.
  void draw(const std::vector<std::uint32_t>& which, const class CasterPrograms& programs, const HoleTest& test = {}) const;
};

/// Attributes 2, 3 and 4 for a vertex array of one's own over these buffers, those that there are.
void add_mask_attributes(const VertexArray& vertex_array, const SceneBuffers& buffers);

/// The vertex and fragment shader of a pass over triangles as programs: one for those without holes, and for each rule one that
/// leaves holes out, in which MASKED is defined. There the vertex shader, whose attribute 0 is `position`, calls
///   void hand_on_mask()
/// and the fragment shader discards, before any other discard, where
///   bool in_hole()
/// By the texel's rule that is floor(uv * size), wrapped, of the very bits of AlphaMask; what rounding of uv to float32 adds is
/// the pass's own error. Attributes 2 and 3; storage block 7.
class CasterPrograms {
 public:
  CasterPrograms() = default;
  CasterPrograms(std::string_view title, std::string_view vertex, std::string_view fragment);
  /// Compiles the one of a rule at the first scene that needs it: for `build`, and for stages in which the rule may change.
  void fit(const Scene& scene, AlphaRule rule = AlphaRule::texel);
  const Program& solid() const { return solid_; }
  const Program& masked(AlphaRule rule = AlphaRule::texel) const { return masked_[number_of(rule)]; }
  /// Of all.
  void set(const char* uniform, const auto& value) const {
    for_all([&](const Program& program) { program.set(uniform, value); });
  }
  void set_if_used(const char* uniform, const auto& value) const {
    for_all([&](const Program& program) { program.set_if_used(uniform, value); });
  }

 private:
  /// Levels differ in what they hold, not in how they are read.
  static std::size_t number_of(AlphaRule rule) { return rule == AlphaRule::texel ? 0 : rule == AlphaRule::hashed ? 2 : 1; }
  void for_all(const auto& use) const {
    use(solid_);
    for (const Program& program : masked_)
      if (program) use(program);
  }
  std::string title_, vertex_, fragment_;
  Program solid_;
  std::array<Program, 3> masked_;
};

/// For the shaders of CasterPrograms over casters that let a part of the light through: the vertex shader calls
///   void hand_on_transmission()
/// and the fragment shader reads from
///   float transmission_here()
/// what the triangle lets through there (of colored ones the red part), 0 where the mesh has no transmission: the very float of
/// the texel floor(uv * size), wrapped. Attributes 2 and 4; storage block 6, by `bind_transmissions`.
extern const std::string_view transmission_vertex_snippet;
extern const std::string transmission_fragment_snippet;

/// For CasterPrograms that draw depth alone: of points less `shift`, zero where it is not set, by `clip_from_world`.
extern const std::string depth_vertex, depth_fragment;

/// Pixels with left <= x < right and top <= y < bottom.
struct PixelRectangle {
  int left = 0, top = 0, right = 0, bottom = 0;
  bool operator==(const PixelRectangle&) const = default;
};
/// The smallest one around all of them; without pixels where there are none.
PixelRectangle around(const std::vector<PixelRectangle>& rectangles);

struct GBufferTextures {
  Texture position;  ///< RGBA32F; w = 1 where not background
  Texture normal;    ///< RGBA32F; w = 1 where the mesh receives
  Texture ids;       ///< RG32UI: mesh + 1 (0 background), triangle
  /// Together they hold every pixel that shows a receiver; a few, apart from each other, in pixels of the picture.
  std::vector<PixelRectangle> receivers;
  /// Meters along the view's axis, from near_share down to half of it of the way to the nearest point: a power of two, so that
  /// a scene that is larger or smaller by one has the same depths.
  double near_plane = 0;
  static constexpr double near_share = 0x1p-10;
  std::size_t bytes = 0;
  double upload_ms = 0;
};

/// Depth (read-only for techniques) and stencil (theirs; of unknown content) of what the eye sees of the scene, drawn with
/// `position_snippet`.
/// A technique that sees shapes, on a G-buffer that shows them, gets the depth of what that G-buffer sees: curved shapes are
/// left out of the drawing, and where the G-buffer shows one the depth is near_plane over the w that place() gives its point.
struct DepthStencil {
  Texture texture;  ///< D32F_S8
  std::size_t bytes = 0;
  double upload_ms = 0;
};

/// What the next three need of the device.
GlLimits inputs_need(const Scene& scene, int width, int height);

/// The triangles of a scene: uploaded at the first request after they changed, looked up after. A technique requests them in
/// `build`, whose time so includes the upload; what holds them counts among its memory. Where vertices of a scene with motion
/// were moved in place (Scene::pose_number), the first request after it writes those that differ into the same buffers, for
/// `update`, a range of each mesh; indices, uv, masks and transmissions stay. The harness keeps the vertices of such a scene in
/// memory to compare with, and counts this as nobody's. The last few scenes are held: request again in every stage and keep no
/// reference from one to the next.
const SceneBuffers& scene_buffers(const Scene& scene);
/// The same without an upload; null where no request came since the scene changed.
const SceneBuffers* uploaded_scene(const Scene& scene);
/// The scene's triangles changed, or are to be taken for changed: the next request uploads them, and depth is drawn again.
void forget_scene(const Scene& scene);
/// Bytes of triangles that this process has uploaded.
std::uint64_t uploaded_scene_bytes();

/// What belongs to the picture and not to the technique: the same upload for all that draw. The harness requests it first,
/// outside of the timed stages, so that a technique's call costs a look-up; held as the scenes are. Depth is drawn from
/// scene_buffers.
const GBufferTextures& gbuffer_textures(const GBuffer& gbuffer, const Scene& scene);
const DepthStencil& depth_stencil(const Scene& scene, const GBuffer& gbuffer, Truth sees = Truth::mesh);
/// Whether anything in this process has requested the depth of what a technique sees, so far.
bool uses_depth_stencil(Truth sees);
struct UploadCost {
  std::size_t bytes = 0;
  double ms = 0;
};
/// Of those two, as far as they are held.
UploadCost picture_uploads(const Scene& scene, const GBuffer& gbuffer);

/// Frees what this part holds. Must be called before the context goes, or after a scene was edited in place without another
/// Scene::pose_number.
void release_inputs();

/// What ends `setup` of a GL technique: its stages on a tiny built-in scene, under each kind of light it supports. Drivers
/// compile a shader at its first draw, in the very state of that draw, so only the stages themselves warm what the stages need.
/// With glass: one of its casters lets a part of the light through; for techniques that draw such casters otherwise.
void warm_up(Technique& technique, bool with_glass = false);

// --- State -----------------------------------------------------------------------------------------------------------------

/// Puts back, when it goes, what a technique may change: bindings of program, vertex array, framebuffers, buffers, the first
/// 16 texture and 8 image units; depth, stencil, blend, cull, clip, scissor, masks. The viewport is not part of the house
/// state: every pass sets its own.
class StateGuard {
 public:
  StateGuard() = default;
  StateGuard(const StateGuard&) = delete;
  StateGuard& operator=(const StateGuard&) = delete;
  ~StateGuard();
};

}  // namespace gnomon
