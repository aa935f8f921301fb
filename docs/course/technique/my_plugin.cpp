// My plugin: a skeleton that leaves everything lit.
#include <gnomon/registry.h>

#include <algorithm>

namespace {
using namespace gnomon;

constexpr About about{.title = "My plugin",
                      .summary = "A skeleton that leaves everything lit.",
                      .source = "An exercise.",
                      .error = "All shadows are missing.",
                      .fails = "Every scene with a shadow."};

class MyPlugin final : public Technique {
 public:
  Support supports(const Scene&, const Light& light, const View&) const override {
    if (has_area(light)) return Support::unsupported("it has no penumbra");
    return Support::full();
  }
  void setup() override {}
  void build(const Scene& scene) override { scene_ = &scene; }   // take what the scene's meshes give, once
  void relight(const Light& light) override { light_ = light; }  // then what this light needs
  void resolve(const GBuffer& gbuffer, VisibilityMask& mask) override {
    const std::span<float> pixels = mask.pixels();
    std::ranges::fill(pixels, 1.0f);
    tests_ = 0;
    for (std::size_t i = 0; i < pixels.size(); ++i) {
      if (!faces_light(*scene_, gbuffer, light_, i)) continue;
      // From gbuffer.position(i) on the way to_light(homogeneous(light_), position), which ends at t = 1 under a point light
      // and never under a sun: set pixels[i] to 0 where something is in the way.
    }
  }
  Counts counts() const override { return {{"tests", static_cast<double>(tests_), ""}, {"bytes", 0, "byte"}}; }

 private:
  const Scene* scene_ = nullptr;
  Light light_;
  std::size_t tests_ = 0;
};

}  // namespace

GNOMON_TECHNIQUE(my_plugin, MyPlugin, about)
