// On a device that can do less, a technique that draws says which limit is too small, or keeps within it.
#include <cstdlib>

#include "stage.h"

namespace conformance {
namespace {

class Limits : public Every {};
INSTANTIATE_TEST_SUITE_P(technique, Limits, testing::ValuesIn(ids_where([](const About& about) { return about.needs_gl; })),
                         id_of);

/// The device has less while this lives.
class Pretended {
 public:
  explicit Pretended(const std::string& words) {
    if (const char* was = std::getenv("GNOMON_GL_LIMITS")) was_ = was;
    setenv("GNOMON_GL_LIMITS", words.c_str(), 1);
    ask_gl_limits();
  }
  Pretended(const Pretended&) = delete;
  ~Pretended() {
    was_.empty() ? unsetenv("GNOMON_GL_LIMITS") : setenv("GNOMON_GL_LIMITS", was_.c_str(), 1);
    ask_gl_limits();
  }

 private:
  std::string was_;
};

/// Mesa and others name objects by small numbers.
constexpr GLuint most_names = 4096;

/// How many storage blocks a program reads in the stage that `referenced` names.
int storage_blocks(GLuint program, GLenum referenced) {
  GLint count = 0;
  glGetProgramInterfaceiv(program, GL_SHADER_STORAGE_BLOCK, GL_ACTIVE_RESOURCES, &count);
  int used = 0;
  for (GLint k = 0; k < count; ++k) {
    GLint is_used = 0;
    glGetProgramResourceiv(program, GL_SHADER_STORAGE_BLOCK, static_cast<GLuint>(k), 1, &referenced, 1, nullptr, &is_used);
    used += is_used;
  }
  return used;
}

/// Largest binding of a program's storage blocks, plus one.
GLint storage_bindings(GLuint program) {
  GLint count = 0, most = 0;
  glGetProgramInterfaceiv(program, GL_SHADER_STORAGE_BLOCK, GL_ACTIVE_RESOURCES, &count);
  for (GLint k = 0; k < count; ++k) {
    const GLenum wanted = GL_BUFFER_BINDING;
    GLint binding = 0;
    glGetProgramResourceiv(program, GL_SHADER_STORAGE_BLOCK, static_cast<GLuint>(k), 1, &wanted, 1, nullptr, &binding);
    most = std::max(most, binding + 1);
  }
  return most;
}

/// What all programs and textures that there are now use of some limits.
GlLimits used_limits() {
  GlLimits used;
  const auto raise = [](std::int64_t& limit, std::int64_t value) { limit = std::max(limit, value); };
  for (GLuint name = 1; name < most_names; ++name) {
    if (glIsProgram(name)) {
      raise(used.vertex_storage_blocks, storage_blocks(name, GL_REFERENCED_BY_VERTEX_SHADER));
      raise(used.fragment_storage_blocks, storage_blocks(name, GL_REFERENCED_BY_FRAGMENT_SHADER));
      raise(used.compute_storage_blocks, storage_blocks(name, GL_REFERENCED_BY_COMPUTE_SHADER));
      raise(used.storage_bindings, storage_bindings(name));
    }
    if (!glIsTexture(name)) continue;
    const auto side = [&](GLenum what) {
      GLint value = 0;
      glGetTextureLevelParameteriv(name, 0, what, &value);
      return value;
    };
    raise(used.texture_size, std::max(side(GL_TEXTURE_WIDTH), side(GL_TEXTURE_HEIGHT)));
    raise(used.texture_layers, side(GL_TEXTURE_DEPTH));
  }
  return used;
}

TEST_P(Limits, are_kept_or_named) {
  const auto names = entry().make();
  std::vector<std::string> all_settings = {""};
  for (const Parameter* parameter : names->parameters())
    if (dynamic_cast<const Choice*>(parameter))
      for (const std::string& value : parameter->probes())
        all_settings.push_back(fmt::format("{}={}", parameter->name(), value));
  int runs = 0;
  for (const char* limit :
       {"varying_components=60", "varying_components=16", "vertex_storage_blocks=0", "vertex_storage_blocks=2",
        "fragment_storage_blocks=0", "fragment_storage_blocks=1", "compute_storage_blocks=0", "compute_storage_blocks=7",
        "storage_bindings=0", "storage_bindings=2", "storage_block_bytes=16", "work_group_size=128", "work_groups=1024",
        "texture_size=96", "texture_layers=1"}) {
    for (const char* reference : {"sphere_over_plane:segments=16", "box_city:count=12"}) {
      const auto w = world(reference);
      const GBuffer gbuffer = w->gbuffer();
      for (const std::string& settings : all_settings) {
        SCOPED_TRACE(fmt::format("{} {} {}", limit, reference, settings));
        // One scene and light will do for settings: their programs are compiled for each limit anew.
        if (!settings.empty() && w->scene.has_curved_shapes()) continue;
        std::vector<Light> lights = supported_lights(w->scene, settings);
        lights.resize(std::min<std::size_t>(lights.size(), settings.empty() ? 2 : 1));
        release_inputs();
        const Pretended pretended(limit);
        const Support inputs = within_limits(inputs_need(w->scene, gbuffer.width, gbuffer.height));
        for (const Light& light : lights) {
          const std::string name(limit, std::string_view(limit).find('='));
          if (!inputs) {  // a worker says so in the technique's place
            EXPECT_NE(inputs.why().find(name), std::string::npos) << inputs.why();
            continue;
          }
          if (const Support support = this->support(w->scene, light, settings); !support) {
            EXPECT_NE(support.why().find(name), std::string::npos) << support.why();
            continue;
          }
          ++runs;
          const auto technique = set_up(settings);
          EXPECT_TRUE(is_mask(answer(*technique, w->scene, light, gbuffer), *w, gbuffer, light));
          const Support kept = within_limits(used_limits());
          EXPECT_TRUE(kept) << kept.why();
        }
      }
    }
  }
  EXPECT_GT(runs, 0);
}

}  // namespace
}  // namespace conformance
