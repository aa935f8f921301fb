// The view and the lights of a scene that brings none.
#include <algorithm>
#include <cmath>

#include "measure/scene/load.h"

namespace gnomon {
namespace {

/// Where the default eye and lights stand, seen from the middle: the eye above the right front, the lights above the left.
constexpr glm::dvec3 toward_eye{0.55, 0.5, 1}, toward_point{-0.7, 1.2, 0.55}, toward_sun{-0.6, 1, 0.3};

/// From three quarters and above, as near as an image no higher than wide can be and still show every vertex.
View framing_view(const Scene& scene, const glm::dvec3& middle) {
  View view;
  const glm::dvec3 back = glm::normalize(toward_eye), right = glm::normalize(glm::cross(glm::dvec3(0, 1, 0), back));
  const glm::dvec3 up = glm::cross(back, right);
  const double slope = std::tan(glm::radians(view.fov_y_degrees / 2.0));
  double distance = 0;
  for (const Mesh& mesh : scene.meshes)
    for (const glm::vec3& p : mesh.positions) {
      const glm::dvec3 q = glm::dvec3(p) - middle;
      const double aside = std::max(std::abs(glm::dot(q, right)), std::abs(glm::dot(q, up)));
      distance = std::max(distance, glm::dot(q, back) + aside / slope);
    }
  constexpr double margin = 1.05;
  view.target = middle;
  view.eye = middle + margin * distance * back;
  return view;
}

}  // namespace

void add_framing(Scene& scene) {
  const Bounds bounds = scene.bounds();
  if (bounds.empty()) return;
  const glm::dvec3 low(bounds.min), high(bounds.max), middle = (low + high) / 2.0;
  if (scene.views.empty()) {
    scene.views.push_back(framing_view(scene, middle));
    scene.notes.push_back("no view given: view 'view' frames the whole scene");
  }
  if (scene.lights.empty()) {
    // Twice the radius of the sphere around the bounds: outside all geometry.
    const glm::vec3 position(middle + glm::length(high - low) * glm::normalize(toward_point));
    scene.lights.push_back({.name = "point", .kind = PointLight{position}});
    scene.lights.push_back({.name = "sun", .kind = DirectionalLight{glm::vec3(-toward_sun)}});
    scene.notes.push_back("no light given: 'point' stands above the left front, 'sun' comes from there");
  }
}

}  // namespace gnomon
