#pragma once
#include <algorithm>
#include <cmath>
#include <numbers>
#include <string_view>
#include <vector>

namespace gnomon::fourier_opacity {

/// The first terms of the Fourier series of the absorbance on a ray over depth 0 .. 1: a[0], then a[k] and b[k] for k = 1 .. n,
/// where a[k] = 2 sum of tau cos(2 pi k t) and b[k] = 2 sum of tau sin(2 pi k t).
template <class Real>
struct Series {
  std::vector<Real> a, b;  ///< n + 1 each; b[0] is 0
  explicit Series(int n) : a(static_cast<std::size_t>(n) + 1), b(a.size()) {}

  void add(Real t, Real absorbance) {
    for (std::size_t k = 0; k < a.size(); ++k) {
      const Real angle = 2 * std::numbers::pi_v<Real> * static_cast<Real>(k) * t;
      a[k] += 2 * absorbance * std::cos(angle);
      b[k] += 2 * absorbance * std::sin(angle);
    }
  }
};

/// What part of the light arrives at depth t: the series integrated from 0 to t, not above 1. Exact at 0 and 1.
template <class Real>
Real transmittance(const Series<Real>& series, Real t) {
  Real absorbance = series.a[0] * t / 2;
  for (std::size_t k = 1; k < series.a.size(); ++k) {
    const Real w = 2 * std::numbers::pi_v<Real> * static_cast<Real>(k);
    absorbance += (series.a[k] * std::sin(w * t) + series.b[k] * (1 - std::cos(w * t))) / w;
  }
  return std::min(std::exp(-absorbance), Real(1));
}

/// The same in GLSL: a[0], a[1] .. a[n], b[1] .. b[n]. The angle's multiples are made by turning.
inline constexpr std::string_view add = R"(
void sums_of(float t, float absorbance, out float sums[SUM_COUNT]) {
  const int n = SUM_COUNT / 2;
  float angle = 6.28318530718 * t;
  vec2 step = vec2(cos(angle), sin(angle)), turned = vec2(1, 0);
  sums[0] = 2 * absorbance;
  for (int k = 1; k <= n; ++k) {
    turned = vec2(turned.x * step.x - turned.y * step.y, turned.x * step.y + turned.y * step.x);
    sums[k] = 2 * absorbance * turned.x;
    sums[n + k] = 2 * absorbance * turned.y;
  }
}
)";
inline constexpr std::string_view share = R"(
float share_of(float sums[SUM_COUNT], float t) {
  const int n = SUM_COUNT / 2;
  float angle = 6.28318530718 * t, absorbance = 0;
  vec2 step = vec2(cos(angle), sin(angle)), turned = vec2(1, 0);
  for (int k = 1; k <= n; ++k) {
    turned = vec2(turned.x * step.x - turned.y * step.y, turned.x * step.y + turned.y * step.x);
    absorbance += (sums[k] * turned.y + sums[n + k] * (1 - turned.x)) / float(k);
  }
  return min(exp(-(0.5 * sums[0] * t + absorbance / 6.28318530718)), 1);
}
)";

}  // namespace gnomon::fourier_opacity
