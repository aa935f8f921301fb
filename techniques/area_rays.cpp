// Area rays: shadow rays from every visible point to a number of places of the light.
#include <gnomon/kit/area/light_points.h>
#include <gnomon/kit/parallel.h>
#include <gnomon/kit/rays/ray_casters.h>
#include <gnomon/registry.h>

#include <atomic>
#include <bit>

namespace {
using namespace gnomon;

constexpr About about{
    .title = "Area rays",
    .summary = "Shadow rays from every visible point to a fixed number of places of the light, each counting as much.",
    .source =
        "Cook, Porter and Carpenter 1984 (random, stratified); Keller and Heidrich 2001 (interleaved); Sobol 1967 and Owen "
        "1995 (low discrepancy).",
    .error =
        "Noise, which falls with the number n of samples as n^-0.5 where they are random and as about n^-0.75 where they are "
        "spread evenly; banding instead of noise where neighbors share their places. It estimates the share of the light's "
        "area.",
    .fails = "A penumbra of few samples: behind opaque casters n of them tell n + 1 shares apart.",
    .promise = Promise::sampled,
    .sees = Truth::shape,
    .handles = with_gray_transmission};

class AreaRays final : public Technique {
 public:
  Number<int> samples{this, "samples", 64, {"ray", 1, 4096, true}, Stage::resolve, "Rays from a point to the light."};
  Choice pattern =
      Choice(this, "pattern", "low_discrepancy", pattern_names(), Stage::resolve,
             "Where they go: anywhere; one into each of as many cells; a sequence that fills the light evenly; the same "
             "sequence, scrambled alike for every fourth pixel along x and y.");
  Number<int> seed{this, "seed", 1, {"", 0, 1000000}, Stage::resolve, "Other random numbers."};

  Support supports(const Scene&, const Light& light, const View&) const override {
    if (!has_area(light)) return Support::unsupported("the light has no area: its shadows are hard, see embree_rays");
    return Support::full();
  }
  void setup() override {}
  void build(const Scene& scene) override { casters_->build(scene); }
  void update(const Scene& scene, const Changes& changes) override { casters_->update(scene, changes); }
  void relight(const Light& light) override { light_ = light; }
  void resolve(const GBuffer& gbuffer, VisibilityMask& mask) override {
    gbuffer_ = &gbuffer;
    const std::span<float> pixels = mask.pixels();
    std::atomic<std::size_t> ray_count = 0;
    for_blocks(gbuffer.size(), 256, [&](std::size_t begin, std::size_t end) {
      std::size_t rays = 0;
      for (std::size_t i = begin; i < end; ++i) pixels[i] = visibility(gbuffer, i, rays);
      ray_count += rays;
    });
    ray_count_ = ray_count;
  }
  Counts counts() const override { return ray_counts(casters_, ray_count_); }
  std::unique_ptr<Technique> for_another_light() const override { return another(*this, &AreaRays::casters_); }
  std::optional<Explanation> explain(std::size_t index) const override {
    Explanation why;
    ask(*gbuffer_, index, [&](const LightFigure& figure, const Squares& squares, const FaceHits& hits) {
      for (std::uint32_t left = hits.asked; left; left &= left - 1) {
        const int k = std::countr_zero(left);
        const glm::dvec2 place = figure.box().at({squares.x[k], squares.y[k]});
        why.samples.push_back({glm::dvec3(gbuffer_->position(index)) + figure.at(place), 1, hits.seen(k)});
      }
    });
    for (LightSample& sample : why.samples) sample.weight /= static_cast<double>(why.samples.size());
    return why;
  }

 private:
  /// Traces to the places of pixel i, sixteen at a time: `use(figure, squares, hits)`. Nothing of a pixel that does not face
  /// the light.
  template <class Use>
  void ask(const GBuffer& gbuffer, std::size_t i, const Use& use) const {
    if (gbuffer.is_background(i) || !casters_->scene().meshes[gbuffer.mesh[i]].receives) return;
    const LightFigure figure(light_, gbuffer.position(i), gbuffer.normal(i));
    if (!figure.is_seen()) return;
    const FaceRays to_light(casters_->under(gbuffer.truth), gbuffer, i, figure);
    const std::size_t x = i % gbuffer.width, y = i / gbuffer.width;
    PatternPlaces places(pattern.value(), samples, places_seed(seed, pattern.is("interleaved") ? interleaved_set(x, y) : i));
    for (int first = 0; first < samples; first += 16) {
      const std::uint32_t wanted = samples - first >= 16 ? 0xffffu : (1u << (samples - first)) - 1;
      const Squares squares = places_on(figure, places.next(static_cast<std::uint32_t>(first / 16)));
      use(figure, squares, to_light.ask(squares, wanted));
    }
  }

  float visibility(const GBuffer& gbuffer, std::size_t i, std::size_t& rays) const {
    int asked = 0;
    double hidden = 0;
    bool is_dimmed = false;
    ask(gbuffer, i, [&](const LightFigure&, const Squares&, const FaceHits& hits) {
      asked += std::popcount(hits.asked);
      hidden += hits.hidden_count();
      is_dimmed |= hits.dimmed != 0;
    });
    rays += static_cast<std::size_t>(asked);
    // Parts of rays are no whole numbers: only the share is rounded to float32, as the reference's is.
    if (is_dimmed) return static_cast<float>(1 - hidden / asked);
    return asked == 0 ? 1.0f : 1.0f - static_cast<float>(hidden) / static_cast<float>(asked);
  }

  const GBuffer* gbuffer_ = nullptr;
  Light light_;
  Shared<RayCasters> casters_;
  std::size_t ray_count_ = 0;
};

}  // namespace

GNOMON_TECHNIQUE(area_rays, AreaRays, about)
