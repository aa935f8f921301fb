// The exact scene against brute force, and the technique on hand-made G-buffers.
#include <gnomon/kit/geometry/exact_scene.h>
#include <gnomon/kit/random.h>
#include <gnomon/registry.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "hand_made.h"

extern "C" void gnomon_technique_exact_rays(gnomon::Registry& registry);

namespace gnomon::exact_rays_test {

using namespace hand_made;

Triangle corners(const Mesh& mesh, const glm::uvec3& t) {
  return {{mesh.positions[t.x], mesh.positions[t.y], mesh.positions[t.z]}};
}

/// Every triangle tested, in order; own ones left out as Receiver says.
ExactAnswer brute_force(const Scene& scene, const Receiver& receiver, const glm::dvec4& light) {
  bool crossed = false, touched = false;
  for (std::uint32_t m = 0; m < scene.meshes.size(); ++m)
    for (std::uint32_t t = 0; t < scene.meshes[m].triangles.size(); ++t) {
      const Mesh& mesh = scene.meshes[m];
      const Triangle caster = corners(mesh, mesh.triangles[t]);
      bool own = !mesh.casts;
      if (receiver.mesh != no_mesh) {
        const Mesh& own_mesh = scene.meshes[receiver.mesh];
        const Triangle plane = corners(own_mesh, own_mesh.triangles[receiver.triangle]);
        own |= std::all_of(caster.points, caster.points + 3,
                           [&](const glm::vec3& p) { return coplanar(plane.points[0], plane.points[1], plane.points[2], p); });
      }
      if (own) continue;
      const Crossing crossing = crosses({receiver.point, light}, caster);
      crossed |= crossing == Crossing::crosses;
      touched |= crossing == Crossing::degenerate;
    }
  return {crossed || touched, touched && !crossed};
}

/// Triangles that are hard on trees and predicates: loose ones, slivers, exact copies, stacks in axis planes, some far larger.
Scene soup(Random& random, int count) {
  // On a grid of 1/8, so that shared planes, edges and corners happen.
  const auto grid = [&](float scale) {
    const auto coordinate = [&] { return scale * (static_cast<float>(random.below(33)) / 8 - 2); };
    return glm::vec3(coordinate(), coordinate(), coordinate());
  };
  Scene scene;
  for (int m = 0; m < 2; ++m) {
    Mesh mesh;
    mesh.casts = true;
    for (int i = 0; i < count; ++i) {
      glm::vec3 a = grid(1), b = grid(1), c = grid(1);
      const std::uint32_t kind = random.below(6);
      if (kind == 0) c = b + glm::vec3(0, 0, 0x1p-12f);                      // sliver
      if (kind == 1) a.y = b.y = c.y = static_cast<float>(random.below(3));  // stack
      if (kind == 2) b = 8.0f * b;                                           // large
      if (kind == 3 && i > 0) {                                              // copy of the last
        const std::size_t n = mesh.positions.size();
        a = mesh.positions[n - 3], b = mesh.positions[n - 2], c = mesh.positions[n - 1];
      }
      const auto first = static_cast<std::uint32_t>(mesh.positions.size());
      mesh.positions.insert(mesh.positions.end(), {a, b, c});
      mesh.triangles.emplace_back(first, first + 1, first + 2);
    }
    finish(mesh);
    scene.meshes.push_back(mesh);
  }
  return scene;
}

TEST(ExactScene, the_tree_answers_like_brute_force) {
  Random random(1);
  int blocked = 0, free = 0, degenerate = 0;
  for (int round = 0; round < 60; ++round) {
    const Scene scene = soup(random, round < 5 ? round : 40);
    const ExactScene exact(scene);
    for (int i = 0; i < 150; ++i) {
      Receiver receiver{{random.uniform(-2, 2), random.uniform(-2, 2), random.uniform(-2, 2)}};
      const auto m = random.below(2);
      const Mesh& mesh = scene.meshes[m];
      if (!mesh.triangles.empty() && random.below(4)) {
        const std::uint32_t t = random.below(static_cast<std::uint32_t>(mesh.triangles.size()));
        const Triangle own = corners(mesh, mesh.triangles[t]);
        receiver = {(own.points[0] + own.points[1]) / 4.0f + own.points[2] / 2.0f, m, t};
        if (random.below(4) == 0) receiver = {receiver.point};  // the same point, in space
      }
      // Lights on a grid are in supporting planes and along axes; the last one makes the way go exactly through a corner.
      const glm::vec3 to = glm::vec3(random.below(9), random.below(9), random.below(9)) / 2.0f - 2.0f;
      if (to == glm::vec3(0)) continue;
      const glm::vec3 aim =
          mesh.positions.empty() ? to : mesh.positions[random.below(static_cast<std::uint32_t>(mesh.positions.size()))];
      for (const Light& light : {point_light(3.0f * to), sun(to), point_light(2.0f * aim - receiver.point)}) {
        const glm::dvec4 l = homogeneous(light);
        ExactTally tally;
        const ExactAnswer answer = exact.occluded(receiver, l, tally), expected = brute_force(scene, receiver, l);
        ASSERT_EQ(answer, expected) << "round " << round << ", ray " << i;
        ++(answer.blocked ? blocked : free);
        degenerate += answer.degenerate;
        EXPECT_EQ(tally.rays, 1u);
      }
    }
  }
  EXPECT_GT(blocked, 1000);
  EXPECT_GT(free, 1000);
  EXPECT_GT(degenerate, 20);
}

// Enough pixels for every thread, several times: the mask is that of brute force and the counts repeat.
TEST(ExactScene, all_threads_give_the_answers_of_one) {
  Random random(9);
  const Scene scene = soup(random, 100);
  const ExactScene exact(scene);
  Picture picture(200, 40);
  for (std::size_t i = 0; i < picture.gbuffer.size(); ++i) {
    const Mesh& mesh = scene.meshes[i % 2];
    const std::uint32_t t = random.below(static_cast<std::uint32_t>(mesh.triangles.size()));
    const Triangle own = corners(mesh, mesh.triangles[t]);
    picture.set(i, (own.points[0] + own.points[1] + own.points[2]) / 3.0f, {0, 1, 0}, i % 2, t);
  }
  for (const Light& light : {point_light({0.3f, 20, 0.1f}), sun({0, -1, 0})}) {
    std::vector<float> mask(picture.gbuffer.size()), again(mask);
    const ExactTally tally = exact.decide(picture.gbuffer, light, mask);
    EXPECT_EQ(exact.decide(picture.gbuffer, light, again).triangles, tally.triangles);
    EXPECT_EQ(mask, again);
    EXPECT_EQ(tally.rays, mask.size());
    for (std::size_t i = 0; i < mask.size(); ++i)
      ASSERT_EQ(mask[i] == 0, brute_force(scene, receiver_at(scene, picture.gbuffer, i), homogeneous(light)).blocked)
          << "pixel " << i;
  }
}

// Corners on a lattice of 2^-7 within +-8 and barycentrics in steps of 2^-10 make points on a lattice of 2^-17 within +-8: 20
// bits and a sign, so float32 and the triangle's plane hold them exactly. Then no triangle need be named: the plane's own sign
// is zero.
TEST(ExactScene, a_receiver_exactly_on_its_plane_needs_no_name) {
  Random random(2);
  const auto corner = [&] {
    return (glm::vec3(random.below(2049), random.below(2049), random.below(2049)) - 1024.0f) * 0x1p-7f;
  };
  for (int round = 0; round < 200; ++round) {
    // A parallelogram in two triangles: a neighbor across the diagonal, exactly coplanar.
    const glm::vec3 a = corner() / 4.0f, u = corner() / 4.0f, v = corner() / 4.0f;
    const auto snap = [](const glm::vec3& p) { return glm::round(p * 128.0f) / 128.0f; };
    const glm::vec3 p = snap(a), q = snap(a + u), s = snap(a + v), r = q + s - p;
    Scene scene;
    scene.meshes = {mesh_of({p, q, r, s}, {{0, 1, 2}, {0, 2, 3}}), mesh_of({corner(), corner(), corner()}, {{0, 1, 2}})};
    if (scene.meshes[0].triangles.size() != 2) continue;
    const ExactScene exact(scene);
    for (int i = 0; i < 50; ++i) {
      const std::uint32_t t = random.below(2), w0 = random.below(1025), w1 = random.below(1025 - w0);
      const Triangle own = corners(scene.meshes[0], scene.meshes[0].triangles[t]);
      const glm::dvec3 point =
          (static_cast<double>(w0) * glm::dvec3(own.points[0]) + static_cast<double>(w1) * glm::dvec3(own.points[1]) +
           static_cast<double>(1024 - w0 - w1) * glm::dvec3(own.points[2])) /
          1024.0;
      ASSERT_EQ(glm::dvec3(glm::vec3(point)), point);
      ExactTally tally;
      const glm::dvec4 light(corner(), 1);
      const ExactAnswer named = exact.occluded({point, 0, t}, light, tally);
      EXPECT_EQ(exact.occluded({point}, light, tally), named);
      EXPECT_EQ(exact.occluded({point, 0, 1 - t}, light, tally), named);
      Scene without = scene;
      without.meshes[0].casts = false;
      EXPECT_EQ(ExactScene(without).occluded({point}, light, tally), named);
    }
  }
}

// Octahedron |x| + |y| + |z| = 1 seen from its center: toward (2, 2, 0) the way goes through the edge from (1, 0, 0) to (0, 1,
// 0), toward (2, 0, 0) through a vertex, toward (2, 2, 2) through a face.
TEST(ExactScene, an_edge_or_a_vertex_blocks_and_is_counted) {
  Scene scene;
  std::vector<glm::uvec3> triangles;
  for (const std::uint32_t x : {0u, 1u})
    for (const std::uint32_t y : {2u, 3u})
      for (const std::uint32_t z : {4u, 5u}) triangles.emplace_back(x, y, z);
  scene.meshes = {mesh_of({{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}}, triangles)};
  const ExactScene exact(scene);
  ExactTally tally;
  EXPECT_EQ(exact.occluded({}, {2, 2, 0, 1}, tally), (ExactAnswer{true, true}));
  EXPECT_EQ(exact.occluded({}, {2, 0, 0, 0}, tally), (ExactAnswer{true, true}));
  EXPECT_EQ(exact.occluded({}, {2, 2, 2, 1}, tally), (ExactAnswer{true, false}));
  EXPECT_EQ(exact.occluded({}, {0.1f, 0.1f, 0, 1}, tally), (ExactAnswer{false, false}));
  // From below through the edge, then out by a face: the face settles it.
  EXPECT_EQ(exact.occluded({{-1.5f, -0.5f, 0.125f}}, {glm::vec3(0.5f, 0.25f, 2), 1}, tally).degenerate, false);
  EXPECT_EQ(tally.degenerate, 2u);
}

// A way along the x axis, inside the plane z = 0 (then with axes turned) that bounds the caster's box: a box test multiplies
// zero by infinity there. The edge from (2, -1, 0) to (2, 1, 0) is hit at its middle; a caster that starts at z = 1 is not.
TEST(ExactScene, a_way_inside_a_side_of_a_box_meets_the_box) {
  for (int turn = 0; turn < 3; ++turn)
    for (const float up : {1.0f, -1.0f}) {
      const auto turned = [&](float x, float y, float z) {
        glm::vec3 p;
        p[turn] = x, p[(turn + 1) % 3] = y, p[(turn + 2) % 3] = z;
        return p;
      };
      const auto caster = [&](float z) {
        Scene scene;
        scene.meshes = {mesh_of({turned(2, -1, z), turned(2, 1, z), turned(2, 0, z + up)}, {{0, 1, 2}})};
        return scene;
      };
      const Scene touched = caster(0), missed = caster(up);
      ExactTally tally;
      for (const double w : {0.0, 1.0}) {
        EXPECT_EQ(ExactScene(touched).occluded({}, {turned(4, 0, 0), w}, tally), (ExactAnswer{true, true}));
        EXPECT_EQ(ExactScene(touched).occluded({}, {turned(4, -0.0f, -0.0f), w}, tally), (ExactAnswer{true, true}));
        EXPECT_EQ(ExactScene(missed).occluded({}, {turned(4, 0, 0), w}, tally), (ExactAnswer{}));
      }
    }
}

// The edge x = 1 of a triangle in the plane z = 2. The way from the origin to (0, 0, 4) passes 1 m beside it, at half its
// length, so that 1 m there is 2 m at the receiver. The other edges are farther. A sun has no end: nothing is scaled.
TEST(ExactScene, an_edge_margin_is_carried_to_the_receiver) {
  Scene scene;
  scene.meshes = {mesh_of({{1, -9, 2}, {1, 9, 2}, {9, 0, 2}}, {{0, 1, 2}})};
  const ExactScene exact(scene);
  const EdgeMargin point = exact.edge_margin({}, {0, 0, 4, 1}, INFINITY);
  EXPECT_NEAR(point.clearance, 1, 1e-12);
  EXPECT_NEAR(point.carried, 2, 1e-12);
  const EdgeMargin directional = exact.edge_margin({}, {0, 0, 4, 0}, INFINITY);
  EXPECT_NEAR(directional.clearance, 1, 1e-12);
  EXPECT_NEAR(directional.carried, 1, 1e-12);
  EXPECT_EQ(exact.edge_margin({}, {0, 0, 4, 1}, 0.9).clearance, INFINITY);
  EXPECT_NEAR(exact.edge_margin({}, {0, 0, 4, 1}, 1.1).clearance, 1, 1e-12);
}

/// A fresh technique, through a roll of its own.
std::unique_ptr<Technique> exact_rays() {
  Registry roll;
  gnomon_technique_exact_rays(roll);
  return roll.technique("exact_rays").make();
}

std::vector<float> resolve(const Scene& scene, const Light& light, const GBuffer& gbuffer, Counts* counts = nullptr) {
  const auto technique = exact_rays();
  VisibilityMask mask(gbuffer.width, gbuffer.height);
  technique->setup();
  technique->build(scene);
  technique->relight(light);
  technique->resolve(gbuffer, mask);
  if (counts) *counts = technique->counts();
  return {mask.read().begin(), mask.read().end()};
}

// Floor, a square of half side 1 one meter above it, a light at (0, 2, 0): the shadow is the square of half side 2.
TEST(ExactRays, decides_the_pixels_that_face_the_light_and_lights_the_rest) {
  Scene scene;
  scene.meshes = {square(10, 0), square(1, 1), square(10, 0)};
  scene.meshes[2].receives = false;
  const glm::vec3 up(0, 1, 0);
  Picture picture(7, 1);
  picture.set(0, {1.9f, 0, 0.5f}, up, 0, 1);
  picture.set(1, {2.1f, 0, 0.5f}, up, 0, 1);
  picture.set(2, {0, 0, 0}, {0, -1, 0}, 0, 0);  // turned away
  picture.set(3, {0.1f, 0, 0.2f}, up, 2, 0);    // does not receive
  picture.set(4, {0.5f, 1, 0.25f}, up, 1, 1);   // on the caster itself
  picture.set(5, {2, 0, 0.5f}, up, 0, 1);       // its segment goes through the edge x = 1, z = 0.25
  const Light light = point_light({0, 2, 0});
  Counts counts;
  EXPECT_EQ(resolve(scene, light, picture.gbuffer, &counts), (std::vector<float>{0, 1, 1, 1, 1, 0, 1}));
  const auto value = [&](std::string_view name) {
    return std::find_if(counts.begin(), counts.end(), [&](const Count& c) { return c.name == name; })->value;
  };
  EXPECT_EQ(value("rays"), 4);
  EXPECT_EQ(value("degenerate_rays"), 1);
  EXPECT_GT(value("bytes"), 6 * 9 * sizeof(float));
  // Straight down the shadow is the square itself.
  EXPECT_EQ(resolve(scene, sun({0, -3, 0}), picture.gbuffer), (std::vector<float>{1, 1, 1, 1, 1, 1, 1}));
  picture.set(0, {0.9f, 0, 0.5f}, up, 0, 1);
  EXPECT_EQ(resolve(scene, sun({0, -3, 0}), picture.gbuffer)[0], 0);
}

TEST(ExactRays, area_lights_are_refused_with_a_reason) {
  const Light area{.name = "area", .kind = SphereLight{}};
  const Support support = exact_rays()->supports({}, area, {});
  EXPECT_FALSE(support);
  EXPECT_FALSE(support.why().empty());
  EXPECT_TRUE(exact_rays()->supports({}, point_light({0, 1, 0}), {}));
}

}  // namespace gnomon::exact_rays_test
