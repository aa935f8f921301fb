// Penumbra wedges: the hard shadow of a light's center, and from every edge of the outline that the center sees, what it adds
// to that shadow or takes from it in the wedge of points that see the edge before the light.
//
// Published is a rasterizer's two passes, one for the hard shadow and one for wedges, which meet in a visibility buffer. Here
// both are asked at every visible point, so that the sum is of one outline in closed form, with nothing lost to pixels.
#include <gnomon/kit/bases/point_technique.h>
#include <gnomon/kit/pictures/lines.h>
#include <gnomon/kit/scratch_pool.h>
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
    .causes = causes};

class PenumbraWedge final : public Technique {
 public:
  Support supports(const Scene&, const Light& light, const View&) const override {
    if (!has_area(light)) return Support::unsupported("the light has no area: its shadows are hard, see stencil_volume");
    return Support::approximate("the outline from the light's center stands for all of it, and penumbrae add up");
  }
  void setup() override {}
  void build(const Scene& scene) override { *built_ = Casters(scene); }
  void relight(const Light& light) override;
  void resolve(const GBuffer& gbuffer, VisibilityMask& mask) override;
  Counts counts() const override;
  std::optional<Explanation> explain(std::size_t index) const override;
  std::unique_ptr<Technique> for_another_light() const override { return another(*this, &PenumbraWedge::built_); }
  std::vector<DebugLayer> debug_layers() const override {
    return {heat_debug_layer("wedges", "Penumbra wedges that hold each point"), silhouette_layer()};
  }
  std::vector<float> draw_debug(std::string_view layer) const override;

 private:
  bool is_asked(const GBuffer& gbuffer, std::size_t i) const {
    return !gbuffer.is_background(i) && built_->scene().meshes[gbuffer.mesh[i]].receives;
  }
  NumberedReceiver receiver(const GBuffer& gbuffer, std::size_t i) const {
    return built_->numbers().numbered(receiver_at(built_->scene(), gbuffer, i));
  }
  /// Decides a group of pixels: in halves while many wedges hold some of them.
  void decide(const GBuffer& gbuffer, std::span<std::uint32_t> pixels, PointQuery& query, std::span<float> mask,
              Tally& tally) const;
  /// Asks for one pixel by itself: use(query, face).
  template <class Use>
  void ask(std::size_t index, const Use& use) const;

  Shared<Casters> built_;
  Light light_;
  Outline outline_;
  const GBuffer* gbuffer_ = nullptr;
  std::vector<float> answer_;
  Tally tally_;
  mutable ScratchPool<PointQuery> pool_;
};

void PenumbraWedge::relight(const Light& light) {
  light_ = light;
  outline_.hull = hull_of(light);
  built_->adjacency().find_silhouette(homogeneous_of_center(light), outline_.silhouette);
  outline_.wedges.make(built_->adjacency(), outline_.silhouette, outline_.hull, built_->extent());
  built_->find_triangles(outline_.silhouette, outline_.hull.box, outline_.crossing);
}

void PenumbraWedge::decide(const GBuffer& gbuffer, std::span<std::uint32_t> pixels, PointQuery& query, std::span<float> mask,
                           Tally& tally) const {
  constexpr std::size_t few_wedges = 16;
  for_narrow_groups(
      gbuffer, pixels,
      [&](std::size_t level, const PixelGroup& group) {
        if (level == 0)
          query.start(*built_, outline_, group);
        else
          query.narrow(level, group);
        return query.wedge_count() > few_wedges;
      },
      [&](const PixelGroup&, std::span<const std::uint32_t> some) {
        for (const std::uint32_t i : some) {
          const LightFigure face(light_, gbuffer.position(i), gbuffer.normal(i));
          if (face.is_seen()) mask[i] = static_cast<float>(query.share(receiver(gbuffer, i), face, tally));
        }
      });
}

void PenumbraWedge::resolve(const GBuffer& gbuffer, VisibilityMask& mask) {
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
  answer_.assign(out.begin(), out.end());
}

Counts PenumbraWedge::counts() const {
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

template <class Use>
void PenumbraWedge::ask(std::size_t index, const Use& use) const {
  const GBuffer& gbuffer = *gbuffer_;
  if (!is_asked(gbuffer, index)) return;
  const LightFigure face(light_, gbuffer.position(index), gbuffer.normal(index));
  if (!face.is_seen()) return;
  const auto query = pool_.borrow();
  const auto pixel = static_cast<std::uint32_t>(index);
  const PixelGroup group = group_of(gbuffer, {&pixel, 1});
  query->start(*built_, outline_, group);
  Tally tally;
  query->share(receiver(gbuffer, index), face, tally);
  use(*query, face);
}

// Where no place has more than one layer, adding up is not what is wrong, and there is only the outline left.
std::optional<Explanation> PenumbraWedge::explain(std::size_t index) const {
  Explanation why;
  ask(index, [&](PointQuery& query, const LightFigure& face) {
    constexpr int side = 16;
    int seen = 0, asked = 0, layers = 0;
    for (int k = 0; k < side * side; ++k) {
      const glm::dvec2 square((k % side + 0.5) / side, (k / side + 0.5) / side);
      const glm::dvec2 place = face.box().low + square * (face.box().high - face.box().low);
      if (!face.holds(place)) continue;
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

std::vector<float> PenumbraWedge::draw_debug(std::string_view layer) const {
  if (layer == "silhouette") {
    std::vector<float> picture = shaded_layer(built_->scene(), *gbuffer_, light_, answer_);
    draw_lines(silhouette_lines(built_->adjacency(), outline_.silhouette), *gbuffer_, picture);
    return picture;
  }
  if (layer != "wedges") return Technique::draw_debug(layer);
  std::vector<float> values(gbuffer_->size(), 0);
  for_blocks(values.size(), 256, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      ask(i, [&](const PointQuery& query, const LightFigure&) { values[i] = static_cast<float>(query.holding_count()); });
  });
  return heat_layer(*gbuffer_, values);
}

}  // namespace

GNOMON_TECHNIQUE(penumbra_wedge, PenumbraWedge, about)
