// Outlines of spheres, cones and discs in double, against closed forms and against rays through the solids.
#include <gnomon/kit/geometry/contour.h>
#include <gnomon/kit/geometry/shapes.h>
#include <gnomon/kit/random.h>
#include <gtest/gtest.h>

#include <numbers>

#include "kit/rays/shape_rays.h"
#include "small_world.h"
#include "techniques/sphere_volume/bodies.h"

namespace sphere_contour_test {
using namespace gnomon;
namespace sv = sphere_volume;

// --- Circles as polygons ---------------------------------------------------------------------------------------------------

void expect_near(const glm::dvec3& a, const glm::dvec3& b, double tolerance = 1e-9) {
  EXPECT_NEAR(a.x, b.x, tolerance);
  EXPECT_NEAR(a.y, b.y, tolerance);
  EXPECT_NEAR(a.z, b.z, tolerance);
}

// The outline of a sphere takes the points of its circle of tangency counter-clockwise seen from the light.
TEST(Contour, of_a_sphere_runs_around_its_circle_of_tangency) {
  for (const auto& [sphere, light] :
       {std::pair(Sphere{{3, 2, -4}, 2}, glm::dvec4(0, 10, 0, 1)), {Sphere{{0, 0, 0}, 3}, {0, 0, 5, 1}}})
    for (const int n : {4, 6}) {
      const TangencyCircle circle = tangency_circle(sphere, light);
      const sv::Contour contour = sv::contour_of(sphere, light, sv::inscribed, n);
      const glm::dvec3 p = circle.center, l(light);
      ASSERT_EQ(contour.points.size(), static_cast<std::size_t>(n));
      for (int k = 0; k < n; ++k) {
        expect_near(contour.points[k], circle.point(-2 * std::numbers::pi * k / n));
        EXPECT_GT(glm::dot(glm::cross(contour.points[k] - p, contour.points[(k + 1) % n] - p), l - p), 0);
        expect_near(glm::cross(contour.away[k], contour.points[k] - l), glm::dvec3(0));
      }
    }
}

// Area of the inscribed polygon over the circle's: N sin(2 pi / N) / (2 pi); it lies 1 - cos(pi / N) of the radius inside.
TEST(Polygon, factors_are_those_of_the_vectors) {
  struct {
    int n;
    double area_ratio, radial_gap, circumscribed, equal_area;
  } const vectors[] = {{6, 0.826993343133, 0.133974596216, 1.15470053838, 1.09963611079},
                       {32, 0.993586851144, 0.0048152733278, 1.00483857238, 1.0032220805},
                       {64, 0.998394393036, 0.00120454379483, 1.00120599647, 1.00080377152}};
  for (const auto& v : vectors) {
    EXPECT_EQ(sv::radius_factor(sv::inscribed, v.n), 1);
    EXPECT_NEAR(sv::radius_factor(sv::circumscribed, v.n), v.circumscribed, 1e-9);
    EXPECT_NEAR(sv::radius_factor(sv::equal_area, v.n), v.equal_area, 1e-9);
    EXPECT_NEAR(1 / v.area_ratio, v.equal_area * v.equal_area, 1e-9);
    EXPECT_NEAR(1 / (1 - v.radial_gap), v.circumscribed, 1e-9);
  }
}

TEST(Contour, light_on_the_surface_sees_tangents_at_a_right_angle) {
  const Sphere sphere{.center = {1, 2, 3}, .radius = 2};
  const sv::Contour contour = sv::contour_of(sphere, {1, 4, 3, 1}, sv::inscribed, 16);
  for (std::size_t i = 0; i < contour.points.size(); ++i) {
    expect_near(contour.points[i], {1, 4, 3});
    EXPECT_NEAR(contour.away[i].y, 0, 1e-12);
    EXPECT_NEAR(glm::length(contour.away[i]), 1, 1e-12);
  }
}

// --- Polygons for arcs -----------------------------------------------------------------------------------------------------

// The polygon from the circle's center over the corners; the sector is half the arc. Around it no corner is inside, and each
// side is one of a tangent; inside it no corner is outside.
TEST(Arc, has_the_area_of_the_sector_or_bounds_it) {
  Random random(7);
  for (int i = 0; i < 500; ++i) {
    const double from = random.uniform(-3, 3), length = random.uniform(1e-4, 6.28);
    const double to = random.below(2) ? from + length : from - length;
    const int count = 8 + static_cast<int>(random.below(100));
    for (const sv::Fit fit : {sv::inscribed, sv::equal_area, sv::circumscribed}) {
      const std::vector<sv::Corner> corners = sv::arc(fit, from, to, count);
      EXPECT_EQ(corners.front().angle, from);
      EXPECT_EQ(corners.back().angle, to);
      double area = 0;
      for (std::size_t k = 0; k + 1 < corners.size(); ++k) {
        const sv::Corner &a = corners[k], &b = corners[k + 1];
        const double turn = std::abs(b.angle - a.angle);
        EXPECT_LE(turn, 2 * std::numbers::pi / count + 1e-9);
        area += a.radius * b.radius * std::sin(turn) / 2;
        const double to_side = a.radius * b.radius * std::sin(turn) /
                               std::sqrt(a.radius * a.radius + b.radius * b.radius - 2 * a.radius * b.radius * std::cos(turn));
        if (fit == sv::inscribed) {
          EXPECT_EQ(b.radius, 1);
        }
        if (fit == sv::circumscribed) {
          EXPECT_NEAR(to_side, 1, 1e-6);
        }
      }
      if (fit == sv::equal_area) {
        EXPECT_NEAR(area, length / 2, 1e-9);
      }
    }
  }
}

TEST(FullCircle, of_equal_area_has_its_area) {
  for (const int n : {3, 8, 64, 255}) {
    double area = 0;
    const std::vector<sv::Corner> corners = sv::full_circle(sv::equal_area, n);
    for (const sv::Corner& c : corners) area += c.radius * c.radius * std::sin(2 * std::numbers::pi / n) / 2;
    EXPECT_NEAR(area, std::numbers::pi, 1e-9);
  }
}

// --- Volumes against the solids ----------------------------------------------------------------------------------------------

sv::Body random_body(Random& random, int kind) {
  const glm::vec3 place(random.uniform(glm::dvec3(-1), glm::dvec3(1))), axis(small_world::direction_of(random));
  const auto radius = static_cast<float>(random.uniform(0.2, 1)), height = static_cast<float>(random.uniform(0.1, 2));
  if (kind == 0) return {0, Sphere{place, radius}};
  if (kind == 1) return {0, Cone{place, axis, radius, height}};
  return {0, Disc{place, axis, radius}};
}

/// Directional, far, near, and for cones now and then above the peak or below the base, where the outline is the whole circle.
glm::dvec4 random_light(Random& random, const sv::Body& body) {
  for (;;) {
    glm::dvec4 light(small_world::direction_of(random), 0);
    const std::uint32_t way = random.below(4);
    if (way == 1) light = glm::dvec4(small_world::direction_of(random) * 6.0, 1);
    if (way == 2) light = glm::dvec4(sv::middle(body.shape) + small_world::direction_of(random) * random.uniform(0.3, 2), 1);
    const auto* cone = std::get_if<Cone>(&body.shape);
    if (way == 3 && cone) {
      const glm::dvec3 axis = glm::normalize(glm::dvec3(cone->axis));
      const double side = random.below(2) ? cone->height + random.uniform(0.1, 2) : -random.uniform(0.1, 2);
      light = glm::dvec4(glm::dvec3(cone->base) + side * axis + small_world::direction_of(random) * 0.1, 1);
    }
    if (light.w != 0 && (contains(body.shape, glm::dvec3(light)) || sv::is_on_surface(body.shape, glm::dvec3(light)))) continue;
    return light;
  }
}

/// Whether the light's rays that reach x are inside the sides of the volume.
bool is_between_sides(const sv::Contour& contour, const glm::dvec3& x) {
  const std::size_t n = contour.points.size();
  for (std::size_t i = 0; i < n; ++i) {
    const glm::dvec3 &a = contour.points[i], &b = contour.points[(i + 1) % n];
    if (glm::dot(glm::cross(a - b, contour.away[i]), x - a) > 0) return false;
  }
  return n > 0;
}

/// Whether the way to the light goes through the light cap.
bool is_behind_cap(const sv::Contour& contour, const glm::dvec3& x, const glm::dvec3& to_light) {
  const std::size_t n = contour.points.size();
  for (std::size_t i = 0; i < n; ++i) {
    const double t = small_world::intersect(x, to_light, contour.hub, contour.points[i], contour.points[(i + 1) % n]);
    if (t > 0 && t < INFINITY) return true;
  }
  return false;
}

// Lines from the light through random points near the body: a polygon inside never takes one that misses the solid, one around
// it never misses one that meets it, whatever the light sees of a cone. With 256 segments the two leave little between.
TEST(Contour, sides_enclose_the_lines_that_meet_the_solid) {
  Random random(11);
  int met[3] = {}, differ[3] = {}, arcs = 0, circles_above = 0, circles_below = 0;
  for (int round = 0; round < 600; ++round) {
    const int kind = round % 3;
    const sv::Body body = random_body(random, kind);
    const glm::dvec4 light = random_light(random, body);
    const int segments = round % 2 ? 256 : 9;
    const sv::Contour inside = sv::contour_of(body.shape, light, sv::inscribed, segments);
    const sv::Contour around = sv::contour_of(body.shape, light, sv::circumscribed, segments);
    const sv::Contour bounding = sv::bounding_contour(body.shape, light);
    if (kind == 1) {
      const auto& cone = std::get<Cone>(body.shape);
      const bool below = glm::dot(glm::dvec3(cone.axis), glm::dvec3(light) - light.w * glm::dvec3(cone.base)) < 0;
      const bool circle = inside.points.size() == static_cast<std::size_t>(segments) &&
                          glm::distance(inside.points[0], glm::dvec3(cone.base)) < cone.radius * 1.001;
      arcs += !circle, circles_above += circle && !below, circles_below += circle && below;
    }
    for (int k = 0; k < 200; ++k) {
      const glm::dvec3 x = sv::middle(body.shape) + random.uniform(glm::dvec3(-2), glm::dvec3(2));
      const glm::dvec3 away = light.w * x - glm::dvec3(light), start = light.w != 0 ? glm::dvec3(light) : x - 100.0 * away;
      const bool meets = first_hit(body.shape, start, away, 0, INFINITY).found;
      const bool in = is_between_sides(inside, x), out = is_between_sides(around, x);
      EXPECT_TRUE(!in || meets) << "inscribed, kind " << kind << ", round " << round;
      EXPECT_TRUE(!meets || out) << "circumscribed, kind " << kind << ", round " << round;
      EXPECT_TRUE(!meets || is_between_sides(bounding, x)) << "bounding, kind " << kind << ", round " << round;
      if (segments == 256) met[kind] += meets, differ[kind] += in != out;
    }
  }
  for (int kind = 0; kind < 3; ++kind) {
    EXPECT_GT(met[kind], 1000);
    EXPECT_LT(differ[kind], met[kind] / 500);  // twice 1 - cos(pi / 256) of the radius: 3e-4 of the area
  }
  EXPECT_GT(arcs, 100);
  EXPECT_GT(circles_above, 10);
  EXPECT_GT(circles_below, 10);
}

// Points outside the solid: in the volume exactly when the way to the light meets the solid, between the two polygons.
TEST(Contour, cap_parts_points_before_the_solid_from_those_behind) {
  Random random(12);
  int dark = 0, before = 0, sliver = 0;
  for (int round = 0; round < 600; ++round) {
    const int kind = round % 3;
    const sv::Body body = random_body(random, kind);
    const glm::dvec4 light = random_light(random, body);
    const sv::Contour inside = sv::contour_of(body.shape, light, sv::inscribed, 32);
    const sv::Contour around = sv::contour_of(body.shape, light, sv::circumscribed, 32);
    const sv::Contour bounding = sv::bounding_contour(body.shape, light);
    if (kind != 2) {
      EXPECT_TRUE(contains(body.shape, inside.hub));
    }
    for (int k = 0; k < 200; ++k) {
      const glm::dvec3 x = sv::middle(body.shape) + random.uniform(glm::dvec3(-2), glm::dvec3(2));
      if (contains(body.shape, x)) continue;
      const glm::dvec3 to = to_light(light, x);
      const bool blocked = first_hit(body.shape, x, to, 0, light.w != 0 ? 1 : INFINITY).found;
      const bool in = is_between_sides(inside, x) && is_behind_cap(inside, x, to);
      const bool out = is_between_sides(around, x) && is_behind_cap(around, x, to);
      EXPECT_TRUE(!in || blocked) << "inscribed, kind " << kind << ", round " << round;
      // Between its corners a cap around a cone leaves the cone a little.
      sliver += blocked && !out;
      const bool starts_at_light = glm::distance(bounding.hub, glm::dvec3(light)) < 1e-9;
      EXPECT_TRUE(!blocked || starts_at_light || is_behind_cap(bounding, x, to)) << "bounding, kind " << kind;
      dark += blocked;
      before += !blocked && is_between_sides(inside, x);
    }
  }
  EXPECT_GT(dark, 5000);
  EXPECT_GT(before, 1000);
  EXPECT_LE(sliver, dark / 2000);
}

TEST(Contour, of_a_disc_seen_edge_on_is_empty) {
  EXPECT_TRUE(sv::contour_of(Disc{}, {3, 0, 1, 1}, sv::inscribed, 32).points.empty());
  EXPECT_TRUE(sv::contour_of(Disc{}, {1, 0, 0, 0}, sv::inscribed, 32).points.empty());
}

}  // namespace sphere_contour_test
