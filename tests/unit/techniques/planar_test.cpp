#include <gnomon/kit/geometry/planes.h>
#include <gnomon/kit/geometry/shapes.h>

#include <algorithm>
#include <utility>

#include "planar_rig.h"

namespace planar_test {
using namespace planar_rig;

// --- kit/geometry/planes
// ------------------------------------------------------------------------------------------------------------

/// A square of half-side 1 in cells x cells quads, turned and moved in double, then rounded.
Mesh tilted_grid(int cells, const glm::dvec3& shift, double height = 0) {
  const glm::dvec3 u = glm::normalize(glm::dvec3(1, 0.3, -0.2)), v = glm::normalize(glm::cross(u, glm::dvec3(0.1, 1, 0.4)));
  const glm::dvec3 up = glm::cross(u, v);
  std::vector<glm::vec3> p;
  std::vector<glm::uvec3> t;
  const unsigned side = unsigned(cells) + 1;
  for (unsigned j = 0; j < side; ++j)
    for (unsigned i = 0; i < side; ++i)
      p.push_back(glm::vec3(shift + u * (2.0 * i / cells - 1) + v * (2.0 * j / cells - 1) + up * height));
  for (unsigned j = 0; j + 1 < side; ++j)
    for (unsigned i = 0; i + 1 < side; ++i) {
      const unsigned a = j * side + i;
      t.push_back({a, a + 1, a + side + 1});
      t.push_back({a, a + side + 1, a + side});
    }
  return make_mesh(p, t);
}

TEST(Planes, box_has_six_planes_of_its_sides) {
  Scene scene;
  scene.meshes = {small_world::box({0, 0, 0}, {1, 2, 3})};
  const ReceiverPlanes planes = find_receiver_planes(scene, 0.01);
  ASSERT_EQ(planes.planes.size(), 6u);
  EXPECT_NEAR(planes.planes[0].area, 6, 1e-12);
  EXPECT_NEAR(planes.planes[5].area, 2, 1e-12);
  EXPECT_NEAR(planes.planar_area, 22, 1e-12);
  for (int side = 0; side < 6; ++side) EXPECT_EQ(planes.plane_of[2 * side], planes.plane_of[2 * side + 1]);
}

// Rounding of corners at 100 m moves them by 2^-24 * 100 m = 6 micrometers off the plane, and turns cells of 1/30 m visibly.
TEST(Planes, tilted_grid_far_from_the_origin_is_one_plane) {
  for (const double far_away : {0.0, 100.0}) {
    Scene scene;
    scene.meshes = {tilted_grid(60, glm::dvec3(far_away, far_away / 2, 3))};
    const ReceiverPlanes planes = find_receiver_planes(scene, 0.01);
    ASSERT_EQ(planes.planes.size(), 1u);
    EXPECT_NEAR(planes.planar_area, planes.receiving_area, 1e-9);
    EXPECT_NEAR(planes.receiving_area, 4, 1e-3);
  }
}

TEST(Planes, unconnected_pieces_at_one_height_are_one_plane_and_a_step_is_another) {
  Scene scene;
  scene.meshes = {small_world::ground(1, 0.5f), small_world::ground(1, 0.5f), small_world::ground(1, 0.501f)};
  for (glm::vec3& p : scene.meshes[1].positions) p.x += 5;
  std::swap(scene.meshes[1].triangles[0].y, scene.meshes[1].triangles[0].z);  // winding does not count
  const ReceiverPlanes planes = find_receiver_planes(scene, 0.01);
  ASSERT_EQ(planes.planes.size(), 2u);
  EXPECT_EQ(planes.plane_of, (std::vector<std::uint32_t>{0, 0, 0, 0, 1, 1}));
  EXPECT_NEAR(planes.planes[0].area, 8, 1e-12);
}

TEST(Planes, small_sets_and_meshes_that_do_not_receive_are_on_no_plane) {
  Scene scene;
  scene.meshes = {small_world::ground(1), small_world::ground(0.05f, 1), small_world::ground(3, 2)};
  scene.meshes[2].receives = false;
  const ReceiverPlanes planes = find_receiver_planes(scene, 0.01);
  EXPECT_EQ(planes.plane_of, (std::vector<std::uint32_t>{0, 0, no_plane, no_plane, no_plane, no_plane}));
  EXPECT_NEAR(planes.receiving_area, 4.01, 1e-6);
}

TEST(Planes, curved_surface_has_none) {
  Scene scene;
  scene.meshes = {tessellate(Sphere{}, 128, "sphere")};
  EXPECT_TRUE(find_receiver_planes(scene, 0.01).planes.empty());
}

// --- planar_projected ------------------------------------------------------------------------------------------------------

// Point light at height 4 over a triangle at height 1: its shadow is the triangle scaled by 4/3 about the light's foot point.
TEST_F(PlanarProjected, shadow_of_a_triangle_is_the_analytic_triangle) {
  Scene scene;
  scene.meshes = {small_world::ground(4), make_mesh({{-1, 1, -1}, {0, 1, 1}, {1.2f, 1, -0.5f}}, {{0, 1, 2}})};
  const Light light{.kind = PointLight{{0.5f, 4, 0.25f}}};
  const GBuffer g = small_world::make_gbuffer(scene, {.eye = {0, 3, 7}, .target = {0, 0, 0}}, 160, 120);
  const auto planar = run(scene, light, g);
  int dark = 0;
  for (std::size_t i = 0; i < g.size(); ++i) {
    if (g.is_background(i) || g.mesh[i] != 0) continue;
    const glm::dvec2 foot(0.5, 0.25), p(g.px[i], g.pz[i]);
    double inside = INFINITY;
    for (int k = 0; k < 3; ++k) {
      const auto corner = [&](int c) {
        const glm::vec3& v = scene.meshes[1].positions[c % 3];
        return foot + (glm::dvec2(v.x, v.z) - foot) * (4.0 / 3);
      };
      const glm::dvec2 edge = glm::normalize(corner(k + 1) - corner(k)), to = p - corner(k);
      inside = std::min(inside, to.x * edge.y - to.y * edge.x);
    }
    dark += inside > 0;
    if (std::abs(inside) < 1e-3) continue;  // a fiftieth of a pixel's width on the ground
    EXPECT_EQ(planar.mask[i], inside > 0 ? 0 : 1) << i;
  }
  EXPECT_GT(dark, 300);
}

// On flat receivers the answer is the ray's but where the sample point lies within 1/100 pixel of an edge: soup that pierces
// the ground and reaches under it and above the light, a box in contact, and its sides, top and the ground as receivers.
TEST_F(PlanarProjected, agrees_with_rays_on_every_receiver_plane) {
  const std::vector<Light> lights = {{.name = "point", .kind = PointLight{{1, 2.5f, 0.5f}}},
                                     {.name = "sun", .kind = DirectionalLight{{0.4f, -1, 0.2f}}},
                                     {.name = "low", .kind = DirectionalLight{{1, -0.2f, 0.3f}}},
                                     {.name = "below", .kind = PointLight{{0.3f, -2, 0.1f}}},
                                     {.name = "spot", .kind = SpotLight{{1, 3, 1}, {-0.2f, -1, -0.2f}, 20, 35}}};
  int tested = 0, wrong = 0, far_from_edge = 0, dark = 0;
  for (unsigned seed = 1; seed <= 6; ++seed) {
    std::mt19937 random(seed);
    Scene scene;
    scene.meshes = {small_world::ground(3), small_world::random_soup(random, 25, 1.5f, -0.5f, 3.0f, 0.6f),
                    small_world::box({-2.5f, 0, -1}, {-1.5f, 1, 0.5f})};
    scene.meshes[1].receives = false;
    View from = view;
    if (seed % 2) from.eye.y = -5;
    const GBuffer g = small_world::make_gbuffer(scene, from, 128, 96);
    for (const Light& light : lights) {
      const auto planar = run(scene, light, g);
      for (std::size_t i = 0; i < g.size(); ++i) {
        if (!faces_light(scene, g, light, i)) {
          EXPECT_EQ(planar.mask[i], 1);
          continue;
        }
        ++tested;
        const bool reference = small_world::caster_distance(scene, light, g.position(i)) < INFINITY;
        dark += reference;
        if (reference == (planar.mask[i] == 0)) continue;
        ++wrong;
        far_from_edge += !near_edge(by_rays(scene, light), g, i, 0.01);
      }
    }
  }
  RecordProperty("tested", tested);
  RecordProperty("wrong", wrong);
  EXPECT_GT(dark, 5000);
  EXPECT_LE(wrong, tested / 5000);
  EXPECT_EQ(far_from_edge, 0);
}

TEST_F(PlanarProjected, caster_behind_the_plane_or_behind_the_light_casts_nothing) {
  Scene scene;
  scene.meshes = {small_world::ground(3, 0, false), make_mesh({{-1, 3, -1}, {0, 3, 1}, {1, 3, -1}}, {{0, 1, 2}}),
                  make_mesh({{-1, -1, -1}, {0, -1, 1}, {1, -1, -1}}, {{0, 1, 2}})};
  for (Mesh& mesh : scene.meshes) mesh.receives = &mesh == &scene.meshes[0];
  const GBuffer g = small_world::make_gbuffer(scene, {.eye = {0, 2, 5}}, 64, 48);
  for (const float value : run(scene, {.kind = PointLight{{0, 2, 0}}}, g).mask) EXPECT_EQ(value, 1);
}

TEST_F(PlanarProjected, light_in_the_plane_leaves_it_lit) {
  Scene scene;
  scene.meshes = {small_world::ground(3), small_world::box({-1, 0, -1}, {0, 1, 0})};
  scene.meshes[1].receives = false;
  const GBuffer g = small_world::make_gbuffer(scene, view, 64, 48);
  for (const Light& light : {Light{.kind = PointLight{{2, 0, 1}}}, Light{.kind = DirectionalLight{{1, 0, 0.5f}}}})
    for (const float value : run(scene, light, g).mask) EXPECT_EQ(value, 1);
}

TEST_F(PlanarProjected, pixels_off_the_planes_are_lit_and_not_covered) {
  Scene scene;
  scene.meshes = {small_world::ground(3), tessellate(Sphere{{0, 1.2f, 0}, 0.7f}, 64, "sphere"),
                  small_world::box({-1, 2.5f, -1}, {1, 2.6f, 1})};
  const Light light{.kind = PointLight{{0, 5, 0}}};
  const GBuffer mesh_truth = small_world::make_gbuffer(scene, view, 64, 48);
  EXPECT_EQ(supports(scene, light).kind(), Support::Kind::approximate);
  GBuffer shape_truth = mesh_truth;
  shape_truth.truth = Truth::shape;
  for (const GBuffer& g : {mesh_truth, shape_truth}) {
    const auto planar = run(scene, light, g);
    int off = 0;
    for (std::size_t i = 0; i < g.size(); ++i) {
      if (!faces_light(scene, g, light, i)) continue;
      const Explanation why = *planar.technique->explain(i);
      EXPECT_EQ(why.covered, g.mesh[i] != 1);
      EXPECT_EQ(why.element.has_value(), why.covered);
      if (g.mesh[i] != 1) continue;
      ++off;
      EXPECT_EQ(planar.mask[i], 1);
    }
    EXPECT_GT(off, 20);
  }
}

// Shape truth: pixels of a curved shape say triangle 0. All triangles of a disc lie on one plane, so triangle 0 says which.
TEST_F(PlanarProjected, disc_is_a_receiver_under_shape_truth) {
  Scene scene;
  scene.meshes = {tessellate(Disc{{0, 0, 0}, {0, 1, 0}, 3}, 64, "disc"), small_world::box({-0.5f, 1, -0.5f}, {0.5f, 2, 0.5f})};
  GBuffer g = small_world::make_gbuffer(scene, view, 64, 48);
  const auto by_mesh = run(scene, {.kind = PointLight{{0, 5, 0}}}, g).mask;
  g.truth = Truth::shape;
  std::vector<std::uint32_t> triangle(g.triangle.begin(), g.triangle.end());
  for (std::size_t i = 0; i < g.size(); ++i)
    if (g.mesh[i] == 0) triangle[i] = 0;
  g.triangle = triangle;
  const auto kept = std::exchange(g.storage, std::make_shared<int>());  // another G-buffer on the same arrays
  EXPECT_EQ(run(scene, {.kind = PointLight{{0, 5, 0}}}, g).mask, by_mesh);
  EXPECT_GT(std::ranges::count(by_mesh, 0.0f), 50);
}

TEST_F(PlanarProjected, supports_what_has_planes) {
  Scene ground_only, soup;
  ground_only.meshes = {small_world::ground(1)};
  std::mt19937 random(1);
  soup.meshes = {small_world::random_soup(random, 500, 1, 0, 1, 0.1f)};
  EXPECT_EQ(supports(ground_only, {.kind = PointLight{}}).kind(), Support::Kind::full);
  EXPECT_EQ(supports(ground_only, {.kind = DiscLight{}}).kind(), Support::Kind::unsupported);
  const Support no_plane = supports(soup, {.kind = PointLight{}});
  EXPECT_EQ(no_plane.kind(), Support::Kind::unsupported);
  EXPECT_EQ(no_plane.why(), "no plane holds 0.01 of the receiving area");
}

}  // namespace planar_test
