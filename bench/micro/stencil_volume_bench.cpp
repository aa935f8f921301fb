// What stencil_volume costs beside the least that its stages must do. Contender and floor alternate inside one run; `ratio` is
// the ratio of their medians.
//
// adjacency     EdgeAdjacency of a scan, beside reading the corners of every triangle once. Target: at most 500 ms.
// relight       The outline and both caps, found and uploaded, beside a copy that reads and writes as many bytes as the stage
//               must. Target: at most 15 ms for the dragon.
// resolve       Beside a bare draw of the same triangles, whose corners lie in a buffer already: the same order, stencil
//               state, depth, size and ends, one draw for each kind of face, and a pass that writes a constant where the
//               stencil is not zero, with position and normal fetched. Target: a ratio of at most 1.3.
// per_triangle  Side quads of every triangle (contender) beside those of the outline (floor), both by resolve.
//
// Adjacency and relight run on two threads.
#include <benchmark/benchmark.h>
#include <gnomon/kit/geometry/edges.h>
#include <gnomon/kit/gl/gl_pass.h>
#include <gnomon/kit/parallel.h>
#include <gnomon/kit/volumes/volume_faces.h>
#include <tbb/global_control.h>

#include <cstring>

#include "bench/micro/alternate.h"
#include "bench/micro/scenes.h"
#include "device/context.h"

namespace {
using namespace gnomon;

constexpr int width = 960, height = 540;
constexpr std::size_t block = std::size_t{1} << 15;

std::unique_ptr<Technique> made(const Scene& scene, const std::string& settings) {
  process_context();
  return gnomon::made("stencil_volume", settings, scene);
}

tbb::global_control two_threads() { return {tbb::global_control::max_allowed_parallelism, 2}; }

void adjacency(benchmark::State& state, const char* reference) {
  const Scene* scene = loaded(state, reference);
  if (!scene) return;
  const auto threads = two_threads();
  const auto read_corners = [&] {
    for (const Mesh& mesh : scene->meshes)
      for_blocks(mesh.triangles.size(), block, [&](std::size_t begin, std::size_t end) {
        glm::vec3 sum(0);
        for (std::size_t t = begin; t < end; ++t)
          for (int k = 0; k < 3; ++k) sum += mesh.positions[mesh.triangles[t][k]];
        benchmark::DoNotOptimize(sum);
      });
  };
  alternate(
      state, [&] { benchmark::DoNotOptimize(EdgeAdjacency(*scene)); }, read_corners);
  state.counters["triangles"] = static_cast<double>(scene->triangle_count());
}

/// What the stage must touch whatever it keeps: positions and triangles, the ends and neighbors of every edge; and write: the
/// triangles of the light caps and a side for every copy of an edge.
std::size_t least_bytes(const EdgeAdjacency& adjacency, const Silhouette& silhouette) {
  std::size_t copies = 0;
  for (const SilhouetteEdge& edge : silhouette.edges) copies += static_cast<std::size_t>(std::abs(edge.count));
  const auto caps = adjacency.triangles().size() - static_cast<std::size_t>(std::ranges::count(silhouette.facing, 0));
  return adjacency.positions().size_bytes() + adjacency.triangles().size_bytes() + adjacency.edges().size_bytes() +
         adjacency.irregular_edges().size_bytes() + adjacency.sides().size_bytes() + caps * sizeof(glm::uvec3) +
         copies * sizeof(glm::uvec4);
}

void relight(benchmark::State& state, const char* reference) {
  const Scene* scene = loaded(state, reference);
  if (!scene) return;
  const auto threads = two_threads();
  const auto technique = made(*scene, "count=zfail");
  const Light& light = scene->lights[0];
  const EdgeAdjacency adjacency(*scene);
  Silhouette silhouette;
  adjacency.find_silhouette(homogeneous(light), silhouette);
  const std::size_t bytes = least_bytes(adjacency, silhouette);
  // Half of them are read, half are written.
  const std::vector<char> from(bytes / 2, 1);
  std::vector<char> to(bytes / 2);
  const auto copy = [&] {
    for_blocks(to.size(), 16 * block,
               [&](std::size_t begin, std::size_t end) { std::memcpy(&to[begin], &from[begin], end - begin); });
    benchmark::ClobberMemory();
  };
  alternate(
      state, [&] { technique->relight(light); }, copy);
  state.counters["bytes"] = static_cast<double>(bytes);
  state.counters["edges"] = static_cast<double>(silhouette.edges.size());
}

/// The faces of the shadow volumes of a scene as a list of triangles, in the order of stencil_volume.
class BareVolumes {
 public:
  BareVolumes(const Scene& scene, const Light& light, bool behind_surface) : behind_(behind_surface), ends_(scene) {
    const EdgeAdjacency adjacency(scene);
    Silhouette silhouette;
    adjacency.find_silhouette(homogeneous(light), silhouette);
    add_sides(adjacency, silhouette);
    if (behind_) add_light_caps(adjacency, silhouette);
    if (behind_) add_dark_caps(adjacency, silhouette);
    buffer_ = Buffer(corners_.data(), corners_.size() * sizeof(glm::vec4));
    glVertexArrayVertexBuffer(vertex_array_.name(), 0, buffer_.name(), 0, sizeof(glm::vec4));
    glVertexArrayAttribFormat(vertex_array_.name(), 1, 4, GL_FLOAT, GL_FALSE, 0);
    glVertexArrayAttribBinding(vertex_array_.name(), 1, 0);
    glEnableVertexArrayAttrib(vertex_array_.name(), 1);
  }

  /// Leaves the count in the stencil of `depth`, and a pass over the pixels that it lets through in the mask.
  void draw(const DepthStencil& depth, const GBufferTextures& gbuffer, VisibilityMask& mask, const glm::mat4& clip) const {
    const PixelRectangle within = around(gbuffer.receivers);
    const StateGuard guard;
    const GLint zero = 0;
    glNamedFramebufferTexture(framebuffer_.name(), GL_DEPTH_STENCIL_ATTACHMENT, depth.texture.name(), 0);
    glBindFramebuffer(GL_FRAMEBUFFER, framebuffer_.name());
    glClearNamedFramebufferiv(framebuffer_.name(), GL_STENCIL, 0, &zero);
    glViewport(0, 0, depth.texture.width, depth.texture.height);
    glEnable(GL_DEPTH_TEST);
    glDepthMask(GL_FALSE);
    glDepthFunc(GL_GREATER);
    glColorMask(GL_FALSE, GL_FALSE, GL_FALSE, GL_FALSE);
    glEnable(GL_STENCIL_TEST);
    glStencilFunc(GL_ALWAYS, 0, ~0u);
    glEnable(GL_SCISSOR_TEST);
    glScissor(within.left, within.top, within.right - within.left, within.bottom - within.top);
    if (!behind_) glEnable(GL_DEPTH_CLAMP);
    program_.set("clip_from_world", clip);
    glUseProgram(program_.name());
    glBindVertexArray(vertex_array_.name());
    for (const Draw& draw : draws_) {
      const GLenum in = draw.reversed ? GL_DECR_WRAP : GL_INCR_WRAP, out = draw.reversed ? GL_INCR_WRAP : GL_DECR_WRAP;
      glStencilOpSeparate(GL_FRONT, GL_KEEP, behind_ ? out : GL_KEEP, behind_ ? GL_KEEP : in);
      glStencilOpSeparate(GL_BACK, GL_KEEP, behind_ ? in : GL_KEEP, behind_ ? GL_KEEP : out);
      glDrawArrays(GL_TRIANGLES, draw.first, draw.count);
    }
    glBindVertexArray(0);
    write(mask, gbuffer);
    glFinish();
  }

  /// Whether every pixel that the mask says is in shadow has a count, and every other one that faces the light has none.
  bool agrees(const DepthStencil& depth, VisibilityMask& mask, const Scene& scene, const GBuffer& gbuffer,
              const Light& light) const {
    std::vector<std::uint8_t> stencil(gbuffer.size());
    glGetTextureImage(depth.texture.name(), 0, GL_STENCIL_INDEX, GL_UNSIGNED_BYTE, static_cast<GLsizei>(stencil.size()),
                      stencil.data());
    const auto visible = mask.read();
    for (std::size_t i = 0; i < stencil.size(); ++i)
      if (faces_light(scene, gbuffer, light, i) && (visible[i] == 0) != (stencil[i] != 0)) return false;
    return true;
  }

  std::size_t triangle_count() const { return corners_.size() / 3; }

 private:
  struct Draw {
    GLint first;
    GLsizei count;
    bool reversed;
  };
  void write(VisibilityMask& mask, const GBufferTextures& gbuffer) const {
    glNamedFramebufferTexture(framebuffer_.name(), GL_COLOR_ATTACHMENT0, mask.texture(), 0);
    glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
    const float lit[] = {1, 0, 0, 0};
    glClearNamedFramebufferfv(framebuffer_.name(), GL_COLOR, 0, lit);
    glDisable(GL_DEPTH_TEST);
    glStencilFunc(GL_NOTEQUAL, 0, ~0u);
    glStencilOp(GL_KEEP, GL_KEEP, GL_KEEP);
    bind_gbuffer(gbuffer);
    glUseProgram(mask_program_.name());
    draw_full_screen();
    glNamedFramebufferTexture(framebuffer_.name(), GL_COLOR_ATTACHMENT0, 0, 0);
  }
  void add(std::initializer_list<glm::vec4> corners) { corners_.insert(corners_.end(), corners); }
  void end_draw(bool reversed) {
    const GLint first = draws_.empty() ? 0 : draws_.back().first + draws_.back().count;
    draws_.push_back({first, static_cast<GLsizei>(corners_.size()) - first, reversed});
  }
  static glm::vec4 near(const EdgeAdjacency& adjacency, std::uint32_t v) { return {adjacency.positions()[v], 1}; }
  /// Where the way of light through a point ends: on the part's far plane, else at infinity.
  glm::vec4 far(const glm::vec3& point, const EdgeAdjacency::Part& part, const glm::dvec4& light) const {
    const auto k = behind_ ? ends_.end_of(part, light) : std::nullopt;
    if (!k) return extruded(point, light);
    const glm::dvec4 p(point, 1);
    return glm::dot(ends_[*k], light) * p - glm::dot(ends_[*k], p) * light;
  }
  template <class Visit>
  static void for_copies(const Silhouette& silhouette, const Visit& visit) {
    for (const SilhouetteEdge& edge : silhouette.edges)
      for (int i = 0; i < std::abs(edge.count); ++i) visit(edge);
  }

  void add_sides(const EdgeAdjacency& adjacency, const Silhouette& silhouette) {
    const glm::dvec4& light = silhouette.light;
    for_copies(silhouette, [&](const SilhouetteEdge& edge) {
      const glm::vec4 a = near(adjacency, edge.low), b = near(adjacency, edge.high);
      const EdgeAdjacency::Part& part = adjacency.parts()[edge.part];
      const glm::vec4 c = far(adjacency.positions()[edge.low], part, light),
                      d = far(adjacency.positions()[edge.high], part, light);
      if (light.w == 0 && !behind_)
        edge.count > 0 ? add({a, c, b}) : add({a, b, c});
      else
        edge.count > 0 ? add({a, c, d, a, d, b}) : add({a, d, c, a, b, d});
    });
    end_draw(false);
  }
  void add_light_caps(const EdgeAdjacency& adjacency, const Silhouette& silhouette) {
    for (const int turn : {1, -1}) {
      for (std::size_t t = 0; t < silhouette.facing.size(); ++t)
        if (silhouette.facing[t] == turn)
          for (int k = 0; k < 3; ++k) add({near(adjacency, adjacency.triangles()[t][k])});
      end_draw(turn < 0);
    }
  }
  /// Fans over the outlines of the parts that have them, then triangle by triangle for the rest.
  void add_dark_caps(const EdgeAdjacency& adjacency, const Silhouette& silhouette) {
    const glm::dvec4& light = silhouette.light;
    for_copies(silhouette, [&](const SilhouetteEdge& edge) {
      const EdgeAdjacency::Part& part = adjacency.parts()[edge.part];
      if (!has_hub(part, light)) return;
      const glm::vec4 apex = far((part.bounds.min + part.bounds.max) / 2.0f, part, light);
      const glm::vec4 low = far(adjacency.positions()[edge.low], part, light),
                      high = far(adjacency.positions()[edge.high], part, light);
      edge.count > 0 ? add({apex, high, low}) : add({apex, low, high});
    });
    end_draw(false);
    for (std::size_t t = 0; t < silhouette.facing.size(); ++t) {
      if (silhouette.facing[t] == 0) continue;
      if (has_hub(adjacency.parts()[adjacency.part_of()[t]], light)) continue;
      glm::uvec3 v = adjacency.triangles()[t];
      if (silhouette.facing[t] > 0) std::swap(v.y, v.z);
      for (int k = 0; k < 3; ++k) add({extruded(adjacency.positions()[v[k]], light)});
    }
    end_draw(false);
  }

  bool behind_;
  FarPlanes ends_;
  std::vector<glm::vec4> corners_;
  std::vector<Draw> draws_;
  Buffer buffer_;
  VertexArray vertex_array_ = make_vertex_array();
  Framebuffer framebuffer_ = make_framebuffer();
  Program program_{
      "bare volumes",
      std::string(position_snippet) + "layout(location = 1) in vec4 corner; void main() { gl_Position = place(corner); }",
      "void main() {}"};
  Program mask_program_{"bare mask", full_screen_vertex, std::string(gbuffer_snippet) + R"(
layout(location = 0) out float visibility;
void main() { visibility = dot(position_here(), normal_here()) > 0 ? 0 : 1; })"};
};

/// A scene with its inputs uploaded, as resolve requires it.
struct Frame {
  const Scene& scene;
  GBuffer gbuffer;

  explicit Frame(const Scene& looked_at) : scene(looked_at) {
    process_context();
    gbuffer = seen(scene, scene.views[0], width, height);
    scene_buffers(scene);
    gbuffer_textures(gbuffer, scene);
    depth_stencil(scene, gbuffer);
  }
};

void resolve(benchmark::State& state, const char* reference, const char* method) {
  const Scene* scene = loaded(state, reference);
  if (!scene) return;
  const Frame frame(*scene);
  const Light& light = scene->lights[0];
  const auto technique = made(*scene, fmt::format("count={}", method));
  technique->relight(light);
  const BareVolumes bare(*scene, light, std::string_view(method) == "zfail");
  const glm::mat4 clip(clip_from_world(frame.gbuffer, *scene));
  VisibilityMask mask(width, height), other(width, height);
  const auto contender = [&] { technique->resolve(frame.gbuffer, mask); };
  const auto floor = [&] {
    bare.draw(depth_stencil(*scene, frame.gbuffer), gbuffer_textures(frame.gbuffer, *scene), other, clip);
  };
  contender(), floor();
  if (!bare.agrees(depth_stencil(*scene, frame.gbuffer), mask, *scene, frame.gbuffer, light))
    return state.SkipWithError("the bare draw and resolve disagree");
  alternate(state, contender, floor);
  state.counters["triangles"] = static_cast<double>(bare.triangle_count());
  for (const Count& count : technique->counts())
    if (count.name == "counter_bits") state.counters[count.name] = count.value;
}

void per_triangle(benchmark::State& state) {
  const Scene scene = ball_over_ground("ball_over_ground", 1, static_cast<int>(state.range(0)));
  const Frame frame(scene);
  const auto outline = made(scene, "extrusion=silhouette"), triangles = made(scene, "extrusion=per_triangle");
  outline->relight(scene.lights[0]), triangles->relight(scene.lights[0]);
  VisibilityMask mask(width, height), other(width, height);
  alternate(
      state, [&] { triangles->resolve(frame.gbuffer, mask); }, [&] { outline->resolve(frame.gbuffer, other); });
  state.counters["triangles"] = static_cast<double>(scene.meshes[1].triangles.size());
}

[[maybe_unused]] const bool registered = [] {
  const char* const dragon = "dragon";
  add_timed("stencil_volume/adjacency/dragon", adjacency, dragon)->Iterations(9);
  for (const char* scene : {dragon, "bunny"}) add_timed(fmt::format("stencil_volume/relight/{}", scene), relight, scene);
  for (const char* scene : {"bunny", "box_city", "sphere_field"})
    for (const char* method : {"zfail", "zpass"})
      add_timed(fmt::format("stencil_volume/resolve/{}/{}", scene, method), resolve, scene, method)->Iterations(15);
  add_timed("stencil_volume/per_triangle", per_triangle)->ArgName("segments")->ArgsProduct({{32, 72, 142}})->Iterations(9);
  return true;
}();

}  // namespace
