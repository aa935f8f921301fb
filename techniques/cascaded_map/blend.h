#pragma once
#include <string_view>

namespace gnomon::cascaded_map {

/// The decision of slices that are blended: in the far part of a slice, over as much depth as its overlap, the answer goes over
/// from its own image to the next one's. The last slice has none to go over to.
inline constexpr std::string_view blend_snippet = R"(
uniform vec3 overlaps;  // of the slices but the last, meters
struct Blend {
  float share;  // of the next slice's answer
  float ahead;  // from the point's depth into that slice, by a quarter of the overlap, which no slice is shorter than
};
Blend blend_at(vec4 surface) {
  float depth = depth_along_view(surface.xyz - light_origin);
  bool is_second = depth > light_ends.x, is_third = depth > light_ends.y, is_fourth = depth > light_ends.z;
  float end = is_third ? light_ends.z : is_second ? light_ends.y : light_ends.x;
  float overlap = is_fourth ? 0.0 : is_third ? overlaps.z : is_second ? overlaps.y : overlaps.x;
  float share = overlap > 0 ? clamp((depth - end) / overlap + 1, 0, 1) : 0.0;
  return Blend(share, share > 0 ? end - depth + 0.25 * overlap : 0.0);
}
ComparedPoint asked_again(vec4 surface, vec4 facet) {
  light_ahead = blend_at(surface).ahead;
  ComparedPoint point = ask(surface, facet);
  light_ahead = 0;
  return point;
}
float decided(vec4 surface, vec4 facet, ComparedPoint point) {
  float lit = compared(point), share = blend_at(surface).share;
  if (share > 0) lit += share * (compared(asked_again(surface, facet)) - lit);
  return lit;
}
float noted(vec4 surface, vec4 facet, ComparedPoint point) { return blend_at(surface).share; }
)";

}  // namespace gnomon::cascaded_map
