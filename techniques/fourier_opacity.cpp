// Fourier opacity map: a texel holds the first terms of a Fourier series of the absorbance on its ray.
#include <gnomon/kit/maps/glass_sums.h>
#include <gnomon/registry.h>

#include "fourier_opacity/curve.h"

namespace {
using namespace gnomon;

constexpr About about{
    .title = "Fourier opacity map",
    .summary = "The first terms of a Fourier series of absorbance over depth say how much of the light glass lets through.",
    .source = "Jansen and Bavoil 2010",
    .error =
        "Exact before and behind the range of depths, for any number of terms. Between sheets the series rings: absorbance "
        "overshoots by 9 % of each jump on both sides of it. Mean error in random stacks of three to eight plates: .063, .037 "
        "and .022 with terms=3, 7 and 15. Opaque casters are those of a shadow map. filter=bilinear averages absorbance, which "
        "darkens.",
    .fails = "Few sheets of dark glass with receivers between them: it is made for smoke, whose absorbance has no jumps.",
    .device = Device::opengl,
    .floor = Floor::depth_draw,
    .handles = with_gray_transmission,
    .causes = glass_map_causes,
    .named_only = true};

class FourierOpacity final : public GlassSums {
  Choice terms = Choice(this, "terms", "7", {"3", "7", "15"}, Stage::setup,
                        "Terms of the series beside the constant one: a texel holds twice as many numbers, and one.");

 public:
  std::unique_ptr<Technique> for_another_light() const override { return another(*this, &FourierOpacity::made_); }

 private:
  Sums sums() const override {
    return {.count = 1 + 2 * (terms.is("3")   ? 3
                              : terms.is("7") ? 7
                                              : 15),
            .add = std::string(fourier_opacity::add),
            .share = std::string(fourier_opacity::share)};
  }
};

}  // namespace

GNOMON_TECHNIQUE(fourier_opacity, FourierOpacity, about)
