// What shadow_map costs beside the least that its stages must do: a bare depth-only draw of the same triangles at the same
// resolution and faces (relight), and one full-screen pass that fetches the same textures and writes the same target
// (resolve). Contender and floor alternate inside one run; `ratio` is the ratio of their medians.
#include <benchmark/benchmark.h>
#include <gnomon/kit/maps/light_map.h>

#include "bench/micro/alternate.h"
#include "bench/micro/scenes.h"
#include "device/context.h"

extern "C" void gnomon_technique_shadow_map(gnomon::Registry&);

namespace {
using namespace gnomon;

constexpr int resolution = 1024;

/// Spheres all around the origin in one mesh over a ground: the lights below see casters and receivers in their whole cone or
/// in all six directions, so that every face is drawn and holds every triangle.
Scene sphere_cloud(int spheres) {
  Mesh cloud;
  for (int i = 0; i < spheres; ++i) {
    const float turn = 2.4f * static_cast<float>(i),
                height = 2 * (static_cast<float>(i) + 0.5f) / static_cast<float>(spheres) - 1;
    const float around = std::sqrt(1 - height * height);
    const glm::vec3 center = 3.0f * glm::vec3(around * std::cos(turn), height, around * std::sin(turn));
    const Mesh sphere = tessellate(Sphere{center, 0.4f}, 32, "sphere");
    const auto first = static_cast<std::uint32_t>(cloud.positions.size());
    cloud.positions.insert(cloud.positions.end(), sphere.positions.begin(), sphere.positions.end());
    for (const glm::uvec3& t : sphere.triangles) cloud.triangles.push_back(t + first);
  }
  Scene scene;
  scene.meshes = {cloud, tessellate(Plane{{0, -4, 0}, {0, 0, 8}, {8, 0, 0}}, 4, "ground")};
  scene.views = {View{.eye = {0, 3, 14}, .target = {0, -1, 0}}};
  scene.lights = {{.name = "spot", .kind = SpotLight{{0, 10, 0}, {0, -1, 0}, 15, 20}}, {.name = "point", .kind = PointLight{}}};
  return scene;
}

struct Rig {
  Scene scene = sphere_cloud(60);
  std::unique_ptr<Technique> technique;
  GBuffer gbuffer;

  Rig(int width, int height) {
    process_context();
    Registry registry;
    gnomon_technique_shadow_map(registry);
    technique = registry.techniques()[0].make();
    gbuffer = seen(scene, scene.views[0], width, height);
    scene_buffers(scene);
    gbuffer_textures(gbuffer, scene);
    technique->setup();
    technique->build(scene);
  }
};

/// The least that a shadow map must do with the very faces that shadow_map fits: depth-only draws, and the texels that the
/// pixels look up, found beforehand.
class BareMap {
 public:
  BareMap(const Scene& scene, const Light& light)
      : scene_(scene), camera_(fit_to_scene(light, mesh_boxes(scene), resolution, 1)) {
    depth_ = Texture(GL_DEPTH_COMPONENT32F, resolution, resolution, static_cast<int>(camera_.images.size()));
  }

  void draw() const {
    const SceneBuffers& buffers = scene_buffers(scene_);
    const StateGuard guard;
    glBindFramebuffer(GL_FRAMEBUFFER, framebuffer_.name());
    glViewport(0, 0, resolution, resolution);
    glEnable(GL_DEPTH_TEST);
    glDepthFunc(GL_GREATER);
    glUseProgram(program_.name());
    for (std::size_t i = 0; i < camera_.images.size(); ++i) {
      if (camera_.images[i].casters.empty()) continue;
      glNamedFramebufferTextureLayer(framebuffer_.name(), GL_DEPTH_ATTACHMENT, depth_.name(), 0, static_cast<GLint>(i));
      const float infinitely_far = 0;
      glClearNamedFramebufferfv(framebuffer_.name(), GL_DEPTH, 0, &infinitely_far);
      program_.set("clip_from_world", glm::mat4(camera_.images[i].clip_from_world(resolution)));
      buffers.draw(camera_.images[i].casters);
    }
    glFinish();
  }

  /// Column, row and layer of the texel that each pixel looks up; layer -1 on the background.
  Texture texels(const GBuffer& gbuffer) const {
    std::vector<glm::vec4> at(gbuffer.size(), glm::vec4(0, 0, -1, 1));
    for (std::size_t i = 0; i < at.size(); ++i) {
      if (gbuffer.is_background(i)) continue;
      const int which = camera_.space.face_of(gbuffer.position(i));
      const LightImage& face = camera_.images[which];
      at[i] = {glm::floor(face.place_of(gbuffer.position(i)) * face.scale + face.offset), which, 1};
    }
    Texture texture(GL_RGBA32F, gbuffer.width, gbuffer.height);
    glTextureSubImage2D(texture.name(), 0, 0, 0, gbuffer.width, gbuffer.height, GL_RGBA, GL_FLOAT, at.data());
    return texture;
  }

  const Texture& depth() const { return depth_; }

 private:
  const Scene& scene_;
  LightCamera camera_;
  Texture depth_;
  Framebuffer framebuffer_ = make_framebuffer();
  Program program_{"bare depth", std::string(position_snippet) + "void main() { gl_Position = place(vec4(position, 1)); }",
                   "void main() {}"};
};

void relight(benchmark::State& state) {
  Rig rig(64, 36);
  const Light& light = rig.scene.lights[state.range(0)];
  const BareMap bare(rig.scene, light);
  alternate(
      state, [&] { rig.technique->relight(light); }, [&] { bare.draw(); });
  state.SetLabel(light.name);
}

void resolve(benchmark::State& state) {
  Rig rig(static_cast<int>(state.range(1)), static_cast<int>(state.range(2)));
  const Light& light = rig.scene.lights[state.range(0)];
  rig.technique->relight(light);
  VisibilityMask mask(rig.gbuffer.width, rig.gbuffer.height), target(rig.gbuffer.width, rig.gbuffer.height);
  const Program program("bare fetch", full_screen_vertex, R"(
layout(binding = 0) uniform sampler2D texels;  // in place of the position: same format, same size
layout(binding = 1) uniform sampler2D normal;
layout(binding = 3) uniform sampler2DArray map;
layout(location = 0) out float visibility;
void main() {
  ivec2 pixel = ivec2(gl_FragCoord.xy);
  vec4 at = texelFetch(texels, pixel, 0), n = texelFetch(normal, pixel, 0);
  float depth = texelFetch(map, ivec3(at.xyz), 0).r;
  visibility = n.x + n.y + n.z + n.w > depth ? 1 : 0;
}
)");
  BareMap bare(rig.scene, light);
  bare.draw();
  const Texture texels = bare.texels(rig.gbuffer);
  const Framebuffer framebuffer = make_framebuffer();
  const auto floor = [&] {
    const StateGuard guard;
    bind_gbuffer(gbuffer_textures(rig.gbuffer, rig.scene));
    glBindTextureUnit(0, texels.name());
    glBindTextureUnit(3, bare.depth().name());
    glNamedFramebufferTexture(framebuffer.name(), GL_COLOR_ATTACHMENT0, target.texture(), 0);
    glBindFramebuffer(GL_FRAMEBUFFER, framebuffer.name());
    glViewport(0, 0, target.width(), target.height());
    glUseProgram(program.name());
    draw_full_screen();
    glFinish();
  };
  alternate(
      state, [&] { rig.technique->resolve(rig.gbuffer, mask); }, floor);
  state.SetLabel(light.name);
}

[[maybe_unused]] const bool is_registered = [] {
  add_timed("shadow_map/relight", relight)->ArgName("light")->ArgsProduct({{0, 1}});
  add_timed("shadow_map/resolve", resolve)
      ->ArgNames({"light", "width", "height"})
      ->ArgsProduct({{0, 1}, {640}, {360}})
      ->ArgsProduct({{0, 1}, {960}, {540}});
  return true;
}();

}  // namespace
