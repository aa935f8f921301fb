#include <gnomon/kit/geometry/camera.h>
#include <gnomon/kit/geometry/shapes.h>
#include <gnomon/kit/rays/gbuffer_maker.h>
#include <gtest/gtest.h>

#include <random>

#include "small_world.h"

namespace gbuffer_test {

using namespace gnomon;

GBuffer made(const Scene& scene, int width, int height, Truth truth) {
  const RayScene everything(scene, truth, RayScene::Which::seen);
  return make_gbuffer(scene, everything, scene.views[0], width, height, truth);
}

/// Rounding three coordinates to float32 moves a point by at most half an ulp in each: sqrt(3) * 2^-24 of the largest. The
/// same again for what double leaves over.
double rounding(const glm::dvec3& p) { return 2 * 0x1p-24 * std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)}); }

TEST(gbuffer, points_lie_on_their_triangle_and_on_the_ray_of_their_pixel) {
  for (unsigned seed = 1; seed <= 4; ++seed) {
    std::mt19937 random(seed);
    Scene scene;
    // Hundreds of meters from the origin, where org + t * dir in float32 would be off by millimeters.
    scene.meshes = {small_world::ground(300), small_world::random_soup(random, 60, 200, 1, 90, 40)};
    scene.views = {View{.eye = {100, 120, 310}, .target = {0, 10, 0}}};
    const GBuffer g = made(scene, 96, 54, Truth::mesh);
    const Camera camera(g.view, g.width, g.height);
    int seen = 0;
    for (std::size_t i = 0; i < g.size(); ++i) {
      if (g.is_background(i)) continue;
      ++seen;
      const Mesh& mesh = scene.meshes[g.mesh[i]];
      const glm::uvec3 t = mesh.triangles[g.triangle[i]];
      const glm::dvec3 a = mesh.positions[t.x], b = mesh.positions[t.y], c = mesh.positions[t.z], p = g.position(i);
      const glm::dvec3 normal = glm::normalize(glm::cross(b - a, c - a));
      EXPECT_LE(std::abs(glm::dot(normal, p - a)), rounding(p)) << i;
      const glm::dvec3 ray =
          glm::normalize(camera.ray(static_cast<double>(i % g.width) + 0.5, static_cast<double>(i / g.width) + 0.5));
      const glm::dvec3 offset = p - camera.eye;
      EXPECT_LE(glm::length(offset - glm::dot(offset, ray) * ray), rounding(p) + rounding(camera.eye)) << i;
      // The normal is the triangle's, turned toward the eye, to float32.
      EXPECT_NEAR(std::abs(glm::dot(normal, glm::dvec3(g.normal(i)))), 1, 1e-6);
      EXPECT_LT(glm::dot(glm::dvec3(g.normal(i)), ray), 0);
    }
    EXPECT_GT(seen, 2000);
  }
}

TEST(gbuffer, ids_are_those_of_a_brute_force_in_double) {
  std::mt19937 random(9);
  Scene scene;
  scene.meshes = {small_world::ground(5), small_world::random_soup(random, 50, 3, 0.3f, 2.5f, 0.8f),
                  small_world::box({-1, 0, -1}, {1, 1, 1})};
  scene.views = {View{.eye = {1, 4, 8}}};
  const GBuffer g = made(scene, 120, 80, Truth::mesh), brute = small_world::make_gbuffer(scene, scene.views[0], 120, 80);
  int different = 0, background = 0;
  for (std::size_t i = 0; i < g.size(); ++i) {
    different += g.mesh[i] != brute.mesh[i] || g.triangle[i] != brute.triangle[i];
    background += g.is_background(i);
    if (g.is_background(i)) {
      EXPECT_EQ(g.position(i), glm::vec3(0));
      EXPECT_EQ(g.normal(i), glm::vec3(0));
    }
  }
  EXPECT_LE(different, 2) << "rays through an edge within float32 rounding";
  EXPECT_GT(background, 100);
}

TEST(gbuffer, winding_decides_nothing) {
  Scene scene;
  scene.meshes = {small_world::ground(3)};
  scene.views = {View{.eye = {0, 2, 6}}};
  const GBuffer up = made(scene, 32, 18, Truth::mesh);
  for (glm::uvec3& t : scene.meshes[0].triangles) std::swap(t.y, t.z);
  const GBuffer down = made(scene, 32, 18, Truth::mesh);
  for (std::size_t i = 0; i < up.size(); ++i) {
    EXPECT_EQ(up.normal(i), down.normal(i));
    EXPECT_EQ(up.position(i), down.position(i));
    if (!up.is_background(i)) {
      EXPECT_EQ(up.normal(i), glm::vec3(0, 1, 0));
    }
  }
}

const Sphere sphere{{-3, 1, 0.5f}, 1.25f};
const Cone cone{{0, 2, 0}, {0.5f, -2, 1}, 1, 2.5f};
const Disc disc{{3, 1, 0}, {-0.3f, 1, 2}, 1.5f};

Scene shapes() {
  Scene scene;
  scene.meshes = {tessellate(sphere, 24, "sphere"), tessellate(cone, 24, "cone"), tessellate(disc, 24, "disc")};
  scene.views = {View{.eye = {0.5f, 5, 9}, .target = {0, 1, 0}}};
  return scene;
}

/// How far a point is from the surface that it should be on.
double distance_to(std::uint32_t mesh, const glm::dvec3& p) {
  if (mesh == 0) return std::abs(glm::distance(p, glm::dvec3(sphere.center)) - sphere.radius);
  if (mesh == 2) return std::abs(glm::dot(p - glm::dvec3(disc.center), glm::normalize(glm::dvec3(disc.normal))));
  const glm::dvec3 axis = glm::normalize(glm::dvec3(cone.axis)), x = p - glm::dvec3(cone.base);
  const double along = glm::dot(x, axis), off = glm::length(x - along * axis);
  const double side = std::abs(cone.height * (off - cone.radius) + cone.radius * along) / std::hypot(cone.radius, cone.height);
  return std::min(std::abs(along), side);
}

TEST(gbuffer, under_shape_truth_points_lie_on_the_curved_shapes) {
  const Scene scene = shapes();
  const GBuffer g = made(scene, 160, 90, Truth::shape);
  std::array<int, 3> seen{};
  for (std::size_t i = 0; i < g.size(); ++i) {
    if (g.is_background(i)) continue;
    ++seen.at(g.mesh[i]);
    const glm::dvec3 p = g.position(i), n = g.normal(i);
    EXPECT_LE(distance_to(g.mesh[i], p), rounding(p)) << i;
    EXPECT_EQ(g.triangle[i], 0u);
    EXPECT_NEAR(glm::length(n), 1, 1e-6);
    EXPECT_GT(glm::dot(n, glm::dvec3(g.view.eye) - p), 0);
    if (g.mesh[i] == 0) {
      EXPECT_NEAR(glm::distance(n, (p - glm::dvec3(sphere.center)) / double(sphere.radius)), 0, 1e-6);
    }
    if (g.mesh[i] == 2) {
      EXPECT_NEAR(std::abs(glm::dot(n, glm::normalize(glm::dvec3(disc.normal)))), 1, 1e-6);
    }
  }
  for (const int count : seen) EXPECT_GT(count, 200);
}

TEST(gbuffer, under_mesh_truth_points_lie_on_the_inscribed_triangles) {
  const Scene scene = shapes();
  const GBuffer mesh = made(scene, 160, 90, Truth::mesh), shape = made(scene, 160, 90, Truth::shape);
  EXPECT_EQ(mesh.truth, Truth::mesh);
  int below = 0, sphere_pixels = 0, larger = 0;
  for (std::size_t i = 0; i < mesh.size(); ++i) {
    larger += mesh.is_background(i) && !shape.is_background(i);
    EXPECT_FALSE(shape.is_background(i) && !mesh.is_background(i)) << "the tessellation is inside the shape";
    if (mesh.mesh[i] != 0) continue;
    ++sphere_pixels;
    // Inscribed: inside the sphere by up to the sag r (1 - cos(pi / 24)) of a quad, a little more across its diagonal.
    const double depth = sphere.radius - glm::distance(glm::dvec3(mesh.position(i)), glm::dvec3(sphere.center));
    EXPECT_GT(depth, -1e-6);
    EXPECT_LT(depth, 2 * sphere.radius * (1 - std::cos(std::acos(-1.0) / 24)));
    below += depth > 1e-3;
  }
  EXPECT_GT(below, sphere_pixels / 2);
  EXPECT_GT(larger, 10);
}

TEST(gbuffer, seen_from_inside_a_shape_is_in_its_own_shadow_when_the_light_is_outside) {
  // Eye inside the sphere: the normal turns inward. A light outside faces the far inner side and the near side blocks it: all
  // dark, as with the triangles. A light inside blocks nowhere: all lit. The cone alike.
  for (const Shape& shape : {Shape(Sphere{{0, 1, 0}, 2}), Shape(Cone{{0, -1, 0}, {0, 1, 0}, 4, 5})}) {
    Scene scene;
    scene.meshes = {tessellate(shape, 64, "shell")};
    scene.views = {View{.eye = {0, 0.5f, 0}, .target = {1, 0.25f, 1}, .fov_y_degrees = 100}};
    for (const Truth truth : {Truth::shape, Truth::mesh}) {
      const GBuffer g = made(scene, 64, 48, truth);
      const RayScene casters(scene, truth, RayScene::Which::casters);
      std::vector<float> mask(g.size());
      const Light outside{.name = "outside", .kind = PointLight{{-9, 3, -8}}};
      EXPECT_GT(trace_shadows(casters, scene, g, outside, mask), 500u);
      for (std::size_t i = 0; i < g.size(); ++i)
        ASSERT_EQ(mask[i], faces_light(scene, g, outside, i) ? 0 : 1) << kind_name(shape) << ' ' << name(truth) << ' ' << i;
      const Light inside{.name = "inside", .kind = PointLight{{0.25f, 0, 0.5f}}};
      EXPECT_EQ(trace_shadows(casters, scene, g, inside, mask), g.size());
      EXPECT_EQ(std::ranges::count(mask, 1.0f), static_cast<std::ptrdiff_t>(g.size()))
          << kind_name(shape) << ' ' << name(truth);
    }
  }
}

TEST(gbuffer, seen_from_outside_a_convex_shape_is_never_in_its_own_shadow) {
  const Scene scene = shapes();
  const GBuffer g = made(scene, 160, 90, Truth::shape);
  for (std::uint32_t only = 0; only < 3; ++only) {
    Scene alone = scene;
    for (std::uint32_t m = 0; m < 3; ++m) alone.meshes[m].casts = m == only;
    const RayScene casters(alone, Truth::shape, RayScene::Which::casters);
    std::vector<float> mask(g.size());
    trace_shadows(casters, alone, g, {.name = "sun", .kind = DirectionalLight{{1, -2, -0.5f}}}, mask);
    for (std::size_t i = 0; i < g.size(); ++i)
      if (g.mesh[i] == only) {
        ASSERT_EQ(mask[i], 1) << i;
      }
  }
}

}  // namespace gbuffer_test
