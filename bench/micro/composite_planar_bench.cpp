// What composite_planar costs beside the least that its stages must do.
//
// resolve            Beside one full-screen pass that fetches the same textures, tests which pixels face the light and writes
//                    the same target; both by turns in one run, `ratio` is the ratio of their medians. `few`: the shadows of
//                    16 shapes cover the share `dark` of the picture. Target: at most 1.3 where that is a fifth at most.
//                    `all`: each of 1, 4, 16 shapes covers all of it. Target: at most 4.
// relight            `per_shape`: seconds for each of 16, 64, 256 shapes over one plane. Target: at most 2 microseconds.
// characteristic     The points that determine a shape's shadow by the paper's equations (contender) beside the projection of
//                    all vertices of its tessellation (floor), as dearly as that is done: 1 / `ratio` is what the paper saves.
#include <benchmark/benchmark.h>
#include <gnomon/kit/geometry/planar_shadow.h>
#include <gnomon/kit/gl/gl_pass.h>
#include <gnomon/kit/random.h>

#include "bench/micro/alternate.h"
#include "bench/micro/scenes.h"
#include "device/context.h"

namespace {
using namespace gnomon;

constexpr int width = 960, height = 540;
const Light lamp{.name = "point", .kind = PointLight{{-3, 9, 1}}};

Mesh ground() { return tessellate(ground_plane(40), default_segments, "ground"); }

/// A ground that fills the picture, and shapes that do not hide it.
Scene scene_of(const std::vector<Shape>& shapes) {
  Scene scene;
  scene.meshes = {ground()};
  for (const Shape& shape : shapes) scene.meshes.push_back(tessellate(shape, 32, "shape"));
  scene.views = {{.eye = {0, 7, 6}, .target = {0, 0, 0}, .fov_y_degrees = 50}};
  scene.lights = {lamp};
  return scene;
}

/// Spheres, cones, discs and triangles in turn, somewhere over the ground.
std::vector<Shape> mixed(int count, float size, float half) {
  Random random(7);
  std::vector<Shape> shapes;
  for (int i = 0; i < count; ++i) {
    const glm::vec3 at(random.uniform(glm::dvec3(-half, 0.5, -half), glm::dvec3(half, 2, half)));
    const glm::vec3 side(size, 0, 0), up(0, 2 * size, 0);
    const Shape kinds[] = {Sphere{at, size}, Cone{at, {0, 1, 0}, size, 2 * size}, Disc{at, {0, 1, 0}, size},
                           Triangle{{at - side, at + side, at + up}}};
    shapes.push_back(kinds[i % 4]);
  }
  return shapes;
}

/// Discs close below the lamp, out of the picture.
std::vector<Shape> covering(int count) {
  std::vector<Shape> shapes;
  for (int i = 0; i < count; ++i) shapes.push_back(Disc{{-3, 8.5f - 0.01f * static_cast<float>(i), 1}, {0, 1, 0}, 2});
  return shapes;
}

/// Discs close below the lamp, out of the picture; their shadows, four by four side by side, are a fifth of it.
std::vector<Shape> scattered() {
  std::vector<Shape> shapes;
  for (int i = 0; i < 16; ++i) {
    // Where the image is, 18 times as far from the lamp's foot, (-3, 1).
    const float x = (static_cast<float>(i % 4) - 1.5f) * 2.9f, z = (static_cast<float>(i / 4) - 1.5f) * 1.75f - 0.8f;
    shapes.push_back(Disc{{-3 + (x + 3) / 18, 8.5f, 1 + (z - 1) / 18}, {0, 1, 0}, 0.047f});
  }
  return shapes;
}

/// Slats side by side close below the lamp, half of them open.
std::vector<Shape> slats(int count) {
  std::vector<Shape> shapes;
  for (int i = 0; i < count; ++i) {
    const float x = -3 + 2.0f * (static_cast<float>(i) + 0.5f - static_cast<float>(count) / 2) / static_cast<float>(count);
    shapes.push_back(Plane{{x, 8.5f, 1}, {0, 0, 2}, {0.5f / static_cast<float>(count), 0, 0}});
  }
  return shapes;
}

struct Rig {
  Scene scene;
  std::unique_ptr<Technique> technique;
  GBuffer gbuffer;

  Rig(const std::vector<Shape>& shapes, const std::string& settings) : scene(scene_of(shapes)) {
    process_context();
    gbuffer = seen(scene, scene.views[0], width, height, Truth::shape);
    gbuffer_textures(gbuffer, scene);
    technique = made("composite_planar", settings, scene, scene.lights[0]);
  }
};

class FullScreenPass {
 public:
  void draw(const Rig& rig, VisibilityMask& mask) const {
    const StateGuard guard;
    glBindFramebuffer(GL_FRAMEBUFFER, framebuffer_.name());
    glNamedFramebufferTexture(framebuffer_.name(), GL_COLOR_ATTACHMENT0, mask.texture(), 0);
    glViewport(0, 0, width, height);
    bind_gbuffer(gbuffer_textures(rig.gbuffer, rig.scene));
    set_light(program_, rig.scene.lights[0]);
    glUseProgram(program_.name());
    draw_full_screen();
    glFinish();
  }

 private:
  Framebuffer framebuffer_ = make_framebuffer();
  Program program_ =
      pass_program("full screen", faces_light_constants, std::string(gbuffer_snippet) + std::string(faces_light_snippet) + R"(
layout(location = 0) out float visibility;
void main() { visibility = faces_light(position_here(), normal_here()) ? 0.5 : 1; }
)");
};

void resolve(benchmark::State& state, const std::vector<Shape>& shapes, const std::string& settings) {
  const Rig rig(shapes, settings);
  const FullScreenPass pass;
  VisibilityMask mask(width, height), other(width, height);
  alternate(
      state, [&] { rig.technique->resolve(rig.gbuffer, mask); }, [&] { pass.draw(rig, other); });
  const auto pixels = mask.read();
  state.counters["dark"] = static_cast<double>(std::ranges::count(pixels, 0.0f)) / static_cast<double>(pixels.size());
  for (const Count& count : rig.technique->counts())
    if (count.name == "fill" || count.name == "patches") state.counters[count.name] = count.value;
}

void relight(benchmark::State& state, const std::string& settings) {
  const auto count = static_cast<int>(state.range(0));
  const Rig rig(mixed(count, 0.2f, 10), settings);
  for (auto _ : state) rig.technique->relight(rig.scene.lights[0]);
  state.counters["per_shape"] =
      benchmark::Counter(count, benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}

void characteristic(benchmark::State& state, const Shape& shape) {
  const Mesh mesh = tessellate(shape, static_cast<int>(state.range(0)), "shape");
  const glm::dvec4 light = homogeneous(lamp), plane(0, 1, 0, 0);
  // Sixteen at a time: one is below the clock.
  constexpr int copies = 16;
  std::vector<glm::dvec3> projected(mesh.positions.size());
  alternate(
      state,
      [&] {
        for (int i = 0; i < copies; ++i) benchmark::DoNotOptimize(PlanarShadow(shape, light, plane, ShadowForm::paper));
      },
      [&] {
        for (int i = 0; i < copies; ++i) {
          for (std::size_t v = 0; v < projected.size(); ++v) {
            const glm::dvec4 image = image_on_plane(mesh.positions[v], light, plane);
            projected[v] = glm::dvec3(image) / image.w;
          }
          benchmark::ClobberMemory();
        }
      });
  state.counters["vertices"] = static_cast<double>(mesh.positions.size());
}

[[maybe_unused]] const bool registered = [] {
  for (const char* form : {"exact", "paper"}) {
    const std::string settings = fmt::format("form={}", form);
    const auto add = [&](const std::string& name, const std::vector<Shape>& shapes) {
      add_timed(fmt::format("composite_planar/resolve/{}/{}", form, name), resolve, shapes, settings)->Iterations(25);
    };
    add("few_16_small", mixed(16, 0.35f, 2.5f));
    add("few_16_large", mixed(16, 2.2f, 3));
    add("few_16_fifth", scattered());
    for (const int count : {1, 4, 16}) add(fmt::format("all_{}", count), covering(count));
    if (form == std::string_view("exact"))
      for (const int count : {64, 256}) add(fmt::format("slats_{}", count), slats(count));
    benchmark::RegisterBenchmark(fmt::format("composite_planar/relight/{}", form).c_str(), relight, settings)
        ->ArgName("shapes")
        ->ArgsProduct({{16, 64, 256}})
        ->Unit(benchmark::kMicrosecond);
  }
  for (const auto& [name, shape] :
       {std::pair("sphere", Shape(Sphere{{0, 2, 0}, 0.5f})), std::pair("cone", Shape(Cone{{0, 2, 0}, {0, 1, 0}, 0.5f, 1})),
        std::pair("disc", Shape(Disc{{0, 2, 0}, {0, 1, 0}, 0.5f}))})
    add_timed(fmt::format("composite_planar/characteristic/{}", name), characteristic, shape)
        ->ArgName("segments")
        ->ArgsProduct({{16, 64, 256}})
        ->Iterations(500)
        ->Unit(benchmark::kMicrosecond);
  return true;
}();

}  // namespace
