// Exponential shadow map: a texel holds an exponential of depth, whose mean gives how much of the light arrives.
#include <gnomon/kit/maps/filtered_map.h>
#include <gnomon/registry.h>

namespace {
using namespace gnomon;

constexpr About about{
    .title = "Exponential shadow map",
    .summary = "The mean of exponentials of the depths around a texel, times one of the receiver's, tells how much arrives.",
    .source = "Annen, Mertens, Seidel, Flerackers and Kautz 2008; Salvi 2008",
    .error =
        "A step in depth becomes an exponential of 1 / exponent of the depth range: shadows are lit near their casters, and "
        "wrong where some texels around lie behind the receiver, since one far depth outweighs all near ones. "
        "Holes are those of the mask with alpha=texel alone: mips and mips_kept filter alpha, and hashed is random "
        "where alpha is neither 0 nor 1. A texel holds no product: glass is taken for opaque or left out.",
    .fails = "Contacts; edges of receivers before a far background, which light leaks to.",
    .device = Device::opengl,
    .floor = Floor::depth_draw,
    .handles = with_gray_transmission,
    .causes = map_causes};

class ExponentialMap final : public FilteredMap {
  // exp(88.7) is the largest float32, and exp(-87.3) the least that every device keeps. A blur adds up to no more than its
  // largest texel.
  Number<double> exponent = Number<double>(this, "exponent", 80, {.min = 1, .max = 87}, Stage::relight,
                                           "How steep the exponential is, over the image's depth range.");

 public:
  std::unique_ptr<Technique> for_another_light() const override { return another(*this, &ExponentialMap::made_); }

 private:
  Texel texel() const override { return {.channels = 1, .to_one = glm::vec4(static_cast<float>(std::exp(-exponent)))}; }
  Method method() const override {
    return {
        .encode = "vec4 encode(float t) { return vec4(exp(exponent * t)); }\n",
        .answer = fmt::format("float answer(vec4 mean, float t) {{ return min(mean.x * exp(-exponent * t) * {:.6f}, 1); }}\n",
                              1 + rounding().share),
        .constants = "float exponent;"};
  }
  Support method_support() const override {
    // exp(11.08) = 64860 is the last below 65504, and 1 / 10 of 2^15 = exp(10.4) is what a table still tells from its largest.
    if (has_16_bits() && exponent > 11.08)
      return Support::unsupported(
          fmt::format("exponent = {:g}: a float of 16 bits holds up to 65504, exponents up to 11.08", exponent.value()));
    if (has_table() && exponent > 10)
      return Support::unsupported(
          fmt::format("exponent = {:g}: sums of whole numbers tell exponents up to 10 from rounding", exponent.value()));
    return Support::full();
  }
  void set_constants(const Program& program) const override { program.set_if_used("exponent", static_cast<float>(exponent)); }
};

}  // namespace

GNOMON_TECHNIQUE(exponential_map, ExponentialMap, about)
