#include <gnomon/kit/random.h>
#include <gtest/gtest.h>

#include <random>

#include "measure/frame/classify.h"
#include "measure/frame/frame.h"
#include "measure/score/score.h"
#include "small_world.h"

namespace snapping_test {

using namespace small_world;

/// Straight down from 4 meters with tan(fov / 2) = 1: the ground at height 0 is seen from -4 to 4 along x, which runs to the
/// right, and along z, which runs down.
View from_above() { return {.eye = {0, 4, 0}, .target = {0, 0, 0}, .up = {0, 0, -1}, .fov_y_degrees = 90}; }

struct Frame {
  GBuffer gbuffer;
  std::vector<float> reference;
  std::vector<PixelClass> classes;
  std::vector<std::uint8_t> snapping;

  Frame(const Scene& scene, const Light& light, const View& view, int size, Truth truth = Truth::mesh, int subpixel_bits = 8) {
    const RayScene everything(scene, truth, RayScene::Which::seen), casters(scene, truth, RayScene::Which::casters);
    gbuffer = gnomon::make_gbuffer(scene, everything, view, size, size, truth);
    reference.resize(gbuffer.size());
    trace_shadows(casters, scene, gbuffer, light, reference);
    classes = classify(scene, casters, gbuffer, light, reference, find_silhouettes(everything, gbuffer));
    snapping = find_snapping(scene, everything, casters, gbuffer, light, reference, classes, subpixel_bits);
  }
  Evidence evidence() const {
    return {.width = gbuffer.width,
            .height = gbuffer.height,
            .classes = classes,
            .reference = reference,
            .mask = reference,
            .causes = {},
            .snapping = snapping};
  }
  std::size_t count() const { return std::ranges::count(snapping, 1); }
};

std::optional<double> floor_of(const Evidence& evidence) { return measure_metrics(Scoring(evidence)).at("snapping_floor"); }

/// A plate at height 1, 0 < x < right, -1 < z < 1, under a sun that moves its shadow by 1 along x.
Scene plate(float right) {
  Scene scene;
  scene.name = "plate";
  scene.meshes = {ground(4), make_mesh({{0, 1, -1}, {0, 1, 1}, {right, 1, 1}, {right, 1, -1}}, {{0, 1, 2}, {0, 2, 3}})};
  scene.lights = {{.name = "sun", .kind = DirectionalLight{{1, -1, 0}}}};
  scene.views = {from_above()};
  return scene;
}

TEST(snapping, an_edge_of_sixteen_pixels_counts_when_it_is_within_a_512th_of_their_centers) {
  // At 64 x 64 a pixel is 0.125 m, with centers at the odd multiples of 0.0625 m. The shadow on the ground is
  // 1 < x < right + 1, -1 < z < 1, sixteen rows high, with its ends midway between centers; the plate hides its left part, up
  // to 4/3 right. Its right edge lies m / 1024 px right of the centers at x = 2.0625: near enough for m = 1, and not for 3.
  for (const int m : {-3, -1, 1, 3}) {
    const Scene scene = plate(1.0625f + 0.125f / 1024 * static_cast<float>(m));
    const Frame frame(scene, scene.lights[0], from_above(), 64);
    const std::size_t expected = std::abs(m) == 1 ? 16 : 0;
    EXPECT_EQ(frame.count(), expected) << m;
    for (int y = 24; y < 40; ++y) EXPECT_EQ(frame.snapping[64 * y + 48], expected > 0) << m << " row " << y;
    const auto tested = static_cast<double>(std::ranges::count(frame.classes, PixelClass::T));
    EXPECT_DOUBLE_EQ(floor_of(frame.evidence()).value(), static_cast<double>(expected) / tested);
  }
}

// The same plate, and a rasterizer that rounds to 1/16 px: half of that is 32/1024 px.
TEST(snapping, a_coarser_grid_turns_over_what_is_within_half_of_it) {
  for (const int m : {-33, -31, 31, 33}) {
    const Scene scene = plate(1.0625f + 0.125f / 1024 * static_cast<float>(m));
    EXPECT_EQ(Frame(scene, scene.lights[0], from_above(), 64, Truth::mesh, 4).count(), std::abs(m) == 31 ? 16u : 0u) << m;
    EXPECT_EQ(Frame(scene, scene.lights[0], from_above(), 64).count(), 0u) << m;
  }
}

TEST(snapping, a_pixel_counts_when_a_corner_of_its_square_is_across_the_edge_of_a_triangle_s_shadow) {
  // Under a sun, the shadow of a triangle is a triangle, and the image of the ground is a similar picture of it. Seventy
  // triangles have edges in all directions; each pixel of the ground is decided on paper.
  std::mt19937 random(5);
  std::uniform_real_distribution<float> across(-1, 1), height(0.6f, 1);
  constexpr int size = 256;
  const double pixel = 8.0 / size;
  double expected_area = 0;
  std::size_t flagged = 0;
  for (int round = 0; round < 30; ++round) {
    // Shadows lie at x > 0.6: five meters to the right of the casters.
    std::vector<glm::vec3> p;
    for (int k = 0; k < 3; ++k) p.push_back({-1.5f + across(random), height(random), 2 * across(random)});
    Scene scene;
    scene.meshes = {ground(4), make_mesh(p, {{0, 1, 2}})};
    const Light sun{.name = "sun", .kind = DirectionalLight{{5, -1, 0.5f}}};
    const Frame frame(scene, sun, from_above(), size);

    // Corners of the shadow in pixels.
    glm::dvec2 s[3];
    for (int k = 0; k < 3; ++k) {
      const glm::dvec3 v = p[k];
      s[k] = {(v.x + 5 * v.y + 4) / pixel, (v.z + 0.5 * v.y + 4) / pixel};
    }
    const auto cross = [](const glm::dvec2& a, const glm::dvec2& b) { return a.x * b.y - a.y * b.x; };
    if (cross(s[1] - s[0], s[2] - s[0]) < 0) std::swap(s[1], s[2]);
    /// Pixels that `q` is inside by; negative outside.
    const auto depth = [&](const glm::dvec2& q) {
      double least = INFINITY;
      for (int k = 0; k < 3; ++k) {
        const glm::dvec2 edge = s[(k + 1) % 3] - s[k];
        least = std::min(least, cross(edge, q - s[k]) / glm::length(edge));
      }
      return least;
    };
    for (int y = 0; y < size; ++y)
      for (int x = 0; x < size; ++x) {
        const std::size_t i = static_cast<std::size_t>(y) * size + x;
        if (frame.classes[i] != PixelClass::T || frame.gbuffer.mesh[i] != 0) continue;
        const glm::dvec2 center(x + 0.5, y + 0.5);
        bool flips = false, is_close = false;
        for (int corner = 0; corner < 4; ++corner) {
          const double d = depth(center + glm::dvec2(corner & 1 ? 1 : -1, corner & 2 ? 1 : -1) / 512.0);
          // The float32 point is off by up to 2.4e-7 m in each coordinate, 1e-5 px; the shadow ray's end by a few times that.
          is_close |= std::abs(d) < 1e-4;
          flips |= (d > 0) != (depth(center) > 0);
        }
        EXPECT_TRUE(is_close || frame.snapping[i] == flips) << "round " << round << " at " << x << ' ' << y;
        flagged += frame.snapping[i];
      }
    // By length: a strip of (|nx| + |ny|) / 512 on either side of an edge with unit normal n holds as many centers as its area.
    for (int k = 0; k < 3; ++k) {
      const glm::dvec2 edge = glm::abs(s[(k + 1) % 3] - s[k]);
      const bool is_seen = std::max(s[k].x, s[(k + 1) % 3].x) < size && std::min(s[k].x, s[(k + 1) % 3].x) > 0;
      if (is_seen) expected_area += 2 * (edge.x + edge.y) / 512;
    }
  }
  // Centers fall into such strips like independent events; edges that leave the picture are in neither sum on the whole.
  EXPECT_GT(expected_area, 25);
  EXPECT_NEAR(static_cast<double>(flagged), expected_area, 4 * std::sqrt(expected_area));
}

TEST(snapping, the_shadow_on_a_curved_shape_is_asked_on_the_shape) {
  // A ball of radius 2 seen from above, a sun at 45 degrees from the left, and a wall on that side whose upper edge runs along
  // z: light carries x + y of that edge along unchanged, so that the shadow's edge on the ball is where x + y is the same. A
  // pixel flips where the sums at its corners lie on both sides of it.
  constexpr int size = 256;
  const Camera camera(from_above(), size, size);
  const auto sum = [&](double x, double y) {
    const glm::dvec3 d = glm::normalize(camera.ray(x, y));
    const double b = glm::dot(camera.eye, d), c = glm::dot(camera.eye, camera.eye) - 4;
    const glm::dvec3 p = camera.eye + d * (-b - std::sqrt(b * b - c));
    return p.x + p.y;
  };
  int expected = 0, dark = 0;
  for (int round = 0; round < 40; ++round) {
    const float top = 9 + 0.03f * static_cast<float>(round);
    Scene scene;
    Mesh ball = box({-2, -2, -2}, {2, 2, 2});
    ball.shape = Sphere{{0, 0, 0}, 2};
    scene.meshes = {ball, make_mesh({{-8.5f, top, -9}, {-8.5f, top, 9}, {-20, top - 11.5f, 9}, {-20, top - 11.5f, -9}},
                                    {{0, 1, 2}, {0, 2, 3}})};
    const double edge = double(-8.5f) + double(top);
    const Frame frame(scene, {.name = "sun", .kind = DirectionalLight{{1, -1, 0}}}, from_above(), size, Truth::shape);
    for (std::size_t i = 0; i < frame.snapping.size(); ++i) {
      if (frame.classes[i] != PixelClass::T || frame.gbuffer.mesh[i] != 0) continue;
      const double x = static_cast<double>(i % size) + 0.5, y = static_cast<double>(i / size) + 0.5, here = sum(x, y) - edge;
      dark += frame.reference[i] == 0;
      bool flips = false, is_close = false;
      for (const double dx : {-1.0 / 512, 1.0 / 512})
        for (const double dy : {-1.0 / 512, 1.0 / 512}) {
          const double s = sum(x + dx, y + dy) - edge;
          // Rounding to float32 moves the point by up to 2e-7 m and the ray's other end by a few times that.
          is_close |= std::abs(s) < 1e-5;
          flips |= (s > 0) != (here > 0);
        }
      if (is_close) continue;
      EXPECT_EQ(frame.snapping[i], flips) << "round " << round << " at " << x << ' ' << y;
      expected += flips;
    }
  }
  EXPECT_GT(dark, 10000);
  EXPECT_GT(expected, 8);
}

TEST(snapping, without_a_caster_nothing_flips_and_without_flags_there_is_no_floor) {
  Scene scene = plate(-1);
  for (Mesh& mesh : scene.meshes) mesh.casts = false;
  const Frame frame(scene, scene.lights[0], from_above(), 64);
  EXPECT_EQ(frame.count(), 0u);
  EXPECT_EQ(floor_of(frame.evidence()), 0.0);
  Evidence evidence = frame.evidence();
  evidence.snapping = {};
  EXPECT_EQ(floor_of(evidence), std::nullopt);
}

TEST(snapping, only_tested_pixels_count_and_a_point_without_answer_never_differs) {
  std::mt19937 random(11);
  std::size_t flagged = 0;
  for (int round = 0; round < 8; ++round) {
    Scene scene;
    scene.meshes = {ground(4, 0, false), random_soup(random, 60, 3, 0.2f, 2, 0.7f), box({-1, 0, -1}, {1, 0.5f, 1})};
    scene.meshes[2].receives = round % 2 == 0;
    const Light light{.name = "spot", .kind = SpotLight{{1, 3.5f, 1}, {-0.2f, -1, -0.1f}, 20, 40}};
    const Frame frame(scene, light, from_above(), 256);
    for (std::size_t i = 0; i < frame.snapping.size(); ++i)
      EXPECT_TRUE(frame.classes[i] == PixelClass::T || !frame.snapping[i]);
    flagged += frame.count();
    // The same again, whatever thread did it.
    EXPECT_EQ(Frame(scene, light, from_above(), 256).snapping, frame.snapping);
  }
  EXPECT_GT(flagged, 0u);
  // A cone of light on bare ground: the pixels at its rim have a corner outside, and still none is flagged.
  Scene bare;
  bare.meshes = {ground(4)};
  const Light spot{.name = "spot", .kind = SpotLight{{0, 3, 0}, {0, -1, 0}, 20, 40}};
  EXPECT_EQ(Frame(bare, spot, from_above(), 512).count(), 0u);
}

// The ways from the upper corners of a row of pixels lie in the plane of a triangle beside the picture. The ray tracer reports
// that some of them meet it, which an opaque one shows.
TEST(snapping, a_triangle_in_whose_plane_ways_pass_it_turns_no_pixel_over) {
  Random random(3);
  constexpr int size = 64;
  std::size_t reported = 0;
  for (int round = 0; round < 120; ++round) {
    const glm::vec3 lamp = random.uniform(glm::dvec3(-0.5, 2.5, -3), glm::dvec3(0.5, 3.5, 3));
    const double z = (random.below(size) + 0.5 - 1.0 / 512) * 8 / size - 4;
    const auto on_way = [&](double x, double t) { return glm::vec3(x, t * lamp.y, z + t * (lamp.z - z)); };
    Scene scene;
    scene.meshes = {ground(4), make_mesh({on_way(3.3, 0.35), on_way(3.5, 0.75), on_way(8, 0.8)}, {{0, 1, 2}})};
    scene.meshes[0].casts = false;
    const Light light{.name = "lamp", .kind = PointLight{lamp}};
    reported += Frame(scene, light, from_above(), size).count();
    scene.meshes[1].transmission = std::make_shared<const Transmission>(glm::vec3(0.5f));
    EXPECT_EQ(Frame(scene, light, from_above(), size).count(), 0u) << round;
  }
  EXPECT_GT(reported, 3u);
}

}  // namespace snapping_test
