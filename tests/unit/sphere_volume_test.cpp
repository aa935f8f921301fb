// Shadow volumes of spheres, cones and discs: the outlines in double against closed forms and against rays through the solids,
// and the technique against the ray tracer under shape truth.
#include <gnomon/kit/gl.h>
#include <gnomon/kit/random.h>
#include <gnomon/kit/rays.h>
#include <gnomon/kit/shapes.h>
#include <gtest/gtest.h>

#include <numbers>

#include "../../techniques/sphere_volume/bodies.h"
#include "device/context.h"
#include "kit/shape_rays.h"
#include "measure/frame/classify.h"
#include "measure/frame/gbuffer_maker.h"
#include "small_world.h"

extern "C" void gnomon_technique_sphere_volume(gnomon::Registry&);

namespace {
using namespace gnomon;
namespace sv = sphere_volume;

// --- Circle of tangency ----------------------------------------------------------------------------------------------------

void expect_near(const glm::dvec3& a, const glm::dvec3& b, double tolerance = 1e-9) {
  EXPECT_NEAR(a.x, b.x, tolerance);
  EXPECT_NEAR(a.y, b.y, tolerance);
  EXPECT_NEAR(a.z, b.z, tolerance);
}

struct TangencyVector {
  glm::dvec3 light, center;
  double radius, to_center, cos_alpha;
  glm::dvec3 p;
  double r;
  glm::dvec3 u, v;
  std::vector<glm::dvec3> q;
};

// cos a = sqrt(LC^2 - R^2) / LC; PL = (LC^2 - R^2) / LC; P = L + PL * LC / |LC|; r = R cos a. u skips the smallest component of
// LC, v = u x LC, Q_k = P + cos(2 pi k / N) v + sin(2 pi k / N) u.
TEST(TangencyCircle, is_the_one_of_the_vectors) {
  const TangencyVector vectors[] = {{{0, 10, 0},
                                     {3, 2, -4},
                                     2,
                                     9.00998198005,
                                     0.977269757935,
                                     {2.86516853933, 2.3595505618, -3.8202247191},
                                     1.95453951587,
                                     {0.0, 0.874096644439, -1.74819328888},
                                     {-1.85308118005, -0.555924354016, -0.277962177008},
                                     {{1.01208735927, 1.80362620778, -4.09818689611},
                                      {1.9386279493, 2.83857828424, -5.4731856065},
                                      {3.79170912935, 3.39450263825, -5.19522342949},
                                      {4.71824971938, 2.91547491581, -3.54226254209},
                                      {3.79170912935, 1.88052283936, -2.1672638317},
                                      {1.9386279493, 1.32459848534, -2.44522600871}}},
                                    {{0, 0, 5},
                                     {0, 0, 0},
                                     3,
                                     3.2,
                                     0.8,
                                     {0, 0, 1.8},
                                     2.4,
                                     {0, 2.4, 0},
                                     {-2.4, 0, 0},
                                     {{-2.4, 0, 1.8}, {0, 2.4, 1.8}, {2.4, 0, 1.8}, {0, -2.4, 1.8}}}};
  for (const TangencyVector& t : vectors) {
    const Sphere sphere{.center = t.center, .radius = static_cast<float>(t.radius)};
    const glm::dvec4 light(t.light, 1);
    const sv::TangencyCircle circle = sv::tangency_circle(sphere, light);
    EXPECT_NEAR(circle.to_center, t.to_center, 1e-9);
    EXPECT_NEAR(circle.cos_alpha, t.cos_alpha, 1e-9);
    EXPECT_NEAR(circle.radius, t.r, 1e-9);
    expect_near(circle.center, t.p);
    expect_near(circle.u * circle.radius, t.u);
    expect_near(circle.v * circle.radius, t.v);
    const int n = static_cast<int>(t.q.size());
    for (int k = 0; k < n; ++k) expect_near(circle.point(2 * std::numbers::pi * k / n), t.q[k]);
    // The outline takes them the other way, counter-clockwise seen from the light.
    const sv::Contour contour = sv::contour_of(sphere, light, sv::inscribed, n);
    for (int k = 0; k < n; ++k) {
      expect_near(contour.points[k], t.q[(n - k) % n]);
      const glm::dvec3 a = contour.points[k] - t.p, b = contour.points[(k + 1) % n] - t.p;
      EXPECT_GT(glm::dot(glm::cross(a, b), t.light - t.p), 0);
      expect_near(glm::cross(contour.away[k], contour.points[k] - t.light), glm::dvec3(0));
    }
  }
}

// R = 0.01 at 1000 m: r differs from R by 5e-13. The difference of squares as printed returns 0 in float32.
TEST(TangencyCircle, small_far_sphere_keeps_its_radius) {
  const Sphere sphere{.center = {0, 0, 1000}, .radius = 0.01f};
  EXPECT_NEAR(sv::tangency_circle(sphere, {0, 0, 0, 1}).radius, 0.0099999999995, 1e-8);

  const float lc = 1000, r = 0.01f, pl = (lc * lc - r * r) / lc;
  EXPECT_EQ(std::sqrt(lc * lc - r * r - pl * pl), 0);  // as printed
  EXPECT_NEAR(r * std::sqrt(lc * lc - r * r) / lc, 0.00999999977648, 1e-8);
}

// Area of the inscribed polygon over the circle's: N sin(2 pi / N) / (2 pi); it lies 1 - cos(pi / N) of the radius inside.
TEST(TangencyCircle, polygon_factors_are_those_of_the_vectors) {
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

TEST(TangencyCircle, light_on_the_surface_sees_tangents_at_a_right_angle) {
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

glm::dvec3 direction_of(Random& random) {
  for (;;)
    if (const glm::dvec3 p = random.uniform(glm::dvec3(-1), glm::dvec3(1)); glm::length(p) > 0.1 && glm::length(p) < 1)
      return glm::normalize(p);
}

sv::Body random_body(Random& random, int kind) {
  const glm::vec3 place(random.uniform(glm::dvec3(-1), glm::dvec3(1))), axis(direction_of(random));
  const auto radius = static_cast<float>(random.uniform(0.2, 1)), height = static_cast<float>(random.uniform(0.1, 2));
  if (kind == 0) return {0, Sphere{place, radius}};
  if (kind == 1) return {0, Cone{place, axis, radius, height}};
  return {0, Disc{place, axis, radius}};
}

/// Directional, far, near, and for cones now and then above the peak or below the base, where the outline is the whole circle.
glm::dvec4 random_light(Random& random, const sv::Body& body) {
  for (;;) {
    glm::dvec4 light(direction_of(random), 0);
    const std::uint32_t way = random.below(4);
    if (way == 1) light = glm::dvec4(direction_of(random) * 6.0, 1);
    if (way == 2) light = glm::dvec4(sv::middle(body.shape) + direction_of(random) * random.uniform(0.3, 2), 1);
    const auto* cone = std::get_if<Cone>(&body.shape);
    if (way == 3 && cone) {
      const glm::dvec3 axis = glm::normalize(glm::dvec3(cone->axis));
      const double side = random.below(2) ? cone->height + random.uniform(0.1, 2) : -random.uniform(0.1, 2);
      light = glm::dvec4(glm::dvec3(cone->base) + side * axis + direction_of(random) * 0.1, 1);
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
    const sv::Contour inside = sv::contour_of(body, light, sv::inscribed, segments);
    const sv::Contour around = sv::contour_of(body, light, sv::circumscribed, segments);
    const sv::Contour bounding = sv::bounding_contour(body, light);
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
    const sv::Contour inside = sv::contour_of(body, light, sv::inscribed, 32);
    const sv::Contour around = sv::contour_of(body, light, sv::circumscribed, 32);
    const sv::Contour bounding = sv::bounding_contour(body, light);
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

// --- The technique -----------------------------------------------------------------------------------------------------------

/// A scene with what rays through its exact shapes say.
struct ShapeWorld {
  Scene scene;
  RayScene everything, casters;
  GBuffer gbuffer;
  ShapeWorld(Scene the_scene, const View& view, int width = 160, int height = 120)
      : scene(std::move(the_scene)),
        everything(scene, Truth::shape, RayScene::Which::all),
        casters(scene, Truth::shape, RayScene::Which::casters),
        gbuffer(make_gbuffer(scene, everything, view, width, height, Truth::shape)) {}

  std::vector<float> reference(const Light& light) const {
    std::vector<float> mask(gbuffer.size());
    trace_shadows(casters, scene, gbuffer, light, mask);
    return mask;
  }
  std::vector<PixelClass> classes(const Light& light, std::span<const float> mask) const {
    return classify(scene, casters, gbuffer, light, mask);
  }

  /// Whether the answer of rays changes when the pixel's point moves by `pixels` on the screen, in its tangent plane.
  bool near_edge(const Light& light, std::size_t i, double pixels) const {
    const glm::dvec3 p = gbuffer.position(i), n = gbuffer.normal(i), eye = gbuffer.view.eye;
    const glm::dvec3 forward = glm::normalize(glm::dvec3(gbuffer.view.target) - eye);
    const glm::dvec3 right = glm::normalize(glm::cross(forward, glm::dvec3(gbuffer.view.up))), up = glm::cross(right, forward);
    const double step = 2 * std::tan(glm::radians(double(gbuffer.view.fov_y_degrees)) / 2) / gbuffer.height * pixels;
    const glm::dvec3 ray = (p - eye) / glm::dot(p - eye, forward);
    bool seen[2] = {};
    for (int k = 0; k <= 16; ++k) {
      const glm::dvec3 turned = ray + (k < 16 ? step : 0) * (right * std::cos(k * 0.3927) + up * std::sin(k * 0.3927));
      const glm::dvec3 moved = eye + turned * (glm::dot(n, p - eye) / glm::dot(n, turned));
      seen[is_dark(light, gbuffer.mesh[i], moved)] = true;
    }
    return seen[0] && seen[1];
  }
  bool is_dark(const Light& light, std::uint32_t own, const glm::dvec3& p) const {
    const glm::dvec4 l = homogeneous(light);
    const double end = l.w != 0 ? 1 : INFINITY;
    for (std::uint32_t m = 0; m < scene.meshes.size(); ++m) {
      const Mesh& mesh = scene.meshes[m];
      if (m == own || !mesh.casts || !mesh.has_curved_shape()) continue;
      if (first_hit(*mesh.shape, p, to_light(l, p), 0, end).found) return true;
    }
    Scene flat;
    for (const Mesh& mesh : scene.meshes)
      if (mesh.casts && !mesh.has_curved_shape()) flat.meshes.push_back(mesh);
    return small_world::occluder_distance(flat, light, p) < INFINITY;
  }
};

class SphereVolume : public testing::Test {
 protected:
  SphereVolume() { process_context(); }
  void TearDown() override { EXPECT_EQ(state_differences(), std::vector<std::string>{}); }

  static small_world::Run run(const ShapeWorld& world, const Light& light, const std::string& settings = "") {
    return small_world::run(gnomon_technique_sphere_volume, settings, world.scene, light, world.gbuffer);
  }
  static Support supports(const Scene& scene, const Light& light) {
    Registry registry;
    gnomon_technique_sphere_volume(registry);
    return registry.techniques()[0].make()->supports(scene, light, {});
  }
};

const View view{.eye = {3, 5, 7}, .target = {0, 0.6f, 0}, .fov_y_degrees = 50};

Mesh shape_mesh(const Shape& shape) { return tessellate(shape, 24, "shape"); }

/// Spheres, cones and discs over a ground that does not cast; every third touches it. None reaches into another: each has a
/// cell of its own.
Scene random_shapes(unsigned seed) {
  Random random(seed);
  Scene scene;
  scene.meshes = {small_world::ground(6, 0, false)};
  for (int cell = 0; cell < 9; ++cell) {
    const double x = 1.6 * (cell % 3 - 1) + random.uniform(-0.2, 0.2), z = 1.6 * (cell / 3 - 1) + random.uniform(-0.2, 0.2);
    const auto radius = static_cast<float>(random.uniform(0.15, 0.5));
    const double y = random.below(3) ? random.uniform(0.6, 1.4) : 0;
    const glm::vec3 axis = y == 0 ? glm::vec3(0, 1, 0) : glm::vec3(direction_of(random));
    const std::uint32_t kind = random.below(3);
    if (kind == 0) scene.meshes.push_back(shape_mesh(Sphere{{x, y + (y == 0 ? radius : 0), z}, radius}));
    if (kind == 1)
      scene.meshes.push_back(shape_mesh(Cone{{x, y, z}, axis, radius, static_cast<float>(random.uniform(0.1, 0.5))}));
    if (kind == 2) scene.meshes.push_back(shape_mesh(Disc{{x, y + 0.3, z}, glm::vec3(direction_of(random)), radius}));
  }
  return scene;
}

const std::vector<Light> lights = {{.name = "point", .kind = PointLight{{1.5f, 4, 0.5f}}},
                                   {.name = "near", .kind = PointLight{{0.05f, 2.2f, 0.1f}}},
                                   {.name = "low", .kind = PointLight{{4, 0.5f, 2.5f}}},
                                   {.name = "sun", .kind = DirectionalLight{{0.4f, -1, 0.2f}}},
                                   {.name = "evening", .kind = DirectionalLight{{1, -0.15f, 0.3f}}},
                                   {.name = "spot", .kind = SpotLight{{1, 4, 1}, {-0.2f, -1, -0.2f}, 20, 35}}};

struct Tally {
  int tested = 0, dark = 0, false_dark = 0, false_lit = 0, far_dark = 0, far_lit = 0;
};

/// Pixels of class T only; `far` ones are farther than `pixels` from where the reference changes.
void compare(const ShapeWorld& world, const Light& light, std::span<const float> mask, double pixels, Tally& t) {
  const std::vector<float> reference = world.reference(light);
  const std::vector<PixelClass> classes = world.classes(light, reference);
  for (std::size_t i = 0; i < mask.size(); ++i) {
    if (!faces_light(world.scene, world.gbuffer, light, i)) {
      EXPECT_EQ(mask[i], 1);
    }
    if (classes[i] != PixelClass::T) continue;
    ++t.tested, t.dark += reference[i] == 0;
    if (mask[i] == reference[i]) continue;
    const bool far = pixels > 0 && !world.near_edge(light, i, pixels);
    if (mask[i] == 0) ++t.false_dark, t.far_dark += far;
    if (mask[i] == 1) ++t.false_lit, t.far_lit += far;
  }
}

// Class T leaves out what changes when the point or the light moves by 16 * 2^-24 of the extent, a millionth: no other pixel is
// wrong, whatever touches the ground and wherever the light is.
TEST_F(SphereVolume, exact_agrees_with_rays_at_every_tested_pixel) {
  Tally t;
  for (unsigned seed = 1; seed <= 8; ++seed) {
    const ShapeWorld world(random_shapes(seed), view);
    for (const Light& light : lights) {
      SCOPED_TRACE(fmt::format("seed {}, {}", seed, light.name));
      compare(world, light, run(world, light, "fit=exact").mask, 0, t);
      EXPECT_EQ(t.false_dark + t.false_lit, 0);
    }
  }
  EXPECT_GT(t.dark, 20000);
}

// The rasterizer moves an edge by less than 1/100 pixel; but for that, a polygon around never leaves light in the shadow, and
// one inside never darkens what is lit. At the angle t off the middle of a side, |t| <= s / 2, the radius of a polygon around
// errs by t^2 / 2, inside by t^2 / 2 - s^2 / 8, of equal area by t^2 / 2 - s^2 / 24: in the mean s^2 times 1/24, 1/12 and, in
// amount, 1/(9 sqrt(12)) = 1/31.2. So equal area errs on 0.77 of the pixels of one around and on 0.38 of those of one inside.
TEST_F(SphereVolume, polygons_err_on_their_side) {
  Tally inside, around, equal;
  for (unsigned seed = 1; seed <= 6; ++seed) {
    const ShapeWorld world(random_shapes(seed), view);
    for (const Light& light : lights) {
      SCOPED_TRACE(fmt::format("seed {}, {}", seed, light.name));
      compare(world, light, run(world, light, "fit=inscribed,segments=12").mask, 0.01, inside);
      compare(world, light, run(world, light, "fit=circumscribed,segments=12").mask, 0.01, around);
      compare(world, light, run(world, light, "fit=equal_area,segments=12").mask, 0, equal);
    }
  }
  EXPECT_EQ(inside.far_dark, 0);
  EXPECT_EQ(around.far_lit, 0);
  EXPECT_GT(inside.far_lit, 20);
  EXPECT_GT(around.far_dark, 20);
  const double wrong = equal.false_dark + equal.false_lit;
  EXPECT_NEAR(wrong / (inside.false_dark + inside.false_lit), 0.38, 0.1);
  EXPECT_NEAR(wrong / (around.false_dark + around.false_lit), 0.77, 0.15);
  RecordProperty("inscribed", inside.false_dark + inside.false_lit);
  RecordProperty("circumscribed", around.false_dark + around.false_lit);
  RecordProperty("equal_area", equal.false_dark + equal.false_lit);
}

TEST_F(SphereVolume, casters_without_a_curved_shape_cast_by_their_triangles) {
  std::mt19937 random(3);
  Scene scene;
  scene.meshes = {small_world::ground(5), tessellate(Box{{-2, 0, -1}, {-1, 1, 0.5f}}, 8, "box"),
                  small_world::random_soup(random, 12, 1.5f, 0.8f, 2.2f, 0.5f), shape_mesh(Sphere{{1.5f, 0.6f, 1}, 0.6f})};
  const ShapeWorld world(std::move(scene), view);
  for (const char* settings : {"", "fit=exact"}) {
    Tally t;
    for (const Light& light : lights) compare(world, light, run(world, light, settings).mask, 0.02, t);
    EXPECT_GT(t.dark, 3000);
    EXPECT_LE(t.false_dark + t.false_lit, t.tested / 2000);
    if (*settings) {
      EXPECT_EQ(t.far_dark + t.far_lit, 0);  // the soup's and the box's edges are the rasterizer's
    }
  }
}

// The middle of the ground lies under 256 discs: a count modulo 256 says lit.
TEST_F(SphereVolume, two_hundred_and_fifty_six_nested_volumes_are_dark) {
  Scene scene;
  scene.meshes = {small_world::ground(4)};
  for (int k = 0; k < 256; ++k) {
    scene.meshes.push_back(shape_mesh(Disc{{0, 1.5f + 0.005f * static_cast<float>(k), 0}, {0, 1, 0}, 1}));
    scene.meshes.back().receives = false;
  }
  const ShapeWorld world(std::move(scene), {.eye = {0, 0.6f, 4}, .target = {0, 0.4f, 0}});
  for (const Light& light : {lights[0], lights[3]}) {
    Tally t;
    const auto volumes = run(world, light);
    compare(world, light, volumes.mask, 0.3, t);
    EXPECT_GT(t.dark, 500);
    EXPECT_EQ(t.far_dark + t.far_lit, 0);
    const std::vector<float> counts = volumes.technique->draw_debug("counts");
    EXPECT_GT(*std::ranges::max_element(counts), 0.5f);
  }
}

// The light sees no outline at all, only 256 closed boxes around it.
TEST_F(SphereVolume, two_hundred_and_fifty_six_boxes_around_the_light_are_dark) {
  Scene scene;
  scene.meshes = {small_world::ground(4, -1)};
  for (int k = 0; k < 256; ++k)
    scene.meshes.push_back(small_world::box(glm::vec3(-0.3f - k / 512.0f), glm::vec3(0.3f + k / 512.0f)));
  const ShapeWorld world(std::move(scene), {.eye = {0, 2, 4}, .target = {0, -0.4f, 0}}, 48, 36);
  const Light light{.kind = PointLight{{0.1f, 0, 0.05f}}};
  for (const char* settings : {"", "fit=exact"}) {
    Tally t;
    compare(world, light, run(world, light, settings).mask, 0, t);
    EXPECT_GT(t.tested, 200);
    EXPECT_EQ(t.dark, t.tested);
    EXPECT_EQ(t.false_lit, 0);
  }
}

// A sphere around everything, and the light inside: it casts on nothing that the eye inside sees. From outside, all that is
// seen of other things is dark.
TEST_F(SphereVolume, light_inside_a_solid_is_seen_from_inside_only) {
  Scene scene;
  scene.meshes = {small_world::ground(3, 0, false), shape_mesh(Sphere{{0, 3, 0}, 1.5f}),
                  shape_mesh(Sphere{{0.5f, 2.6f, 0.3f}, 0.3f}), shape_mesh(Cone{{1.5f, 0.5f, 1}, {0, 1, 0}, 0.4f, 0.5f})};
  const Light light{.kind = PointLight{{0, 3.4f, 0}}};
  const View from_outside = view, from_inside{.eye = {-1, 3, 0.4f}, .target = {0.5f, 2.6f, 0.3f}, .fov_y_degrees = 80};
  for (const char* settings : {"", "fit=exact"}) {
    for (const View& from : {from_outside, from_inside}) {
      const ShapeWorld world(scene, from);
      Tally t;
      compare(world, light, run(world, light, settings).mask, 0.3, t);
      EXPECT_EQ(t.far_dark + t.far_lit, 0);
      EXPECT_GT(t.tested, 1000);
      EXPECT_GT(t.dark, 100);
      if (from.eye == from_outside.eye) {
        EXPECT_EQ(t.dark, t.tested);
      }
      if (from.eye != from_outside.eye) {
        EXPECT_LT(t.dark, t.tested / 2);
      }
      EXPECT_LE(t.false_dark + t.false_lit, t.tested / 200);
    }
  }
  // The light outside, the eye inside: nothing it sees is lit.
  const ShapeWorld world(scene, from_inside);
  for (const Light& outside : {lights[0], lights[3]}) {
    Tally t;
    compare(world, outside, run(world, outside).mask, 0, t);
    EXPECT_EQ(t.dark, t.tested);
    EXPECT_EQ(t.false_dark + t.false_lit, 0);
  }
}

// Flat meshes have the depth of their triangles, to the bit; points of curved ones have near_plane / w, within two roundings.
TEST_F(SphereVolume, depth_is_that_of_what_the_gbuffer_sees) {
  const ShapeWorld world(random_shapes(2), view);
  const GBuffer& g = world.gbuffer;
  const DepthStencil& by_mesh = depth_stencil(world.scene, g);
  const DepthStencil& by_shape = depth_stencil(world.scene, g, Truth::shape);
  EXPECT_NE(by_mesh.texture.name(), by_shape.texture.name());
  EXPECT_EQ(by_shape.bytes, g.size() * 8);
  EXPECT_EQ(&by_shape, &depth_stencil(world.scene, g, Truth::shape));
  const auto read = [&](const DepthStencil& depth) {
    std::vector<float> texels(g.size());
    glGetTextureImage(depth.texture.name(), 0, GL_DEPTH_COMPONENT, GL_FLOAT, static_cast<GLsizei>(g.size() * 4), texels.data());
    return texels;
  };
  const std::vector<float> mesh = read(by_mesh), shape = read(by_shape);
  const glm::dvec3 forward = glm::normalize(glm::dvec3(view.target) - glm::dvec3(view.eye));
  int curved = 0, differ = 0;
  for (std::size_t i = 0; i < g.size(); ++i) {
    if (g.is_background(i)) continue;
    const double expected = near_plane / glm::dot(forward, glm::dvec3(g.position(i)) - glm::dvec3(view.eye));
    if (g.mesh[i] != 0) {
      ++curved, differ += mesh[i] != shape[i];
      EXPECT_NEAR(shape[i], expected, expected * 1e-6);
    } else {
      EXPECT_NEAR(shape[i], expected, expected * 1e-4);
    }
  }
  EXPECT_GT(curved, 500);
  EXPECT_GT(differ, curved / 2);

  // A G-buffer of triangles has one depth, whoever asks.
  GBuffer of_mesh = small_world::make_gbuffer(world.scene, view, 32, 24);
  EXPECT_EQ(&depth_stencil(world.scene, of_mesh), &depth_stencil(world.scene, of_mesh, Truth::shape));
}

TEST_F(SphereVolume, shows_volumes_and_explains_by_mesh) {
  const ShapeWorld world(random_shapes(4), view);
  const auto volumes = run(world, lights[0]);
  const std::vector<float> picture = volumes.technique->draw_debug("volumes"), counts = volumes.technique->draw_debug("counts");
  ASSERT_EQ(picture.size(), 3 * world.gbuffer.size());
  ASSERT_EQ(counts.size(), picture.size());
  int entered = 0, dark = 0;
  for (std::size_t i = 0; i < world.gbuffer.size(); ++i) {
    const glm::vec3 c(counts[3 * i], counts[3 * i + 1], counts[3 * i + 2]);
    if (world.gbuffer.mesh[i] == 0) {
      EXPECT_EQ(volumes.mask[i] == 0, c.x != c.y || c.y != c.z);  // colors where a volume is, gray elsewhere
      dark += volumes.mask[i] == 0;
      entered += volumes.mask[i] == 0 && picture[3 * i] > 2 * picture[3 * i + 2];  // orange: front sides
    }
    const Explanation why = *volumes.technique->explain(i);
    EXPECT_TRUE(why.covered);
    EXPECT_EQ(why.element.has_value(), faces_light(world.scene, world.gbuffer, lights[0], i));
    if (why.element) {
      EXPECT_EQ(*why.element, world.gbuffer.mesh[i]);
    }
  }
  EXPECT_GT(dark, 500);
  EXPECT_GT(entered, dark * 9 / 10);  // where volumes overlap, teal comes in
}

TEST_F(SphereVolume, supports_every_scene_under_lights_without_area) {
  Scene scene;
  scene.meshes = {shape_mesh(Cone{{0, 0, 0}, {0, 1, 0}, 1, 2}), small_world::ground(3)};
  for (const Light& light : lights) EXPECT_EQ(supports(scene, light).kind(), Support::Kind::full);
  EXPECT_EQ(supports(scene, {.kind = PointLight{{0.1f, 1, 0}}}).kind(), Support::Kind::full);  // inside
  EXPECT_EQ(supports(scene, {.kind = SphereLight{}}).kind(), Support::Kind::unsupported);
  // Half way up, the cone's radius is one half.
  const Support on_surface = supports(scene, {.kind = PointLight{{0.5f, 1, 0}}});
  EXPECT_EQ(on_surface.kind(), Support::Kind::unsupported);
  EXPECT_EQ(supports(scene, {.kind = PointLight{{0.2f, 0, 0}}}).kind(), Support::Kind::unsupported);
  EXPECT_EQ(supports(scene, {.kind = PointLight{{0.2f, -1e-3f, 0}}}).kind(), Support::Kind::full);
  EXPECT_EQ(on_surface.why(), "the light lies on the surface of shape, whose outline cannot be seen from there");
}

}  // namespace
