// Every call: shadow rays to a grid of places, by a technique that overrides every function of the contract, declares a
// parameter of each type and fills in every line of a data sheet. Frozen at version 1.0: it must compile, unchanged, with
// every 1.x.
#include <gnomon/kit/rays/rays.h>
#include <gnomon/kit/shared.h>
#include <gnomon/registry.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

namespace {
using namespace gnomon;

constexpr OwnCause own_causes[] = {{.id = "few_places",
                                    .sentence = "The places of the light are too few for the width of the penumbra.",
                                    .color = {252, 0, 132}}};
constexpr Feature features[] = {Feature::alpha_masks, Feature::transmission};

constexpr About about{.title = "Every call",
                      .summary = "Shadow rays to a grid of places of the light, with every function of the contract.",
                      .source = "none",
                      .error = "None under lights without area; steps of one place in penumbrae.",
                      .fails = "Wide penumbrae with few places.",
                      .promise = Promise::sampled,
                      .sees = Truth::mesh,
                      .estimates = LightShareKind::area,
                      .role = Role::contender,
                      .device = Device::processor,
                      .floor = Floor::none,
                      .is_default = false,
                      .rasterizes = false,
                      .handles = features,
                      .causes = own_causes,
                      .lights = {},
                      .update_error = 0,
                      .remembers = false,
                      .named_only = false};

class EveryCall final : public Technique {
  Number<int> side{this,
                   "side",
                   4,
                   {.unit = "places", .min = 1, .max = 16, .log = true},
                   Stage::relight,
                   "Places along a side of a light with area."};
  Number<double> spread{
      this, "spread", 1, {.min = 0.5, .max = 1}, Stage::relight, "Share of the light's width that the places cover."};
  Choice at{this, "at", "centers", {"centers", "shifted"}, Stage::relight, "Where in its cell a place is."};
  Flag keep{this, "keep", true, Stage::resolve, "Keeps what was found at each place, for explanations."};

 public:
  Support supports(const Scene&, const Light& light, const View&) const override {
    if (std::holds_alternative<SphereLight>(light.kind))
      return Support::unsupported("a sphere has no places that all points see");
    if (has_area(light)) return Support::approximate("the light is a grid of places", Approximation{.most_wrong = 0.25});
    return hard_lights_only(light, "it has an area");
  }
  void setup() override { moved_ = 0; }
  void build(const Scene& scene) override {
    made_->scene = &scene;
    made_->casters.emplace(scene, Truth::mesh, RayScene::Which::casters);
    moved_ = 0;
  }
  void update(const Scene& scene, const Changes& changes) override {
    made_->scene = &scene;
    moved_ = 0;
    for (const MeshChange& change : changes.meshes) {
      if (change.kind == MeshChange::Kind::still) continue;
      Bounds both = change.before;
      both.add(change.after);
      if (change.count > 0 && !both.empty()) ++moved_;
    }
    if (!changes.empty()) made_->casters->update(changes);
  }
  void relight(const Light& light) override {
    light_ = light;
    places_ = places_of(light);
  }
  void resolve(const GBuffer& gbuffer, VisibilityMask& mask) override {
    gbuffer_ = &gbuffer;
    found_.clear();
    const std::span<float> pixels = mask.pixels();
    rays_ = 0;
    if (!has_area(light_)) {
      rays_ = trace_shadows(*made_->casters, *made_->scene, gbuffer, light_, pixels);
    } else {
      std::vector<float> sum(pixels.size(), 0.0f), count(pixels.size(), 0.0f), one(pixels.size());
      for (const glm::dvec3& place : places_) {
        const Light at_place = lamp_at(place);
        rays_ += trace_shadows(*made_->casters, *made_->scene, gbuffer, at_place, one);
        for (std::size_t i = 0; i < pixels.size(); ++i) {
          if (!faces_light(*made_->scene, gbuffer, at_place, i)) continue;
          sum[i] += one[i];
          count[i] += 1;
        }
        if (keep) found_.insert(found_.end(), one.begin(), one.end());
      }
      for (std::size_t i = 0; i < pixels.size(); ++i)
        pixels[i] = faces_light(*made_->scene, gbuffer, light_, i) && count[i] > 0 ? sum[i] / count[i] : 1.0f;
    }
    answer_.assign(pixels.begin(), pixels.end());
  }
  void forget() override { moved_ = 0; }
  Counts counts() const override {
    const double held =
        static_cast<double>(sizeof(float) * (answer_.size() + found_.size()) + sizeof(glm::dvec3) * places_.size());
    return {{"rays", static_cast<double>(rays_), ""},
            {"places", static_cast<double>(places_.size()), "", Count::Together::largest},
            {.name = "meshes_moved",
             .value = static_cast<double>(moved_),
             .unit = "",
             .together = Count::Together::mean,
             .is_by_tree = true},
            {"bytes", made_.own(static_cast<double>(made_->casters->bytes())) + held, "byte"}};
  }
  std::unique_ptr<Technique> for_another_light() const override { return another(*this, &EveryCall::made_); }
  std::optional<Explanation> explain(std::size_t index) const override {
    Explanation why;
    if (!faces_light(*made_->scene, *gbuffer_, light_, index)) return why;
    if (!has_area(light_)) {
      const glm::dvec3 point = gbuffer_->position(index), normal = gbuffer_->normal(index);
      const glm::dvec3 start = point + ray_offset(gbuffer_->position(index)) * normal;
      const RayScene::Hit hit = made_->casters->closest_caster(start, to_light(homogeneous(light_), start));
      if (hit.mesh != no_mesh && std::isfinite(hit.t)) why.element = std::uint64_t{hit.mesh} << 32 | hit.triangle;
      return why;
    }
    if (found_.empty()) return why;
    for (std::size_t k = 0; k < places_.size(); ++k)
      if (faces_light(*made_->scene, *gbuffer_, lamp_at(places_[k]), index))
        why.samples.push_back(LightSample{.place = places_[k], .weight = 1, .visibility = found_[k * answer_.size() + index]});
    for (LightSample& sample : why.samples) sample.weight = 1 / static_cast<double>(why.samples.size());
    why.cause = own_causes[0].id;
    return why;
  }
  std::vector<ErrorTerm> error_terms(std::span<const float> exact) override {
    ErrorTerm term{.cause = own_causes[0].id, .values = answer_};
    for (std::size_t i = 0; i < term.values.size(); ++i) term.values[i] -= exact[i];
    return {std::move(term)};
  }
  std::optional<DepthCurve> depth_curve(std::size_t) const override { return std::nullopt; }
  std::vector<std::uint32_t> image_parts() const override { return {}; }
  std::optional<SurfaceDetail> surface_detail() const override { return std::nullopt; }
  std::vector<DebugLayer> debug_layers() const override {
    return {{.name = "answer",
             .sentence = "The answer of each pixel.",
             .legend = {Swatch{"lit", {1, 1, 1}}, Swatch{"umbra", {0, 0, 0}}}}};
  }
  std::vector<float> draw_debug(std::string_view layer) const override {
    if (layer != "answer") return Technique::draw_debug(layer);
    std::vector<float> rgb;
    for (const float value : answer_) rgb.insert(rgb.end(), 3, value);
    return rgb;
  }
  std::optional<std::vector<float>> global_picture() const override { return std::nullopt; }

 private:
  struct Made {
    const Scene* scene = nullptr;
    std::optional<RayScene> casters;
  };

  Light lamp_at(const glm::dvec3& place) const {
    return Light{.name = light_.name, .kind = PointLight{.position = glm::vec3(place)}, .intensity = light_.intensity};
  }
  std::vector<glm::dvec3> places_of(const Light& light) const {
    std::vector<glm::dvec3> places;
    const int n = side;
    const double shift = at.is("shifted") ? 0.25 : 0.5;
    for (int k = 0; has_area(light) && k < n * n; ++k) {
      const double u = (k % n + shift) / n, v = (k / n + shift) / n;
      if (const auto* const rect = std::get_if<RectLight>(&light.kind)) {
        places.push_back(glm::dvec3(rect->center) +
                         spread.value() * ((2 * u - 1) * glm::dvec3(rect->half_u) + (2 * v - 1) * glm::dvec3(rect->half_v)));
      } else if (const auto* const disc = std::get_if<DiscLight>(&light.kind)) {
        const glm::dvec3 normal = glm::normalize(glm::dvec3(disc->normal));
        const glm::dvec3 across =
            glm::normalize(glm::cross(normal, std::abs(normal.x) < 0.5 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0)));
        const double r = spread.value() * disc->radius * std::sqrt(u), turn = 2 * std::numbers::pi * v;
        places.push_back(glm::dvec3(disc->center) +
                         r * (std::cos(turn) * across + std::sin(turn) * glm::cross(normal, across)));
      }
    }
    return places;
  }

  Shared<Made> made_;
  Light light_;
  std::vector<glm::dvec3> places_;
  const GBuffer* gbuffer_ = nullptr;
  std::vector<float> answer_, found_;
  std::size_t rays_ = 0;
  int moved_ = 0;
};

}  // namespace

GNOMON_TECHNIQUE(every_call, EveryCall, about)
