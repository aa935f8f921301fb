// Exact rays: one segment from every visible point to the light, against every triangle near it, by exact signs of
// determinants. The independent witness for the ray tracer: no offset, no epsilon, no code in common with it.
#include <gnomon/kit/counts.h>
#include <gnomon/kit/geometry/exact_scene.h>
#include <gnomon/kit/shared.h>
#include <gnomon/registry.h>

namespace {
using namespace gnomon;

constexpr About about{
    .title = "Exact rays",
    .summary = "One segment per visible point against the triangles near it, decided without rounding or epsilon.",
    .source = "None to cite for the whole; the filter is of the kind of Shewchuk 1997, derived in kit/geometry/exact.cpp.",
    .error =
        "None on the points it is given, which are float32. A point may so lie below its own triangle by a rounding; then a "
        "neighbor across an edge, closer than that rounding, blocks it by right. Edges and vertices count as blocking. The "
        "texels of alpha masks and glass are found without rounding, too; what glass lets through is multiplied in double, "
        "in a fixed order. It sees triangles: against exact spheres, cones and discs it errs by the tessellation.",
    .fails = "Nothing it supports; it is slow.",
    .promise = Promise::exact,
    .handles = with_gray_transmission};

class ExactRays final : public Technique {
 public:
  Support supports(const Scene&, const Light& light, const View&) const override {
    return hard_lights_only(light, "one exact segment per pixel cannot see part of an area light");
  }
  void setup() override {}
  void build(const Scene& scene) override { casters_->emplace(scene); }
  void update(const Scene&, const Changes& changes) override { casters_->value().update(changes); }
  void relight(const Light& light) override { light_ = light; }
  void resolve(const GBuffer& gbuffer, VisibilityMask& mask) override {
    tally_ = casters_->value().decide(gbuffer, light_, mask.pixels());
  }
  Counts counts() const override {
    return {count_of("rays", tally_.rays),
            count_by_tree("triangle_tests", tally_.triangles),
            count_of("degenerate_rays", tally_.degenerate),
            count_by_tree("signs_by_int128", tally_.signs.lattice),
            count_by_tree("signs_by_gmp", tally_.signs.big),
            {"bytes", casters_.own(static_cast<double>(*casters_ ? casters_->value().bytes() : 0)), "byte"}};
  }
  std::unique_ptr<Technique> for_another_light() const override { return another(*this, &ExactRays::casters_); }

 private:
  Shared<std::optional<ExactScene>> casters_;
  Light light_;
  ExactTally tally_;
};

}  // namespace

GNOMON_TECHNIQUE(exact_rays, ExactRays, about)
