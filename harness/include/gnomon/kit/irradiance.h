#pragma once
#include <gnomon/light.h>

#include <vector>

namespace gnomon {

/// What the light gives a surface at `point` with the unit `normal`, without casters, in W/m2: cosine and inverse square, of a
/// light with area integrated over what is above the surface's horizon. 0 behind the surface and where a spot does not shine.
double irradiance(const Light& light, const glm::dvec3& point, const glm::dvec3& normal);

/// How much of a spot's intensity goes toward the point: 1 within its inner cone, 0 outside of its outer one, between them as
/// glTF has it (KHR_lights_punctual): the square of a linear function of the cosine. 1 of every other light.
double spot_share(const Light& light, const glm::dvec3& point);

/// The lights with intensities that give a surface at `point`, turned to each light's center, `watts` per square meter; 1 where
/// a light does not reach the point.
std::vector<Light> shining_at(const glm::vec3& point, std::vector<Light> lights, double watts = 1);

}  // namespace gnomon
