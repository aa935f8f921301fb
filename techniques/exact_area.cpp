// Exact area: what casters leave of a light with area, by clipping its figure, from every visible point. The independent
// witness for soft shadows: no samples, no noise, no code in common with the ray tracer.
#include <gnomon/kit/area/area_scene.h>
#include <gnomon/kit/counts.h>
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
    .fails =
        "Nothing it supports; where a large light is seen past thousands of triangles it is slow. Casters with holes are "
        "unsupported: it does not cut alpha masks into polygons.",
    .promise = Promise::exact};

class ExactArea final : public Technique {
 public:
  Support supports(const Scene&, const Light& light, const View&) const override {
    if (!has_area(light)) return Support::unsupported("the light has no area: see exact_rays");
    return Support::full();
  }
  void setup() override {}
  void build(const Scene& scene) override { casters_->emplace(scene); }
  void update(const Scene&, const Changes& changes) override { casters_->value().update(changes); }
  void relight(const Light& light) override { light_ = light; }
  void resolve(const GBuffer& gbuffer, VisibilityMask& mask) override {
    constexpr std::size_t block = 32;
    const AreaScene& casters = casters_->value();
    const std::span<float> pixels = mask.pixels();
    std::vector<AreaTally> tallies((gbuffer.size() + block - 1) / block);
    for_blocks(gbuffer.size(), block, [&](std::size_t begin, std::size_t end) {
      LightPieces pieces;
      for (std::size_t i = begin; i < end; ++i) {
        pixels[i] = 1;
        if (gbuffer.is_background(i) || !casters.scene().meshes[gbuffer.mesh[i]].receives) continue;
        const LightFigure figure(light_, gbuffer.position(i), gbuffer.normal(i));
        if (!figure.is_seen()) continue;
        const Receiver receiver = receiver_at(casters.scene(), gbuffer, i);
        pixels[i] = static_cast<float>(casters.seen(receiver, figure, pieces, tallies[begin / block]).area.best);
      }
    });
    tally_ = {};
    for (const AreaTally& tally : tallies) tally_ += tally;
  }
  Counts counts() const override {
    return {count_of("points", tally_.points),
            count_of("triangles", tally_.triangles),
            count_of("pieces", tally_.pieces),
            {"bytes", casters_.own(static_cast<double>(*casters_ ? casters_->value().bytes() : 0)), "byte"}};
  }
  std::unique_ptr<Technique> for_another_light() const override { return another(*this, &ExactArea::casters_); }

 private:
  Shared<std::optional<AreaScene>> casters_;
  Light light_;
  AreaTally tally_;
};

}  // namespace

GNOMON_TECHNIQUE(exact_area, ExactArea, about)
