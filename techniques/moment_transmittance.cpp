// Moment transmittance: a texel holds five sums over the glass on its ray, which bound its absorbance down to any depth.
#include <gnomon/kit/maps/glass_sums.h>
#include <gnomon/registry.h>

#include "moment_transmittance/curve.h"

namespace {
using namespace gnomon;

constexpr About about{
    .title = "Moment transmittance",
    .summary =
        "Absorbance and its first four moments in depth say about how much of the light glass lets through to any depth.",
    .source = "Muenstermann, Krumpen, Klein and Peters 2018; Peters and Klein 2015 (Hamburger's moment problem)",
    .error =
        "Exact before and behind all glass but for overestimation, and for one surface and two but for moment_bias and rounding "
        "around their depths. Between three and more a mean error of .06 in random stacks of three to eight plates; "
        "overestimation=0 and 1 are the sharpest bounds, .23 apart in the mean. Opaque casters are those of a shadow map. "
        "filter=bilinear averages absorbance, which darkens: beside glass that lets 1 % through the middle is 10 % instead of "
        "50 %.",
    .fails = "Many sheets of glass with receivers between them; filtered edges of dark glass.",
    .device = Device::opengl,
    .floor = Floor::depth_draw,
    .handles = with_gray_transmission,
    .causes = glass_map_causes,
    .named_only = true};

class MomentTransmittance final : public GlassSums {
  Number<double> moment_bias = Number<double>(
      this, "moment_bias", 5e-7, {.min = 1e-7, .max = 0.1, .log = true}, Stage::resolve,
      "Share of the moments that is replaced by those of absorbance spread over all depths, against rounding: one surface or "
      "two make a singular matrix.");
  Number<double> overestimation =
      Number<double>(this, "overestimation", 0.25, {.min = 0, .max = 1}, Stage::resolve,
                     "Share of the absorbance that may lie at the point's own depth which counts: 0 is the upper bound of the "
                     "light, 1 the lower one.");

 public:
  std::unique_ptr<Technique> for_another_light() const override { return another(*this, &MomentTransmittance::made_); }

 private:
  Sums sums() const override {
    return {.count = 5,
            .add = std::string(moment_transmittance::add),
            .share = std::string(moment_transmittance::share),
            .constants = "vec2 curve_facts;",
            .constant_count = 1};
  }
  void set_constants(const Program& program) const override {
    program.set_if_used("curve_facts", glm::vec2(double(moment_bias), double(overestimation)));
  }
};

}  // namespace

GNOMON_TECHNIQUE(moment_transmittance, MomentTransmittance, about)
