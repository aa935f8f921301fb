#include <gnomon/error.h>
#include <gnomon/kit/camera.h>
#include <gnomon/kit/gl.h>

#include <algorithm>
#include <glm/gtc/type_ptr.hpp>

namespace gnomon {

namespace {

GLuint created(void (*create)(GLsizei, GLuint*)) {
  GLuint name = 0;
  create(1, &name);
  return name;
}

int texel_bytes(GLenum format) {
  switch (format) {
    case GL_R32F:
    case GL_R32UI:
    case GL_R32I:
    case GL_DEPTH_COMPONENT32F:
    case GL_DEPTH24_STENCIL8:
      return 4;
    case GL_RG32F:
    case GL_RG32UI:
    case GL_DEPTH32F_STENCIL8:
      return 8;
    case GL_RGBA32F:
    case GL_RGBA32UI:
      return 16;
    case GL_R8UI:
    case GL_R8:
      return 1;
  }
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
  throw Error("shader {} ({}) does not compile:\n{}\n{}", title,
              stage == GL_VERTEX_SHADER     ? "vertex"
              : stage == GL_FRAGMENT_SHADER ? "fragment"
                                            : "compute",
              log_of(glGetShaderiv, glGetShaderInfoLog, shader), numbered(source));
}

}  // namespace

Framebuffer make_framebuffer() { return Framebuffer(created(glCreateFramebuffers)); }
VertexArray make_vertex_array() { return VertexArray(created(glCreateVertexArrays)); }

Buffer::Buffer(const void* data, std::size_t bytes, GLbitfield flags) : GlObject(created(glCreateBuffers)), bytes(bytes) {
  glNamedBufferStorage(name(), static_cast<GLsizeiptr>(std::max<std::size_t>(bytes, 4)), bytes ? data : nullptr, flags);
}

Texture::Texture(GLenum format, int width, int height, int layers)
    : width(width),
      height(height),
      layers(layers),
      bytes(std::size_t(width) * height * std::max(layers, 1) * texel_bytes(format)) {
  GLuint texture = 0;
  glCreateTextures(layers ? GL_TEXTURE_2D_ARRAY : GL_TEXTURE_2D, 1, &texture);
  static_cast<GlObject&>(*this) = GlObject(texture);
  if (layers)
    glTextureStorage3D(texture, 1, format, width, height, layers);
  else
    glTextureStorage2D(texture, 1, format, width, height);
  if (const GLenum error = glGetError())
    throw Error("texture of {} x {} x {} texels, {} MiB: the OpenGL device refuses it (error {:#x})", width, height,
                std::max(layers, 1), bytes >> 20, error);
  glTextureParameteri(texture, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
  glTextureParameteri(texture, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
  glTextureParameteri(texture, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
  glTextureParameteri(texture, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
}

Program::Program(std::string_view title, std::string_view vertex, std::string_view fragment)
    : GlObject(glCreateProgram()), title_(title) {
  attach(name(), GL_VERTEX_SHADER, title, vertex);
  attach(name(), GL_FRAGMENT_SHADER, title, fragment);
  link(title, fmt::format("vertex:\n{}\nfragment:\n{}", numbered(vertex), numbered(fragment)));
}

Program Program::compute(std::string_view title, std::string_view source) {
  Program program;
  static_cast<GlObject&>(program) = GlObject(glCreateProgram());
  program.title_ = title;
  attach(program.name(), GL_COMPUTE_SHADER, title, source);
  program.link(title, numbered(source));
  return program;
}

void Program::link(std::string_view title, std::string_view sources) {
  glLinkProgram(name());
  GLint ok = 0;
  glGetProgramiv(name(), GL_LINK_STATUS, &ok);
  if (ok) return;
  throw Error("program {} does not link:\n{}\n{}", title, log_of(glGetProgramiv, glGetProgramInfoLog, name()), sources);
}

GLint Program::location(const char* uniform) const {
  const GLint location = glGetUniformLocation(name(), uniform);
  if (location < 0) throw Error("program {} uses no uniform {}", title_, uniform);
  return location;
}

void Program::set(const char* uniform, int v) const { glProgramUniform1i(name(), location(uniform), v); }
void Program::set(const char* uniform, float v) const { glProgramUniform1f(name(), location(uniform), v); }
void Program::set(const char* uniform, const glm::vec2& v) const {
  glProgramUniform2fv(name(), location(uniform), 1, glm::value_ptr(v));
}
void Program::set(const char* uniform, const glm::vec3& v) const {
  glProgramUniform3fv(name(), location(uniform), 1, glm::value_ptr(v));
}
void Program::set(const char* uniform, const glm::vec4& v) const {
  glProgramUniform4fv(name(), location(uniform), 1, glm::value_ptr(v));
}
void Program::set(const char* uniform, const glm::mat3& v) const {
  glProgramUniformMatrix3fv(name(), location(uniform), 1, GL_FALSE, glm::value_ptr(v));
}
void Program::set(const char* uniform, const glm::mat4& v) const {
  glProgramUniformMatrix4fv(name(), location(uniform), 1, GL_FALSE, glm::value_ptr(v));
}

glm::dmat4 clip_from_world(const View& view, int width, int height) {
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

// With t = to_light and unit N, N.t in float32 is off by less than 4 * 2^-24 |t| (one rounding of t, three products, two sums),
// and so are both sides of the cone's comparison; 2^-21 |t| leaves room for the rounding of N. Squared, for the sake of speed.
const std::string_view faces_light_snippet = R"(
layout(binding = 0) uniform sampler2D gbuffer_position;
layout(binding = 1) uniform sampler2D gbuffer_normal;
layout(binding = 2) uniform usampler2D gbuffer_ids;
uniform vec4 light;  // homogeneous
uniform vec4 spot;   // unit axis and squared cosine of the outer half-angle, rounded up; zero for lights without a cone
bool faces_light(vec4 position, vec4 normal) {
  vec3 to_light = light.xyz - light.w * position.xyz;
  float squared = dot(to_light, to_light), height = dot(normal.xyz, to_light), along = -dot(to_light, spot.xyz);
  return position.w * normal.w * height > 0 && height * height > squared * 2.2737368e-13 && along >= 0 &&
         along * along >= spot.w * squared;
}
)";

void set_light(const Program& program, const Light& light) {
  if (program.uses("light")) program.set("light", glm::vec4(homogeneous(light)));
  glm::dvec4 cone(0);
  if (const auto* spot = std::get_if<SpotLight>(&light.kind)) {
    const double cosine = std::cos(glm::radians(double(spot->outer_degrees)));
    cone = {glm::normalize(glm::dvec3(spot->direction)), cosine * cosine + 0x1p-20};
  }
  if (program.uses("spot")) program.set("spot", glm::vec4(cone));
}

const std::string_view full_screen_vertex = R"(
void main() { gl_Position = vec4(gl_VertexID == 1 ? 3 : -1, gl_VertexID == 2 ? 3 : -1, 0.5, 1); }
)";

}  // namespace gnomon
