#pragma once
#include <string_view>

// GLSL of percentage_closer_soft, mirrored by its explanation. The head defines TURNED and SEARCH_ALL; the taps come as
// uniforms.
namespace gnomon::percentage_closer_soft {

/// The account is where filter or search looked: position, spread (of a search that found nothing negative), turn.
inline constexpr std::string_view body = R"(
uniform int search_taps, filter_taps;

/// Between 0 and 1, different between neighbors (Jimenez 2014).
float turn_here() {
  return TURNED == 1 ? fract(52.9829189 * fract(dot(vec2(0.06711056, 0.00583715), floor(gl_FragCoord.xy)))) : 0.0;
}

/// Places of the light's figure, evenly spread, one after the other. The state that makes the next one is a unit direction on a
/// disc, and a place of the unit square on a rectangle.
vec2 first_state(float turn) {
#if FIGURE == 1
  return vec2(cos(6.2831853 * turn), sin(6.2831853 * turn));
#else
  return fract(vec2(0.5 + turn, 0.5 + 1.6180340 * turn));
#endif
}
vec2 next_place(inout vec2 state, int index, int count) {
#if FIGURE == 1
  vec2 place = state * sqrt((float(index) + 0.5) / float(count));
  const vec2 golden = vec2(-0.73736888, 0.67549030);  // cosine and sine of the golden angle
  state = vec2(dot(state, vec2(golden.x, -golden.y)), dot(state, golden.yx));
#else
  vec2 place = 2 * state - 1;
  state = fract(state + vec2(0.75487767, 0.56984029));
#endif
  return place;
}

float share_seen(Point p, out vec4 account) {
  float turn = turn_here();
#if SEARCH_ALL
  float spread = min(1 / light_facts.z - 1 / p.z, most_spread(p));
#else
  Point searched = p;
  float spread = min(searched_spread(searched), most_spread(p));
#endif
  float found = 0, depths = 0, near = light_facts.z;
  vec2 state = first_state(turn);
  for (int k = 0; k < search_taps; ++k) {
    vec2 texel = floor(p.position + offset_of(p, spread, next_place(state, k, search_taps)));
    float stored = stored_depth(texel);
    bool hides = spread > 0 && is_hidden_by(p, texel, stored);
    found += hides ? 1 : 0;
    depths += hides ? near / stored : 0;
  }
  account = vec4(p.position, -max(spread, 0), turn);
  if (found == 0) return 1;
  spread = clamp(found / depths - 1 / p.z, 0, most_spread(p));
  account.z = spread;
  float seen = 0, sum = 0;
  state = first_state(turn);
  for (int k = 0; k < filter_taps; ++k) {
    vec2 place = next_place(state, k, filter_taps);
    vec2 texel = floor(p.position + offset_of(p, spread, place));
    float weight = height_of(p, place) > 0 ? 1 : 0;
    seen += is_hidden_by(p, texel, stored_depth(texel)) ? 0 : weight;
    sum += weight;
  }
  return sum > 0 ? seen / sum : 1;
}
)";

}  // namespace gnomon::percentage_closer_soft
