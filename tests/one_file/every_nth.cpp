// Every n-th: the file that is added. It is dark at every n-th pixel that faces the light, and so has one of everything: a
// parameter, an answer, a count.
#include <gnomon/registry.h>

namespace {
using namespace gnomon;

class EveryNth final : public Technique {
  Number<int> n{this, "n", 7, {.unit = "px", .min = 1, .max = 64}, Stage::resolve, "Distance from one dark pixel to the next."};

 public:
  Support supports(const Scene&, const Light&, const View&) const override { return Support::full(); }
  void setup() override {}
  void build(const Scene& scene) override { scene_ = &scene; }
  void relight(const Light& light) override { light_ = light; }
  void resolve(const GBuffer& gbuffer, VisibilityMask& mask) override {
    dark_ = 0;
    std::size_t facing = 0;
    for (std::size_t i = 0; i < gbuffer.size(); ++i) {
      const bool dark = faces_light(*scene_, gbuffer, light_, i) && facing++ % n == 0;
      mask.pixels()[i] = dark ? 0.0f : 1.0f;
      dark_ += dark;
    }
  }
  Counts counts() const override { return {{"dark_pixels", static_cast<double>(dark_), "px"}, {"bytes", 0, "byte"}}; }

 private:
  const Scene* scene_ = nullptr;
  Light light_;
  std::size_t dark_ = 0;
};

}  // namespace

GNOMON_TECHNIQUE(every_nth, EveryNth,
                 {.title = "Every n-th pixel",
                  .summary = "Dark at every n-th pixel that faces the light.",
                  .source = "None.",
                  .error = "All of it.",
                  .fails = "Everywhere."})
