// Umbra and penumbra trees against shares derived on paper, against the exact witness, and against svbsp where the light is
// next to a point.
#include <gnomon/kit/area/area_scene.h>
#include <gnomon/kit/geometry/across.h>
#include <gnomon/kit/pictures/surface_detail.h>
#include <gtest/gtest.h>

#include "hard_scenes.h"

extern "C" void gnomon_technique_area_svbsp(gnomon::Registry&);
extern "C" void gnomon_technique_svbsp(gnomon::Registry&);

namespace gnomon::area_svbsp_test {

Light lamp(const glm::vec3& center, float half_u, float half_v) {
  return {.name = "lamp", .kind = RectLight{center, {half_u, 0, 0}, {0, 0, half_v}}};
}

/// A light of any kind, anywhere in and above a scene of 6 m, turned anyhow, of 3 mm to 2 m.
Light any_light(Random& random, int kind) {
  const glm::vec3 at(random.uniform(glm::dvec3(-2.5, 0.3, -2.5), glm::dvec3(2.5, 4, 2.5)));
  const Across across(small_world::direction_of(random));
  const double size = std::pow(10.0, random.uniform(-2.5, 0.3));
  const Emits emits = random.below(3) == 0 ? Emits::in_front : Emits::on_both_sides;
  if (kind == 0)
    return {.name = "lamp",
            .kind = RectLight{at, glm::vec3(size * random.uniform(0.3, 1) * across.u),
                              glm::vec3(size * random.uniform(0.3, 1) * across.v), emits}};
  if (kind == 1) return lamp(at, static_cast<float>(size), static_cast<float>(size * random.uniform(0.2, 1)));
  if (kind == 2) return {.name = "lamp", .kind = DiscLight{at, glm::vec3(across.u), static_cast<float>(size), emits}};
  return {.name = "lamp", .kind = SphereLight{at, static_cast<float>(size)}};
}

Scene any_scene(Random& random, std::mt19937& engine, int kind) {
  Scene scene;
  scene.meshes = {small_world::ground(3, 0)};
  if (kind < 2) scene.meshes.push_back(hard_scenes::boxes(random, 6, kind == 1));
  if (kind == 2) scene.meshes.push_back(small_world::random_soup(engine, 30, 2, 0.1f, 2, 0.5f));
  if (kind == 3) scene.meshes.push_back(hard_scenes::grid_soup(random, 25));
  return scene;
}

/// Points anywhere on triangles, most on the side that is turned to the light's center.
void scatter(const Scene& scene, const Light& light, Random& random, hand_made::Picture& picture) {
  for (std::size_t i = 0; i < picture.gbuffer.size(); ++i) {
    const std::uint32_t m = random.below(static_cast<std::uint32_t>(scene.meshes.size()));
    const std::uint32_t t = random.below(static_cast<std::uint32_t>(scene.meshes[m].triangles.size()));
    const Triangle triangle = scene.meshes[m].corners(t);
    const glm::dvec3 a(triangle.points[0]), b(triangle.points[1]), c(triangle.points[2]);
    const double u = random.uniform(0, 1), v = random.uniform(0, 1) * (1 - u);
    const glm::vec3 p(a + u * (b - a) + v * (c - a));
    glm::dvec3 n = glm::normalize(triangle.normal());
    if ((glm::dot(n, to_light(homogeneous_of_center(light), p)) < 0) != (random.below(8) == 0)) n = -n;
    picture.set(i, p, n, m, t);
  }
}

/// How masks compare with the witness, outside class U.
struct Tally {
  std::size_t lit = 0, wrong_lit = 0, umbra = 0, wrong_umbra = 0, penumbra = 0, uncertain = 0;
  double worst = 0;  ///< in the penumbra

  void add(const Scene& scene, const Light& light, const hand_made::Picture& picture, std::span<const float> mask) {
    const AreaScene witness(scene);
    LightPieces pieces;
    AreaTally work;
    const GBuffer& g = picture.gbuffer;
    for (std::size_t i = 0; i < mask.size(); ++i) {
      const Receiver receiver = receiver_at(scene, g, i);
      const auto share = [&](const glm::vec3& offset, const glm::vec3& normal) {
        Receiver moved = receiver;
        moved.point += offset;
        const LightFigure face(light, moved.point, normal);
        return face.is_seen() ? witness.seen(moved, face, pieces, work).area.best : 1;
      };
      if (!LightFigure(light, receiver.point, g.normal(i)).is_seen()) {
        EXPECT_EQ(mask[i], 1);
        continue;
      }
      const double truth = share(glm::vec3(0), g.normal(i)), error = std::abs(mask[i] - truth);
      const bool is_wrong = error > 1e-5;
      // Class U: the answer is another one at points moved by what coordinates, 16 * 2^-24 of them, and normals leave open.
      const float rho = 16 * 0x1p-24f * static_cast<float>(extent(scene, light, {}));
      bool is_uncertain = false;
      for (int axis = 0; axis < 3 && is_wrong; ++axis)
        for (const float sign : {-1.0f, 1.0f}) {
          glm::vec3 step(0);
          step[axis] = sign;
          is_uncertain |= std::abs(share(rho * step, g.normal(i)) - truth) > error / 4;
          is_uncertain |= std::abs(share(glm::vec3(0), g.normal(i) + 0x1p-22f * step) - truth) > error / 4;
        }
      if (is_uncertain) {
        ++uncertain;
      } else if (mask[i] == 1) {
        ++lit;
        wrong_lit += is_wrong;
      } else if (mask[i] == 0) {
        ++umbra;
        wrong_umbra += is_wrong;
      } else {
        ++penumbra;
        worst = std::max(worst, error);
      }
      if (is_wrong && !is_uncertain)
        ADD_FAILURE() << kind_name(light) << " light, pixel " << i << ": " << mask[i] << " is off by " << error;
    }
  }
};

small_world::Run run(const std::string& settings, const Scene& scene, const Light& light, const GBuffer& gbuffer) {
  return small_world::run(gnomon_technique_area_svbsp, settings, scene, light, gbuffer);
}

/// A square of side 2 at 3 m over the ground, and over its middle at 6 m a square lamp of side 1. From the ground at x along
/// the middle the square's edge at 1 is seen in line with the lamp's place 2 - x: below -1/2 and beyond 1/2 are x = 2.5
/// and 1.5.
Scene square_over_ground() {
  Scene scene;
  scene.meshes = {small_world::ground(8, 0), small_world::ground(1, 3)};
  return scene;
}

TEST(AreaSvbsp, shares_of_a_square_are_those_of_similar_triangles) {
  const Scene scene = square_over_ground();
  hand_made::Picture picture(40, 1);
  for (std::size_t i = 0; i < 40; ++i) picture.set(i, {0.1f * static_cast<float>(i), 0, 0.0625f}, {0, 1, 0}, 0, 1);
  for (std::size_t i = 0; i < 40; ++i) picture.triangle[i] = 0.1f * static_cast<float>(i) > 0.0625f ? 1 : 0;
  const auto made = run("", scene, lamp({0, 6, 0}, 0.5f, 0.5f), picture.gbuffer);
  for (std::size_t i = 0; i < 40; ++i) {
    const double x = picture.value[0][i];
    EXPECT_NEAR(made.mask[i], std::clamp(x - 1.5, 0.0, 1.0), 1e-6) << x;
    if (x < 1.49) {
      EXPECT_EQ(made.mask[i], 0) << x;
    }
    if (x > 2.51) {
      EXPECT_EQ(made.mask[i], 1) << x;
    }
  }
}

TEST(AreaSvbsp, fragments_are_as_large_as_umbra_and_penumbra) {
  // Two triangles of ground see the umbra's square of side 3 and, less that, the penumbra's of side 5 with its corners: 25 - 9.
  const Scene scene = square_over_ground();
  hand_made::Picture picture(1, 1);
  const auto made = run("", scene, lamp({0, 6, 0}, 0.5f, 0.5f), picture.gbuffer);
  const auto detail = made.technique->surface_detail();
  ASSERT_TRUE(detail);
  check_detail(scene, *detail);
  double areas[3] = {};
  for (const DetailPolygon& p : detail->polygons) {
    if (p.mesh != 0) continue;
    double area = 0;
    for (std::uint32_t k = 2; k < p.count; ++k) {
      const glm::dvec3* const c = detail->corners.data() + p.first;
      area += glm::length(glm::cross(c[k - 1] - c[0], c[k] - c[0])) / 2;
    }
    areas[p.is_lit ? 0 : p.is_penumbra ? 1 : 2] += area;
  }
  EXPECT_NEAR(areas[2], 9, 1e-4);
  EXPECT_NEAR(areas[1], 16, 1e-4);
  EXPECT_NEAR(areas[0] + areas[1] + areas[2], 256, 1e-6);
}

// Casters touch and cross the lights, lights stand inside boxes, slivers and doubled triangles are among the grid's.
TEST(AreaSvbsp, random_scenes_are_as_the_witness_sees_them) {
  Random random(41);
  std::mt19937 engine(41);
  Tally tally;
  const std::string settings[] = {"", "light_splits=0", "light_splits=4,least_width=0.0001", "fragment_size=0.05", "work=1"};
  for (int round = 0; round < 240; ++round) {
    Scene scene = any_scene(random, engine, round % 4);
    const Light light = any_light(random, round / 4 % 4);
    if (round % 3 == 0) {  // a triangle through the light's center
      const glm::vec3 at(homogeneous_of_center(light)), u(small_world::direction_of(random)),
          v(small_world::direction_of(random));
      scene.meshes.push_back(hand_made::mesh_of({at + u, at - u + v, at - u - v}, {{0, 1, 2}}));
    }
    hand_made::Picture picture(200, 28);
    scatter(scene, light, random, picture);
    tally.add(scene, light, picture, run(settings[round % 5], scene, light, picture.gbuffer).mask);
  }
  EXPECT_EQ(tally.wrong_lit, 0u) << "of " << tally.lit;
  EXPECT_EQ(tally.wrong_umbra, 0u) << "of " << tally.umbra;
  EXPECT_LT(tally.worst, 1e-5) << "of " << tally.penumbra;
  EXPECT_GT(tally.lit + tally.umbra + tally.penumbra, 1000000u);
  EXPECT_LT(tally.uncertain, 200u);
  EXPECT_GT(tally.lit, 200'000u);
  EXPECT_GT(tally.umbra, 200'000u);
  EXPECT_GT(tally.penumbra, 50'000u);
}

TEST(AreaSvbsp, a_light_that_shrinks_to_a_point_gives_the_hard_mask) {
  Random random(42);
  std::mt19937 engine(42);
  std::size_t hard = 0, dark = 0, soft = 0, differing = 0;
  for (int round = 0; round < 60; ++round) {
    const Scene scene = any_scene(random, engine, round % 2 == 0 ? 0 : 2);
    const glm::vec3 at(random.uniform(glm::dvec3(-2.5, 2.5, -2.5), glm::dvec3(2.5, 4, 2.5)));
    const Light small = lamp(at, 1e-5f, 1e-5f);
    hand_made::Picture picture(200, 10);
    scatter(scene, small, random, picture);
    const auto mask = run("", scene, small, picture.gbuffer).mask;
    const auto by_point = small_world::run(gnomon_technique_svbsp, "", scene, hand_made::point_light(at), picture.gbuffer).mask;
    for (std::size_t i = 0; i < mask.size(); ++i) {
      if (mask[i] > 0 && mask[i] < 1) {
        ++soft;
        continue;
      }
      ++hard;
      dark += mask[i] == 0;
      differing += mask[i] != by_point[i];
    }
  }
  EXPECT_EQ(differing, 0u) << "of " << hard;
  EXPECT_GT(dark, hard / 8);
  EXPECT_LT(soft, hard / 1000);
}

TEST(AreaSvbsp, what_corners_miss_falls_with_the_size_of_fragments) {
  const Scene scene = square_over_ground();
  const Light light = lamp({0.3f, 6, 0.2f}, 0.7f, 0.5f);
  const GBuffer g = small_world::make_gbuffer(scene, {.eye = {0, 14, 6}, .target = {0, 0, 0}}, 160, 120);
  const std::vector<float> truth = run("", scene, light, g).mask;
  double before = 1;
  for (const char* size : {"0.2", "0.05", "0.0125"}) {
    const auto made = run(std::string("shade=vertices,fragment_size=") + size, scene, light, g);
    double sum = 0;
    for (std::size_t i = 0; i < truth.size(); ++i) sum += std::abs(made.mask[i] - truth[i]);
    const double mean = sum / static_cast<double>(truth.size());
    EXPECT_LT(mean, before / 4) << size;  // of what is smooth, with the square of the size
    before = mean;
    RecordProperty(std::string("error_") + std::to_string(std::atof(size)), std::to_string(mean));
  }
  EXPECT_LT(before, 1e-4);
}

// What is left whole when the work is spent is clipped from every point, not interpolated over a whole polygon.
TEST(AreaSvbsp, work_that_is_spent_makes_nothing_worse) {
  Random random(43);
  Scene scene;
  scene.meshes = {small_world::ground(3, 0), hard_scenes::boxes(random, 30, false)};
  const Light light = lamp({0.3f, 6, 0.2f}, 1.5f, 1.5f);
  const GBuffer g = small_world::make_gbuffer(scene, {.eye = {0, 9, 6}, .target = {0, 0, 0}}, 96, 72);
  const std::vector<float> truth = run("", scene, light, g).mask;
  const auto error = [&](const std::vector<float>& mask) {
    double sum = 0;
    for (std::size_t i = 0; i < truth.size(); ++i) sum += std::abs(mask[i] - truth[i]);
    return sum / static_cast<double>(truth.size());
  };
  const auto all = run("shade=vertices,fragment_size=0.02,work=4096", scene, light, g),
             some = run("shade=vertices,fragment_size=0.02,work=1", scene, light, g);
  EXPECT_EQ(small_world::value(all.technique->counts(), "left_whole"), 0);
  EXPECT_GT(small_world::value(some.technique->counts(), "left_whole"), 0);
  EXPECT_LE(error(some.mask), error(all.mask));
}

TEST(AreaSvbsp, parts_of_the_light_find_the_umbra_of_two_polygons) {
  // Two squares at two heights that overlap by 0.6 m: below that neither hides all of the lamp, but each a part. Of two that
  // shared an edge the edge would always be seen before some part.
  Scene scene;
  scene.meshes = {
      small_world::ground(8, 0),
      hand_made::mesh_of({{-2, 3, -2}, {-2, 3, 2}, {0.3f, 3, 2}, {0.3f, 3, -2}}, {{0, 1, 2}, {0, 2, 3}}),
      hand_made::mesh_of({{-0.3f, 3.5f, -2}, {-0.3f, 3.5f, 2}, {2, 3.5f, 2}, {2, 3.5f, -2}}, {{0, 1, 2}, {0, 2, 3}})};
  const Light light = lamp({0, 6, 0}, 0.6f, 0.6f);
  hand_made::Picture picture(1, 1);
  const auto area_of = [&](const char* settings) {
    const auto made = run(settings, scene, light, picture.gbuffer);
    double sum = 0;
    const auto detail = made.technique->surface_detail();
    for (const DetailPolygon& p : detail->polygons)
      for (std::uint32_t k = 2; p.mesh == 0 && !p.is_lit && !p.is_penumbra && k < p.count; ++k) {
        const glm::dvec3* const c = detail->corners.data() + p.first;
        sum += glm::length(glm::cross(c[k - 1] - c[0], c[k] - c[0])) / 2;
      }
    return sum;
  };
  const double single = area_of("light_splits=0"), many = area_of("light_splits=4");
  EXPECT_GT(many, 1.01 * single) << single;
}

TEST(AreaSvbsp, what_is_beyond_its_reach_is_refused_with_the_number) {
  Registry registry;
  gnomon_technique_area_svbsp(registry);
  const auto technique = registry.techniques()[0].make();
  Scene scene = square_over_ground();
  EXPECT_EQ(technique->supports(scene, lamp({0, 6, 0}, 1, 1), {}).kind(), Support::Kind::full);
  EXPECT_FALSE(technique->supports(scene, hand_made::sun({0, -1, 0}), {}));
  // A pile of 2,000 triangles before the lamp, then of 300,000.
  const auto add = [&](int count) {
    for (int i = 0; i < count; ++i) scene.meshes[1].triangles.push_back(scene.meshes[1].triangles[0]);
  };
  add(4000);
  const Support slow = technique->supports(scene, lamp({0, 6, 0}, 1, 1), {});
  EXPECT_FALSE(slow);
  EXPECT_NE(slow.why().find("triangles stand before the light"), std::string::npos) << slow.why();
  // Whichever way receivers are wound, and whatever else there is that does not receive.
  Scene turned = scene;
  for (Mesh& mesh : turned.meshes)
    for (glm::uvec3& t : mesh.triangles) std::swap(t.y, t.z);
  EXPECT_EQ(technique->supports(turned, lamp({0, 6, 0}, 1, 1), {}).why(), slow.why());
  Scene beside = scene;
  for (int k = 0; k < 40; ++k) {
    Mesh deaf = hand_made::square(0.001f, 9);
    deaf.receives = deaf.casts = false;
    beside.meshes.insert(beside.meshes.begin() + k % 3, deaf);
  }
  EXPECT_EQ(technique->supports(beside, lamp({0, 6, 0}, 1, 1), {}).why(), slow.why());
  add(300'000);
  const Support large = technique->supports(scene, lamp({0, 6, 0}, 1, 1), {});
  EXPECT_EQ(large.why(), "304004 triangles cast; trees are grown for up to 200000");
}

}  // namespace gnomon::area_svbsp_test
