#pragma once
#include <fmt/core.h>

#include <glm/glm.hpp>
#include <string>
#include <string_view>

namespace gnomon::moment_map {

/// Hamburger's moment problem with four moments: of all distributions of depth that have them, the one with the least below t
/// lies on three points, t and the roots z of a quadratic; how much it has below t is in shadow for sure. `moment_bias` blends
/// the moments with those of both ends alike, 0 and 1, without which two layers of depth make a singular matrix, and so do
/// layers at the ends themselves: depths have to stay away from them.
inline constexpr std::string_view answer = R"(
float least_lit(vec4 mean, float t) {
  vec4 b = mix(mean, vec4(0.5), moment_bias);
  // Cholesky of the Hankel matrix (1 b1 b2; b1 b2 b3; b2 b3 b4) = L D L^T.
  float l32_d22 = b.z - b.x * b.y, d22 = b.y - b.x * b.x, spread = b.w - b.y * b.y;
  float d33_d22 = max(spread * d22 - l32_d22 * l32_d22, 1e-7 * d22), l32 = l32_d22 / d22;
  // Rounding makes the last of them less than nothing where two layers lie far apart; near nothing the bound is that of both.
  // It times c is (1, t, t^2): forward, diagonal, back.
  float c1 = t - b.x, c2 = t * t - b.y - l32 * c1;
  c1 /= d22, c2 *= d22 / d33_d22;
  c1 -= l32 * c2;
  float c0 = 1 - dot(vec2(c1, c2), b.xy);
  // The roots of c0 + c1 z + c2 z^2 are z and 1 / g: the other one goes through infinity where t is a layer of two, and the
  // difference that would give z loses all digits there.
  float half_c1 = 0.5 * c1, root = sqrt(max(half_c1 * half_c1 - c0 * c2, 0));
  float q = -(half_c1 + (half_c1 < 0 ? -root : root)), z = c0 / q, g = c2 / q;
  if (g >= 0 && t <= z) return 1;
  // What lies below t: all but t with its weight, or the nearer root with its weight.
  bool is_beyond_both = g < 0 ? t > z : t * g > 1;
  float dark = is_beyond_both ? 1 - (z - b.x * (z * g + 1) + b.y * g) / ((t - z) * (t * g - 1))
               : g < 0        ? g * g * (z * t - b.x * (z + t) + b.y) / ((1 - z * g) * (1 - t * g))
                              : (t - b.x * (1 + t * g) + b.y * g) / ((z * g - 1) * (z - t));
  return 1 - clamp(dark, 0, 1);
}
)";

/// Of 16 bits not the moments are stored but sums of them that fill 0 .. 1 for depths in 0 .. 1, so that rounding moves the
/// moments by little more (Peters and Klein 2015): a column says what each moment adds to one of them, or they to a moment.
inline const glm::dmat4 stored_of_moments(                        //
    -2.07224649, 32.23703778, -68.571074599, 39.3703274134,       //
    13.7948857237, -59.4683975703, 82.0359750338, -35.364903257,  //
    0.105877704, -1.9077466311, 9.3496555107, -6.6543490743,      //
    9.7924062118, -33.7652110555, 47.9456096605, -23.9728048165);
inline const glm::dmat4 moments_of_stored(                    //
    0.2227744146, 0.0771972861, 0.7926986636, 0.0319417555,   //
    0.1549679261, 0.1394629426, 0.7963415838, -0.1722823173,  //
    0.1451988946, 0.2120202157, 0.7258694464, -0.2758014811,  //
    0.163127443, 0.2591432266, 0.6539092497, -0.3376131734);
inline const glm::dvec4 stored_of_none(0.035955884801, 0, 0, 0);

/// In GLSL: `vec4 to_stored(vec4 moments)`, `vec4 from_stored(vec4 stored)`.
inline std::string stored(bool has_16_bits) {
  if (!has_16_bits) return "#define to_stored(moments) moments\n#define from_stored(stored) stored\n";
  const auto matrix = [](const glm::dmat4& m) {
    std::string text;
    for (int k = 0; k < 16; ++k) text += fmt::format("{}{:.10f}", k > 0 ? ", " : "mat4(", m[k / 4][k % 4]);
    return text + ")";
  };
  const std::string none = fmt::format("vec4({:.12f}, 0, 0, 0)", stored_of_none.x);
  return "vec4 to_stored(vec4 moments) { return moments * " + matrix(stored_of_moments) + " + " + none + "; }\n" +
         "vec4 from_stored(vec4 stored) { return (stored - " + none + ") * " + matrix(moments_of_stored) + "; }\n";
}

}  // namespace gnomon::moment_map
