#pragma once
#include <string_view>

// GLSL of backprojected_map. The head defines JOINTS, in the order of the parameter's choices.
namespace gnomon::backprojected_map {

inline constexpr std::string_view body = R"(
/// A disc counts as the square with its area: half sides are so much of the radius.
const float half_side = FIGURE == 1 ? 0.88622693 : 1.0;

/// From the plane of the figure seen along the axis, in texels at spread 1, to places of the light.
struct Back {
  mat2 places;
  vec2 tilt, steps_tilt;
  vec2 reach;  // half the box around the light, texels at spread 1
};

/// How much of the light's square, of area 4, the texels between two corners hide: the area of the patch, times the share of the
/// box around it that lies on the light; of a patch larger than the light, the share that it hides of the box around that.
float hidden_by(Back back, vec2 low, vec2 high) {
  vec2 extent = 0.5 * max(high - low, 0), center = back.places * (0.5 * (low + high));
  float per = 1 / max(1 + dot(back.tilt, center), 0.125);
  vec2 place = center * per;
  // How places change along columns and rows.
  vec2 along_x = (back.places[0] - place * back.steps_tilt.x) * per, along_y = (back.places[1] - place * back.steps_tilt.y) * per;
  vec2 box = abs(along_x) * extent.x + abs(along_y) * extent.y;
  vec2 on_light = max(min(place + box, vec2(1)) - max(place - box, vec2(-1)), 0);
  float area = abs(along_x.x * along_y.y - along_x.y * along_y.x) * extent.x * extent.y;
  vec2 on_patch = max(min(high, back.reach) - max(low, -back.reach), 0) / back.reach;
  float small = on_light.x * on_light.y * area / (box.x * box.y);
  return area > 0 ? (area > 1 ? on_patch.x * on_patch.y : small) : 0;
}

/// The share of the light's figure that is above the horizon.
float share_above(Point p) {
#if FIGURE == 1
  float x = clamp(p.horizon.x / max(length(p.horizon.yz), 1e-30), -1, 1);
  return 0.5 + (x * sqrt(1 - x * x) + asin(x)) / 3.1415927;
#else
  // Of a square before a line: with a >= b the slopes, a trapezoid's or a triangle's area.
  float a = max(abs(p.horizon.y), abs(p.horizon.z)), b = min(abs(p.horizon.y), abs(p.horizon.z)), h = abs(p.horizon.x);
  float corner = max(a + b - h, 0), less = h <= a - b ? 0.5 - 0.5 * h / max(a, 1e-30) : corner * corner / (8 * max(a * b, 1e-37));
  return p.horizon.x > 0 ? 1 - less : less;
#endif
}

float share_seen(Point p, out vec4 account) {
  float most = most_spread(p), spread = max(searched_spread(p), 0);
  account = vec4(p.position, min(spread, most), 0);
  mat2 figure = p.figure * half_side;
  vec2 tilt = p.tilt * half_side;
  float turn = figure[0].x * figure[1].y - figure[1].x * figure[0].y;
  float edge_on = 1e-20 * (dot(figure[0], figure[0]) + dot(figure[1], figure[1]));
  turn = (turn < 0 ? -1 : 1) * max(max(abs(turn), edge_on), 1e-37);
  mat2 places = mat2(figure[1].y, -figure[0].y, -figure[1].x, figure[0].x) / turn;
  Back back = Back(places, tilt, tilt * places, abs(figure[0]) + abs(figure[1]));

  vec2 radius = p.reach * spread, first = floor(p.position - radius), last = floor(p.position + radius);
  float hidden = 0;
  if (!(spread > 0)) last = first - 1;
  for (float y = first.y; y <= last.y; ++y) {
    float left = 0;  // spread of the texel before, where that hides
    for (float x = first.x - 1; x <= last.x; ++x) {
      vec2 texel = vec2(x, y);
      float stored = stored_depth(texel), own = is_hidden_by(p, texel, stored) ? spread_of(p, stored) : 0;
      vec2 at = texel - p.position;
      vec2 low = at / own, high = (at + 1) / own;
#if JOINTS > 0
      float above = stored_depth(texel - vec2(0, 1));
      above = is_hidden_by(p, texel - vec2(0, 1), above) ? spread_of(p, above) : 0;
      vec2 joint = at / vec2(left, above);
      if (JOINTS == 1) joint = min(joint, low);
      low = vec2(left > 0 ? joint.x : low.x, above > 0 ? joint.y : low.y);
#endif
      hidden += own > 0 && x >= first.x ? hidden_by(back, low, high) : 0;
      left = own;
    }
  }
  return 1 - hidden / (4 * max(share_above(p), 1e-6));
}
)";

}  // namespace gnomon::backprojected_map
