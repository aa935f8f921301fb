#include "measure/scene/turned_light.h"

#include <cmath>

namespace gnomon {

namespace {

struct Turn {
  glm::dvec3 about;
  double cosine, sine;

  glm::dvec3 turned(const glm::dvec3& v) const { return {cosine * v.x + sine * v.z, v.y, cosine * v.z - sine * v.x}; }
  void axis(glm::vec3& v) const { v = glm::vec3(turned(v)); }
  void place(glm::vec3& p) const { p = glm::vec3(about + turned(glm::dvec3(p) - about)); }

  void operator()(PointLight& l) const { place(l.position); }
  void operator()(DirectionalLight& l) const { axis(l.direction); }
  void operator()(SpotLight& l) const {
    place(l.position);
    axis(l.direction);
  }
  void operator()(RectLight& l) const {
    place(l.center);
    axis(l.half_u);
    axis(l.half_v);
  }
  void operator()(DiscLight& l) const {
    place(l.center);
    axis(l.normal);
  }
  void operator()(SphereLight& l) const { place(l.center); }
};

}  // namespace

Light turned(const Light& light, const glm::dvec3& about, double radians) {
  Light result = light;
  std::visit(Turn{about, std::cos(radians), std::sin(radians)}, result.kind);
  return result;
}

}  // namespace gnomon
