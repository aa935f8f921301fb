#pragma once
#include <fmt/format.h>
#include <gnomon/kit/geometry/planar_shadow.h>
#include <gnomon/kit/random.h>

#include "planar_brute.h"

// Random shapes, lights, planes and points, in general places and in degenerate ones.
namespace planar_questions {
using namespace gnomon;

struct Question {
  Shape shape;
  glm::dvec4 light, plane;
};

/// Real numbers, or whole ones, by which light and shape are edge-on, level, in one plane and parallel as often as not.
struct Dice {
  Random& random;
  bool whole;

  double number(double low, double high) {
    const double x = random.uniform(low, high);
    return whole ? std::round(x) : x;
  }
  double size() { return whole ? 1.0 + random.below(3) : std::exp(random.uniform(-2, 1)); }
  glm::dvec3 point(double half) {
    const double x = number(-half, half), y = number(-half, half), z = number(-half, half);
    return {x, y, z};
  }
  glm::dvec3 direction() {
    for (;;)
      if (const glm::dvec3 d = whole ? point(1.4) : small_world::direction_of(random); glm::length(d) > 0.5) return d;
  }
};

inline Shape random_shape(Dice& dice) {
  const glm::vec3 at = dice.point(2), direction = dice.direction();
  const auto size = [&] { return static_cast<float>(dice.size()); };
  switch (dice.random.below(6)) {
    case 0:
      return Sphere{at, size()};
    case 1: {
      const float radius = size();
      return Cone{at, direction, radius, size()};
    }
    case 2:
      return Disc{at, direction, size()};
    case 3:
      for (;;) {
        const Triangle t{{at, dice.point(3), dice.point(3)}};
        if (glm::length(glm::cross(glm::dvec3(t.points[1] - t.points[0]), glm::dvec3(t.points[2] - t.points[0]))) > 0.01)
          return t;
      }
    case 4: {
      const glm::dvec3 a = dice.direction();
      glm::dvec3 u = glm::cross(glm::dvec3(direction), a);
      if (glm::length(u) < 0.1) u = std::abs(direction.x) > 0.5 ? glm::dvec3(0, 1, 0) : glm::dvec3(1, 0, 0);
      u -= glm::dot(u, glm::dvec3(direction)) / glm::dot(glm::dvec3(direction), glm::dvec3(direction)) * glm::dvec3(direction);
      if (glm::length(u) < 0.1) u = {0, 0, 1};
      const glm::dvec3 v = glm::cross(u, glm::dvec3(direction));
      const double s = dice.size();
      return Plane{at, u * s, v * dice.size()};
    }
    default: {
      const float x = size(), y = size();
      return Box{at, at + glm::vec3(x, y, size())};
    }
  }
}

/// A point up to 0.1 off the surface of a shape, and as often less than 0.001.
inline glm::dvec3 close_to(const Shape& shape, Random& random) {
  const Mesh mesh = tessellate(shape, 12, "shape");
  const glm::uvec3 t = mesh.triangles[random.below(static_cast<std::uint32_t>(mesh.triangles.size()))];
  const glm::dvec3 a(mesh.positions[t.x]), b(mesh.positions[t.y]), c(mesh.positions[t.z]);
  const double u = random.uniform(0, 1), v = random.uniform(0, 1 - u);
  return a + u * (b - a) + v * (c - a) + std::pow(10, random.uniform(-5, -1)) * glm::normalize(glm::cross(b - a, c - a));
}

/// The light is on the plane's positive side, above the shape's top, level with it or below it as it comes; one in five is at
/// infinity, one in five next to the shape. Nobody objects.
inline Question random_question(Random& random, bool whole) {
  Dice dice{random, whole};
  for (;;) {
    Question q{random_shape(dice), {}, {}};
    const glm::dvec3 up = glm::normalize(dice.direction());
    q.plane = {up, dice.number(-1, 4)};
    const std::uint32_t side = random.below(5);
    q.light = side == 0   ? glm::dvec4(dice.direction(), 0)
              : side == 1 ? glm::dvec4(close_to(q.shape, random), 1)
                          : glm::dvec4(dice.point(side == 2 ? 8 : 3), 1);
    const double height = glm::dot(q.plane, q.light);
    if (height < 0) q.plane = -q.plane;
    if (std::abs(height) > 1e-6 && PlanarShadow::objection(q.shape, q.light, q.plane, ShadowForm::exact).empty()) return q;
  }
}

struct Ball {
  glm::dvec3 middle{0};
  double radius = 0;
};

inline Ball ball_around(const Shape& shape) {
  const Mesh mesh = tessellate(shape, 8, "shape");
  Ball ball;
  for (const glm::vec3& p : mesh.positions) ball.middle += glm::dvec3(p) / double(mesh.positions.size());
  for (const glm::vec3& p : mesh.positions) ball.radius = std::max(ball.radius, glm::distance(ball.middle, glm::dvec3(p)));
  return ball;
}

/// Distance of a point from the surface, from samples of a coarse tessellation: up to a tenth of the ball's radius off.
inline double gap(const Shape& shape, const glm::dvec3& point) {
  const Mesh mesh = tessellate(shape, 16, "shape");
  double least = INFINITY;
  for (const glm::uvec3& t : mesh.triangles) {
    const glm::dvec3 a(mesh.positions[t.x]), u = 0.1 * (glm::dvec3(mesh.positions[t.y]) - a),
                                             v = 0.1 * (glm::dvec3(mesh.positions[t.z]) - a);
    for (int i = 0; i <= 10; ++i)
      for (int j = 0; i + j <= 10; ++j) least = std::min(least, glm::distance(point, a + double(i) * u + double(j) * v));
  }
  return least;
}

/// A point of the plane: mostly the image of a point about the shape, else anywhere.
inline glm::dvec3 random_point(Random& random, const Question& q, const Ball& ball) {
  const glm::dvec3 near = ball.middle + random.uniform(glm::dvec3(-ball.radius), glm::dvec3(ball.radius));
  const glm::dvec4 image = image_on_plane(near, q.light, q.plane);
  glm::dvec3 point = glm::dvec3(image) / image.w;
  if (random.below(8) == 0 || !(image.w > 0) || glm::length(point) > 1e4) point = random.uniform(glm::dvec3(-8), glm::dvec3(8));
  return point - glm::dot(q.plane, glm::dvec4(point, 1)) * glm::dvec3(q.plane);
}

inline std::string print(const Question& q) {
  const auto v = [](const auto& p) { return fmt::format("({:.9g}, {:.9g}, {:.9g})", p.x, p.y, p.z); };
  std::string text =
      fmt::format("light {} {} plane {} {} {}", v(q.light), q.light.w, v(q.plane), q.plane.w, kind_name(q.shape));
  if (const auto* s = std::get_if<Sphere>(&q.shape)) text += fmt::format(" {} r {}", v(s->center), s->radius);
  if (const auto* s = std::get_if<Cone>(&q.shape))
    text += fmt::format(" {} axis {} r {} h {}", v(s->base), v(s->axis), s->radius, s->height);
  if (const auto* s = std::get_if<Disc>(&q.shape))
    text += fmt::format(" {} normal {} r {}", v(s->center), v(s->normal), s->radius);
  if (const auto* s = std::get_if<Triangle>(&q.shape))
    text += fmt::format(" {} {} {}", v(s->points[0]), v(s->points[1]), v(s->points[2]));
  if (const auto* s = std::get_if<Plane>(&q.shape)) text += fmt::format(" {} {} {}", v(s->center), v(s->half_u), v(s->half_v));
  if (const auto* s = std::get_if<Box>(&q.shape)) text += fmt::format(" {} {}", v(s->min), v(s->max));
  return text;
}

}  // namespace planar_questions
