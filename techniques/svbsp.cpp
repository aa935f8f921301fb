// SVBSP tree: one tree of shadow planes for a light, made by filtering the polygons down it; its cells say what is nearest to
// the light.
//
// Source: Chin and Feiner 1989. A polygon is filtered down the tree of those before it, front to back from the light; what
//         comes to an OUT cell is lit, and the shadow planes of its edges turn that part of the cell into IN. All shadow planes
//         hold the light, so the tree is one of lines in what the light sees. Three orders: `bsp`, the published one, by a
//         regular BSP tree of the scene (Fuchs, Kedem and Naylor 1980), which cuts polygons; `face_planes`, any order, with the
//         polygon's own plane as the last of its IN cell, as Chrysanthou and Slater 1995; `tiles`, tiles as the light sees
//         them, split as long as that deals polygons out, and in each one the nearest polygons first, with face planes. After
//         cuts no shadow plane is made of an edge that lies on one already.
// Error:  none but for epsilon, 1e-10 of the casters' extent, and from a lamp farther away than 28,000 of that 2^-48 of its
//         coordinates: within it double decides, and everything counts as on a plane; whether the point lies beyond the polygon
//         nearest to the light is decided exactly. A point that rounding put behind its own triangle is lit where that is
//         nearest to the light. Tessellation on curved shapes.
// Fails:  nothing it supports. Many small polygons behind many others, as the light sees them, are cut most: fragments per
//         polygon grow with the depth of layers. `order=bsp` cuts them twice. A fan of n triangles around one point takes time
//         like n^2, but for `order=face_planes`.
#include <gnomon/kit/bsp.h>
#include <gnomon/kit/exact.h>
#include <gnomon/kit/layers.h>
#include <gnomon/kit/surface_detail.h>
#include <gnomon/registry.h>

#include "svbsp/detail.h"

namespace {
using namespace gnomon;
using namespace gnomon::svbsp;

constexpr std::uint32_t none = 0xffffffffu;

class Svbsp final : public Technique {
 public:
  Choice order{this,
               "order",
               "tiles",
               {"tiles", "bsp", "face_planes"},
               Stage::build,
               "Order of polygons: nearest first in tiles, front to back by a regular BSP tree of the scene, or shuffled."};
  Choice split{this,
               "split",
               "balanced",
               {"balanced", "fewest_splits", "first"},
               Stage::build,
               "Which polygon's plane splits a cell of the regular BSP tree, for order=bsp and the painter: of the least 8 "
               "cuts + imbalance, of the fewest cuts, "
               "or the first one's."};
  Flag free_cuts{this, "free_cuts", true, Stage::build,
                 "The regular BSP tree may also be split by planes across an axis that hold no polygon; not with split=first."};
  Choice drop_edges{
      this,           "drop_edges",
      "shared",       {"shared", "cut", "none"},
      Stage::relight, "Edges without a shadow plane: those on one already, those that cuts by one made, or none."};
  Number<int> tile_size{this,
                        "tile_size",
                        16,
                        {.unit = "polygons", .min = 1, .max = 4096, .log = true},
                        Stage::relight,
                        "Tiles hold about as many polygons; those with more are split, where that deals them out."};
  Flag merge{this, "merge", true, Stage::relight,
             "Surface detail: a polygon whose fragments are all lit, or all shadowed, is left whole."};

  Support supports(const Scene&, const Light& light, const View&) const override {
    if (has_area(light))
      return Support::unsupported("a shadow plane goes through one point: it cannot see part of an area light");
    return Support::full();
  }
  void setup() override {}
  void build(const Scene& scene) override;
  void relight(const Light& light) override;
  void resolve(const GBuffer& gbuffer, VisibilityMask& mask) override;
  Counts counts() const override;
  std::optional<Explanation> explain(std::size_t index) const override;
  std::optional<SurfaceDetail> surface_detail() const override { return divide(merge); }
  std::vector<DebugLayer> debug_layers() const override;
  std::vector<float> draw_debug(std::string_view layer) const override;

 private:
  BspOptions bsp_options() const {
    return {.choice = split.is("first")           ? BspOptions::Choice::first
                      : split.is("fewest_splits") ? BspOptions::Choice::fewest_splits
                                                  : BspOptions::Choice::balanced,
            .free_cuts = free_cuts && !split.is("first")};
  }
  /// Of all triangles, or of those that a picture shows.
  SurfaceDetail divide(bool merges, const GBuffer* shown = nullptr) const;
  /// The regular BSP tree of the scene, for pictures: made when it is first asked for, where no order needs it.
  const Bsp& regular_tree() const;
  std::vector<float> paint() const;
  Facing facing() const { return {triangles_, signs_}; }
  Query query(const GBuffer& gbuffer, std::size_t i) const;
  /// The triangle that shades a pixel's point, or `none`; the query is in its cell.
  std::uint32_t occluder(const GBuffer& gbuffer, const Query& query) const;
  std::uint32_t occluder(const GBuffer& gbuffer, std::size_t i, std::uint64_t& visits) const;
  /// Triangle of its mesh, and the mesh.
  DetailPolygon named(std::uint32_t triangle) const {
    const std::uint32_t mesh = triangles_[triangle].mesh;
    return {.mesh = mesh, .triangle = triangle - first_triangle_[mesh], .is_lit = false, .first = 0, .count = 0};
  }

  const Scene* scene_ = nullptr;
  const GBuffer* gbuffer_ = nullptr;
  Light light_;
  Bounds bounds_;                              // of the casters
  std::vector<SceneTriangle> triangles_;       // of all meshes
  std::vector<std::uint32_t> first_triangle_;  // of each mesh
  std::optional<Bsp> bsp_;                     // for order=bsp
  mutable std::optional<Bsp> drawn_bsp_;       // for pictures only
  std::vector<const BspPolygon*> front_to_back_;
  std::vector<std::int8_t> signs_;
  LightSpace space_;
  Pieces pieces_;
  Forest forest_;
  std::size_t polygon_count_ = 0;  // triangles that cast and are not edge-on
  std::uint64_t locations_ = 0, visits_ = 0;
};

void Svbsp::build(const Scene& scene) {
  scene_ = &scene;
  triangles_.clear(), first_triangle_.clear();
  triangles_.reserve(scene.triangle_count());
  bounds_ = {};
  for (std::uint32_t m = 0; m < scene.meshes.size(); ++m) {
    const Mesh& mesh = scene.meshes[m];
    first_triangle_.push_back(static_cast<std::uint32_t>(triangles_.size()));
    for (const glm::uvec3& v : mesh.triangles) {
      triangles_.push_back({{mesh.positions[v.x], mesh.positions[v.y], mesh.positions[v.z]}, m});
      if (mesh.casts)
        for (const glm::vec3& p : triangles_.back().corners) bounds_.add(p);
    }
  }
  bsp_.reset(), drawn_bsp_.reset();
  if (order.is("bsp")) bsp_.emplace(scene, bsp_options());
}

void Svbsp::relight(const Light& light) {
  light_ = light;
  const glm::dvec4 at = homogeneous(light);
  space_ = LightSpace(at, bounds_);
  signs_.resize(triangles_.size());
  for_blocks(triangles_.size(), 8192, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const glm::vec3* p = triangles_[i].corners;
      signs_[i] = static_cast<std::int8_t>(orient3d_sign(p[0], p[1], p[2], at));
    }
  });
  const auto casts = [&](std::uint32_t triangle) {
    return signs_[triangle] != 0 && scene_->meshes[triangles_[triangle].mesh].casts;
  };
  polygon_count_ = 0;
  for (std::uint32_t i = 0; i < triangles_.size(); ++i) polygon_count_ += casts(i);
  using Part = std::pair<std::uint32_t, std::span<const Corner>>;
  if (bsp_) {
    front_to_back_.clear();
    bsp_->front_to_back(at, [&](std::span<const BspPolygon> set) {
      for (const BspPolygon& polygon : set)
        if (casts(polygon.triangle)) front_to_back_.push_back(&polygon);
    });
    pieces_.make(space_, facing(), front_to_back_.size(), [&](std::size_t i, Corner*) -> Part {
      return {front_to_back_[i]->triangle, bsp_->corners(*front_to_back_[i])};
    });
  } else {
    pieces_.make(space_, facing(), triangles_.size(), [&](std::size_t i, Corner* scratch) -> Part {
      const auto triangle = static_cast<std::uint32_t>(i);
      if (!casts(triangle)) return {triangle, {}};
      for (int k = 0; k < 3; ++k) scratch[k] = {glm::dvec3(triangles_[i].corners[k]), own_edge};
      return {triangle, {scratch, 3}};
    });
  }
  double extent = 0;
  for (const glm::vec3& p : {bounds_.min, bounds_.max})
    if (!bounds_.empty())
      for (int k = 0; k < 3; ++k) extent = std::max(extent, std::abs(double{p[k]}));
  forest_.grow(space_, pieces_, facing(),
               order.is("tiles") ? Forest::Order::tiles
               : order.is("bsp") ? Forest::Order::bsp
                                 : Forest::Order::face_planes,
               {.epsilon = {},
                .drop = drop_edges.is("none")  ? Drop::none
                        : drop_edges.is("cut") ? Drop::cut
                                               : Drop::shared,
                .tile_size = static_cast<std::size_t>(tile_size)},
               extent);
}

Query Svbsp::query(const GBuffer& gbuffer, std::size_t i) const {
  const glm::vec3 point = gbuffer.position(i);
  const int face = space_.face_of(point);
  Query query = forest_.query(face, space_.of_world(face, point));
  query.pixel = static_cast<std::uint32_t>(i);
  return query;
}

std::uint32_t Svbsp::occluder(const GBuffer& gbuffer, std::size_t i, std::uint64_t& visits) const {
  Query query = this->query(gbuffer, i);
  locate<1>({&query, 1}, visits);
  return occluder(gbuffer, query);
}

std::uint32_t Svbsp::occluder(const GBuffer& gbuffer, const Query& query) const {
  if (!is_in_cell(query.link)) return none;
  const std::size_t i = query.pixel;
  const std::uint32_t nearest = triangle_in(query.link), m = gbuffer.mesh[i];
  const SceneTriangle& other = triangles_[nearest];
  // A curved body is convex: none shades a point of its own that faces the light.
  const bool is_curved = gbuffer.truth == Truth::shape && scene_->meshes[m].has_curved_shape();
  if (is_curved ? other.mesh == m : nearest == first_triangle_[m] + gbuffer.triangle[i]) return none;
  const glm::vec3* p = other.corners;
  if (orient3d_sign(p[0], p[1], p[2], gbuffer.position(i)) != -signs_[nearest]) return none;
  if (is_curved) return nearest;
  const glm::vec3* own = triangles_[first_triangle_[m] + gbuffer.triangle[i]].corners;
  const bool is_coplanar = coplanar(own[0], own[1], own[2], p[0]) && coplanar(own[0], own[1], own[2], p[1]) &&
                           coplanar(own[0], own[1], own[2], p[2]);
  return is_coplanar ? none : nearest;
}

void Svbsp::resolve(const GBuffer& gbuffer, VisibilityMask& mask) {
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
      if (faces_light(*scene_, gbuffer, light_, i)) queries[count++] = query(gbuffer, i);
      if (count < most && i + 1 < end) continue;
      locations += count;
      locate<most>({queries, count}, visits);
      for (const Query& query : std::span(queries, count))
        if (occluder(gbuffer, query) != none) pixels[query.pixel] = 0;
      count = 0;
    }
  });
  locations_ = visits_ = 0;
  for (const auto& [locations, visits] : work) locations_ += locations, visits_ += visits;
}

Counts Svbsp::counts() const {
  const Tally tally = forest_.tally();
  const auto count = [](const char* name, auto value) { return Count{name, static_cast<double>(value), ""}; };
  std::size_t bytes = triangles_.capacity() * sizeof(SceneTriangle) + signs_.capacity() + pieces_.bytes() + forest_.bytes() +
                      front_to_back_.capacity() * sizeof(void*) + (bsp_ ? bsp_->bytes() : 0);
  std::size_t pieces = 0;
  for (int face = 0; face < 6; ++face) pieces += pieces_.of_face(face).size();
  const std::uint64_t fragments = tally.lit + tally.shadowed;
  Counts counts = {count("polygons", polygon_count_),
                   count("pieces", pieces),
                   count("tiles", forest_.tile_count() + forest_.node_count() - tally.planes),
                   count("nodes", forest_.node_count()),
                   count("shadow_planes", tally.planes),
                   count("depth", forest_.depth()),
                   count("fragments", fragments),
                   count("lit_fragments", tally.lit),
                   count("hidden", tally.hidden),
                   count("fragments_per_polygon",
                         static_cast<double>(fragments) / static_cast<double>(std::max<std::size_t>(polygon_count_, 1))),
                   count("splits", tally.cuts + tally.crossings),
                   count("tile_splits", tally.tile_cuts),
                   count("queries", locations_),
                   count("visits", static_cast<double>(visits_) / static_cast<double>(std::max<std::uint64_t>(locations_, 1))),
                   {"bytes", static_cast<double>(bytes), "byte"}};
  if (bsp_) {
    counts.push_back(count("bsp_nodes", bsp_->node_count()));
    counts.push_back(count("bsp_splits", bsp_->split_count()));
    counts.push_back(count("bsp_depth", bsp_->depth()));
  }
  return counts;
}

std::optional<Explanation> Svbsp::explain(std::size_t index) const {
  if (!faces_light(*scene_, *gbuffer_, light_, index)) return std::nullopt;
  Explanation why;
  std::uint64_t visits = 0;
  if (const std::uint32_t triangle = occluder(*gbuffer_, index, visits); triangle != none) why.element = triangle;
  return why;
}

SurfaceDetail Svbsp::divide(bool merges, const GBuffer* shown) const {
  std::vector<std::uint8_t> is_shown(triangles_.size(), shown == nullptr);
  for (std::size_t i = 0; shown && i < shown->size(); ++i) {
    if (shown->is_background(i)) continue;
    const std::uint32_t m = shown->mesh[i], first = first_triangle_[m];
    // A point of a curve has no triangle of its own.
    if (shown->truth == Truth::mesh || !scene_->meshes[m].has_curved_shape())
      is_shown[first + shown->triangle[i]] = 1;
    else if (!is_shown[first])
      std::fill_n(is_shown.begin() + first, scene_->meshes[m].triangles.size(), 1);
  }
  constexpr std::size_t block = 4096;
  std::vector<SurfaceDetail> parts((triangles_.size() + block - 1) / block);
  const Facing facing = this->facing();
  for_blocks(signs_.size(), block, [&](std::size_t begin, std::size_t end) {
    Divider divider(space_, forest_, facing);
    for (std::size_t i = begin; i < end; ++i) {
      if (!is_shown[i] || signs_[i] == 0 || !scene_->meshes[triangles_[i].mesh].receives) continue;
      Corner corners[3];
      for (int k = 0; k < 3; ++k) corners[k] = {glm::dvec3(triangles_[i].corners[k]), own_edge};
      const auto triangle = static_cast<std::uint32_t>(i);
      divider.divide(corners, triangle, named(triangle), merges, parts[begin / block]);
    }
  });
  SurfaceDetail all;
  for (const SurfaceDetail& part : parts) {
    const auto first = static_cast<std::uint32_t>(all.corners.size());
    for (DetailPolygon polygon : part.polygons) polygon.first += first, all.polygons.push_back(polygon);
    all.corners.insert(all.corners.end(), part.corners.begin(), part.corners.end());
  }
  return all;
}

std::vector<DebugLayer> Svbsp::debug_layers() const {
  std::vector<DebugLayer> layers = detail_layers();
  layers.push_back(splits_layer());
  layers.push_back(bsp_layer());
  layers.push_back(painter_layer());
  layers.push_back({"visits", "Nodes visited to locate each point: gray none, else colors as in the legend.", heat_legend()});
  return layers;
}

const Bsp& Svbsp::regular_tree() const {
  if (bsp_) return *bsp_;
  if (!drawn_bsp_) drawn_bsp_.emplace(*scene_, bsp_options());
  return *drawn_bsp_;
}

/// The second pass of the source: the regular BSP tree's polygons with their surface detail.
std::vector<float> Svbsp::paint() const {
  const Bsp& bsp = regular_tree();
  const Facing facing = this->facing();
  Divider divider(space_, forest_, facing);
  SurfaceDetail detail;
  return paint_back_to_front(*scene_, *gbuffer_, light_, bsp, [&](const BspPolygon& polygon, DetailBrush& brush) {
    detail.corners.clear(), detail.polygons.clear();
    divider.divide(bsp.corners(polygon), polygon.triangle, named(polygon.triangle), merge, detail);
    for (const DetailPolygon& part : detail.polygons)
      brush.paint(std::span<const glm::dvec3>(detail.corners).subspan(part.first, part.count), part.is_lit);
  });
}

std::vector<float> Svbsp::draw_debug(std::string_view layer) const {
  if (layer == "fragments") return paint_detail(*scene_, *gbuffer_, light_, divide(merge, gbuffer_));
  if (layer == "splits") return paint_splits(*scene_, *gbuffer_, light_, divide(false, gbuffer_));
  if (layer == "bsp") return paint_bsp(*scene_, *gbuffer_, light_, regular_tree());
  if (layer == "painter") return paint();
  if (layer != "visits") return Technique::draw_debug(layer);
  std::vector<float> values(gbuffer_->size(), 0);
  for (std::size_t i = 0; i < values.size(); ++i) {
    std::uint64_t visits = 0;
    if (faces_light(*scene_, *gbuffer_, light_, i)) occluder(*gbuffer_, i, visits);
    values[i] = static_cast<float>(visits);
  }
  return heat_layer(*gbuffer_, values);
}

}  // namespace

GNOMON_TECHNIQUE(svbsp, Svbsp,
                 {.title = "SVBSP tree",
                  .summary = "Polygons filtered down a tree of shadow planes; each visible point is located in it.",
                  .source = "Chin and Feiner 1989",
                  .error = "None beyond 1e-10 of the extent; tessellation on curved shapes.",
                  .fails = "Nothing it supports; many layers of small polygons, as the light sees them, are cut most.",
                  .promise = gnomon::Promise::exact,
                  .sees = gnomon::Truth::mesh,
                  .role = gnomon::Role::contender})
