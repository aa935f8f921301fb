// Two-pass object precision: hidden surfaces are removed from the light's side, in object precision. What is left of each
// triangle is lit and stays attached to it as surface detail; a visible point is looked up there.
//
// The source clips concave polygons with holes by one another, front to back, in the image space of one perspective. Here
// pieces are convex and cut by planes in world space: a triangle loses what lies inside the three planes through the light and
// a caster's edges and beyond the caster, whatever the order. So shared edges, corners on edges, cycles and triangles through
// each other need no case of their own, and since the planes bound a cone on its own side only, what lies behind the light
// stays out. Candidates come from a grid in light space. What lies beyond casters that cover its cell, or all of its places
// there, is in shadow and is not clipped at all.
#include <gnomon/kit/bases/mask_setting.h>
#include <gnomon/kit/bases/point_technique.h>
#include <gnomon/kit/pictures/surface_detail.h>
#include <gnomon/registry.h>

#include "two_pass_object/detail.h"

namespace {
using namespace gnomon;
using namespace gnomon::two_pass_object;

constexpr About about{
    .title = "Two-pass object precision",
    .summary =
        "Each triangle loses what nearer ones hide from the light; visible points are looked up in the convex lit pieces.",
    .source = "Atherton, Weiler and Greenberg 1978",
    .error =
        "None on the float32 points it is given: pieces are in double, and points within rounding of a piece's border or of "
        "their triangle's, and casters within rounding of their receiver's plane, are decided one by one by exact signs. A "
        "way to the light through an edge or a vertex is blocked. Tessellation on curved shapes, whose points are all "
        "decided one by one. Edges of holes are rounded to float32 where masks are cut.",
    .fails =
        "Nothing it supports. Fragments multiply where layer lies on layer of large triangles; many triangles that stand "
        "edge to the light, or share one line of sight, crowd a cell that no grid can thin out, and pairs there are "
        "quadratic.",
    .promise = Promise::exact,
    .handles = with_alpha_masks};

class TwoPassObject final : public PointTechnique {
 public:
  Number<double> cell_triangles =
      Number<double>(this, "cell_triangles", 24, {.unit = "triangles", .min = 2, .max = 256, .log = true}, Stage::relight,
                     "About how many triangles a cell of the light-space grid holds; it never changes the answer.");
  Flag merge{this, "merge", true, Stage::relight,
             "Surface detail of a triangle that is lit, or in shadow, throughout is one polygon; the mask does not need it."};
  MaskSetting masks{this};

  Support supports(const Scene& scene, const Light& light, const View& view) const override {
    return masks.limit(scene, PointTechnique::supports(scene, light, view));
  }
  void build(const Scene& scene) override {
    map_.clear();
    is_lit_up_ = false;
    triangles_.build(masks.cut(scene));
    remember(triangles_.scene());
  }
  void update(const Scene& scene, const Changes& changes) override {
    if (!triangles_.follow(changes)) return build(scene);
    map_.clear();
    is_lit_up_ = false;
  }
  void relight(const Light& light) override {
    light_ = light;
    triangles_.relight(homogeneous(light));
    map_.make(triangles_, cell_triangles);
    merges_ = merge;
    is_lit_up_ = true;
  }
  void resolve(const GBuffer& gbuffer, VisibilityMask& mask) override {
    gbuffer_ = &gbuffer;
    const std::span<float> pixels = mask.pixels();
    std::ranges::fill(pixels, 1.0f);
    work_ = for_facing_pixels(gbuffer, PointWork(), [&](std::size_t i, PointWork& work) {
      if (!map_.is_lit(triangles_, receiver(gbuffer, i), work)) pixels[i] = 0;
    });
  }

  Counts counts() const override {
    const Work& work = map_.work();
    std::size_t polygons = 0;
    for (std::uint32_t i = 0; i < triangles_.size(); ++i) polygons += triangles_.takes_part(i);
    return {count_of("cells", work.cells),
            count_of("pairs_tested", work.pairs_tested),
            count_of("pairs_clipped", work.pairs_clipped),
            count_of("pairs_near", work.near),
            count_of("splits", work.splits),
            count_of("lit_pieces", work.lit),
            count_of("shadowed_pieces", work.shadowed),
            count_of("hidden", work.hidden),
            mean_of("fragments_per_polygon", work.lit + work.shadowed, polygons),
            count_of("point_locations", work_.points),
            count_of("points_asked", work_.exact),
            {"bytes", static_cast<double>(triangles_.bytes() + map_.bytes()), "byte"}};
  }

  std::optional<SurfaceDetail> surface_detail() const override {
    return is_lit_up_ ? make_detail(*remembered_->scene, triangles_, map_, merges_) : SurfaceDetail{};
  }
  std::vector<DebugLayer> debug_layers() const override {
    std::vector<DebugLayer> layers = detail_layers();
    const auto clips = heat_debug_layer("clips", "Casters that took a part away from each point's triangle in its cell");
    layers.insert(layers.end(), {splits_layer(), clips});
    return layers;
  }
  std::vector<float> draw_debug(std::string_view layer) const override {
    if (layer == "fragments")
      return paint_detail(*remembered_->scene, *gbuffer_, light_, make_detail(*remembered_->scene, triangles_, map_, merges_));
    if (layer == "splits")
      return paint_splits(*remembered_->scene, *gbuffer_, light_, make_detail(*remembered_->scene, triangles_, map_, false));
    if (layer == "clips") return heat_of([&](std::size_t i) { return map_.clips_at(triangles_, receiver(*gbuffer_, i)); });
    return Technique::draw_debug(layer);
  }

  std::unique_ptr<Technique> for_another_light() const override {
    return another(*this, &TwoPassObject::remembered_, &TwoPassObject::triangles_);
  }

 private:
  const char* why_no_area() const override { return "surfaces are hidden from one point of the light: it has no area"; }
  std::uint32_t shading_triangle(std::size_t index) const override {
    const std::uint32_t shading = map_.shading(triangles_, receiver(*gbuffer_, index));
    return shading == LightMap::none ? nothing : triangles_.source(shading);
  }

  bool is_lit_up_ = false, merges_ = true;
  Triangles triangles_;
  LightMap map_;
  PointWork work_;
};

}  // namespace

GNOMON_TECHNIQUE(two_pass_object, TwoPassObject, about)
