// Shadow rays: one ray from every visible point to the light, or as many as a light with area needs, traced by Embree. The
// reference.
#include <gnomon/kit/area/area_rays.h>
#include <gnomon/kit/rays/ray_casters.h>
#include <gnomon/registry.h>

namespace {
using namespace gnomon;

constexpr About about{
    .title = "Shadow rays",
    .summary =
        "One shadow ray from every visible point to the light, or rays to as many places of a light with area as its "
        "share needs, traced by Embree in packets of 16.",
    .source = "Wald et al. 2014 (Embree); Owen 1995 (places of the light); the ray recipe is measured, see docs/method.md.",
    .error =
        "None on the points it sees, away from rays that graze an edge closer than float32 rounding (class U). Under a light "
        "with area a standard error of 0.002, where 8192 places suffice. Rays go through the holes of alpha "
        "masks, and behind glass a point gets the product of what all of it lets through, each looked up from the point and "
        "the light.",
    .fails = "Nowhere known; it is certified against exact_rays and exact_area by gnomon certify.",
    .promise = Promise::exact,
    .sees = Truth::shape,
    .role = Role::reference,
    .handles = with_gray_transmission};

constexpr double least_extent = 1e-19;  ///< largest coordinate of a scene, meters

class EmbreeRays final : public Technique {
 public:
  Support supports(const Scene& scene, const Light&, const View&) const override {
    // Below, squares of lengths leave float32.
    if (const double extent = scene.bounds().extent(); extent > 0 && extent < least_extent)
      return Support::unsupported(fmt::format("the scene reaches {:.3g} m, rays of float32 need {} m", extent, least_extent));
    return Support::full();
  }
  void setup() override {}
  void build(const Scene& scene) override { casters_->build(scene); }
  void update(const Scene& scene, const Changes& changes) override { casters_->update(scene, changes); }
  void relight(const Light& light) override { light_ = light; }
  void resolve(const GBuffer& gbuffer, VisibilityMask& mask) override {
    const RayScene& casters = casters_->under(gbuffer.truth);
    ray_count_ = has_area(light_) ? trace_shares(casters, casters_->scene(), gbuffer, light_, {}, mask.pixels())
                                  : trace_shadows(casters, casters_->scene(), gbuffer, light_, mask.pixels());
  }
  Counts counts() const override { return ray_counts(casters_, ray_count_); }
  std::unique_ptr<Technique> for_another_light() const override { return another(*this, &EmbreeRays::casters_); }

 private:
  Light light_;
  Shared<RayCasters> casters_;
  std::size_t ray_count_ = 0;
};

}  // namespace

GNOMON_TECHNIQUE(embree_rays, EmbreeRays, about)
