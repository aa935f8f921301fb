// Alias-free shadow map (irregular z-buffer): the visible points, sorted into a grid as the light sees them, and every triangle
// rasterized onto those points instead of onto texels.
//
// Here on the processor: a triangle walks the cells that its shadow may touch, and the points in them are tested against the
// planes through the light and its edges and against its own plane, in double with a proven bound, by exact signs where double
// cannot decide. A triangle with an alpha mask darkens those of them that see it through a solid texel; the others wait for the
// next triangle. Glass is noted for each point that it crosses, and multiplied when all triangles of the tile were walked.
#include <gnomon/kit/add_up.h>
#include <gnomon/kit/bases/point_technique.h>
#include <gnomon/kit/geometry/light_through.h>
#include <gnomon/kit/scratch_pool.h>
#include <gnomon/registry.h>

#include "alias_free_map/walk.h"

namespace {
using namespace gnomon;
using namespace gnomon::alias_free_map;

constexpr About about{
    .title = "Alias-free shadow map",
    .summary = "The visible points in a grid seen from the light, each tested against the triangles over its cell.",
    .source =
        "Aila and Laine 2004; Johnson, Lee, Burns and Mark 2005; lists of points per cell and tests against the frustum of a "
        "triangle, without any depth: Wyman, Hoetzlein and Lefohn 2015",
    .error =
        "None on the float32 points it is given: edges and vertices block, the texels of alpha masks and glass are "
        "exact, and behind glass a point gets the product of what all of it lets through. Tessellation on curved shapes.",
    .fails =
        "Nothing it supports. Its cost depends on the view, and resolve pays nearly all of it: it is highest exactly where a "
        "shadow map would alias worst, where many points share a cell, which then meet each triangle that covers it.",
    .promise = Promise::exact,
    .handles = with_gray_transmission};

constexpr std::size_t caster_block = 16384;

struct Caster : Triangle {
  std::uint32_t triangle;  ///< counted over the scene
};

/// What a pixel was found to be.
struct PixelAnswer {
  /// A triangle of the scene; 0xffffffff: none. Of glass alone the first that lets least through.
  std::uint32_t shaded_by = 0xffffffffu;
  std::uint32_t tests = 0;
  std::uint32_t list = 0;  ///< samples of its cell, itself included
};

struct Work {
  std::uint64_t walked = 0, tests = 0, exact = 0;  ///< triangles with samples to test; tests; those by exact signs
  Work& operator+=(const Work& w) { return add_up(*this, w, &Work::walked, &Work::tests, &Work::exact); }
};

/// Glass that is crossed on the way from a pixel's point to the light.
struct PixelCrossing {
  std::uint32_t pixel;
  Crossings::Crossed crossed;
};

/// What one thread works with.
struct Scratch {
  std::vector<Run> runs;
  std::vector<std::uint32_t> candidates;
  std::vector<std::int32_t> steps;   ///< of the number of tests, from each sample of the tile to the next
  std::vector<PixelCrossing> glass;  ///< of the tile
  Crossings crossings;
};

class AliasFreeMap final : public PointTechnique {
 public:
  Number<int> resolution =
      Number<int>(this, "resolution", 512, {.unit = "cells", .min = 16, .max = 4096, .log = true}, Stage::resolve,
                  "Side of the grid that holds the visible points as the light sees them; it never changes the answer.");

  void build(const Scene& scene) override {
    remember(scene);
    built_->all_bounds = scene.bounds();
    built_->bounds = {};
    built_->has_holes = scene.has_alpha_masks();
    built_->has_transmission = scene.has_transmission();
    built_->casters.clear();
    std::size_t count = 0;
    for (const Mesh& mesh : scene.meshes) count += mesh.casts ? mesh.triangles.size() : 0;
    built_->casters.reserve(count);
    for_triangles(scene, [&](const glm::vec3& a, const glm::vec3& b, const glm::vec3& c, std::uint32_t mesh, auto number) {
      if (!scene.meshes[mesh].casts) return;
      built_->casters.push_back({{{a, b, c}}, number});
      built_->bounds.add(built_->casters.back().points);
    });
  }
  void relight(const Light& light) override {
    light_ = light;
    homogeneous_ = homogeneous(light);
    space_ = space_of(light, built_->bounds);
    project_casters();
  }
  void resolve(const GBuffer& gbuffer, VisibilityMask& mask) override {
    gbuffer_ = &gbuffer;
    const std::span<float> pixels = mask.pixels();
    answers_.assign(gbuffer.size(), {});
    std::ranges::fill(pixels, 1.0f);
    grid_.fill(*remembered_->scene, gbuffer, light_, space_, resolution);
    dark_.assign(grid_.capacity(), 0);
    sort_casters();
    std::vector<Work> works(grid_.tiles().size());
    for_blocks(works.size(), 1, [&](std::size_t t, std::size_t) {
      if (grid_.tiles()[t].count == 0) return;
      works[t] = walk_tile(t, pixels, *scratch_.borrow());
    });
    work_ = {};
    for (const Work& work : works) work_ += work;
  }
  Counts counts() const override {
    std::size_t bytes = bytes_of(facing_, dark_, answers_) + grid_.bytes();
    for (int face = 0; face < 6; ++face) bytes += bytes_of(footprints_[face]) + caster_bins_[face].bytes();
    return {count_of("samples", grid_.sample_count()),
            count_of("cells_used", grid_.used_cell_count()),
            most_of("longest_list", grid_.longest_list()),
            count_of("triangles_walked", work_.walked),
            count_of("sample_tests", work_.tests),
            count_of("exact_tests", work_.exact),
            {"bytes", static_cast<double>(bytes) + built_.own(static_cast<double>(bytes_of(built_->casters))), "byte"}};
  }
  std::vector<DebugLayer> debug_layers() const override {
    return {heat_debug_layer("list", "Points in the cell of each point"),
            heat_debug_layer("tests", "Triangles that each point was tested against")};
  }
  std::vector<float> draw_debug(std::string_view layer) const override {
    if (layer == "list") return heat_of([&](std::size_t i) { return answers_[i].list; });
    if (layer == "tests") return heat_of([&](std::size_t i) { return answers_[i].tests; });
    return Technique::draw_debug(layer);
  }
  std::unique_ptr<Technique> for_another_light() const override {
    return another(*this, &AliasFreeMap::remembered_, &AliasFreeMap::built_);
  }

 private:
  const char* why_no_area() const override { return "points are sorted as one point of the light sees them: it has no area"; }
  std::uint32_t shading_triangle(std::size_t index) const override { return answers_[index].shaded_by; }
  /// Whether the shadow of the footprint's caster may reach samples of a tile.
  static bool may_touch(const Footprint& f, const Tile& tile) {
    return tile.count > 0 && f.z0 <= tile.z1 && f.x0 <= tile.high.x && f.x1 >= tile.low.x && f.y0 <= tile.high.y &&
           f.y1 >= tile.low.y;
  }
  void project_casters() {
    double extent = 0;
    if (!built_->all_bounds.empty())
      for (int k = 0; k < 8; ++k) {
        const glm::vec3 &low = built_->all_bounds.min, &high = built_->all_bounds.max;
        const glm::vec3 corner((k & 1 ? high : low).x, (k & 2 ? high : low).y, (k & 4 ? high : low).z);
        extent = std::max(extent, norm1(space_.main().seen(corner)));
      }
    find_facing(built_->casters, homogeneous_, facing_);
    const std::size_t blocks = (built_->casters.size() + caster_block - 1) / caster_block;
    std::vector<std::vector<Footprint>> found[6];  // of each face and block
    for (auto& face : found) face.resize(blocks);
    for_blocks(built_->casters.size(), caster_block, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        if (facing_[i] == 0) continue;
        FaceFootprint footprints[6];
        const int count = find_footprints(space_, built_->casters[i].points, extent, static_cast<std::uint32_t>(i), footprints);
        for (const auto& [face, footprint] : std::span(footprints, count))
          found[face][begin / caster_block].push_back(footprint);
      }
    });
    for (int face = 0; face < 6; ++face) {
      std::size_t count = 0;
      for (const auto& block : found[face]) count += block.size();
      footprints_[face].clear();
      footprints_[face].reserve(count);
      for (const auto& block : found[face]) footprints_[face].insert(footprints_[face].end(), block.begin(), block.end());
    }
  }
  void sort_casters() {
    for (int k = 0; k < 6; ++k) {
      const Grid::Face& face = grid_.face(k);
      const int cells = grid_.cells();
      sort_into_bins(footprints_[k].size(), caster_block, static_cast<std::size_t>(face.tile_columns) * face.tile_rows,
                     caster_bins_[k], [&](std::size_t i, auto&& visit) {
                       const Footprint& f = footprints_[k][i];
                       if (face.empty()) return;
                       const int c0 = face.column(f.x0) / cells, c1 = face.column(f.x1) / cells;
                       const int r0 = face.row(f.y0) / cells, r1 = face.row(f.y1) / cells;
                       for (int r = r0; r <= r1; ++r)
                         for (int c = c0; c <= c1; ++c) {
                           const std::size_t t = static_cast<std::size_t>(r) * face.tile_columns + c;
                           if (may_touch(f, grid_.tiles()[face.first_tile + t])) visit(t);
                         }
                     });
    }
  }
  Work walk_tile(std::size_t t, std::span<float> mask, Scratch& scratch) {
    Tile& tile = grid_.tile(t);
    const Grid::Face& face = grid_.face(tile.face);
    const std::span<const std::uint32_t> footprints = caster_bins_[tile.face].of(t - face.first_tile);
    const int cells = grid_.cells();
    const std::uint32_t* const begins = grid_.cell_begins(t);
    const std::uint32_t first = tile.first;
    scratch.runs.resize(cells);
    scratch.candidates.resize(std::max<std::size_t>(scratch.candidates.size(), tile.count + Grid::lanes));
    scratch.steps.assign(tile.count + 1, 0);
    scratch.glass.clear();
    for (std::size_t c = 0; c + 1 < grid_.begins_per_tile(); ++c)
      for (std::uint32_t k = begins[c]; k < begins[c + 1]; ++k) answers_[grid_.pixel()[k]].list = begins[c + 1] - begins[c];

    Work work;
    std::uint32_t dark = 0;
    for (std::size_t k = 0; k < footprints.size() && dark < tile.count; ++k) {
      const Footprint& footprint = footprints_[tile.face][footprints[k]];
      if (!may_touch(footprint, tile)) continue;
      const Caster& caster = built_->casters[footprint.caster];
      const Shadow shadow = make_shadow(space_[tile.face], homogeneous_, caster.points, facing_[footprint.caster], tile.reach);
      const int runs = find_runs(face, tile, cells, begins, footprint, shadow, space_.is_parallel(), scratch.runs.data());
      if (runs == 0) continue;
      ++work.walked;
      for (const Run& run : std::span(scratch.runs).first(runs)) {
        work.tests += run.end - run.begin;
        ++scratch.steps[run.begin - first];
        --scratch.steps[run.end - first];
      }
      const std::uint32_t count =
          find_candidates(grid_.x(), grid_.y(), grid_.z(), scratch.runs.data(), runs, shadow, scratch.candidates.data());
      dark += darken(caster, shadow, count, mask, scratch, work);
      // Dark samples are decided and leave the tile.
      if (2 * dark > tile.count) {
        note_tests(tile, scratch);
        grid_.remove_dark(t, dark_);
        dark = 0;
      }
    }
    note_tests(tile, scratch);
    shine_through(mask, scratch);
    return work;
  }
  /// Darkens the first `candidate_count` candidates that a caster shades, and returns how many; of glass none, but notes them.
  std::uint32_t darken(const Caster& caster, const Shadow& shadow, std::uint32_t candidate_count, std::span<float> mask,
                       Scratch& scratch, Work& work) {
    std::uint32_t count = 0;
    const std::optional<Crossings::Crossed> glass = glass_of(caster);
    for (const std::uint32_t i : std::span(scratch.candidates).first(candidate_count)) {
      if (dark_[i]) continue;
      const bool clearly = std::ranges::all_of(
          shadow.sides, [&](const Side& s) { return s.at(grid_.x()[i], grid_.y()[i], grid_.z()[i]) > 2 * s.error; });
      const std::uint32_t pixel = grid_.pixel()[i];
      if (!shades(caster, pixel, clearly, work)) continue;
      if (glass) {
        scratch.glass.push_back({pixel, *glass});
        continue;
      }
      dark_[i] = 1;
      ++count;
      mask[pixel] = 0;
      answers_[pixel].shaded_by = caster.triangle;
    }
    return count;
  }
  /// By exact signs, if `clearly` does not settle whether the way crosses the caster.
  bool shades(const Caster& caster, std::uint32_t pixel, bool clearly, Work& work) const {
    const NumberedReceiver own = receiver(*gbuffer_, pixel);
    if (own.is_own(caster.triangle)) return false;
    if (!clearly) {
      ++work.exact;
      if (crosses({own.point, homogeneous_}, caster) == Crossing::none) return false;
    }
    if (own.is_coplanar(*remembered_->scene, caster.points)) return false;
    return !built_->has_holes || is_solid(caster, {own.point, homogeneous_});
  }
  bool is_solid(const Caster& caster, const Segment& segment) const {
    const Crossings::Crossed place = place_of(caster);
    return is_solid_at(remembered_->scene->meshes[place.mesh], place.triangle, segment);
  }
  Crossings::Crossed place_of(const Caster& caster) const {
    const TriangleNumbers& numbers = remembered_->numbers;
    const std::uint32_t mesh = numbers.mesh_of(caster.triangle);
    return {mesh, caster.triangle - numbers.first_of(mesh)};
  }
  /// A caster with transmission, else nothing.
  std::optional<Crossings::Crossed> glass_of(const Caster& caster) const {
    if (!built_->has_transmission) return std::nullopt;
    const Crossings::Crossed place = place_of(caster);
    return remembered_->scene->meshes[place.mesh].transmission ? std::optional(place) : std::nullopt;
  }
  /// Gives the samples of a tile that are behind glass alone what that lets through.
  void shine_through(std::span<float> mask, Scratch& scratch) {
    std::ranges::sort(scratch.glass, {}, &PixelCrossing::pixel);
    for (auto next = scratch.glass.begin(); next != scratch.glass.end();) {
      const std::uint32_t pixel = next->pixel;
      scratch.crossings.clear();
      for (; next != scratch.glass.end() && next->pixel == pixel; ++next)
        scratch.crossings.add(next->crossed.mesh, next->crossed.triangle);
      if (mask[pixel] == 0) continue;
      const Segment segment{gbuffer_->position(pixel), homogeneous_};
      const LightThrough light = light_through(scratch.crossings, *remembered_->scene, remembered_->numbers, segment);
      mask[pixel] = light.share;
      answers_[pixel].shaded_by = light.triangle;
    }
  }
  /// Adds up the tests of the samples of a tile.
  void note_tests(const Tile& tile, Scratch& scratch) {
    std::int32_t tests = 0;
    for (std::uint32_t k = 0; k < tile.count; ++k) {
      tests += scratch.steps[k];
      answers_[grid_.pixel()[tile.first + k]].tests += static_cast<std::uint32_t>(tests);
      scratch.steps[k] = 0;
    }
    scratch.steps[tile.count] = 0;
  }

  glm::dvec4 homogeneous_{0};
  struct Built {
    std::vector<Caster> casters;
    Bounds bounds, all_bounds;  // of the casters, of all meshes
    bool has_holes = false;     // whether a mesh has an alpha mask
    bool has_transmission = false;
  };
  Shared<Built> built_;
  LightSpace space_;
  std::vector<Footprint> footprints_[6];  // of each face
  std::vector<std::int8_t> facing_;       // of each caster: 0 when edge-on
  Grid grid_;
  Bins caster_bins_[6];  // footprints of each face to its tiles
  std::vector<std::uint8_t> dark_;
  std::vector<PixelAnswer> answers_;
  Work work_;
  ScratchPool<Scratch> scratch_;
};

}  // namespace

GNOMON_TECHNIQUE(alias_free_map, AliasFreeMap, about)
