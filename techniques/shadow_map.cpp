// Shadow map: one depth image from the light (six around a point light), compared once or a few times per visible point.
//
// The faces of a cube are layers of one array, drawn one by one: only faces with casters and receivers are allocated, each is
// fitted and culls meshes for itself, and a 3 x 2 atlas of the largest faces would exceed the largest texture (16384).
#include <gnomon/kit/maps/fitted_map.h>
#include <gnomon/registry.h>

namespace {
using namespace gnomon;

constexpr About about{
    .title = "Shadow map",
    .summary = "One depth image from the light, compared once per visible point.",
    .source =
        "Williams 1978; Reeves, Salesin and Cook 1987 (filter); Woo 1992, Wang and Molnar 1994, Weiskopf and Ertl 2003 "
        "(stored); Isidoro 2006, Dou et al. 2014, Ehm et al. 2015, Fatnassi 2023 (bias)",
    .error =
        "Stair steps of one texel diagonal along every shadow edge; acne where the bias is less than the depth spread of a "
        "texel, peter-panning where a caster is nearer than the bias. bias=adaptive has no acne on flat "
        "receivers, nor has receiver_plane at depth_bias 0. "
        "Holes are those of the mask with alpha=texel alone: mips and mips_kept filter alpha, and hashed is random "
        "where alpha is neither 0 nor 1. A texel holds no product: glass is taken for opaque or left out.",
    .fails = "A long shadow at a grazing angle, a fine mesh of wires, and every large scene: texels are spread over all of it.",
    .device = Device::opengl,
    .floor = Floor::depth_draw,
    .is_default = true,
    .handles = with_gray_transmission,
    .causes = map_causes};

class ShadowMap final : public FittedMap {
  Choice stored = Choice(this, "stored", "first", {"first", "second", "midpoint", "dual"}, Stage::setup,
                         "What a texel holds: the first surface seen from the light, the second, the mean of both (the far "
                         "plane where there is no second), or that mean, but no more than dual_offset behind the first.");
  Number<double> dual_offset =
      Number<double>(this, "dual_offset", 2, {.unit = "texel", .min = 0, .max = 64}, Stage::relight,
                     "How far behind the first surface, at most, in widths of a texel there; for stored=dual.");

 public:
  std::unique_ptr<Technique> for_another_light() const override { return another(*this, &ShadowMap::made_); }

 private:
  StoredDepth stored_depth() const override { return {StoredDepth::Kind(stored.index()), dual_offset}; }
};

}  // namespace

GNOMON_TECHNIQUE(shadow_map, ShadowMap, about)
