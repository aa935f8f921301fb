#pragma once
#include <cstdint>
#include <glm/glm.hpp>
#include <string>
#include <string_view>
#include <variant>

namespace gnomon {

// World space, meters, float32 rounded once at load; exact techniques widen to double.

struct PointLight {
  glm::vec3 position{0};
};
struct SpotLight {
  glm::vec3 position{0};
  glm::vec3 direction{0, -1, 0};  ///< the way light travels, any length
  float inner_degrees = 20;       ///< half-angle of full intensity; see spot_share
  float outer_degrees = 30;       ///< half-angle of the cone, below 90; outside it a pixel is class F
};
struct DirectionalLight {
  glm::vec3 direction{0, -1, 0};  ///< the way light travels, any length
};
/// Where a flat light emits. Of four bytes, so that lights have no gaps between their fields.
enum class Emits : std::uint32_t { on_both_sides, in_front };
/// Rectangle center +- half_u +- half_v; its front is on the side of cross(half_u, half_v).
struct RectLight {
  glm::vec3 center{0}, half_u{1, 0, 0}, half_v{0, 0, 1};
  Emits emits = Emits::on_both_sides;
};
/// Its front is on the side of its normal.
struct DiscLight {
  glm::vec3 center{0}, normal{0, -1, 0};
  float radius = 1;
  Emits emits = Emits::on_both_sides;
};
struct SphereLight {
  glm::vec3 center{0};
  float radius = 1;
};

using LightKind = std::variant<PointLight, SpotLight, DirectionalLight, RectLight, DiscLight, SphereLight>;

/// Of radiation of 540 THz, to which the candela and the lux are tied: a watt is taken for so many lumens, whatever its color.
inline constexpr double lumens_per_watt = 683;

struct Light {
  std::string name = "light";  ///< unique in its scene, [a-z0-9_]
  LightKind kind;
  /// W/sr of a point and of a spot, toward its inner cone; W/m2 of a directional light, on a surface across its direction;
  /// W/(m2 sr), its radiance, of a light with area.
  float intensity = 1;
};

/// "point", "spot", "directional", "rect", "disc", "sphere".
std::string_view kind_name(const Light& light);

/// Whether the light has an area, hence penumbrae.
bool has_area(const Light& light);

/// The homogeneous light: (position, 1), or (-direction, 0) where direction is the way light travels. Exact: the floats of the
/// light, widened. A light with area is neither; throws Error with its name.
glm::dvec4 homogeneous(const Light& light);
/// The same, and of a light with area its center, for who means that. Nothing else converts a light to a point or direction.
glm::dvec4 homogeneous_of_center(const Light& light);

/// From `point` to the light, not normalized: position - point, or -direction.
inline glm::dvec3 to_light(const glm::dvec4& homogeneous_light, const glm::dvec3& point) {
  return glm::dvec3(homogeneous_light) - homogeneous_light.w * point;
}

/// Whether `point` lies inside the cone of a spot light; true for every other light.
bool in_spot_cone(const Light& light, const glm::dvec3& point);

}  // namespace gnomon
