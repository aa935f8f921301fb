#include <gnomon/error.h>

#include <cmath>
#include <cstring>

#include "measure/cause/causes.h"

// Layout: magic, count; for each pixel one record and its taps. All little pieces of plain memory: both sides are this program
// on this machine.

namespace gnomon {

namespace {

constexpr std::uint64_t magic = 0x33'79'68'77'6d'6e'67ull;  // "gnmwhy3"

struct Head {
  std::uint64_t magic, count;
};

/// One explanation less its taps.
struct Plain {
  std::uint64_t tap_count = 0, element = 0;
  double bias = 0, texel_width = 0, outline_error = 0;
  glm::dvec3 shifted{0};
  std::uint8_t has_any = 0, covered = 0, has_shifted = 0, has_element = 0, formula_differs = 0;
  std::uint8_t padding[3] = {};
};
static_assert(sizeof(Plain) == 72 && sizeof(Tap) == 64 && std::is_trivially_copyable_v<Tap>);

template <class T>
void append(std::vector<std::byte>& bytes, const T* items, std::size_t count) {
  const std::size_t size = bytes.size();
  bytes.resize(size + count * sizeof(T));
  if (count > 0) std::memcpy(&bytes[size], items, count * sizeof(T));
}

class Reader {
 public:
  explicit Reader(std::span<const std::byte> bytes) : bytes_(bytes) {}
  template <class T>
  void take(T* items, std::uint64_t count) {
    if (count > bytes_.size() / sizeof(T))
      throw Error("explanations end early: {} items of {} bytes are wanted, {} bytes are left", count, sizeof(T),
                  bytes_.size());
    if (count > 0) std::memcpy(static_cast<void*>(items), bytes_.data(), count * sizeof(T));
    bytes_ = bytes_.subspan(count * sizeof(T));
  }
  /// Throws like take, before anybody makes room for that many.
  template <class T>
  void expect(std::uint64_t count) const {
    if (count > bytes_.size() / sizeof(T))
      throw Error("explanations end early: {} items of {} bytes are wanted, {} bytes are left", count, sizeof(T),
                  bytes_.size());
  }
  std::size_t left() const { return bytes_.size(); }

 private:
  std::span<const std::byte> bytes_;
};

}  // namespace

namespace {

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
  std::vector<std::byte> bytes;
  const Head head{magic, explanations.size()};
  append(bytes, &head, 1);
  for (const auto& why : explanations) {
    Plain plain;
    if (why) {
      check(*why, static_cast<std::size_t>(&why - explanations.data()));
      plain.has_any = 1;
      plain.covered = why->covered;
      plain.tap_count = why->taps.size();
      plain.bias = why->bias;
      plain.texel_width = why->texel_width;
      plain.outline_error = why->outline_error;
      plain.formula_differs = why->formula_differs;
      plain.has_shifted = why->shifted.has_value();
      plain.shifted = why->shifted.value_or(glm::dvec3(0));
      plain.has_element = why->element.has_value();
      plain.element = why->element.value_or(0);
    }
    append(bytes, &plain, 1);
    if (why) append(bytes, why->taps.data(), why->taps.size());
  }
  return bytes;
}

std::vector<std::optional<Explanation>> explanations_from_bytes(std::span<const std::byte> bytes) {
  Reader reader(bytes);
  Head head;
  reader.take(&head, 1);
  if (head.magic != magic) throw Error("these bytes are no explanations: they begin with {:#x}, not {:#x}", head.magic, magic);
  reader.expect<Plain>(head.count);
  std::vector<std::optional<Explanation>> explanations(head.count);
  for (auto& why : explanations) {
    Plain plain;
    reader.take(&plain, 1);
    if (!plain.has_any) continue;
    why.emplace();
    why->covered = plain.covered;
    why->bias = plain.bias;
    why->texel_width = plain.texel_width;
    why->outline_error = plain.outline_error;
    why->formula_differs = plain.formula_differs != 0;
    if (plain.has_shifted) why->shifted = plain.shifted;
    if (plain.has_element) why->element = plain.element;
    reader.expect<Tap>(plain.tap_count);
    why->taps.resize(plain.tap_count);
    reader.take(why->taps.data(), plain.tap_count);
  }
  if (reader.left() > 0) throw Error("{} bytes are left after the last explanation", reader.left());
  return explanations;
}

}  // namespace gnomon
