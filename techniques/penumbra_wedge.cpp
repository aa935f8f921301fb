// Penumbra wedges: the hard shadow of a light's center, and from every edge of the outline that the center sees, what it adds
// to that shadow or takes from it in the wedge of points that see the edge before the light.
//
// Published is a rasterizer's two passes, one for the hard shadow and one for wedges, which meet in a visibility buffer. Here
// both are computed at every visible point, so that the sum is of one outline in closed form, with nothing lost to pixels.
#include <gnomon/kit/bases/area_point_technique.h>
#include <gnomon/kit/bases/mask_setting.h>
#include <gnomon/kit/counts.h>
#include <gnomon/kit/pictures/lines.h>
#include <gnomon/registry.h>

#include <algorithm>

#include "penumbra_wedge/point_query.h"

namespace {
using namespace gnomon;
using namespace gnomon::penumbra_wedge;

constexpr OwnCause causes[] = {
    {"overlapping_penumbrae",
     "Penumbrae of several outlines were added up although they hide the same part of the light.",
     {192, 72, 152}},
    {"one_outline", "The outline seen from the light's center was used for every point of the light.", {32, 144, 255}},
};

constexpr About about{
    .title = "Penumbra wedges",
    .summary =
        "The hard shadow of the light's center, to which every silhouette edge adds or from which it takes its part of the "
        "light in the wedge of points that see it before the light.",
    .source = "Assarsson and Akenine-Moeller 2003 (penumbra wedges); Bergeron 1986 (open meshes)",
    .error =
        "One convex polygon with all of the light on one side of its plane: rounding of double, since the part of each edge is "
        "closed form, for rectangles and round lights alike. Outlines that overlap before the light hide their common part as "
        "often as there are outlines: too dark, by up to that part. A body hides what the outline that the light's center sees "
        "of it hides, which tends to the truth as the light shrinks. It estimates the share of the light's area, and sees "
        "triangles.",
    .fails =
        "Leaves, soups and fences under large lights, whose penumbrae overlap. Bodies close to a large light, of which other "
        "places see sides that the center does not: the floor before a box gets no penumbra from places behind a front that "
        "the center sees. A caster across the light ends in its plane, and what it hides of places that see its other side "
        "than the center counts as lit.",
    .handles = with_alpha_masks,
    .causes = causes};

class PenumbraWedge final : public AreaPointTechnique<Casters, PointQuery, Tally> {
 public:
  MaskSetting masks{this};

  Support supports(const Scene& scene, const Light& light, const View&) const override {
    if (!has_area(light)) return Support::unsupported("the light has no area: its shadows are hard, see stencil_volume");
    return masks.limit(scene,
                       Support::approximate("the outline from the light's center stands for all of it, and penumbrae add up"));
  }
  void build(const Scene& scene) override { *built_ = Casters(masks.cut(scene)); }
  void relight(const Light& light) override {
    light_ = light;
    outline_.hull = hull_of(light);
    built_->adjacency().find_silhouette(homogeneous_of_center(light), outline_.silhouette);
    outline_.wedges.make(built_->adjacency(), outline_.silhouette, outline_.hull, built_->extent());
    const auto is_part = [&](std::uint32_t triangle) { return outline_.silhouette.facing[triangle] != 0; };
    built_->find_in(outline_.hull.box, is_part, outline_.crossing);
  }
  void resolve(const GBuffer& gbuffer, VisibilityMask& mask) override {
    AreaPointTechnique::resolve(gbuffer, mask);
    answer_.assign(mask.pixels().begin(), mask.pixels().end());
  }
  Counts counts() const override {
    return {count_of("silhouette_edges", outline_.silhouette.edges.size()),
            count_of("crossing_triangles", outline_.crossing.size()),
            count_of("points", tally_.points),
            count_of("rays", tally_.rays),
            count_of("wedge_tests", tally_.tests),
            count_of("contributions", tally_.contributions),
            mean_of("contributions_per_point", tally_.contributions, tally_.points),
            {"bytes",
             built_.own(static_cast<double>(built_->bytes())) +
                 static_cast<double>(outline_.silhouette.bytes() + outline_.wedges.bytes() +
                                     bytes_of(outline_.crossing, outline_.hull.corners, answer_)),
             "byte"}};
  }
  // Where no place has more than one layer, adding up is not what is wrong, and there is only the outline left.
  std::optional<Explanation> explain(std::size_t index) const override {
    Explanation why;
    query_pixel(index, [&](PointQuery& query, const LightFigure& figure) {
      constexpr int side = 16;
      int seen = 0, asked = 0, layers = 0;
      for (int k = 0; k < side * side; ++k) {
        const glm::dvec2 square((k % side + 0.5) / side, (k / side + 0.5) / side);
        const glm::dvec2 place = figure.box().at(square);
        if (!figure.holds(place)) continue;
        ++asked;
        const int there = query.layers_at(place);
        seen += there <= 0;
        layers += there;
      }
      if (asked == 0) return;
      const double united = static_cast<double>(seen) / asked,
                   summed = std::clamp(1 - static_cast<double>(layers) / asked, 0.0, 1.0);
      why.cause = causes[std::abs(united - summed) > 1.0 / 128 ? 0 : 1].id;
    });
    return why;
  }
  std::unique_ptr<Technique> for_another_light() const override { return another(*this, &PenumbraWedge::built_); }
  std::vector<DebugLayer> debug_layers() const override {
    return {heat_debug_layer("wedges", "Penumbra wedges that hold each point"), silhouette_layer()};
  }
  std::vector<float> draw_debug(std::string_view layer) const override {
    if (layer == "silhouette") {
      std::vector<float> picture = shaded_layer(built_->scene(), *gbuffer_, light_, answer_);
      draw_lines(silhouette_lines(built_->adjacency(), outline_.silhouette), *gbuffer_, picture);
      return picture;
    }
    if (layer != "wedges") return Technique::draw_debug(layer);
    return heat_of([](const PointQuery& query) { return query.holding_count(); });
  }

 private:
  bool gather(PointQuery& query, std::size_t level, const PixelGroup& points) const override {
    if (level == 0)
      query.start(*built_, outline_, points);
    else
      query.narrow(level, points);
    constexpr std::size_t few_wedges = 16;
    return query.wedge_count() > few_wedges;
  }
  double share(PointQuery& query, std::size_t pixel, const LightFigure& figure, Tally& tally) const override {
    return query.share(receiver(pixel), figure, tally);
  }

  Outline outline_;
  std::vector<float> answer_;
};

}  // namespace

GNOMON_TECHNIQUE(penumbra_wedge, PenumbraWedge, about)
