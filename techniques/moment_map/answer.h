#pragma once
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
  float d33_d22 = spread * d22 - l32_d22 * l32_d22, l32 = l32_d22 / d22;
  // It times c is (1, t, t^2): forward, diagonal, back.
  float c1 = t - b.x, c2 = t * t - b.y - l32 * c1;
  c1 /= d22, c2 *= d22 / d33_d22;
  c1 -= l32 * c2;
  float c0 = 1 - dot(vec2(c1, c2), b.xy);
  // The roots of c0 + c1 z + c2 z^2.
  float half_p = 0.5 * c1 / c2, root = sqrt(max(half_p * half_p - c0 / c2, 0));
  float near = -half_p - root, far = -half_p + root;
  if (t <= near) return 1;
  // What lies below t: the nearer root with its weight, or all but t with its weight.
  bool is_beyond_both = t > far;
  float dark = is_beyond_both ? 1 - (near * far - b.x * (near + far) + b.y) / ((t - near) * (t - far))
                              : (far * t - b.x * (far + t) + b.y) / ((near - far) * (near - t));
  return 1 - clamp(dark, 0, 1);
}
)";

}  // namespace gnomon::moment_map
