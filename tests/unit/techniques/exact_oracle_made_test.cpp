// Every exact technique decides as the exact oracle does where rounding, the light or the exact shape is out to mislead it.
#include <gnomon/kit/geometry/shapes.h>

#include "exact_oracle_rig.h"
#include "exact_techniques.h"

namespace gnomon::exact_oracle::exact_oracle_made_test {

using namespace hand_made;

class ExactOracleWithoutEpsilon : public ExactOracle {};

INSTANTIATE_TEST_SUITE_P(All, ExactOracleWithoutEpsilon, testing::ValuesIn(without_epsilon()),
                         [](const auto& info) { return info.param.id(); });

// Three bars, each over the next one: no order of them is right for all points.
TEST_P(ExactOracle, decides_as_the_oracle_does_on_cyclic_overlap) {
  std::vector<glm::vec3> positions;
  std::vector<glm::uvec3> triangles;
  for (int k = 0; k < 3; ++k) {
    const double turn = 2 * 3.14159265358979 / 3 * k;
    const auto at = [&](double x, double y, double z) {
      return glm::vec3(std::cos(turn) * x - std::sin(turn) * z, y, std::sin(turn) * x + std::cos(turn) * z);
    };
    const auto base = static_cast<std::uint32_t>(positions.size());
    positions.insert(positions.end(), {at(-2, 1, 0.5), at(-2, 1, 0.9), at(2, 2, 0.9), at(2, 2, 0.5)});
    triangles.insert(triangles.end(), {{base, base + 1, base + 2}, {base, base + 2, base + 3}});
  }
  Scene scene;
  scene.meshes = {mesh_of(positions, triangles), square(4, 0)};
  Random random(9);
  Agreement sum;
  for (const Light& light :
       {point_light({0.2f, 5, 0.1f}), sun({0.1f, -1, 0.05f}), point_light({0.1f, 1.5f, 0}), sun({1, -0.2f, 0})}) {
    Picture picture(80, 60);
    hard_scenes::scatter(scene, light, random, picture);
    compare(GetParam().settings, scene, light, picture.gbuffer, sum);
  }
  expect_agreement(sum, 1000, 1000);
}

// The light is 2^-56 m off the plane of the triangle around it, which so shades half of space. In double a light's faces see
// the triangle as a line through themselves, and a clip to a face leaves nothing of it, or little.
TEST_P(ExactOracleWithoutEpsilon, a_triangle_that_all_but_holds_the_light_shades_half_of_space) {
  Scene scene;
  scene.meshes = {mesh_of({{0.25f, -0.5f, 0}, {0.25f, 0.5f, -1}, {1.25f, 0.5f, 0x1p-54f}}, {{0, 1, 2}}),
                  tessellate(Sphere{{0.25f, 0.5f, 0}, 3}, 12, "room"), square(6, -2)};
  scene.meshes[1].shape.reset();
  scene.meshes[1].casts = false;
  const Light light = point_light({0.5f, 0, -0.25f});
  Random random(12);
  Picture picture(100, 20);
  hard_scenes::scatter(scene, light, random, picture);
  Agreement sum;
  compare(GetParam().settings, scene, light, picture.gbuffer, sum);
  expect_agreement(sum, 500, 500);
}

// A lamp at a vertex, in a triangle but for one unit in the last place, and a long thin triangle that points at it: planes that
// double cannot vouch for.
TEST_P(ExactOracleWithoutEpsilon, lights_almost_on_triangles_do_no_harm) {
  Random random(5);
  std::mt19937 engine(5);
  Agreement sum;
  for (const float off : {0.0f, 1e-30f, 1e-12f, 0x1p-24f, 1e-6f, 1e-3f}) {
    Scene scene;
    scene.meshes = {tessellate(Sphere{{0, 0, 0}, 1}, 16, "sphere"), square(4, -1.5f),
                    small_world::random_soup(engine, 50, 2, -1, 2, 0.4f),
                    mesh_of({{0.25f, 2, 0.25f}, {0.5f, 0.5f, 0.5f}, {0.5f, 0.5f, 0.5f + 0x1p-22f}}, {{0, 1, 2}})};
    scene.meshes[0].shape.reset();
    const glm::vec3 vertex = scene.meshes[0].positions[5], inside = (vertex + scene.meshes[0].positions[6]) / 2.0f;
    for (const glm::vec3& at : {vertex, inside, glm::vec3(0.125f, 2.75f, 0.125f), glm::vec3(-1.0f, -1.5f, 0.5f)}) {
      SCOPED_TRACE(fmt::format("{} off {}, {}, {}", off, at.x, at.y, at.z));
      const Light light = point_light(at + glm::vec3(0, off, off));
      Picture picture(50, 40);
      hard_scenes::scatter(scene, light, random, picture);
      compare(defaults, scene, light, picture.gbuffer, sum);
    }
  }
  expect_agreement(sum, 5'000, 1'000);
}

// A floor of 10 mm under a lamp 17 m off: a unit of float32, in which two_pass_object keeps boxes around lit pieces, is 0.6
// micrometers of the floor there, and what a cell sees beyond its rectangle 0.01. Points within 1 micrometer of the floor's
// edges are lit.
TEST_P(ExactOracle, a_small_floor_is_lit_to_its_edges_under_a_lamp_far_off) {
  constexpr float half = 0.005f;
  Scene scene;
  scene.meshes = {square(0.001f, 0.001f), square(half, 0)};
  Random random(6);
  Agreement sum;
  for (const glm::vec3& at : {glm::vec3(9.1f, 10, 9.4f), {-9.3f, 10, 9.2f}, {8.9f, 10, -9.5f}, {-9.6f, 10, -9.7f}}) {
    Picture picture(50, 40);
    for (std::size_t i = 0; i < picture.gbuffer.size(); ++i) {
      const auto along = static_cast<float>(random.uniform(-half, half)),
                 edge = static_cast<float>(half - random.uniform(1e-9, 1e-6));
      const float to = i & 1 ? edge : -edge;
      const glm::vec3 p = i & 2 ? glm::vec3(to, 0, along) : glm::vec3(along, 0, to);
      picture.set(i, p, {0, 1, 0}, 1, p.z > p.x ? 0 : 1);
    }
    compare(GetParam().settings, scene, point_light(at), picture.gbuffer, sum);
  }
  EXPECT_EQ(sum.wrong, 0);
  EXPECT_EQ(sum.lit, 8'000);
  if (GetParam().id() == "two_pass_object") {
    EXPECT_LT(sum.counts.at("points_asked"), 0.1 * sum.counts.at("point_locations"));
  }
}

// Points of a ball's triangles, on their edges but for rounding. Some are behind their own triangle and outside of the ball, so
// that a triangle turned away from the light, which has no shadow volume in crow_counting, blocks theirs.
TEST_P(ExactOracleWithoutEpsilon, a_point_that_rounding_puts_out_of_a_body_beside_its_edge_is_dark) {
  Scene scene;
  scene.meshes = {tessellate(Sphere{{0.25f, 0.5f, 0}, 1}, 6, "ball")};
  Mesh& ball = scene.meshes[0];
  ball.shape.reset();
  Random random(10);
  Picture picture(100, 50);
  picture.gbuffer.view.eye = {1, 3, 7};
  for (std::size_t i = 0; i < picture.gbuffer.size(); ++i) {
    const std::uint32_t t = random.below(static_cast<std::uint32_t>(ball.triangles.size())), k = random.below(3);
    const Triangle own = ball.corners(t);
    const glm::dvec3 a(own.points[k]), b(own.points[(k + 1) % 3]);
    picture.set(i, a + random.uniform(0, 1) * (b - a), glm::normalize(own.normal()), 0, t);
  }
  int out = 0;
  for (const Light& light :
       {point_light({-7, 5, 0}), sun({-4, -2.5f, -4}), sun({-0.5f, -3, 3.5f}), point_light({-3, -4, -4})}) {
    Agreement sum;
    compare(GetParam().settings, scene, light, picture.gbuffer, sum);
    expect_agreement(sum, 0, 1000);
    out += sum.dark;
  }
  EXPECT_GT(out, 50);
}

// Points on a true sphere, of the size of its mesh, or so much smaller that all triangles are before them. The body is convex
// and shades none of its points that face the light; its shadow on the floor, and a plate's shadow on it, remain.
TEST_P(ExactOracle, an_exact_shape_is_not_shaded_by_its_own_triangles) {
  const Light lamp = point_light({0.3f, 6, -0.2f});
  const struct {
    float radius;
    Light light;
    glm::vec3 eye;
  } cases[] = {{1, lamp, {4, 3, 1}},
               {1, lamp, {0.1f, -0.2f, 0}},
               {1, lamp, {0.3f, -1.2f, 0.2f}},
               {1, sun({0.2f, -1, 0.3f}), {4, 3, 1}},
               {0.75f, lamp, {4, 3, 1}}};
  Random random(4);
  for (const auto& [radius, light, eye] : cases) {
    SCOPED_TRACE(fmt::format("radius {}, {}, eye at height {}", radius, light.name, eye.y));
    Scene scene;
    scene.meshes = {tessellate(Sphere{{0, 0, 0}, 1}, 12, "sphere"), square(4, -1.5f), square(0.4f, 3)};
    scene.meshes[0].shape = Sphere{{0, 0, 0}, radius};
    Picture picture(100, 102, Truth::shape);
    picture.gbuffer.view.eye = eye;
    for (std::size_t i = 0; i < 10'000; ++i) {
      const glm::vec3 n(small_world::direction_of(random));
      picture.set(i, radius * n, n, 0, 0);
    }
    for (std::size_t i = 10'000; i < 10'200; ++i) {
      const float x = static_cast<float>(random.uniform(-3, 3)), z = static_cast<float>(random.uniform(-3, 3));
      picture.set(i, {x, -1.5f, z}, {0, 1, 0}, 1, z > x ? 0 : 1);
    }
    Agreement sum;
    compare(GetParam().settings, scene, light, picture.gbuffer, sum);
    expect_agreement(sum, 120, radius == 1 ? 2000 : 1000);
    scene.meshes[2].casts = false;
    const std::vector<float> mask = run("", scene, light, picture.gbuffer).mask;
    EXPECT_EQ(std::count(mask.begin(), mask.begin() + 10'000, 1.0f), 10'000);
    EXPECT_GT(std::count(mask.begin() + 10'000, mask.end(), 0.0f), 10);
  }
}

/// Scene, light and picture with all coordinates times a power of two, which changes no sign.
struct Scaled {
  Scene scene;
  Light light;
  Picture picture;
  Scaled(const Scene& s, const Light& l, const GBuffer& g, float scale) : scene(s), light(l), picture(g.width, g.height) {
    for (Mesh& mesh : scene.meshes)
      for (glm::vec3& p : mesh.positions) p *= scale;
    if (auto* const point = std::get_if<PointLight>(&light.kind)) point->position *= scale;
    for (std::size_t i = 0; i < g.size(); ++i)
      if (!g.is_background(i)) picture.set(i, scale * g.position(i), g.normal(i), g.mesh[i], g.triangle[i]);
  }
};

// Lights far away, and coordinates so large or small that float32 proves nothing; with float32 as it should be,
// shadow_volume_tree takes few signs in double.
TEST_P(ExactOracle, answers_do_not_depend_on_the_scale) {
  Random random(11);
  Scene scene;
  scene.meshes = {hard_scenes::grid_soup(random, 40), hard_scenes::boxes(random, 4, false)};
  for (const Light& light : {point_light({1.3f, 3.1f, 0.4f}), point_light({1e6f, 3e6f, 2e6f}), sun({0.3f, -1, 0.1f})}) {
    Picture picture(60, 40);
    hard_scenes::scatter(scene, light, random, picture);
    Agreement sum;
    compare(defaults, scene, light, picture.gbuffer, sum);
    expect_agreement(sum, 100, 100);
    if (GetParam().id() == "shadow_volume_tree") {
      EXPECT_LT(sum.counts.at("signs_in_double"), 20'000);
    }
    const std::vector<float> mask = run("", scene, light, picture.gbuffer).mask;
    for (const int exponent : {-80, -20, 20, 98, 101, 120}) {
      const bool is_far = light.name == "point" && std::get<PointLight>(light.kind).position.x > 100;
      if (is_far && exponent > 101) continue;  // beyond float32
      const Scaled scaled(scene, light, picture.gbuffer, std::ldexp(1.0f, exponent));
      EXPECT_EQ(run("", scaled.scene, scaled.light, scaled.picture.gbuffer).mask, mask) << "times 2^" << exponent;
    }
  }
}

}  // namespace gnomon::exact_oracle::exact_oracle_made_test
