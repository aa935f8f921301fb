#pragma once
// What the tests of camera and light moves share: any view, a small scene, lights of every kind, and what rounding costs.
#include <gnomon/kit/geometry/camera.h>
#include <gnomon/kit/random.h>
#include <gnomon/scene.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "measure/scene/load.h"

namespace viewer_world {

using namespace gnomon;

inline constexpr double pi = std::numbers::pi;
inline constexpr int height = 540, width = 960;

/// Half a unit in the last place of the largest coordinate of eye and target: what one rounding may cost a coordinate.
inline double rounding(const View& view) {
  double largest = 0;
  for (int k = 0; k < 3; ++k) largest = std::max({largest, std::abs(1.0 * view.eye[k]), std::abs(1.0 * view.target[k])});
  return std::ldexp(1.0, std::ilogb(largest) - 24);
}

inline double distance(const View& view) { return glm::length(glm::dvec3(view.eye) - glm::dvec3(view.target)); }
inline glm::dvec3 offset(const View& view) { return glm::dvec3(view.target) - glm::dvec3(view.eye); }
inline double gap(const glm::dvec3& a, const glm::dvec3& b) {
  const glm::dvec3 d = glm::abs(a - b);
  return std::max({d.x, d.y, d.z});
}
inline bool same(const View& a, const View& b) {
  return a.name == b.name && a.eye == b.eye && a.target == b.target && a.up == b.up && a.fov_y_degrees == b.fov_y_degrees;
}

/// A view that `check` accepts, anywhere in a world of `size` meters, with any `up` and opening.
inline View any_view(Random& random, double size) {
  View view;
  const glm::dvec3 middle = random.uniform(glm::dvec3(-size), glm::dvec3(size));
  do {
    view.target = middle;
    view.eye = middle + size * random.uniform(glm::dvec3(-1), glm::dvec3(1));
    view.up = std::exp(random.uniform(-5, 5)) * random.uniform(glm::dvec3(-1), glm::dvec3(1));
  } while (distance(view) < 0.1 * size ||
           glm::length(glm::cross(glm::normalize(offset(view)), glm::normalize(glm::dvec3(view.up)))) < 0.2);
  view.fov_y_degrees = static_cast<float>(random.uniform(5, 120));
  check(view, "test");
  return view;
}

/// How much more than the line of sight the picture's frame may turn by a rounding of both ends: `any_view` keeps `up` at a
/// sine of 0.2 from it.
inline constexpr double swing = 2 / 0.2;

inline constexpr double sizes[] = {1e-3, 1, 1e5};

/// A plate of 8 x 6 meters and a tip 2 meters over it: bounds (-4, 0, -3) .. (4, 2, 3), scaled and moved.
inline Scene roof(double size = 1, const glm::dvec3& at = glm::dvec3(0)) {
  Scene scene;
  Mesh mesh;
  for (const glm::dvec3& p :
       {glm::dvec3(-4, 0, -3), glm::dvec3(4, 0, -3), glm::dvec3(4, 0, 3), glm::dvec3(-4, 0, 3), glm::dvec3(0, 2, 0)})
    mesh.positions.push_back(glm::vec3(at + size * p));
  mesh.triangles = {{0, 1, 4}, {1, 2, 4}, {2, 3, 4}, {3, 0, 4}};
  scene.meshes = {mesh};
  return scene;
}

inline std::vector<Light> all_kinds() {
  return {{.name = "point", .kind = PointLight{{1, 2, 3}}},
          {.name = "spot", .kind = SpotLight{{1, 2, 3}, {0, -1, 1}, 10, 20}},
          {.name = "sun", .kind = DirectionalLight{{-0.3f, -2, 0.5f}}, .intensity = 2},
          {.name = "rect", .kind = RectLight{{1, 2, 3}, {1, 0, 0}, {0, 1, 0}}},
          {.name = "disc", .kind = DiscLight{{1, 2, 3}, {0, -1, 0}, 0.5f}},
          {.name = "sphere", .kind = SphereLight{{1, 2, 3}, 0.5f}}};
}

}  // namespace viewer_world
