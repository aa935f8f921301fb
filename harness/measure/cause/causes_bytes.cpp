#include <gnomon/error.h>

#include <cmath>

#include "measure/cause/causes.h"
#include "measure/scene/fields.h"

// Both sides are this program on this machine.

namespace gnomon {

namespace {

constexpr std::uint64_t magic = 0x34'79'68'77'6d'6e'67ull;  // "gnmwhy4"

/// The fields in their order, for FieldWriter and FieldReader alike.
void visit_explanation(auto& io, auto& why) {
  io(why.covered, why.taps, why.bias, why.texel_width, why.shifted, why.element, why.outline_error, why.formula_differs);
}

bool is_finite(const glm::dvec3& v) { return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z); }

/// Rays are traced from these numbers: one that is none would stop the ray tracer.
void check(const Explanation& why, std::size_t place) {
  const auto refuse = [&](std::string_view what) { throw Error("explanation {}: {}", place, what); };
  if (!std::isfinite(why.bias)) refuse(fmt::format("the bias is {}; meters are wanted", why.bias));
  if (!(why.texel_width >= 0 && std::isfinite(why.texel_width)))
    refuse(fmt::format("the texel's width is {}; meters, 0 or more, are wanted", why.texel_width));
  if (!(why.outline_error >= 0 && std::isfinite(why.outline_error)))
    refuse(fmt::format("the error of the outline is {}; meters, 0 or more, are wanted", why.outline_error));
  if (why.shifted && !is_finite(*why.shifted)) refuse("the look-up point is not finite");
  for (const Tap& tap : why.taps) {
    if (!is_finite(tap.origin)) refuse("the origin of a tap is not finite");
    // Also when a component is not a number.
    if (!(std::abs(glm::length(tap.direction) - 1) < 1e-6)) refuse("the direction of a tap has not length 1");
    if (!std::isfinite(tap.weight)) refuse(fmt::format("the weight of a tap is {}", tap.weight));
    if (std::isnan(tap.stored)) refuse("the stored distance of a tap is not a number");
  }
}

}  // namespace

std::vector<std::byte> explanation_bytes(std::span<const std::optional<Explanation>> explanations) {
  FieldWriter io;
  io(magic);
  io.list(explanations, [&](FieldWriter& out, const std::optional<Explanation>& why) {
    out(why.has_value());
    if (!why) return;
    check(*why, static_cast<std::size_t>(&why - explanations.data()));
    visit_explanation(out, *why);
  });
  return std::move(io.bytes);
}

std::vector<std::optional<Explanation>> explanations_from_bytes(std::span<const std::byte> bytes) {
  FieldReader io(bytes, fmt::format("explanations end early: they have {} bytes", bytes.size()));
  std::uint64_t mark = 0;
  io(mark);
  if (mark != magic) throw Error("these bytes are no explanations: they begin with {:#x}, not {:#x}", mark, magic);
  std::vector<std::optional<Explanation>> explanations;
  io.list(explanations, [](FieldReader& in, std::optional<Explanation>& why) {
    bool has_any = false;
    in(has_any);
    if (has_any) visit_explanation(in, why.emplace());
  });
  if (io.left() > 0) throw Error("{} bytes are left after the last explanation", io.left());
  return explanations;
}

}  // namespace gnomon
