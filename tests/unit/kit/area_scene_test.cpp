// Exact shares of lights with area over whole scenes: what the tree finds is what every triangle by itself leaves.
#include <gnomon/kit/area/area_scene.h>
#include <gnomon/kit/geometry/shapes.h>
#include <gnomon/kit/random.h>
#include <gtest/gtest.h>

#include <cmath>

#include "hand_made.h"

namespace gnomon::area_scene_test {

std::vector<Light> lights() {
  return {{.name = "rect", .kind = RectLight{{0, 3, 0}, {1, 0, 0.2f}, {0, 0.3f, 1}}},
          {.name = "disc", .kind = DiscLight{{1, 3, -1}, {0.2f, -1, 0}, 0.8f}},
          {.name = "sphere", .kind = SphereLight{{-1, 2.5f, 1}, 0.6f}},
          {.name = "low", .kind = RectLight{{3, 0.4f, 0}, {0, 0.6f, 0}, {0, 0, 1}}}};  // half below the floor's horizon
}

/// Triangles of any place and size around the lights, some beyond them and some below the floor.
Scene soup(Random& random, int count) {
  Scene scene;
  Mesh& mesh = scene.meshes.emplace_back();
  for (int k = 0; k < count; ++k) {
    const glm::dvec3 place = random.uniform({-3, -0.5, -3}, {3, 4, 3});
    const double size = k % 9 == 0 ? 2 : 0.4;
    for (int corner = 0; corner < 3; ++corner)
      mesh.positions.emplace_back(place + random.uniform(glm::dvec3(-size), glm::dvec3(size)));
    const auto first = static_cast<std::uint32_t>(3 * k);
    mesh.triangles.emplace_back(first, first + 1, first + 2);
  }
  finish(mesh);
  return scene;
}

TEST(AreaScene, asks_every_triangle_that_matters) {
  Random random(3);
  double dark = 0, partly = 0;
  for (int round = 0; round < 20; ++round) {
    const Scene scene = soup(random, 10 + 15 * round);
    const AreaScene exact(scene);
    LightPieces pieces, all;
    AreaTally tally;
    for (const Light& light : lights())
      for (int k = 0; k < 10; ++k) {
        const glm::vec3 point(random.uniform({-2, 0, -2}, {2, 0.3, 2}));
        const LightFigure face(light, point, {0, 1, 0});
        if (!face.is_seen()) continue;
        const LightShares shares = exact.seen({point}, face, pieces, tally);
        all.start(face);
        for (std::size_t t = 0; t < scene.meshes[0].triangles.size(); ++t) {
          const Triangle caster = scene.meshes[0].corners(t);
          const glm::dvec3 p(point);
          all.subtract(glm::dvec3(caster.points[0]) - p, glm::dvec3(caster.points[1]) - p, glm::dvec3(caster.points[2]) - p);
        }
        // The order of the triangles differs, and with it how pieces are cut and which slivers are let go.
        EXPECT_NEAR(shares.area.best, all.shares().area.best, 1e-9) << light.name;
        EXPECT_NEAR(shares.irradiance.best, all.shares().irradiance.best, 1e-9) << light.name;
        dark += shares.area.best == 0;
        partly += shares.area.best > 0 && shares.area.best < 1;
      }
  }
  EXPECT_GT(dark, 20);
  EXPECT_GT(partly, 200);
}

// A point of a floor that float32 put below it, or that lies in it with its neighbors, is not shaded by the floor.
TEST(AreaScene, a_surface_does_not_shade_itself) {
  Scene scene;
  scene.meshes = {hand_made::square(5, 0)};
  const AreaScene exact(scene);
  LightPieces pieces;
  AreaTally tally;
  for (const Light& light : lights())
    for (const float y : {0.0f, -1e-7f, 1e-7f}) {
      const Receiver receiver{{0.3f, y, 0.1f}, 0, 0};
      const LightFigure face(light, receiver.point, {0, 1, 0});
      const LightShares shares = exact.seen(receiver, face, pieces, tally);
      EXPECT_EQ(shares.area.best, 1) << light.name;
      EXPECT_EQ(shares.irradiance.best, 1) << light.name;
    }
}

// The light lies on the caster: it covers nothing before it; and a caster through the light's middle covers the half on this
// side as seen from there.
TEST(AreaScene, casters_that_touch_the_light_have_an_answer) {
  Scene scene;
  scene.meshes = {hand_made::square(1, 3)};
  LightPieces pieces;
  AreaTally tally;
  const Light panel{.name = "panel", .kind = RectLight{{0, 3, 0}, {1, 0, 0}, {0, 0, 1}}};
  const LightFigure face(panel, {0, 0, 0}, {0, 1, 0});
  EXPECT_EQ(AreaScene(scene).seen({{0, 0, 0}}, face, pieces, tally).area.best, 1);
  Scene wall;
  Mesh& mesh = wall.meshes.emplace_back();
  mesh.positions = {
      {0, 2, -9}, {0, 2, 9}, {0, 4, 0}};  // of x = 0, seen from x = -1: its part below the light covers x in 0 .. 0.5
  mesh.triangles = {{0, 1, 2}};
  finish(mesh);
  const LightFigure from_side(panel, {-1, 0, 0}, {0, 1, 0});
  EXPECT_NEAR(AreaScene(wall).seen({{-1, 0, 0}}, from_side, pieces, tally).area.best, 0.75, 1e-12);
}

// A light that covers the top of a box, to its edges: each wall has a triangle with one corner in the light's plane and one
// with two. Seen from the floor the walls hide all of it, and from above nothing does.
TEST(AreaScene, a_light_on_a_box_is_behind_its_walls) {
  Scene scene;
  scene.meshes = {tessellate(Box{{-0.5f, 0, -0.5f}, {0.5f, 1, 0.5f}}, 4, "box")};
  const AreaScene exact(scene);
  const Light top{.name = "top", .kind = RectLight{{0, 1, 0}, {0.5f, 0, 0}, {0, 0, 0.5f}}};
  LightPieces pieces;
  AreaTally tally;
  Random random(4);
  for (int k = 0; k < 200; ++k) {
    glm::vec3 point(random.uniform({-3, 0, -3}, {3, 0.9, 3}));
    if (std::max(std::abs(point.x), std::abs(point.z)) < 0.6f) continue;
    EXPECT_EQ(exact.seen({point}, LightFigure(top, point, {0, 1, 0}), pieces, tally).area.best, 0)
        << point.x << ", " << point.z;
    point.y += 2;
    EXPECT_EQ(exact.seen({point}, LightFigure(top, point, {0, -1, 0}), pieces, tally).area.best, 1)
        << point.x << ", " << point.z;
  }
}

// A fin of height 1 stands below a light at the height 2 on one tip: with the tip in the light's plane, a rounding before or
// behind it, the share is the same. From (2, 0, 0) the fin x = 0 from (0, 1, -1) and (0, 1, 1) to (0, 2, 0) covers, of the
// light -1 < x < 1, what lies beyond it: the triangle's picture from there has its base at x = -2, z = +-2, and its tip where
// it is, so that the light loses |z| < -x of its half x < 0: a quarter.
TEST(AreaScene, a_tip_at_the_light_has_one_answer) {
  for (const float tip : {2.0f, std::nextafter(2.0f, 0.0f), std::nextafter(2.0f, 3.0f), 1.9999f, 2.0001f}) {
    Scene scene;
    Mesh& mesh = scene.meshes.emplace_back();
    mesh.positions = {{0, 1, -1}, {0, 1, 1}, {0, tip, 0}};
    mesh.triangles = {{0, 1, 2}};
    finish(mesh);
    const Light panel{.name = "panel", .kind = RectLight{{0, 2, 0}, {1, 0, 0}, {0, 0, 1}}};
    LightPieces pieces;
    AreaTally tally;
    const double share = AreaScene(scene).seen({{2, 0, 0}}, LightFigure(panel, {2, 0, 0}, {0, 1, 0}), pieces, tally).area.best;
    EXPECT_NEAR(share, 0.75, 1e-6 + std::abs(tip - 2)) << tip;
  }
}

}  // namespace gnomon::area_scene_test
