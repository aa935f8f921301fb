// Shadow rays in Vulkan: any-hit rays from every visible point to the light, or to places of a light with area, traced by what
// the device has for rays, through its own acceleration structures.
//
// The ray is that of the reference (docs/method.md), cast by shaders in techniques/vulkan_rays. All triangles that cast are one
// tree, so that the number of a triangle tells a ray its own. Places are those of area_rays with pattern=interleaved: sixteen
// sets, one for every fourth pixel along x and y.
#include <gnomon/kit/area/light_points.h>
#include <gnomon/kit/area/light_shape.h>
#include <gnomon/kit/counts.h>
#include <gnomon/kit/pictures/layers.h>
#include <gnomon/kit/shared.h>
#include <gnomon/registry.h>

#include <cmath>
#include <numeric>

#include "vulkan_rays/tracer.h"

namespace {
using namespace gnomon;
using namespace gnomon::vulkan_rays;

constexpr About about{
    .title = "Shadow rays in Vulkan",
    .summary =
        "One shadow ray from every visible point to the light, or rays to places of a light with area, traced by the device's "
        "own acceleration structures, in a ray tracing pipeline or by ray queries.",
    .source =
        "Khronos 2020 (acceleration structures, ray tracing pipelines, ray queries); Owen 1995 and Keller and Heidrich 2001 "
        "(places of the light).",
    .error =
        "Without area none on the points it sees, away from rays that graze an edge closer than float32 rounding (class U), as "
        "far as the device's own test of triangles is exact there. Under a light with area noise, which falls with the number "
        "of samples, in a pattern of 4 x 4 pixels; it estimates the share of the light's area. It sees triangles: against "
        "exact spheres, cones and discs it errs by the tessellation.",
    .fails = "A penumbra of few samples: n of them tell n + 1 shares apart.",
    .device = Device::vulkan,
    .floor = Floor::fetch,
    .named_only = true};

constexpr double least_extent = 1e-19;  ///< largest coordinate of a scene, meters: below, squares leave float32
constexpr std::string_view rays_layer = "rays";
constexpr int set_count = 16;  ///< of places: interleaved_set

/// Largest coordinate of what a scene holds and its meshes reach.
double extent_of(const Scene& scene) {
  double extent = 0;
  for (const Mesh& mesh : scene.meshes) extent = std::max(extent, mesh.reached().extent());
  return extent;
}

/// Of the world to the frame that is traced: a power of two where float32 has little room, as for the reference.
float frame_scale(const Scene& scene) {
  const double extent = extent_of(scene);
  const bool has_room = extent == 0 || (extent >= 0x1p-10 && extent <= 0x1p30);
  return has_room ? 1 : static_cast<float>(std::exp2(std::min(-std::ilogb(extent), 100)));
}

std::size_t caster_count(const Scene& scene) {
  std::size_t count = 0;
  for (const Mesh& mesh : scene.meshes) count += mesh.casts ? mesh.triangles.size() : 0;
  return count;
}

/// All sets, one after the other.
std::vector<glm::vec2> places_of(const Light& light, int samples) {
  const bool is_disc = LightShape(light).form != LightShape::Form::rectangle;
  std::vector<glm::vec2> all;
  for (std::uint64_t set = 0; set < set_count; ++set) {
    PatternPlaces places("interleaved", samples, places_seed(1, set));
    for (int k = 0; k < samples; k += 16) {
      const Squares squares = places.next(static_cast<std::uint32_t>(k / 16));
      for (int lane = 0; lane < std::min(16, samples - k); ++lane) {
        const glm::dvec2 place(2.0 * squares.x[lane] - 1, 2.0 * squares.y[lane] - 1);
        all.emplace_back(is_disc ? place_in_disc(place) : place);
      }
    }
  }
  return all;
}

/// What shaders know of a light.
FrameConstants constants_of(const Light& light) {
  FrameConstants constants;
  if (!has_area(light)) {
    constants.light = homogeneous(light);
    if (const auto* spot = std::get_if<SpotLight>(&light.kind)) {
      const double cosine = std::cos(glm::radians(double(spot->outer_degrees)));
      constants.spot = glm::dvec4(glm::normalize(glm::dvec3(spot->direction)), cosine * cosine + 0x1p-20);
    }
    return constants;
  }
  const LightShape shape(light);
  const bool is_rectangle = shape.form == LightShape::Form::rectangle;
  constants.facts = is_area_light | (shape.is_one_sided ? is_one_sided : 0);
  constants.form = static_cast<std::int32_t>(shape.form);
  constants.center = glm::dvec4(shape.center, shape.radius);
  if (shape.is_flat()) constants.half_u = glm::dvec4(is_rectangle ? shape.half_u : shape.front(), 0);
  constants.half_v = glm::dvec4(shape.half_v, 0);
  return constants;
}

class VulkanRays final : public Technique {
 public:
  Choice trace{this,         "trace",
               "pipeline",   {"pipeline", "query"},
               Stage::setup, "What traces: a ray tracing pipeline, or a compute shader that queries."};
  Choice tree{this,         "build",
              "fast_trace", {"fast_trace", "fast_build"},
              Stage::build, "What the device is told to prefer where it builds."};
  Flag compaction{this, "compaction", true, Stage::build, "Copy the tree to no more room than it needs."};
  Choice moved{this,         "update",
               "refit",      {"refit", "rebuild"},
               Stage::build, "Where vertices moved: move the boxes of the tree, or build it anew."};
  Number<int> samples{this, "samples", 16, {"ray", 1, 4096, true}, Stage::resolve, "Rays from a point to a light with area."};

  Support supports(const Scene& scene, const Light&, const View&) const override {
    if (const double extent = scene.bounds().extent(); extent > 0 && extent < least_extent)
      return Support::unsupported(fmt::format("the scene reaches {:.3g} m, rays of float32 need {} m", extent, least_extent));
    if (const std::string why = refusal(way(), caster_count(scene)); !why.empty()) return Support::unsupported(why);
    return Support::full();
  }
  void setup() override {
    built_->emplace(way());
    warm_up();
  }
  void build(const Scene& scene) override {
    (**built_).build(scene, frame_scale(scene),
                     {.is_fast_to_trace = tree.is("fast_trace"), .compacts = compaction, .refits = moved.is("refit")});
  }
  void update(const Scene& scene, const Changes& changes) override {
    if ((**built_).scale() != frame_scale(scene)) return build(scene);
    (**built_).update(changes);
  }
  void relight(const Light& light) override { light_ = light; }
  void resolve(const GBuffer& gbuffer, VisibilityMask& mask) override {
    gbuffer_ = &gbuffer;
    FrameConstants constants = constants_of(light_);
    constants.samples = samples;
    if (gbuffer.truth == Truth::shape) constants.facts |= sees_shapes;
    const std::vector<glm::vec2> places = has_area(light_) ? places_of(light_, samples) : std::vector<glm::vec2>();
    answers_.resolve(**built_, constants, places, gbuffer, mask.pixels());
  }
  Counts counts() const override {
    const std::vector<std::uint32_t> rays = answers_.ray_counts();
    const Sizes sizes = (**built_).sizes();
    return {count_of("rays", std::accumulate(rays.begin(), rays.end(), std::uint64_t{0})),
            {"triangles", built_.own(double(sizes.triangles)), ""},
            {"tree_bytes", built_.own(double(sizes.tree_bytes)), "byte"},
            {"built_tree_bytes", built_.own(double(sizes.built_bytes)), "byte"},
            {"bytes", built_.own(double(sizes.bytes)) + double(answers_.bytes()), "byte"}};
  }
  std::vector<DebugLayer> debug_layers() const override {
    return {heat_debug_layer(std::string(rays_layer), "Rays from each point")};
  }
  std::vector<float> draw_debug(std::string_view layer) const override {
    if (layer != rays_layer) return Technique::draw_debug(layer);
    const std::vector<std::uint32_t> rays = answers_.ray_counts();
    return heat_layer(*gbuffer_, std::vector<float>(rays.begin(), rays.end()));
  }
  std::unique_ptr<Technique> for_another_light() const override { return another(*this, &VulkanRays::built_); }

 private:
  /// One ray: drivers compile at the first one.
  void warm_up() const {
    Scene scene;
    Mesh& floor = scene.meshes.emplace_back();
    floor.positions = {{0, 0, 0}, {1, 0, 0}, {0, 0, 1}};
    floor.triangles = {{0, 1, 2}};
    const float zero = 0, one = 1;
    const std::uint32_t mesh = 0, triangle = 0;
    GBuffer g;
    g.truth = Truth::mesh;
    g.width = g.height = 1;
    g.px = g.py = g.pz = g.nx = g.nz = {&zero, 1};
    g.ny = {&one, 1};
    g.mesh = {&mesh, 1};
    g.triangle = {&triangle, 1};
    float answer = 0;
    (**built_).build(scene, 1, {});
    Answers().resolve(**built_, constants_of({.name = "warm_up", .kind = PointLight{{0, 1, 0}}}), {}, g, {&answer, 1});
  }
  Trace way() const { return trace.is("query") ? Trace::query : Trace::pipeline; }

  Shared<std::optional<Tracer>> built_;
  Light light_;
  const GBuffer* gbuffer_ = nullptr;  // of the last resolve
  Answers answers_;
};

}  // namespace

GNOMON_TECHNIQUE(vulkan_rays, VulkanRays, about)
