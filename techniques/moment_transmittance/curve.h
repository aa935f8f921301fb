#pragma once
#include <algorithm>
#include <cmath>
#include <string_view>

namespace gnomon::moment_transmittance {

/// Of the absorbance on a ray, with z = 2 t - 1 for depth t: b[0] = sum of tau, b[k] = sum of tau z^k.
template <class Real>
struct Moments {
  Real b[5] = {};

  void add(Real t, Real absorbance) {
    const Real z = 2 * t - 1;
    for (Real& sum : b) {
      sum += absorbance;
      absorbance *= z;
    }
  }
};

/// The one measure on three points, one of them z0, that has four given moments (Hamburger's problem, canonical
/// representation). The others are the roots of a quadratic: `z` and 1 / `g`, which goes through infinity where z0 is one of
/// two points that have these moments alone.
template <class Real>
struct Canonical {
  Real z, g;
  Real w0, w, wg;  ///< weights of z0, z and 1 / g; they add up to 1

  bool is_before(Real z0) const { return z < z0; }
  bool is_other_before(Real z0) const { return g > 0 ? z0 * g > 1 : g < 0 && z0 * g < 1; }
};

/// What (0, 3/8, 0, 3/8), blended into normalized moments, leaves of the pivots of their Hankel matrix at least: 3/8 and
/// 3/8 - (3/8)^2, for each unit of `moment_bias`.
inline constexpr double least_pivot1 = 0.375, least_pivot2 = 0.234375;

/// `n` are moments 1 to 4 divided by the absorbance. Two surfaces make their Hankel matrix singular, and one does so twice:
/// hence the bias. Roundings of float32 are as large as what it adds to the pivots: these are kept at what it adds.
template <class Real>
Canonical<Real> canonical(const Real (&n)[4], Real z0, Real moment_bias) {
  Real b[4];
  for (int k = 0; k < 4; ++k) b[k] = n[k] + ((k % 2 == 0 ? Real(0) : Real(0.375)) - n[k]) * moment_bias;
  // L D L^T of (1 b1 b2; b1 b2 b3; b2 b3 b4).
  const Real d1 = std::max(b[1] - b[0] * b[0], Real(least_pivot1) * moment_bias);
  const Real l21_d1 = b[2] - b[0] * b[1], l21 = l21_d1 / d1;
  const Real d2 = std::max(b[3] - b[1] * b[1] - l21_d1 * l21, Real(least_pivot2) * moment_bias);
  // The matrix times c is (1, z0, z0^2): forward, diagonal, back. Squares on the way add up to 1 / w0.
  const Real y1 = z0 - b[0], y2 = z0 * z0 - b[1] - l21 * y1;
  const Real c2 = y2 / d2, c1 = y1 / d1 - l21 * c2, c0 = 1 - c1 * b[0] - c2 * b[1];
  const Real half = c1 / 2, root = std::sqrt(std::max(half * half - c0 * c2, Real(0)));
  Real q = -(half + (half < 0 ? -root : root));
  if (std::abs(q) < Real(1e-30)) q = Real(1e-30);
  Canonical<Real> found{.z = c0 / q, .g = c2 / q, .w0 = 1 / (1 + y1 * y1 / d1 + y2 * y2 / d2), .w = 0, .wg = 0};
  const Real rest = 1 - found.w0, apart = 1 - found.g * found.z;
  const Real w = (rest - found.g * (b[0] - found.w0 * z0)) / apart;
  found.w = apart == 0 ? rest : std::clamp(w, Real(0), rest);
  found.wg = rest - found.w;
  return found;
}

/// What part of the light arrives at depth t: a fraction `overestimation` of the absorbance that may lie at t itself counts. 1
/// and 0 make the sharp lower and upper bound of all absorbances with these moments.
template <class Real>
Real transmittance(const Moments<Real>& moments, Real t, Real moment_bias, Real overestimation) {
  if (!(moments.b[0] > 0)) return 1;
  Real n[4];
  for (int k = 0; k < 4; ++k) n[k] = moments.b[k + 1] / moments.b[0];
  const Real z0 = 2 * t - 1;
  const Canonical<Real> at = canonical(n, z0, moment_bias);
  const Real before = (at.is_before(z0) ? at.w : Real(0)) + (at.is_other_before(z0) ? at.wg : Real(0));
  return std::exp(-moments.b[0] * (before + overestimation * at.w0));
}

/// The same in GLSL.
inline constexpr std::string_view add = R"(
void sums_of(float t, float absorbance, out float sums[SUM_COUNT]) {
  float z = 2 * t - 1;
  for (int k = 0; k < SUM_COUNT; ++k) {
    sums[k] = absorbance;
    absorbance *= z;
  }
}
)";
inline constexpr std::string_view share = R"(
float share_of(float sums[SUM_COUNT], float t) {
  float moment_bias = curve_facts.x, overestimation = curve_facts.y, z0 = 2 * t - 1;
  vec4 b = mix(vec4(sums[1], sums[2], sums[3], sums[4]) / sums[0], vec4(0, 0.375, 0, 0.375), moment_bias);
  float d1 = max(b.y - b.x * b.x, 0.375 * moment_bias);
  float l21_d1 = b.z - b.x * b.y, l21 = l21_d1 / d1;
  float d2 = max(b.w - b.y * b.y - l21_d1 * l21, 0.234375 * moment_bias);
  float y1 = z0 - b.x, y2 = z0 * z0 - b.y - l21 * y1;
  float c2 = y2 / d2, c1 = y1 / d1 - l21 * c2, c0 = 1 - c1 * b.x - c2 * b.y;
  float halved = c1 / 2, root = sqrt(max(halved * halved - c0 * c2, 0));
  float q = -(halved + (halved < 0 ? -root : root));
  q = abs(q) < 1e-30 ? 1e-30 : q;
  float z = c0 / q, g = c2 / q, w0 = 1 / (1 + y1 * y1 / d1 + y2 * y2 / d2), rest = 1 - w0, apart = 1 - g * z;
  float w = apart == 0 ? rest : clamp((rest - g * (b.x - w0 * z0)) / apart, 0, rest);
  bool is_other_before = g > 0 ? z0 * g > 1 : g < 0 && z0 * g < 1;
  float before = (z < z0 ? w : 0) + (is_other_before ? rest - w : 0);
  return exp(-sums[0] * (before + overestimation * w0));
}
)";

}  // namespace gnomon::moment_transmittance
