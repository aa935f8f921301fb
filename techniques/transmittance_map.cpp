// Transmittance map: for each texel of the light's image a curve, what part of the light glass leaves down to any depth.
#include <gnomon/kit/maps/glass_map.h>
#include <gnomon/kit/pictures/layers.h>
#include <gnomon/registry.h>

#include "transmittance_map/texel_curves.h"

namespace {
using namespace gnomon;
using transmittance_map::Keep;
using transmittance_map::TexelCurves;

constexpr About about{
    .title = "Transmittance map",
    .summary = "A curve for each texel of a depth image from the light: how much of it glass lets through, down to any depth.",
    .source = "Lokovic and Veach 2000 (keep=error, as functions of visibility); Salvi et al. 2010 (keep=nodes)",
    .error =
        "With keep=all none for the ray of a texel: only the image's resolution errs, as of a shadow map. With keep=error it is "
        "off by `tolerance` at most on that ray; keep=nodes has no bound, and errs by too much light alone. Lists are as long "
        "as the scene is deep: memory grows with it. At edges a texel may hold glass that the ray through its center misses: "
        "that is named curve.",
    .fails = "Smoke of many layers on a large image: a list for each texel.",
    .device = Device::opengl,
    .floor = Floor::depth_draw,
    .handles = with_gray_transmission,
    .causes = curve_causes,
    .named_only = true};

class TransmittanceMap final : public GlassMap {
  Choice keep =
      Choice(this, "keep", "all", {"all", "error", "nodes"}, Stage::relight,
             "Which nodes of a curve are kept. all: one for each surface. error: as few as a greedy walk of lines takes "
             "to stay within `tolerance`. nodes: so many as `nodes`, those that matter most for the area below it.");
  Number<double> tolerance =
      Number<double>(this, "tolerance", 0.02, {.unit = "", .min = 0.001, .max = 0.5, .log = true}, Stage::relight,
                     "How far the curve of a texel may be off, in shares of the light; for keep=error.");
  Number<int> nodes = Number<int>(this, "nodes", 8, {.unit = "", .min = 1, .max = 64, .log = true}, Stage::relight,
                                  "Most nodes of a curve; for keep=nodes.");

 public:
  Support supports(const Scene& scene, const Light& light, const View& view) const override {
    const Support support = GlassMap::supports(scene, light, view);
    if (!support || !scene.has_transmission()) return support;
    const std::int64_t side = image_resolution(), texels = side * side * (looks_through_cube(light) ? 6 : 1);
    const Support enough = within_limits({.storage_block_bytes = texels * 4});
    return enough ? support : enough;
  }
  std::unique_ptr<Technique> for_another_light() const override { return another(*this, &TransmittanceMap::made_); }

  std::vector<DebugLayer> debug_layers() const override {
    std::vector<DebugLayer> layers = GlassMap::debug_layers();
    layers.push_back(heat_debug_layer("nodes", "How many nodes the curve of the texel that holds the point has"));
    return layers;
  }
  std::vector<float> draw_debug(std::string_view layer) const override {
    if (layer != "nodes") return GlassMap::draw_debug(layer);
    const std::vector<std::uint32_t> ends = curves_.ends();
    return heat_of_texels([&](const glm::ivec3& texel) -> float {
      if (ends.empty()) return 0;
      const std::size_t i = index_of(texel);
      return static_cast<float>(ends[i] - (i > 0 ? ends[i - 1] : 0));
    });
  }

 private:
  Keep what_is_kept() const { return {Keep::Kind(keep.index()), tolerance, static_cast<std::uint32_t>(nodes.value())}; }
  std::size_t index_of(const glm::ivec3& texel) const {
    const auto side = static_cast<std::size_t>(image_resolution());
    return (texel.z * side + texel.y) * side + texel.x;
  }

  Method method() const override {
    return {.draw = std::string(TexelCurves::draw_snippet),
            .share = std::string(TexelCurves::share_snippet) + std::string(filtered_shares),
            .constants = "float curve_has_lines;",
            .constant_count = 1};
  }
  GlLimits glass_needs() const override { return TexelCurves::needs(); }
  void draw_glass(const GlassDrawing& glass) override { curves_.draw(glass, what_is_kept(), id()); }
  void bind_glass(const Program& look_up) const override {
    curves_.bind();
    look_up.set_if_used("curve_has_lines", what_is_kept().has_lines() ? 1.0f : 0.0f);
  }
  void release_glass() override { curves_.release(); }
  std::size_t glass_bytes() const override { return curves_.bytes(); }
  Counts more_counts() const override {
    return {{"surfaces", static_cast<double>(curves_.surface_count()), ""},
            {"nodes", static_cast<double>(curves_.node_count()), ""},
            {"longest_list", static_cast<double>(curves_.longest()), "", Count::Together::largest}};
  }

  TexelCurves curves_;
};

}  // namespace

GNOMON_TECHNIQUE(transmittance_map, TransmittanceMap, about)
