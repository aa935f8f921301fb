#pragma once
#include <gnomon/scene.h>

namespace gnomon {

/// Visits the members of a light's kind or of a shape by name and value, in the order of a scene file's keys: `place` gets each
/// point, `side` each half side of a rectangle, `axis` each direction, `length` each radius and height. Of a triangle it visits
/// its three points, of a light neither angles nor `emits`.
void for_each_part(auto& item, const auto& place, const auto& side, const auto& axis, const auto& length) {
  if constexpr (requires { item.position; }) place("position", item.position);
  if constexpr (requires { item.center; }) place("center", item.center);
  if constexpr (requires { item.base; }) place("base", item.base);
  if constexpr (requires { item.min; }) place("min", item.min);
  if constexpr (requires { item.max; }) place("max", item.max);
  if constexpr (requires { item.points; })
    for (auto& point : item.points) place("points", point);
  if constexpr (requires { item.half_u; }) side("half_u", item.half_u);
  if constexpr (requires { item.half_v; }) side("half_v", item.half_v);
  if constexpr (requires { item.direction; }) axis("direction", item.direction);
  if constexpr (requires { item.normal.x; }) axis("normal", item.normal);  // a triangle's is a function
  if constexpr (requires { item.axis; }) axis("axis", item.axis);
  if constexpr (requires { item.radius; }) length("radius", item.radius);
  if constexpr (requires { item.height; }) length("height", item.height);
}

}  // namespace gnomon
