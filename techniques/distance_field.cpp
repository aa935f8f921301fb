// Distance fields: a grid of signed distances for each caster, traced by steps as long as the least of them, and the penumbra
// from how near the way to the light comes to a caster.
#include <gnomon/kit/counts.h>
#include <gnomon/kit/parallel.h>
#include <gnomon/kit/pictures/layers.h>
#include <gnomon/kit/shared.h>
#include <gnomon/registry.h>

#include <atomic>

#include "distance_field/explaining.h"
#include "distance_field/sheets.h"
#include "distance_field/ways.h"

namespace {
using namespace gnomon;
using namespace gnomon::distance_field;

constexpr About about{
    .title = "Distance fields",
    .summary =
        "A grid of signed distances for each caster; a ray to the light's middle steps by the least of them, and how near it "
        "comes to a caster beside the width of the light's cone there tells the share that is seen.",
    .source = "Hart 1996 (sphere tracing); the share of a disc past a straight line is closed form.",
    .error =
        "Edges as of the grid: interpolated distances move a right edge of a body in by up to 0.42 voxel along its bisector, "
        "and a plate of thickness t below a voxel is lost at a share 1 - t of its positions. Under a light with area exact for "
        "one thick caster with a straight edge across the way, before a disc. A rectangle counts as the disc of its area. "
        "formula=smoothstep is off by up to 0.039 more, and formula=ratio by 0.25 in the mean of the penumbra: it has no inner "
        "half. Casters within a voxel of the point count only where the way comes nearer to them again. It estimates the share "
        "of the light's area, and sees triangles.",
    .fails =
        "Fences, leaves and open sheets: thinner than a voxel, and under a light with area without an umbra, because the way "
        "out of a thin caster is short. Casters beside one another before a light, of which the nearest counts alone; small "
        "ones, which hide no half of it. Where an open caster may hide the light it promises a mean error of at most a half.",
    .causes = causes,
    .named_only = true};

class DistanceField final : public Technique {
  Number<int> resolution = Number<int>(this, "resolution", 64, {.unit = "voxel", .min = 16, .max = 128, .log = true},
                                       Stage::build, "Voxels along the longest side of a caster's box.");
  Choice formula = Choice(this, "formula", "disc", {"disc", "smoothstep", "ratio"}, Stage::resolve,
                          "Share of a light with area from distance by width: what a straight line leaves of a disc; a cubic "
                          "for it; the ratio itself, without the inner half of the penumbra.");

 public:
  Support supports(const Scene& scene, const Light& light, const View&) const override {
    if (const std::size_t bytes = Fields::planned_bytes(scene, resolution); bytes > most_bytes)
      return Support::unsupported(fmt::format("the fields of its casters at resolution {} take {} MiB; at most {}",
                                              resolution.value(), bytes >> 20, most_bytes >> 20));
    if (!has_area(light))
      return Support::approximate("a grid of distances stands for each caster: what is thinner than a voxel is lost");
    const char* const why = "the nearest caster counts alone, as if its outline were straight and the light a disc";
    const Mesh* const sheet = set_formula() == Formula::ratio ? nullptr : sheet_in(scene, homogeneous_of_center(light));
    if (!sheet) return Support::approximate(why);
    return Support::approximate(fmt::format("{}; {} is open, and what is as thin has no umbra", why, sheet->name),
                                {.most_wrong = 0.5});
  }
  void setup() override {}
  void build(const Scene& scene) override {
    judge_.reset();
    built_->build(scene, resolution);
  }
  void update(const Scene& scene, const Changes& changes) override {
    judge_.reset();
    built_->update(scene, changes, resolution);
  }
  void relight(const Light& light) override {
    judge_.reset();
    light_ = light;
  }
  void resolve(const GBuffer& gbuffer, VisibilityMask& mask) override {
    gbuffer_ = &gbuffer;
    answer_.resize(gbuffer.size());
    steps_.resize(gbuffer.size());
    std::atomic<std::uint64_t> rays = 0, steps = 0;
    for_blocks(gbuffer.size(), 256, [&](std::size_t begin, std::size_t end) {
      std::uint64_t ray_count = 0, step_count = 0;
      Trace trace(*built_);
      for (std::size_t i = begin; i < end; ++i) {
        answer_[i] = 1;
        steps_[i] = 0;
        const std::optional<Way> way = way_of(*built_, gbuffer, light_, i);
        if (!way) continue;
        trace.follow(*way);
        answer_[i] = static_cast<float>(share_seen(set_formula(), trace.least()));
        steps_[i] = static_cast<std::uint16_t>(std::min(trace.steps(), 65535u));
        ++ray_count;
        step_count += trace.steps();
      }
      rays += ray_count;
      steps += step_count;
    });
    ray_count_ = rays;
    step_count_ = steps;
    std::ranges::copy(answer_, mask.pixels().begin());
  }
  Counts counts() const override {
    return {
        count_of("rays", ray_count_),
        mean_of("steps_per_ray", step_count_, ray_count_),
        {"voxels", built_.own(static_cast<double>(built_->sample_count())), ""},
        {"bytes", built_.own(static_cast<double>(built_->bytes())) + static_cast<double>(bytes_of(answer_, steps_)), "byte"}};
  }
  std::unique_ptr<Technique> for_another_light() const override { return another(*this, &DistanceField::built_); }
  std::optional<Explanation> explain(std::size_t index) const override {
    Explanation why;
    const std::optional<Way> way = way_of(*built_, *gbuffer_, light_, index);
    if (!way) return why;
    if (!judge_) judge_ = std::make_unique<Judge>(*built_, light_);
    const Judge::Question question{*gbuffer_, index, *way, set_formula(), answer_[index]};
    why.formula_differs = judge_->is_of_formula(question);
    if (!why.formula_differs) why.cause = judge_->cause(question);
    return why;
  }
  std::vector<DebugLayer> debug_layers() const override {
    return {heat_debug_layer("steps", "Steps of the ray from each point"),
            heat_debug_layer("distance",
                             "How far the own field says that each point is from its surface, in sixteenths of a voxel (0 "
                             "is right, -8 on an open mesh; red is within)"),
            heat_debug_layer("lost",
                             "Where the own field says outside half a voxel below the surface, in sixteenths of a voxel: what "
                             "is too thin for it")};
  }
  std::vector<float> draw_debug(std::string_view layer) const override {
    if (layer == "steps") return heat_layer(*gbuffer_, std::vector<float>(steps_.begin(), steps_.end()));
    if (layer == "distance") return heat_of_own(0, -INFINITY);
    if (layer == "lost") return heat_of_own(0.5, 0);
    return Technique::draw_debug(layer);
  }

 private:
  static constexpr std::size_t most_bytes = std::size_t{1} << 30;
  static constexpr Formula formulas[] = {Formula::disc, Formula::smoothstep, Formula::ratio};

  Formula set_formula() const { return formulas[formula.index()]; }

  /// The distance by the own field so many voxels below each point, in sixteenths of a voxel; `least` where it is less, and 0
  /// of points that are on no caster.
  std::vector<float> heat_of_own(double below, double least) const {
    std::vector<float> values(gbuffer_->size(), 0);
    for (std::size_t i = 0; i < values.size(); ++i) {
      const std::uint32_t caster = gbuffer_->is_background(i) ? no_caster : built_->of_mesh(gbuffer_->mesh[i]);
      if (caster == no_caster) continue;
      const double voxel = built_->voxel(caster);
      const glm::dvec3 p = glm::dvec3(gbuffer_->position(i)) - below * voxel * glm::dvec3(gbuffer_->normal(i));
      values[i] = static_cast<float>(std::max(16 * built_->distance(caster, p) / voxel, least));
    }
    return heat_layer(*gbuffer_, values);
  }

  Shared<Fields> built_;
  Light light_;
  const GBuffer* gbuffer_ = nullptr;  // of the last resolve
  std::vector<float> answer_;         // likewise
  std::vector<std::uint16_t> steps_;  // likewise
  std::uint64_t ray_count_ = 0, step_count_ = 0;
  mutable std::unique_ptr<Judge> judge_;  // made by the first explanation after a relight
};

}  // namespace

GNOMON_TECHNIQUE(distance_field, DistanceField, about)
