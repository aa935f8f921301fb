#pragma once
// A world with one casting triangle, whose shadow on all others is known, and its pictures.
#include <gnomon/kit/geometry/clip.h>

#include "hand_made.h"
#include "small_world.h"

namespace gnomon::surface_world {

using hand_made::point_light, hand_made::sun;

inline glm::vec3 color(const std::vector<float>& picture, std::size_t i) {
  return {picture[3 * i], picture[3 * i + 1], picture[3 * i + 2]};
}
inline float largest(const glm::vec3& v) { return std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)}); }
inline bool is_warm(const glm::vec3& c) { return c.r > 1.5f * c.b; }
inline bool is_cool(const glm::vec3& c) { return c.b > 1.5f * c.r; }

using Polygon = std::vector<Corner>;

/// The part of a polygon on the positive side of a plane stays, the other one is returned; either may be empty.
inline Polygon cut_away(Polygon& polygon, const ClipPlane& plane) {
  std::vector<double> values(polygon.size());
  Polygon negative(polygon.size() + 1), positive(polygon.size() + 1);
  switch (classify(polygon, plane, 1e-10, values.data())) {
    case Lies::positive:
      return {};
    case Lies::across: {
      const CutCounts counts = cut_polygon(polygon, values.data(), 1e-10, 1, negative.data(), positive.data());
      negative.resize(counts.negative), positive.resize(counts.positive);
      polygon = positive;
      return negative;
    }
    default:
      return std::exchange(polygon, {});
  }
}

/// The shadow volume of one triangle: inside its shadow planes and behind it.
struct Shadow {
  glm::vec3 corners[3];
  std::vector<ClipPlane> planes;  ///< positive inside

  Shadow(const Mesh& mesh, const Light& light) {
    for (int k = 0; k < 3; ++k) corners[k] = mesh.positions[mesh.triangles[0][k]];
    const glm::dvec4 l = homogeneous(light);
    const auto toward = [](const glm::dvec3& normal, const glm::dvec3& on, const glm::dvec3& inside) {
      const glm::dvec3 n = glm::normalize(glm::dot(normal, inside - on) > 0 ? normal : -normal);
      return ClipPlane{n, -glm::dot(n, on)};
    };
    for (int k = 0; k < 3; ++k) {
      const glm::dvec3 a(corners[k]), b(corners[(k + 1) % 3]), c(corners[(k + 2) % 3]);
      planes.push_back(toward(glm::cross(b - a, to_light(l, a)), a, c));
    }
    const glm::dvec3 a(corners[0]), normal = glm::cross(glm::dvec3(corners[1]) - a, glm::dvec3(corners[2]) - a);
    planes.push_back(toward(normal, a, a - to_light(l, a)));
  }

  /// Calls part(corners, is_lit) for the parts of a polygon of any triangle but its own.
  template <class Part>
  void divide(Polygon polygon, const Part& part) const {
    for (const ClipPlane& plane : planes) {
      if (polygon.empty()) return;
      if (const Polygon outside = cut_away(polygon, plane); !outside.empty()) part(outside, true);
    }
    if (!polygon.empty()) part(polygon, false);
  }
};

/// A scene of one triangle that casts, mesh 0, and others that do not, around an eye; with its picture and shadow by brute
/// force.
struct World {
  Scene scene;
  Light light;
  GBuffer gbuffer;
  std::vector<float> mask;

  World(unsigned seed, bool is_in_the_sun) {
    std::mt19937 random(seed);
    scene.meshes.push_back(small_world::random_soup(random, 1, 1, -1, 1, 1.5f));
    scene.meshes.push_back(small_world::random_soup(random, 40, 2, -2, 2, 1));
    scene.meshes.push_back(small_world::ground(4, -2));
    scene.meshes.push_back(small_world::box({-4, -3, -4}, {4, 4, 4}));
    for (Mesh& mesh : scene.meshes) mesh.casts = &mesh == scene.meshes.data();
    for (Mesh& mesh : scene.meshes)
      mesh.albedo = glm::vec3(0.2f + 0.1f * static_cast<float>(&mesh - scene.meshes.data()), 0.5f, 0.4f);
    scene.meshes[3].receives = seed % 4 != 0;
    std::uniform_real_distribution<float> place(-2, 2);
    const auto point = [&] {
      const float x = place(random), y = place(random), z = place(random);
      return glm::vec3(x, y, z);
    };
    light = is_in_the_sun ? sun(point()) : point_light(1.6f * point());
    const glm::vec3 target = point(), eye = point();
    look(eye, target);
  }
  void look(const glm::vec3& eye, const glm::vec3& target) {
    gbuffer = small_world::make_gbuffer(scene, {.eye = eye, .target = target, .fov_y_degrees = 75}, 64, 48);
    mask.assign(gbuffer.size(), 1);
    for (std::size_t i = 0; i < gbuffer.size(); ++i)
      if (faces_light(scene, gbuffer, light, i) && gbuffer.mesh[i] != 0)
        mask[i] = std::isinf(small_world::caster_distance(scene, light, gbuffer.position(i)));
  }
  /// Whether triangle and answer are the same at all pixels around.
  bool is_plain(std::size_t i) const {
    const int x = static_cast<int>(i) % 64, y = static_cast<int>(i) / 64;
    for (int v = std::max(0, y - 1); v <= std::min(47, y + 1); ++v)
      for (int u = std::max(0, x - 1); u <= std::min(63, x + 1); ++u) {
        const auto j = static_cast<std::size_t>(64 * v + u);
        if (gbuffer.mesh[j] != gbuffer.mesh[i] || gbuffer.triangle[j] != gbuffer.triangle[i] || mask[j] != mask[i])
          return false;
      }
    return true;
  }
};

}  // namespace gnomon::surface_world
