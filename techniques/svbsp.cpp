// SVBSP tree: one tree of shadow planes for a light, made by filtering the polygons down it; its cells say what is nearest to
// the light.
//
// A polygon is filtered down the tree of those before it; what comes to an OUT cell is lit, and the shadow planes of its edges
// turn that part of the cell into IN. All shadow planes hold the light, so the tree is one of lines in what the light sees.
// After cuts no shadow plane is made of an edge that lies on one already.
// Where the scene moves, with order=tiles the first relight after an update grows only those tiles anew in which something
// moved.
// Three orders of polygons:
//   bsp          the published one: front to back from the light by a regular BSP tree of the scene, which cuts polygons;
//   face_planes  any order, with the polygon's own plane as the last of its IN cell;
//   tiles        tiles as the light sees them, split as long as that leaves fewer polygons in each, and in each one the nearest
//                polygons first, with face planes.
#include <gnomon/kit/bases/mask_setting.h>
#include <gnomon/kit/bases/point_technique.h>
#include <gnomon/kit/pictures/surface_detail.h>
#include <gnomon/registry.h>

#include "svbsp/detail.h"
#include "svbsp/paint_bsp.h"

namespace {
using namespace gnomon;
using namespace gnomon::svbsp;

constexpr About about{
    .title = "SVBSP tree",
    .summary = "Polygons filtered down a tree of shadow planes; each visible point is located in it.",
    .source =
        "Chin and Feiner 1989; for order=bsp the tree of Fuchs, Kedem and Naylor 1980; face planes as in Chrysanthou and "
        "Slater 1995",
    .error =
        "None but for epsilon, 1e-10 of the casters' extent, and from a point light farther away than 28,000 of that 2^-48 "
        "of its coordinates: within it double decides, and everything counts as on a plane; whether the point lies beyond "
        "the polygon nearest to the light is decided exactly. A point that rounding put behind its own triangle is lit where "
        "that one, or another in its plane, is nearest to the light: a cell holds the nearest polygon alone, and not what "
        "lies between it and the point. Tessellation on curved shapes. Edges of holes are rounded to float32 where masks are "
        "cut.",
    .fails =
        "Nothing it supports. Many small polygons behind many others, as the light sees them, are cut most: fragments per "
        "polygon grow with the depth of layers. order=bsp cuts them twice. A fan of n triangles around one point takes "
        "time like n^2, but for order=face_planes.",
    .promise = Promise::exact,
    .handles = with_alpha_masks};

class Svbsp final : public PointTechnique {
 public:
  Choice order =
      Choice(this, "order", "tiles", {"tiles", "bsp", "face_planes"}, Stage::build,
             "Order of polygons: nearest first in tiles, front to back by a regular BSP tree of the scene, or shuffled.");
  Choice split = Choice(this, "split", "balanced", {"balanced", "fewest_splits", "first"}, Stage::build,
                        "Which polygon's plane splits a cell of the regular BSP tree, for order=bsp and the painter: of the "
                        "least 8 cuts + imbalance, of the fewest cuts, or the first one's.");
  Flag free_cuts{this, "free_cuts", true, Stage::build,
                 "The regular BSP tree may also be split by planes across an axis that hold no polygon; not with split=first."};
  Choice drop_edges = Choice(this, "drop_edges", "shared", {"shared", "cut", "none"}, Stage::relight,
                             "Edges without a shadow plane: those on one already, those that cuts by one made, or none.");
  Number<int> tile_size =
      Number<int>(this, "tile_size", 16, {.unit = "polygons", .min = 1, .max = 4096, .log = true}, Stage::relight,
                  "Tiles hold about as many polygons; those with more are split, where that deals them out.");
  Flag merge{this, "merge", true, Stage::relight,
             "Surface detail: a polygon whose fragments are all lit, or all shadowed, is left whole."};
  MaskSetting masks{this};

  Support supports(const Scene& scene, const Light& light, const View& view) const override {
    const Support support = masks.limit(scene, PointTechnique::supports(scene, light, view));
    if (support.kind() == Support::Kind::full && order.is("bsp") && std::ranges::any_of(scene.meshes, casts_with_holes))
      return Support::unsupported("planes of the regular BSP tree would divide what is cut out of one triangle");
    return support;
  }

  void build(const Scene& original) override {
    built_->cut = masks.cut(original);
    const Scene& scene = built_->cut.scene();
    remember(scene);
    built_->number += 2;
    built_->moved.assign(scene.meshes.size(), 0);
    built_->triangles.clear();
    built_->triangles.reserve(scene.triangle_count());
    for_triangles(scene, [&](const glm::vec3& a, const glm::vec3& b, const glm::vec3& c, std::uint32_t mesh, std::uint32_t) {
      built_->triangles.push_back({{{a, b, c}}, mesh});
    });
    find_bounds();
    make_regular_tree();
  }

  void update(const Scene& original, const Changes& changes) override {
    if (!built_->cut.follow(changes)) return build(original);
    built_->number += 1;
    std::ranges::fill(built_->moved, 0);
    const Scene& scene = *remembered_->scene;
    for (std::uint32_t m = 0; m < changes.meshes.size(); ++m) {
      if (changes.meshes[m].kind == MeshChange::Kind::still) continue;
      built_->moved[m] = 1;
      SceneTriangle* next = &built_->triangles[remembered_->numbers.first_of(m)];
      for (std::size_t t = 0; t < scene.meshes[m].triangles.size(); ++t) *next++ = {scene.meshes[m].corners(t), m};
    }
    find_bounds();
    if (!changes.empty()) make_regular_tree();
  }

  void relight(const Light& light) override {
    const glm::dvec4 at = homogeneous(light);
    const ProjectedSpace space(at, built_->bounds);
    // After one update, under the very light of the last relight, tiles in which nothing moved stay.
    Moved moved;
    if (built_->number == number_ + 1 && !built_->bsp && at == at_ && space == space_)
      moved = {built_->triangles, built_->moved};
    number_ = 0;
    light_ = light;
    at_ = at;
    space_ = space;
    if (!moved.empty()) forest_.leave(pieces_, moved);
    find_facing(built_->triangles, at, signs_);
    polygon_count_ = 0;
    for (std::uint32_t i = 0; i < built_->triangles.size(); ++i) polygon_count_ += casts(i);
    make_pieces(at, moved);
    forest_.grow(space_, pieces_, facing(), static_cast<Forest::Order>(order.index()), rules(), built_->bounds.extent(), moved);
    number_ = built_->number;
  }

  void resolve(const GBuffer& gbuffer, VisibilityMask& mask) override {
    gbuffer_ = &gbuffer;
    const std::span<float> pixels = mask.pixels();
    constexpr std::size_t rows = 8;
    const std::size_t block = rows * static_cast<std::size_t>(gbuffer.width);
    std::vector<std::pair<std::uint64_t, std::uint64_t>> work((gbuffer.size() + block - 1) / block);
    for_blocks(gbuffer.size(), block, [&](std::size_t begin, std::size_t end) {
      auto& [locations, visits] = work[begin / block];
      constexpr std::size_t most = 32;
      Query queries[most];
      std::size_t count = 0;
      for (std::size_t i = begin; i < end; ++i) {
        pixels[i] = 1;
        if (faces_light(gbuffer, i)) queries[count++] = query(gbuffer, i);
        if (count < most && i + 1 < end) continue;
        locations += count;
        locate<most>({queries, count}, visits);
        for (const Query& query : std::span(queries, count))
          if (shading_triangle(gbuffer, query) != nothing) pixels[query.pixel] = 0;
        count = 0;
      }
    });
    locations_ = visits_ = 0;
    for (const auto& [locations, visits] : work) {
      locations_ += locations;
      visits_ += visits;
    }
  }

  Counts counts() const override {
    const TreeWork work = forest_.work();
    const std::size_t bytes = bytes_of(signs_, front_to_back_) + pieces_.bytes() + forest_.bytes();
    const std::size_t shared_bytes =
        bytes_of(built_->triangles) + (built_->bsp ? built_->bsp->bytes() : 0) + built_->cut.bytes();
    std::size_t pieces = 0;
    for (int face = 0; face < 6; ++face) pieces += pieces_.of_face(face).size();
    const std::uint64_t fragments = work.lit + work.shadowed;
    Counts counts{count_of("polygons", polygon_count_),
                  count_of("pieces", pieces),
                  count_of("tiles", forest_.tile_count() + forest_.node_count() - work.planes),
                  count_of("nodes", forest_.node_count()),
                  count_of("shadow_planes", work.planes),
                  most_of("depth", forest_.depth()),
                  count_of("fragments", fragments),
                  count_of("lit_fragments", work.lit),
                  count_of("hidden", work.hidden),
                  mean_of("fragments_per_polygon", fragments, polygon_count_),
                  count_of("splits", work.cuts + work.crossings),
                  count_of("tile_splits", work.tile_cuts),
                  count_of("queries", locations_),
                  mean_of("visits", visits_, locations_),
                  {"bytes", static_cast<double>(bytes) + built_.own(static_cast<double>(shared_bytes)), "byte"}};
    if (built_->bsp) {
      counts.push_back(most_of("bsp_nodes", built_->bsp->node_count()));
      counts.push_back(most_of("bsp_splits", built_->bsp->split_count()));
      counts.push_back(most_of("bsp_depth", built_->bsp->depth()));
    }
    return counts;
  }

  std::optional<SurfaceDetail> surface_detail() const override { return remembered_->scene ? divide(merge) : SurfaceDetail{}; }
  std::vector<DebugLayer> debug_layers() const override {
    std::vector<DebugLayer> layers = detail_layers();
    layers.insert(layers.end(), {splits_layer(), bsp_layer(), painter_layer(),
                                 heat_debug_layer("visits", "Nodes visited to locate each point")});
    return layers;
  }
  std::vector<float> draw_debug(std::string_view layer) const override {
    if (layer == "fragments") return paint_detail(*remembered_->scene, *gbuffer_, light_, divide(merge, gbuffer_));
    if (layer == "splits") return paint_splits(*remembered_->scene, *gbuffer_, light_, divide(false, gbuffer_));
    if (layer == "bsp") return paint_bsp(*remembered_->scene, *gbuffer_, light_, regular_tree());
    if (layer == "painter") return paint();
    if (layer != "visits") return Technique::draw_debug(layer);
    return heat_of([&](std::size_t i) {
      std::uint64_t visits = 0;
      locate_one(i, visits);
      return visits;
    });
  }

  std::unique_ptr<Technique> for_another_light() const override { return another(*this, &Svbsp::remembered_, &Svbsp::built_); }

 private:
  const char* why_no_area() const override {
    return "a shadow plane goes through one point: it cannot see part of an area light";
  }
  std::uint32_t shading_triangle(std::size_t index) const override {
    std::uint64_t visits = 0;
    return shading_triangle(*gbuffer_, locate_one(index, visits));
  }
  BspOptions bsp_options() const {
    return {.choice = static_cast<BspOptions::Choice>(split.index()), .free_cuts = free_cuts && !split.is("first")};
  }
  Rules rules() const {
    const auto drop = static_cast<Drop>(drop_edges.index());
    return {.epsilon = {}, .drop = drop, .tile_size = static_cast<std::size_t>(tile_size), .is_followed = built_->is_in_motion};
  }
  bool casts(std::uint32_t triangle) const {
    return signs_[triangle] != 0 && signs_[built_->cut.source(triangle)] != 0 &&
           remembered_->scene->meshes[built_->triangles[triangle].mesh].casts;
  }
  /// The bounds of casters hold all places that they come to, so that what depends on them stays while they move.
  void find_bounds() {
    const Scene& scene = *remembered_->scene;
    built_->bounds = {};
    for (const SceneTriangle& triangle : built_->triangles)
      if (scene.meshes[triangle.mesh].casts) built_->bounds.add(triangle.points);
    built_->is_in_motion = false;
    for (const Mesh& mesh : scene.meshes) {
      if (!mesh.casts || mesh.reach.empty()) continue;
      built_->is_in_motion = true;
      built_->bounds.add(mesh.reach);
    }
  }
  void make_regular_tree() {
    built_->bsp.reset();
    built_->drawn_bsp.reset();
    if (order.is("bsp")) built_->bsp.emplace(*remembered_->scene, bsp_options());
  }
  void make_pieces(const glm::dvec4& light, const Moved& moved) {
    if (!built_->bsp) {
      const auto corners_of = [&](std::size_t i, Corner* scratch) -> Pieces::Part {
        const auto triangle = static_cast<std::uint32_t>(i);
        if (!casts(triangle)) return {triangle, {}};
        for (int k = 0; k < 3; ++k) scratch[k] = {glm::dvec3(built_->triangles[i].points[k]), own_edge};
        return {triangle, {scratch, 3}};
      };
      pieces_.make(space_, facing(), built_->triangles.size(), corners_of, moved);
      return;
    }
    front_to_back_.clear();
    built_->bsp->front_to_back(light, [&](std::span<const BspPolygon> set) {
      for (const BspPolygon& polygon : set)
        if (casts(polygon.triangle)) front_to_back_.push_back(&polygon);
    });
    pieces_.make(space_, facing(), front_to_back_.size(), [&](std::size_t i, Corner*) -> Pieces::Part {
      return {front_to_back_[i]->triangle, built_->bsp->corners(*front_to_back_[i])};
    });
  }

  /// Of all triangles, or of those that a picture shows.
  SurfaceDetail divide(bool merges, const GBuffer* shown = nullptr) const {
    const std::vector<std::uint8_t> is_shown =
        shown ? find_shown(*shown) : std::vector<std::uint8_t>(built_->triangles.size(), 1);
    return divide_triangles(*remembered_->scene, remembered_->numbers, space_, forest_, facing(), is_shown, merges);
  }
  std::vector<std::uint8_t> find_shown(const GBuffer& gbuffer) const {
    std::vector<std::uint8_t> is_shown(built_->triangles.size(), 0);
    for (std::size_t i = 0; i < gbuffer.size(); ++i) {
      if (gbuffer.is_background(i)) continue;
      const NumberedReceiver receiver = this->receiver(gbuffer, i);
      if (!is_shown[receiver.first_own]) std::fill_n(is_shown.begin() + receiver.first_own, receiver.own_count, 1);
    }
    return is_shown;
  }

  /// The regular BSP tree of the scene, for pictures: made at the first request where no order needs it.
  const Bsp& regular_tree() const {
    if (built_->bsp) return *built_->bsp;
    if (!built_->drawn_bsp) built_->drawn_bsp.emplace(built_->cut.original(), bsp_options());
    return *built_->drawn_bsp;
  }
  /// The second pass of the source: the regular BSP tree's polygons with their surface detail.
  std::vector<float> paint() const {
    const Bsp& bsp = regular_tree();
    const Facing facing = this->facing();
    Divider divider(space_, forest_, facing, remembered_->numbers);
    SurfaceDetail detail;
    return paint_back_to_front(*remembered_->scene, *gbuffer_, light_, bsp, [&](const BspPolygon& polygon, DetailBrush& brush) {
      detail.corners.clear();
      detail.polygons.clear();
      divider.divide(bsp.corners(polygon), polygon.triangle, merge, detail);
      for (const DetailPolygon& part : detail.polygons)
        brush.paint(std::span<const glm::dvec3>(detail.corners).subspan(part.first, part.count), part.is_lit);
    });
  }

  Facing facing() const { return {built_->triangles, signs_, &built_->cut}; }
  Query query(const GBuffer& gbuffer, std::size_t i) const {
    const auto [face, at] = space_.of_world(gbuffer.position(i));
    Query query = forest_.query(face, at);
    query.pixel = static_cast<std::uint32_t>(i);
    return query;
  }
  /// The query of a pixel, in its cell.
  Query locate_one(std::size_t i, std::uint64_t& visits) const {
    Query query = this->query(*gbuffer_, i);
    locate<1>({&query, 1}, visits);
    return query;
  }
  /// The triangle of the scene that shades a pixel's point, or `nothing`; the query is in its cell.
  std::uint32_t shading_triangle(const GBuffer& gbuffer, const Query& query) const {
    if (!is_in_cell(query.link)) return nothing;
    const std::uint32_t nearest = built_->cut.source(triangle_in(query.link));
    const NumberedReceiver receiver = this->receiver(gbuffer, query.pixel);
    if (receiver.is_own(nearest)) return nothing;
    const glm::vec3* p = built_->triangles[nearest].points;
    if (orient3d_sign(p[0], p[1], p[2], receiver.point) != -signs_[nearest]) return nothing;
    return receiver.is_coplanar(*remembered_->scene, p) ? nothing : nearest;
  }

  struct Built {
    CutMasks cut;
    Bounds bounds;                         // of the casters, and of all places that they come to
    std::vector<SceneTriangle> triangles;  // of all meshes
    std::vector<std::uint8_t> moved;       // of each mesh, whether the last update moved it
    bool is_in_motion = false;             // whether a caster follows an animation
    std::uint64_t number = 0;              // of the geometry: 1 more with each update, 2 more with each build
    std::optional<Bsp> bsp;                // for order=bsp
    std::optional<Bsp> drawn_bsp;          // for pictures only
  };
  Shared<Built> built_;
  std::vector<const BspPolygon*> front_to_back_;
  std::vector<std::int8_t> signs_;
  std::uint64_t number_ = 0;  // of the geometry of the last relight
  glm::dvec4 at_{0};          // of that relight's light
  ProjectedSpace space_;
  Pieces pieces_;
  Forest forest_;
  std::size_t polygon_count_ = 0;  // triangles that cast and are not edge-on
  std::uint64_t locations_ = 0, visits_ = 0;
};

}  // namespace

GNOMON_TECHNIQUE(svbsp, Svbsp, about)
