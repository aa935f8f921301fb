#include <gnomon/kit/gl/gl_pass.h>

#include <cmath>

namespace gnomon {

namespace {

constexpr std::string_view blanks = " \t\n";

std::string_view trimmed(std::string_view text) {
  const std::size_t first = text.find_first_not_of(blanks);
  return first == std::string_view::npos ? "" : text.substr(first, text.find_last_not_of(blanks) - first + 1);
}

/// Not destroyed at exit: the context may be gone by then.
VertexArray& no_attributes() {
  static VertexArray* const array = new VertexArray;
  return *array;
}

bool covers(const std::vector<PixelRectangle>& rectangles, const Texture& picture) {
  return rectangles.size() == 1 && rectangles[0] == PixelRectangle{0, 0, picture.width, picture.height};
}

}  // namespace

PassConstants::PassConstants(std::string_view declarations) {
  std::string copies;
  for (std::string_view rest = declarations; !trimmed(rest).empty();) {
    const std::size_t end = rest.find(';');
    const std::string_view one = trimmed(rest.substr(0, end));
    const std::size_t space = one.find_first_of(blanks);
    if (end == std::string_view::npos || space == std::string_view::npos)
      throw Error("constants of a pass: \"{}\" is no declaration like \"vec4 window[6];\"", one);
    rest.remove_prefix(end + 1);
    const std::string_view type = one.substr(0, space), name = trimmed(one.substr(space));
    const std::string_view alone = trimmed(name.substr(0, name.find('[')));
    vertex += fmt::format("uniform {0} {1};\nflat out {0} flat_{1};\n", type, name);
    copies += fmt::format("  flat_{0} = {0};\n", alone);
    fragment += fmt::format("flat in {0} flat_{1};\n#define {2} flat_{2}\n", type, name, alone);
  }
  vertex += "void hand_on() {\n" + copies + "}\n";
}

Program pass_program(std::string_view title, std::string_view constants, std::string_view fragment) {
  const PassConstants of_pass(constants);
  const std::string vertex =
      of_pass.vertex +
      "void main() { hand_on(); gl_Position = vec4(gl_VertexID == 1 ? 3 : -1, gl_VertexID == 2 ? 3 : -1, 0.5, 1); }\n";
  return Program(title, vertex, of_pass.fragment + std::string(fragment));
}

const std::string_view full_screen_vertex = R"(
void main() { gl_Position = vec4(gl_VertexID == 1 ? 3 : -1, gl_VertexID == 2 ? 3 : -1, 0.5, 1); }
)";

void draw_full_screen() {
  if (!no_attributes()) no_attributes() = make_vertex_array();
  glBindVertexArray(no_attributes().name());
  glDrawArrays(GL_TRIANGLES, 0, 3);
  glBindVertexArray(0);
}

void begin_mask(const Framebuffer& framebuffer, unsigned texture, const GBufferTextures& gbuffer) {
  glNamedFramebufferTexture(framebuffer.name(), GL_COLOR_ATTACHMENT0, texture, 0);
  glBindFramebuffer(GL_FRAMEBUFFER, framebuffer.name());
  glViewport(0, 0, gbuffer.position.width, gbuffer.position.height);
  const float lit[] = {1, 0, 0, 0};
  if (!covers(gbuffer.receivers, gbuffer.position)) glClearNamedFramebufferfv(framebuffer.name(), GL_COLOR, 0, lit);
}

void draw_receivers(const GBufferTextures& gbuffer) {
  if (covers(gbuffer.receivers, gbuffer.position)) return draw_full_screen();
  glEnable(GL_SCISSOR_TEST);
  for (const PixelRectangle& r : gbuffer.receivers) {
    glScissor(r.left, r.top, r.right - r.left, r.bottom - r.top);
    draw_full_screen();
  }
  glDisable(GL_SCISSOR_TEST);
}

void draw_mask(const Program& program, const Framebuffer& framebuffer, unsigned texture, const GBufferTextures& gbuffer) {
  bind_gbuffer(gbuffer);
  begin_mask(framebuffer, texture, gbuffer);
  glUseProgram(program.name());
  draw_receivers(gbuffer);
  glNamedFramebufferTexture(framebuffer.name(), GL_COLOR_ATTACHMENT0, 0, 0);
}

void bind_gbuffer(const GBufferTextures& textures) {
  const GLuint names[] = {textures.position.name(), textures.normal.name(), textures.ids.name()};
  glBindTextures(0, 3, names);
}

// At the center of a texel the nearest one is that very texel; llvmpipe samples at least as fast as it fetches, and reads the
// size of a texture sooner than the value of a uniform.
const std::string_view gbuffer_snippet = R"(
layout(binding = 0) uniform sampler2D gbuffer_position;
layout(binding = 1) uniform sampler2D gbuffer_normal;
layout(binding = 2) uniform usampler2D gbuffer_ids;
vec2 gbuffer_place() { return gl_FragCoord.xy / vec2(textureSize(gbuffer_position, 0)); }
vec4 position_here() { return textureLod(gbuffer_position, gbuffer_place(), 0); }
vec4 normal_here() { return textureLod(gbuffer_normal, gbuffer_place(), 0); }
uvec2 ids_here() { return textureLod(gbuffer_ids, gbuffer_place(), 0).xy; }
)";

const std::string_view faces_light_constants = "vec4 light; vec4 spot;";

// With t = to_light and unit N, N.t in float32 is off by less than 4 * 2^-24 |t| (one rounding of t, three products, two sums),
// and so are both sides of the cone's comparison; 2^-21 |t| leaves room for the rounding of N. Squared, for the sake of speed.
const std::string_view faces_light_snippet = R"(
bool faces_light(vec4 position, vec4 normal) {
  vec3 to_light = light.xyz - light.w * position.xyz;
  float squared = dot(to_light, to_light), height = dot(normal.xyz, to_light), along = -dot(to_light, spot.xyz);
  return position.w * normal.w * height > 0 && height * height > squared * 2.2737368e-13 && along >= 0 &&
         along * along >= spot.w * squared;
}
)";

void set_light(const Program& program, const Light& light) {
  program.set_if_used("light", glm::vec4(homogeneous_of_center(light)));
  glm::dvec4 cone(0);
  if (const auto* spot = std::get_if<SpotLight>(&light.kind)) {
    const double cosine = std::cos(glm::radians(double(spot->outer_degrees)));
    cone = {glm::normalize(glm::dvec3(spot->direction)), cosine * cosine + 0x1p-20};
  }
  program.set_if_used("spot", glm::vec4(cone));
}

void release_passes() { no_attributes() = {}; }

}  // namespace gnomon
