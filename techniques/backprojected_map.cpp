// Backprojected map: every texel of a depth image from the light's center is a patch of a caster, which is projected from the
// point onto the light; what the patches hide is added up.
#include <gnomon/kit/maps/area_map.h>
#include <gnomon/registry.h>

#include <cmath>

#include "backprojected_map/shader.h"

namespace {
using namespace gnomon;

constexpr About about{
    .title = "Backprojected shadow map",
    .summary = "Texels of a depth image from the light's center, each a patch that hides its part of the light, added up.",
    .source = "Guennebaud, Barthe and Paulin 2006 (patches, joints, search by the nearest depth of blocks)",
    .error =
        "Patches that overlap count twice, and what is hidden by both is too dark. A disc counts as the square with its "
        "area: a straight edge before it is off by up to 2.3 %. It estimates the share of the light's area. "
        "Holes are those of the mask with alpha=texel alone: mips and mips_kept filter alpha, and hashed is random "
        "where alpha is neither 0 nor 1. A texel holds no product: glass is taken for opaque or left out.",
    .fails =
        "Casters behind one another, of which the image holds the nearest; casters that the center sees from the side; "
        "penumbrae wider than most_radius.",
    .device = Device::opengl,
    .floor = Floor::depth_draw,
    .handles = with_gray_transmission,
    .causes = map_causes};

class BackprojectedMap final : public AreaMap {
  Choice joints = Choice(this, "joints", "snapped", {"none", "extended", "snapped"}, Stage::setup,
                         "Patches side by side that both hide the light: left as they are; the gap between them filled; or "
                         "the one's edge put on the other's, also where they overlap.");

 public:
  BackprojectedMap() : AreaMap({.resolution = 512, .most_radius = 32}) {}
  Support supports(const Scene& scene, const Light& light, const View& view) const override {
    const Support support = AreaMap::supports(scene, light, view);
    if (!support || LightShape(light).form == LightShape::Form::rectangle) return support;
    const char* const why = "a square of the same area stands for a disc, and for what is seen of a sphere";
    return glass.limit(scene, Support::approximate(why));
  }
  std::unique_ptr<Technique> for_another_light() const override { return another(*this, &BackprojectedMap::made_); }

 private:
  std::string body() const override { return fmt::format("#define JOINTS {}\n{}", joints.index(), backprojected_map::body); }
};

}  // namespace

GNOMON_TECHNIQUE(backprojected_map, BackprojectedMap, about)
