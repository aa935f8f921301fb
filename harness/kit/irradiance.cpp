#include <gnomon/kit/irradiance.h>
#include <gnomon/kit/light_face.h>

#include <algorithm>
#include <cmath>

namespace gnomon {

double spot_share(const Light& light, const glm::dvec3& point) {
  const auto* spot = std::get_if<SpotLight>(&light.kind);
  if (!spot) return 1;
  if (!in_spot_cone(light, point)) return 0;
  const glm::dvec3 way = point - glm::dvec3(spot->position);
  const double cosine = glm::dot(way, glm::normalize(glm::dvec3(spot->direction))) / glm::length(way);
  const double inner = std::cos(glm::radians(double(spot->inner_degrees)));
  const double outer = std::cos(glm::radians(double(spot->outer_degrees)));
  const double share = std::clamp((cosine - outer) / std::max(inner - outer, 1e-3), 0.0, 1.0);
  return share * share;
}

double irradiance(const Light& light, const glm::dvec3& point, const glm::dvec3& normal) {
  if (has_area(light)) return light.intensity * LightFace(light, point, normal).irradiance();
  const glm::dvec4 l = homogeneous(light);
  const glm::dvec3 to = to_light(l, point);
  const double distance = glm::length(to), cosine = glm::dot(normal, to) / distance;
  if (!(cosine > 0)) return 0;  // also at the light
  return light.intensity * spot_share(light, point) * cosine / (l.w != 0 ? distance * distance : 1);
}

std::vector<Light> shining_at(const glm::vec3& point, std::vector<Light> lights, double watts) {
  for (Light& light : lights) {
    light.intensity = 1;
    const glm::dvec3 toward = glm::normalize(to_light(homogeneous_of_center(light), point));
    light.intensity = static_cast<float>(watts / irradiance(light, point, toward));
  }
  return lights;
}

}  // namespace gnomon
