// The reference at the edge of what float32 can say: each kind of trouble alone. Where it differs from exact signs, the pixel
// is of class U, and scenes of any size are traced as at one meter.
#include <gnomon/kit/geometry/exact_scene.h>
#include <gnomon/kit/geometry/shapes.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "degenerate_scenes.h"
#include "measure/frame/classify.h"
#include "measure/frame/frame.h"
#include "measure/frame/light_rays.h"

namespace gnomon::float32_edge_test {

using hand_made::Picture;
using hand_made::point_light;

/// 40 x 40 points of the first mesh, a ground of half side 6 at height -2, whose triangles meet at x = z.
struct Ground {
  Scene scene;
  Picture picture{40, 40};

  explicit Ground(Mesh caster, double scale = 1) {
    scene.meshes = {hand_made::square(6, -2), std::move(caster)};
    for (Mesh& mesh : scene.meshes) {
      for (glm::vec3& p : mesh.positions) p = glm::vec3(scale * glm::dvec3(p));
      finish(mesh);
    }
    picture.gbuffer.view.eye = glm::vec3(scale * glm::dvec3(1, 3, 7));
    for (int y = 0; y < 40; ++y)
      for (int x = 0; x < 40; ++x) {
        const glm::dvec3 p(0.293 * (x - 19.7), -2, 0.287 * (y - 19.4));
        picture.set(40 * y + x, glm::vec3(scale * p), {0, 1, 0}, 0, p.x > p.z ? 1 : 0);
      }
  }
};

struct Seen {
  std::vector<float> mask;
  int tested = 0, uncertain = 0, wrong = 0, wrong_tested = 0, dark = 0;
};
Seen look(const Ground& ground, const Light& light) {
  const GBuffer& g = ground.picture.gbuffer;
  const RayScene casters(ground.scene, Truth::mesh, RayScene::Which::casters);
  std::vector<float> truth(g.size());
  Seen seen{.mask = truth};
  trace_shadows(casters, ground.scene, g, light, seen.mask);
  ExactScene(ground.scene).decide(g, light, truth);
  const std::vector<PixelClass> classes = classify(ground.scene, casters, g, light, seen.mask, {});
  for (std::size_t i = 0; i < g.size(); ++i) {
    const bool is_tested = classes[i] == PixelClass::T, is_off = seen.mask[i] != truth[i];
    seen.tested += is_tested, seen.wrong += is_off, seen.wrong_tested += is_tested && is_off, seen.dark += truth[i] == 0;
    seen.uncertain += classes[i] == PixelClass::U;
  }
  return seen;
}

Mesh ball() {
  Mesh mesh = tessellate(Sphere{{0.3f, 0.2f, 0.1f}, 1}, 24, "ball");
  mesh.shape.reset();
  return mesh;
}

// All pages hold the light, so none casts anything: exact signs say that all is lit.
TEST(Float32Edge, a_light_on_an_edge_of_sixty_triangles) {
  for (const float height : {0.25f, 1.0f, -1.0f}) {  // the last two are the ends of the edge
    const Seen seen = look(Ground(degenerate_scenes::fan(60)), point_light({0, height, 0}));
    EXPECT_EQ(seen.dark, 0);
    EXPECT_EQ(seen.wrong_tested, 0) << seen.tested << " tested";
    EXPECT_GT(seen.uncertain, 1000) << "beside the edge all is dark";
  }
}

TEST(Float32Edge, a_light_on_a_vertex_an_edge_or_a_face) {
  const Mesh lamp = ball();
  for (std::uint32_t t = 0; t < lamp.triangles.size(); t += 5) {
    const Triangle on = lamp.corners(t);
    const glm::vec3* p = on.points;
    for (const glm::vec3& at : {p[0], p[0] / 2.0f + p[1] / 2.0f, p[0] / 2.0f + p[1] / 4.0f + p[2] / 4.0f}) {
      const Seen seen = look(Ground(lamp), point_light(at));
      EXPECT_EQ(seen.wrong_tested, 0) << "triangle " << t << ", " << seen.wrong << " wrong";
    }
  }
}

// The ground twice, and a third time a rounding below: no copy shades the other.
TEST(Float32Edge, receivers_in_one_plane_with_casters) {
  Mesh copies = hand_made::square(6, -2);
  const Mesh below = hand_made::square(6, std::nextafter(-2.0f, -3.0f));
  for (const glm::uvec3& t : below.triangles)
    copies.triangles.push_back(t + static_cast<std::uint32_t>(copies.positions.size()));
  copies.positions.insert(copies.positions.end(), below.positions.begin(), below.positions.end());
  const Mesh above = ball();
  for (const glm::uvec3& t : above.triangles)
    copies.triangles.push_back(t + static_cast<std::uint32_t>(copies.positions.size()));
  copies.positions.insert(copies.positions.end(), above.positions.begin(), above.positions.end());
  for (const Light& light : {point_light({1, 4, 1}), hand_made::sun({0.3f, -1, 0.2f})}) {
    const Seen seen = look(Ground(copies), light);
    EXPECT_EQ(seen.wrong_tested, 0) << seen.wrong;
    EXPECT_GT(seen.dark, 30);
    EXPECT_LT(seen.wrong, seen.uncertain / 10) << "the lift of the ray takes it off all copies";
  }
}

// Over every point hangs a triangle some 3e-7 m wide: rho is 7e-6 m, so shifted rays miss what exact signs say is met.
TEST(Float32Edge, slivers_thinner_than_rho) {
  const Light light = hand_made::sun({0.3f, -1, 0.2f});
  const glm::dvec3 way = glm::normalize(glm::dvec3(homogeneous(light)));
  const Ground bare(hand_made::square(1, -5));
  std::vector<glm::vec3> positions;
  std::vector<glm::uvec3> triangles;
  for (std::size_t i = 0; i < bare.picture.gbuffer.size(); ++i) {
    const glm::dvec3 middle = glm::dvec3(bare.picture.gbuffer.position(i)) + 1.7 * way, along(0.07, 0.01, 0.05);
    const auto first = static_cast<std::uint32_t>(positions.size());
    for (const glm::dvec3& p : {middle - along, middle + along - 3e-7 * across(way)[0], middle + along + 3e-7 * across(way)[0]})
      positions.emplace_back(p);
    triangles.push_back({first, first + 1, first + 2});
  }
  const Seen seen = look(Ground(hand_made::mesh_of(positions, triangles)), light);
  EXPECT_EQ(seen.wrong_tested, 0) << seen.tested << " tested";
  EXPECT_GT(seen.dark, 100);
}

// The light is at the origin, the caster rises from an edge 2^-26 m before it and 2^-24 m below it: from the ground it ends
// just before the light, and all of it that is farther from that edge is behind the light.
TEST(Float32Edge, a_light_just_behind_an_edge) {
  const float before = -0x1p-26f, below = -0x1p-24f;
  const Seen seen = look(Ground(hand_made::mesh_of({{before, below, -3}, {before, below, 3}, {3, 3, 0.5f}}, {{0, 1, 2}})),
                         point_light({0, 0, 0}));
  EXPECT_EQ(seen.wrong_tested, 0) << seen.wrong;
  EXPECT_GT(seen.dark, 500);
}

// Points of a level triangle, rounded at the edge that it shares with a rising one: about half lie beyond it, in its shadow.
TEST(Float32Edge, points_at_the_edge_of_a_fold) {
  Ground ground(hand_made::square(1, -5));
  const glm::vec3 from{-0.31f, -2, -3.1f}, to{0.72f, -2, 2.9f};
  ground.scene.meshes[0] = hand_made::mesh_of({from, to, {-4, -2, 0}, {3, 0.9f, 0}}, {{0, 2, 1}, {0, 1, 3}});
  for (int i = 0; i < 1600; ++i)
    ground.picture.set(i, glm::vec3(glm::mix(glm::dvec3(from), glm::dvec3(to), (i + 0.5) / 1600)), {0, 1, 0}, 0, 0);
  const Seen seen = look(ground, hand_made::sun({0.3f, -1, 0.1f}));
  EXPECT_EQ(seen.wrong_tested, 0) << seen.wrong;
  EXPECT_GT(seen.dark, 300);
}

// The point lies on the edge that its triangle shares with a steeper one, but for rounding, which put it behind that. Its ray
// slips between the two.
TEST(Float32Edge, a_ray_between_its_own_triangle_and_the_next) {
  Ground ground(hand_made::square(1, -5));
  ground.scene.meshes[0] = hand_made::mesh_of(
      {{0.5f, 1.36602545f, -0.433012694f}, {0.25f, 1, -0.866025388f}, {0.25f, 1.36602545f, -0.5f}, {-0.183012709f, 1, -0.75f}},
      {{0, 1, 2}, {2, 1, 3}});
  ground.picture.gbuffer.view.eye = {1, 3, 16};
  for (int i = 0; i < 1600; ++i)
    ground.picture.set(i, {0.25f, 1.06862974f, -0.797395647f}, {-0.18615678f, 0.694746554f, -0.694746673f}, 0, 1);
  const Seen seen = look(ground, hand_made::sun({-1, -3.5f, -2.5f}));
  EXPECT_EQ(seen.dark, 1600);
  EXPECT_EQ(seen.wrong, 1600) << "the reference says lit";
  EXPECT_EQ(seen.wrong_tested, 0);
}

// A power of two rounds nothing, so masks are those at one meter; other scales round every coordinate.
TEST(Float32Edge, scenes_of_any_size_are_traced_alike) {
  const Light lamp = point_light({1, 4, 1});
  const Seen here = look(Ground(ball()), lamp);
  EXPECT_GT(here.dark, 30);
  const auto at = [&](double scale) {
    return look(Ground(ball(), scale), point_light(glm::vec3(scale * glm::dvec3(1, 4, 1))));
  };
  for (const int exponent : {-62, -60, -40, -12, 12, 29, 50, 53}) {
    const Seen seen = at(std::exp2(exponent));
    EXPECT_EQ(seen.mask, here.mask) << "2^" << exponent;
    EXPECT_EQ(seen.uncertain, here.uncertain) << "2^" << exponent;
  }
  for (const double scale : {1e-18, 1e-12, 1e-6, 1e6, 1e15}) {
    const Seen seen = at(scale);
    EXPECT_EQ(seen.wrong_tested, 0) << scale;
    EXPECT_NEAR(seen.tested, here.tested, 3) << scale;
    EXPECT_NEAR(seen.dark, here.dark, 3) << scale;
  }
}

TEST(Float32Edge, a_sun_of_any_length_is_the_same) {
  const Ground ground(ball());
  const Seen seen = look(ground, hand_made::sun({0.25f, -1, 0.5f}));
  EXPECT_GT(seen.dark, 30);
  for (const float length : {0x1p-80f, 0x1p-31f, 0x1p50f})
    EXPECT_EQ(look(ground, hand_made::sun(length * glm::vec3(0.25f, -1, 0.5f))).mask, seen.mask) << length;
}

// 12 m wide and 100,000 km away, coordinates are multiples of 8 m.
TEST(Float32Edge, a_scene_without_room_is_uncertain_as_a_whole) {
  Ground ground(ball());
  const View& view = ground.picture.gbuffer.view;
  EXPECT_TRUE(is_resolved(ground.scene, point_light({1, 4, 1}), view));
  EXPECT_FALSE(is_resolved(ground.scene, point_light({1, 1e8f, 1}), view));
  const Seen seen = look(ground, point_light({1, 1e8f, 1}));
  EXPECT_EQ(seen.tested, 0);
  EXPECT_EQ(seen.uncertain, 1600);
}

TEST(Float32Edge, what_is_smaller_than_squares_of_lengths_is_refused) {
  const Light lamp = point_light({1, 4, 1});
  EXPECT_TRUE(reference_support(Ground(ball(), 1e-18).scene, lamp, {}));
  const Support none = reference_support(Ground(ball(), 1e-21).scene, lamp, {});
  EXPECT_FALSE(none);
  EXPECT_NE(none.why().find("6e-21 m"), std::string::npos) << none.why();
}

}  // namespace gnomon::float32_edge_test
