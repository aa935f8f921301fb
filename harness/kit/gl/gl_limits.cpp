#include <epoxy/gl.h>
#include <gnomon/kit/gl/gl_limits.h>

#include <algorithm>
#include <charconv>
#include <cstdlib>

namespace gnomon {

namespace {

constexpr GlLimit limit_list[] = {{"varying_components", &GlLimits::varying_components},
                                  {"vertex_storage_blocks", &GlLimits::vertex_storage_blocks},
                                  {"fragment_storage_blocks", &GlLimits::fragment_storage_blocks},
                                  {"compute_storage_blocks", &GlLimits::compute_storage_blocks},
                                  {"storage_bindings", &GlLimits::storage_bindings},
                                  {"storage_block_bytes", &GlLimits::storage_block_bytes},
                                  {"work_group_size", &GlLimits::work_group_size},
                                  {"work_groups", &GlLimits::work_groups},
                                  {"texture_size", &GlLimits::texture_size},
                                  {"texture_layers", &GlLimits::texture_layers},
                                  {"subpixel_bits", &GlLimits::subpixel_bits}};

std::optional<GlLimits> known;

std::int64_t asked(GLenum what) {
  GLint64 value = 0;
  glGetInteger64v(what, &value);
  return value;
}

/// Of a limit that has a value for each of several directions.
std::int64_t asked(GLenum what, GLuint direction) {
  GLint64 value = 0;
  glGetInteger64i_v(what, direction, &value);
  return value;
}

GlLimits device_limits() {
  GLint viewport[2] = {};
  glGetIntegerv(GL_MAX_VIEWPORT_DIMS, viewport);
  const std::int64_t framebuffer = std::min(asked(GL_MAX_FRAMEBUFFER_WIDTH), asked(GL_MAX_FRAMEBUFFER_HEIGHT));
  return {
      .varying_components = std::min(
          {asked(GL_MAX_VARYING_COMPONENTS), asked(GL_MAX_VERTEX_OUTPUT_COMPONENTS), asked(GL_MAX_FRAGMENT_INPUT_COMPONENTS)}),
      .vertex_storage_blocks = asked(GL_MAX_VERTEX_SHADER_STORAGE_BLOCKS),
      .fragment_storage_blocks = asked(GL_MAX_FRAGMENT_SHADER_STORAGE_BLOCKS),
      .compute_storage_blocks = asked(GL_MAX_COMPUTE_SHADER_STORAGE_BLOCKS),
      .storage_bindings = asked(GL_MAX_SHADER_STORAGE_BUFFER_BINDINGS),
      .storage_block_bytes = asked(GL_MAX_SHADER_STORAGE_BLOCK_SIZE),
      .work_group_size = std::min(asked(GL_MAX_COMPUTE_WORK_GROUP_INVOCATIONS), asked(GL_MAX_COMPUTE_WORK_GROUP_SIZE, 0)),
      .work_groups = std::min(asked(GL_MAX_COMPUTE_WORK_GROUP_COUNT, 0), asked(GL_MAX_COMPUTE_WORK_GROUP_COUNT, 1)),
      .texture_size = std::min({asked(GL_MAX_TEXTURE_SIZE), framebuffer, std::int64_t{viewport[0]}, std::int64_t{viewport[1]}}),
      .texture_layers = asked(GL_MAX_ARRAY_TEXTURE_LAYERS),
      .subpixel_bits = asked(GL_SUBPIXEL_BITS)};
}

/// What GNOMON_GL_LIMITS says, in place of what the device has.
void pretend(GlLimits& limits, std::string_view words) {
  while (!words.empty()) {
    const std::string_view word = words.substr(0, words.find(','));
    words.remove_prefix(std::min(word.size() + 1, words.size()));
    const std::string_view name = word.substr(0, word.find('=')), text = word.substr(std::min(name.size() + 1, word.size()));
    const auto limit = std::ranges::find(limit_list, name, &GlLimit::name);
    if (limit == std::end(limit_list)) {
      std::string names;
      for (const GlLimit& one : limit_list) names += fmt::format("{}{}", names.empty() ? "" : " | ", one.name);
      throw Error("GNOMON_GL_LIMITS: {} is none of {}", name, names);
    }
    std::int64_t& has = limits.*limit->value;
    std::int64_t value = -1;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc() || end != text.data() + text.size() || value < 0 || value > has)
      throw Error("GNOMON_GL_LIMITS: {} = {} is outside 0 .. {}, which the device has", name, text, has);
    has = value;
  }
}

}  // namespace

std::span<const GlLimit> gl_limit_list() { return limit_list; }

GlLimits most_of(const GlLimits& a, const GlLimits& b) {
  GlLimits most;
  for (const GlLimit& limit : limit_list) most.*limit.value = std::max(a.*limit.value, b.*limit.value);
  return most;
}

const GlLimits* gl_limits() { return known ? &*known : nullptr; }

Support within_limits(const GlLimits& needed) {
  if (!known) return Support::full();
  for (const GlLimit& limit : limit_list)
    if (const std::int64_t has = *known.*limit.value, wanted = needed.*limit.value; has < wanted)
      return Support::unsupported(fmt::format("the OpenGL device has {} = {}; {} are needed", limit.name, has, wanted));
  return Support::full();
}

void require_storage_block(std::size_t bytes) {
  if (const Support support = within_limits({.storage_block_bytes = static_cast<std::int64_t>(bytes)}); !support)
    throw Error("a buffer of {} bytes: {}", bytes, support.why());
}

void ask_gl_limits() {
  GlLimits limits = device_limits();
  if (const char* const words = std::getenv("GNOMON_GL_LIMITS")) pretend(limits, words);
  known = limits;
}

void forget_gl_limits() { known.reset(); }

}  // namespace gnomon
