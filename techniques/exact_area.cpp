// Exact area: what casters leave of a light with area, by clipping its figure, from every visible point. The independent
// witness for soft shadows: no samples, no noise, no code in common with the ray tracer.
#include <gnomon/kit/area/area_scene.h>
#include <gnomon/kit/parallel.h>
#include <gnomon/kit/shared.h>
#include <gnomon/registry.h>

namespace {
using namespace gnomon;

constexpr About about{
    .title = "Exact area",
    .summary = "The light's figure, less what every triangle between covers of it, clipped from every visible point.",
    .source = "Nishita and Nakamae 1985 (visible parts of a polygonal light by clipping); Lambert 1760 (their irradiance).",
    .error =
        "Rounding of double for lights with corners. Disc and sphere lie between polygons of 64 corners: 1e-5. It estimates "
        "the share of the light's area, and sees triangles: against exact spheres, cones and discs it errs by the "
        "tessellation.",
    .fails = "Nothing it supports; where a large light is seen past thousands of triangles it is slow.",
    .promise = Promise::exact};

class ExactArea final : public Technique {
 public:
  Support supports(const Scene&, const Light& light, const View&) const override {
    if (!has_area(light)) return Support::unsupported("the light has no area: see exact_rays");
    return Support::full();
  }
  void setup() override {}
  void build(const Scene& scene) override {
    built_->scene = &scene;
    built_->casters.emplace(scene);
  }
  void relight(const Light& light) override { light_ = light; }
  void resolve(const GBuffer& gbuffer, VisibilityMask& mask) override {
    constexpr std::size_t block = 32;
    const std::span<float> pixels = mask.pixels();
    std::vector<AreaTally> tallies((gbuffer.size() + block - 1) / block);
    for_blocks(gbuffer.size(), block, [&](std::size_t begin, std::size_t end) {
      LightPieces pieces;
      for (std::size_t i = begin; i < end; ++i) {
        pixels[i] = 1;
        if (gbuffer.is_background(i) || !built_->scene->meshes[gbuffer.mesh[i]].receives) continue;
        const LightFigure face(light_, gbuffer.position(i), gbuffer.normal(i));
        if (!face.is_seen()) continue;
        pixels[i] = static_cast<float>(
            built_->casters->seen(receiver_at(*built_->scene, gbuffer, i), face, pieces, tallies[begin / block]).area.best);
      }
    });
    tally_ = {};
    for (const AreaTally& tally : tallies) tally_ += tally;
  }
  Counts counts() const override {
    const auto count = [](const char* name, std::uint64_t value) { return Count{name, static_cast<double>(value), ""}; };
    return {count("points", tally_.points),
            count("triangles", tally_.triangles),
            count("pieces", tally_.pieces),
            {"bytes", built_.own(static_cast<double>(built_->casters ? built_->casters->bytes() : 0)), "byte"}};
  }
  std::unique_ptr<Technique> for_another_light() const override { return another(*this, &ExactArea::built_); }

 private:
  struct Built {
    const Scene* scene = nullptr;
    std::optional<AreaScene> casters;
  };
  Shared<Built> built_;
  Light light_;
  AreaTally tally_;
};

}  // namespace

GNOMON_TECHNIQUE(exact_area, ExactArea, about)
