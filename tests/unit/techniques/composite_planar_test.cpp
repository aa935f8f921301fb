// Analytic composite shadows, exact form, against rays and against formulas on paper.
#include "composite_planar_rig.h"

namespace composite_planar_test {
using namespace composite_rig;
using Point = glm::dvec3;

class CompositePlanar : public TestRig {};

Shape random_shape(Random& random) {
  Point at = random.uniform(Point(-2.2, -0.5, -2.2), Point(2.2, 1.8, 2.2)), axis = small_world::direction_of(random);
  const auto radius = static_cast<float>(random.uniform(0.15, 0.8)), height = static_cast<float>(random.uniform(0.2, 1.3));
  const bool stands = random.below(3) == 0;
  if (stands) at.y = 0, axis = {0, 1, 0};
  switch (random.below(6)) {
    case 0:
      return Sphere{{at.x, stands ? radius : at.y, at.z}, radius};
    case 1:
      return Cone{at, glm::vec3(axis), radius, height};
    case 2:
      return Disc{{at.x, at.y + (stands ? 0.4 : 0), at.z}, glm::vec3(axis), radius};
    case 3: {
      const Point b = random.uniform(Point(-0.8), Point(0.8)), c = random.uniform(Point(-0.8), Point(0.8));
      return Triangle{{at, at + b, at + c}};
    }
    case 4: {
      const Point u = glm::normalize(glm::cross(axis, Point(0.3, 0.2, 1))), v = glm::cross(axis, u);
      return Plane{at, radius * glm::vec3(u), height * 0.7f * glm::vec3(v)};
    }
    default: {
      const Point half = random.uniform(Point(0.1), Point(0.7));
      return Box{at - (stands ? Point(half.x, 0, half.z) : half), at + half};
    }
  }
}

/// A floor, a wall and a tilted roof, and shapes on, in, under and over them and through one another.
Scene random_scene(unsigned seed) {
  Random random(seed);
  Scene scene;
  scene.meshes = {mesh_of(level({0, 0, 0}, 4)), mesh_of(Plane{{-3, 1.5f, 0}, {0, 0, 3}, {0, 1.5f, 0}}),
                  mesh_of(Plane{{1, 2.4f, -2}, {1.2f, 0.2f, 0.4f}, {-0.3f, 0.5f, 0.9f}})};
  for (std::uint32_t k = 4 + random.below(5); k > 0; --k) scene.meshes.push_back(mesh_of(random_shape(random), 12));
  for (Mesh& mesh : scene.meshes) mesh.casts = random.below(8) != 0, mesh.receives = random.below(8) != 0;
  scene.meshes[0].receives = true;
  return scene;
}

// Class T leaves out what changes when the point or the light moves by 16 * 2^-24 of the extent: no other pixel is wrong.
TEST_F(CompositePlanar, exact_agrees_with_rays_at_every_tested_pixel) {
  Tally tally;
  int worlds = 0;
  for (unsigned seed = 1; seed <= 24; ++seed) {
    Random random(seed, 7);
    View from = view;
    from.eye = small_world::direction_of(random) * random.uniform(3, 8);
    if (seed % 3) from.eye.y = std::abs(from.eye.y) + 0.1f;
    const World world(random_scene(seed), from);
    for (const Light& light : lights) {
      if (!supports(world.scene, light)) continue;  // the light is in or on a shape
      SCOPED_TRACE(fmt::format("seed {}, {}", seed, light.name));
      ++worlds;
      compare(world, light, tally);
      EXPECT_EQ(tally.false_dark + tally.false_lit, 0);
    }
  }
  EXPECT_GT(worlds, 180);
  EXPECT_GT(tally.tested, 500000);
  EXPECT_GT(tally.dark, 100000);
  EXPECT_LT(tally.not_covered, tally.tested / 3);
}

// Sizes that tiles do not divide, and one pixel: the answer is that of the tests run one after the other, without tiles.
TEST_F(CompositePlanar, pictures_of_any_size_lose_no_pixel) {
  int asked = 0, dark = 0;
  for (const auto& [width, height] : {std::pair{1, 1}, {33, 31}, {31, 65}, {1, 70}, {200, 2}, {257, 161}})
    for (unsigned seed = 41; seed <= 44; ++seed) {
      const World world(random_scene(seed), view, width, height);
      for (const Light& light : {lights[0], lights[2], lights[6]}) {
        if (!supports(world.scene, light)) continue;
        SCOPED_TRACE(fmt::format("{}x{}, seed {}, {}", width, height, seed, light.name));
        const std::vector<float> answer = mask(world, light);
        const std::vector<PixelClass> classes = world.classes(light, world.reference(light));
        for (std::size_t i = 0; i < answer.size(); ++i) {
          if (classes[i] != PixelClass::T) continue;
          const Explanation why = explain(i);  // runs them all, in double
          EXPECT_EQ(answer[i], why.element ? 0 : 1) << i;
          ++asked, dark += why.element.has_value();
        }
      }
    }
  EXPECT_GT(asked, 100000);
  EXPECT_GT(dark, 10000);
}

/// Whether the ball is in the way from p, outside of it, to the light: the foot of its center on the ray is nearer than the
/// radius, and in front of p; a light outside is then beyond it when it is farther than the foot.
bool behind_ball(const Point& p, const glm::dvec4& light, const Sphere& ball) {
  const Point to = to_light(light, p), direction = glm::normalize(to), center = Point(ball.center) - p;
  const double along = glm::dot(center, direction);
  return along > 0 && glm::length(center - along * direction) <= ball.radius && (light.w == 0 || along < glm::length(to));
}

// Of a light lower than the ball's top the shadow has no end: it is bounded by one branch of a hyperbola; from the top's height
// on, a parabola; of a higher one an ellipse. The other branch, behind the light, is none.
TEST_F(CompositePlanar, low_light_throws_one_branch_of_a_hyperbola) {
  const Sphere ball{{0, 1, 0}, 0.5f};
  Scene scene;
  scene.meshes = {mesh_of(level({0, 0, 0}, 30)), mesh_of(ball)};
  scene.meshes[0].casts = false;
  const World world(std::move(scene), {.eye = {-1, 12, 0.5f}, .target = {-1.5f, 0, 0}, .fov_y_degrees = 120}, 320, 180);
  for (const float height : {0.7f, 1.0f, 1.49f, 1.5f, 1.51f, 3.0f}) {
    const Light light{.kind = PointLight{{1.5f, height, 0.2f}}};
    const std::vector<float> answer = mask(world, light);
    const std::vector<PixelClass> classes = world.classes(light, world.reference(light));
    int wrong = 0, dark = 0;
    double farthest = 0;
    for (std::size_t i = 0; i < answer.size(); ++i) {
      if (world.gbuffer.mesh[i] != 0 || classes[i] != PixelClass::T) continue;
      const Point p = world.gbuffer.position(i);
      wrong += (answer[i] == 0) != behind_ball(p, homogeneous(light), ball);
      dark += answer[i] == 0;
      if (answer[i] == 0) {
        EXPECT_LT(p.x, 1.5) << i;
        farthest = std::max(farthest, -p.x);
      }
    }
    EXPECT_EQ(wrong, 0) << height;
    EXPECT_GT(dark, 20) << height;
    if (height <= 1.5f) {
      EXPECT_GT(farthest, 15) << height;  // as far as the eye sees
    }
    if (height == 3) {
      EXPECT_LT(farthest, 3);
    }
  }
}

// Where the way to the light cuts the disc's plane, within the radius, p is dark.
TEST_F(CompositePlanar, tilted_discs_under_every_light) {
  for (const glm::vec3& normal : {glm::vec3(0, 1, 0), glm::vec3(1, 1, 0.3f), glm::vec3(-0.2f, 0.1f, 1), glm::vec3(1, 0, 0)}) {
    const Disc disc{{0.2f, 0.7f, -0.3f}, normal, 0.9f};  // all but the level one reach through the ground
    Scene scene;
    scene.meshes = {mesh_of(level({0, 0, 0}, 5)), mesh_of(disc)};
    const World world(std::move(scene), view);
    for (const Light& light : lights) {
      const std::vector<float> answer = mask(world, light);
      const std::vector<PixelClass> classes = world.classes(light, world.reference(light));
      const Point n = glm::normalize(Point(normal)), center = disc.center;
      int wrong = 0;
      for (std::size_t i = 0; i < answer.size(); ++i) {
        if (world.gbuffer.mesh[i] != 0 || classes[i] != PixelClass::T) continue;
        const Point p = world.gbuffer.position(i), to = to_light(homogeneous(light), p);
        const double t = glm::dot(n, center - p) / glm::dot(n, to);
        const bool dark = t > 0 && (homogeneous(light).w == 0 || t < 1) && glm::distance(p + t * to, center) <= disc.radius;
        wrong += dark != (answer[i] == 0);
      }
      EXPECT_EQ(wrong, 0) << light.name << " " << normal.x << " " << normal.y << " " << normal.z;
    }
  }
}

// Half of the ball, of the box and of the cone is under the ground: that half casts nothing on it.
TEST_F(CompositePlanar, casters_that_cross_the_ground) {
  const Sphere ball{{-1.5f, 0.1f, 0}, 0.7f};
  Scene scene;
  scene.meshes = {mesh_of(level({0, 0, 0}, 5)), mesh_of(ball), mesh_of(Box{{0.2f, -0.6f, -0.5f}, {1, 0.5f, 0.6f}}),
                  mesh_of(Cone{{2.2f, 0.8f, 0}, {0, -1, 0}, 0.7f, 1.6f}), mesh_of(Sphere{{0, -1, 2}, 0.8f})};
  Tally tally;
  const World world(scene, view);
  for (const Light& light : lights) compare(world, light, tally);
  EXPECT_EQ(tally.false_dark + tally.false_lit, 0);
  EXPECT_GT(tally.dark, 3000);
  // The last ball is wholly below: it changes no pixel of the ground under a light above.
  Scene without = scene;
  without.meshes.pop_back();
  const std::vector<float> with_it = mask(world, lights[0]);
  EXPECT_EQ(with_it, mask(without, lights[0], world.gbuffer));
}

// What two casters hide is hidden once: the mask of both is the lesser of their masks, pixel by pixel, and 0 or 1.
TEST_F(CompositePlanar, shadows_that_overlap_are_no_darker) {
  Scene both;
  both.meshes = {mesh_of(level({0, 0, 0}, 5)), mesh_of(Sphere{{-0.3f, 1, 0}, 0.6f}), mesh_of(Cone{{0.4f, 0.4f, 0.2f}})};
  const World world(both, view);
  int overlap = 0;
  for (const Light& light : lights) {
    Scene first = both, second = both;
    first.meshes[2].casts = second.meshes[1].casts = false;
    const std::vector<float> a = mask(first, light, world.gbuffer), b = mask(second, light, world.gbuffer);
    const std::vector<float> answer = mask(world, light);
    int different = 0;
    for (std::size_t i = 0; i < answer.size(); ++i) {
      EXPECT_TRUE(answer[i] == 0 || answer[i] == 1);
      different += answer[i] != std::min(a[i], b[i]);
      overlap += a[i] == 0 && b[i] == 0;
    }
    EXPECT_EQ(different, 0) << light.name;
  }
  EXPECT_GT(overlap, 100);
}

// Ball: one disc. Cone: a triangle; its base lies in the plane and casts nothing on it. Box: three sides face the light.
TEST_F(CompositePlanar, counts_what_is_asked) {
  Scene scene;
  scene.meshes = {mesh_of(level({0, 0, 0}, 4)), mesh_of(Sphere{{-1, 0.7f, 0}, 0.5f}),
                  mesh_of(Cone{{1, 0, 0}, {0, 1, 0}, 0.5f, 0.9f}), mesh_of(Box{{-0.3f, 0, 1}, {0.4f, 0.5f, 1.6f}})};
  for (std::size_t m = 1; m < 4; ++m) scene.meshes[m].receives = false;
  const World world(scene, view, 256, 160);
  const std::vector<float> answer = mask(world, {.kind = PointLight{{-3, 6, -4}}});
  EXPECT_EQ(count("casters"), 4);
  EXPECT_EQ(count("planes"), 1);
  EXPECT_EQ(count("discs"), 1);
  EXPECT_EQ(count("polygons"), 4);
  const auto dark = std::ranges::count(answer, 0.0f);
  EXPECT_GT(dark, 400);
  EXPECT_GE(count("fill"), dark);
  EXPECT_LT(count("fill"), 256 * 160 / 2);  // not the screen
  EXPECT_GT(count("patches"), 0);
  EXPECT_GT(count("asked"), 0);
  EXPECT_LE(count("asked"), count("fill") * 5);
  EXPECT_GT(count("bytes"), 5 * 96);

  // Nothing casts: nothing is drawn.
  for (Mesh& mesh : scene.meshes) mesh.casts = false;
  for (const float value : mask(scene, lights[0], world.gbuffer)) EXPECT_EQ(value, 1);
  EXPECT_EQ(count("patches"), 0);
  EXPECT_EQ(count("fill"), 0);
}

// Stages again in any order give what a fresh object gives, and buffers that were larger or smaller leave nothing behind.
TEST_F(CompositePlanar, another_scene_light_and_size_leave_nothing_behind) {
  std::vector<Scene> scenes;
  for (unsigned seed = 61; seed <= 63; ++seed) scenes.push_back(random_scene(seed));
  scenes.emplace_back().meshes = {mesh_of(level({0, 0, 0}, 4))};
  std::vector<std::vector<float>> fresh;
  std::vector<World> worlds;
  for (const Scene& scene : scenes)
    for (const auto& [width, height] : {std::pair{96, 64}, {37, 80}}) worlds.emplace_back(scene, view, width, height);
  const Light& light = lights[7];
  for (const World& world : worlds)
    fresh.push_back(small_world::run(gnomon_technique_composite_planar, "", world.scene, light, world.gbuffer).mask);
  for (int round = 0; round < 2; ++round)
    for (const std::size_t k : {0, 6, 3, 1, 4, 7, 2, 5}) {
      EXPECT_EQ(mask(worlds[k], light), fresh[k]) << k;
      const std::size_t twin = k ^ 1;  // the same scene in the other size
      Technique& t = technique("");
      t.build(worlds[twin].scene);
      t.relight(lights[5]);
      t.relight(light);
      EXPECT_EQ(resolve(worlds[twin].gbuffer), fresh[twin]) << twin;
    }
}

}  // namespace composite_planar_test
