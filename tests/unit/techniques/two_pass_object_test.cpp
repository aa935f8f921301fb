// Two-pass object precision: pieces on paper, what threads and growth change, layers, and what is refused.
#include <gnomon/error.h>
#include <gnomon/kit/geometry/exact_scene.h>
#include <tbb/global_control.h>

#include "techniques/two_pass_object/detail.h"
#include "two_pass_object_rig.h"

namespace two_pass_object_test {

using namespace two_pass_object_rig;
using small_world::value;

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

}  // namespace two_pass_object_test
