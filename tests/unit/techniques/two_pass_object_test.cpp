// Two-pass object precision: pieces on paper, and masks and surface detail against the exact oracle on scenes that are hard on
// it.
#include <gnomon/error.h>
#include <gnomon/kit/exact_scene.h>
#include <gnomon/kit/shapes.h>
#include <gnomon/registry.h>
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "hard_scenes.h"
#include "techniques/two_pass_object/detail.h"

extern "C" void gnomon_technique_two_pass_object(gnomon::Registry& registry);

namespace gnomon {
namespace {

using namespace hand_made;
using small_world::value;

small_world::Run run(const std::string& settings, const Scene& scene, const Light& light, const GBuffer& gbuffer) {
  return small_world::run(gnomon_technique_two_pass_object, settings, scene, light, gbuffer);
}

SurfaceDetail detail_of(const std::string& settings, const Scene& scene, const Light& light) {
  Picture nothing(1, 1);
  return run(settings, scene, light, nothing.gbuffer).technique->surface_detail().value();
}

Triangle triangle_of(const Scene& scene, std::uint32_t mesh, std::uint32_t triangle) {
  const Mesh& m = scene.meshes[mesh];
  const glm::uvec3& t = m.triangles[triangle];
  return {{m.positions[t.x], m.positions[t.y], m.positions[t.z]}};
}

/// Twice the area vector of a polygon.
glm::dvec3 area_vector(std::span<const glm::dvec3> corners) {
  glm::dvec3 sum(0);
  for (std::size_t k = 1; k + 1 < corners.size(); ++k) sum += glm::cross(corners[k] - corners[0], corners[k + 1] - corners[0]);
  return sum;
}

glm::dvec3 normal_of(const Triangle& t) {
  const glm::dvec3 a(t.points[0]), b(t.points[1]), c(t.points[2]);
  return glm::cross(b - a, c - a);
}

std::span<const glm::dvec3> corners_of(const SurfaceDetail& detail, const DetailPolygon& polygon) {
  return {detail.corners.data() + polygon.first, polygon.count};
}

/// Area of the lit or the dark polygons of a mesh.
double area(const SurfaceDetail& detail, std::uint32_t mesh, bool is_lit) {
  double sum = 0;
  for (const DetailPolygon& p : detail.polygons)
    if (p.mesh == mesh && p.is_lit == is_lit) sum += glm::length(area_vector(corners_of(detail, p))) / 2;
  return sum;
}

/// A floor of one triangle with the area 72, around the origin.
Mesh floor_at(float y) { return mesh_of({{-4, y, -4}, {-4, y, 8}, {8, y, -4}}, {{0, 1, 2}}); }

// A right triangle of legs 2 at the height 1 has a shadow of its own size under the sun, area 2, and one of twice the size,
// area 8, from a lamp at the height 2. The caster itself is lit, as one polygon; the floor below shades nothing.
TEST(TwoPassObject, a_shadow_on_paper) {
  Scene scene;
  scene.meshes = {mesh_of({{0, 1, 0}, {0, 1, 2}, {2, 1, 0}}, {{0, 1, 2}}), floor_at(0)};
  for (const auto& [light, shadow] : {std::pair(sun({0, -1, 0}), 2.0), std::pair(point_light({0, 2, 0}), 8.0)}) {
    const SurfaceDetail detail = detail_of("", scene, light);
    EXPECT_NEAR(area(detail, 1, false), shadow, 1e-9);
    EXPECT_NEAR(area(detail, 1, true), 72 - shadow, 1e-9);
    ASSERT_FALSE(detail.polygons.empty());
    const DetailPolygon& first = detail.polygons[0];
    EXPECT_TRUE(first.mesh == 0 && first.is_lit && first.count == 3);
    EXPECT_EQ(corners_of(detail, first)[1], glm::dvec3(0, 1, 2));
  }
}

// From between them nothing of the floor is hidden: the caster is behind the light, though inside the planes through its edges.
TEST(TwoPassObject, what_lies_behind_the_light_casts_no_shadow) {
  Scene scene;
  scene.meshes = {mesh_of({{0, 1, 0}, {0, 1, 2}, {2, 1, 0}}, {{0, 1, 2}}), floor_at(0)};
  const SurfaceDetail detail = detail_of("", scene, point_light({0.5f, 0.5f, 0.5f}));
  EXPECT_EQ(area(detail, 1, false), 0);
  EXPECT_NEAR(area(detail, 1, true), 72, 1e-9);
  EXPECT_EQ(detail.polygons.size(), 2u);
}

// The triangle (-2, -2, -1), (2, 2, -1), (2, 2, 1) lies in y = x and goes through the floor at x = 0. Seen from above it is
// -1 < z < x / 2. Its upper part shades the integral of x / 2 + 1 from 0 to 2, which is 3; its lower part, 1 from above, is
// itself in the floor's shadow, and the root of 2 larger in its own plane. From below it is the other way about.
TEST(TwoPassObject, triangles_through_each_other_on_paper) {
  Scene scene;
  scene.meshes = {mesh_of({{-2, -2, -1}, {2, 2, -1}, {2, 2, 1}}, {{0, 1, 2}}), floor_at(0)};
  for (const float way : {-1.0f, 1.0f}) {
    const SurfaceDetail detail = detail_of("", scene, sun({0, way, 0}));
    const double above = way < 0 ? 3 : 1;
    EXPECT_NEAR(area(detail, 1, false), above, 1e-9);
    EXPECT_NEAR(area(detail, 0, true), above * std::sqrt(2), 1e-9);
    EXPECT_NEAR(area(detail, 0, false), (4 - above) * std::sqrt(2), 1e-9);
  }
}

// Two triangles make a square that covers another one of half its size: what they share is no gap, and both stay whole.
TEST(TwoPassObject, a_shared_edge_leaves_no_gap) {
  Scene scene;
  scene.meshes = {square(2, 1), square(1, 0)};
  for (const Light& light : {sun({0.03f, -1, 0.07f}), point_light({0.3f, 9, 0.1f})}) {
    const SurfaceDetail detail = detail_of("", scene, light);
    ASSERT_EQ(detail.polygons.size(), 4u);
    for (const DetailPolygon& polygon : detail.polygons) {
      EXPECT_EQ(polygon.is_lit, polygon.mesh == 0);
      EXPECT_EQ(polygon.count, 3u);
    }
    EXPECT_GT(detail_of("merge=false", scene, light).polygons.size(), 4u);
  }
}

// A plate of two triangles covers every cell that holds one of the triangles beneath it: none of them is clipped, and all are
// dark.
TEST(TwoPassObject, what_lies_beyond_casters_that_cover_its_cell_is_not_clipped) {
  std::mt19937 engine(17);
  Scene scene;
  scene.meshes = {square(6, 1), small_world::random_soup(engine, 1'000, 2, -1, 0, 0.2f)};
  for (const Light& light : {sun({0, -1, 0}), point_light({0, 40, 0})}) {
    Picture nothing(1, 1);
    const auto done = run("", scene, light, nothing.gbuffer);
    const Counts counts = done.technique->counts();
    EXPECT_EQ(value(counts, "pairs_clipped"), 0);
    EXPECT_GE(value(counts, "hidden"), 1'000);
    const SurfaceDetail detail = done.technique->surface_detail().value();
    EXPECT_GE(detail.polygons.size(), 1'000u);
    for (const DetailPolygon& polygon : detail.polygons) EXPECT_EQ(polygon.is_lit, polygon.mesh == 0);
  }
}

struct Agreement {
  int wrong = 0, dark = 0, lit = 0, degenerate = 0;
  double points = 0, asked = 0;
  std::string text() const {
    return fmt::format("{} dark, {} lit, {} of the dark through edges or vertices; {} of {} points asked", dark, lit,
                       degenerate, asked, points);
  }
};

/// Counts pixels that the oracle decides otherwise, those where it is degenerate included.
void compare(const std::string& settings, const Scene& scene, const Light& light, const GBuffer& gbuffer, Agreement& sum) {
  const auto done = run(settings, scene, light, gbuffer);
  const Counts counts = done.technique->counts();
  sum.points += value(counts, "point_locations"), sum.asked += value(counts, "points_asked");
  const ExactScene exact(scene);
  for (std::size_t i = 0; i < gbuffer.size(); ++i) {
    if (!faces_light(scene, gbuffer, light, i)) {
      EXPECT_EQ(done.mask[i], 1);
      continue;
    }
    ExactTally tally;
    const ExactAnswer answer = exact.occluded(receiver_at(scene, gbuffer, i), homogeneous(light), tally);
    ++(answer.blocked ? sum.dark : sum.lit);
    sum.degenerate += answer.degenerate;
    if ((done.mask[i] == 0) == answer.blocked || sum.wrong++ > 0) continue;
    const glm::vec3 p = gbuffer.position(i);
    ADD_FAILURE() << "'" << settings << "', pixel " << i << " of mesh " << gbuffer.mesh[i] << ", triangle "
                  << gbuffer.triangle[i] << " at " << p.x << ", " << p.y << ", " << p.z << " should be "
                  << (answer.blocked ? "dark" : "lit") << (answer.degenerate ? ", degenerate" : "");
  }
}

/// Soups on a grid and off it, boxes wall to wall and through each other, cycles, stacks of coplanar triangles, a fine mesh.
Scene hard_scene(Random& random, std::mt19937& engine, int kind) {
  Scene scene;
  switch (kind % 6) {
    case 0:
      scene.meshes = {hard_scenes::grid_soup(random, 60)};
      break;
    case 1:
      scene.meshes = {hard_scenes::boxes(random, 8, true)};
      break;
    case 2:
      scene.meshes = {hard_scenes::boxes(random, 8, false), square(5, -2)};
      break;
    case 3:
      scene.meshes = {hard_scenes::cycle(1, 1), hard_scenes::cycle(2, 0.5f), square(4, 0)};
      break;
    case 4:
      scene.meshes = {small_world::random_soup(engine, 300, 2, 0.1f, 2, 0.4f), square(3, 0)};
      break;
    case 5:
      scene.meshes = {tessellate(Sphere{{0, 0, 0}, 1}, 24, "sphere"), square(4, -1.5f)};
      scene.meshes[0].shape.reset();
      break;
  }
  return scene;
}

// Nothing is left out: points on edges, on planes of others and within rounding of them are decided as the oracle decides them.
TEST(TwoPassObject, agrees_with_the_oracle_on_hard_scenes) {
  Random random(21);
  std::mt19937 engine(21);
  Agreement sum;
  for (int round = 0; round < 48; ++round) {
    SCOPED_TRACE(round);
    const Scene scene = hard_scene(random, engine, round);
    const Light light = hard_scenes::hard_light(random);
    Picture picture(60, 40);
    hard_scenes::scatter(scene, light, random, picture);
    compare(round % 3 == 0   ? ""
            : round % 3 == 1 ? "cell_triangles=2"
                             : "cell_triangles=256",
            scene, light, picture.gbuffer, sum);
  }
  EXPECT_EQ(sum.wrong, 0);
  EXPECT_GT(sum.dark, 20'000);
  EXPECT_GT(sum.lit, 20'000);
  EXPECT_LT(sum.asked, 0.2 * sum.points);  // a third of the points lie on a grid, on borders on purpose
  RecordProperty("points", sum.text());
}

// Where points lie as views put them, pieces decide nearly all.
TEST(TwoPassObject, agrees_with_the_oracle_on_pictures) {
  std::mt19937 engine(7);
  Random random(7);
  Agreement sum;
  for (int round = 0; round < 6; ++round) {
    SCOPED_TRACE(round);
    const auto [scene, gbuffer, lights] = hard_scenes::viewed(random, engine);
    for (const Light& light : lights) compare("", scene, light, gbuffer, sum);
  }
  EXPECT_EQ(sum.wrong, 0);
  EXPECT_GT(sum.dark, 20'000);
  EXPECT_GT(sum.lit, 20'000);
  EXPECT_LT(sum.asked, 0.001 * sum.points);
  RecordProperty("pixels", sum.text());
}

// A lamp at a vertex, in a triangle but for one unit in the last place, and a long thin triangle that points at it: planes that
// double cannot vouch for. All is as the oracle says.
TEST(TwoPassObject, lights_almost_on_triangles_do_no_harm) {
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
      const Light light = point_light(at + glm::vec3(0, off, off));
      Picture picture(50, 40);
      hard_scenes::scatter(scene, light, random, picture);
      compare("", scene, light, picture.gbuffer, sum);
    }
  }
  EXPECT_EQ(sum.wrong, 0);
  EXPECT_GT(sum.dark, 5'000);
  EXPECT_GT(sum.lit, 1'000);
  RecordProperty("points", sum.text());
}

// A floor of 10 mm under a lamp 17 m off: a unit of float32, in which boxes around lit pieces are kept, is 0.6 micrometers of
// the floor there, and what a cell sees beyond its rectangle 0.01. Points within 1 micrometer of the floor's edges are lit.
TEST(TwoPassObject, lit_pieces_reach_the_edges_under_a_lamp_far_off) {
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
    compare("", scene, point_light(at), picture.gbuffer, sum);
  }
  EXPECT_EQ(sum.wrong, 0);
  EXPECT_EQ(sum.lit, 8'000);
  EXPECT_LT(sum.asked, 0.1 * sum.points);
}

// Inner points of the polygons, which no point location has to do with. Left out are the points whose way in float32 passes an
// edge, or that lie on the plane of another triangle, within rounding: 3e-7 of the extent. The areas add up besides; alone that
// would say little.
TEST(TwoPassObject, surface_detail_is_what_the_oracle_says) {
  Random random(31);
  std::mt19937 engine(31);
  int wrong = 0, checked = 0, left_out = 0, dark = 0;
  for (int round = 0; round < 36; ++round) {
    SCOPED_TRACE(round);
    const Scene scene = hard_scene(random, engine, round);
    const Light light = hard_scenes::hard_light(random);
    const SurfaceDetail detail = detail_of(round % 2 ? "" : "cell_triangles=4,merge=false", scene, light);
    const ExactScene exact(scene);
    const Bounds bounds = scene.bounds();
    double extent = 0, expected = 0, found = 0;
    for (int k = 0; k < 3; ++k) extent = std::max<double>({extent, std::abs(bounds.min[k]), std::abs(bounds.max[k])});
    for (std::uint32_t m = 0; m < scene.meshes.size(); ++m)
      for (std::uint32_t t = 0; t < scene.meshes[m].triangles.size(); ++t) {
        const Triangle own = triangle_of(scene, m, t);
        if (orient3d_sign(own.points[0], own.points[1], own.points[2], homogeneous(light)) != 0)
          expected += glm::length(normal_of(own));
      }
    std::pair<std::uint32_t, std::uint32_t> last(0, 0);
    for (const DetailPolygon& polygon : detail.polygons) {
      const std::pair at(polygon.mesh, polygon.triangle);
      EXPECT_GE(at, last);
      last = at;
      const Triangle own = triangle_of(scene, polygon.mesh, polygon.triangle);
      const glm::dvec3 normal = glm::normalize(normal_of(own));
      const std::span<const glm::dvec3> corners = corners_of(detail, polygon);
      ASSERT_GE(corners.size(), 3u);
      found += glm::dot(area_vector(corners), normal);  // wound as the triangle
      for (const glm::dvec3& p : corners) EXPECT_NEAR(glm::dot(normal, p - glm::dvec3(own.points[0])), 0, 1e-10 * extent);
      glm::dvec3 p(0);
      double sum = 0;
      for (const glm::dvec3& corner : corners) {
        const double weight = random.uniform(0.02, 1);
        p += weight * corner, sum += weight;
      }
      const Receiver receiver{glm::vec3(p / sum), polygon.mesh, polygon.triangle};
      bool is_clear = exact.edge_margin(receiver, homogeneous(light), 1e-6 * extent).clearance > 3e-7 * extent;
      for (std::uint32_t m = 0; m < scene.meshes.size() && is_clear; ++m)
        for (std::uint32_t t = 0; t < scene.meshes[m].triangles.size(); ++t) {
          const Triangle other = triangle_of(scene, m, t);
          const double height = glm::dot(glm::normalize(normal_of(other)), p / sum - glm::dvec3(other.points[0]));
          if (std::abs(height) < 3e-7 * extent && !std::ranges::all_of(other.points, [&](const glm::vec3& q) {
                return coplanar(own.points[0], own.points[1], own.points[2], q);
              }))
            is_clear = false;
        }
      if (!is_clear) {
        ++left_out;
        continue;
      }
      ++checked;
      dark += !polygon.is_lit;
      ExactTally tally;
      wrong += exact.occluded(receiver, homogeneous(light), tally).blocked == polygon.is_lit;
    }
    EXPECT_NEAR(found, expected, 1e-7 * expected);
  }
  EXPECT_EQ(wrong, 0);
  EXPECT_GT(checked, 20'000);
  EXPECT_GT(dark, 5'000);
  EXPECT_LT(left_out, checked / 10);
  RecordProperty("points", fmt::format("{} checked, {} of them dark, {} left out", checked, dark, left_out));
}

// A body on an exact shape leaves itself out; its shadow on the floor, and a plate's shadow on it, remain.
TEST(TwoPassObject, an_exact_shape_is_not_shaded_by_its_own_triangles) {
  Scene scene;
  scene.meshes = {tessellate(Sphere{{0, 0, 0}, 1}, 12, "sphere"), square(4, -1.5f), square(0.4f, 3)};
  Picture picture(100, 102, Truth::shape);
  Random random(4);
  const Light light = point_light({0.3f, 6, -0.2f});
  for (std::size_t i = 0; i < 10'000; ++i) {
    const glm::vec3 n(small_world::direction_of(random));
    picture.set(i, n, n, 0, 0);
  }
  for (std::size_t i = 10'000; i < 10'200; ++i) {
    const float x = static_cast<float>(random.uniform(-3, 3)), z = static_cast<float>(random.uniform(-3, 3));
    picture.set(i, {x, -1.5f, z}, {0, 1, 0}, 1, z > x ? 0 : 1);
  }
  Agreement sum;
  compare("", scene, light, picture.gbuffer, sum);
  EXPECT_EQ(sum.wrong, 0);
  EXPECT_GT(sum.dark, 100);
  EXPECT_GT(sum.lit, 1'000);
}

// Masks, counts and polygons are the same on one thread and on all, and what is named as shading a point blocks its way.
TEST(TwoPassObject, threads_change_nothing_and_what_is_named_shades) {
  std::mt19937 engine(12);
  Scene scene;
  scene.meshes = {square(3, 0), small_world::random_soup(engine, 8'000, 2, 0.1f, 2, 0.05f)};
  Random random(12);
  const Light light = point_light({0.7f, 3, 1.1f});
  Picture picture(100, 100);
  hard_scenes::scatter(scene, light, random, picture);
  const auto many = run("", scene, light, picture.gbuffer);
  const SurfaceDetail many_detail = many.technique->surface_detail().value();
  const tbb::global_control control(tbb::global_control::max_allowed_parallelism, 1);
  const auto one = run("", scene, light, picture.gbuffer);
  const SurfaceDetail one_detail = one.technique->surface_detail().value();
  EXPECT_EQ(one.mask, many.mask);
  EXPECT_EQ(one_detail.corners, many_detail.corners);
  EXPECT_EQ(one_detail.polygons.size(), many_detail.polygons.size());
  const Counts a = one.technique->counts(), b = many.technique->counts();
  for (std::size_t k = 0; k < a.size(); ++k) EXPECT_EQ(a[k].value, b[k].value) << a[k].name;
  int dark = 0;
  for (std::size_t i = 0; i < one.mask.size(); ++i) {
    const auto why = one.technique->explain(i);
    ASSERT_EQ(why.has_value(), faces_light(scene, picture.gbuffer, light, i));
    if (!why) continue;
    ASSERT_EQ(why->element.has_value(), one.mask[i] == 0);
    if (!why->element) continue;
    ++dark;
    const auto element = static_cast<std::uint32_t>(*why->element);
    const Triangle triangle = element >= 2 ? triangle_of(scene, 1, element - 2) : triangle_of(scene, 0, element);
    EXPECT_NE(crosses({picture.gbuffer.position(i), homogeneous(light)}, triangle), Crossing::none);
  }
  EXPECT_GT(dark, 500);
}

// The grid keeps work near linear: 16 times the triangles of a small ball over a large floor, whose two triangles lie under all
// of them, and 16 times those of a soup that covers the same share of it, cost about 16 times the pairs.
TEST(TwoPassObject, pairs_grow_with_triangles) {
  const auto pairs = [](const Scene& scene) {
    Picture nothing(1, 1);
    return value(run("", scene, point_light({2, 10, 1}), nothing.gbuffer).technique->counts(), "pairs_tested");
  };
  double ball[2], soup[2];
  for (int k = 0; k < 2; ++k) {
    Scene scene;
    scene.meshes = {square(50, -1.5f), tessellate(Sphere{{0, 0, 0}, 1}, k == 0 ? 32 : 128, "sphere")};
    ball[k] = pairs(scene);
    std::mt19937 engine(3);
    scene.meshes[1] = small_world::random_soup(engine, k == 0 ? 1'000 : 16'000, 8, 0.2f, 3.2f, k == 0 ? 0.2f : 0.05f);
    soup[k] = pairs(scene);
  }
  EXPECT_LT(ball[1], 24 * ball[0]);
  EXPECT_LT(soup[1], 24 * soup[0]);
  RecordProperty("pairs", fmt::format("ball {} -> {}, soup {} -> {}", ball[0], ball[1], soup[0], soup[1]));
}

TEST(TwoPassObject, area_lights_are_refused_and_a_fresh_object_has_no_polygons) {
  Registry roll;
  gnomon_technique_two_pass_object(roll);
  const auto technique = roll.technique("two_pass_object").make();
  const Support support = technique->supports({}, {.name = "area", .kind = SphereLight{}}, {});
  EXPECT_FALSE(support);
  EXPECT_FALSE(support.why().empty());
  EXPECT_TRUE(technique->supports({}, {.name = "spot", .kind = SpotLight{}}, {}));
  EXPECT_TRUE(technique->surface_detail().value().polygons.empty());
}

// One caster takes a part of the floor's first triangle and nothing of the second.
TEST(TwoPassObject, the_layer_shows_where_casters_took_something) {
  Scene scene;
  scene.meshes = {mesh_of({{-3, 1, 1}, {-3, 1, 3}, {-1, 1, 3}}, {{0, 1, 2}}), square(10, 0)};
  Picture picture(3, 1);
  picture.set(0, {5, 0, -5}, {0, 1, 0}, 1, 1);
  picture.set(1, {-5, 0, 5}, {0, 1, 0}, 1, 0);
  picture.set(2, {-2.5f, 0, 2.5f}, {0, 1, 0}, 1, 0);
  const auto done = run("", scene, sun({0, -1, 0}), picture.gbuffer);
  EXPECT_EQ(done.mask, (std::vector<float>{1, 1, 0}));
  EXPECT_EQ(value(done.technique->counts(), "pairs_clipped"), 1);
  const std::vector<float> layer = done.technique->draw_debug("clips");
  ASSERT_EQ(layer.size(), 9u);
  EXPECT_NE(layer[0], layer[3]);
  EXPECT_EQ(layer[3], layer[6]);
  const std::vector<float> fragments = done.technique->draw_debug("fragments");
  ASSERT_EQ(fragments.size(), 9u);
  EXPECT_GT(fragments[3], fragments[5]);  // lit is warm
  EXPECT_LT(fragments[6], fragments[8]);  // shadow is cool
  EXPECT_THROW(done.technique->draw_debug("nodes"), Error);
}

// The floor loses a part to the caster; a triangle 100 m away, named for a point of that floor, is not in the point's cell.
// What has lost nothing is gray.
TEST(TwoPassObject, the_layer_shows_nothing_where_a_cell_does_not_hold_the_triangle) {
  Scene scene;
  scene.meshes = {mesh_of({{100, 0, 0}, {100, 0, 1}, {101, 0, 0}}, {{0, 1, 2}}), square(10, 0),
                  mesh_of({{-3, 1, 1}, {-3, 1, 3}, {-1, 1, 3}}, {{0, 1, 2}})};
  Picture picture(2, 1);
  for (std::uint32_t mesh = 0; mesh < 2; ++mesh) picture.set(mesh, {-5, 0, 5}, {0, 1, 0}, mesh, 0);
  const auto done = run("cell_triangles=2", scene, sun({0, -1, 0}), picture.gbuffer);
  const std::vector<float> layer = done.technique->draw_debug("clips");
  ASSERT_EQ(layer.size(), 6u);
  EXPECT_EQ(layer[0], layer[2]);
  EXPECT_NE(layer[3], layer[5]);
}

}  // namespace
}  // namespace gnomon
