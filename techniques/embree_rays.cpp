// Shadow rays: one ray from every visible point to the light, traced by Embree. The reference.
// Source: Wald et al. 2014 (Embree); the ray recipe is measured, see docs/method.md.
// Error: none on the points it sees, away from rays that graze an edge closer than float32 rounding (class U).
// Fails: nowhere known; it is certified against exact_rays by `gnomon certify`.
#include <gnomon/kit/rays.h>
#include <gnomon/registry.h>

namespace gnomon {

class EmbreeRays final : public Technique {
 public:
  Support supports(const Scene&, const Light& light, const View&) const override {
    if (has_area(light)) return Support::unsupported("one ray per pixel cannot see part of an area light");
    return Support::full();
  }
  void setup() override {}
  void build(const Scene& scene) override {
    scene_ = &scene;
    casters_.emplace(scene, Truth::shape, RayScene::Which::casters);
    mesh_casters_.reset();
    // Which truth the G-buffer will have is not known here, and resolve must not build.
    if (scene.has_curved_shapes()) mesh_casters_.emplace(scene, Truth::mesh, RayScene::Which::casters);
  }
  void relight(const Light& light) override { light_ = light; }
  void resolve(const GBuffer& gbuffer, VisibilityMask& mask) override {
    const RayScene& casters = gbuffer.truth == Truth::mesh && mesh_casters_ ? *mesh_casters_ : *casters_;
    ray_count_ = trace_shadows(casters, *scene_, gbuffer, light_, mask.pixels());
  }
  Counts counts() const override {
    return {{"rays", static_cast<double>(ray_count_), ""},
            {"bytes", static_cast<double>(casters_->bytes() + (mesh_casters_ ? mesh_casters_->bytes() : 0)), "byte"}};
  }

 private:
  const Scene* scene_ = nullptr;
  Light light_;
  std::optional<RayScene> casters_, mesh_casters_;
  std::size_t ray_count_ = 0;
};

}  // namespace gnomon

GNOMON_TECHNIQUE(embree_rays, gnomon::EmbreeRays,
                 {.title = "Shadow rays",
                  .summary = "One shadow ray from every visible point to the light, traced by Embree in packets of 16.",
                  .source = "Wald et al. 2014",
                  .error = "None away from rays that graze an edge within float32 rounding (class U).",
                  .fails = "Nowhere known; certified against exact_rays.",
                  .promise = gnomon::Promise::exact,
                  .sees = gnomon::Truth::shape,
                  .role = gnomon::Role::reference})
