#pragma once
#include <cstdint>
#include <glm/glm.hpp>
#include <utility>

namespace gnomon {

/// SplitMix64 (Steele, Lea and Flood 2014): numbers that look random from a counter that grows by `mixed_step`, or from any.
inline constexpr std::uint64_t mixed_step = 0x9e3779b97f4a7c15u;
constexpr std::uint64_t mixed(std::uint64_t z) {
  z += mixed_step;
  z = (z ^ z >> 30) * 0xbf58476d1ce4e5b9u;
  z = (z ^ z >> 27) * 0x94d049bb133111ebu;
  return z ^ z >> 31;
}

/// PCG32 (O'Neill 2014, XSH-RR): small, fast, and the same numbers on every machine, which the standard distributions are not.
class Random {
 public:
  explicit Random(std::uint64_t seed, std::uint64_t stream = 54) : increment_(stream << 1 | 1) {
    next();
    state_ += seed;
    next();
  }

  std::uint32_t next() {
    const std::uint64_t old = state_;
    state_ = old * 6364136223846793005u + increment_;
    const auto word = static_cast<std::uint32_t>((old >> 18 ^ old) >> 27);
    const auto turn = static_cast<std::uint32_t>(old >> 59);
    return word >> turn | word << (-turn & 31);
  }

  /// In [low, high), in steps of 2^-32 of the interval.
  double uniform(double low, double high) { return low + (high - low) * (next() * 0x1p-32); }

  /// In the box from low to high: x, y, z in this order. (Three draws among a function's arguments come in no fixed order.)
  glm::dvec3 uniform(const glm::dvec3& low, const glm::dvec3& high) {
    const double x = uniform(low.x, high.x), y = uniform(low.y, high.y), z = uniform(low.z, high.z);
    return {x, y, z};
  }

  /// In 0 .. count - 1, by multiplication; the bias is below count / 2^32.
  std::uint32_t below(std::uint32_t count) { return static_cast<std::uint32_t>(std::uint64_t{next()} * count >> 32); }

  /// Every order is as likely, but for that bias (Fisher and Yates).
  template <class Items>
  void shuffle(Items&& items) {
    for (std::size_t i = items.size(); i > 1; --i) std::swap(items[i - 1], items[below(static_cast<std::uint32_t>(i))]);
  }

 private:
  std::uint64_t state_ = 0;
  std::uint64_t increment_;
};

}  // namespace gnomon
