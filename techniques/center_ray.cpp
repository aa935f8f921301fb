// Center ray: the hard shadow of the center of a light with area.
#include <gnomon/kit/rays/ray_casters.h>
#include <gnomon/registry.h>

namespace {
using namespace gnomon;

constexpr About about{
    .title = "Center ray",
    .summary = "One shadow ray from every visible point to the center of a light with area.",
    .source = "none",
    .error = "No penumbra: what ignoring the light's size costs. It is taken for the share of the light's area.",
    .fails = "Wherever the light is large beside its distance from the caster.",
    .sees = Truth::shape,
    .role = Role::baseline,
    .handles = with_gray_transmission};

class CenterRay final : public Technique {
 public:
  Support supports(const Scene&, const Light& light, const View&) const override {
    if (!has_area(light)) return Support::unsupported("the light has no area: its shadows are hard, see embree_rays");
    return Support::approximate("the light's center stands for all of it");
  }
  void setup() override {}
  void build(const Scene& scene) override { casters_->build(scene); }
  void update(const Scene& scene, const Changes& changes) override { casters_->update(scene, changes); }
  void relight(const Light& light) override {
    center_ = light;
    center_.kind = PointLight{glm::vec3(homogeneous_of_center(light))};
  }
  void resolve(const GBuffer& gbuffer, VisibilityMask& mask) override {
    const RayScene& casters = casters_->under(gbuffer.truth);
    ray_count_ = trace_shadows(casters, casters_->scene(), gbuffer, center_, mask.pixels());
    answer_.assign(mask.pixels().begin(), mask.pixels().end());
  }
  Counts counts() const override { return ray_counts(casters_, ray_count_); }
  std::unique_ptr<Technique> for_another_light() const override { return another(*this, &CenterRay::casters_); }
  std::optional<Explanation> explain(std::size_t index) const override {
    Explanation why;
    why.samples = {{.place = glm::dvec3(homogeneous(center_)), .weight = 1, .visibility = answer_[index]}};
    return why;
  }

 private:
  std::vector<float> answer_;
  Light center_;
  Shared<RayCasters> casters_;
  std::size_t ray_count_ = 0;
};

}  // namespace

GNOMON_TECHNIQUE(center_ray, CenterRay, about)
