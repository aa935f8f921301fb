// Shadow volume tree: the shadow volumes of all triangles as planes of one tree, in which each visible point is located.
//
// What a triangle shades is inside its three shadow planes and behind its own plane: four nodes. Each has a tree on either side
// and a third one, visited from both, for triangles that lie across: they go there whole, nothing is ever split. Any triangles
// will do, and memory is fixed. A query that meets a triangle in a hole, or glass, goes on into all of its trees.
#include <gnomon/kit/bases/point_technique.h>
#include <gnomon/kit/geometry/light_through.h>
#include <gnomon/kit/random.h>
#include <gnomon/registry.h>

#include "shadow_volume_tree/tree.h"

namespace {
using namespace gnomon;
using namespace gnomon::shadow_volume_tree;

constexpr About about{
    .title = "Shadow volume tree",
    .summary = "The shadow volumes of all triangles, unsplit, in one tree of planes; each visible point is located in it.",
    .source =
        "Gerhards et al. 2015, partitioned shadow volumes; of Mora et al. 2016 the ideas to pass by a tree that is farther "
        "from the light than the point, and one whose triangles do not reach as far from the plane that they cross",
    .error =
        "None on the float32 points it is given: a sign that float32 does not prove is taken in double, and exactly where "
        "that does not prove it either. A way to the light through an edge or a vertex is blocked. The texels of "
        "alpha masks and glass are exact, and behind glass a point gets the product of what all of it lets through. "
        "Tessellation on curved shapes.",
    .fails =
        "Nothing it supports. A plane's third tree is visited from as far away as its largest triangle reaches; many small "
        "and large ones side by side, and layer on layer as the light sees them, cost queries most. So do layers of holes "
        "and of glass: a triangle does not end the queries that go through its holes, and glass ends none.",
    .promise = Promise::exact,
    .handles = with_gray_transmission};

class ShadowVolumeTree final : public PointTechnique {
 public:
  Choice order =
      Choice(this, "order", "large_first", {"large_first", "random", "scene", "near_first"}, Stage::build,
             "Order of triangles: shuffled with the larger ones first, shuffled, the scene's, or nearest to the light first.");
  Number<int> seed = Number<int>(this, "seed", 1, {.min = 0, .max = 1'000'000}, Stage::build,
                                 "Seed of the shuffle; it decides the shape of the tree, never an answer.");
  Flag early_out{this, "early_out", true, Stage::relight,
                 "Queries pass by trees that hold nothing as near to the light as their point."};
  Flag wedge{this, "wedge", true, Stage::relight,
             "Queries pass by the trees of triangles across a plane where none of these reaches as far from the plane."};

  void build(const Scene& scene) override {
    remember(scene);
    built_->casters.clear();
    built_->casters.reserve(scene.triangle_count());
    built_->bounds = {};
    built_->is_sorted = order.is("near_first");
    for_triangles(scene,
                  [&](const glm::vec3& a, const glm::vec3& b, const glm::vec3& c, std::uint32_t mesh, std::uint32_t number) {
                    const Mesh& of = scene.meshes[mesh];
                    if (!of.casts) return;
                    built_->casters.push_back({{a, b, c}, of.alpha_mask || of.transmission ? no_mesh : mesh, number});
                    for (const glm::vec3& p : {a, b, c}) built_->bounds.add(p);
                  });
    if (order.is("random") || order.is("large_first")) Random(static_cast<std::uint64_t>(seed)).shuffle(built_->casters);
    if (order.is("large_first")) put_large_first(built_->casters);
  }

  void relight(const Light& light) override {
    light_ = light;
    const Frame frame(homogeneous(light), built_->bounds);
    tree_.reserve(built_->casters.size());
    // Edge-on triangles cast nothing.
    constexpr std::size_t block = 8192;
    std::vector<std::int8_t> facing;
    find_facing(built_->casters, frame.light, facing);
    std::vector<std::size_t> begin((built_->casters.size() + block - 1) / block + 1, 0);
    for (std::size_t i = 0; i < facing.size(); ++i) begin[i / block + 1] += facing[i] != 0;
    for (std::size_t b = 1; b < begin.size(); ++b) begin[b] += begin[b - 1];

    if (built_->is_sorted) {
      nearest_.resize(built_->casters.size());
      for_blocks(built_->casters.size(), block, [&](std::size_t low, std::size_t high) {
        for (std::size_t i = low; i < high; ++i)
          nearest_[i] = {facing[i] != 0 ? frame.nearest(built_->casters[i]) : INFINITY, static_cast<std::uint32_t>(i)};
      });
      std::ranges::sort(nearest_);
    }
    const std::span<Caster> into = tree_.casters();
    for_blocks(built_->casters.size(), block, [&](std::size_t low, std::size_t high) {
      std::size_t next = built_->is_sorted ? low : begin[low / block];
      for (std::size_t i = low; i < high; ++i) {
        const std::size_t from = built_->is_sorted ? nearest_[i].second : i;
        if (facing[from] == 0) continue;
        into[next] = built_->casters[from];
        if (facing[from] < 0) std::swap(into[next].points[1], into[next].points[2]);
        into[next].steepness = frame.steepness(into[next]);
        ++next;
      }
    });
    tree_.grow(begin.back(), frame, early_out, wedge);
  }

  void resolve(const GBuffer& gbuffer, VisibilityMask& mask) override {
    gbuffer_ = &gbuffer;
    const std::span<float> pixels = mask.pixels();
    std::ranges::fill(pixels, 1.0f);
    work_ = for_facing_pixels(gbuffer, tree_.make_work(), [&](std::size_t i, QueryWork& work) {
      if (locate(gbuffer, i, work) != nothing)
        pixels[i] = 0;
      else if (!work.glass.empty())
        pixels[i] = through(i, work.glass).share;
    });
  }

  Counts counts() const override {
    const std::size_t bytes = bytes_of(nearest_) + tree_.bytes();
    SignCounts signs = tree_.signs();
    signs += work_.signs;
    return {count_of("triangles", tree_.triangles()),
            count_of("nodes", 4 * tree_.triangles()),
            most_of("depth", tree_.depth()),
            count_of("queries", work_.queries),
            mean_of("visits", work_.visits, work_.queries),
            most_of("longest_stack", work_.longest_stack),
            count_of("signs_in_double", signs.in_double),
            count_of("signs_by_int128", signs.exact.lattice),
            count_of("signs_by_gmp", signs.exact.big),
            {"bytes", static_cast<double>(bytes) + built_.own(static_cast<double>(bytes_of(built_->casters))), "byte"}};
  }

  std::vector<DebugLayer> debug_layers() const override {
    return {heat_debug_layer("visits", "Nodes visited to locate each point")};
  }
  std::vector<float> draw_debug(std::string_view layer) const override {
    if (layer != "visits") return Technique::draw_debug(layer);
    return heat_of([&](std::size_t i) {
      QueryWork work = tree_.make_work();
      locate(*gbuffer_, i, work);
      return work.visits;
    });
  }

  std::unique_ptr<Technique> for_another_light() const override {
    return another(*this, &ShadowVolumeTree::remembered_, &ShadowVolumeTree::built_);
  }

 private:
  const char* why_no_area() const override {
    return "a shadow plane goes through one point: it cannot see part of an area light";
  }
  std::uint32_t shading_triangle(std::size_t index) const override {
    QueryWork work = tree_.make_work();
    const std::uint32_t opaque = locate(*gbuffer_, index, work);
    return opaque != nothing ? opaque : through(index, work.glass).triangle;
  }
  LightThrough through(std::size_t index, Crossings& glass) const {
    const Segment segment{gbuffer_->position(index), homogeneous(light_)};
    return light_through(glass, *remembered_->scene, remembered_->numbers, segment);
  }
  /// The opaque triangle that shades a pixel, or `nothing`.
  std::uint32_t locate(const GBuffer& gbuffer, std::size_t i, QueryWork& work) const {
    return tree_.shading_triangle(*remembered_->scene, receiver(gbuffer, i), work, remembered_->numbers);
  }

  struct Built {
    Bounds bounds;                // of the casters
    bool is_sorted = false;       // nearest first
    std::vector<Caster> casters;  // in order of insertion, but for `near_first`
  };
  Shared<Built> built_;
  std::vector<std::pair<float, std::uint32_t>> nearest_;  // for `near_first`
  Tree tree_;
  QueryWork work_;
};

}  // namespace

GNOMON_TECHNIQUE(shadow_volume_tree, ShadowVolumeTree, about)
