// Rays, exact segments and exact shares in scenes that move: after updates they answer as where they are built.
//
// GNOMON_PIXELS=1000000 tests about that many rays instead of the few of every day; GNOMON_SEED=1 tests others.
#include <gnomon/kit/area/area_scene.h>
#include <gnomon/kit/geometry/edges.h>
#include <gnomon/kit/geometry/exact_scene.h>
#include <gnomon/kit/random.h>
#include <gnomon/kit/rays/ray_casters.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdlib>

#include "generated_scene.h"
#include "measure/conformance/motion_world.h"
#include "measure/scene/posed_scene.h"
#include "moving_world.h"
#include "small_world.h"

namespace refit_scenes_test {

using namespace gnomon;

struct Moving {
  std::string name;
  Scene scene;
  std::string animation;
};

std::vector<Moving> moving_scenes() {
  std::vector<Moving> all;
  all.push_back({"walking_boxes", generated::make("walking_boxes"), "walk"});
  all.push_back({"bending_tube", generated::make("bending_tube"), "bend"});
  all.push_back({"swarm", generated::make("swarm", "count=2000,reach=1.6"), "fly"});
  all.push_back({"moving_world", moving_world::scene(), "walk"});
  all.push_back({"sleeper", moving_world::scene(), "sleep"});
  all.push_back({"moving_things", conformance::moving_things(true), "move"});  // triangles lose their area, a mesh is a point
  all.push_back({"moving_ground", conformance::moving_ground(), "move"});
  return all;
}

/// Frames of the rows, 8 a second: neighbors, far ones, back to where it began, and the same twice.
constexpr int frames[] = {0, 1, 2, 16, 16, 24, 8, 25, 0};
RowPose at_frame(const Moving& moving, int frame) {
  return {.animation = moving.animation, .seconds = frame / 8.0, .start = 0, .frame_rate = 8, .frames = 33};
}

std::size_t wanted_rays(std::size_t usual) {
  const char* wanted = std::getenv("GNOMON_PIXELS");
  return wanted ? std::strtoull(wanted, nullptr, 10) : usual;
}
Random seeded() {
  const char* seed = std::getenv("GNOMON_SEED");
  return Random(seed ? std::strtoull(seed, nullptr, 10) : 5);
}

/// A ray through the scene as it is now. Of two one goes anywhere and one through a place on a triangle; with edges of three
/// one goes at an edge, too.
struct Ray {
  glm::vec3 origin, direction;
};
Ray random_ray(const Scene& scene, Random& random, bool with_edges = true) {
  const Bounds bounds = scene.bounds();
  const glm::dvec3 low(bounds.min), high(bounds.max), room(0.1 * glm::length(high - low));
  const glm::dvec3 origin = random.uniform(low - room, high + room);
  glm::dvec3 to = random.uniform(low, high);
  const Mesh& mesh = scene.meshes[random.below(static_cast<std::uint32_t>(scene.meshes.size()))];
  if (const std::uint32_t kind = random.below(with_edges ? 3 : 2); kind > 0) {
    const Triangle triangle = mesh.corners(random.below(static_cast<std::uint32_t>(mesh.triangles.size())));
    const double u = random.uniform(0, 1), v = kind == 1 ? random.uniform(0, 1 - u) : 0;
    const glm::dvec3 a(triangle.points[0]), b(triangle.points[1]), c(triangle.points[2]);
    to = a + u * (b - a) + v * (c - a);
  }
  return {glm::vec3(origin), glm::vec3(2.0 * (to - origin))};
}

struct Answers {
  std::vector<std::uint32_t> occluded;
  std::vector<double> closest;
  std::size_t blocked() const {
    std::size_t count = 0;
    for (const std::uint32_t bits : occluded) count += static_cast<std::size_t>(std::popcount(bits));
    return count;
  }
  bool operator==(const Answers&) const = default;
};

Answers answers(const RayScene& rays, const std::vector<Ray>& asked) {
  std::array<std::uint32_t, ray_lanes> mesh, triangle;
  mesh.fill(no_mesh);
  triangle.fill(0);
  Answers result;
  for (std::size_t first = 0; first + ray_lanes <= asked.size(); first += ray_lanes) {
    ShadowPacket packet;
    for (int lane = 0; lane < ray_lanes; ++lane) {
      const Ray& ray = asked[first + static_cast<std::size_t>(lane)];
      set_ray(packet, lane, ray.origin, ray.direction, lane % 2 ? INFINITY : 1);
    }
    result.occluded.push_back(rays.occluded(0xffff, packet, {mesh.data(), triangle.data()}));
    result.closest.push_back(rays.closest(asked[first].origin, asked[first].direction).t);
  }
  return result;
}

TEST(RayScene, answers_after_updates_as_one_that_is_built_there) {
  Random random = seeded();
  for (Moving& moving : moving_scenes()) {
    SCOPED_TRACE(moving.name);
    PosedScene posed(moving.scene);
    posed.go_to(at_frame(moving, 0));
    posed.take_changes();
    RayScene all(moving.scene, Truth::shape, RayScene::Which::seen, RayScene::Trees::moving);
    RayScene casters(moving.scene, Truth::mesh, RayScene::Which::casters, RayScene::Trees::moving);
    const std::size_t ray_count = wanted_rays(30'000) / std::size(frames) / 7 + ray_lanes;
    std::size_t blocked = 0;
    for (const int frame : frames) {
      posed.go_to(at_frame(moving, frame));
      const Changes changes = posed.take_changes();
      all.update(changes);
      casters.update(changes);
      std::vector<Ray> asked(ray_count), away_from_edges(ray_count);
      for (Ray& ray : asked) ray = random_ray(moving.scene, random);
      for (Ray& ray : away_from_edges) ray = random_ray(moving.scene, random, false);
      for (const RayScene* const updated : {&all, &casters}) {
        const Truth truth = updated == &all ? Truth::shape : Truth::mesh;
        const RayScene::Which which = updated == &all ? RayScene::Which::seen : RayScene::Which::casters;
        const Answers now = answers(*updated, asked);
        blocked += now.blocked();
        EXPECT_EQ(now, answers(RayScene(moving.scene, truth, which, RayScene::Trees::moving), asked)) << "frame " << frame;
        // A ray through an open edge, within rounding, is another ray in each of Embree's structures.
        const RayScene fixed(moving.scene, truth, which);
        EXPECT_EQ(answers(*updated, away_from_edges).occluded, answers(fixed, away_from_edges).occluded) << "frame " << frame;
      }
    }
    EXPECT_GT(blocked, ray_count) << "of " << 2 * std::size(frames) * ray_count;
    posed.go_to(std::nullopt);
  }
}

TEST(RayScene, holds_after_updates_the_bytes_and_edges_of_one_that_is_built_there) {
  Moving moving{"moving_things", conformance::moving_things(true), "move"};
  PosedScene posed(moving.scene);
  posed.go_to(at_frame(moving, 0));
  posed.take_changes();
  RayScene rays(moving.scene, Truth::mesh, RayScene::Which::casters, RayScene::Trees::moving);
  for (const int frame : frames) {
    posed.go_to(at_frame(moving, frame));
    rays.update(posed.take_changes());
    const RayScene built(moving.scene, Truth::mesh, RayScene::Which::casters, RayScene::Trees::moving);
    EXPECT_EQ(rays.bytes(), built.bytes()) << frame;
    EXPECT_TRUE(std::ranges::equal(rays.adjacency().positions(), built.adjacency().positions())) << frame;
  }
  posed.go_to(std::nullopt);
}

// A packet straight down on a square of which a thousandth is enough to be hit, and on the same square a thousand times as
// large.
TEST(RayScene, follows_a_mesh_that_grows_a_thousandfold_and_shrinks_again) {
  Scene scene;
  scene.meshes = {small_world::ground(1), small_world::ground(0.5f, 2)};
  const std::vector<glm::vec3> small = scene.meshes[1].positions;
  std::vector<glm::vec3> large = small;
  for (glm::vec3& p : large) p = {1000 * p.x, p.y, 1000 * p.z};
  scene.meshes[1].reach.add(large);
  Changes changes;
  changes.meshes.resize(2);
  changes.meshes[1].kind = MeshChange::Kind::deformed;
  changes.meshes[1].count = static_cast<std::uint32_t>(small.size());
  RayScene rays(scene, Truth::mesh, RayScene::Which::casters, RayScene::Trees::moving);
  for (const bool is_large : {false, true, false, true}) {
    scene.meshes[1].positions = is_large ? large : small;
    ++scene.pose_number;
    rays.update(changes);
    for (const double x : {0.25, 0.75, 400.5, 600.0}) {
      const RayScene::Hit hit = rays.closest({x, 8, 0.1}, {0, -1, 0});
      const bool meets_upper = x < (is_large ? 500 : 0.5);
      EXPECT_EQ(hit.mesh, meets_upper ? 1u : x < 1 ? 0u : no_mesh) << x << (is_large ? ", large" : ", small");
    }
  }
}

TEST(RayCasters, follow_meshes_that_lose_their_exact_shape_and_get_it_back) {
  Random random = seeded();
  Moving moving{"moving_world", moving_world::scene(), "walk"};
  RayCasters casters;
  PosedScene posed(moving.scene);
  casters.build(moving.scene);
  const auto expect_same = [&](const char* where) {
    std::vector<Ray> asked(1000);
    for (Ray& ray : asked) ray = random_ray(moving.scene, random);
    RayCasters built;
    built.build(moving.scene);
    for (const Truth truth : {Truth::shape, Truth::mesh})
      EXPECT_EQ(answers(casters.under(truth), asked), answers(built.under(truth), asked)) << where;
    EXPECT_EQ(casters.bytes(), built.bytes()) << where;
  };
  ASSERT_TRUE(moving.scene.has_curved_shapes());
  for (const int frame : {0, 5, 9}) {
    posed.go_to(at_frame(moving, frame));
    casters.update(moving.scene, posed.take_changes());
    expect_same("in the row");
  }
  ASSERT_FALSE(moving.scene.has_curved_shapes());
  posed.go_to(std::nullopt);
  casters.update(moving.scene, posed.take_changes());
  expect_same("at rest");
}

TEST(ExactScene, answers_after_updates_as_one_that_is_built_there) {
  Random random = seeded();
  for (Moving& moving : moving_scenes()) {
    SCOPED_TRACE(moving.name);
    PosedScene posed(moving.scene);
    posed.go_to(at_frame(moving, 0));
    posed.take_changes();
    ExactScene exact(moving.scene);
    ExactTally tally;
    for (const int frame : frames) {
      posed.go_to(at_frame(moving, frame));
      exact.update(posed.take_changes());
      const ExactScene built(moving.scene);
      EXPECT_EQ(exact.bytes(), built.bytes()) << frame;
      for (int k = 0; k < 200; ++k) {
        const Ray ray = random_ray(moving.scene, random);
        const glm::dvec4 light =
            k % 2 ? glm::dvec4(glm::vec3(ray.origin + ray.direction), 1) : glm::dvec4(glm::dvec3(ray.direction), 0);
        EXPECT_EQ(exact.occluded({ray.origin}, light, tally), built.occluded({ray.origin}, light, tally)) << frame;
        EXPECT_EQ(exact.edge_margin({ray.origin}, light, 0.01).clearance,
                  built.edge_margin({ray.origin}, light, 0.01).clearance)
            << frame;
      }
    }
    posed.go_to(std::nullopt);
  }
}

TEST(AreaScene, answers_after_updates_bit_for_bit_as_one_that_is_built_there) {
  Random random = seeded();
  LightPieces pieces;
  AreaTally tally;
  std::size_t partial = 0;
  for (Moving& moving : moving_scenes()) {
    SCOPED_TRACE(moving.name);
    PosedScene posed(moving.scene);
    AreaScene area(moving.scene);  // at rest, which is no row
    for (const int frame : frames) {
      posed.go_to(at_frame(moving, frame));
      area.update(posed.take_changes());
      const AreaScene built(moving.scene);
      EXPECT_EQ(area.bytes(), built.bytes()) << frame;
      for (int k = 0; k < 40; ++k) {
        const Ray ray = random_ray(moving.scene, random);
        if (glm::length(ray.direction) < 1) continue;  // never inside of the lamp
        const glm::vec3 place = ray.origin + ray.direction;
        const Light lamp{.name = "lamp", .kind = SphereLight{place, 0.3f}};
        const LightFigure figure(lamp, ray.origin, glm::normalize(glm::dvec3(ray.direction)));
        if (!figure.is_seen()) continue;
        const double share = area.seen({ray.origin}, figure, pieces, tally).area.best;
        EXPECT_EQ(share, built.seen({ray.origin}, figure, pieces, tally).area.best) << frame;
        partial += share > 0 && share < 1;
      }
    }
    posed.go_to(std::nullopt);
  }
  EXPECT_GT(partial, 50u);
}

}  // namespace refit_scenes_test
