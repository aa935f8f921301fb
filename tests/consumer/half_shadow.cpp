// Half shadow: one ray per visible point, and a share of the light gets through every caster.
// Source: none; an example of a plugin.  Error: the share, wherever it is dark.  Fails: everywhere, unless share is 0.
#include <gnomon/kit/rays/rays.h>
#include <gnomon/registry.h>

#include <optional>

namespace {
using namespace gnomon;

class HalfShadow final : public Technique {
  Number<double> share{this, "share", 0.5, {.min = 0, .max = 1}, Stage::resolve, "What of the light gets through a caster."};

 public:
  Support supports(const Scene&, const Light& light, const View&) const override {
    if (has_area(light)) return Support::unsupported("one ray per pixel cannot see part of an area light");
    return Support::full();
  }
  void setup() override {}
  void build(const Scene& scene) override {
    scene_ = &scene;
    casters_.emplace(scene, Truth::mesh, RayScene::Which::casters);
  }
  void relight(const Light& light) override { light_ = light; }
  void resolve(const GBuffer& gbuffer, VisibilityMask& mask) override {
    trace_shadows(*casters_, *scene_, gbuffer, light_, mask.pixels());
    for (float& pixel : mask.pixels()) pixel += (1 - pixel) * static_cast<float>(share);
  }
  Counts counts() const override { return {{"bytes", static_cast<double>(casters_->bytes()), "byte"}}; }

 private:
  const Scene* scene_ = nullptr;
  std::optional<RayScene> casters_;
  Light light_;
};

}  // namespace

GNOMON_TECHNIQUE(half_shadow, HalfShadow,
                 {.title = "Half shadow",
                  .summary = "A share of the light gets through every caster.",
                  .source = "An example.",
                  .error = "The share, wherever it is dark.",
                  .fails = "Everywhere, unless share is 0."})
