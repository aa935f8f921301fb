// Crow's counting of shadow volumes: on the way from the eye to a point, volumes entered minus volumes left, front to back.
#include <gnomon/kit/bases/point_technique.h>
#include <gnomon/kit/geometry/light_through.h>
#include <gnomon/kit/pictures/lines.h>
#include <gnomon/kit/random.h>
#include <gnomon/registry.h>

#include "crow_counting/ways.h"

namespace {
using namespace gnomon;
using namespace gnomon::crow_counting;

constexpr About about{
    .title = "Crow's counting of shadow volumes",
    .summary =
        "Shadow volumes entered and left on the way from the eye to each visible point, sorted and counted front to back.",
    .source =
        "Crow 1977; the front-to-back count of the lecture notes, with the rule put right: a point is in shadow if and "
        "only if eye + entered - left > 0, where eye is the number of volumes that hold the eye (>= 0 would shadow "
        "everything).",
    .error =
        "None on the float32 points that it is given: a crossing that double cannot decide is decided by exact signs. A way "
        "through the border of a side quad is counted anew from a start beside the eye. A point on such a border, whose way "
        "to the light goes exactly through an edge, is dark. Of a closed body only the half that faces the light counts, and "
        "the other half is counted at points close to an edge alone: a point that rounding put through its own triangle and "
        "out of the body behind it may be lit where it is 64 times as far from the edges of that triangle as it is behind "
        "it. A triangle with an alpha mask or of glass has a volume of its own: a point in it is dark where the texel on its "
        "way to the light is solid, and gets the product of what all glass on its way lets through, which is exact, too. "
        "Tessellation on curved shapes.",
    .fails =
        "Nothing it supports; the work grows with the length of the silhouette's shadow on the screen. Casters with holes or "
        "of glass are not counted but met one by one, so that they show nothing of what counting costs. A closed body that "
        "passes through itself inside out may be taken for empty.",
    .promise = Promise::exact,
    .handles = with_gray_transmission};

// Side quads are infinite and weigh what their edges count, so that open and inconsistently wound meshes and layers are right;
// light caps are the triangles that face the light. A dark cap at infinity is never on the way. Points that the count leaves
// lit are then located in the volumes of the single casters, with alpha masks or transmission.
class CrowCounting final : public PointTechnique {
 public:
  void build(const Scene& scene) override {
    remember(scene);
    volumes_.build(scene);
    own_->build(scene, remembered_->numbers);
    single_->build(scene, remembered_->numbers);
  }
  void update(const Scene& scene, const Changes& changes) override {
    volumes_.update(scene, changes);
    own_->update(changes);
    single_->update(scene, remembered_->numbers, changes);
  }
  void relight(const Light& light) override {
    light_ = light;
    volumes_.relight(light);
  }
  void resolve(const GBuffer& gbuffer, VisibilityMask& mask) override {
    gbuffer_ = &gbuffer;
    const double size = remembered_->scene->bounds().extent();
    counter_.begin(*remembered_->scene, size, gbuffer, light_, volumes_, *own_, mask.pixels());

    // The count at a point does not depend on its start: where a start is in line with the border of a volume, another one
    // beside it gives the same count. A point without a count from any of many starts lies on a border itself.
    const glm::vec3 eye = gbuffer.view.eye;
    const auto beside = static_cast<float>(0x1p-12 * std::max(size, extent(eye)));
    Random random(1977);
    std::size_t left = 1;
    for (int attempt = 0; attempt < 16 && left > 0; ++attempt) {
      glm::vec3 start = eye;
      if (attempt > 0) start += beside * glm::vec3(random.uniform(glm::dvec3(-1), glm::dvec3(1)));
      const EdgeAdjacency::Depth depth = volumes_.adjacency().depth_at(start, volumes_.silhouette());
      if (attempt == 0) volumes_at_eye_ = depth.volumes;
      if (!depth.degenerate) left = counter_.count_from(Frame(gbuffer.view, start), depth.volumes);
    }
    counter_.darken_rest();
    find_single(mask.pixels());
  }

  Counts counts() const override {
    const CountingWork& work = counter_.work();
    const auto rays = static_cast<double>(std::max<std::uint64_t>(work.rays, 1));
    const auto shared_bytes = static_cast<double>(own_->bytes() + remembered_->numbers.bytes() + single_->bytes());
    Counts all{count_of("silhouette_edges", volumes_.silhouette().edges.size()),
               count_of("polygons", volumes_.count()),
               count_of("volumes_at_eye", volumes_at_eye_),
               count_of("rays", work.rays),
               count_of("crossings", work.crossings),
               count_of("crossings_per_ray", static_cast<double>(work.crossings) / rays),
               count_of("longest_list", work.longest),
               count_of("deepest", work.deepest),
               count_of("crossing_tests", work.tests),
               count_of("exact_tests", work.exact),
               count_of("restarts", work.again),
               count_of("degenerate_rays", work.touching),
               {"bytes", static_cast<double>(volumes_.bytes() + counter_.bytes() + bytes_of(shares_)) + own_.own(shared_bytes),
                "byte"}};
    if (single_->empty()) return all;
    // The names are as old as masks: kept results have them.
    all.push_back(count_of("masked_points", single_work_.points));
    all.push_back(count_of("masked_tests", single_work_.tests));
    return all;
  }

  std::vector<DebugLayer> debug_layers() const override {
    return {{"crossings", "Faces crossed on the way to each point: gray none, else colors as in the legend.", heat_legend()},
            {"depth", "Shadow volumes of opaque casters around each point: gray none, else colors as in the legend.",
             heat_legend()},
            silhouette_layer()};
  }
  std::unique_ptr<Technique> for_another_light() const override {
    return another(*this, &CrowCounting::remembered_, &CrowCounting::volumes_, &CrowCounting::own_, &CrowCounting::single_);
  }
  std::vector<float> draw_debug(std::string_view layer) const override {
    const std::span<const PixelCount> found = counter_.found();
    if (layer == "crossings" || layer == "depth")
      return heat_of([&](std::size_t i) { return layer == "depth" ? found[i].depth : found[i].crossings; });
    if (layer != "silhouette") return Technique::draw_debug(layer);
    std::vector<float> mask;
    for (const PixelCount& pixel : found) mask.push_back(pixel.depth > 0 ? 0.0f : share(mask.size()));
    std::vector<float> picture = shaded_layer(*remembered_->scene, *gbuffer_, light_, mask);
    draw_lines(silhouette_lines(volumes_.adjacency(), volumes_.silhouette()), *gbuffer_, picture);
    return picture;
  }

 private:
  const char* why_no_area() const override { return "a shadow volume has one apex: it cannot see part of an area light"; }
  /// A caster with holes that blocks the way, or the glass that lets least through where nothing blocks it. Else a volume is
  /// named by the polygon through which it was entered: a triangle of the scene or, from the number of triangles on, an edge of
  /// the silhouette.
  std::uint32_t shading_triangle(std::size_t index) const override {
    if (!single_->empty()) {
      SingleWork work;
      const std::uint32_t single = single_->on_way(receiver(*gbuffer_, index), homogeneous(light_), work);
      if (single != SingleCasters::none) return single;
      if (share(index) < 1) return through(index, work.glass).triangle;
    }
    const std::uint32_t entered = counter_.found()[index].entered;
    if (entered == no_polygon) return nothing;
    if (!volumes_.is_side(entered)) return volumes_.cap(entered);
    return static_cast<std::uint32_t>(remembered_->scene->triangle_count()) + entered;
  }

  /// Darkens the lit pixels whose way to the light a single caster blocks, and those behind glass by what it lets through.
  void find_single(std::span<float> mask) {
    single_work_ = {};
    shares_.assign(single_->has_transmission() ? mask.size() : 0, 1.0f);
    if (single_->empty()) return;
    const glm::dvec4 light = homogeneous(light_);
    single_work_ = for_facing_pixels(*gbuffer_, SingleWork{}, [&](std::size_t i, SingleWork& work) {
      if (mask[i] == 0) return;
      if (single_->on_way(receiver(*gbuffer_, i), light, work) != SingleCasters::none)
        counter_.add_volume(i);
      else if (!work.glass.empty())
        mask[i] = shares_[i] = through(i, work.glass).share;
    });
  }
  LightThrough through(std::size_t index, Crossings& glass) const {
    const Segment segment{gbuffer_->position(index), homogeneous(light_)};
    return light_through(glass, *remembered_->scene, remembered_->numbers, segment);
  }
  /// What glass lets through where nothing opaque is on the way.
  float share(std::size_t index) const { return shares_.empty() ? 1 : shares_[index]; }

  Volumes volumes_;
  Shared<OwnVolumes> own_;
  Shared<SingleCasters> single_;
  SingleWork single_work_;
  std::vector<float> shares_;  // of each pixel; empty without transmission
  WayCounter counter_;
  std::int64_t volumes_at_eye_ = 0;
};

}  // namespace

GNOMON_TECHNIQUE(crow_counting, CrowCounting, about)
