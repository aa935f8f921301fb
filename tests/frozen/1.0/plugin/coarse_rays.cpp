// Coarse rays: one shadow ray for each block of pixels.
#include <gnomon/kit/rays/rays.h>
#include <gnomon/registry.h>

#include <cmath>
#include <optional>

namespace {
using namespace gnomon;

constexpr About about{.title = "Coarse rays",
                      .summary = "One shadow ray for each block of pixels that see the same mesh.",
                      .source = "Folklore of renderers that must be quick.",
                      .error = "Edges of shadows are off by up to a block, to the right and down.",
                      .fails = "Shadows that are thinner than a block, and all edges of shadows."};

class CoarseRays final : public Technique {
  Number<int> block{this, "block", 2, {.unit = "px", .min = 1, .max = 8}, Stage::resolve, "Width and height of a block."};

 public:
  Support supports(const Scene&, const Light& light, const View&) const override {
    if (has_area(light)) return Support::unsupported("it has no penumbra");
    return Support::approximate("one pixel of a block answers for all");
  }
  void setup() override {}
  void build(const Scene& scene) override {
    scene_ = &scene;
    casters_.emplace(scene, Truth::mesh, RayScene::Which::casters);
    offset_ = 1e-6 * scene.bounds().extent();  // no length is special
  }
  void relight(const Light& light) override { light_ = light; }
  void resolve(const GBuffer& gbuffer, VisibilityMask& mask) override {
    const std::span<float> pixels = mask.pixels();
    const std::size_t width = static_cast<std::size_t>(gbuffer.width), n = static_cast<std::size_t>(block);
    rays_ = 0;
    for (std::size_t i = 0; i < pixels.size(); ++i) {
      const std::size_t x = i % width, y = i / width, corner = (y - y % n) * width + x - x % n;  // upper left of its block
      if (!faces_light(*scene_, gbuffer, light_, i))
        pixels[i] = 1;
      else if (corner != i && gbuffer.mesh[corner] == gbuffer.mesh[i] && faces_light(*scene_, gbuffer, light_, corner))
        pixels[i] = pixels[corner];
      else
        pixels[i] = is_lit(gbuffer, i) ? 1.0f : 0.0f;
    }
  }
  Counts counts() const override {
    return {{"rays", static_cast<double>(rays_), ""}, {"bytes", static_cast<double>(casters_->bytes()), "byte"}};
  }

 private:
  bool is_lit(const GBuffer& gbuffer, std::size_t i) {
    ++rays_;
    const glm::dvec3 point = gbuffer.position(i), normal = gbuffer.normal(i);
    const glm::dvec3 start = point + offset_ * normal;  // off its own surface
    const glm::dvec4 light = homogeneous(light_);
    const double end = light.w != 0 ? 1 : INFINITY;  // a point light is an end of the segment
    return casters_->closest(start, to_light(light, start)).t >= end;
  }

  const Scene* scene_ = nullptr;
  std::optional<RayScene> casters_;
  Light light_;
  double offset_ = 0;
  std::size_t rays_ = 0;
};

}  // namespace

GNOMON_TECHNIQUE(coarse_rays, CoarseRays, about)
