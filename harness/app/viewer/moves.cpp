// The camera: where eye and target go.
#include "app/viewer/moves.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "app/viewer/moves_parts.h"

namespace gnomon::viewer {
namespace {

constexpr double pole_gap = std::numbers::pi / 360;  // half a degree

/// How far rounding a coordinate may turn the line of sight, in radians: half a unit in the last place of the largest one.
double coarseness(double largest_coordinate, double distance) { return largest_coordinate * 0x1p-24 / distance; }
constexpr double coarsest_zoom = 1e-4;
constexpr double coarsest = 1e-2;  // a hundred times that: from where a zoom ends, panning and flying still go on

double largest_coordinate(const glm::dvec3& p) { return std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)}); }

double coarseness(const View& view) {
  const glm::dvec3 eye(view.eye), target(view.target);
  return coarseness(std::max(largest_coordinate(eye), largest_coordinate(target)), glm::length(target - eye));
}

/// The view with this eye and target, rounded; the view as it is where they are none, or none that float32 can hold.
View with(const View& view, const glm::dvec3& eye, const glm::dvec3& target) {
  if (!is_castable(eye) || !is_castable(target)) return view;
  View moved = view;
  moved.eye = eye;
  moved.target = target;
  return is_valid(moved) && coarseness(moved) <= std::max(coarsest, coarseness(view)) ? moved : view;
}

/// `arm` turned about `axis` (unit) by `azimuth`, and away from it by `polar`, both in radians. It ends short of the poles; one
/// that is nearer to a pole already comes no nearer.
glm::dvec3 turned(const glm::dvec3& arm, const glm::dvec3& axis, double azimuth, double polar) {
  const double along = glm::dot(arm, axis);
  const glm::dvec3 away = arm - along * axis, outward = glm::normalize(away), ahead = glm::cross(axis, outward);
  const double before = std::atan2(glm::length(away), along);
  const double after = std::clamp(before + polar, std::min(before, pole_gap), std::max(before, std::numbers::pi - pole_gap));
  const glm::dvec3 flat = std::cos(azimuth) * outward + std::sin(azimuth) * ahead;
  return glm::length(arm) * (std::cos(after) * axis + std::sin(after) * flat);
}

glm::dvec3 axis(const View& view) { return glm::normalize(glm::dvec3(view.up)); }
glm::dvec3 sight(const View& view) { return glm::dvec3(view.target) - glm::dvec3(view.eye); }

/// The width of a pixel in the middle of the picture, a meter before the eye.
double pixel_width(const View& view, int height) { return 2 * Camera(view, 1, 1).tan_y / std::max(height, 1); }

/// Eye and target moved by the same step. Of each coordinate, the larger is rounded and the other follows at the offset that it
/// had: that stays to the bit where float32 holds it.
View shifted(const View& view, const glm::dvec3& by) {
  const glm::dvec3 offset = sight(view);
  glm::dvec3 eye = glm::dvec3(view.eye) + by, target = glm::dvec3(view.target) + by;
  if (!is_castable(eye) || !is_castable(target)) return view;
  for (int k = 0; k < 3; ++k)
    if (std::abs(eye[k]) > std::abs(target[k]))
      target[k] = static_cast<float>(eye[k]) + offset[k];
    else
      eye[k] = static_cast<float>(target[k]) - offset[k];
  return with(view, eye, target);
}

}  // namespace

View orbit_by(const View& view, glm::dvec2 angles) {
  if (angles == glm::dvec2(0)) return view;
  const glm::dvec3 target(view.target);
  return with(view, target + turned(-sight(view), axis(view), angles.x, -angles.y), target);
}

View orbit(const View& view, glm::dvec2 pixels, int height) {
  return orbit_by(view, std::numbers::pi / std::max(height, 1) * glm::dvec2(-pixels.x, pixels.y));
}

View pan(const View& view, glm::dvec2 pixels, int height) {
  const Camera camera(view, 1, 1);
  const double meters = pixel_width(view, height) * glm::length(sight(view));
  return shifted(view, meters * (pixels.y * camera.up - pixels.x * camera.right));
}

View zoom(const View& view, double steps) {
  if (steps == 0) return view;
  constexpr double least = 1e-9, most = 1e9;  // meters, for targets that are the origin or near it
  const glm::dvec3 target(view.target), arm = -sight(view);
  const double distance = glm::length(arm);
  const double nearest = std::max(least, coarseness(largest_coordinate(target), coarsest_zoom));
  const double wanted = std::clamp(distance * std::pow(0.9, steps), std::min(distance, nearest), std::max(distance, most));
  return with(view, target + wanted / distance * arm, target);
}

View look(const View& view, glm::dvec2 pixels, int height) {
  if (pixels == glm::dvec2(0)) return view;
  const glm::dvec3 eye(view.eye), arm = sight(view), up = axis(view);
  // The middle of the picture goes around the axis on a circle of this radius; near a pole it would have to spin.
  constexpr double least_radius = 0.2;
  const double radius = std::max(glm::length(glm::cross(glm::normalize(arm), up)), least_radius);
  const double angle = pixel_width(view, height);
  return with(view, eye, eye + turned(arm, up, angle * pixels.x / radius, -angle * pixels.y));
}

View fly(const View& view, glm::dvec3 steps, double step) {
  const Camera camera(view, 1, 1);
  return shifted(view, step * (steps.x * camera.right + steps.y * axis(view) + steps.z * camera.forward));
}

std::optional<glm::dvec2> project(const Camera& camera, const glm::dvec3& point) {
  const glm::dvec3 to_point = point - camera.eye;
  const double depth = glm::dot(to_point, camera.forward);
  if (!(depth > 0)) return std::nullopt;
  const double aspect = static_cast<double>(camera.width) / camera.height;
  const glm::dvec2 slope(glm::dot(to_point, camera.right) / depth / (camera.tan_y * aspect),
                         glm::dot(to_point, camera.up) / depth / camera.tan_y);
  if (!std::isfinite(slope.x) || !std::isfinite(slope.y)) return std::nullopt;
  return glm::dvec2((1 + slope.x) * camera.width / 2, (1 - slope.y) * camera.height / 2);
}

}  // namespace gnomon::viewer
