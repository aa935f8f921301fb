// Light that goes on from surface to surface, against sums and integrals that can be derived on paper.
#include <gnomon/kit/area/area_scene.h>
#include <gnomon/kit/area/path_light.h>
#include <gnomon/kit/geometry/across.h>
#include <gnomon/kit/random.h>
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <cmath>
#include <numbers>

#include "hand_made.h"

namespace gnomon::path_light_test {

constexpr double pi = std::numbers::pi;

/// Rays through a scene under a truth.
struct Rays {
  const Scene& scene;
  RayScene all, casters;
  Rays(const Scene& of, Truth truth)
      : scene(of), all(of, truth, RayScene::Which::seen), casters(of, truth, RayScene::Which::casters) {}
  PathPicture trace(const GBuffer& gbuffer, const Light& light, const PathOptions& options) const {
    return trace_paths({scene, all, casters}, gbuffer, light, options);
  }
};

/// A rectangle of two triangles; a, b, c, d are its corners in their order around it.
Mesh rectangle(const glm::vec3& a, const glm::vec3& b, const glm::vec3& c, const glm::vec3& d, const glm::vec3& albedo) {
  Mesh mesh = hand_made::mesh_of({a, b, c, d}, {{0, 1, 2}, {0, 2, 3}});
  mesh.albedo = albedo;
  return mesh;
}

constexpr float width = 2, height = 1.5f, depth = 1;

/// A closed room from 0 to (width, height, depth) whose six sides are one mesh each, some wound to the outside.
Scene room(const glm::vec3& albedo, bool casts) {
  const auto corner = [](int k) { return glm::vec3(k & 1 ? width : 0, k & 2 ? height : 0, k & 4 ? depth : 0); };
  Scene scene;
  for (const auto& [a, b, c, d] : std::initializer_list<std::array<int, 4>>{
           {0, 1, 3, 2}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 3, 7, 6}, {0, 2, 6, 4}, {1, 3, 7, 5}}) {
    scene.meshes.push_back(rectangle(corner(a), corner(b), corner(c), corner(d), albedo));
    scene.meshes.back().casts = casts;
  }
  return scene;
}

/// Flux that all surfaces of the room send, by channel: a point in each of n x n cells of a side. Its standard error by what
/// neighbors differ by.
struct Flux {
  glm::dvec3 value{0}, error{0};
};
Flux flux_from(const Scene& scene, const Light& light, const PathOptions& options) {
  constexpr int n = 12;
  hand_made::Picture picture(n * n, static_cast<int>(scene.meshes.size()));
  Random random(3);
  const glm::dvec3 middle(width / 2, height / 2, depth / 2);
  for (std::uint32_t side = 0; side < scene.meshes.size(); ++side) {
    const Mesh& mesh = scene.meshes[side];
    const glm::dvec3 a(mesh.positions[0]), u = glm::dvec3(mesh.positions[1]) - a, v = glm::dvec3(mesh.positions[3]) - a;
    glm::dvec3 normal = glm::normalize(glm::cross(u, v));
    if (glm::dot(normal, middle - a) < 0) normal = -normal;
    for (int k = 0; k < n * n; ++k) {
      const double s = (k % n + random.uniform(0, 1)) / n, t = (k / n + random.uniform(0, 1)) / n;
      picture.set(side * n * n + k, a + s * u + t * v, normal, side, s > t ? 0 : 1);
    }
  }
  const PathPicture found = Rays(scene, Truth::mesh).trace(picture.gbuffer, light, options);
  Flux flux;
  for (std::uint32_t side = 0; side < scene.meshes.size(); ++side) {
    const Mesh& mesh = scene.meshes[side];
    const double area = glm::length(
        glm::cross(glm::dvec3(mesh.positions[1] - mesh.positions[0]), glm::dvec3(mesh.positions[3] - mesh.positions[0])));
    for (int c = 0; c < 3; ++c) {
      double sum = 0, squares = 0;
      for (int k = 0; k < n * n; k += 2) {
        const double one = found.radiance[3 * (side * n * n + k) + c], next = found.radiance[3 * (side * n * n + k + 1) + c];
        sum += one + next;
        squares += (one - next) * (one - next);
      }
      flux.value[c] += pi * area * sum / (n * n);
      flux.error[c] += pi * area * pi * area * squares / (n * n * n * n);
    }
  }
  flux.error = glm::sqrt(flux.error);
  return flux;
}

struct Lamp {
  Light light;
  double flux;
};
std::vector<Lamp> lamps() {
  const double radiance = 3;
  return {{{.name = "rect",
            .kind = RectLight{{0.9f, 0.8f, 0.55f}, {0.2f, 0, 0}, {0, 0.1f, 0.1f}},
            .intensity = static_cast<float>(radiance)},
           2 * pi * radiance * 4 * 0.2 * std::sqrt(0.02)},
          {{.name = "disc",
            .kind = DiscLight{{1.1f, 0.9f, 0.5f}, {0, -1, 0.3f}, 0.2f, Emits::in_front},
            .intensity = static_cast<float>(radiance)},
           pi * radiance * pi * 0.04},
          {{.name = "sphere", .kind = SphereLight{{1, 0.7f, 0.5f}, 0.15f}, .intensity = static_cast<float>(radiance)},
           pi * radiance * 4 * pi * 0.15 * 0.15}};
}

// In a closed room all light meets a surface, which sends on its share rho; that meets one again: rho + rho^2 + ... of what the
// lamp sends, up to rho^(n+1) after n bounces. The errors come from points and paths together, and stay below 2 %.
TEST(PathLight, in_a_closed_room_the_flux_is_a_geometric_series) {
  const glm::dvec3 rho(0.2, 0.5, 0.8);
  for (const bool casts : {true, false})
    for (const Lamp& lamp : lamps())
      for (const std::optional<int> bounces : {std::optional(0), std::optional(2), std::optional<int>()}) {
        const Flux flux = flux_from(room(rho, casts), lamp.light, {.samples = 64, .bounces = bounces});
        for (int c = 0; c < 3; ++c) {
          const double series = (1 - (bounces ? std::pow(rho[c], *bounces + 1) : 0)) / (1 - rho[c]);
          const double right = lamp.flux * rho[c] * series;
          EXPECT_NEAR(flux.value[c], right, 4 * flux.error[c])
              << lamp.light.name << ' ' << casts << ' ' << bounces.value_or(-1) << ' ' << c;
          EXPECT_LT(flux.error[c], 0.02 * right) << lamp.light.name << ' ' << bounces.value_or(-1);
        }
      }
}

// Inside a sphere light that a surface sends spreads evenly over all of it, and so does that of a lamp in its center: every
// point has the irradiance flux / (1 - rho) over the sphere's area.
TEST(PathLight, in_an_exact_sphere_around_its_lamp_all_points_are_alike) {
  Scene scene;
  Mesh& mesh = scene.meshes.emplace_back(
      hand_made::mesh_of({{2, 0, 0}, {-1, 1, 0}, {-1, 0, 1}, {-1, -1, -1}}, {{0, 1, 2}, {0, 2, 3}, {0, 3, 1}, {1, 3, 2}}));
  const float radius = 2;
  mesh.shape = Sphere{{0.5f, 0, 0}, radius};
  const glm::dvec3 rho(0.7, 0.4, 0.1);
  mesh.albedo = rho;
  const Light lamp{.name = "lamp", .kind = SphereLight{{0.5f, 0, 0}, 0.25f}, .intensity = 2};
  hand_made::Picture picture(40, 1, Truth::shape);
  Random random(4);
  for (std::size_t i = 0; i < 40; ++i) {
    const glm::dvec3 out = glm::normalize(random.uniform(glm::dvec3(-1), glm::dvec3(1)));
    picture.set(i, glm::dvec3(0.5, 0, 0) + static_cast<double>(radius) * out, -out, 0, 0);
  }
  const PathPicture found = Rays(scene, Truth::shape).trace(picture.gbuffer, lamp, {.samples = 256});
  const double flux = pi * 2 * 4 * pi * 0.25 * 0.25;
  int beyond = 0;
  for (std::size_t i = 0; i < 40; ++i)
    for (int c = 0; c < 3; ++c) {
      const double right = rho[c] / pi * flux / (1 - rho[c]) / (4 * pi * radius * radius);
      EXPECT_NEAR(found.radiance[3 * i + c], right, 0.1 * right);
      beyond += std::abs(found.radiance[3 * i + c] - right) > 4 * found.error[3 * i + c] + 1e-5 * right;
    }
  EXPECT_LE(beyond, 3);  // of 120, half a percent each
}

/// Light of `area` at radiance 1 that a point with this normal gets from places of a rectangle, by midpoints.
template <class Radiance>
double irradiance_of(const glm::dvec3& corner, const glm::dvec3& u, const glm::dvec3& v, const glm::dvec3& point,
                     const glm::dvec3& normal, int cells, const Radiance& radiance) {
  double sum = 0;
  const glm::dvec3 across = glm::cross(u, v);
  for (int j = 0; j < cells; ++j)
    for (int i = 0; i < cells; ++i) {
      const glm::dvec3 place = corner + (i + 0.5) / cells * u + (j + 0.5) / cells * v, way = place - point;
      const double square = glm::dot(way, way);
      const double rise = std::max(0.0, glm::dot(normal, way));
      sum += radiance(place) * rise * std::abs(glm::dot(across, way)) / (square * square);
    }
  return sum / (cells * cells);
}

// The lamp shines down on the lower plate and not on the upper one, which sees it by that plate's light alone.
TEST(PathLight, one_bounce_between_plates_is_the_integral_over_the_first_one) {
  const glm::dvec3 low(0.8, 0.4, 0.2), high(0.5, 0.9, 0.3);
  Scene scene;
  scene.meshes.push_back(rectangle({-1, 0, -1}, {1, 0, -1}, {1, 0, 1}, {-1, 0, 1}, low));
  scene.meshes.push_back(rectangle({-1, 2, -1}, {1, 2, -1}, {1, 2, 1}, {-1, 2, 1}, high));
  const Light lamp{.name = "lamp",
                   .kind = RectLight{{0.2f, 1, 0}, {0, 0, 0.3f}, {-0.3f, 0, 0}, Emits::in_front},  // x: z x -x = -y
                   .intensity = 5};
  const std::vector<glm::vec3> points = {{0, 2, 0}, {0.7f, 2, -0.4f}, {-0.9f, 2, 0.9f}};
  hand_made::Picture picture(static_cast<int>(points.size()), 1);
  for (std::size_t i = 0; i < points.size(); ++i) picture.set(i, points[i], {0, -1, 0}, 1, 0);
  const Rays rays(scene, Truth::mesh);
  const PathPicture none = rays.trace(picture.gbuffer, lamp, {.samples = 64, .bounces = 0});
  const PathPicture one = rays.trace(picture.gbuffer, lamp, {.samples = 16384, .bounces = 1});
  for (std::size_t i = 0; i < points.size(); ++i) {
    const double received = irradiance_of({-1, 0, -1}, {2, 0, 0}, {0, 0, 2}, points[i], {0, -1, 0}, 80, [&](const auto& place) {
      return 5 / pi *
             irradiance_of({-0.1, 1, -0.3}, {0.6, 0, 0}, {0, 0, 0.6}, place, {0, 1, 0}, 12, [](const auto&) { return 1; });
    });
    for (int c = 0; c < 3; ++c) {
      const double right = high[c] / pi * low[c] * received;
      EXPECT_EQ(none.radiance[3 * i + c], 0);
      EXPECT_NEAR(one.radiance[3 * i + c], right, 4 * one.error[3 * i + c] + 1e-3 * right) << i << ' ' << c;
      EXPECT_LT(one.error[3 * i + c], 0.01 * right);
    }
  }
}

/// Irradiance of a rectangle at radiance 1, all above the horizon of a point at the origin (Lambert 1760).
double lambert(const RectLight& light, const glm::dvec3& normal) {
  const glm::dvec3 c = light.center, u = light.half_u, v = light.half_v;
  const glm::dvec3 corners[] = {c - u - v, c + u - v, c + u + v, c - u + v};
  double sum = 0;
  for (int k = 0; k < 4; ++k) {
    const glm::dvec3 a = glm::normalize(corners[k]), b = glm::normalize(corners[(k + 1) % 4]), across = glm::cross(a, b);
    sum += std::acos(glm::dot(a, b)) * glm::dot(glm::normalize(across), normal);
  }
  return std::abs(sum) / 2;
}

// As for shares of the light (area_rays_test): of seven degrees of freedom, Student's law has 8.56 % beyond 2 and 1.99 % beyond
// 3 standard errors. 300 of one law: at most 60 and 18 but once in a hundred thousand runs.
TEST(PathLight, direct_light_and_mask_are_those_of_the_exact_witness_within_their_error) {
  const RectLight rect{{0.4f, 3, 0}, {0.8f, 0, 0}, {0, 0.2f, 0.7f}};
  const Light light{.name = "lamp", .kind = rect, .intensity = 2};
  Random random(6);
  std::size_t beyond_2 = 0, beyond_3 = 0, asked = 0;
  double sum = 0;
  for (int round = 0; round < 300; ++round) {
    Scene scene;
    Mesh& floor = scene.meshes.emplace_back(hand_made::mesh_of({{-1, 0, -1}, {-1, 0, 1}, {2, 0, 0}}, {{0, 1, 2}}));
    floor.albedo = {0.6f, 0.3f, 0.9f};
    for (int k = 0; k < 1 + round % 4; ++k) {
      const glm::dvec3 place = random.uniform({-0.5, 0.6, -0.5}, {0.7, 1.6, 0.5});
      std::vector<glm::vec3> corners(3);
      for (glm::vec3& corner : corners) corner = place + random.uniform(glm::dvec3(-0.6), glm::dvec3(0.6));
      scene.meshes.push_back(hand_made::mesh_of(corners, {{0, 1, 2}}));
    }
    hand_made::Picture picture(1, 1);
    picture.set(0, {0, 0, 0}, {0, 1, 0}, 0, 0);
    const PathPicture found =
        Rays(scene, Truth::mesh)
            .trace(picture.gbuffer, light, {.samples = 1024, .bounces = 0, .seed = static_cast<std::uint64_t>(round)});
    const LightFigure face(light, {}, {0, 1, 0});
    LightPieces pieces;
    AreaTally tally;
    const double share = AreaScene(scene).seen({.mesh = 0}, face, pieces, tally).irradiance.best;
    const double all = 0.6 / pi * 2 * lambert(rect, {0, 1, 0}), error = found.error[0];
    EXPECT_NEAR(found.visibility[0], share, 0.03);
    EXPECT_FLOAT_EQ(found.radiance[1], found.radiance[0] / 2);
    if (share < 0.02 || share > 0.98) continue;  // the spread of what is lit throughout is not one of edges
    ++asked;
    const double off = (found.radiance[0] - all * share) / error;
    beyond_2 += std::abs(off) > 2;
    beyond_3 += std::abs(off) > 3;
    sum += off;
  }
  EXPECT_GT(asked, 150u);
  EXPECT_LE(beyond_2, 60u);
  EXPECT_LE(beyond_3, 18u);
  EXPECT_LT(std::abs(sum / static_cast<double>(asked)), 0.4);
}

// The spread of 400 answers is known to 3.5 %; the mean of their squared errors, each of seven degrees of freedom, to 2.7 %.
TEST(PathLight, answers_to_many_seeds_spread_as_their_standard_errors_say) {
  const Scene scene = room({0.3f, 0.6f, 0.9f}, true);
  const Lamp lamp = lamps()[0];
  hand_made::Picture picture(1, 1);
  picture.set(0, {0.5f, 0, 0.4f}, {0, 1, 0}, 2, 0);
  const Rays rays(scene, Truth::mesh);
  constexpr int count = 400;
  for (const int samples : {32, 37}) {
    glm::dvec3 sum(0), squares(0), told(0);
    for (int seed = 0; seed < count; ++seed) {
      const PathPicture found = rays.trace(picture.gbuffer, lamp.light,
                                           {.samples = samples, .bounces = {}, .seed = static_cast<std::uint64_t>(seed)});
      for (int c = 0; c < 3; ++c) {
        sum[c] += found.radiance[c];
        squares[c] += static_cast<double>(found.radiance[c]) * found.radiance[c];
        told[c] += static_cast<double>(found.error[c]) * found.error[c];
      }
    }
    for (int c = 0; c < 3; ++c) {
      const double mean = sum[c] / count, spread = squares[c] / count - mean * mean;
      EXPECT_GT(told[c] / count, 0.75 * spread) << samples << ' ' << c;
      EXPECT_LT(told[c] / count, 1.33 * spread) << samples << ' ' << c;
    }
  }
}

TEST(PathLight, the_answer_does_not_depend_on_the_number_of_threads) {
  const Scene scene = room({0.3f, 0.6f, 0.9f}, true);
  hand_made::Picture picture(20, 20);
  for (std::size_t i = 0; i < 400; ++i)
    picture.set(i, {0.1f * static_cast<float>(i % 20) + 0.05f, 0, 0.05f * static_cast<float>(i / 20) + 0.025f}, {0, 1, 0}, 2,
                0);
  const Rays rays(scene, Truth::mesh);
  const auto trace = [&] { return rays.trace(picture.gbuffer, lamps()[0].light, {.samples = 16}); };
  const PathPicture many = trace();
  const tbb::global_control one_thread(tbb::global_control::max_allowed_parallelism, 1);
  const PathPicture one = trace();
  EXPECT_EQ(many.radiance, one.radiance);
  EXPECT_EQ(many.error, one.error);
  EXPECT_EQ(many.visibility, one.visibility);
  EXPECT_EQ(many.rays, one.rays);
  EXPECT_GT(one.rays, 400u * 16 * 4);
}

// What reflects all light in a closed room keeps it for ever: the cap ends the path.
TEST(PathLight, paths_that_lose_no_light_end_at_the_cap) {
  hand_made::Picture picture(1, 1);
  picture.set(0, {0.5f, 0, 0.4f}, {0, 1, 0}, 2, 0);
  const Scene scene = room({1, 1, 1}, true);
  const PathPicture found = Rays(scene, Truth::mesh).trace(picture.gbuffer, lamps()[2].light, {.samples = 16});
  EXPECT_LE(found.rays, 16u * (1 + 2 * most_bounces));
  EXPECT_GT(found.rays, 16u * most_bounces);
}

}  // namespace gnomon::path_light_test
