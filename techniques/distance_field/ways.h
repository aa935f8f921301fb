#pragma once
#include <gnomon/gbuffer.h>
#include <gnomon/kit/area/light_figure.h>
#include <gnomon/kit/rays/rays.h>

#include <cmath>
#include <numbers>
#include <optional>

#include "trace.h"

namespace gnomon::distance_field {

/// Where a way to a light with area goes: the middle of the box of what is above the horizon, and the disc across the way that
/// has the area of that box's part of the figure. Of a light that is wholly above the horizon that is its center and its area.
struct Aim {
  glm::dvec3 to;      ///< from the point
  double radius = 0;  ///< meters

  explicit Aim(const LightFigure& figure) : to(figure.at(figure.box().at(glm::dvec2(0.5)))) {
    const glm::dvec2 half = (figure.box().high - figure.box().low) / 2.0;
    const glm::dvec3 across = half.x * half.y * glm::cross(figure.half_u(), figure.half_v());
    const double quarter = std::abs(glm::dot(across, to)) / glm::length(to);
    radius = std::sqrt(figure.is_disc() ? quarter : quarter * 4 / std::numbers::pi);
  }
};

/// How far a ray goes until it has left a box; 0 where it misses it.
inline double leaves(const Bounds& box, const glm::dvec3& start, const glm::dvec3& direction) {
  if (box.empty()) return 0;
  double near = 0, far = INFINITY;
  for (int k = 0; k < 3; ++k) {
    const double low = box.min[k] - start[k], high = box.max[k] - start[k];
    if (direction[k] == 0) {
      if (low > 0 || high < 0) return 0;
      continue;
    }
    near = std::max(near, std::min(low / direction[k], high / direction[k]));
    far = std::min(far, std::max(low / direction[k], high / direction[k]));
  }
  return near <= far ? far : 0;
}

/// The way of a pixel by the recipe of shadow rays (docs/method.md); nothing of a pixel that does not face the light.
inline std::optional<Way> way_of(const Fields& fields, const GBuffer& gbuffer, const Light& light, std::size_t pixel) {
  const Scene& scene = fields.scene();
  if (gbuffer.is_background(pixel) || !scene.meshes[gbuffer.mesh[pixel]].receives) return std::nullopt;
  const glm::dvec3 point(gbuffer.position(pixel)), normal(gbuffer.normal(pixel));
  Way way;
  way.own = fields.of_mesh(gbuffer.mesh[pixel]);
  way.start = point + ray_offset(gbuffer.position(pixel)) * normal;
  glm::dvec3 to;
  double radius = 0;
  if (has_area(light)) {
    const LightFigure figure(light, point, normal);
    if (!figure.is_seen()) return std::nullopt;
    const Aim aim(figure);
    to = point + aim.to - way.start;
    radius = aim.radius;
  } else {
    if (!faces_light(scene, gbuffer, light, pixel)) return std::nullopt;
    to = to_light(homogeneous(light), way.start);
  }
  const double distance = glm::length(to);
  if (!(distance > 0)) return way;
  way.direction = to / distance;
  way.widening = radius / distance;
  way.length = distance;
  if (!has_area(light)) {
    const double exit = leaves(fields.tree().bounds(), way.start, way.direction);
    way.length = homogeneous(light).w != 0 ? std::min(distance, exit) : exit;
  }
  way.cone_end = way.length / (1 + way.widening);
  return way;
}

}  // namespace gnomon::distance_field
