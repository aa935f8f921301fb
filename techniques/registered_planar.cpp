// Registered planar shadows: for each receiver plane a texture in which casters, projected from many points of the light, add
// up.
#include <gnomon/kit/area/light_points.h>
#include <gnomon/kit/bytes.h>
#include <gnomon/kit/kept_masks.h>
#include <gnomon/kit/pictures/layers.h>
#include <gnomon/kit/shared.h>
#include <gnomon/registry.h>

#include <algorithm>

#include "registered_planar/sheets.h"

namespace {
using namespace gnomon;
using namespace registered_planar;

constexpr About about{
    .title = "Registered planar shadows",
    .summary =
        "For each receiver plane a texture in which casters, projected from a number of points of the light, add up; a pixel "
        "looks its share up.",
    .source = "Heckbert and Herf 1997; the projection of Blinn 1988; places of the light as for area_rays.",
    .error =
        "Steps of one point of the light in n, soft over a texel, and shadows that are thinner than one. The error falls "
        "with n as n^-0.5 where points are random and as about n^-0.75 where they are spread evenly, down to that of the "
        "texels. It estimates the share of the light's area. What glass lets through is multiplied for each point of the light, "
        "exactly at the center of a texel but for float32.",
    .fails =
        "Receivers that are not flat: pixels off the receiver planes are lit and reported as not covered; contact shadows "
        "and fine casters on a large plane, whose texels are large; casters within a sphere of light, as for averaged_hard.",
    .device = Device::opengl,
    .floor = Floor::depth_draw,
    .handles = with_gray_transmission};

/// Textures of all sheets together, at most.
constexpr double most_bytes = 0x1p31;

/// Colors of texels in turn where all of the light is seen, and the share of them that is left where none of it is.
const Swatch lit_texels[] = {{"lit, even texels", {0.85, 0.80, 0.62}}, {"lit, odd texels", {0.55, 0.62, 0.72}}};
constexpr double umbra_brightness = 0.06;

class RegisteredPlanar final : public Technique {
  Number<int> samples{this, "samples", 16, {"point", 1, 1024, true}, Stage::relight, "Points of the light."};
  Choice pattern = Choice(this, "pattern", "low_discrepancy", {"random", "stratified", "low_discrepancy"}, Stage::relight,
                          "Where they lie: anywhere; one in each of as many cells; a sequence that fills the light evenly.");
  Number<int> seed{this, "seed", 1, {"", 0, 1000000}, Stage::relight, "Other random numbers."};
  Number<int> resolution = Number<int>(this, "resolution", 512, {"texel", 16, 4096, true}, Stage::relight,
                                       "Side of the square texture of each side of a receiver plane that the light shows.");
  Number<double> min_share =
      Number<double>(this, "min_share", 0.01, {.min = 0.001, .max = 1, .log = true}, Stage::build,
                     "Least share of the receiving area that makes a set of coplanar faces a receiver plane.");

 public:
  Support supports(const Scene& scene, const Light& light, const View&) const override {
    if (!has_area(light)) return Support::unsupported("the light has no area: its shadows are hard, see planar_projected");
    GlLimits needed = PlaneLookup::needs(scene);
    needed.fragment_storage_blocks = needed.storage_bindings = 4;
    needed.texture_size = resolution;
    const ReceiverPlanes planes = find_receiver_planes(scene, min_share);
    const Support support = support_on_planes(planes, min_share);
    if (!support) return support;
    needed.texture_layers = static_cast<std::int64_t>(2 * planes.planes.size());
    if (const Support enough = within_limits(needed); !enough) return enough;
    const double texel_bytes = has_far_side(light) ? 8 : 4;
    if (const double bytes = 2.0 * static_cast<double>(planes.planes.size()) * resolution * resolution * texel_bytes;
        bytes > most_bytes)
      return Support::unsupported(
          fmt::format("textures of both sides of {} planes take up to {:.0f} MiB at {} texels; at most {:.0f}",
                      planes.planes.size(), bytes / 0x1p20, resolution.value(), most_bytes / 0x1p20));
    return support;
  }
  void setup() override {
    painter_->setup();
    // Programs are the same for any number of texels and points, so few do. `settings` has only what is not by default: what is
    // set here goes back to its default before they are applied again.
    const std::string chosen = settings();
    apply("samples=2,resolution=16");
    warm_up(*this);
    warm_up(*this, true);
    samples.set(samples.default_text());
    resolution.set(resolution.default_text());
    apply(chosen);
  }
  void build(const Scene& scene) override { painter_->build(scene, min_share); }
  void relight(const Light& light) override {
    const StateGuard guard;
    points_ = light_points(light, pattern.value(), samples, places_seed(seed, 0));
    lit_ = painter_->sheets_for(light, points_, resolution);
    painter_->draw_sums(lit_, points_, sums_);
    glFinish();
  }
  void resolve(const GBuffer& gbuffer, VisibilityMask& mask) override {
    const StateGuard guard;
    gbuffer_ = &gbuffer;
    kept_.clear();
    painter_->look_up(lit_, sums_, gbuffer, mask);
    glFinish();
  }
  Counts counts() const override {
    const std::size_t own = sums_.bytes() + lit_.planes.bytes + bytes_of(points_, lit_.sheets);
    return {{"sheets", static_cast<double>(lit_.sheets.size()), ""},
            {"light_points", static_cast<double>(points_.size()), ""},
            {"triangles", static_cast<double>(sums_.triangles), ""},
            {"bytes", static_cast<double>(own) + painter_.own(static_cast<double>(painter_->bytes())), "byte"}};
  }
  std::optional<Explanation> explain(std::size_t index) const override {
    Explanation why;
    const GBuffer& g = *gbuffer_;
    if (!faces_light(painter_->scene(), g, lit_.light, index)) return why;
    const std::uint32_t plane = painter_->lookup().plane_of(g, index);
    why.covered = plane != no_plane;
    if (!why.covered) return why;
    why.element = plane;
    if (kept_.empty()) {
      const StateGuard guard;
      VisibilityMask mask(g.width, g.height);
      Sums one;
      for (const glm::vec3& point : points_) {
        painter_->draw_sums(lit_, {&point, 1}, one);
        painter_->look_up(lit_, one, g, mask);
        kept_.add(mask.read());
      }
    }
    const PointWeights weights(lit_.light, g.position(index), g.normal(index));
    double sum = 0;
    for (std::size_t k = 0; k < points_.size(); ++k) {
      const float weight = weights.at(points_[k]);
      if (weight > 0) why.samples.push_back({.place = points_[k], .weight = weight, .visibility = kept_.at(k, index)});
      sum += weight;
    }
    for (LightSample& sample : why.samples) sample.weight /= sum;
    return why;
  }
  std::unique_ptr<Technique> for_another_light() const override { return another(*this, &RegisteredPlanar::painter_); }
  std::vector<DebugLayer> debug_layers() const override {
    std::vector<Swatch> legend(std::begin(lit_texels), std::end(lit_texels));
    for (const Swatch& lit : lit_texels) legend.push_back({"umbra" + lit.name.substr(3), umbra_brightness * lit.color});
    return {{"texture",
             "The share of the light that each texel of the receiver planes' textures holds, unfiltered: the darker, the less. "
             "Dim where no texture is looked up.",
             legend}};
  }
  std::vector<float> draw_debug(std::string_view layer) const override {
    if (layer != "texture") return Technique::draw_debug(layer);
    const StateGuard guard;
    const GBuffer& g = *gbuffer_;
    VisibilityMask mask(g.width, g.height);
    painter_->look_up(lit_, sums_, g, mask, true);
    const std::span<const float> texels = mask.read();
    std::vector<float> picture = heat_layer(g, std::vector<float>(g.size(), 0));
    for (std::size_t i = 0; i < g.size(); ++i) {
      if (texels[i] < 2) continue;
      const bool is_odd = texels[i] >= 4;
      const double share = texels[i] - (is_odd ? 4 : 2);
      const glm::dvec3 color = glm::mix(umbra_brightness, 1.0, share) * lit_texels[is_odd].color;
      for (int c = 0; c < 3; ++c) picture[3 * i + c] = static_cast<float>(color[c]);
    }
    return picture;
  }

 private:
  Shared<SheetPainter> painter_;
  const GBuffer* gbuffer_ = nullptr;
  std::vector<glm::vec3> points_;  // of the light
  LitSheets lit_;
  Sums sums_;
  mutable KeptMasks kept_;  // made by the first `explain`
};

}  // namespace

GNOMON_TECHNIQUE(registered_planar, RegisteredPlanar, about)
