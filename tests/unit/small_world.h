#pragma once
#include <gnomon/kit/random.h>
#include <gnomon/registry.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <random>
#include <vector>

// Small scenes, their G-buffers and their shadows by brute force in double: independent of Embree, of OpenGL and of the kit.
namespace small_world {
using namespace gnomon;

inline Mesh make_mesh(std::vector<glm::vec3> positions, std::vector<glm::uvec3> triangles, bool casts = true,
                      bool receives = true) {
  Mesh mesh;
  mesh.positions = std::move(positions);
  mesh.triangles = std::move(triangles);
  mesh.casts = casts;
  mesh.receives = receives;
  finish(mesh);
  return mesh;
}

/// The square |x|, |z| <= half at height y.
inline Mesh ground(float half, float y = 0, bool casts = true) {
  return make_mesh({{-half, y, -half}, {-half, y, half}, {half, y, half}, {half, y, -half}}, {{0, 1, 2}, {0, 2, 3}}, casts);
}

inline Mesh box(const glm::vec3& a, const glm::vec3& b) {
  std::vector<glm::vec3> p;
  for (int i = 0; i < 8; ++i) p.push_back({i & 1 ? b.x : a.x, i & 2 ? b.y : a.y, i & 4 ? b.z : a.z});
  return make_mesh(p, {{0, 2, 3},
                       {0, 3, 1},
                       {4, 5, 7},
                       {4, 7, 6},
                       {0, 1, 5},
                       {0, 5, 4},
                       {2, 6, 7},
                       {2, 7, 3},
                       {0, 4, 6},
                       {0, 6, 2},
                       {1, 3, 7},
                       {1, 7, 5}});
}

inline Mesh random_soup(std::mt19937& random, int count, float half, float low, float high, float size) {
  std::uniform_real_distribution<float> across(-half, half), height(low, high), edge(-size, size);
  std::vector<glm::vec3> p;
  std::vector<glm::uvec3> t;
  for (unsigned i = 0; i < unsigned(count); ++i) {
    // One number after the other, the last one first: the arguments of a call are drawn in another order by each compiler.
    const float z = across(random), y = height(random), x = across(random);
    for (int k = 0; k < 3; ++k) {
      const float dz = edge(random), dy = edge(random), dx = edge(random);
      p.push_back(glm::vec3(x, y, z) + glm::vec3(dx, dy, dz));
    }
    t.push_back({3 * i, 3 * i + 1, 3 * i + 2});
  }
  return make_mesh(p, t);
}

struct Hit {
  double t = std::numeric_limits<double>::infinity();
  std::uint32_t mesh = no_mesh, triangle = 0;
};

/// Ray parameter of the triangle a b c, or infinity (Moeller and Trumbore 1997, in double).
inline double intersect(const glm::dvec3& origin, const glm::dvec3& direction, const glm::dvec3& a, const glm::dvec3& b,
                        const glm::dvec3& c) {
  const glm::dvec3 e1 = b - a, e2 = c - a, p = glm::cross(direction, e2), s = origin - a, q = glm::cross(s, e1);
  const double determinant = glm::dot(e1, p);
  const double u = glm::dot(s, p) / determinant, v = glm::dot(direction, q) / determinant;
  const bool inside = determinant != 0 && u >= 0 && v >= 0 && u + v <= 1;
  return inside ? glm::dot(e2, q) / determinant : std::numeric_limits<double>::infinity();
}

/// The nearest triangle with ray parameter above `from`.
inline Hit nearest(const Scene& scene, const glm::dvec3& origin, const glm::dvec3& direction, double from,
                   bool casters_only = false) {
  Hit best;
  for (std::uint32_t m = 0; m < scene.meshes.size(); ++m) {
    const Mesh& mesh = scene.meshes[m];
    if (casters_only && !mesh.casts) continue;
    for (std::uint32_t i = 0; i < mesh.triangles.size(); ++i) {
      const glm::uvec3& t = mesh.triangles[i];
      const double hit = intersect(origin, direction, mesh.positions[t.x], mesh.positions[t.y], mesh.positions[t.z]);
      if (hit > from && hit < best.t) best = {hit, m, i};
    }
  }
  return best;
}

/// The mesh-truth G-buffer of a view.
inline GBuffer make_gbuffer(const Scene& scene, const View& view, int width, int height) {
  struct Storage {
    std::vector<float> p[3], n[3];
    std::vector<std::uint32_t> mesh, triangle;
  };
  auto s = std::make_shared<Storage>();
  const glm::dvec3 eye = view.eye, forward = glm::normalize(glm::dvec3(view.target) - eye);
  const glm::dvec3 right = glm::normalize(glm::cross(forward, glm::dvec3(view.up))), up = glm::cross(right, forward);
  const double tangent = std::tan(glm::radians(double(view.fov_y_degrees)) / 2);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const glm::dvec3 ray = forward + right * (tangent * width / height * (2 * (x + 0.5) / width - 1)) +
                             up * (tangent * (1 - 2 * (y + 0.5) / height));
      const Hit hit = nearest(scene, eye, ray, 0);
      glm::dvec3 point(0), normal(0);
      if (hit.mesh != no_mesh) {
        const Mesh& mesh = scene.meshes[hit.mesh];
        const glm::uvec3& t = mesh.triangles[hit.triangle];
        const glm::dvec3 a = mesh.positions[t.x], b = mesh.positions[t.y], c = mesh.positions[t.z];
        point = eye + ray * hit.t;
        normal = glm::normalize(glm::cross(b - a, c - a));
        if (glm::dot(normal, ray) > 0) normal = -normal;
      }
      for (int k = 0; k < 3; ++k) {
        s->p[k].push_back(static_cast<float>(point[k]));
        s->n[k].push_back(static_cast<float>(normal[k]));
      }
      s->mesh.push_back(hit.mesh);
      s->triangle.push_back(hit.triangle);
    }
  return {view, Truth::mesh, width, height, s->p[0], s->p[1], s->p[2], s->n[0], s->n[1], s->n[2], s->mesh, s->triangle, s};
}

/// Distance along the ray to the light of the nearest caster, infinity when there is none. Rays start `offset` meters off.
inline double caster_distance(const Scene& scene, const Light& light, const glm::dvec3& point, double offset = 1e-5) {
  const glm::dvec4 l = homogeneous(light);
  const glm::dvec3 to = to_light(l, point);
  const double length = glm::length(to);
  const double t = nearest(scene, point, to / length, offset, true).t;
  return l.w != 0 && t >= length ? std::numeric_limits<double>::infinity() : t;
}

/// A technique brought up to a mask of one scene, light and G-buffer.
/// What a technique that was relit answers.
inline std::vector<float> mask_of(Technique& technique, const GBuffer& gbuffer) {
  VisibilityMask mask(gbuffer.width, gbuffer.height);
  technique.resolve(gbuffer, mask);
  const auto pixels = mask.read();
  return {pixels.begin(), pixels.end()};
}

struct Run {
  std::unique_ptr<Technique> technique;
  std::vector<float> mask;
};

/// `roll` is the technique's registration function.
inline Run run(void (*roll)(Registry&), const std::string& settings, const Scene& scene, const Light& light,
               const GBuffer& gbuffer) {
  Registry registry;
  roll(registry);
  Run run{registry.techniques()[0].make(), {}};
  run.technique->apply(settings);
  run.technique->setup();
  run.technique->build(scene);
  run.technique->relight(light);
  run.mask = mask_of(*run.technique, gbuffer);
  return run;
}

/// One of a technique's counts, which must be there.
inline double value(const Counts& counts, std::string_view name) {
  return std::find_if(counts.begin(), counts.end(), [&](const Count& c) { return c.name == name; })->value;
}

/// A unit vector, every direction alike.
inline glm::dvec3 direction_of(Random& random) {
  for (;;)
    if (const glm::dvec3 p = random.uniform(glm::dvec3(-1), glm::dvec3(1)); glm::length(p) > 0.1 && glm::length(p) < 1)
      return glm::normalize(p);
}

}  // namespace small_world
