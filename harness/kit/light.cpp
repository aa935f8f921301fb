#include <gnomon/light.h>

#include <cmath>

namespace gnomon {

std::string_view kind_name(const Light& light) {
  static constexpr std::string_view names[] = {"point", "spot", "directional", "rect", "disc", "sphere"};
  return names[light.kind.index()];
}

bool has_area(const Light& light) { return light.kind.index() >= 3; }

glm::dvec4 homogeneous(const Light& light) {
  struct Visitor {
    glm::dvec4 operator()(const PointLight& l) const { return {l.position, 1}; }
    glm::dvec4 operator()(const SpotLight& l) const { return {l.position, 1}; }
    glm::dvec4 operator()(const DirectionalLight& l) const { return {-l.direction, 0}; }
    glm::dvec4 operator()(const RectLight& l) const { return {l.center, 1}; }
    glm::dvec4 operator()(const DiscLight& l) const { return {l.center, 1}; }
    glm::dvec4 operator()(const SphereLight& l) const { return {l.center, 1}; }
  };
  return std::visit(Visitor{}, light.kind);
}

bool in_spot_cone(const Light& light, const glm::dvec3& point) {
  const auto* spot = std::get_if<SpotLight>(&light.kind);
  if (!spot) return true;
  const glm::dvec3 away = point - glm::dvec3(spot->position);
  const double cosine = std::cos(glm::radians(static_cast<double>(spot->outer_degrees)));
  return glm::dot(away, glm::normalize(glm::dvec3(spot->direction))) > cosine * glm::length(away);
}

}  // namespace gnomon
