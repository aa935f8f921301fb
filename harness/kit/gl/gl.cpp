#include <gnomon/kit/geometry/camera.h>
#include <gnomon/kit/gl/gl.h>

namespace gnomon {

namespace {

GLuint created(void (*create)(GLsizei, GLuint*)) {
  GLuint name = 0;
  create(1, &name);
  return name;
}

int texel_bytes(GLenum format) {
  const auto is_in = [&](std::initializer_list<GLenum> formats) { return std::ranges::find(formats, format) != formats.end(); };
  if (is_in({GL_R8, GL_R8UI})) return 1;
  if (is_in({GL_R16, GL_R16F, GL_DEPTH_COMPONENT16})) return 2;
  if (is_in({GL_RG16, GL_RG16F, GL_R32F, GL_R32UI, GL_R32I, GL_DEPTH_COMPONENT24, GL_DEPTH_COMPONENT32F, GL_DEPTH24_STENCIL8}))
    return 4;
  if (is_in({GL_RGBA16, GL_RGBA16F, GL_RG32F, GL_RG32UI, GL_DEPTH32F_STENCIL8})) return 8;
  if (is_in({GL_RGBA32F, GL_RGBA32UI})) return 16;
  throw Error("Texture of format {:#x}: its size is not known", format);
}

std::string numbered(std::string_view source) {
  std::string text;
  for (int line = 1; !source.empty(); ++line) {
    const std::size_t end = std::min(source.find('\n'), source.size());
    text += fmt::format("{:4}  {}\n", line, source.substr(0, end));
    source.remove_prefix(std::min(end + 1, source.size()));
  }
  return text;
}

/// What the driver says about a shader or program.
std::string log_of(const auto& get, const auto& get_log, GLuint name) {
  GLint length = 0;
  get(name, GL_INFO_LOG_LENGTH, &length);
  std::string log(std::max(length, 1), '\0');
  get_log(name, length, nullptr, log.data());
  return log.c_str();
}

std::string_view stage_name(GLenum stage) {
  if (stage == GL_GEOMETRY_SHADER) return "geometry";
  return stage == GL_VERTEX_SHADER ? "vertex" : stage == GL_FRAGMENT_SHADER ? "fragment" : "compute";
}

/// A shader object, attached to `program`; it lives as long as the program.
void attach(GLuint program, GLenum stage, std::string_view title, std::string_view body) {
  const std::string source = "#version 450 core\n" + std::string(body);
  const char* const text = source.c_str();
  const GLuint shader = glCreateShader(stage);
  glShaderSource(shader, 1, &text, nullptr);
  glCompileShader(shader);
  glAttachShader(program, shader);
  glDeleteShader(shader);
  GLint ok = 0;
  glGetShaderiv(shader, GL_COMPILE_STATUS, &ok);
  if (ok) return;
  throw Error("shader {} ({}) does not compile:\n{}\n{}", title, stage_name(stage),
              log_of(glGetShaderiv, glGetShaderInfoLog, shader), numbered(source));
}

}  // namespace

Framebuffer make_framebuffer() { return Framebuffer(created(glCreateFramebuffers)); }
VertexArray make_vertex_array() { return VertexArray(created(glCreateVertexArrays)); }

Buffer::Buffer(const void* data, std::size_t bytes, GLbitfield flags) : GlObject(created(glCreateBuffers)), bytes(bytes) {
  glNamedBufferStorage(name(), static_cast<GLsizeiptr>(std::max<std::size_t>(bytes, 4)), bytes ? data : nullptr, flags);
}

Texture::Texture(GLenum format, int width, int height, int layers, int levels)
    : format(format), width(width), height(height), layers(layers), levels(levels) {
  for (int k = 0; k < levels; ++k)
    bytes += std::size_t(level_size(width, k)) * level_size(height, k) * std::max(layers, 1) * texel_bytes(format);
  GLuint texture = 0;
  glCreateTextures(layers ? GL_TEXTURE_2D_ARRAY : GL_TEXTURE_2D, 1, &texture);
  static_cast<GlObject&>(*this) = GlObject(texture);
  if (layers)
    glTextureStorage3D(texture, levels, format, width, height, layers);
  else
    glTextureStorage2D(texture, levels, format, width, height);
  if (const GLenum error = glGetError())
    throw Error("texture of {} x {} x {} texels, {} MiB: the OpenGL device refuses it (error {:#x})", width, height,
                std::max(layers, 1), bytes >> 20, error);
  glTextureParameteri(texture, GL_TEXTURE_MIN_FILTER, levels > 1 ? GL_NEAREST_MIPMAP_NEAREST : GL_NEAREST);
  glTextureParameteri(texture, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
  glTextureParameteri(texture, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
  glTextureParameteri(texture, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
}

void Texture::fit(GLenum new_format, int new_width, int new_height, int new_layers, int new_levels) {
  if (format == new_format && width == new_width && height == new_height && layers == new_layers && levels == new_levels)
    return;
  *this = {};
  *this = Texture(new_format, new_width, new_height, new_layers, new_levels);
}

Program::Program(std::string_view title, std::initializer_list<std::pair<GLenum, std::string_view>> shaders)
    : GlObject(glCreateProgram()), title_(title) {
  for (const auto& [stage, source] : shaders) attach(name(), stage, title, source);
  glLinkProgram(name());
  GLint ok = 0;
  glGetProgramiv(name(), GL_LINK_STATUS, &ok);
  if (!ok) {
    std::string sources;
    for (const auto& [stage, source] : shaders) sources += fmt::format("\n{}:\n{}", stage_name(stage), numbered(source));
    throw Error("program {} does not link:\n{}{}", title, log_of(glGetProgramiv, glGetProgramInfoLog, name()), sources);
  }
  list_uniforms();
}

void Program::list_uniforms() {
  GLint count = 0, longest = 0;
  glGetProgramInterfaceiv(name(), GL_UNIFORM, GL_ACTIVE_RESOURCES, &count);
  glGetProgramInterfaceiv(name(), GL_UNIFORM, GL_MAX_NAME_LENGTH, &longest);
  std::string text(static_cast<std::size_t>(std::max(longest, 1)), '\0');
  for (GLint k = 0; k < count; ++k) {
    GLsizei length = 0;
    glGetProgramResourceName(name(), GL_UNIFORM, static_cast<GLuint>(k), longest, &length, text.data());
    const std::string uniform = text.substr(0, static_cast<std::size_t>(length));
    const auto add = [&](const std::string& called) {
      if (const GLint location = glGetUniformLocation(name(), called.c_str()); location >= 0)
        uniforms_.push_back({called, location});
    };
    add(uniform);
    if (!uniform.ends_with("[0]")) continue;
    // An array goes by its name, too, and each of its elements by its own.
    const std::string array = uniform.substr(0, uniform.size() - 3);
    add(array);
    const GLenum wanted = GL_ARRAY_SIZE;
    GLint size = 1;
    glGetProgramResourceiv(name(), GL_UNIFORM, static_cast<GLuint>(k), 1, &wanted, 1, nullptr, &size);
    for (GLint i = 1; i < size; ++i) add(fmt::format("{}[{}]", array, i));
  }
  std::ranges::sort(uniforms_, {}, &Uniform::name);
}

GLint Program::find(std::string_view uniform) const {
  const auto found = std::ranges::lower_bound(uniforms_, uniform, {}, &Uniform::name);
  return found != uniforms_.end() && found->name == uniform ? found->location : -1;
}

GLint Program::location(std::string_view uniform) const {
  const GLint location = find(uniform);
  if (location < 0) throw Error("program {} uses no uniform {}", title_, uniform);
  return location;
}

void Program::set(const char* uniform, int v) const { glProgramUniform1i(name(), location(uniform), v); }
void Program::set(const char* uniform, float v) const { glProgramUniform1f(name(), location(uniform), v); }
void Program::set(const char* uniform, const glm::vec2& v) const { glProgramUniform2fv(name(), location(uniform), 1, &v.x); }
void Program::set(const char* uniform, const glm::vec3& v) const { glProgramUniform3fv(name(), location(uniform), 1, &v.x); }
void Program::set(const char* uniform, const glm::vec4& v) const { glProgramUniform4fv(name(), location(uniform), 1, &v.x); }
void Program::set(const char* uniform, const glm::mat3& v) const {
  glProgramUniformMatrix3fv(name(), location(uniform), 1, GL_FALSE, &v[0].x);
}
void Program::set(const char* uniform, const glm::mat4& v) const {
  glProgramUniformMatrix4fv(name(), location(uniform), 1, GL_FALSE, &v[0].x);
}

void Program::set(const char* uniform, std::span<const glm::vec4> values) const {
  glProgramUniform4fv(name(), location(uniform), static_cast<GLsizei>(values.size()), &values[0].x);
}

glm::dmat4 clip_from_world(const View& view, int width, int height, double near_plane) {
  const Camera camera(view, width, height);
  const auto row = [&](const glm::dvec3& axis, double scale) { return glm::dvec4(axis, -glm::dot(axis, camera.eye)) / scale; };
  // Rows x, y, z, w. z is near_plane for finite points and 0 for points at infinity: z/w is the reversed depth.
  return glm::transpose(glm::dmat4(row(camera.right, camera.tan_y * width / height), row(camera.up, camera.tan_y),
                                   glm::dvec4(0, 0, 0, near_plane), row(camera.forward, 1)));
}

// The products are summed in one order, and `precise` keeps compilers from fusing them differently in different passes.
const std::string_view position_snippet = R"(
layout(location = 0) in vec3 position;
uniform mat4 clip_from_world;
invariant gl_Position;
vec4 place(vec4 world) {
  precise vec4 clip = ((clip_from_world[0] * world.x + clip_from_world[1] * world.y) + clip_from_world[2] * world.z) +
                      clip_from_world[3] * world.w;
  return clip;
}
)";

StateGuard::~StateGuard() {
  for (const GLenum capability : {GL_BLEND, GL_COLOR_LOGIC_OP, GL_CULL_FACE, GL_DEPTH_CLAMP, GL_DEPTH_TEST, GL_FRAMEBUFFER_SRGB,
                                  GL_POLYGON_OFFSET_FILL, GL_PRIMITIVE_RESTART, GL_PROGRAM_POINT_SIZE, GL_RASTERIZER_DISCARD,
                                  GL_SAMPLE_ALPHA_TO_COVERAGE, GL_SAMPLE_MASK, GL_SCISSOR_TEST, GL_STENCIL_TEST})
    glDisable(capability);
  for (const GLenum capability : {GL_DITHER, GL_MULTISAMPLE}) glEnable(capability);
  constexpr int clip_distances = 8, texture_units = 16, image_units = 8, buffer_units = 8;
  for (int i = 0; i < clip_distances; ++i) glDisable(GL_CLIP_DISTANCE0 + i);
  glUseProgram(0);
  glBindVertexArray(0);
  glBindFramebuffer(GL_FRAMEBUFFER, 0);
  glBindRenderbuffer(GL_RENDERBUFFER, 0);
  for (const GLenum target : {GL_ARRAY_BUFFER, GL_DRAW_INDIRECT_BUFFER, GL_PIXEL_PACK_BUFFER, GL_PIXEL_UNPACK_BUFFER})
    glBindBuffer(target, 0);
  glBindBuffersBase(GL_SHADER_STORAGE_BUFFER, 0, buffer_units, nullptr);
  glBindBuffersBase(GL_UNIFORM_BUFFER, 0, buffer_units, nullptr);
  for (const GLenum target : {GL_SHADER_STORAGE_BUFFER, GL_UNIFORM_BUFFER, GL_ATOMIC_COUNTER_BUFFER}) glBindBuffer(target, 0);
  glBindTextures(0, texture_units, nullptr);
  glBindSamplers(0, texture_units, nullptr);
  glBindImageTextures(0, image_units, nullptr);
  glActiveTexture(GL_TEXTURE0);
  glPixelStorei(GL_PACK_ALIGNMENT, 4);
  glPixelStorei(GL_UNPACK_ALIGNMENT, 4);
  glDepthFunc(GL_LESS);
  glDepthMask(GL_TRUE);
  glDepthRange(0, 1);
  glStencilFunc(GL_ALWAYS, 0, ~0u);
  glStencilOp(GL_KEEP, GL_KEEP, GL_KEEP);
  glStencilMask(~0u);
  glBlendFunc(GL_ONE, GL_ZERO);
  glBlendEquation(GL_FUNC_ADD);
  glCullFace(GL_BACK);
  glFrontFace(GL_CCW);
  glPolygonMode(GL_FRONT_AND_BACK, GL_FILL);
  glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
  glClipControl(GL_UPPER_LEFT, GL_ZERO_TO_ONE);
}

}  // namespace gnomon
