// Two-pass object precision: hidden surfaces are removed from the light's side, in object precision. What is left of each
// triangle is lit and stays attached to it as surface detail; a visible point is looked up there.
//
// Source: Atherton, Weiler and Greenberg 1978. Theirs clips concave polygons with holes by one another, front to back, in the
//         image space of one perspective. Here pieces are convex and cut by planes in world space: a triangle loses what lies
//         inside the three planes through the light and a caster's edges and beyond the caster, whatever the order. So shared
//         edges, corners on edges, cycles and triangles through each other need no case of their own, and since the planes
//         bound a cone on its own side only, what lies behind the light stays out. Candidates come from a grid in light space.
//         What lies beyond casters that cover its cell, or all of its places there, is in shadow and is not clipped at all.
// Error:  none on the float32 points that it is given. Pieces are in double. Points within rounding of a piece's border or of
//         their triangle's, and casters within rounding of their receiver's plane, are decided one by one by exact signs. A
//         way to the light through an edge or a vertex is blocked. Tessellation on curved shapes, whose points are all asked.
// Fails:  nothing it supports. Fragments multiply where layer lies on layer of large triangles; many triangles that stand edge
//         to the light, or share one line of sight, crowd a cell that no grid can thin out, and pairs there are quadratic.
#include <gnomon/kit/layers.h>
#include <gnomon/kit/surface_detail.h>
#include <gnomon/registry.h>

#include "two_pass_object/detail.h"

namespace {
using namespace gnomon;
using namespace gnomon::two_pass_object;

class TwoPassObject final : public Technique {
 public:
  Number<double> cell_triangles{this,
                                "cell_triangles",
                                24,
                                {.unit = "triangles", .min = 2, .max = 256, .log = true},
                                Stage::relight,
                                "About how many triangles a cell of the light-space grid holds; it never changes the answer."};
  Flag merge{this, "merge", true, Stage::relight,
             "Surface detail of a triangle that is lit, or in shadow, throughout is one polygon; the mask does not need it."};

  Support supports(const Scene&, const Light& light, const View&) const override {
    if (has_area(light)) return Support::unsupported("surfaces are hidden from one point of the light: it has no area");
    return Support::full();
  }
  void setup() override {}
  void build(const Scene& scene) override {
    scene_ = &scene;
    map_.clear();
    is_lit_up_ = false;
    triangles_.build(scene);
  }
  void relight(const Light& light) override {
    light_ = light;
    triangles_.relight(homogeneous(light));
    map_.make(triangles_, cell_triangles);
    merges_ = merge;
    is_lit_up_ = true;
  }
  void resolve(const GBuffer& gbuffer, VisibilityMask& mask) override;
  Counts counts() const override;
  std::optional<Explanation> explain(std::size_t index) const override;
  std::optional<SurfaceDetail> surface_detail() const override {
    return is_lit_up_ ? make_detail(*scene_, triangles_, map_, merges_) : SurfaceDetail{};
  }
  std::vector<DebugLayer> debug_layers() const override {
    std::vector<DebugLayer> layers = detail_layers();
    layers.push_back(splits_layer());
    layers.push_back({"clips",
                      "Casters that took a part away from each point's triangle in its cell: none where the picture is left "
                      "gray, else colors as in the legend.",
                      heat_legend()});
    return layers;
  }
  std::vector<float> draw_debug(std::string_view layer) const override;

 private:
  Asked asked(const GBuffer& gbuffer, std::size_t i) const;

  const Scene* scene_ = nullptr;
  const GBuffer* gbuffer_ = nullptr;
  Light light_;
  bool is_lit_up_ = false, merges_ = true;
  Triangles triangles_;
  LightMap map_;
  Tally tally_;
};

Asked TwoPassObject::asked(const GBuffer& gbuffer, std::size_t i) const {
  const std::uint32_t m = gbuffer.mesh[i];
  Asked asked{.point = gbuffer.position(i)};
  // A curved body is convex: none shades a point of its own that faces the light.
  if (gbuffer.truth == Truth::shape && scene_->meshes[m].has_curved_shape())
    asked.first_own = triangles_.first_of(m), asked.end_own = triangles_.end_of(m);
  else
    asked.triangle = triangles_.first_of(m) + gbuffer.triangle[i];
  return asked;
}

void TwoPassObject::resolve(const GBuffer& gbuffer, VisibilityMask& mask) {
  gbuffer_ = &gbuffer;
  const std::span<float> pixels = mask.pixels();
  // Neighbors lie in the same cells.
  constexpr int side = 16;
  const std::size_t columns = (gbuffer.width + side - 1) / side, rows = (gbuffer.height + side - 1) / side;
  std::vector<Tally> tallies(columns * rows);
  for_blocks(tallies.size(), 8, [&](std::size_t begin, std::size_t end) {
    for (std::size_t tile = begin; tile < end; ++tile) {
      const int left = static_cast<int>(tile % columns) * side, top = static_cast<int>(tile / columns) * side;
      for (int y = top; y < std::min(top + side, gbuffer.height); ++y)
        for (int x = left; x < std::min(left + side, gbuffer.width); ++x) {
          const std::size_t i = static_cast<std::size_t>(y) * gbuffer.width + x;
          const bool is_dark =
              faces_light(*scene_, gbuffer, light_, i) && !map_.is_lit(triangles_, asked(gbuffer, i), tallies[tile]);
          pixels[i] = is_dark ? 0 : 1;
        }
    }
  });
  tally_ = {};
  for (const Tally& tally : tallies) tally_ += tally;
}

Counts TwoPassObject::counts() const {
  const auto count = [](const char* name, auto value) { return Count{name, static_cast<double>(value), ""}; };
  const Work& work = map_.work();
  std::size_t polygons = 0;
  for (std::uint32_t i = 0; i < triangles_.size(); ++i) polygons += triangles_.takes_part(i);
  return {count("cells", work.cells),
          count("pairs_tested", work.pairs_tested),
          count("pairs_clipped", work.pairs_clipped),
          count("pairs_near", work.near),
          count("splits", work.splits),
          count("lit_pieces", work.lit),
          count("shadowed_pieces", work.shadowed),
          count("hidden", work.hidden),
          count("fragments_per_polygon",
                static_cast<double>(work.lit + work.shadowed) / static_cast<double>(std::max<std::size_t>(polygons, 1))),
          count("point_locations", tally_.points),
          count("points_asked", tally_.asked),
          {"bytes", static_cast<double>(triangles_.bytes() + map_.bytes()), "byte"}};
}

// The element is a triangle of the scene, counted mesh after mesh.
std::optional<Explanation> TwoPassObject::explain(std::size_t index) const {
  if (!faces_light(*scene_, *gbuffer_, light_, index)) return std::nullopt;
  Explanation why;
  if (const std::uint32_t triangle = map_.shading(triangles_, asked(*gbuffer_, index)); triangle != Asked::none)
    why.element = triangle;
  return why;
}

std::vector<float> TwoPassObject::draw_debug(std::string_view layer) const {
  if (layer == "fragments") return paint_detail(*scene_, *gbuffer_, light_, make_detail(*scene_, triangles_, map_, merges_));
  if (layer == "splits") return paint_splits(*scene_, *gbuffer_, light_, make_detail(*scene_, triangles_, map_, false));
  if (layer != "clips") return Technique::draw_debug(layer);
  std::vector<float> clips(gbuffer_->size(), 0);
  for_blocks(clips.size(), 4096, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      if (faces_light(*scene_, *gbuffer_, light_, i))
        clips[i] = static_cast<float>(map_.clips_at(triangles_, asked(*gbuffer_, i)));
  });
  return heat_layer(*gbuffer_, clips);
}

}  // namespace

GNOMON_TECHNIQUE(
    two_pass_object, TwoPassObject,
    {.title = "Two-pass object precision",
     .summary =
         "Each triangle loses what nearer ones hide from the light; visible points are looked up in the convex lit pieces.",
     .source = "Atherton, Weiler and Greenberg 1978",
     .error = "None on the float32 points it is given; tessellation on curved shapes.",
     .fails =
         "Nothing it supports; layers of large triangles multiply fragments, and crowds along one line of sight cost pairs.",
     .promise = gnomon::Promise::exact,
     .sees = gnomon::Truth::mesh,
     .role = gnomon::Role::contender})
