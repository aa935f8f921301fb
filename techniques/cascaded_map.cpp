// Cascaded shadow map: the picture is divided by depth, and each slice has a depth image of its own.
//
// Images depend on the view: each resolve divides, fits, draws and looks up, and pays for all of it. A point is looked up in
// the image of its slice. Where two meet the texels' width jumps. With `blend`, the far part of a slice is looked up in the
// next one, too, and the share of that answer grows from 0 to 1 at the slice's end: the jump becomes a ramp.
//
// Defaults: of the settings within 3 % of the lowest mean wrong rate in suite map_defaults (results/map_defaults) the one with
// the bias of warped_map and the lowest wrong rate in two of the three views `low`.
//
// placement=fitted is as tight as images can be: each contains the rectangle of what its slice shows that faces the light, and
// slices divide the range of depths that is seen. placement=stable is less sharp and does not crawl: the size of an image
// depends on its slice alone, and its place goes in steps of a texel, so edges stay the same while the eye moves.
#include <gnomon/kit/geometry/camera.h>
#include <gnomon/kit/maps/compared_map.h>
#include <gnomon/registry.h>

#include "cascaded_map/blend.h"
#include "cascaded_map/slices.h"

namespace {
using namespace gnomon;

constexpr About about{
    .title = "Cascaded shadow map",
    .summary = "The picture is divided by depth into slices, each with a depth image of its own.",
    .source =
        "Zhang, Sun, Xu and Lun 2006 (splits); Engel 2006; Valient 2008 (stable); Lauritzen, Salvi and Lefohn 2010 (fitted to "
        "what is seen)",
    .error =
        "As a shadow map's, with texels that grow with the distance from the eye: stair steps of about the same width in the "
        "picture. Jumps of the texels' width where slices meet, which blend makes ramps. "
        "Holes are those of the mask with alpha=texel alone: mips and mips_kept filter alpha, and hashed is random "
        "where alpha is neither 0 nor 1. A texel holds no product: glass is taken for opaque or left out.",
    .fails =
        "A light that shines along the view: the slices see the same stretch of the light's picture. One receiver near the "
        "eye and none between it and the horizon.",
    .device = Device::opengl,
    .floor = Floor::depth_draw,
    .handles = with_gray_transmission,
    .causes = map_causes};

class CascadedMap final : public ComparedMap {
  Number<int> cascades{this, "cascades", 4, {.min = 1, .max = ViewSlices::most}, Stage::resolve, "How many slices."};
  Number<double> logarithmic =
      Number<double>(this, "logarithmic", 0.5, {.min = 0, .max = 1}, Stage::resolve,
                     "How slices divide depth: 0 into equal lengths, 1 into equal ratios, between them a mean.");
  Choice placement = Choice(this, "placement", "fitted", {"fitted", "stable"}, Stage::resolve,
                            "Images hold what their slice shows, or the sphere around the slice, moved by whole texels.");
  Number<double> blend =
      Number<double>(this, "blend", 0, {.min = 0, .max = 1}, Stage::setup,
                     "Over which share of a slice's depth, before its end, the next slice's answer is blended in.");

 public:
  CascadedMap() : ComparedMap({.bias = "receiver_plane", .depth_bias = 2, .slope_bias = 1}) {}
  Support supports(const Scene& scene, const Light& light, const View& view) const override {
    if (placement.is("stable") && std::holds_alternative<SpotLight>(light.kind))
      return Support::unsupported("images that stand still while the eye moves need parallel rays; placement=fitted does not");
    return ComparedMap::supports(scene, light, view);
  }
  std::unique_ptr<Technique> for_another_light() const override { return another(*this, &CascadedMap::made_); }

 private:
  std::optional<LightCamera> fitted_to_scene(const Light&, const MeshBoxes&, int) const override { return std::nullopt; }
  LightCamera fitted_to_view(const Light& light, const MeshBoxes& boxes, const GBuffer& gbuffer, int margin) const override {
    using namespace cascaded_map;
    const View& view = gbuffer.view;
    ViewSlices slices{.eye = view.eye, .axis = glm::normalize(glm::dvec3(view.target) - glm::dvec3(view.eye))};
    const std::vector<glm::dvec3> points = points_facing(light, boxes, gbuffer);
    DepthRange range = depths_of(points, slices);
    const bool is_stable = placement.is("stable");
    // All that is seen may have one depth, or none at all may face the light.
    if (!(range.near < range.far)) range = range.near == range.far ? DepthRange{range.near * 0.5, range.far} : DepthRange{1, 2};
    if (is_stable) range = quantized(range);
    slices.ends = practical_splits(range, cascades, logarithmic);
    if (looks_twice())
      for (const double length : lengths_of(range, slices.ends)) slices.overlaps.push_back(blend * length);

    const LightSpace still = light_space_of(light, boxes);
    const double coordinates = std::max(boxes.extent, extent(slices.eye));
    const bool is_around_eye = needs_eye(still, coordinates, range);
    const LightSpace space = is_around_eye ? around_eye(still, slices.eye) : still;
    const double up = std::tan(glm::radians(double(view.fov_y_degrees)) / 2),
                 tangent = up * std::hypot(1, double(gbuffer.width) / gbuffer.height);
    std::vector<LightExtent> seen;
    if (is_stable) {
      for (int i = 0; i < cascades; ++i) {
        const double near = i == 0 ? range.near : slices.ends[i - 1] - slices.overlap(i - 1);
        const SliceSphere sphere =
            sphere_around(slices.eye, slices.axis, tangent, {near, i == cascades - 1 ? range.far : slices.ends[i]});
        const LightExtent window = stable_window(still.main(), sphere, image_resolution() - 2 * margin);
        seen.push_back(is_around_eye ? less(window, still.main().seen(slices.eye)) : window);
      }
    } else {
      // Of a depth that a shader computes in float32: from products and sums of coordinates as large as these.
      seen = seen_in_slices(points, space.main(), slices, 0x1p-20 * coordinates + 0x1p-18 * range.far);
    }
    LightCamera camera =
        fit_to_extents(light, space, boxes, seen, image_resolution(), margin, is_stable ? FitWindow::whole : FitWindow::shared);
    if (is_around_eye) {
      camera.shift = view.eye;
      camera.rounding = rounding_around_eye(camera, boxes, slices, range.far, tangent);
    }
    camera.slices = slices;
    return camera;
  }
  LightImages images() const override { return LightImages::slices; }
  bool looks_twice() const override { return blend > 0; }
  std::string decision() const override { return looks_twice() ? std::string(cascaded_map::blend_snippet) : std::string(); }
  void bind_decision(const Program& program, const Light&, const GBuffer&) const override {
    if (!looks_twice()) return;
    glm::vec3 overlaps(0);
    for (std::size_t i = 0; i < camera().slices.overlaps.size(); ++i)
      overlaps[static_cast<int>(i)] = static_cast<float>(camera().slices.overlaps[i]);
    program.set_if_used("overlaps", overlaps);
  }
};

}  // namespace

GNOMON_TECHNIQUE(cascaded_map, CascadedMap, about)
