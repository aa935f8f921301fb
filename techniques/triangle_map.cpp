// Triangle map: a shadow map whose texels also list the triangles that touch them. Where a list is whole, a point's segment to
// the light is tested against its triangles; elsewhere depths are compared.
//
// The depth images, their fit, bias and filter are those of shadow_map: with list_length=0 that is all there is. A caster with
// holes or glass makes lists open, for the test does not look into textures: there depth decides by the rules of the parameters
// alpha and glass.
//
// The test leaves out what Woop, Benthin and Wald add for an edge function of exactly 0, to compute all three in double: it
// would take away false hits at edges, where float32 is in doubt anyway, and no leak.
#include <gnomon/kit/geometry/first_triangles.h>
#include <gnomon/kit/maps/fitted_map.h>
#include <gnomon/kit/pictures/layers.h>
#include <gnomon/registry.h>

#include "triangle_map/lists.h"
#include "triangle_map/shader.h"

namespace {
using namespace gnomon;
using namespace gnomon::triangle_map;

constexpr OwnCause list_full{
    "list_full",
    "Depth decided: more triangles touch the texel than its list holds, or one of them has holes or glass.",
    {72, 8, 0}};
constexpr OwnCause causes[] = {map_causes[0], map_causes[1], map_causes[2], list_full};
static_assert(std::size(causes) == std::size(map_causes) + 1);

constexpr About about{
    .title = "Triangle map",
    .summary = "Each texel of the light's image lists the triangles that touch it, and points are tested against those.",
    .source =
        "Lecocq, Marvie, Sourimant and Gautron 2014 (triangles in texels); Hasselgren, Akenine-Moeller and Ohlsson 2005 "
        "(conservative raster); Woop, Benthin and Wald 2013 (test)",
    .error =
        "None in float32 where a texel's list is whole, at any resolution; a shadow map's where it is not. Tessellation on "
        "curved shapes.",
    .fails =
        "A mesh whose triangles are smaller than texels: its lists overflow, and depth decides. Casters with holes and glass, "
        "whose texels depth decides always.",
    .device = Device::opengl,
    .floor = Floor::depth_draw,
    .handles = with_gray_transmission,
    .causes = causes,
    .named_only = true};

constexpr std::string_view length_layer = "list";
/// Bytes that the entries of a light's lists may take: what they take goes into one texture.
constexpr std::int64_t most_entry_bytes = std::int64_t{1} << 30;

class TriangleMap final : public FittedMap {
  Number<int> list_length = Number<int>(
      this, "list_length", 8, {.unit = "triangles", .min = 0, .max = 32}, Stage::setup,
      "How many triangles a texel's list holds. Of a texel that more touch, depth decides; with 0 of all: the answers "
      "are those of shadow_map.");

 public:
  Support supports(const Scene& scene, const Light& light, const View& view) const override {
    const Support support = FittedMap::supports(scene, light, view);
    if (!support || !has_lists()) return support;
    const Support enough = lists_support(scene, light);
    return enough ? support : enough;
  }
  void setup() override {
    if (has_lists()) listed_->programs.setup(list_length);
    FittedMap::setup();
  }
  void build(const Scene& scene) override {
    FittedMap::build(scene);
    const std::vector<std::uint32_t> firsts = first_triangles(scene);
    listed_->meshes = has_lists() ? Buffer(firsts.data(), firsts.size() * sizeof firsts[0]) : Buffer();
  }
  Counts counts() const override {
    Counts counts = FittedMap::counts();
    if (!has_lists()) return counts;
    const ListTotals& totals = lists_.totals();
    for (Count& count : counts)
      if (count.name == "bytes")
        count.value += static_cast<double>(lists_.bytes()) + listed_.own(static_cast<double>(listed_->meshes.bytes));
    counts.push_back({"entries", static_cast<double>(totals.entries), ""});
    counts.push_back({"full_texels", static_cast<double>(totals.full_texels), "texel"});
    counts.push_back({"longest_list", static_cast<double>(totals.longest), "", Count::Together::largest});
    return counts;
  }
  std::vector<DebugLayer> debug_layers() const override {
    std::vector<DebugLayer> layers = FittedMap::debug_layers();
    layers.push_back(heat_debug_layer(std::string(length_layer),
                                      "Triangles in the list of each point's texel, and in red where the list is not whole, so "
                                      "that depth decides"));
    layers.back().legend.push_back({"not whole", negative_heat()});
    return layers;
  }
  std::vector<float> draw_debug(std::string_view layer) const override {
    return layer == length_layer ? heat_layer(gbuffer(), noted()) : FittedMap::draw_debug(layer);
  }
  std::unique_ptr<Technique> for_another_light() const override {
    return another(*this, &TriangleMap::made_, &TriangleMap::listed_);
  }

 private:
  bool has_lists() const { return list_length > 0; }
  /// Whether lists of one light fit on the device, and the triangles of the scene into what its shaders read.
  Support lists_support(const Scene& scene, const Light& light) const {
    const std::int64_t side = image_resolution(), images = looks_through_cube(light) ? 6 : 1, length = list_length;
    const std::int64_t bytes = 4 * side * side * images * length;
    if (bytes > most_entry_bytes)
      return Support::unsupported(
          fmt::format("lists of {} triangle{} for {} x {} x {} texels take {} MiB; {} MiB are the most that fit", length,
                      length == 1 ? "" : "s", images, side, side, bytes >> 20, most_entry_bytes >> 20));
    std::size_t vertices = 0, triangles = 0;
    for (const Mesh& mesh : scene.meshes) {
      vertices += mesh.positions.size();
      triangles += mesh.triangles.size();
    }
    const std::size_t block = std::max(vertices * sizeof(glm::vec3), triangles * sizeof(glm::uvec3));
    return within_limits({.fragment_storage_blocks = 3,
                          .compute_storage_blocks = mask_pass() == MaskPass::compute ? 3 : 1,
                          .storage_bindings = 3,
                          .storage_block_bytes = static_cast<std::int64_t>(block),
                          .work_group_size = 64,
                          .texture_layers = images * length});
  }

  std::string decision() const override {
    return has_lists() ? fmt::format("#define LIST_LENGTH {}\n{}{}", list_length.value(), segment_snippet, decision_snippet)
                       : std::string();
  }
  void images_drawn(const LightCamera& camera) override {
    if (has_lists())
      lists_.draw(camera, scene_buffers(*made_->scene), listed_->programs);
    else
      lists_.release();
  }
  void bind_decision(const Program& program, const Light& light, const GBuffer& gbuffer) const override {
    if (!has_lists()) return;
    const SceneBuffers& buffers = scene_buffers(*made_->scene);
    const GLuint blocks[] = {buffers.positions.name(), buffers.triangles.name(), listed_->meshes.name()};
    for (GLuint k = 0; k < std::size(blocks); ++k) glBindBufferBase(GL_SHADER_STORAGE_BUFFER, k, blocks[k]);
    lists_.bind(4);
    const double extent = made_->depth_images.boxes().extent;
    const int exponent = extent > 0 ? std::min(-std::ilogb(extent), 100) : 0;
    program.set_if_used("list_light", glm::vec4(homogeneous(light)));
    program.set_if_used("list_scale", static_cast<float>(std::exp2(exponent)));
    program.set_if_used("list_sees_shapes", static_cast<int>(gbuffer.truth == Truth::shape));
  }
  void explain_decision(float number, Explanation& why) const override {
    if (!has_lists()) return;
    if (number >= 0)
      why = {};
    else if (why.cause.empty())
      why.cause = list_full.id;
  }

  struct Listed {
    ListPrograms programs;
    Buffer meshes;  // of each the first triangle, and whether it stands for a curved shape; then how many triangles there are
  };
  Shared<Listed> listed_;
  TriangleLists lists_;  // of the images
};

}  // namespace

GNOMON_TECHNIQUE(triangle_map, TriangleMap, about)
