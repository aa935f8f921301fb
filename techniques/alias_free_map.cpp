// Alias-free shadow map (irregular z-buffer): the visible points, sorted into a grid as the light sees them, and every triangle
// rasterized onto those points instead of onto texels.
//
// Source: Aila and Laine 2004; Johnson, Lee, Burns and Mark 2005; lists of points per cell and tests against the frustum of a
//         triangle, without any depth, as Wyman, Hoetzlein and Lefohn 2015. Here on the processor: a triangle walks the cells
//         that its shadow may touch, and the points in them are tested against the planes through the light and its edges and
//         against its own plane, in double with a proven bound, by exact signs where double cannot decide.
// Error:  none on the float32 points that it is given; edges and vertices block. Tessellation on curved shapes.
// Fails:  nothing it supports. Its cost depends on the view, and resolve pays nearly all of it: it is highest exactly where a
//         shadow map would alias worst, where many points share a cell, which then meet each triangle that covers it.
#include <gnomon/kit/exact.h>
#include <gnomon/kit/exact_scene.h>
#include <gnomon/kit/layers.h>
#include <gnomon/registry.h>

#include <mutex>

#include "alias_free_map/walk.h"

namespace {
using namespace gnomon;
using namespace gnomon::alias_free_map;

constexpr std::uint32_t nothing = 0xffffffffu;
constexpr std::size_t caster_block = 16384;

struct Caster {
  glm::vec3 points[3];
  std::uint32_t triangle;  ///< counted over the scene
};

/// What a pixel was found to be.
struct Found {
  std::uint32_t occluder = nothing;  ///< a triangle of the scene
  std::uint32_t tests = 0;
  std::uint32_t list = 0;  ///< samples of its cell, itself included
};

/// Work and findings.
struct Tally {
  std::uint64_t walked = 0, tests = 0, exact = 0;
  Tally& operator+=(const Tally& t) {
    walked += t.walked, tests += t.tests, exact += t.exact;
    return *this;
  }
};

/// What one thread works with.
struct Scratch {
  std::vector<Run> runs;
  std::vector<std::uint32_t> candidates;
  std::vector<std::int32_t> steps;  ///< of the number of tests, from each sample of the tile to the next
  std::size_t bytes() const {
    return sizeof(Scratch) + runs.capacity() * sizeof(Run) + (candidates.capacity() + steps.capacity()) * sizeof(std::uint32_t);
  }
};

class AliasFreeMap final : public Technique {
 public:
  Number<int> resolution{this,
                         "resolution",
                         512,
                         {.unit = "cells", .min = 16, .max = 4096, .log = true},
                         Stage::resolve,
                         "Side of the grid that holds the visible points as the light sees them; it never changes the answer."};

  Support supports(const Scene&, const Light& light, const View&) const override {
    if (has_area(light)) return Support::unsupported("points are sorted as one point of the light sees them: it has no area");
    return Support::full();
  }
  void setup() override {}
  void build(const Scene& scene) override;
  void relight(const Light& light) override;
  void resolve(const GBuffer& gbuffer, VisibilityMask& mask) override;
  Counts counts() const override;
  std::optional<Explanation> explain(std::size_t index) const override;
  std::vector<DebugLayer> debug_layers() const override {
    return {{"list", "Points in the cell of each point: none where the picture is left gray, else colors as in the legend.",
             heat_legend()},
            {"tests",
             "Triangles that each point was tested against: none where the picture is left gray, else colors as in the legend.",
             heat_legend()}};
  }
  std::vector<float> draw_debug(std::string_view layer) const override;

 private:
  /// Whether the shadow of the footprint's caster may reach samples of a tile.
  static bool may_touch(const Footprint& f, const Tile& tile) {
    return tile.count > 0 && f.z0 <= tile.z1 && f.x0 <= tile.x1 && f.x1 >= tile.x0 && f.y0 <= tile.y1 && f.y1 >= tile.y0;
  }
  void deal_casters();
  Tally walk_tile(std::size_t tile, std::span<float> mask, Scratch& scratch);
  /// By exact signs, if `clearly` does not settle it.
  bool occludes(const Caster& caster, std::uint32_t pixel, bool clearly, Tally& tally) const;
  /// Adds up the tests of the samples of a tile.
  void note_tests(const Tile& tile, Scratch& scratch);

  std::unique_ptr<Scratch> borrow_scratch();
  void return_scratch(std::unique_ptr<Scratch> scratch);

  const Scene* scene_ = nullptr;
  const GBuffer* gbuffer_ = nullptr;
  Light light_;
  glm::dvec4 homogeneous_{0};
  std::vector<Caster> casters_;
  std::vector<std::uint32_t> first_triangle_;  // of each mesh
  Bounds bounds_, all_bounds_;                 // of the casters, of all meshes
  Projection projection_;
  std::vector<Footprint> footprints_[6];  // of each face
  std::vector<std::int8_t> facing_;       // of each caster: 0 when edge-on
  Grid grid_;
  Dealt dealt_[6];  // footprints of each face to its tiles
  std::vector<std::uint8_t> dark_;
  std::vector<Found> found_;  // of each pixel
  Tally tally_;
  std::mutex mutex_;
  std::vector<std::unique_ptr<Scratch>> scratch_;  // not in use
};

void AliasFreeMap::build(const Scene& scene) {
  scene_ = &scene;
  bounds_ = {};
  all_bounds_ = scene.bounds();
  casters_.clear();
  first_triangle_.clear();
  std::size_t count = 0;
  for (const Mesh& mesh : scene.meshes) count += mesh.casts ? mesh.triangles.size() : 0;
  if (casters_.capacity() < count) casters_ = {};
  casters_.reserve(count);
  std::uint32_t first = 0;
  for (const Mesh& mesh : scene.meshes) {
    first_triangle_.push_back(first);
    if (mesh.casts)
      for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
        const glm::uvec3& corner = mesh.triangles[t];
        casters_.push_back({{mesh.positions[corner.x], mesh.positions[corner.y], mesh.positions[corner.z]}, first + t});
        for (const glm::vec3& p : casters_.back().points) bounds_.add(p);
      }
    first += static_cast<std::uint32_t>(mesh.triangles.size());
  }
}

void AliasFreeMap::relight(const Light& light) {
  light_ = light;
  homogeneous_ = homogeneous(light);
  projection_ = Projection(light, bounds_);
  double extent = 0;
  if (!all_bounds_.empty())
    for (int k = 0; k < 8; ++k) {
      const glm::vec3 &low = all_bounds_.min, &high = all_bounds_.max;
      const glm::vec3 corner((k & 1 ? high : low).x, (k & 2 ? high : low).y, (k & 4 ? high : low).z);
      extent = std::max(extent, norm1(projection_.seen(corner)));
    }
  facing_.resize(casters_.size());
  const std::size_t blocks = (casters_.size() + caster_block - 1) / caster_block;
  std::vector<std::vector<Footprint>> found[6];  // of each face and block
  for (auto& face : found) face.resize(blocks);
  for_blocks(casters_.size(), caster_block, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const glm::vec3* p = casters_[i].points;
      facing_[i] = static_cast<std::int8_t>(orient3d_sign(p[0], p[1], p[2], homogeneous_));
      if (facing_[i] == 0) continue;
      const glm::dvec3 corners[3] = {projection_.seen(p[0]), projection_.seen(p[1]), projection_.seen(p[2])};
      project(projection_, corners, extent, static_cast<std::uint32_t>(i),
              [&](int face, const Footprint& footprint) { found[face][begin / caster_block].push_back(footprint); });
    }
  });
  for (int face = 0; face < 6; ++face) {
    std::size_t count = 0;
    for (const auto& block : found[face]) count += block.size();
    footprints_[face].clear();
    if (footprints_[face].capacity() < count) footprints_[face] = {};
    footprints_[face].reserve(count);
    for (const auto& block : found[face]) footprints_[face].insert(footprints_[face].end(), block.begin(), block.end());
  }
}

void AliasFreeMap::resolve(const GBuffer& gbuffer, VisibilityMask& mask) {
  gbuffer_ = &gbuffer;
  const std::span<float> pixels = mask.pixels();
  found_.assign(gbuffer.size(), {});
  std::ranges::fill(pixels, 1.0f);
  grid_.fill(*scene_, gbuffer, light_, projection_, resolution);
  dark_.assign(grid_.capacity(), 0);
  deal_casters();
  std::vector<Tally> tallies(grid_.tiles().size());
  for_blocks(tallies.size(), 1, [&](std::size_t t, std::size_t) {
    if (grid_.tiles()[t].count == 0) return;
    std::unique_ptr<Scratch> scratch = borrow_scratch();
    tallies[t] = walk_tile(t, pixels, *scratch);
    return_scratch(std::move(scratch));
  });
  tally_ = {};
  for (const Tally& tally : tallies) tally_ += tally;
}

void AliasFreeMap::deal_casters() {
  for (int k = 0; k < 6; ++k) {
    const Grid::Face& face = grid_.face(k);
    const std::vector<Footprint>& footprints = footprints_[k];
    const int cells = grid_.cells();
    deal(footprints.size(), caster_block, static_cast<std::size_t>(face.tile_columns) * face.tile_rows, dealt_[k],
         [&](std::size_t i, auto&& visit) {
           const Footprint& f = footprints[i];
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

Tally AliasFreeMap::walk_tile(std::size_t t, std::span<float> mask, Scratch& scratch) {
  Tile& tile = grid_.tile(t);
  const Grid::Face& face = grid_.face(tile.face);
  const Dealt& dealt = dealt_[tile.face];
  const int cells = grid_.cells();
  const std::uint32_t* const begins = grid_.cell_begins(t);
  const std::uint32_t first = tile.first;
  scratch.runs.resize(cells);
  scratch.candidates.resize(std::max<std::size_t>(scratch.candidates.size(), tile.count + Grid::lanes));
  scratch.steps.assign(tile.count + 1, 0);
  for (std::size_t c = 0; c + 1 < grid_.begins_per_tile(); ++c)
    for (std::uint32_t k = begins[c]; k < begins[c + 1]; ++k) found_[grid_.pixel()[k]].list = begins[c + 1] - begins[c];

  Tally tally;
  std::uint32_t dark = 0;
  const std::size_t bin = t - face.first_tile;
  for (std::uint32_t place = dealt.begin[bin]; place < dealt.begin[bin + 1] && dark < tile.count; ++place) {
    const Footprint& footprint = footprints_[tile.face][dealt.items[place]];
    if (!may_touch(footprint, tile)) continue;
    const Caster& caster = casters_[footprint.caster];
    const Shadow shadow =
        make_shadow(projection_, tile.face, homogeneous_, caster.points, facing_[footprint.caster], tile.reach);
    const int runs = find_runs(face, tile, cells, begins, footprint, shadow, projection_.is_parallel(), scratch.runs.data());
    if (runs == 0) continue;
    ++tally.walked;
    for (int r = 0; r < runs; ++r) {
      const Run& run = scratch.runs[r];
      tally.tests += run.end - run.begin;
      ++scratch.steps[run.begin - first], --scratch.steps[run.end - first];
    }
    const std::uint32_t count =
        find_candidates(grid_.x(), grid_.y(), grid_.z(), scratch.runs.data(), runs, shadow, scratch.candidates.data());
    for (std::uint32_t k = 0; k < count; ++k) {
      const std::uint32_t i = scratch.candidates[k];
      if (dark_[i]) continue;
      const bool clearly = std::ranges::all_of(
          shadow.sides, [&](const Side& s) { return s.at(grid_.x()[i], grid_.y()[i], grid_.z()[i]) > 2 * s.error; });
      const std::uint32_t pixel = grid_.pixel()[i];
      if (!occludes(caster, pixel, clearly, tally)) continue;
      dark_[i] = 1, ++dark;
      mask[pixel] = 0;
      found_[pixel].occluder = caster.triangle;
    }
    // What is dark need not be asked again.
    if (2 * dark > tile.count) {
      note_tests(tile, scratch);
      grid_.remove_dark(t, dark_);
      dark = 0;
    }
  }
  note_tests(tile, scratch);
  return tally;
}

void AliasFreeMap::note_tests(const Tile& tile, Scratch& scratch) {
  std::int32_t tests = 0;
  for (std::uint32_t k = 0; k < tile.count; ++k) {
    tests += scratch.steps[k];
    found_[grid_.pixel()[tile.first + k]].tests += static_cast<std::uint32_t>(tests);
    scratch.steps[k] = 0;
  }
  scratch.steps[tile.count] = 0;
}

// As the oracle asks (kit/exact_scene.h): the own triangle and those exactly coplanar with it never occlude.
bool AliasFreeMap::occludes(const Caster& caster, std::uint32_t pixel, bool clearly, Tally& tally) const {
  const std::uint32_t first = first_triangle_[gbuffer_->mesh[pixel]];
  if (caster.triangle == first + gbuffer_->triangle[pixel]) return false;
  const ExactReceiver receiver = exact_receiver(*scene_, *gbuffer_, pixel);
  const Mesh& mesh = scene_->meshes[receiver.mesh];
  if (receiver.triangle == ExactReceiver::whole_mesh) {
    if (caster.triangle - first < mesh.triangles.size()) return false;
  }
  if (!clearly) {
    ++tally.exact;
    const Triangle triangle{{caster.points[0], caster.points[1], caster.points[2]}};
    if (crosses({receiver.point, homogeneous_}, triangle) == Crossing::none) return false;
  }
  if (receiver.triangle == ExactReceiver::whole_mesh) return true;
  const glm::uvec3& own = mesh.triangles[receiver.triangle];
  return !std::ranges::all_of(caster.points, [&](const glm::vec3& p) {
    return coplanar(mesh.positions[own.x], mesh.positions[own.y], mesh.positions[own.z], p);
  });
}

std::unique_ptr<Scratch> AliasFreeMap::borrow_scratch() {
  const std::lock_guard lock(mutex_);
  if (scratch_.empty()) return std::make_unique<Scratch>();
  std::unique_ptr<Scratch> scratch = std::move(scratch_.back());
  scratch_.pop_back();
  return scratch;
}

void AliasFreeMap::return_scratch(std::unique_ptr<Scratch> scratch) {
  const std::lock_guard lock(mutex_);
  scratch_.push_back(std::move(scratch));
}

Counts AliasFreeMap::counts() const {
  const auto held = [](const auto& v) { return v.capacity() * sizeof(v[0]); };
  std::size_t bytes = held(casters_) + held(facing_) + held(dark_) + held(found_) + grid_.bytes();
  for (int face = 0; face < 6; ++face) {
    bytes += held(footprints_[face]) + dealt_[face].bytes();
  }
  for (const auto& scratch : scratch_) bytes += scratch->bytes();
  const auto count = [](const char* name, auto value) { return Count{name, static_cast<double>(value), ""}; };
  return {count("samples", grid_.sample_count()),       count("cells_used", grid_.used_cell_count()),
          count("longest_list", grid_.longest_list()),  count("triangles_walked", tally_.walked),
          count("sample_tests", tally_.tests),          count("exact_tests", tally_.exact),
          {"bytes", static_cast<double>(bytes), "byte"}};
}

// The element is a triangle of the scene, counted mesh after mesh.
std::optional<Explanation> AliasFreeMap::explain(std::size_t index) const {
  if (!faces_light(*scene_, *gbuffer_, light_, index)) return std::nullopt;
  Explanation why;
  if (found_[index].occluder != nothing) why.element = found_[index].occluder;
  return why;
}

std::vector<float> AliasFreeMap::draw_debug(std::string_view layer) const {
  if (layer != "list" && layer != "tests") return Technique::draw_debug(layer);
  std::vector<float> values;
  values.reserve(found_.size());
  for (const Found& found : found_) values.push_back(static_cast<float>(layer == "list" ? found.list : found.tests));
  return heat_layer(*gbuffer_, values);
}

}  // namespace

GNOMON_TECHNIQUE(
    alias_free_map, AliasFreeMap,
    {.title = "Alias-free shadow map",
     .summary = "The visible points in a grid seen from the light, each tested against the triangles over its cell.",
     .source = "Aila and Laine 2004; Johnson et al. 2005; Wyman, Hoetzlein and Lefohn 2015",
     .error = "None on the float32 points it is given; tessellation on curved shapes.",
     .fails = "Nothing it supports; its cost depends on the view, and is highest where a shadow map would alias worst.",
     .promise = gnomon::Promise::exact,
     .sees = gnomon::Truth::mesh,
     .role = gnomon::Role::contender})
