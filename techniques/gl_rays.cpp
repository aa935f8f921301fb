// Shadow rays in OpenGL: one any-hit ray from every visible point to the light, traced by a compute shader through a tree of
// boxes in buffers.
//
// The ray is that of the reference (docs/method.md). The tree is our own, built on the processor: Embree is what the answers
// are compared with. Nodes lie in depth-first order and know what to skip, so that a ray needs no stack. The way to one light
// is much the same for neighboring pixels, and the first hit ends a ray, so children have no order.
#include <gnomon/kit/counts.h>
#include <gnomon/kit/geometry/first_triangles.h>
#include <gnomon/kit/gl/gl_pass.h>
#include <gnomon/kit/pictures/layers.h>
#include <gnomon/kit/shared.h>
#include <gnomon/registry.h>

#include <numeric>

#include "gl_rays/casters.h"
#include "gl_rays/shader.h"

namespace {
using namespace gnomon;
using namespace gnomon::gl_rays;

constexpr About about{
    .title = "Shadow rays in OpenGL",
    .summary = "One shadow ray from every visible point to the light, traced by a compute shader through a tree of boxes.",
    .source =
        "Woop, Benthin and Wald 2013 (watertight test); Smits 1998 (links that skip); Wald 2007 (bins); Aila and Laine 2009 "
        "(loops).",
    .error =
        "None on the points it sees, away from rays that graze an edge closer than float32 rounding (class U). Texels of alpha "
        "masks and glass are found in double, and what glass lets through is multiplied in double, in the order of the tree. It "
        "sees triangles: against exact spheres, cones and discs it errs by the tessellation.",
    .fails = "Nothing it supports. Under a software renderer it is several times slower than rays on the processor.",
    .promise = Promise::exact,
    .device = Device::opengl,
    .floor = Floor::fetch,
    .handles = with_gray_transmission,
    .named_only = true};

constexpr double least_extent = 1e-19;  ///< largest coordinate of a scene, meters: below, squares leave float32
constexpr std::string_view boxes_layer = "boxes";

/// Texels of a buffer that a shader of the present context can read, at most; nothing without a context.
std::optional<std::size_t> most_buffer_texels() {
  if (!gl_limits()) return std::nullopt;
  GLint64 most = 0;
  glGetInteger64v(GL_MAX_TEXTURE_BUFFER_SIZE, &most);
  return static_cast<std::size_t>(most);
}

/// A buffer that shaders read as texels of four numbers: under llvmpipe in two thirds of the time of a storage buffer.
struct Texels {
  Buffer buffer;
  GlObject<glDeleteTextures> texture;

  /// Writes values, into a buffer with so many bytes of room.
  void write(const auto& values, std::size_t room) {
    if (!buffer || buffer.bytes != room) {
      *this = {};  // before the new one comes
      buffer = Buffer(nullptr, room, GL_DYNAMIC_STORAGE_BIT);
      GLuint name = 0;
      glCreateTextures(GL_TEXTURE_BUFFER, 1, &name);
      texture = GlObject<glDeleteTextures>(name);
      glTextureBuffer(name, GL_RGBA32UI, buffer.name());
    }
    if (!values.empty())
      glNamedBufferSubData(buffer.name(), 0, static_cast<GLsizeiptr>(values.size() * sizeof(values[0])), values.data());
  }
  void bind(GLuint image) const { glBindImageTexture(image, texture.name(), 0, GL_FALSE, 0, GL_READ_ONLY, GL_RGBA32UI); }
};

/// What setup and build make.
struct Built {
  Program solid, textured;
  const Scene* scene = nullptr;
  bool has_textures = false;
  std::optional<Casters> casters;  // in memory only where the scene may move
  Texels nodes, corners;
  Buffer meshes;
  int node_count = 0;
  float scale = 1;
  std::size_t triangles = 0;

  std::size_t bytes() const {
    return nodes.buffer.bytes + corners.buffer.bytes + meshes.bytes + (casters ? casters->bytes() : 0);
  }
  /// Where the scene moves there is room for any tree of it.
  void upload(bool moves) {
    node_count = static_cast<int>(casters->nodes().size());
    scale = casters->scale();
    triangles = casters->triangle_count();
    nodes.write(casters->nodes(), (moves ? casters->most_nodes() : casters->nodes().size()) * sizeof(Node));
    corners.write(casters->corners(), casters->corners().size() * sizeof(Corner));
  }
};

class GlRays final : public Technique {
 public:
  Support supports(const Scene& scene, const Light& light, const View&) const override {
    if (has_area(light)) return Support::unsupported("one ray per pixel cannot see part of a light with area");
    if (const double extent = scene.bounds().extent(); extent > 0 && extent < least_extent)
      return Support::unsupported(fmt::format("the scene reaches {:.3g} m, rays of float32 need {} m", extent, least_extent));
    if (const Support support = tree_support(caster_count(scene), most_buffer_texels()); !support) return support;
    // Those of the scene, where casters have textures.
    std::size_t vertices = 0, triangles = 0;
    if (scene.has_alpha_masks() || scene.has_transmission())
      for (const Mesh& mesh : scene.meshes) {
        vertices += mesh.positions.size();
        triangles += mesh.triangles.size();
      }
    return within_limits({.compute_storage_blocks = 5,
                          .storage_bindings = 8,
                          .storage_block_bytes =
                              static_cast<std::int64_t>(std::max(vertices * sizeof(glm::vec2), triangles * sizeof(glm::uvec3))),
                          .work_group_size = group_side * group_side,
                          .work_groups = 2048});
  }
  void setup() override {
    built_->solid = Program::compute("gl_rays", trace_source(false));
    built_->textured = Program::compute("gl_rays through textures", trace_source(true));
    warm_up(*this);
    warm_up(*this, true);
  }
  void build(const Scene& scene) override {
    built_->scene = &scene;
    built_->has_textures = scene.has_alpha_masks() || scene.has_transmission();
    if (built_->has_textures) scene_buffers(scene);
    const std::vector<std::uint32_t> firsts = first_triangles(scene);
    built_->meshes = Buffer(firsts.data(), firsts.size() * sizeof firsts[0]);
    built_->casters.emplace(scene);
    const bool moves = follows_animation(scene);
    built_->upload(moves);
    if (!moves) built_->casters.reset();
    glFinish();
  }
  void update(const Scene& scene, const Changes& changes) override {
    if (!built_->casters || !follows_animation(scene)) return build(scene);
    if (built_->has_textures) scene_buffers(scene);
    if (built_->casters->update(scene, changes)) built_->upload(true);
    glFinish();
  }
  void relight(const Light& light) override { light_ = light; }
  void resolve(const GBuffer& gbuffer, VisibilityMask& mask) override {
    const StateGuard guard;
    gbuffer_ = &gbuffer;
    box_counts_.fit(GL_R32F, gbuffer.width, gbuffer.height);
    read_counts_.clear();
    const Program& program = built_->has_textures ? built_->textured : built_->solid;
    bind(mask.texture());
    set_light(program, light_);
    program.set("scale", built_->scale);
    program.set("node_count", built_->node_count);
    program.set("sees_shapes", static_cast<int>(gbuffer.truth == Truth::shape));
    glUseProgram(program.name());
    const auto groups = [](int pixels) { return static_cast<GLuint>((pixels + group_side - 1) / group_side); };
    glDispatchCompute(groups(gbuffer.width), groups(gbuffer.height), 1);
    glMemoryBarrier(GL_TEXTURE_FETCH_BARRIER_BIT | GL_TEXTURE_UPDATE_BARRIER_BIT | GL_FRAMEBUFFER_BARRIER_BIT |
                    GL_PIXEL_BUFFER_BARRIER_BIT);
    glFinish();
  }
  Counts counts() const override {
    const std::vector<float>& boxes = box_counts();
    const auto rays = static_cast<std::uint64_t>(std::ranges::count_if(boxes, [](float count) { return count > 0; }));
    Count mean = mean_of("boxes_per_ray", static_cast<std::uint64_t>(std::accumulate(boxes.begin(), boxes.end(), 0.0)), rays);
    mean.is_by_tree = true;
    return {count_of("rays", rays),
            std::move(mean),
            {"nodes", built_.own(double(built_->node_count)), "", Count::Together::sum, true},
            {"triangles", built_.own(double(built_->triangles)), ""},
            {"bytes", built_.own(double(built_->bytes())) + double(box_counts_.bytes), "byte"}};
  }
  std::vector<DebugLayer> debug_layers() const override {
    return {heat_debug_layer(std::string(boxes_layer), "Boxes that the ray from each point tested")};
  }
  std::vector<float> draw_debug(std::string_view layer) const override {
    return layer == boxes_layer ? heat_layer(*gbuffer_, box_counts()) : Technique::draw_debug(layer);
  }
  std::unique_ptr<Technique> for_another_light() const override { return another(*this, &GlRays::built_); }

 private:
  void bind(GLuint mask) const {
    bind_gbuffer(gbuffer_textures(*gbuffer_, *built_->scene));
    glBindImageTexture(0, mask, 0, GL_FALSE, 0, GL_WRITE_ONLY, GL_R32F);
    glBindImageTexture(1, box_counts_.name(), 0, GL_FALSE, 0, GL_WRITE_ONLY, GL_R32F);
    built_->nodes.bind(2);
    built_->corners.bind(3);
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 0, built_->meshes.name());
    if (!built_->has_textures) return;
    const SceneBuffers& buffers = scene_buffers(*built_->scene);
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 3, buffers.triangles.name());
    if (buffers.uv) glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 4, buffers.uv.name());
    buffers.bind_transmissions();
    buffers.bind_masks();
  }
  /// Of the last resolve, read back once.
  const std::vector<float>& box_counts() const {
    if (read_counts_.empty() && box_counts_) read_counts_ = read_texels<float>(box_counts_, GL_RED);
    return read_counts_;
  }

  Shared<Built> built_;
  Light light_;
  const GBuffer* gbuffer_ = nullptr;        // of the last resolve
  Texture box_counts_;                      // likewise, of each pixel's ray; 0: it has none
  mutable std::vector<float> read_counts_;  // likewise
};

}  // namespace

GNOMON_TECHNIQUE(gl_rays, GlRays, about)
