#include <gnomon/kit/gl/gl_pass.h>

#include <algorithm>
#include <cmath>

namespace gnomon {

namespace {

constexpr std::string_view blanks = " \t\n";

std::string_view trimmed(std::string_view text) {
  const std::size_t first = text.find_first_not_of(blanks);
  return first == std::string_view::npos ? "" : text.substr(first, text.find_last_not_of(blanks) - first + 1);
}

/// What lies between commas, trimmed.
std::vector<std::string_view> parts_of(std::string_view list) {
  std::vector<std::string_view> parts;
  for (std::size_t comma = list.find(','); comma != std::string_view::npos; comma = list.find(',')) {
    parts.push_back(trimmed(list.substr(0, comma)));
    list.remove_prefix(comma + 1);
  }
  parts.push_back(trimmed(list));
  return parts;
}

[[noreturn]] void refuse(std::string_view declaration) {
  throw Error("constants of a pass: \"{}\" is no declaration like \"vec4 window[6], place;\"", declaration);
}

/// Of a constant as it is declared: "window" of "window[6]". Throws Error that quotes the declaration where that is no name.
std::string_view name_of(std::string_view constant, std::string_view declaration) {
  constexpr std::string_view signs = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_";
  const std::string_view name = trimmed(constant.substr(0, constant.find('[')));
  if (name.empty() || name.find_first_not_of(signs) != std::string_view::npos) refuse(declaration);
  return name;
}

/// Not destroyed at exit: the context may be gone by then.
VertexArray& no_attributes() {
  static VertexArray* const array = new VertexArray;
  return *array;
}

bool covers(const std::vector<PixelRectangle>& rectangles, const Texture& picture) {
  return rectangles.size() == 1 && rectangles[0] == PixelRectangle{0, 0, picture.width, picture.height};
}

// Lanes of a group lie along a row of the picture. An invocation answers pixels one below the other, and reads what is constant
// once for all of them.
constexpr int group_width = 32, group_height = 2, rows_each = 4;
constexpr int largest_picture = 16384;

// What gbuffer_snippet offers, by imageLoad (docs/decisions/image_passes.md). Beyond the picture it gives 0, as background has,
// and a store does nothing.
constexpr std::string_view gbuffer_images = R"(
layout(binding = 0, r32f) writeonly uniform image2D gbuffer_mask;
layout(binding = 1, rgba32f) readonly uniform image2D gbuffer_position;
layout(binding = 2, rgba32f) readonly uniform image2D gbuffer_normal;
layout(binding = 3, rg32ui) readonly uniform uimage2D gbuffer_ids;
uniform int gbuffer_left, gbuffer_top;
ivec2 gbuffer_pixel;
vec4 position_here() { return imageLoad(gbuffer_position, gbuffer_pixel); }
vec4 normal_here() { return imageLoad(gbuffer_normal, gbuffer_pixel); }
uvec2 ids_here() { return imageLoad(gbuffer_ids, gbuffer_pixel).xy; }
vec2 pixel_here() { return vec2(gbuffer_pixel); }
)";

constexpr std::string_view mask_fragment_body = R"(
layout(location = 0) out float visibility;
void main() { visibility = visibility_here(); }
)";

constexpr std::string_view mask_compute_body = R"(
void main() {
  hand_on();
  ivec2 place = ivec2(gl_GlobalInvocationID.xy);
  int first = gbuffer_top + place.y * ROWS_EACH, end = min(first + ROWS_EACH, imageSize(gbuffer_mask).y);
  for (int row = first; row < end; ++row) {
    gbuffer_pixel = ivec2(gbuffer_left + place.x, row);
    imageStore(gbuffer_mask, gbuffer_pixel, vec4(visibility_here()));
  }
}
)";

/// begin_mask and draw_receivers of a compute shader. Rectangles may be neighbors: pixels that groups of both hold are computed
/// twice, alike.
void dispatch_mask(const Program& program, unsigned texture, const GBufferTextures& gbuffer) {
  const float lit = 1;
  if (!covers(gbuffer.receivers, gbuffer.position)) glClearTexImage(texture, 0, GL_RED, GL_FLOAT, &lit);
  glBindImageTexture(0, texture, 0, GL_FALSE, 0, GL_WRITE_ONLY, GL_R32F);
  const Texture* const inputs[] = {&gbuffer.position, &gbuffer.normal, &gbuffer.ids};
  for (GLuint k = 0; k < std::size(inputs); ++k)
    glBindImageTexture(k + 1, inputs[k]->name(), 0, GL_FALSE, 0, GL_READ_ONLY, inputs[k]->format);
  glUseProgram(program.name());
  const auto groups = [](int pixels, int each) { return static_cast<GLuint>((pixels + each - 1) / each); };
  for (const PixelRectangle& r : gbuffer.receivers) {
    program.set("gbuffer_left", r.left);
    program.set("gbuffer_top", r.top);
    glDispatchCompute(groups(r.right - r.left, group_width), groups(r.bottom - r.top, group_height * rows_each), 1);
  }
  glMemoryBarrier(GL_SHADER_IMAGE_ACCESS_BARRIER_BIT | GL_TEXTURE_FETCH_BARRIER_BIT | GL_TEXTURE_UPDATE_BARRIER_BIT |
                  GL_FRAMEBUFFER_BARRIER_BIT);
}

}  // namespace

PassConstants::PassConstants(std::string_view declarations) {
  std::string copies, names;
  for (std::string_view rest = declarations; !trimmed(rest).empty();) {
    const std::size_t end = rest.find(';');
    const std::string_view one = trimmed(rest.substr(0, end));
    const std::size_t space = one.find_first_of(blanks);
    if (end == std::string_view::npos || space == std::string_view::npos) refuse(one);
    rest.remove_prefix(end + 1);
    const std::string_view type = one.substr(0, space);
    for (const std::string_view constant : parts_of(one.substr(space))) {
      const std::string_view name = name_of(constant, one);
      vertex += fmt::format("uniform {0} {1};\nflat out {0} flat_{1};\n", type, constant);
      fragment += fmt::format("flat in {} flat_{};\n", type, constant);
      compute += fmt::format("uniform {0} {1};\n{0} flat_{1};\n", type, constant);
      copies += fmt::format("  flat_{0} = {0};\n", name);
      names += fmt::format("#define {0} flat_{0}\n", name);
    }
  }
  const std::string hand_on = "void hand_on() {\n" + copies + "}\n";
  vertex += hand_on;
  fragment += names;
  compute += hand_on + names;
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

GlLimits mask_pass_needs(MaskPass by) {
  if (by == MaskPass::fragment) return {};
  constexpr int shorter = std::min(group_width, group_height * rows_each);
  return {.work_group_size = group_width * group_height, .work_groups = largest_picture / shorter};
}

Program mask_program(std::string_view title, std::string_view constants, std::string_view answer, MaskPass by) {
  if (by == MaskPass::fragment)
    return pass_program(title, constants, fmt::format("{}{}{}", gbuffer_snippet, answer, mask_fragment_body));
  return Program::compute(
      title, fmt::format("layout(local_size_x = {}, local_size_y = {}) in;\n#define ROWS_EACH {}\n{}{}{}{}", group_width,
                         group_height, rows_each, PassConstants(constants).compute, gbuffer_images, answer, mask_compute_body));
}

void draw_mask(const Program& program, MaskPass by, const Framebuffer& framebuffer, unsigned texture,
               const GBufferTextures& gbuffer) {
  if (by == MaskPass::fragment) return draw_mask(program, framebuffer, texture, gbuffer);
  dispatch_mask(program, texture, gbuffer);
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
vec2 pixel_here() { return gl_FragCoord.xy - 0.5; }
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
