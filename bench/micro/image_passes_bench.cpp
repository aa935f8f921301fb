// What image passes cost beside bare passes over the picture that fetch as many texels for each and write as many: full-screen
// draws into the same formats. `ratio` is the ratio of their medians.
#include <benchmark/benchmark.h>
#include <gnomon/kit/gl/gl_pass.h>
#include <gnomon/kit/gl/image_passes.h>

#include <array>
#include <random>

#include "bench/micro/alternate.h"
#include "device/context.h"

namespace {
using namespace gnomon;

constexpr std::array<GLenum, 3> formats = {GL_R32F, GL_RG32F, GL_RGBA32F};
constexpr const char* format_names[] = {"R32F", "RG32F", "RGBA32F"};
constexpr int layers = 1;

ImageKind kind_of(const benchmark::State& state) { return {.format = formats[state.range(0)], .has_layers = true}; }

Texture random_texture(const benchmark::State& state, int levels = 1) {
  process_context();
  const int size = static_cast<int>(state.range(1));
  Texture texture(kind_of(state).format, size, size, layers, levels);
  std::mt19937 random(1);
  std::vector<glm::vec4> texels(std::size_t(size) * size);
  for (glm::vec4& texel : texels)
    texel = glm::vec4(random() % 1000, random() % 1000, random() % 1000, random() % 1000) / 1000.0f;
  glTextureSubImage3D(texture.name(), 0, 0, 0, 0, size, size, layers, GL_RGBA, GL_FLOAT, texels.data());
  return texture;
}

/// Draws the plain sum of some texels around, or below, each one. All it does besides is find them.
class BarePass {
 public:
  /// `columns` by `rows` texels of the level above, from `step` times the place on.
  BarePass(int columns, int rows, int step) {
    std::string text = R"(
layout(binding = 0) uniform sampler2DArray from;
layout(location = 0) out vec4 result;
void main() {
  vec4 sum = vec4(0);
)";
    for (int y = 0; y < rows; ++y)
      for (int x = 0; x < columns; ++x)
        text +=
            fmt::format("  sum += textureLod(from, vec3((floor(gl_FragCoord.xy) * float({}) + vec2({}, {})) * texel, 0), 0);\n",
                        step, x + 0.5 - columns / 2 * (step == 1), y + 0.5 - rows / 2 * (step == 1));
    program_ = pass_program("bare pass", "vec2 texel;", text + "  result = sum;\n}\n");
  }
  /// Level `level` of `to` from the single level of `from`.
  void draw(const Texture& from, const Texture& to, int level = 0) const {
    const StateGuard guard;
    program_.set("texel", 1.0f / glm::vec2(from.width, from.height));
    glBindTextureUnit(0, from.name());
    glNamedFramebufferTextureLayer(framebuffer_.name(), GL_COLOR_ATTACHMENT0, to.name(), level, 0);
    glBindFramebuffer(GL_FRAMEBUFFER, framebuffer_.name());
    glViewport(0, 0, level_size(to.width, level), level_size(to.height, level));
    glUseProgram(program_.name());
    draw_full_screen();
  }

 private:
  Program program_;
  Framebuffer framebuffer_ = make_framebuffer();
};

/// Contender and floor until the device has drawn.
template <class Contender, class Floor>
void alternate_finished(benchmark::State& state, const Contender& contender, const Floor& floor) {
  const auto finished = [](const auto& draw) {
    return [&draw] {
      draw();
      glFinish();
    };
  };
  alternate(state, finished(contender), finished(floor));
  state.SetLabel(format_names[state.range(0)]);
}

void blur(benchmark::State& state) {
  const int radius = static_cast<int>(state.range(2));
  const Texture from = random_texture(state);
  Texture to = random_texture(state), between = random_texture(state);
  Blur contender;
  contender.setup(kind_of(state), Blur::Weights::gaussian, radius);
  const BarePass rows(2 * radius + 1, 1, 1), columns(1, 2 * radius + 1, 1);
  const auto floor = [&] {
    rows.draw(from, between);
    columns.draw(between, to);
  };
  alternate_finished(
      state, [&] { contender.run(from, to); }, floor);
}

void mip_chain(benchmark::State& state) {
  const int size = static_cast<int>(state.range(1)), levels = level_count(size, size);
  const Texture texture = random_texture(state, levels);
  // The floor reads each level from a texture of its own, so that no level that is written may be read.
  std::vector<Texture> above;
  for (int k = 0; k < levels; ++k) above.emplace_back(texture.format, level_size(size, k), level_size(size, k), layers);
  MipChain contender;
  contender.setup(kind_of(state));
  const BarePass bare(2, 2, 2);
  const auto floor = [&] {
    for (int k = 1; k < levels; ++k) bare.draw(above[k - 1], above[k]);
  };
  alternate_finished(
      state, [&] { contender.run(texture); }, floor);
}

void summed_area_table(benchmark::State& state) {
  const Texture from = random_texture(state);
  Texture to = random_texture(state), between = random_texture(state);
  SummedAreaTable contender;
  contender.setup(kind_of(state));
  const BarePass bare(1, 1, 1);
  const auto floor = [&] {
    bare.draw(from, between);
    bare.draw(between, to);
  };
  alternate_finished(
      state, [&] { contender.run(from, to); }, floor);
}

[[maybe_unused]] const bool is_registered = [] {
  add_timed("image_passes/blur", blur)->ArgNames({"format", "size", "radius"})->ArgsProduct({{0, 1, 2}, {1024}, {1, 4, 16}});
  add_timed("image_passes/mip_chain", mip_chain)->ArgNames({"format", "size"})->ArgsProduct({{0, 1, 2}, {1000, 1024}});
  add_timed("image_passes/summed_area_table", summed_area_table)
      ->ArgNames({"format", "size"})
      ->ArgsProduct({{0, 1, 2}, {1000, 1024}});
  return true;
}();

}  // namespace
