// Umbra and penumbra trees: every receiving polygon is divided into fragments that see all of a light with area, a part of it,
// or nothing; in the penumbra the part is what clipping the light by the polygons of that fragment leaves.
//
// A polygon that casts has a penumbra volume, in which it hides something of the light, and in it an umbra volume, in which it
// hides all. Both are convex, and bounded by planes through an edge of the one and a corner of the other, light or polygon. The
// fragments of a receiver are the cells of a tree of such planes, grown on the receiver alone: no order of polygons is needed,
// and what no receiver crosses is never cut.
#include <gnomon/kit/bases/mask_setting.h>
#include <gnomon/kit/counts.h>
#include <gnomon/kit/parallel.h>
#include <gnomon/kit/pictures/layers.h>
#include <gnomon/kit/pictures/surface_detail.h>
#include <gnomon/kit/shared.h>
#include <gnomon/registry.h>

#include "area_svbsp/detail.h"
#include "area_svbsp/trees.h"

namespace {
using namespace gnomon;
using namespace gnomon::area_svbsp;

constexpr OwnCause causes[] = {
    {"corners_only", "The light was computed at the corners of the fragment and interpolated between them.", {20, 255, 148}},
};

constexpr About about{
    .title = "Umbra and penumbra trees",
    .summary =
        "Polygons divided into fragments that see all of a light with area, a part or nothing; in the penumbra the light is "
        "clipped by the few polygons that matter there.",
    .source = "Chin and Feiner 1992; the light divided where it pays as in Wong and Tsang 1998",
    .error =
        "None but rounding of double with shade=pixels, as for exact_area. With shade=vertices what is linear between the "
        "corners of a fragment, which falls with its size. It estimates the share of the light's area, and sees triangles. "
        "Edges of holes are rounded to float32 where masks are cut.",
    .fails =
        "Fine meshes: the umbra of a triangle smaller than the light is nothing, so all of their shadow is penumbra. Lights as "
        "large as the scene: everything is in the penumbra of everything.",
    .promise = Promise::exact,
    .handles = with_alpha_masks,
    .causes = causes};

/// Triangles that cast: beyond, trees take minutes.
constexpr std::size_t most_triangles = 200'000;
/// Triangles before the light, from a point on average: beyond, a picture takes minutes.
constexpr double most_before = 100;

class AreaSvbsp final : public Technique {
  Choice shade = Choice(this, "shade", "pixels", {"pixels", "vertices"}, Stage::relight,
                        "Where the light is clipped: from every point of the penumbra, in resolve; or from the corners of its "
                        "fragments, in relight, with linear interpolation between them, as published.");
  Number<double> fragment_size =
      Number<double>(this, "fragment_size", 1, {.min = 0.001, .max = 1, .log = true}, Stage::relight,
                     "Greatest length of a fragment of the penumbra, as a multiple of the scene's diagonal: longer ones "
                     "are halved; for shade=vertices.");
  Number<int> light_splits =
      Number<int>(this, "light_splits", 2, {.min = 0, .max = 8}, Stage::relight,
                  "Halvings of the light, one within the other, where nothing is seen of it past several polygons: what "
                  "hides every part of it is umbra, too. 0: umbra is that of single polygons. Not under spheres.");
  Number<double> least_width =
      Number<double>(this, "least_width", 0.001, {.min = 0.00001, .max = 0.1, .log = true}, Stage::relight,
                     "Width of the narrowest fragments that are divided, as a multiple of the scene's diagonal; "
                     "what is left whole counts as penumbra.");
  Number<int> work =
      Number<int>(this, "work", 64, {.unit = "million tests", .min = 1, .max = 4096, .log = true}, Stage::relight,
                  "Tests of fragments against volumes; when a polygon has spent its share the rest of it is left whole.");
  MaskSetting masks{this};

 public:
  Support supports(const Scene& original, const Light& light, const View&) const override {
    if (!has_area(light)) return Support::unsupported("the light has no area: see svbsp");
    if (const Support limit = masks.limit(original, Support::full()); !limit) return limit;
    const CutMasks cut = masks.cut(original);
    const Scene& scene = cut.scene();
    std::size_t casting = 0;
    for (const Mesh& mesh : scene.meshes) casting += mesh.casts ? mesh.triangles.size() : 0;
    if (casting > most_triangles)
      return Support::unsupported(fmt::format("{} triangles cast; trees are grown for up to {}", casting, most_triangles));
    if (const double before = casters_before(scene, light); before > most_before)
      return Support::unsupported(fmt::format(
          "{:.0f} triangles stand before the light from a point on average; up to {:.0f} are clipped", before, most_before));
    if (shade.is("vertices"))
      return masks.limit(original, Support::approximate("penumbrae are linear between the corners of fragments"));
    return masks.limit(original, Support::full());
  }
  void setup() override {}
  void build(const Scene& scene) override { *built_ = Casters(masks.cut(scene)); }
  /// Keeps the pieces that masks were cut into, where these stand still.
  void update(const Scene& scene, const Changes& changes) override {
    if (!built_->cut.follow(changes)) return build(scene);
    if (!changes.empty()) *built_ = Casters(std::move(built_->cut));
  }
  void relight(const Light& light) override {
    light_ = light;
    body_ = body_of(light);
    // Far above what rounding makes of a plane, far below what float32 tells apart.
    double largest = built_->bounds.extent();
    for (const Corner& corner : body_.corners) largest = std::max(largest, extent(corner.at));
    epsilon_ = 1e-10 * largest;
    volumes_.make(built_->polygons, body_, epsilon_);
    trees_.grow({.casters = &*built_, .volumes = &volumes_, .body = &body_, .light = light},
                {.epsilon = epsilon_,
                 .least_width = least_width * diagonal(),
                 .largest = fragment_size * diagonal(),
                 .light_splits = light_splits,
                 .asks_corners = shade.is("vertices")},
                static_cast<std::uint64_t>(work) * 1'000'000);
  }
  void resolve(const GBuffer& gbuffer, VisibilityMask& mask) override {
    gbuffer_ = &gbuffer;
    constexpr std::size_t block = 64;
    const std::span<float> pixels = mask.pixels();
    std::vector<Tally> tallies((gbuffer.size() + block - 1) / block);
    for_blocks(gbuffer.size(), block, [&](std::size_t begin, std::size_t end) {
      Scratch scratch;
      for (std::size_t i = begin; i < end; ++i) pixels[i] = visibility(gbuffer, i, scratch, tallies[begin / block]);
    });
    tally_ = {};
    for (const Tally& tally : tallies) tally_ += tally;
  }
  Counts counts() const override {
    const Work& done = trees_.work();
    const std::uint64_t fragments = done.lit + done.penumbra + done.umbra;
    std::uint64_t facing = 0;
    for (const Volume& volume : volumes_.all()) facing += !volume.is_turned_away;
    return {count_of("polygons", built_->polygons.size()),
            count_of("facing", facing),
            count_of("volumes", volumes_.all().size()),
            count_of("trees", trees_.count()),
            count_of("nodes", trees_.node_count()),
            count_of("fragments", fragments),
            count_of("lit_fragments", done.lit),
            count_of("penumbra_fragments", done.penumbra),
            count_of("umbra_fragments", done.umbra),
            mean_of("fragments_per_polygon", fragments, trees_.count()),
            count_of("splits", done.cuts),
            count_of("tile_splits", done.halved),
            count_of("tests", done.tests),
            count_of("left_whole", done.stopped),
            count_of("light_parts", done.light_parts),
            count_of("light_clips", done.clips),
            count_of("located", tally_.located),
            mean_of("visits", tally_.visits, tally_.located),
            count_of("clipped", tally_.clipped),
            count_of("searched", tally_.open),
            mean_of("casters", tally_.clippers, tally_.clipped),
            {"bytes", static_cast<double>(volumes_.bytes() + trees_.bytes()) + built_.own(static_cast<double>(built_->bytes())),
             "byte"}};
  }
  std::optional<Explanation> explain(std::size_t index) const override {
    if (!faces_light(*built_->scene, *gbuffer_, light_, index)) return std::nullopt;
    Tally tally;
    const Place at = place(*gbuffer_, index, tally);
    Explanation why;
    if (at.tree && is_penumbra(at.link) && at.tree->penumbras[number_of(at.link)].corner_count > 0) why.cause = causes[0].id;
    return why;
  }
  std::optional<SurfaceDetail> surface_detail() const override {
    if (!built_->scene) return SurfaceDetail{};
    return divide_triangles(*built_, trees_, body_, epsilon_);
  }
  std::vector<DebugLayer> debug_layers() const override {
    std::vector<DebugLayer> layers = soft_detail_layers();
    layers.insert(layers.end(),
                  {splits_layer(), heat_debug_layer("casters", "Polygons that the light is clipped by, from each point")});
    return layers;
  }
  std::vector<float> draw_debug(std::string_view layer) const override {
    if (layer == "fragments") return paint_detail(*built_->scene, *gbuffer_, light_, *surface_detail());
    if (layer == "splits") return paint_splits(*built_->scene, *gbuffer_, light_, *surface_detail());
    if (layer != "casters") return Technique::draw_debug(layer);
    std::vector<float> values(gbuffer_->size(), 0);
    for_blocks(values.size(), 64, [&](std::size_t begin, std::size_t end) {
      Scratch scratch;
      for (std::size_t i = begin; i < end; ++i) {
        Tally tally;
        visibility(*gbuffer_, i, scratch, tally);
        values[i] = static_cast<float>(tally.clippers);
      }
    });
    return heat_layer(*gbuffer_, values);
  }
  std::unique_ptr<Technique> for_another_light() const override { return another(*this, &AreaSvbsp::built_); }

 private:
  /// Where a pixel's point lies: a tree, and the cell in it.
  struct Place {
    const Tree* tree = nullptr;  ///< none: the point is on no side that has one
    Link link = lit_cell;
  };
  struct Tally {
    std::uint64_t located = 0, visits = 0, clipped = 0, clippers = 0;
    std::uint64_t open = 0;  ///< points whose polygons are looked for: without a tree, or in a cell that lists none
    Tally& operator+=(const Tally& t) {
      return add_up(*this, t, &Tally::located, &Tally::visits, &Tally::clipped, &Tally::clippers, &Tally::open);
    }
  };
  struct Scratch {
    VisibleArea area;
    std::vector<std::uint32_t> between;
  };
  Place place(const GBuffer& gbuffer, std::size_t i, Tally& tally) const {
    const Scene& scene = *built_->scene;
    const Receiver receiver = receiver_at(scene, gbuffer, i);
    if (!receiver.has_triangle()) return {};
    const glm::dvec3 point(receiver.point);
    const glm::dvec3 normal = scene.meshes[receiver.mesh].corners(receiver.triangle).normal();
    const bool is_front = glm::dot(normal, glm::dvec3(gbuffer.normal(i))) > 0;
    const int light_side = !body_.is_flat ? 0 : body_.plane.at(point) > 0 ? 1 : -1;
    const Tree* const tree = trees_.find({built_->numbers.first_of(receiver.mesh) + receiver.triangle,
                                          static_cast<std::int8_t>(is_front ? 1 : -1), static_cast<std::int8_t>(light_side)});
    if (!tree) return {};
    ++tally.located;
    return {tree, tree->locate(point, tally.visits)};
  }
  float visibility(const GBuffer& gbuffer, std::size_t i, Scratch& scratch, Tally& tally) const {
    if (gbuffer.is_background(i) || !built_->scene->meshes[gbuffer.mesh[i]].receives) return 1;
    const LightFigure figure(light_, gbuffer.position(i), gbuffer.normal(i));
    if (!figure.is_seen()) return 1;
    const Place at = place(gbuffer, i, tally);
    if (at.tree && !is_penumbra(at.link)) return at.link == lit_cell ? 1.0f : 0.0f;
    const Penumbra* const cell = at.tree ? &at.tree->penumbras[number_of(at.link)] : nullptr;
    if (cell && cell->corner_count > 0)
      return static_cast<float>(
          interpolated(std::span(at.tree->corners).subspan(cell->corner, cell->corner_count), gbuffer.position(i)));
    ++tally.clipped;
    std::span<const std::uint32_t> polygons;
    if (cell && cell->count != Penumbra::open) {
      polygons = std::span(at.tree->polygons).subspan(cell->first, cell->count);
    } else {
      ++tally.open;
      find_between(*built_, receiver_at(*built_->scene, gbuffer, i), figure, scratch.between);
      polygons = scratch.between;
    }
    tally.clippers += polygons.size();
    return static_cast<float>(seen_past(built_->polygons, polygons, gbuffer.position(i), figure, scratch.area));
  }
  double diagonal() const {
    const Bounds& box = built_->bounds;
    return box.empty() ? 0 : glm::distance(glm::dvec3(box.min), glm::dvec3(box.max));
  }

  Shared<Casters> built_;
  Light light_;
  LightBody body_;
  double epsilon_ = 0;
  Volumes volumes_;
  Trees trees_;
  const GBuffer* gbuffer_ = nullptr;
  Tally tally_;
};

}  // namespace

GNOMON_TECHNIQUE(area_svbsp, AreaSvbsp, about)
