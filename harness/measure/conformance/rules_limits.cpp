// On a device with lower limits, a technique that draws names the limit that is too low, or stays within it.
#include <gnomon/kit/gl/gl.h>

#include <algorithm>
#include <cstdlib>
#include <map>

#include "measure/conformance/trial.h"

namespace gnomon::conformance {
namespace {

/// Lowers limits of the device during its lifetime.
class ReducedLimits {
 public:
  explicit ReducedLimits(const std::string& words) {
    if (const char* was = std::getenv("GNOMON_GL_LIMITS")) was_ = was;
    setenv("GNOMON_GL_LIMITS", words.c_str(), 1);
    ask_gl_limits();
  }
  ReducedLimits(const ReducedLimits&) = delete;
  ~ReducedLimits() {
    was_.empty() ? unsetenv("GNOMON_GL_LIMITS") : setenv("GNOMON_GL_LIMITS", was_.c_str(), 1);
    ask_gl_limits();
  }

 private:
  std::string was_;
};

/// Mesa and others name objects by small numbers.
constexpr GLuint most_names = 4096;

/// A property of each storage block of a program.
std::vector<GLint> of_storage_blocks(GLuint program, GLenum property) {
  GLint count = 0;
  glGetProgramInterfaceiv(program, GL_SHADER_STORAGE_BLOCK, GL_ACTIVE_RESOURCES, &count);
  std::vector<GLint> values(static_cast<std::size_t>(count));
  for (GLuint k = 0; k < values.size(); ++k)
    glGetProgramResourceiv(program, GL_SHADER_STORAGE_BLOCK, k, 1, &property, 1, nullptr, &values[k]);
  return values;
}

/// The limits whose use can be measured.
constexpr std::string_view seen_limits[] = {"vertex_storage_blocks",  "fragment_storage_blocks",
                                            "compute_storage_blocks", "storage_bindings",
                                            "texture_size",           "texture_layers"};

/// What all programs and textures that there are now use of them.
GlLimits used_limits() {
  GlLimits used;
  const auto raise = [](std::int64_t& limit, std::int64_t value) { limit = std::max(limit, value); };
  for (GLuint name = 1; name < most_names; ++name) {
    if (glIsProgram(name)) {
      const auto blocks = [&](GLenum stage) { return std::ranges::count(of_storage_blocks(name, stage), GL_TRUE); };
      raise(used.vertex_storage_blocks, blocks(GL_REFERENCED_BY_VERTEX_SHADER));
      raise(used.fragment_storage_blocks, blocks(GL_REFERENCED_BY_FRAGMENT_SHADER));
      raise(used.compute_storage_blocks, blocks(GL_REFERENCED_BY_COMPUTE_SHADER));
      for (const GLint binding : of_storage_blocks(name, GL_BUFFER_BINDING)) raise(used.storage_bindings, binding + 1);
    }
    if (!glIsTexture(name)) continue;
    const auto side = [&](GLenum what) {
      GLint value = 0;
      glGetTextureLevelParameteriv(name, 0, what, &value);
      return value;
    };
    if (side(GL_TEXTURE_BUFFER_DATA_STORE_BINDING) != 0) continue;  // a buffer's texels have a limit of their own
    raise(used.texture_size, std::max(side(GL_TEXTURE_WIDTH), side(GL_TEXTURE_HEIGHT)));
    raise(used.texture_layers, side(GL_TEXTURE_DEPTH));
  }
  return used;
}

/// One scene and one choice.
struct Case {
  const World& world;
  const GBuffer& gbuffer;
  std::string settings;
  std::map<std::string, GlLimits> used = {};  ///< by light, on the device as it is
};

/// The limits that the technique uses under a light on the device as it is.
const GlLimits& used_under(Trial& trial, Case& c, const Light& light) {
  const auto [found, is_new] = c.used.try_emplace(light.name);
  if (is_new) {
    const auto technique = trial.set_up(c.settings);
    trial.expect_mask(trial.answer(*technique, c.world.scene, light, c.gbuffer), c.world.scene, c.gbuffer, light);
    found->second = used_limits();
  }
  return found->second;
}

/// Runs it in a case on the device with the reduced limit; returns how often it ran. Where it keeps within the limit on the
/// whole device, it does the same on the lesser one, and only its support is checked.
int run_within(Trial& trial, Case& c, std::string_view limit) {
  const Scene& scene = c.world.scene;
  std::vector<Light> lights = trial.supported_lights(scene, c.settings);
  lights.resize(std::min<std::size_t>(lights.size(), c.settings.empty() ? 2 : 1));
  const std::string_view name = limit.substr(0, limit.find('='));
  const bool is_seen = std::ranges::count(seen_limits, name) > 0;
  int runs = 0;
  for (const Light& light : lights) {
    trial.at(light);
    const GlLimits used = is_seen ? used_under(trial, c, light) : GlLimits{};
    release_inputs();
    const ReducedLimits limits{std::string(limit)};
    if (const Support inputs = within_limits(inputs_need(scene, c.gbuffer.width, c.gbuffer.height)); !inputs) {
      // A worker reports this in place of the technique.
      trial.expect(inputs.why().find(name) != std::string::npos,
                   fmt::format("{}: the inputs are refused with '{}', without the limit's name", limit, inputs.why()));
      continue;
    }
    if (const Support support = trial.support(scene, light, c.settings); !support) {
      trial.expect(support.why().find(name) != std::string::npos,
                   fmt::format("{}: it is unsupported with '{}', without the limit's name", limit, support.why()));
      continue;
    }
    ++runs;
    if (is_seen && within_limits(used)) continue;
    const auto technique = trial.set_up(c.settings);
    trial.expect_mask(trial.answer(*technique, scene, light, c.gbuffer), scene, c.gbuffer, light);
    const Support kept = within_limits(used_limits());
    trial.expect(bool(kept), fmt::format("{}: it ran and is beyond the limit: {}", limit, kept.why()));
  }
  return runs;
}

void device_limits(Trial& trial) {
  const auto is_choice = [](const Parameter& parameter) { return dynamic_cast<const Choice*>(&typed(parameter)) != nullptr; };
  int runs = 0;
  for (const char* reference : {"sphere_over_plane:segments=16", "box_city:count=12"}) {
    const auto w = trial.enter(reference);
    const GBuffer gbuffer = w->gbuffer();
    for (const std::string& settings : settings_of(trial.entry(), is_choice)) {
      // One scene and light are enough for settings: their programs are compiled for each limit anew.
      if (!settings.empty() && (w->scene.has_curved_shapes() || trial.is_short())) continue;
      trial.at(reference, settings);
      Case c{*w, gbuffer, settings};
      for (const char* limit :
           {"varying_components=60", "varying_components=16", "vertex_storage_blocks=0", "vertex_storage_blocks=2",
            "fragment_storage_blocks=0", "fragment_storage_blocks=1", "compute_storage_blocks=0", "compute_storage_blocks=7",
            "storage_bindings=0", "storage_bindings=2", "storage_block_bytes=16", "work_group_size=128", "work_groups=1024",
            "texture_size=96", "texture_layers=1"})
        runs += run_within(trial, c, limit);
    }
  }
  trial.at("");
  trial.expect(runs > 0, "it ran on none of these devices");
}

}  // namespace

std::vector<Rule> limit_rules() {
  return {Rule("device_limits", device_limits,
               {.applies_to = AppliesTo::drawing, .has_small_pictures = true, .sanitized = Sanitized::part},
               "On a device with lower limits it names the limit that is too low, or stays within it.",
               "Say in supports() what the programs and textures need, with within_limits of gnomon/kit/gl/gl_limits.h; what "
               "the kit makes has a function that says what it needs.")};
}

}  // namespace gnomon::conformance
