// What penumbra wedges say of a light, against clipping in closed form, and their edges against ways through every triangle.
#include <gnomon/kit/geometry/exact_scene.h>
#include <gnomon/kit/geometry/shapes.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "area_lights.h"
#include "hard_scenes.h"
#include "techniques/penumbra_wedge/point_query.h"
#include "techniques/questions.h"

extern "C" void gnomon_technique_penumbra_wedge(gnomon::Registry&);
extern "C" void gnomon_technique_exact_area(gnomon::Registry&);

namespace gnomon::penumbra_wedge_test {

using namespace penumbra_wedge;
using penumbra_wedge::Outline;

/// Open and closed casters, on a grid or not: soups, boxes that lack faces or have some twice, cycles, fans, a floor.
Scene random_scene(int round, Random& random) {
  Scene scene;
  scene.meshes.push_back(hand_made::square(4, -2));
  switch (round % 4) {
    case 0:
      scene.meshes.push_back(hard_scenes::grid_soup(random, 12));
      break;
    case 1:
      scene.meshes.push_back(hard_scenes::boxes(random, 4, false));
      break;
    case 2:
      scene.meshes.push_back(hard_scenes::boxes(random, 4, true));
      break;
    default:
      scene.meshes.push_back(questions::hard_mesh(round / 4 % questions::kinds, round / 40, random));
  }
  return scene;
}

/// Points of all triangles, each side of them.
void scatter(const Scene& scene, Random& random, hand_made::Picture& picture) {
  hard_scenes::scatter(scene, {.name = "sun", .kind = DirectionalLight{glm::vec3(small_world::direction_of(random))}}, random,
                       picture);
}

/// Points of the ground, |x|, |z| <= half.
void scatter_on_ground(double half, Random& random, hand_made::Picture& picture) {
  for (std::size_t i = 0; i < picture.gbuffer.size(); ++i)
    picture.set(i, glm::vec3(random.uniform({-half, 0, -half}, {half, 0, half})), {0, 1, 0}, 0, 0);
}

std::vector<float> wedges_of(const Scene& scene, const Light& light, const GBuffer& g) {
  return small_world::run(gnomon_technique_penumbra_wedge, "", scene, light, g).mask;
}
std::vector<float> exact_of(const Scene& scene, const Light& light, const GBuffer& g) {
  return small_world::run(gnomon_technique_exact_area, "", scene, light, g).mask;
}

/// Whether the point lies exactly in the plane of a caster that is not its own: which side of it counts is open there.
bool is_in_a_plane(const Scene& scene, const Receiver& receiver) {
  for (std::uint32_t m = 0; m < scene.meshes.size(); ++m)
    for (std::uint32_t t = 0; scene.meshes[m].casts && t < scene.meshes[m].triangles.size(); ++t) {
      const Triangle corners = scene.meshes[m].corners(t);
      if (receiver.is_own(m, t) || receiver.is_coplanar(scene, corners.points)) continue;
      if (orient3d_sign(corners.points[0], corners.points[1], corners.points[2], receiver.point) == 0) return true;
    }
  return false;
}

/// A regular polygon of `corner_count` corners, in triangles that share edges.
Mesh polygon(const glm::dvec3& center, const glm::dvec3& u, const glm::dvec3& v, int corner_count) {
  std::vector<glm::vec3> corners;
  std::vector<glm::uvec3> triangles;
  for (int k = 0; k < corner_count; ++k) {
    const double angle = 2 * std::numbers::pi * k / corner_count;
    corners.emplace_back(center + std::cos(angle) * u + std::sin(angle) * v);
    if (k >= 2) triangles.emplace_back(0, k - 1, k);
  }
  return small_world::make_mesh(corners, triangles);
}

// All places of the light are on one side of the polygon's plane, so that all see the same outline: nothing is approximate.
// The witness has round lights to 1e-5.
TEST(PenumbraWedge, one_convex_polygon_hides_what_clipping_says) {
  Random random(31);
  std::size_t penumbrae = 0;
  for (int round = 0; round < 60; ++round) {
    const glm::dvec3 axis = glm::normalize(glm::dvec3(0, 1, 0) + 0.4 * small_world::direction_of(random)),
                     u = glm::normalize(glm::cross(axis, small_world::direction_of(random))), v = glm::cross(axis, u);
    Scene scene;
    scene.meshes = {
        small_world::ground(4, 0, false),
        polygon({0, 1, 0}, random.uniform(0.1, 0.6) * u, random.uniform(0.1, 0.6) * v, static_cast<int>(3 + random.below(5)))};
    hand_made::Picture picture(100, 1);
    scatter_on_ground(1.5, random, picture);
    const glm::vec3 at(random.uniform({-1, 3.5, -1}, {1, 6, 1}));
    const glm::vec3 half_u(0.8 * small_world::direction_of(random)), half_v(0.6 * small_world::direction_of(random));
    const Light light = round % 3 == 0 ? rect(at, half_u, half_v) : round % 3 == 1 ? disc(at, half_u, 0.9f) : sphere(at, 0.8f);
    const auto ours = wedges_of(scene, light, picture.gbuffer), exact = exact_of(scene, light, picture.gbuffer);
    for (std::size_t i = 0; i < ours.size(); ++i) {
      ASSERT_NEAR(ours[i], exact[i], round % 3 == 0 ? 1e-6 : 2e-5) << "round " << round << ", pixel " << i;
      penumbrae += exact[i] > 0 && exact[i] < 1;
    }
  }
  EXPECT_GT(penumbrae, 500u);
}

/// One point of the ground under casters.
float at(const glm::vec3& point, const std::vector<Mesh>& casters, const Light& light) {
  Scene scene;
  scene.meshes = {small_world::ground(4)};
  scene.meshes.insert(scene.meshes.end(), casters.begin(), casters.end());
  hand_made::Picture picture(1, 1);
  picture.set(0, point, {0, 1, 0}, 0, 0);
  return wedges_of(scene, light, picture.gbuffer)[0];
}
float at_origin(const std::vector<Mesh>& casters, const Light& light) { return at(glm::vec3(0), casters, light); }

/// The rectangle a .. b at a height.
Mesh plate(const glm::vec2& a, const glm::vec2& b, float height) {
  return small_world::make_mesh({{a.x, height, a.y}, {a.x, height, b.y}, {b.x, height, b.y}, {b.x, height, a.y}},
                                {{0, 1, 2}, {0, 2, 3}});
}

// Half of the light, a half plane at height 1 before a light at height 3 whose edge lies at d: seen from the origin, the light
// is hidden where x < 3 d.
TEST(PenumbraWedge, a_half_plane_hides_a_part_of_a_rectangle_and_a_segment_of_a_disc) {
  for (int k = -9; k <= 9; ++k) {
    const float d = static_cast<float>(k) / 27;
    const double x = 3.0 * d;  // in half sides or radii
    const Mesh half = plate({-9, -9}, {d, 9}, 1);
    EXPECT_NEAR(at_origin({half}, rect({0, 3, 0}, {1, 0, 0}, {0, 0, 1})), std::clamp((1 - x) / 2, 0.0, 1.0), 1e-6) << d;
    // The segment of the unit disc beyond a chord at x.
    const double chord = std::clamp(x, -1.0, 1.0),
                 seen = (std::acos(chord) - chord * std::sqrt(1 - chord * chord)) / std::numbers::pi;
    EXPECT_NEAR(at_origin({half}, disc({0, 3, 0}, {0, 1, 0}, 1)), seen, 1e-6) << d;
  }
}

// Each hides the half x < 0 of the light; the second lies above the first and reaches as far.
TEST(PenumbraWedge, casters_that_hide_the_same_part_add_up_and_the_cause_says_so) {
  const Light light = rect({0, 4, 0}, {1, 0, 0}, {0, 0, 1});
  const Mesh low = plate({-9, -9}, {0, 9}, 1), high = plate({-9, -9}, {0, 9}, 2), other = plate({0.25f, -9}, {9, 9}, 1);
  EXPECT_NEAR(at_origin({low}, light), 0.5, 1e-6);
  EXPECT_NEAR(at_origin({low, high}, light), 0, 1e-6);
  // x > 1 of the light's plane at height 4 is all beyond the light: nothing. Moved in, it hides its part beside the other's.
  EXPECT_NEAR(at_origin({low, other}, light), 0.5, 1e-6);
  EXPECT_NEAR(at_origin({low, plate({0.125f, -9}, {9, 9}, 1)}, light), 0.25, 1e-6);
  Scene scene;
  scene.meshes = {small_world::ground(4), low, high};
  hand_made::Picture picture(1, 1);
  picture.set(0, {0, 0, 0}, {0, 1, 0}, 0, 0);
  const auto run = small_world::run(gnomon_technique_penumbra_wedge, "", scene, light, picture.gbuffer);
  EXPECT_EQ(run.technique->explain(0)->cause, "overlapping_penumbrae");
}

// A box with its top at height 2 beneath a light at height 4 and as wide: places at the border see sides that the center does
// not see, which are beneath the outline that it sees.
TEST(PenumbraWedge, a_body_whose_outline_changes_over_the_light_has_the_cause_one_outline) {
  const Light light = rect({0, 4, 0}, {2, 0, 0}, {0, 0, 2});
  Scene scene;
  scene.meshes = {small_world::ground(8), small_world::box({-0.5f, 0.5f, -0.5f}, {0.5f, 2, 0.5f})};
  hand_made::Picture picture(64, 1);
  for (std::size_t i = 0; i < 64; ++i) picture.set(i, {static_cast<float>(i) / 32 - 1, 0, 0.1f}, {0, 1, 0}, 0, 0);
  const auto run = small_world::run(gnomon_technique_penumbra_wedge, "", scene, light, picture.gbuffer);
  const auto exact = exact_of(scene, light, picture.gbuffer);
  std::size_t wrong = 0;
  for (std::size_t i = 0; i < 64; ++i) {
    if (std::abs(run.mask[i] - exact[i]) < 0.01) continue;
    ++wrong;
    EXPECT_GT(run.mask[i], exact[i]) << i;
    EXPECT_EQ(run.technique->explain(i)->cause, "one_outline") << i;
  }
  EXPECT_GT(wrong, 5u);
}

// The outline changes over the light by an angle as wide as the light.
TEST(PenumbraWedge, the_error_of_convex_bodies_falls_with_the_size_of_the_light) {
  const auto error_of = [](float size) {
    Random random(3);
    double sum = 0;
    std::size_t count = 0;
    for (int round = 0; round < 30; ++round) {
      const glm::vec3 low(random.uniform({-0.8, 0.2, -0.8}, {-0.2, 0.6, -0.2})),
          high(random.uniform({0.2, 0.8, 0.2}, {0.8, 1.5, 0.8}));
      Scene scene;
      scene.meshes = {small_world::ground(8), small_world::box(low, high)};
      const glm::vec3 center(random.uniform({-2, 4, -2}, {2, 6, 2}));
      const Light light = round % 2 ? rect(center, {size, 0, 0}, {0, 0, size}) : sphere(center, size);
      hand_made::Picture picture(1000, 1);
      scatter_on_ground(2, random, picture);
      const auto ours = wedges_of(scene, light, picture.gbuffer), exact = exact_of(scene, light, picture.gbuffer);
      for (std::size_t i = 0; i < ours.size(); ++i) {
        if (exact[i] == 0 || exact[i] == 1) continue;
        sum += std::abs(ours[i] - exact[i]);
        ++count;
      }
    }
    EXPECT_GT(count, 30u);
    return sum / static_cast<double>(count);
  };
  const double large = error_of(1), small = error_of(0.1f), tiny = error_of(0.01f);
  RecordProperty("seen", fmt::format("{} {} {}", large, small, tiny));
  EXPECT_LT(small, large / 3);
  EXPECT_LT(tiny, small / 2);
}

// The number of layers is known at the base of a point alone; edges carry it to every place. So it must be what the way to that
// place counts, with the same surface: of open and closed meshes, layers, folds, lights in bodies, casters across lights.
TEST(PenumbraWedge, layers_by_edges_are_those_on_the_way_to_every_place) {
  Random random(17);
  std::size_t asked = 0, unsure = 0, layered = 0, crossing = 0, left_out = 0;
  for (int round = 0; round < 400; ++round) {
    const Scene scene = random_scene(round, random);
    const Light light = random_light(random);
    hand_made::Picture picture(40, 3);
    scatter(scene, random, picture);
    const Casters casters(scene);
    Outline outline;
    outline.hull = hull_of(light);
    casters.adjacency().find_silhouette(homogeneous_of_center(light), outline.silhouette);
    outline.wedges.make(casters.adjacency(), outline.silhouette, outline.hull, casters.extent());
    const auto is_part = [&](std::uint32_t t) { return outline.silhouette.facing[t] != 0; };
    casters.find_in(outline.hull.box, is_part, outline.crossing);
    const GBuffer& g = picture.gbuffer;
    for (std::size_t i = 0; i < g.size(); ++i) {
      if (!faces_light(scene, g, light, i)) continue;
      if (is_in_a_plane(scene, receiver_at(scene, g, i))) {
        ++left_out;
        continue;
      }
      const LightFigure face(light, g.position(i), g.normal(i));
      PointQuery query;
      PixelGroup group;
      group.box.add(g.position(i));
      query.start(casters, outline, group);
      const NumberedReceiver receiver = casters.numbers().numbered(receiver_at(scene, g, i));
      Tally tally;
      const double share = query.share(receiver, face, tally);
      ASSERT_TRUE(share >= 0 && share <= 1) << share;
      for (int k = 0; k < 8; ++k) {
        const glm::dvec2 place(random.uniform(-1, 1), random.uniform(-1, 1));
        if (!face.holds(place)) continue;
        std::uint32_t hint = 0xffffffffu;
        const auto layers = casters.layers(outline.silhouette, receiver, face.at(place), false, hint);
        ++asked;
        if (!layers) {
          ++unsure;
          continue;
        }
        layered += *layers != 0;
        crossing += !outline.crossing.empty();
        const bool is_alone = query.holding_count() == 0 && outline.crossing.empty();
        ASSERT_EQ(is_alone ? query.layers_at(place) != 0 : query.layers_at(place), is_alone ? *layers != 0 : *layers)
            << "round " << round << ", pixel " << i << ", " << kind_name(light) << ", place " << place.x << " " << place.y;
      }
    }
  }
  RecordProperty("seen", fmt::format("{} places, {} unsure, {} in layers, {} with casters across, {} pixels left out", asked,
                                     unsure, layered, crossing, left_out));
  EXPECT_GT(asked, 50'000u);
  EXPECT_GT(layered, asked / 20);
  EXPECT_GT(crossing, asked / 20);
  EXPECT_LT(unsure, asked / 1'000);
}

// A point behind an edge, in line with it and a place of the light, is in its wedge.
TEST(PenumbraWedge, a_wedge_holds_every_point_that_sees_its_edge_before_the_light) {
  Random random(8);
  std::size_t planes = 0, outside = 0, asked = 0;
  for (int round = 0; round < 2'000; ++round) {
    const Scene scene = random_scene(0, random);
    const Light light = random_light(random);
    const EdgeAdjacency adjacency(scene);
    Silhouette silhouette;
    adjacency.find_silhouette(homogeneous_of_center(light), silhouette);
    Wedges wedges;
    wedges.make(adjacency, silhouette, hull_of(light), scene.bounds().extent());
    for (const Wedge& wedge : wedges.all()) {
      for (const glm::dvec4& plane : wedge.planes) planes += plane != glm::dvec4(0);
      const glm::dvec3 on_edge =
          glm::mix(glm::dvec3(adjacency.positions()[wedge.low]), glm::dvec3(adjacency.positions()[wedge.high]),
                   random.below(4) ? random.uniform(0, 1) : static_cast<double>(random.below(2)));
      // Any point has the light's face that it has; a place of a sphere is one inside it.
      const LightFigure face(light, glm::dvec3(100, 50, 30), {-1, 0, 0});
      const glm::dvec3 place = glm::dvec3(100, 50, 30) + face.at({random.uniform(-0.7, 0.7), random.uniform(-0.7, 0.7)});
      const glm::dvec3 point = on_edge + random.uniform(0, 3) * (on_edge - place);
      if (extent(point) > 4) continue;
      ++asked;
      ASSERT_TRUE(wedge.holds(point)) << "round " << round;
      ASSERT_TRUE(wedge.meets(point, glm::dvec3(0)));
      outside += !wedge.holds(random.uniform(glm::dvec3(-4), glm::dvec3(4)));
    }
  }
  EXPECT_GT(asked, 10'000u);
  EXPECT_GT(planes, 2 * asked);
  EXPECT_GT(outside, asked / 2);
}

TEST(PenumbraWedge, a_light_that_shrinks_to_a_point_gives_the_hard_mask) {
  Random random(9);
  std::mt19937 engine(9);
  std::size_t asked = 0, dark = 0;
  for (int round = 0; round < 6; ++round) {
    const hard_scenes::Viewed viewed = hard_scenes::viewed(random, engine);
    const glm::vec3 where(random.uniform({-3, 2, -3}, {3, 5, 3}));
    const Light point = hand_made::point_light(where);
    const ExactScene exact(viewed.scene);
    std::vector<float> hard(viewed.gbuffer.size());
    exact.decide(viewed.gbuffer, point, hard);
    for (const float size : {1e-9f, 1e-30f})
      for (const Light& light :
           {rect(where, {size, 0, 0}, {0, size / 2, size}), disc(where, {0, -1, 0.5f}, size), sphere(where, size)}) {
        const auto ours = wedges_of(viewed.scene, light, viewed.gbuffer);
        for (std::size_t i = 0; i < hard.size(); ++i) {
          if (!faces_light(viewed.scene, viewed.gbuffer, light, i) || !faces_light(viewed.scene, viewed.gbuffer, point, i))
            continue;
          const Receiver receiver = receiver_at(viewed.scene, viewed.gbuffer, i);
          if (exact.edge_margin(receiver, homogeneous(point), 1e-7).clearance < 1e-7) continue;
          ++asked;
          dark += hard[i] == 0;
          ASSERT_EQ(ours[i], hard[i]) << "pixel " << i << ", " << kind_name(light) << " of " << size << " m";
        }
      }
  }
  EXPECT_GT(asked, 100'000u);
  EXPECT_GT(dark, asked / 10);
}

// Of a sphere in triangles no point that the whole light sees is shaded by the body behind it, however fine its triangles are.
TEST(PenumbraWedge, a_closed_body_does_not_shade_its_own_lit_side) {
  Random random(4);
  std::size_t asked = 0;
  for (int round = 0; round < 4; ++round) {
    Scene scene;
    scene.meshes = {tessellate(Sphere{{1.5f, 1.25f, -1.75f}, 0.02f}, 48, "ball")};
    hand_made::Picture picture(100, 30);
    scatter(scene, random, picture);
    const auto ours = wedges_of(scene, rect({3, 1.5f, -1.5f}, {0, 0.4f, 0.1f}, {0, 0.1f, 0.4f}), picture.gbuffer);
    const GBuffer& g = picture.gbuffer;
    for (std::size_t i = 0; i < g.size(); ++i) {
      const glm::dvec3 out = glm::dvec3(g.position(i)) - glm::dvec3(1.5f, 1.25f, -1.75f);
      if (glm::dot(out, glm::dvec3(g.normal(i))) < 0) continue;
      ++asked;
      ASSERT_GT(ours[i], 0.99f) << i;
    }
  }
  EXPECT_GT(asked, 2'000u);
}

TEST(PenumbraWedge, a_caster_in_the_plane_of_the_light_hides_nothing_and_a_hair_below_it_what_it_covers) {
  const Light level = rect({0, 3, 0}, {1, 0, 0}, {0, 0, 1});
  EXPECT_EQ(at_origin({hand_made::square(5, 3)}, level), 1);
  EXPECT_EQ(at_origin({hand_made::square(0.5f, 3)}, level), 1);
  EXPECT_EQ(at_origin({hand_made::square(5, 2.9999f)}, level), 0);
}

// From x = 1.5 the lower edge, at height 2, of a plate that stands upright in the light at x = 0.5 lies before x = 0: hidden is
// 0 .. 0.5, a quarter, where the plate ends in the light's plane. From the origin it hides the quarter 0.5 .. 0.75, whose
// places see its other side than the center does, and count as lit.
TEST(PenumbraWedge, a_caster_across_the_light_ends_in_its_plane) {
  const Light level = rect({0, 3, 0}, {1, 0, 0}, {0, 0, 1});
  const Mesh upright =
      small_world::make_mesh({{0.5f, 2, -9}, {0.5f, 2, 9}, {0.5f, 4, 9}, {0.5f, 4, -9}}, {{0, 1, 2}, {0, 2, 3}});
  EXPECT_NEAR(at({1.5f, 0, 0}, {upright}, level), 0.75, 1e-6);
  EXPECT_EQ(at_origin({upright}, level), 1);
}

// The center is below the horizon, 0.25 of the light above it; a plate hides half of that: z < 0.
TEST(PenumbraWedge, what_the_horizon_leaves_of_a_light_counts_where_its_center_is_below) {
  const Light upright = rect({3, -0.5f, 0}, {0, 1, 0}, {0, 0, 1});
  EXPECT_EQ(at_origin({}, upright), 1);
  const Mesh half =
      small_world::make_mesh({{1.5f, -1, -9}, {1.5f, -1, 0}, {1.5f, 9, 0}, {1.5f, 9, -9}}, {{0, 1, 2}, {0, 2, 3}});
  EXPECT_NEAR(at_origin({half}, upright), 0.5, 1e-6);
}

// Slivers and triangles of no area are nothing special; a copy is a second layer, and counts twice.
TEST(PenumbraWedge, degenerate_triangles_change_nothing_and_copies_count_twice) {
  const Light light = rect({0, 3, 0}, {1, 0, 0}, {0, 0, 1});
  const std::vector<glm::vec3> corners{{-1, 1, -9}, {-1, 1, 9}, {0.125f, 1, 9}, {0.125f, 1, -9}, {0.125f, 1, 0}};
  EXPECT_NEAR(at_origin({small_world::make_mesh(corners, {{0, 1, 2}, {0, 2, 3}, {3, 4, 2}, {3, 3, 2}})}, light), 0.3125, 1e-6);
  EXPECT_NEAR(at_origin({small_world::make_mesh(corners, {{0, 1, 2}, {0, 2, 3}, {0, 1, 2}, {2, 3, 0}})}, light), 0, 1e-6);
}

TEST(PenumbraWedge, refuses_lights_without_area_and_says_what_is_approximate) {
  Registry registry;
  gnomon_technique_penumbra_wedge(registry);
  const auto technique = registry.techniques()[0].make();
  EXPECT_FALSE(technique->supports({}, hand_made::point_light({0, 1, 0}), {}));
  EXPECT_TRUE(technique->supports({}, sphere({0, 1, 0}, 1), {}));
}

}  // namespace gnomon::penumbra_wedge_test
