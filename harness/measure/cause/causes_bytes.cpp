#include <algorithm>

#include "measure/cause/causes.h"
#include "measure/scene/fields.h"

// Layout: magic, count; for each pixel one record and its taps. Where any pixel has samples of the light, the magic is another
// one, and each pixel's samples follow its taps. Where any names a cause of the technique's own, it is a third one, and the
// name follows the samples. Numbers are as they lie in memory: both sides are this program on this machine, or an older one
// without samples or without causes of a technique's own.

namespace gnomon {

namespace {

constexpr std::uint64_t magic_alone = 0x33'79'68'77'6d'6e'67ull;         // "gnmwhy3"
constexpr std::uint64_t magic_with_samples = 0x34'79'68'77'6d'6e'67ull;  // "gnmwhy4"
constexpr std::uint64_t magic_with_causes = 0x35'79'68'77'6d'6e'67ull;   // "gnmwhy5"

static_assert(sizeof(Tap) == 64 && std::is_trivially_copyable_v<Tap>);
static_assert(sizeof(LightSample) == 40 && std::is_trivially_copyable_v<LightSample>);

bool is_finite(const glm::dvec3& v) { return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z); }

/// Rays are traced from these numbers: one that is none would stop the ray tracer.
void check(const Explanation& why, std::size_t place) {
  const auto refuse = [&](std::string_view what) { throw Error("explanation {}: {}", place, what); };
  if (!std::isfinite(why.bias)) refuse(fmt::format("the bias is {}; meters are required", why.bias));
  if (!(why.texel_width >= 0 && std::isfinite(why.texel_width)))
    refuse(fmt::format("the texel's width is {}; meters, 0 or more, are required", why.texel_width));
  if (!(why.outline_error >= 0 && std::isfinite(why.outline_error)))
    refuse(fmt::format("the error of the outline is {}; meters, 0 or more, are required", why.outline_error));
  if (why.shifted && !is_finite(*why.shifted)) refuse("the look-up point is not finite");
  for (const Tap& tap : why.taps) {
    if (!is_finite(tap.origin)) refuse("the origin of a tap is not finite");
    // Also when a component is not a number.
    if (!(std::abs(glm::length(tap.direction) - 1) < 1e-6)) refuse("the direction of a tap has not length 1");
    if (!std::isfinite(tap.weight)) refuse(fmt::format("the weight of a tap is {}", tap.weight));
    if (std::isnan(tap.stored)) refuse("the stored distance of a tap is not a number");
  }
  for (const LightSample& sample : why.samples) {
    if (!is_finite(sample.place)) refuse("the place of a sample is not finite");
    if (!std::isfinite(sample.weight)) refuse(fmt::format("the weight of a sample is {}", sample.weight));
    if (!(sample.visibility >= 0 && sample.visibility <= 1))
      refuse(fmt::format("the visibility of a sample is {}; 0 .. 1 is required", sample.visibility));
  }
}

}  // namespace

std::vector<std::byte> explanation_bytes(std::span<const std::optional<Explanation>> explanations) {
  const bool has_samples = std::ranges::any_of(explanations, [](const auto& why) { return why && !why->samples.empty(); });
  const bool has_causes = std::ranges::any_of(explanations, [](const auto& why) { return why && !why->cause.empty(); });
  FieldWriter io;
  const std::uint64_t mark = has_causes ? magic_with_causes : has_samples ? magic_with_samples : magic_alone;
  io(mark, static_cast<std::uint64_t>(explanations.size()));
  static const Explanation none{};
  constexpr std::uint8_t padding[3] = {};  // to 72 bytes
  for (const auto& why : explanations) {
    const Explanation& e = why ? *why : none;
    if (why) check(e, static_cast<std::size_t>(&why - explanations.data()));
    io(std::uint64_t{e.taps.size()}, e.element.value_or(0), e.bias, e.texel_width, e.outline_error,
       e.shifted.value_or(glm::dvec3(0)), why.has_value(), why && e.covered, e.shifted.has_value(), e.element.has_value(),
       e.formula_differs, padding);
    if (!why) continue;
    io.items(e.taps);
    if (mark != magic_alone) io(e.samples);
    if (mark == magic_with_causes) io(e.cause);
  }
  return std::move(io.bytes);
}

std::vector<std::optional<Explanation>> explanations_from_bytes(std::span<const std::byte> bytes) {
  FieldReader io(bytes, fmt::format("explanations end early: there are {} bytes", bytes.size()));
  std::uint64_t mark = 0;
  io(mark);
  if (mark != magic_alone && mark != magic_with_samples && mark != magic_with_causes)
    throw Error("these bytes are no explanations: they begin with {:#x}, not {:#x}, {:#x} or {:#x}", mark, magic_alone,
                magic_with_samples, magic_with_causes);
  std::vector<std::optional<Explanation>> explanations;
  io.list(explanations, [&](auto& sub, auto& why) {
    Explanation e;
    std::uint64_t tap_count = 0, element = 0;
    glm::dvec3 shifted(0);
    std::uint8_t has_any = 0, is_covered = 0, has_shifted = 0, has_element = 0, formula_differs = 0, padding[3] = {};
    sub(tap_count, element, e.bias, e.texel_width, e.outline_error, shifted, has_any, is_covered, has_shifted, has_element,
        formula_differs, padding);
    if (!has_any) return;
    e.covered = is_covered != 0;
    e.formula_differs = formula_differs != 0;
    if (has_shifted) e.shifted = shifted;
    if (has_element) e.element = element;
    sub.items(e.taps, tap_count);
    if (mark != magic_alone) sub(e.samples);
    if (mark == magic_with_causes) sub(e.cause);
    why = std::move(e);
  });
  if (io.left() > 0) throw Error("{} bytes are left after the last explanation", io.left());
  return explanations;
}

}  // namespace gnomon
