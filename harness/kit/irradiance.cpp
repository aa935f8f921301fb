#include <gnomon/kit/area/light_figure.h>
#include <gnomon/kit/irradiance.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace gnomon {

double spot_share(const Light& light, const glm::dvec3& point) {
  const auto* spot = std::get_if<SpotLight>(&light.kind);
  if (!spot) return 1;
  if (!in_spot_cone(light, point)) return 0;
  const glm::dvec3 way = point - glm::dvec3(spot->position);
  const double cosine = glm::dot(way, glm::normalize(glm::dvec3(spot->direction))) / glm::length(way);
  const double inner = std::cos(glm::radians(double(spot->inner_degrees)));
  const double outer = std::cos(glm::radians(double(spot->outer_degrees)));
  if (cosine >= inner) return 1;
  if (cosine <= outer) return 0;
  const double share = (cosine - outer) / (inner - outer);
  return share * share;
}

double irradiance(const Light& light, const glm::dvec3& point, const glm::dvec3& normal) {
  if (has_area(light)) return light.intensity * LightFigure(light, point, normal).irradiance();
  const glm::dvec4 l = homogeneous(light);
  const glm::dvec3 to = to_light(l, point);
  const double distance = glm::length(to), cosine = glm::dot(normal, to) / distance;
  if (!(cosine > 0)) return 0;  // also at the light
  return light.intensity * spot_share(light, point) * cosine / (l.w != 0 ? distance * distance : 1);
}

std::vector<Light> shining_at(const glm::vec3& point, std::vector<Light> lights, double watts) {
  for (Light& light : lights) {
    light.intensity = 1;
    const glm::dvec3 way = to_light(homogeneous_of_center(light), point);
    const double at_one = glm::length(way) > 0 ? irradiance(light, point, glm::normalize(way)) : 0;
    constexpr double least = std::numeric_limits<float>::min(), most = std::numeric_limits<float>::max();
    if (at_one > 0) light.intensity = static_cast<float>(std::clamp(watts / at_one, least, most));
  }
  return lights;
}

}  // namespace gnomon
