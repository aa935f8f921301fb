// Crow's count: the seed's rule on scenes that realize it, the crossing predicates on paper and against other formulations, and
// the technique against the exact oracle on scenes that are hard on counting.
#include <gnomon/kit/exact_scene.h>
#include <gnomon/kit/layers.h>
#include <gnomon/kit/random.h>
#include <gnomon/kit/shapes.h>
#include <gnomon/registry.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "hand_made.h"
#include "hard_scenes.h"
#include "small_world.h"
#include "techniques/crow_counting/polygon.h"

extern "C" void gnomon_technique_crow_counting(gnomon::Registry& registry);

namespace gnomon {
namespace {

using namespace hand_made;
using namespace crow_counting;
using namespace hard_scenes;
using small_world::value;

small_world::Run run(const Scene& scene, const Light& light, const GBuffer& gbuffer) {
  return small_world::run(gnomon_technique_crow_counting, "", scene, light, gbuffer);
}

// The rule: in shadow iff eye + entered - left > 0. The lecture prints ">= 0", by which the first case, and every point that no
// volume holds, would be dark. A square of half side 1 at height 1 under a sun straight down has the volume |x|, |z| < 1, y <
// 1; the floor's own volume begins at the floor.
TEST(CrowCounting, the_rule_counts_the_eye_and_needs_more_than_zero) {
  Scene scene;
  scene.meshes = {square(10, 0), square(1, 1)};
  struct Case {
    const char* name;
    glm::vec3 eye, point;
    int eye_volumes, entered, left;
    bool dark, dark_as_printed;
  };
  const Case cases[] = {
      {"count_rule", {3, 2, 0.1f}, {2.5f, 0, 0.2f}, 0, 0, 0, false, true},
      {"count_rule_eye_inside", {0.5f, 0.5f, 0.1f}, {-0.3f, 0, 0.2f}, 1, 0, 0, true, true},
      {"count_rule_left_volume", {0.5f, 0.5f, 0.1f}, {2.2f, 0, 0.3f}, 1, 0, 1, false, true},
      {"entered by the side", {3, 0.5f, 0.1f}, {0.4f, 0, 0.2f}, 0, 1, 0, true, true},
      {"entered by the cap", {0.3f, 3, 0.1f}, {0.4f, 0, 0.2f}, 0, 1, 0, true, true},
      {"entered and left", {3, 0.5f, 0.1f}, {-4, 0, 0.2f}, 0, 1, 1, false, true},
  };
  for (const Case& c : cases) {
    SCOPED_TRACE(c.name);
    EXPECT_EQ(c.eye_volumes + c.entered - c.left > 0, c.dark);
    EXPECT_EQ(c.eye_volumes + c.entered - c.left >= 0, c.dark_as_printed);
    Picture picture(1, 1);
    picture.gbuffer.view.eye = c.eye;
    picture.gbuffer.view.target = c.point;
    picture.set(0, c.point, {0, 1, 0}, 0, c.point.x < c.point.z ? 0 : 1);
    const auto done = run(scene, sun({0, -1, 0}), picture.gbuffer);
    EXPECT_EQ(done.mask[0] == 0, c.dark);
    const Counts counts = done.technique->counts();
    EXPECT_EQ(value(counts, "volumes_at_eye"), c.eye_volumes);
    EXPECT_EQ(value(counts, "crossings"), c.entered + c.left);
    EXPECT_EQ(value(counts, "deepest"), c.eye_volumes + c.entered);
    EXPECT_EQ(value(counts, "restarts"), 0);
    const auto why = done.technique->explain(0);
    ASSERT_TRUE(why);
    EXPECT_TRUE(why->covered);
    EXPECT_EQ(why->element.has_value(), c.entered > 0);
    // Triangles 2 and 3 are the square; silhouette edges follow on 4 triangles.
    if (c.entered > 0) {
      EXPECT_EQ(*why->element < 4, c.eye.y == 3.0f);
      EXPECT_GE(*why->element, 2u);
    }
  }
}

// The edge from (0, 1, -1) to (0, 1, 1) under a sun straight down has the side quad x = 0, y <= 1, |z| <= 1; under a light at
// (0, 3, 0) it widens to |z| <= (3 - y) / 2. As high, low, low at infinity the quad's normal is (0, 0, -2) x (0, -1, 0) = (-2,
// 0, 0), so that a volume of positive count lies at x > 0.
TEST(CrowCrossing, a_side_quad_on_paper) {
  const glm::vec3 low(0, 1, -1), high(0, 1, 1);
  const glm::dvec4 sun_up(0, 1, 0, 0), lamp(0, 3, 0, 1);
  const auto meet = [&](const glm::vec3& from, const glm::vec3& to, const glm::dvec4& light) {
    const Meeting meeting = meet_side(from, to, low, high, light);
    EXPECT_EQ(meet_side(from, to, high, low, light), meeting);
    return meeting;
  };
  for (const glm::dvec4& light : {sun_up, lamp}) {
    EXPECT_EQ(meet({-1, 0, 0}, {1, 0, 0.1f}, light), Meeting::crosses);
    EXPECT_EQ(meet({1, 0, 0}, {-1, 0, 0.1f}, light), Meeting::crosses);
    EXPECT_EQ(meet({-1, -99, 0}, {1, -99, 0.1f}, light), Meeting::crosses);
    EXPECT_EQ(meet({-1, 2, 0}, {1, 2, 0.1f}, light), Meeting::none);   // before the edge
    EXPECT_EQ(meet({-1, 5, 0}, {1, 5, 0.1f}, light), Meeting::none);   // behind the lamp
    EXPECT_EQ(meet({-1, 0, 0}, {-2, 0, 0.1f}, light), Meeting::none);  // away from the plane
    EXPECT_EQ(meet({-1, 0, 9}, {1, 0, 9}, light), Meeting::none);      // beside it
    EXPECT_EQ(meet({-1, 0, -9}, {1, 0, -9}, light), Meeting::none);
    EXPECT_EQ(meet({-1, 1, 0}, {1, 1, 0.1f}, light), Meeting::none);  // through the edge: as if before it
    EXPECT_EQ(meet({-1, 0, 0}, {0, 0, 0.1f}, light), Meeting::touches);
    EXPECT_EQ(meet({-1, 0, 0}, {0, 1, 0.1f}, light), Meeting::none);  // on the edge: it does not shade itself
    EXPECT_EQ(meet({-1, 0, 0}, {0, 2, 0.1f}, light), Meeting::none);
    EXPECT_EQ(meet({-1, 0, 0}, {0, 0, 9}, light), Meeting::none);
    EXPECT_EQ(meet({0, 0, 9}, {1, 0, 0}, light), Meeting::none);     // from its plane, beside it
    EXPECT_EQ(meet({0, 0, 9}, {0, 0, 0}, light), Meeting::unclear);  // along its plane
  }
  EXPECT_EQ(meet({-1, 0, 1.25f}, {1, 0, 1.25f}, sun_up), Meeting::none);
  EXPECT_EQ(meet({-1, 0, 1.25f}, {1, 0, 1.25f}, lamp), Meeting::crosses);
  EXPECT_EQ(meet({-1, 0, 1}, {1, 0, 1}, sun_up), Meeting::unclear);  // through the end's ray
  EXPECT_EQ(meet({-1, 0, 1.5f}, {1, 0, 1.5f}, lamp), Meeting::unclear);
  EXPECT_EQ(meet({-1, 0, 0}, {0, 0, 1}, sun_up), Meeting::touches);
  EXPECT_EQ(meet({-1, 0, 0}, {0, 0, 1.5f}, lamp), Meeting::touches);

  const Frame left({}, {-1, 0, 0}), right({}, {1, 0, 0}), on_plane({}, {0, 0, 9});
  EXPECT_EQ(side_polygon(left, low, high, sun_up, 2).step, 2);
  EXPECT_EQ(side_polygon(right, low, high, sun_up, 2).step, -2);
  EXPECT_EQ(side_polygon(left, low, high, lamp, -1).step, -1);
  EXPECT_EQ(side_polygon(on_plane, low, high, lamp, -1).step, 0);
  // Rounding is allowed for by the length of the seen point alone: no normal may be longer than 1.
  for (const float scale : {1e-3f, 1.0f, 1e3f})
    for (const glm::dvec4& light : {sun_up, glm::dvec4(0, 3 * scale, 0, 1)})
      for (const glm::dvec3& n : side_polygon(Frame({}, {-scale, 0, 0}), scale * low, scale * high, light, 1).inside) {
        EXPECT_LE(glm::length(n), 1 + 1e-9);
        EXPECT_GT(glm::length(n), 0.1);
      }
}

// A triangle in the plane y = 1, counter-clockwise seen from above. Entered from the light's side, whichever way it is wound.
TEST(CrowCrossing, a_light_cap_on_paper) {
  const Triangle cap{{{0, 1, 0}, {0, 1, 4}, {4, 1, 0}}};
  const Triangle turned{{cap.points[0], cap.points[2], cap.points[1]}};
  for (const glm::dvec4& light : {glm::dvec4(0, 1, 0, 0), glm::dvec4(1, 9, 1, 1)}) {
    const auto meet = [&](const glm::vec3& from, const glm::vec3& to) {
      const Meeting meeting = meet_cap(from, to, cap, light, 1);
      EXPECT_EQ(meet_cap(from, to, turned, light, -1), meeting);
      return meeting;
    };
    EXPECT_EQ(meet({1, 2, 1.5f}, {1, 0, 1.25f}), Meeting::crosses);
    EXPECT_EQ(meet({1, 0, 1.5f}, {1, 2, 1.25f}), Meeting::crosses);
    EXPECT_EQ(meet({5, 2, 1.5f}, {5, 0, 1.25f}), Meeting::none);
    EXPECT_EQ(meet({1, 2, 1.5f}, {1, 1, 1.25f}), Meeting::none);     // the point on it is on the light's side of it
    EXPECT_EQ(meet({1, 0, 1.5f}, {1, 1, 1.25f}), Meeting::crosses);  // and is reached through it from below
    EXPECT_EQ(meet({9, 1, 1.5f}, {1, 0, 1.25f}), Meeting::none);     // from its plane, beside it
  }
  const Frame above({}, {1, 2, 1}), below({}, {1, 0, 1});
  EXPECT_EQ(cap_polygon(above, cap, 1).step, 1);
  EXPECT_EQ(cap_polygon(above, turned, -1).step, 1);
  EXPECT_EQ(cap_polygon(below, cap, 1).step, -1);
  EXPECT_EQ(cap_polygon(Frame({}, {9, 1, 9}), cap, 1).step, 0);
}

// Against other formulations. Where the way meets the plane of light, a and b, a point lies on the quad when its own way to
// the light comes to the line a b between the two (solved in double by distances from the line; ways within 1e-6 of a border
// are left out). A cap is crossed as the oracle's segment from the point to the eye crosses its triangle. And the
// planes in double never contradict.
TEST(CrowCrossing, random_ways_against_other_formulations) {
  Random random(3);
  const auto point = [&] {
    glm::vec3 p;
    for (int k = 0; k < 3; ++k) p[k] = (static_cast<float>(random.below(1 << 22)) - 0x1p21f) * 0x1p-20f;
    return p;
  };
  int crossed[2] = {0, 0}, missed[2] = {0, 0};
  for (int i = 0; i < 200'000; ++i) {
    const glm::vec3 a = point(), b = point(), c = point(), from = point(), to = point();
    const glm::dvec4 light(point(), random.below(2));
    const glm::dvec3 l(light), da(a), e(from), way = glm::dvec3(to) - e;
    const glm::dvec3 u = to_light(light, da), v = glm::dvec3(b) - da, normal = glm::cross(v, u);
    const double t = glm::dot(normal, da - e) / glm::dot(normal, way);
    const glm::dvec3 x = e + t * way;
    // x = a + j v - k u: k is how far behind the line of the edge; the way from x comes to that line beside a by the share i.
    const double vv = glm::dot(v, v), uv = glm::dot(u, v), uu = glm::dot(u, u), det = vv * uu - uv * uv;
    const glm::dvec3 r = x - da;
    const double j = (glm::dot(r, v) * uu - glm::dot(r, u) * uv) / det, k = -(glm::dot(r, u) * vv - glm::dot(r, v) * uv) / det;
    // Point light: x = a + j v - k (l - a); toward l, the share of u grows from -k to 1 and that of v falls from j to 0.
    const double share = light.w != 0 ? j / (1 + k) : j;
    const double clear = std::min({std::abs(t), std::abs(1 - t), std::abs(k), std::abs(share), std::abs(1 - share),
                                   light.w != 0 ? std::abs(1 + k) : 1.0});
    if (clear > 1e-6) {
      const bool expected = t > 0 && t < 1 && k > 0 && share > 0 && share < 1;
      const Meeting meeting = meet_side(from, to, a, b, light);
      ASSERT_EQ(meeting, expected ? Meeting::crosses : Meeting::none) << "way " << i;
      ++(expected ? crossed : missed)[0];
    }
    const Triangle triangle{{a, b, c}};
    const int facing = orient3d_sign(a, b, c, light);
    const Meeting meeting = meet_cap(from, to, triangle, light, facing);
    ASSERT_EQ(meeting == Meeting::crosses, crosses({to, glm::dvec4(from, 1)}, triangle) == Crossing::crosses) << "way " << i;
    ++(meeting == Meeting::crosses ? crossed : missed)[1];

    View view;
    view.eye = from, view.target = point();
    const Frame frame(view, from);
    const auto judged = [&](const Polygon& polygon) {
      const glm::dvec3 p = frame.seen(to);
      const double error = relative_error * glm::length(p), beyond = glm::dot(polygon.plane, p) - polygon.distance;
      double inside = INFINITY;
      for (const glm::dvec3& n : polygon.inside) inside = std::min(inside, glm::dot(n, p));
      EXPECT_GT(std::min(std::abs(beyond), std::abs(inside)), polygon.slack + error);  // no sign was in doubt
      return beyond > 0 && inside > 0;
    };
    ASSERT_EQ(judged(side_polygon(frame, a, b, light, 1)), meet_side(from, to, a, b, light) == Meeting::crosses);
    ASSERT_EQ(judged(cap_polygon(frame, triangle, facing)), meeting == Meeting::crosses);
  }
  for (int kind = 0; kind < 2; ++kind) {
    EXPECT_GT(crossed[kind], 5000);
    EXPECT_GT(missed[kind], 5000);
  }
}

struct Differences {
  int wrong = 0, dark = 0, lit = 0, degenerate = 0;
  double restarts = 0, eye_inside = 0, touching = 0;
};

/// Counts pixels that the oracle decides otherwise; where it is degenerate anything goes.
void compare(const Scene& scene, const Light& light, const GBuffer& gbuffer, Differences& d) {
  const auto done = run(scene, light, gbuffer);
  const ExactScene exact(scene);
  for (std::size_t i = 0; i < gbuffer.size(); ++i) {
    if (!faces_light(scene, gbuffer, light, i)) {
      ASSERT_EQ(done.mask[i], 1);
      continue;
    }
    ExactTally tally;
    const ExactAnswer answer = exact.occluded(receiver_at(scene, gbuffer, i), homogeneous(light), tally);
    if (answer.degenerate) {
      ++d.degenerate;
      continue;
    }
    ++(answer.blocked ? d.dark : d.lit);
    if ((done.mask[i] == 0) != answer.blocked && d.wrong++ == 0) {
      const glm::vec3 p = gbuffer.position(i);
      ADD_FAILURE() << "pixel " << i << " of mesh " << gbuffer.mesh[i] << ", triangle " << gbuffer.triangle[i] << " at " << p.x
                    << ", " << p.y << ", " << p.z << " should be " << (answer.blocked ? "dark" : "lit");
    }
  }
  const Counts counts = done.technique->counts();
  d.restarts += value(counts, "restarts");
  d.touching += value(counts, "degenerate_rays");
  d.eye_inside += value(counts, "volumes_at_eye") > 0;
}

// Eyes on the same grid stand on side planes, on triangles, inside bodies and volumes.
TEST(CrowCounting, decides_as_the_oracle_does_on_soups) {
  Random random(5);
  Differences d;
  for (int round = 0; round < 150; ++round) {
    Scene scene;
    scene.meshes = {grid_soup(random, 1 + round % 40), grid_soup(random, 5)};
    scene.meshes[1].casts = random.below(2);
    const Light light = hard_light(random);
    Picture picture(40, 20);
    picture.gbuffer.view.eye = on_grid(random, 4, 32);
    scatter(scene, light, random, picture);
    SCOPED_TRACE(round);
    compare(scene, light, picture.gbuffer, d);
  }
  EXPECT_EQ(d.wrong, 0);
  EXPECT_GT(d.dark, 10'000);
  EXPECT_GT(d.lit, 10'000);
  EXPECT_GT(d.restarts, 30);
  EXPECT_GT(d.eye_inside, 10);
  RecordProperty("pixels", fmt::format("{} dark, {} lit, {} degenerate, {} restarts, {} touching", d.dark, d.lit, d.degenerate,
                                       d.restarts, d.touching));
}

TEST(CrowCounting, decides_as_the_oracle_does_on_boxes) {
  Random random(6);
  Differences d;
  for (int round = 0; round < 150; ++round) {
    Scene scene;
    scene.meshes = {boxes(random, 1 + round % 12, round % 2), boxes(random, 2, true), square(6, -2)};
    const Light light = hard_light(random);
    Picture picture(40, 20);
    picture.gbuffer.view.eye = on_grid(random, 4, 32);
    scatter(scene, light, random, picture);
    SCOPED_TRACE(round);
    compare(scene, light, picture.gbuffer, d);
  }
  EXPECT_EQ(d.wrong, 0);
  EXPECT_GT(d.dark, 10'000);
  EXPECT_GT(d.lit, 10'000);
  EXPECT_GT(d.restarts, 30);
  EXPECT_GT(d.eye_inside, 10);
  RecordProperty("pixels", fmt::format("{} dark, {} lit, {} degenerate, {} restarts, {} touching", d.dark, d.lit, d.degenerate,
                                       d.restarts, d.touching));
}

// As pictures are: points where the eye's rays meet the scene. The picture is larger than a few tiles, and not a multiple.
TEST(CrowCounting, decides_as_the_oracle_does_in_pictures) {
  std::mt19937 engine(7);
  Random random(7);
  Differences d;
  for (int round = 0; round < 12; ++round) {
    SCOPED_TRACE(round);
    const auto [scene, gbuffer, lights] = hard_scenes::viewed(random, engine);
    for (const Light& light : lights) compare(scene, light, gbuffer, d);
  }
  EXPECT_EQ(d.wrong, 0);
  EXPECT_GT(d.dark, 10'000);
  EXPECT_GT(d.lit, 10'000);
  RecordProperty("pixels", fmt::format("{} dark, {} lit, {} degenerate, {} restarts, {} touching", d.dark, d.lit, d.degenerate,
                                       d.restarts, d.touching));
}

// A plane that no float32 point lies on but by chance: half of its points are below it, in the volume of their own triangle, or
// of a neighbor where the way to the light leaves by its plane across an edge. All are lit.
TEST(CrowCounting, a_rounded_point_is_not_shaded_by_the_plane_it_lies_on) {
  // A fan of a plane through lattice points: exactly coplanar, since the corners are sums of u and v.
  const glm::vec3 u(3, 1, 0), v(0, 2, 5);
  std::vector<glm::vec3> positions;
  std::vector<glm::uvec3> triangles;
  for (std::uint32_t j = 0; j <= 8; ++j)
    for (std::uint32_t i = 0; i <= 8; ++i) positions.push_back(static_cast<float>(i) / 8 * u + static_cast<float>(j) / 8 * v);
  for (std::uint32_t j = 0; j < 8; ++j)
    for (std::uint32_t i = 0; i < 8; ++i) {
      const std::uint32_t p = 9 * j + i;
      triangles.push_back({p, p + 9, p + 10});
      triangles.push_back({p, p + 10, p + 1});
    }
  triangles.insert(triangles.end(), triangles.begin(), triangles.begin() + 40);  // some of them doubled
  Scene scene;
  scene.meshes = {mesh_of(positions, triangles)};
  const glm::dvec3 n = glm::normalize(glm::cross(glm::dvec3(v), glm::dvec3(u)));
  ASSERT_GT(n.y, 0);
  Random random(8);
  Picture picture(100, 50);
  picture.gbuffer.view.eye = {1, 9, 2};
  picture.gbuffer.view.target = {1.5f, 1.5f, 2.5f};
  int below = 0;
  for (std::size_t i = 0; i < picture.gbuffer.size(); ++i) {
    const std::uint32_t t = random.below(static_cast<std::uint32_t>(triangles.size()));
    const glm::dvec3 a(positions[triangles[t].x]), b(positions[triangles[t].y]), c(positions[triangles[t].z]);
    // Half of them near an edge: within 1e-7.
    const double share = random.below(2) ? random.uniform(0, 1) : random.uniform(0, 1e-7), along = random.uniform(0, 1 - share);
    const glm::vec3 p(a + share * (b - a) + along * (c - a));
    picture.set(i, p, n, 0, t);
    below += glm::dot(n, glm::dvec3(p) - glm::dvec3(positions[0])) < 0;
  }
  EXPECT_GT(below, 1500);
  for (const Light& light : {point_light({0.3f, 7, 2}), sun({0.3f, -1, 0.4f}), sun({0.9f, -0.1f, 0.2f}), sun({0, -1, 0})}) {
    const auto done = run(scene, light, picture.gbuffer);
    EXPECT_EQ(std::count(done.mask.begin(), done.mask.end(), 1.0f), 5000);
  }
  // Alone in its tile, with nothing else to bring the neighbor in.
  for (std::size_t i = 0; i < 1000; ++i) {
    Picture one(1, 1);
    one.gbuffer.view = picture.gbuffer.view;
    one.set(0, picture.gbuffer.position(i), picture.gbuffer.normal(i), 0, picture.gbuffer.triangle[i]);
    EXPECT_EQ(run(scene, sun({0.9f, -0.1f, 0.2f}), one.gbuffer).mask[0], 1) << "point " << i;
  }
}

// The same from the dark side, looking straight at the triangle: no way from there crosses the plane to a point below it, and
// yet the volumes of the triangle and of its copies hold the point.
TEST(CrowCounting, a_rounded_point_seen_from_behind_is_not_shaded_by_copies) {
  Scene scene;
  scene.meshes = {mesh_of({{0, 0, 0}, {3, 1, 0}, {0, 2, 5}}, {{0, 2, 1}, {0, 2, 1}, {0, 1, 2}})};
  const glm::vec3* p = scene.meshes[0].positions.data();
  const glm::vec3 center = (p[0] + p[1] + p[2]) / 3.0f, upward = glm::cross(p[2], p[1]);
  Random random(9);
  int below = 0;
  for (int i = 0; i < 200; ++i) {
    const double u = random.uniform(0.3, 0.35), v = random.uniform(0.3, 0.35);
    Picture picture(1, 1);
    picture.gbuffer.view.eye = center - 0.5f * upward;
    picture.gbuffer.view.target = center;
    picture.set(0, u * glm::dvec3(p[1]) + v * glm::dvec3(p[2]), {0, 1, 0}, 0, 0);
    if (orient3d_sign(p[0], p[2], p[1], picture.gbuffer.position(0)) >= 0) continue;
    ++below;
    const auto done = run(scene, sun({0.3f, -1, 0.4f}), picture.gbuffer);
    EXPECT_EQ(done.mask[0], 1);
    EXPECT_EQ(value(done.technique->counts(), "deepest"), 3);
  }
  EXPECT_GT(below, 50);
}

// Points of a ball's triangles, on their edges but for rounding. Some are behind their own triangle and outside of the ball, so
// that a triangle turned away from the light, which has no volume, blocks theirs.
TEST(CrowCounting, a_point_that_rounding_puts_out_of_a_body_beside_its_edge_is_dark) {
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
    Differences d;
    compare(scene, light, picture.gbuffer, d);
    EXPECT_EQ(d.wrong, 0);
    EXPECT_GT(d.lit, 1000);
    out += d.dark;
  }
  EXPECT_GT(out, 50);
}

// The light is 10^-6 rad above a plane of many triangles. From a point 10^-7 m or so below it, the way to the light comes up
// through another triangle than the way from the eye went down through. All are lit.
TEST(CrowCounting, a_rounded_point_under_a_grazing_light_is_not_shaded_by_its_plane) {
  const glm::vec3 u(3, 1, 0), v(0, 2, 5);
  std::vector<glm::vec3> positions;
  std::vector<glm::uvec3> triangles;
  for (std::uint32_t i = 0; i <= 64; ++i)
    for (std::uint32_t j = 0; j <= 1; ++j) positions.push_back(static_cast<float>(i) / 64 * u + static_cast<float>(j) * v);
  for (std::uint32_t p = 0; p < 128; p += 2) {
    triangles.push_back({p, p + 1, p + 3});
    triangles.push_back({p, p + 3, p + 2});
  }
  Scene scene;
  scene.meshes = {mesh_of(positions, triangles)};
  const glm::dvec3 n = glm::normalize(glm::cross(glm::dvec3(v), glm::dvec3(u)));
  const Light light = point_light(glm::dvec3(u) * 2.0 + glm::dvec3(v) * 0.5 + 1e-5 * n);
  Random random(11);
  int below = 0;
  for (int i = 0; i < 400; ++i) {
    const std::uint32_t t = random.below(64);
    const glm::dvec3 a(positions[triangles[t].x]), b(positions[triangles[t].y]), c(positions[triangles[t].z]);
    Picture picture(1, 1);
    picture.gbuffer.view.eye = {1, 9, 2};
    picture.gbuffer.view.target = a;
    picture.set(0, a + random.uniform(0.4, 0.5) * (b - a) + random.uniform(0, 0.5) * (c - a), n, 0, t);
    below += glm::dot(n, glm::dvec3(picture.gbuffer.position(0))) < 0;
    EXPECT_EQ(run(scene, light, picture.gbuffer).mask[0], 1) << i;
  }
  EXPECT_GT(below, 100);
}

// Points on the true sphere lie outside its triangles, and behind the planes of those that turn away; a body that is convex
// shades none of its points that face the light. Its shadow on the floor, and a plate's shadow on it, remain.
TEST(CrowCounting, an_exact_shape_is_not_shaded_by_its_own_triangles) {
  Scene scene;
  scene.meshes = {tessellate(Sphere{{0, 0, 0}, 1}, 12, "sphere"), square(4, -1.5f), square(0.4f, 3)};
  Picture picture(100, 102, Truth::shape);
  Random random(4);
  const Light light = point_light({0.3f, 6, -0.2f});
  for (std::size_t i = 0; i < 10'000; ++i) {
    const glm::vec3 n(glm::normalize(random.uniform(glm::dvec3(-1), glm::dvec3(1))));
    picture.set(i, n, n, 0, 0);
  }
  for (std::size_t i = 10'000; i < 10'200; ++i) {
    const float x = static_cast<float>(random.uniform(-3, 3)), z = static_cast<float>(random.uniform(-3, 3));
    picture.set(i, {x, -1.5f, z}, {0, 1, 0}, 1, z > x ? 0 : 1);
  }
  for (const glm::vec3& eye : {glm::vec3(4, 3, 1), glm::vec3(0.1f, -0.2f, 0), glm::vec3(0.3f, -1.2f, 0.2f)}) {
    picture.gbuffer.view.eye = eye;
    Differences d;
    compare(scene, light, picture.gbuffer, d);
    EXPECT_EQ(d.wrong, 0);
    EXPECT_GT(d.dark, 100);
    EXPECT_GT(d.lit, 2000);
    scene.meshes[2].casts = false;
    const auto done = run(scene, light, picture.gbuffer);
    EXPECT_EQ(std::count(done.mask.begin(), done.mask.begin() + 10'000, 1.0f), 10'000);
    EXPECT_GT(std::count(done.mask.begin() + 10'000, done.mask.end(), 0.0f), 10);
    scene.meshes[2].casts = true;
  }
}

TEST(CrowCounting, area_lights_are_refused_with_a_reason) {
  Registry roll;
  gnomon_technique_crow_counting(roll);
  const auto technique = roll.technique("crow_counting").make();
  const Support support = technique->supports({}, {.name = "area", .kind = SphereLight{}}, {});
  EXPECT_FALSE(support);
  EXPECT_FALSE(support.why().empty());
  EXPECT_TRUE(technique->supports({}, {.name = "spot", .kind = SpotLight{}}, {}));
}

// The layers show what the counts say: most polygons on a way, and the count at the point.
// A square of half side 1 at height 1 under the sun straight down: from each corner, ways along x = z or x = -z run through the
// ray that two side quads share, into the volume or past it. No sign in double decides them.
TEST(CrowCounting, ways_through_the_corner_ray_of_a_volume_are_decided_exactly) {
  Scene scene;
  scene.meshes = {mesh_of({{-30, 0, -9}, {0, 0, 30}, {30, 0, -9}}, {{0, 1, 2}}), square(1, 1)};
  for (const float x : {-1.0f, 1.0f})
    for (const float z : {-1.0f, 1.0f}) {
      const auto answer = [&](const glm::vec3& eye, const glm::vec3& point) {
        Picture picture(1, 1);
        picture.gbuffer.view.eye = eye;
        picture.gbuffer.view.target = point;
        picture.set(0, point, {0, 1, 0}, 0, 0);
        const auto done = run(scene, sun({0, -1, 0}), picture.gbuffer);
        EXPECT_GT(value(done.technique->counts(), "exact_tests"), 0);
        return done.mask[0];
      };
      EXPECT_EQ(answer({3 * x, 0.5f, 3 * z}, {0, 0, 0}), 0) << x << ' ' << z;
      EXPECT_EQ(answer({2 * x, 0.5f, 0}, {0, 0, 2 * z}), 1) << x << ' ' << z;
    }
}

TEST(CrowCounting, layers_show_the_lists_and_the_depth) {
  Scene scene;
  scene.meshes = {square(10, 0), square(1, 1), square(1, 2)};
  Picture picture(3, 1);
  picture.gbuffer.view.eye = {3, 0.5f, 0.1f};
  picture.set(0, {0.4f, 0, 0.2f}, {0, 1, 0}, 0, 1);  // two volumes entered
  picture.set(1, {-4, 0, 0.2f}, {0, 1, 0}, 0, 0);    // two entered, two left
  picture.set(2, {2.5f, 0, 0.2f}, {0, 1, 0}, 0, 1);  // nothing
  const auto done = run(scene, sun({0, -1, 0}), picture.gbuffer);
  EXPECT_EQ(done.mask, (std::vector<float>{0, 1, 1}));
  EXPECT_EQ(value(done.technique->counts(), "longest_list"), 4);
  EXPECT_EQ(value(done.technique->counts(), "deepest"), 2);
  EXPECT_EQ(value(done.technique->counts(), "crossings_per_ray"), 2);
  const auto color = [](const std::vector<float>& picture, int pixel) {
    return glm::vec3(picture[3 * pixel], picture[3 * pixel + 1], picture[3 * pixel + 2]);
  };
  const auto of_value = [](int value) { return glm::vec3(heat_legend().at(value - 1).color); };
  const std::vector<float> crossings = done.technique->draw_debug("crossings"), depth = done.technique->draw_debug("depth");
  EXPECT_EQ(color(crossings, 0), of_value(2));
  EXPECT_EQ(color(crossings, 1), of_value(4));
  EXPECT_EQ(color(depth, 0), of_value(2));
  // Gray where there is none.
  for (const glm::vec3& none : {color(crossings, 2), color(depth, 1), color(depth, 2)}) EXPECT_EQ(none, glm::vec3(none.x));
  EXPECT_THROW(done.technique->draw_debug("volumes"), Error);
}

}  // namespace
}  // namespace gnomon
