// Shadow volume tree: the shadow volumes of all triangles as planes of one tree, in which each visible point is located.
//
// Source: Gerhards et al. 2015, partitioned shadow volumes; of Mora et al. 2016 the ideas to pass by a tree that is farther
// from
//         the light than the point, and one whose triangles do not reach as far from the plane that they cross. What a triangle
//         shades is inside its three shadow planes and behind its own plane: four nodes. Each has a tree on either side and a
//         third one, visited from both, for triangles that lie across: they go there whole, nothing is ever split. Any
//         triangles will do, and memory is fixed.
// Error:  none on the float32 points that it is given: a sign that float32 does not prove is taken in double, and exactly where
//         that does not prove it either. A way to the light through an edge or a vertex is blocked. Tessellation on curved
//         shapes.
// Fails:  nothing it supports. A plane's third tree is visited from as far away as its largest triangle reaches; many small and
//         large ones side by side, and layer on layer as the light sees them, cost queries most.
#include <gnomon/kit/layers.h>
#include <gnomon/registry.h>

#include "shadow_volume_tree/order.h"
#include "shadow_volume_tree/tree.h"

namespace {
using namespace gnomon;
using namespace gnomon::shadow_volume_tree;

class ShadowVolumeTree final : public Technique {
 public:
  Choice order{
      this,
      "order",
      "large_first",
      {"large_first", "random", "scene", "near_first"},
      Stage::build,
      "Order of triangles: shuffled with the larger ones first, shuffled, the scene's, or nearest to the light first."};
  Number<int> seed{this,
                   "seed",
                   1,
                   {.min = 0, .max = 1'000'000},
                   Stage::build,
                   "Seed of the shuffle; it decides the shape of the tree, never an answer."};
  Flag early_out{this, "early_out", true, Stage::relight,
                 "Queries pass by trees that hold nothing as near to the light as their point."};
  Flag wedge{this, "wedge", true, Stage::relight,
             "Queries pass by the trees of triangles across a plane where none of these reaches as far from the plane."};

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
  std::vector<DebugLayer> debug_layers() const override {
    return {{"visits", "Nodes visited to locate each point: gray none, else colors as in the legend.", heat_legend()}};
  }
  std::vector<float> draw_debug(std::string_view layer) const override;

 private:
  Asked asked(const GBuffer& gbuffer, std::size_t i) const;
  /// Calls decide(pixel, stack, tally) for every pixel that faces the light, on all threads, tile by tile.
  template <class Decide>
  Tally for_pixels(const GBuffer& gbuffer, const Decide& decide) const;

  const Scene* scene_ = nullptr;
  const GBuffer* gbuffer_ = nullptr;
  Light light_;
  Bounds bounds_;                                         // of the casters
  bool is_sorted_ = false;                                // nearest first
  std::vector<Caster> casters_;                           // in order of insertion, but for `near_first`
  std::vector<std::uint32_t> first_triangle_;             // of each mesh
  std::vector<std::pair<float, std::uint32_t>> nearest_;  // for `near_first`
  Tree tree_;
  Tally tally_;
};

void ShadowVolumeTree::build(const Scene& scene) {
  scene_ = &scene;
  casters_.clear(), first_triangle_.clear();
  casters_.reserve(scene.triangle_count());
  bounds_ = {};
  is_sorted_ = order.is("near_first");
  std::uint32_t first = 0;
  for (std::uint32_t m = 0; m < scene.meshes.size(); ++m) {
    const Mesh& mesh = scene.meshes[m];
    first_triangle_.push_back(first);
    if (mesh.casts) {
      for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
        const glm::uvec3& v = mesh.triangles[t];
        casters_.push_back({{mesh.positions[v.x], mesh.positions[v.y], mesh.positions[v.z]}, m, first + t});
        for (const glm::vec3& p : casters_.back().corners) bounds_.add(p);
      }
    }
    first += static_cast<std::uint32_t>(mesh.triangles.size());
  }
  if (order.is("random") || order.is("large_first")) shuffle(casters_, static_cast<std::uint64_t>(seed.value()));
  if (order.is("large_first")) put_large_first(casters_);
  tree_.reserve(casters_.size());
}

void ShadowVolumeTree::relight(const Light& light) {
  light_ = light;
  const Frame frame(homogeneous(light), bounds_);
  // Edge-on triangles cast nothing.
  constexpr std::size_t block = 8192;
  std::vector<std::int8_t> facing(casters_.size());
  std::vector<std::size_t> begin((casters_.size() + block - 1) / block + 1, 0);
  for_blocks(casters_.size(), block, [&](std::size_t low, std::size_t high) {
    for (std::size_t i = low; i < high; ++i) {
      const glm::vec3* p = casters_[i].corners;
      facing[i] = static_cast<std::int8_t>(orient3d_sign(p[0], p[1], p[2], frame.light));
      begin[low / block + 1] += facing[i] != 0;
    }
  });
  for (std::size_t b = 1; b < begin.size(); ++b) begin[b] += begin[b - 1];

  if (is_sorted_) {
    nearest_.resize(casters_.size());
    for_blocks(casters_.size(), block, [&](std::size_t low, std::size_t high) {
      for (std::size_t i = low; i < high; ++i)
        nearest_[i] = {facing[i] != 0 ? frame.nearest(casters_[i]) : INFINITY, static_cast<std::uint32_t>(i)};
    });
    std::ranges::sort(nearest_);
  }
  const std::span<Caster> into = tree_.casters();
  for_blocks(casters_.size(), block, [&](std::size_t low, std::size_t high) {
    std::size_t next = is_sorted_ ? low : begin[low / block];
    for (std::size_t i = low; i < high; ++i) {
      const std::size_t from = is_sorted_ ? nearest_[i].second : i;
      if (facing[from] == 0) continue;
      into[next] = casters_[from];
      if (facing[from] < 0) std::swap(into[next].corners[1], into[next].corners[2]);
      into[next].steepness = frame.steepness(into[next]);
      ++next;
    }
  });
  tree_.grow(begin.back(), frame, early_out, wedge);
}

Asked ShadowVolumeTree::asked(const GBuffer& gbuffer, std::size_t i) const {
  const std::uint32_t m = gbuffer.mesh[i];
  const Mesh& mesh = scene_->meshes[m];
  Asked asked{.point = gbuffer.position(i)};
  // A curved body is convex: none shades a point of its own that faces the light.
  if (gbuffer.truth == Truth::shape && mesh.has_curved_shape()) {
    asked.own_mesh = m;
    return asked;
  }
  const glm::uvec3& corners = mesh.triangles[gbuffer.triangle[i]];
  asked.own_triangle = first_triangle_[m] + gbuffer.triangle[i];
  for (int k = 0; k < 3; ++k) asked.own[k] = mesh.positions[corners[k]];
  return asked;
}

template <class Decide>
Tally ShadowVolumeTree::for_pixels(const GBuffer& gbuffer, const Decide& decide) const {
  // Neighbors take much the same ways.
  constexpr int side = 16;
  const std::size_t columns = (gbuffer.width + side - 1) / side, rows = (gbuffer.height + side - 1) / side;
  std::vector<Tally> tallies(columns * rows);
  for_blocks(tallies.size(), 8, [&](std::size_t begin, std::size_t end) {
    Tree::Stack stack = tree_.make_stack();
    for (std::size_t tile = begin; tile < end; ++tile) {
      const int left = static_cast<int>(tile % columns) * side, top = static_cast<int>(tile / columns) * side;
      for (int y = top; y < std::min(top + side, gbuffer.height); ++y)
        for (int x = left; x < std::min(left + side, gbuffer.width); ++x) {
          const std::size_t i = static_cast<std::size_t>(y) * gbuffer.width + x;
          if (faces_light(*scene_, gbuffer, light_, i)) decide(i, stack, tallies[tile]);
        }
    }
  });
  Tally sum;
  for (const Tally& tally : tallies) sum += tally;
  return sum;
}

void ShadowVolumeTree::resolve(const GBuffer& gbuffer, VisibilityMask& mask) {
  gbuffer_ = &gbuffer;
  const std::span<float> pixels = mask.pixels();
  std::ranges::fill(pixels, 1.0f);
  tally_ = for_pixels(gbuffer, [&](std::size_t i, Tree::Stack& stack, Tally& tally) {
    if (tree_.occluder(asked(gbuffer, i), stack, tally) != none) pixels[i] = 0;
  });
}

Counts ShadowVolumeTree::counts() const {
  std::size_t bytes = casters_.capacity() * sizeof(Caster) + nearest_.capacity() * sizeof(nearest_[0]) + tree_.bytes();
  const auto count = [](const char* name, auto value) { return Count{name, static_cast<double>(value), ""}; };
  SignCounts signs = tree_.signs();
  signs += tally_.signs;
  return {count("triangles", tree_.triangles()),
          count("nodes", 4 * tree_.triangles()),
          count("depth", tree_.depth()),
          count("queries", tally_.queries),
          count("visits", static_cast<double>(tally_.visits) / static_cast<double>(std::max<std::uint64_t>(tally_.queries, 1))),
          count("longest_stack", tally_.longest_stack),
          count("signs_in_double", signs.in_double),
          count("signs_by_int128", signs.exact.lattice),
          count("signs_by_gmp", signs.exact.big),
          {"bytes", static_cast<double>(bytes), "byte"}};
}

std::optional<Explanation> ShadowVolumeTree::explain(std::size_t index) const {
  if (!faces_light(*scene_, *gbuffer_, light_, index)) return std::nullopt;
  Explanation why;
  Tree::Stack stack = tree_.make_stack();
  Tally tally;
  if (const std::uint32_t triangle = tree_.occluder(asked(*gbuffer_, index), stack, tally); triangle != none)
    why.element = triangle;
  return why;
}

std::vector<float> ShadowVolumeTree::draw_debug(std::string_view layer) const {
  if (layer != "visits") return Technique::draw_debug(layer);
  std::vector<float> visits(gbuffer_->size(), 0);
  for_pixels(*gbuffer_, [&](std::size_t i, Tree::Stack& stack, Tally& tally) {
    const std::uint64_t before = tally.visits;
    tree_.occluder(asked(*gbuffer_, i), stack, tally);
    visits[i] = static_cast<float>(tally.visits - before);
  });
  return heat_layer(*gbuffer_, visits);
}

}  // namespace

GNOMON_TECHNIQUE(
    shadow_volume_tree, ShadowVolumeTree,
    {.title = "Shadow volume tree",
     .summary = "The shadow volumes of all triangles, unsplit, in one tree of planes; each visible point is located in it.",
     .source = "Gerhards et al. 2015, Mora et al. 2016",
     .error = "None on the float32 points it is given; tessellation on curved shapes.",
     .fails = "Nothing it supports; large triangles among many small ones, layer on layer, cost queries most.",
     .promise = gnomon::Promise::exact,
     .sees = gnomon::Truth::mesh,
     .role = gnomon::Role::contender})
