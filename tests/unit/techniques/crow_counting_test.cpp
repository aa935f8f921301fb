// Crow's count: the seed's rule on scenes that realize it, points that rounding moves off their plane, and what layers show.
#include <gnomon/kit/geometry/exact.h>
#include <gnomon/kit/geometry/shapes.h>
#include <gnomon/kit/pictures/layers.h>
#include <gnomon/kit/random.h>
#include <gnomon/registry.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "hand_made.h"
#include "small_world.h"

extern "C" void gnomon_technique_crow_counting(gnomon::Registry& registry);

namespace gnomon::crow_counting_test {

using namespace hand_made;
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

TEST(CrowCounting, area_lights_are_refused_with_a_reason) {
  Registry roll;
  gnomon_technique_crow_counting(roll);
  const auto technique = roll.technique("crow_counting").make();
  const Support support = technique->supports({}, {.name = "area", .kind = SphereLight{}}, {});
  EXPECT_FALSE(support);
  EXPECT_FALSE(support.why().empty());
  EXPECT_TRUE(technique->supports({}, {.name = "spot", .kind = SpotLight{}}, {}));
}

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

// The layers show what the counts say: most polygons on a way, and the count at the point.
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

}  // namespace gnomon::crow_counting_test
