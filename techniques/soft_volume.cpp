// Soft volumes: the places of a light that a point sees, from the silhouette edges before the light and one ray.
//
// Where an outline passes before the light, as the point sees it, the number of triangles before a place of the light jumps by
// a known number. So edges alone determine how deep in shadow each place is, up to one number for all of them. A ray to one of
// the least deep places finds that number: where it is blocked, all are; else the least deep ones are seen, and no other.
#include <gnomon/kit/area/light_shape.h>
#include <gnomon/kit/bases/area_point_technique.h>
#include <gnomon/kit/bases/mask_setting.h>
#include <gnomon/kit/counts.h>
#include <gnomon/registry.h>

#include <numbers>

#include "soft_volume/point_query.h"

namespace {
using namespace gnomon;
using namespace gnomon::soft_volume;

constexpr About about{
    .title = "Soft volumes",
    .summary =
        "Silhouette edges, as each visible point sees them, tell how many triangles are before each of a number of places of "
        "the light; one ray tells which of them are seen.",
    .source = "Laine, Aila, Assarsson, Lehtinen and Akenine-Moeller 2005; Bergeron 1986 (open meshes).",
    .error =
        "That of as many shadow rays to the same places, see area_rays: noise, which falls with the number n of places as "
        "n^-0.5 where they are random and as about n^-0.75 where they are spread evenly. Each place is what exact signs say "
        "of the float32 points, but within double's rounding of an edge, or where a point is within 2^-48 of its coordinates "
        "of another caster's plane and counts as in it. It estimates the share of the light's area, and sees triangles: "
        "against exact spheres, cones and discs it errs by the tessellation. Edges of holes are rounded to float32 where masks "
        "are cut.",
    .fails =
        "Nothing it supports. It is slow where many silhouette edges lie before the light: soups, leaves, and points close to "
        "finely tessellated casters under a large light.",
    .handles = with_alpha_masks};

/// The box around a light and the box of its figures' places: of a round one any square around it. Wider by what rounding may
/// have cut off.
Bounds box_of(const LightShape& light) {
  glm::dvec3 half = glm::abs(light.half_u) + glm::abs(light.half_v);
  if (light.form == LightShape::Form::disc) {
    const glm::dvec3 n = light.front();
    half = std::numbers::sqrt2 * light.radius * glm::sqrt(glm::max(1.0 - n * n, 0.0));
  } else if (light.form == LightShape::Form::sphere) {
    half = glm::dvec3(std::numbers::sqrt2 * light.radius);
  }
  half += 0x1p-21 * (extent(light.center) + extent(half));
  Bounds box;
  box.add(glm::vec3(light.center - half));
  box.add(glm::vec3(light.center + half));
  return box;
}

class SoftVolume final : public AreaPointTechnique<Casters, PointQuery, Tally> {
 public:
  Number<int> samples{this, "samples", 64, {"place", 1, 4096, true}, Stage::resolve, "Places of the light that a point tests."};
  Choice pattern =
      Choice(this, "pattern", "low_discrepancy", pattern_names(), Stage::resolve,
             "Where they are, as in area_rays: anywhere; one in each of as many cells; a sequence that fills the light "
             "evenly; the same sequence, scrambled alike for every fourth pixel along x and y.");
  Number<int> seed{this, "seed", 1, {"", 0, 1000000}, Stage::resolve, "Other random numbers."};
  MaskSetting masks{this};

  Support supports(const Scene& scene, const Light& light, const View&) const override {
    if (!has_area(light)) return Support::unsupported("the light has no area: its shadows are hard, see shadow_volume_tree");
    return masks.limit(scene, Support::full());
  }
  void build(const Scene& scene) override { *built_ = Casters(masks.cut(scene)); }
  void relight(const Light& light) override {
    light_ = light;
    lamp_.box = box_of(LightShape(light));
    built_->find_in(
        lamp_.box, [](std::uint32_t) { return true; }, lamp_.crossing);
  }
  Counts counts() const override {
    return {
        count_of("points", tally_.points),
        count_of("rays", tally_.rays),
        count_of("edges", tally_.edges),
        count_of("looked_at", tally_.looked),
        {"bytes", built_.own(static_cast<double>(built_->bytes())) + static_cast<double>(bytes_of(lamp_.crossing)), "byte"}};
  }
  std::optional<Explanation> explain(std::size_t index) const override {
    Explanation why;
    query_pixel(index, [&](PointQuery& query, const LightFigure& figure) {
      query.find_all_places(figure, pattern_of(index));
      for (std::uint32_t k = 0; k < query.place_count(); ++k)
        why.samples.push_back({glm::dvec3(gbuffer_->position(index)) + figure.at(query.place(figure, k)),
                               1.0 / query.place_count(), query.is_seen(k) ? 1.0 : 0.0});
    });
    return why;
  }
  std::unique_ptr<Technique> for_another_light() const override { return another(*this, &SoftVolume::built_); }
  std::vector<DebugLayer> debug_layers() const override {
    return {heat_debug_layer("edges", "Silhouette edges that pass before the light, as each point sees them")};
  }
  std::vector<float> draw_debug(std::string_view layer) const override {
    if (layer != "edges") return Technique::draw_debug(layer);
    return heat_of([](const PointQuery& query) { return query.line_count(); });
  }

 private:
  bool gather(PointQuery& query, std::size_t level, const PixelGroup& points) const override {
    if (level == 0)
      query.start(*built_, lamp_, points);
    else
      query.narrow(level, points);
    constexpr std::size_t few_edges = 64;
    return query.edge_count() > few_edges;
  }
  void begin_shares(PointQuery& query, const PixelGroup& points) const override { query.get_ready(points.box); }
  double share(PointQuery& query, std::size_t pixel, const LightFigure& figure, Tally& tally) const override {
    return query.share(receiver(pixel), figure, pattern_of(pixel), tally);
  }
  Pattern pattern_of(std::size_t pixel) const {
    const std::size_t x = pixel % gbuffer_->width, y = pixel / gbuffer_->width;
    return {pattern.value(), samples, places_seed(seed, pattern.is("interleaved") ? interleaved_set(x, y) : pixel)};
  }

  PointQuery::Lamp lamp_;
};

}  // namespace

GNOMON_TECHNIQUE(soft_volume, SoftVolume, about)
