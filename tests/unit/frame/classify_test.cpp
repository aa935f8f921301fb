// One pixel class after the other from points made by hand, each a scene that has exactly that.
#include "measure/frame/classify.h"

#include <gnomon/kit/geometry/exact.h>
#include <gnomon/kit/rays/gbuffer_maker.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "hand_made.h"
#include "measure/frame/light_rays.h"
#include "measure/frame/ray_packets.h"

namespace classify_test {

using namespace gnomon;
using hand_made::Picture;

std::string letters(const Scene& scene, const Picture& picture, const Light& light,
                    std::span<const std::uint8_t> silhouettes = {}) {
  const RayScene casters(scene, Truth::mesh, RayScene::Which::casters);
  std::vector<float> reference(picture.gbuffer.size());
  trace_shadows(casters, scene, picture.gbuffer, light, reference);
  std::string text;
  for (const PixelClass c : classify(scene, casters, picture.gbuffer, light, reference, silhouettes))
    text += class_infos()[std::size_t(c)].letter;
  return text;
}

/// Ground from -4 to 4 at height 0 (extent 4 with the eye at (0, 4, 0)), second mesh the same: to be another mesh. Neither
/// casts, so nothing is uncertain.
Scene two_grounds() {
  Scene scene;
  scene.meshes = {hand_made::square(4, 0), hand_made::square(4, 0)};
  for (Mesh& mesh : scene.meshes) mesh.casts = false;
  return scene;
}

TEST(classify, background_and_lit_ground) {
  Picture picture(3, 3);
  picture.gbuffer.view.eye = {0, 4, 0};
  EXPECT_EQ(letters(two_grounds(), picture, hand_made::sun({0, -1, 0})), "BBBBBBBBB");
  for (int i = 0; i < 9; ++i) picture.set(i, {0.1f * i, 0, 0}, {0, 1, 0}, 0, 0);
  EXPECT_EQ(letters(two_grounds(), picture, hand_made::sun({0, -1, 0})), "TTTTTTTTT");
}

TEST(classify, faces_away_outside_the_cone_or_on_a_mesh_that_does_not_receive) {
  Picture picture(3, 1);
  picture.gbuffer.view.eye = {0, 4, 0};
  for (int i = 0; i < 3; ++i) picture.set(i, {static_cast<float>(i), 0, 0}, {0, 1, 0}, 0, 0);
  EXPECT_EQ(letters(two_grounds(), picture, hand_made::sun({0, 1, 0})), "FFF");
  EXPECT_EQ(letters(two_grounds(), picture, hand_made::sun({1, 0, 0})), "FFF") << "N.L = 0 does not face";
  EXPECT_EQ(letters(two_grounds(), picture, hand_made::point_light({0, -1, 0})), "FFF");
  // From (0, 2, 0) straight down the points are seen under 0, 26.6 and 45 degrees.
  const Light spot{.name = "spot", .kind = SpotLight{{0, 2, 0}, {0, -1, 0}, 10, 30}};
  EXPECT_EQ(letters(two_grounds(), picture, spot), "TTF");
  // The middle point on a mesh of its own.
  Scene scene = two_grounds();
  scene.meshes[1].receives = false;
  for (int i = 0; i < 3; ++i) picture.set(i, {0, 0, 0}, {0, 1, 0}, i == 1 ? 1 : 0, 0);
  EXPECT_EQ(letters(scene, picture, hand_made::sun({0, -1, 0})), "TFT");
}

TEST(classify, grazing_below_0_035) {
  // N.L is the sine of the light's height above the horizon: 0.034 and 0.036.
  Picture picture(1, 1);
  picture.gbuffer.view.eye = {0, 4, 0};
  picture.set(0, {1, 0, 0}, {0, 1, 0}, 0, 0);
  const auto sun_at = [](double sine) {
    return hand_made::sun({static_cast<float>(7 * std::sqrt(1 - sine * sine)), static_cast<float>(-7 * sine), 0});
  };
  EXPECT_EQ(letters(two_grounds(), picture, sun_at(0.034)), "G");
  EXPECT_EQ(letters(two_grounds(), picture, sun_at(0.036)), "T");
  EXPECT_EQ(letters(two_grounds(), picture, hand_made::point_light({-99, 3.4f, 0})), "G") << "3.4 / 100.06 = 0.03398";
  EXPECT_EQ(letters(two_grounds(), picture, hand_made::point_light({-99, 3.6f, 0})), "T") << "3.6 / 100.06 = 0.03598";
}

/// Seen straight from above, 4 m over the ground: a pixel of 8 x 8 is 1 m of it, the center of pixel 4 at x = 0.5. A plate over
/// x > 0.5
/// - `beyond` px, `height` m high, is a mesh of its own or a part of the ground's.
std::vector<std::uint8_t> beside_a_plate(double beyond, double height, bool is_own_mesh) {
  const auto x = static_cast<float>((0.5 - beyond) * (4 - height) / 4), y = static_cast<float>(height);
  Mesh ground = hand_made::square(40, 0);
  Mesh plate = hand_made::mesh_of({{x, y, -40}, {40, y, -40}, {40, y, 40}, {x, y, 40}}, {{0, 1, 2}, {0, 2, 3}});
  Scene scene;
  if (is_own_mesh) {
    scene.meshes = {ground, plate};
  } else {
    for (const glm::vec3& p : plate.positions) ground.positions.push_back(p);
    for (const glm::uvec3& t : plate.triangles) ground.triangles.push_back(t + 4u);
    finish(ground);
    scene.meshes = {ground};
  }
  const RayScene everything(scene, Truth::mesh, RayScene::Which::seen);
  const View view{.eye = {0, 4, 0}, .target = {0, 0, 0}, .up = {0, 0, -1}, .fov_y_degrees = 90};
  return find_silhouettes(everything, make_gbuffer(scene, everything, view, 8, 8, Truth::mesh));
}

TEST(silhouettes, are_pixels_that_show_something_else_half_a_grid_aside) {
  for (const double sign : {-1.0, 1.0})  // the center shows the ground, or the plate
    for (const bool is_own_mesh : {true, false}) {
      const auto near = beside_a_plate(sign / 700, 0.4, is_own_mesh), far = beside_a_plate(sign / 400, 0.4, is_own_mesh);
      for (int i = 0; i < 64; ++i) {
        EXPECT_EQ(near[i], i % 8 == 4) << i << ": 1/700 of a pixel from the edge";
        EXPECT_EQ(far[i], 0) << i << ": 1/400";
      }
    }
  // 1 % nearer is another mesh, and no step of one.
  EXPECT_EQ(std::ranges::count(beside_a_plate(0, 0.04, true), 1), 8);
  EXPECT_EQ(std::ranges::count(beside_a_plate(0, 0.04, false), 1), 0);
  EXPECT_EQ(std::ranges::count(beside_a_plate(0, 0.12, false), 1), 8) << "3 %";
}

TEST(silhouettes, are_pixels_beside_nothing) {
  Scene scene;
  scene.meshes = {hand_made::mesh_of({{0.5f, 0, -40}, {40, 0, -40}, {40, 0, 40}, {0.5f, 0, 40}}, {{0, 1, 2}, {0, 2, 3}})};
  const RayScene everything(scene, Truth::mesh, RayScene::Which::seen);
  const View view{.eye = {0, 4, 0.1f}, .target = {0, 0, 0.1f}, .up = {0, 0, -1}, .fov_y_degrees = 90};
  const GBuffer gbuffer = make_gbuffer(scene, everything, view, 8, 8, Truth::mesh);
  const auto silhouettes = find_silhouettes(everything, gbuffer);
  for (int i = 0; i < 64; ++i)
    EXPECT_EQ(silhouettes[i], i % 8 == 4 && !gbuffer.is_background(i)) << "background is of a class of its own";
}

/// Ground from -4 to 4 that casts nothing, and one triangle over it.
Scene one_caster(const glm::vec3& a, const glm::vec3& b, const glm::vec3& c) {
  Scene scene;
  scene.meshes = {hand_made::square(4, 0), hand_made::mesh_of({a, b, c}, {{0, 1, 2}})};
  scene.meshes[0].casts = false;
  return scene;
}

TEST(classify, uncertain_within_rho_of_a_shadow_edge) {
  // The shadow of a vertical sun ends at x = 0. rho = 16 * 2^-24 * 4, the extent. The ground is at height 0 and N is the ray,
  // so the ray offset moves nothing sideways; the sun's turn by 2^-20 radian moves the edge at height 1 by rho / 4 only.
  const Scene scene = one_caster({0, 1, -3}, {0, 1, 3}, {-3, 1, 0});
  const float rho = 16 * 0x1p-24f * 4;
  Picture picture(9, 1);
  picture.gbuffer.view.eye = {0, 4, 0};
  const float steps[] = {-100, -2, -1.1f, -0.9f, 0.01f, 0.9f, 1.1f, 2, 100};
  for (int i = 0; i < 9; ++i) picture.set(i, {steps[i] * rho, 0, 0.5f}, {0, 1, 0}, 0, 0);
  EXPECT_EQ(letters(scene, picture, hand_made::sun({0, -1, 0})), "TTTUUUTTT");
}

TEST(classify, uncertain_beside_a_tip_between_the_shifts) {
  // A tip of 23 degrees at x = z = 0, halfway between the shifts of the light and of the point, which go along x and z: none
  // reaches it. Its shadow begins there; rho / 2 is 8 * 2^-24 * 4.
  const Scene scene = one_caster({0, 1, 0}, {3, 1, 2}, {2, 1, 3});
  const float rho = 16 * 0x1p-24f * 4;
  Picture picture(4, 1);
  picture.gbuffer.view.eye = {0, 4, 0};
  const float steps[] = {-2, -0.2f, 0.2f, 1000};
  for (int i = 0; i < 4; ++i) picture.set(i, {steps[i] * rho, 0, steps[i] * rho}, {0, 1, 0}, 0, 0);
  EXPECT_EQ(letters(scene, picture, hand_made::sun({0, -1, 0})), "TUUT");
}

TEST(classify, uncertain_where_only_the_ray_offset_keeps_the_point_lit) {
  // A caster 2^-24 above the point: 8 * 2^-24 * max|P| = 2^-21 lifts the ray past it, without the lift it blocks. At height
  // 2^-10 it blocks both, and below the point neither.
  for (const auto& [height, letter] : {std::pair(0x1p-24f, "U"), std::pair(0x1p-10f, "T"), std::pair(-0x1p-22f, "T")}) {
    const Scene scene = one_caster({0, height, -3}, {0, height, 3}, {3, height, 0});
    Picture picture(1, 1);
    picture.gbuffer.view.eye = {0, 4, 0};
    picture.set(0, {1, 0, 0}, {0, 1, 0}, 0, 0);
    EXPECT_EQ(letters(scene, picture, hand_made::sun({0, -1, 0})), letter) << height;
  }
}

// Points on the edges of casters, as float32 rounds them: by exact signs the caster shades about half of them, beside its edge
// or not, and the ray, which starts above the point, meets it or not. Of a lit one that is shaded the edge itself must tell.
TEST(classify, uncertain_where_the_edge_of_a_caster_holds_the_point) {
  std::mt19937 random(5);
  std::uniform_real_distribution<float> any(-1.5f, 1.5f), share(0.1f, 0.9f);
  const auto point = [&] { return glm::vec3(any(random), any(random), any(random)); };
  int shaded = 0;
  for (int round = 0; round < 4000; ++round) {
    const glm::vec3 a = point(), b = point(), c = point();
    Scene scene = one_caster(a, b, c);
    const glm::vec3 p = glm::mix(a, b, share(random));
    const Light light = hand_made::point_light({4, 1.5f, 1.5f});
    const glm::vec3 normal = glm::normalize(glm::vec3(3, any(random), any(random)));
    const glm::vec3 u = glm::normalize(glm::cross(normal, {0, 1, 0})), v = glm::cross(normal, u);
    scene.meshes[0] = hand_made::mesh_of({p - u - v, p + 3.0f * u, p + 3.0f * v}, {{0, 1, 2}});
    scene.meshes[0].casts = false;
    const Segment way{p, homogeneous(light)};
    if (crosses(way, scene.meshes[1].corners(0)) == Crossing::none) continue;
    Picture picture(1, 1);
    picture.gbuffer.view.eye = {4, 1, 0};
    picture.set(0, p, normal, 0, 0);
    const RayScene casters(scene, Truth::mesh, RayScene::Which::casters);
    std::vector<float> reference(1);
    trace_shadows(casters, scene, picture.gbuffer, light, reference);
    if (!is_lit(reference[0])) continue;
    ++shaded;
    EXPECT_NE(letters(scene, picture, light), "T") << round;
  }
  EXPECT_GT(shaded, 100);
}

TEST(classify, uncertain_pixels_lie_within_rounding_of_the_shadow_edge) {
  // Random triangle, random light, a point on one of its edges, projected on the ground, moved off the shadow's edge by d.
  // The ray offset shifts the edge by 8 * 2^-24 * 4 * tan: up to rho / 2 * 1.2. Shifts of the point and the light reach 0.7 to
  // 1.3 rho from there (the tangents may lie askew to the edge; a light 5 m up moves a shadow of what is 1 m up by rho / 4).
  // So |d| < 0.1 rho must be U, and |d| > 3 rho must not; the side decides nothing.
  std::mt19937 random(4);
  const auto number = [&](double low, double high) { return std::uniform_real_distribution<double>(low, high)(random); };
  int near = 0, far = 0;
  for (int round = 0; round < 300; ++round) {
    glm::dvec3 corner[3];
    for (glm::dvec3& c : corner) c = glm::vec3(number(-1, 1), number(0.5, 1), number(-1, 1));
    if (glm::length(glm::cross(corner[1] - corner[0], corner[2] - corner[0])) < 0.3) continue;
    const Scene scene = one_caster(corner[0], corner[1], corner[2]);
    const glm::dvec3 light = glm::vec3(number(-1, 1), 5, number(-1, 1));
    const auto project = [&](const glm::dvec3& p) { return light + (p - light) * (light.y / (light.y - p.y)); };
    const glm::dvec3 a = project(corner[0]), b = project(corner[1]), c = project(corner[2]);
    const glm::dvec3 across = glm::normalize(glm::cross(b - a, glm::dvec3(0, 1, 0)));
    // Seen edge-on the triangle has a thin shadow, with two edges near the point.
    if (std::abs(glm::dot(across, c - a)) < 0.05) continue;
    const double rho = 16 * 0x1p-24 * 5;
    const glm::dvec3 edge = glm::mix(a, b, number(0.2, 0.8));
    Picture picture(4, 1);
    picture.gbuffer.view.eye = {0, 4, 0};
    const double off[] = {number(-0.1, 0.1), number(-0.1, 0.1), number(3, 30), number(-30, -3)};
    for (int i = 0; i < 4; ++i) picture.set(i, glm::vec3(edge + off[i] * rho * across), {0, 1, 0}, 0, 0);
    EXPECT_EQ(letters(scene, picture, hand_made::point_light(light)), "UUTT") << round;
    near += 2;
    far += 2;
  }
  EXPECT_GT(near + far, 400);
}

TEST(classify, first_match_decides) {
  // One row; the light is vertical and its shadow edge runs through every point (x = 0), so all are uncertain at least.
  const Scene scene = one_caster({0, 1, -3}, {0, 1, 3}, {-3, 1, 0});
  const Light sun = hand_made::sun({0, -1, 0});
  Picture picture(1, 2);
  picture.gbuffer.view.eye = {0, 4, 0};
  const std::uint8_t in_doubt[] = {1, 0};
  const auto upper = [&](const glm::vec3& normal, std::span<const std::uint8_t> silhouettes) {
    picture.set(0, {0, 0, 0}, normal, 0, 0);
    picture.set(1, {0, 0, 0.5f}, {0, 1, 0}, 0, 0);
    return letters(scene, picture, sun, silhouettes)[0];
  };
  const glm::vec3 grazing(std::sqrt(1 - 0.03f * 0.03f), 0.03f, 0);
  EXPECT_EQ(upper({0, 1, 0}, {}), 'U');
  EXPECT_EQ(upper({0, 1, 0}, in_doubt), 'S') << "silhouette before uncertain";
  EXPECT_EQ(upper(grazing, in_doubt), 'G') << "grazing before silhouette";
  EXPECT_EQ(upper({0, -1, 0}, in_doubt), 'F') << "facing away before silhouette";
  picture.mesh[0] = no_mesh;
  EXPECT_EQ(letters(scene, picture, sun, in_doubt)[0], 'B');
}

TEST(classify, a_reference_that_is_wrong_makes_uncertain_and_nothing_else) {
  const Scene scene = one_caster({0, 1, -3}, {0, 1, 3}, {-3, 1, 0});
  Picture picture(20, 2);
  picture.gbuffer.view.eye = {0, 4, 0};
  for (int i = 0; i < 40; ++i) {
    picture.set(i, {-2.05f + 0.1f * i, 0, 0}, {0, i % 7 ? 1.0f : -1.0f, 0}, 0, 0);
    if (i == 17) picture.mesh[i] = no_mesh;
  }
  const Light sun = hand_made::sun({0, -1, 0});
  const RayScene casters(scene, Truth::mesh, RayScene::Which::casters);
  std::vector<float> reference(40);
  trace_shadows(casters, scene, picture.gbuffer, sun, reference);
  const auto right = classify(scene, casters, picture.gbuffer, sun, reference, {});
  for (float& v : reference) v = 1 - v;
  const auto inverted = classify(scene, casters, picture.gbuffer, sun, reference, {});
  for (std::size_t i = 0; i < right.size(); ++i)
    EXPECT_EQ(inverted[i], right[i] == PixelClass::T ? PixelClass::U : right[i]) << i;
  const auto counts = count_classes(right);
  EXPECT_EQ(counts[std::size_t(PixelClass::B)], 1u);
  EXPECT_EQ(counts[0] + counts[1] + counts[2] + counts[3] + counts[4] + counts[5], 40u);
  EXPECT_GT(counts[std::size_t(PixelClass::T)], 20u);
}

TEST(classify, a_class_is_known_by_its_letter_in_the_order_of_the_classes) {
  std::string letters;
  for (const ClassInfo& info : class_infos()) letters += info.letter;
  EXPECT_EQ(letters, "BFGSUT");
  EXPECT_EQ(class_infos()[std::size_t(PixelClass::T)].word, "tested");
}

TEST(wrong, is_on_the_other_side_of_one_half) {
  for (const float reference : {0.0f, 1.0f})
    for (const float v : {0.0f, 0.25f, std::nextafter(0.5f, 0.0f), 0.5f, std::nextafter(0.5f, 1.0f), 0.75f, 1.0f})
      EXPECT_EQ(is_wrong(v, reference), is_lit(v) != is_lit(reference)) << v << ' ' << reference;
  // Of shares: off by more than one half, or by one half and dark where the reference is lit.
  EXPECT_FALSE(is_wrong(0.4f, 0.6f));
  EXPECT_FALSE(is_wrong(0.75f, 0.25f));
  EXPECT_TRUE(is_wrong(0.25f, 0.75f));
  EXPECT_TRUE(is_wrong(0.8f, 0.25f));
  EXPECT_FALSE(is_lit(0.5f)) << "a tie counts as shadow";
  EXPECT_TRUE(is_lit(std::nextafter(0.5f, 1.0f)));
}

TEST(moved_rays, go_aside_across_the_ray_and_back_to_the_plane) {
  std::mt19937 random(3);
  std::normal_distribution<double> normal;
  const auto unit = [&] { return glm::normalize(glm::dvec3{normal(random), normal(random), normal(random)}); };
  for (int k = 0; k < 1000; ++k) {
    const glm::dvec3 ray = unit(), n = unit();
    const auto [u, v] = across(ray);
    EXPECT_NEAR(glm::length(u), 1, 1e-14);
    EXPECT_NEAR(glm::length(v), 1, 1e-14);
    EXPECT_NEAR(std::max({std::abs(glm::dot(u, v)), std::abs(glm::dot(u, ray)), std::abs(glm::dot(v, ray))}), 0, 1e-14);
    const glm::dvec3 back = back_to_plane(u, ray, n);
    if (std::abs(glm::dot(ray, n)) > 2e-3) {
      EXPECT_NEAR(glm::dot(u + back, n), 0, 1e-12) << "the point lies on the plane again";
      EXPECT_NEAR(glm::length(glm::cross(back, ray)), 0, 1e-12) << "it came along the ray";
    }
  }
  EXPECT_EQ(back_to_plane({0, 1, 0}, {1, 0, 0}, {0, 1, 0}), glm::dvec3(0)) << "a ray in the plane brings nothing back";
}

TEST(pixel_packets, take_sixteen_and_the_rest) {
  for (const std::size_t count : {0u, 1u, 16u, 17u, 40u}) {
    // Two rows; every third pixel is classified, but not the last one.
    const int width = static_cast<int>(3 * count + 1);
    std::vector<std::size_t> sizes[2], pixels[2];
    const auto is_asked = [&](std::size_t i, int x, int y) {
      EXPECT_EQ(i, static_cast<std::size_t>(y * width + x));
      return x % 3 == 0 && x < width - 1;
    };
    decide_in_packets(width, 2, is_asked, [&](std::span<const std::size_t> some) {
      const std::size_t row = some[0] / width;  // rows may come on different threads
      sizes[row].push_back(some.size());
      pixels[row].insert(pixels[row].end(), some.begin(), some.end());
    });
    for (const std::size_t row : {0u, 1u}) {
      ASSERT_EQ(pixels[row].size(), count);
      for (std::size_t i = 0; i < count; ++i) EXPECT_EQ(pixels[row][i], row * width + 3 * i);
      EXPECT_EQ(sizes[row].size(), (count + 15) / 16);
      EXPECT_TRUE(std::ranges::all_of(sizes[row], [](std::size_t size) { return size > 0 && size <= 16; }));
    }
  }
}

}  // namespace classify_test
