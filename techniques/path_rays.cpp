// Path rays: all light of the scene, by random paths from every visible point to the lamp.
#include <gnomon/kit/area/path_light.h>
#include <gnomon/kit/pictures/exposure.h>
#include <gnomon/kit/rays/ray_casters.h>
#include <gnomon/registry.h>

#include <algorithm>
#include <bit>

namespace {
using namespace gnomon;

constexpr About about{
    .title = "Path rays",
    .summary =
        "Random light paths from every visible point over diffuse surfaces, with a shadow ray to the light at each of their "
        "points.",
    .source =
        "Kajiya 1986 (rendering equation, path tracing); Arvo and Kirk 1990 (Russian roulette); Sobol 1967 and Owen 1995 (low "
        "discrepancy).",
    .error =
        "Noise, which falls with the number n of samples as n^-0.5; of the shadows alone as about n^-0.75. The layer `error` "
        "shows it. It estimates the share of the light's irradiance.",
    .fails =
        "Surfaces right beside a light with area, which a few paths find with far more light than all others; surfaces that "
        "reflect nearly all light, where paths are long.",
    .promise = Promise::sampled,
    .sees = Truth::shape,
    .estimates = LightShareKind::irradiance,
    .handles = with_alpha_masks};

class PathRays final : public Technique {
 public:
  Number<int> samples{this, "samples", 64, {"path", 16, 4096, true}, Stage::resolve, "Light paths of a pixel."};
  Choice ending =
      Choice(this, "ending", "roulette", {"roulette", "bounces"}, Stage::resolve,
             "What ends a path: chance, the sooner the darker its surfaces, so that all light counts on the mean; or a number "
             "of bounces.");
  Number<int> bounces =
      Number<int>(this, "bounces", 4, {"", 0, 100}, Stage::resolve,
                  "That number: how often light is sent on before it comes to what is seen; 0: direct light alone.");
  Number<int> seed{this, "seed", 1, {"", 0, 1000000}, Stage::resolve, "Other random numbers."};

  Support supports(const Scene& scene, const Light& light, const View&) const override {
    if (!has_area(light))
      return Support::unsupported("the light has no area, hence no radiance: this needs a rect, disc or sphere light");
    if (ending.is("bounces")) return Support::full();
    if (const auto why = endless_bounces(scene)) return Support::unsupported(*why + ", or ending=bounces");
    return Support::full();
  }
  void setup() override {}
  void build(const Scene& scene) override {
    built_->casters.build(scene);
    built_->has_more = !std::ranges::all_of(scene.meshes, &Mesh::casts);
    if (built_->has_more) built_->all.build(scene, RayScene::Which::seen);
  }
  void update(const Scene& scene, const Changes& changes) override {
    built_->casters.update(scene, changes);
    if (built_->has_more) built_->all.update(scene, changes);
  }
  void relight(const Light& light) override { light_ = light; }
  void resolve(const GBuffer& gbuffer, VisibilityMask& mask) override {
    gbuffer_ = &gbuffer;
    const Scene& scene = built_->casters.scene();
    const RayCasters& all = built_->has_more ? built_->all : built_->casters;
    const LightSurfaces surfaces{scene, all.under(gbuffer.truth), built_->casters.under(gbuffer.truth)};
    picture_ = trace_paths(surfaces, gbuffer, light_, options());
    const std::span<float> pixels = mask.pixels();
    for (std::size_t i = 0; i < pixels.size(); ++i) pixels[i] = receives(i) ? picture_.visibility[i] : 1.0f;
  }
  Counts counts() const override {
    const double surfaces = built_->casters.bytes() + (built_->has_more ? built_->all.bytes() : 0);
    const double picture = static_cast<double>(picture_.radiance.size() + picture_.error.size() + picture_.visibility.size());
    return {{"rays", static_cast<double>(picture_.rays), ""},
            {"bytes", built_.own(surfaces) + picture * sizeof(float), "byte"}};
  }
  std::unique_ptr<Technique> for_another_light() const override { return another(*this, &PathRays::built_); }
  std::optional<Explanation> explain(std::size_t index) const override {
    Explanation why;
    if (!receives(index)) return why;
    double sum = 0;
    const auto take = [&](const LightFigure& figure, const Squares& squares, const FaceHits& hits) {
      for (std::uint32_t left = hits.asked; left; left &= left - 1) {
        const int k = std::countr_zero(left);
        const glm::dvec2 place = figure.box().at({squares.x[k], squares.y[k]});
        why.samples.push_back(
            {glm::dvec3(gbuffer_->position(index)) + figure.at(place), hits.weight[k], hits.blocked >> k & 1 ? 0.0 : 1.0});
        sum += hits.weight[k];
      }
    };
    ask_first(built_->casters.under(gbuffer_->truth), *gbuffer_, index, light_, options(), take);
    for (LightSample& sample : why.samples) sample.weight /= sum;
    return why;
  }
  std::vector<DebugLayer> debug_layers() const override {
    return {
        {"global", "All light toward the eye, handed on by other surfaces included; 95 % of the lit pixels are below white."},
        {"standard_error", "Its standard error in the same light, ten times as bright."}};
  }
  std::vector<float> draw_debug(std::string_view layer) const override {
    if (layer == "global") return exposed(picture_.radiance);
    if (layer == "standard_error") return exposed(picture_.error, 10 * exposure(picture_.radiance));
    return Technique::draw_debug(layer);
  }
  std::optional<std::vector<float>> global_picture() const override { return picture_.radiance; }

 private:
  struct Built {
    RayCasters casters, all;
    bool has_more = false;  ///< than casters
  };

  PathOptions options() const {
    return {.samples = samples,
            .bounces = ending.is("bounces") ? std::optional<int>(bounces) : std::nullopt,
            .seed = static_cast<std::uint64_t>(seed)};
  }
  bool receives(std::size_t i) const {
    return !gbuffer_->is_background(i) && built_->casters.scene().meshes[gbuffer_->mesh[i]].receives;
  }

  const GBuffer* gbuffer_ = nullptr;
  Light light_;
  Shared<Built> built_;
  PathPicture picture_;
};

}  // namespace

GNOMON_TECHNIQUE(path_rays, PathRays, about)
