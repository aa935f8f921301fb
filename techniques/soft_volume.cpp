// Soft volumes: the places of a light that a point sees, from the silhouette edges before the light and one ray.
//
// Where an outline passes before the light, as the point sees it, the number of triangles before a place of the light jumps by
// a known number. So edges alone tell how deep in shadow each place is, up to one number for all of them. A ray to one of the
// least deep places finds that number: where it is blocked, all are; else the least deep ones are seen, and no other.
#include <gnomon/kit/parallel.h>
#include <gnomon/kit/pictures/layers.h>
#include <gnomon/kit/scratch_pool.h>
#include <gnomon/kit/shared.h>
#include <gnomon/registry.h>

#include <algorithm>
#include <cmath>
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
        "against exact spheres, cones and discs it errs by the tessellation.",
    .fails =
        "Nothing it supports. It is slow where many silhouette edges lie before the light: soups, leaves, and points close to "
        "finely tessellated casters under a large light."};

class SoftVolume final : public Technique {
 public:
  Number<int> samples{this, "samples", 64, {"place", 1, 4096, true}, Stage::resolve, "Places of the light that a point asks."};
  Choice pattern{this,
                 "pattern",
                 "low_discrepancy",
                 pattern_names(),
                 Stage::resolve,
                 "Where they are, as in area_rays: anywhere; one in each of as many cells; a sequence that fills the light "
                 "evenly; the same sequence, scrambled alike for every fourth pixel along x and y."};
  Number<int> seed{this, "seed", 1, {"", 0, 1000000}, Stage::resolve, "Other random numbers."};

  Support supports(const Scene&, const Light& light, const View&) const override {
    if (!has_area(light)) return Support::unsupported("the light has no area: its shadows are hard, see shadow_volume_tree");
    return Support::full();
  }
  void setup() override {}
  void build(const Scene& scene) override { *built_ = Casters(scene); }
  void relight(const Light& light) override;
  void resolve(const GBuffer& gbuffer, VisibilityMask& mask) override;
  Counts counts() const override;
  std::optional<Explanation> explain(std::size_t index) const override;
  std::unique_ptr<Technique> for_another_light() const override { return another(*this, &SoftVolume::built_); }
  std::vector<DebugLayer> debug_layers() const override {
    return {{"edges",
             "Silhouette edges that pass before the light, as each point sees them: none where the picture is left gray, else "
             "colors as in the legend.",
             heat_legend()}};
  }
  std::vector<float> draw_debug(std::string_view layer) const override;

 private:
  bool is_asked(const GBuffer& gbuffer, std::size_t i) const {
    return !gbuffer.is_background(i) && built_->scene().meshes[gbuffer.mesh[i]].receives;
  }
  NumberedReceiver receiver(const GBuffer& gbuffer, std::size_t i) const {
    return built_->numbers().numbered(receiver_at(built_->scene(), gbuffer, i));
  }
  Pattern pattern_of(const GBuffer& gbuffer, std::size_t i) const {
    const std::size_t x = i % gbuffer.width, y = i / gbuffer.width;
    return {pattern.value(), samples, places_seed(seed, pattern.is("interleaved") ? interleaved_set(x, y) : i)};
  }
  /// Decides a group of pixels: in halves while they look at many edges.
  void decide(const GBuffer& gbuffer, std::span<std::uint32_t> pixels, PointQuery& query, std::span<float> mask,
              Tally& tally) const;
  /// Asks for one pixel by itself: use(query, face).
  template <class Use>
  void ask(std::size_t index, const Use& use) const;

  Shared<Casters> built_;
  Light light_;
  PointQuery::Lamp lamp_;
  const GBuffer* gbuffer_ = nullptr;
  Tally tally_;
  mutable ScratchPool<PointQuery> pool_;
};

/// The box around a light's face and its places' box: of a round one any square around it. Wider by what rounding may have cut
/// off.
Bounds box_of(const Light& light) {
  glm::dvec3 center, half;
  if (const auto* rect = std::get_if<RectLight>(&light.kind)) {
    center = rect->center;
    half = glm::abs(glm::dvec3(rect->half_u)) + glm::abs(glm::dvec3(rect->half_v));
  } else if (const auto* disc = std::get_if<DiscLight>(&light.kind)) {
    center = disc->center;
    const glm::dvec3 n = glm::normalize(glm::dvec3(disc->normal));
    half = std::numbers::sqrt2 * disc->radius * glm::sqrt(glm::max(1.0 - n * n, 0.0));
  } else {
    const auto& sphere = std::get<SphereLight>(light.kind);
    center = sphere.center;
    half = glm::dvec3(std::numbers::sqrt2 * sphere.radius);
  }
  half += 0x1p-21 * (extent(center) + extent(half));
  Bounds box;
  box.add(glm::vec3(center - half));
  box.add(glm::vec3(center + half));
  return box;
}

void SoftVolume::relight(const Light& light) {
  light_ = light;
  lamp_.box = box_of(light);
  built_->find_triangles(lamp_.box, lamp_.crossing);
}

void SoftVolume::decide(const GBuffer& gbuffer, std::span<std::uint32_t> pixels, PointQuery& query, std::span<float> mask,
                        Tally& tally) const {
  constexpr std::size_t few_edges = 64;
  for_narrow_groups(
      gbuffer, pixels,
      [&](std::size_t level, const PixelGroup& group) {
        if (level == 0)
          query.start(*built_, lamp_, group);
        else
          query.narrow(level, group);
        return query.edge_count() > few_edges;
      },
      [&](const PixelGroup& group, std::span<const std::uint32_t> some) {
        query.get_ready(group.box);
        for (const std::uint32_t i : some) {
          const LightFigure face(light_, gbuffer.position(i), gbuffer.normal(i));
          if (face.is_seen())
            mask[i] = static_cast<float>(query.share(receiver(gbuffer, i), face, pattern_of(gbuffer, i), tally));
        }
      });
}

void SoftVolume::resolve(const GBuffer& gbuffer, VisibilityMask& mask) {
  gbuffer_ = &gbuffer;
  const std::span<float> out = mask.pixels();
  std::ranges::fill(out, 1.0f);
  std::vector<Tally> tallies(tile_count(gbuffer));
  for_pixel_groups(
      gbuffer, [&](std::size_t i) { return is_asked(gbuffer, i); }, [&] { return pool_.borrow(); },
      [&](std::span<std::uint32_t> pixels, std::size_t tile, PointQuery& query) {
        decide(gbuffer, pixels, query, out, tallies[tile]);
      });
  tally_ = {};
  for (const Tally& tally : tallies) tally_ += tally;
}

Counts SoftVolume::counts() const {
  const auto count = [](const char* name, std::uint64_t value) { return Count{name, static_cast<double>(value), ""}; };
  return {count("points", tally_.points),
          count("rays", tally_.rays),
          count("edges", tally_.edges),
          count("looked_at", tally_.looked),
          {"bytes", built_.own(static_cast<double>(built_->bytes())) + static_cast<double>(bytes_of(lamp_.crossing)), "byte"}};
}

template <class Use>
void SoftVolume::ask(std::size_t index, const Use& use) const {
  const GBuffer& gbuffer = *gbuffer_;
  if (!is_asked(gbuffer, index)) return;
  const LightFigure face(light_, gbuffer.position(index), gbuffer.normal(index));
  if (!face.is_seen()) return;
  const auto query = pool_.borrow();
  const auto pixel = static_cast<std::uint32_t>(index);
  const PixelGroup group = group_of(gbuffer, {&pixel, 1});
  query->start(*built_, lamp_, group);
  query->get_ready(group.box);
  Tally tally;
  query->share(receiver(gbuffer, index), face, pattern_of(gbuffer, index), tally);
  use(*query, face);
}

std::optional<Explanation> SoftVolume::explain(std::size_t index) const {
  Explanation why;
  ask(index, [&](PointQuery& query, const LightFigure& face) {
    query.find_all_places(face, pattern_of(*gbuffer_, index));
    for (std::uint32_t k = 0; k < query.place_count(); ++k)
      why.samples.push_back({glm::dvec3(gbuffer_->position(index)) + face.at(query.place(face, k)), 1.0 / query.place_count(),
                             query.is_seen(k) ? 1.0 : 0.0});
  });
  return why;
}

std::vector<float> SoftVolume::draw_debug(std::string_view layer) const {
  if (layer != "edges") return Technique::draw_debug(layer);
  std::vector<float> values(gbuffer_->size(), 0);
  for_blocks(values.size(), 256, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      ask(i, [&](const PointQuery& query, const LightFigure&) { values[i] = static_cast<float>(query.line_count()); });
  });
  return heat_layer(*gbuffer_, values);
}

}  // namespace

GNOMON_TECHNIQUE(soft_volume, SoftVolume, about)
