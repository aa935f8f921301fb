#include "measure/cause/causes_taps.h"

#include <gnomon/kit/geometry/shapes.h>
#include <gtest/gtest.h>

#include "cause_world.h"

namespace causes_taps_test {

using namespace gnomon;
using namespace gnomon::cause_world;

TEST(causes, large_texels_err_along_edges_and_nowhere_else) {
  // Texels of 0.5 m; the receiver's own plane is the bias that a flat ground needs, so nothing but the edge can be wrong.
  World world(on_ground({plate(-3.1f, -0.8f, -0.9f, 1.3f, 2)}), slanted);
  const TestMap map(world.scene, world.casters, world.light, {.texel = 0.5, .bias = 0.01, .receiver_plane = true});
  world.take(map, [&](std::uint32_t i, float) { return world.point(i).y == 0; });
  EXPECT_GT(world.wrong(), 50u);
  EXPECT_EQ(world.causes(map), (Causes{{"edge_resolution", world.wrong()}}));
}

TEST(causes, an_edge_within_the_raster_s_snapping_is_an_edge_and_farther_is_not) {
  // One texel of 0.1 m. Its ray passes the shadow's edge x = 1 at 1/600 and at 1/100 texel (on the slope sqrt 2 times that):
  // moving the plate's corner by 1/512 texel explains the first, not the second.
  World world = shadow_of_two_by_two();
  const std::uint32_t outside = world.pixel(1.2, 0), inside = world.pixel(0.8, 0);
  const auto at = [&](double texels, double height) {
    return world.causes([&](std::uint32_t) { return tapped(through(1 + texels * 0.1 * std::sqrt(2.0), 0, height), 0.1); });
  };
  world.mask[outside] = 0;  // the map holds the plate
  EXPECT_EQ(at(1.0 / 600, 2), (Causes{{"edge_resolution", 1}}));
  EXPECT_EQ(at(1.0 / 100, 2), (Causes{{"unexplained", 1}})) << "there is nothing on that ray";
  world.mask = world.truth;
  world.mask[inside] = 1;  // the map holds the ground
  EXPECT_EQ(at(-1.0 / 600, 0), (Causes{{"edge_resolution", 1}}));
  EXPECT_EQ(at(-1.0 / 100, 0), (Causes{{"leak_representation", 1}}));
}

// Two taps, one in the plate's shadow and one beside it: one half, which is dark, where the reference is lit.
TEST(causes, taps_that_see_one_half_are_dark) {
  World world = shadow_of_two_by_two();
  const std::uint32_t outside = world.pixel(1.1, 0);
  world.mask[outside] = 0.5f;
  const auto why = [&](std::uint32_t) {
    Explanation why = tapped(through(0.9, 0, 2), 0.4);
    why.taps.push_back(through(1.3, 0, 0));
    for (Tap& tap : why.taps) tap.weight = 0.5;
    return why;
  };
  EXPECT_EQ(world.wrong(), 1u);
  EXPECT_EQ(world.causes(why), (Causes{{"edge_resolution", 1}}));
}

TEST(causes, a_dark_reference_without_anything_before_the_light_is_unexplained) {
  // The reference is made to say dark at a point that sees the light; the tap lies in the shadow beside it.
  World world = shadow_of_two_by_two();
  const std::uint32_t outside = world.pixel(1.2, 0);
  ASSERT_EQ(world.truth[outside], 1);
  world.truth[outside] = 0;
  EXPECT_EQ(world.causes([&](std::uint32_t) { return tapped(through(0.8, 0, 2), 0.1); }), (Causes{{"unexplained", 1}}));
}

TEST(causes, a_perfect_map_of_the_triangles_is_lit_behind_the_rim_of_the_shape) {
  // A ball of radius 1 is an eight-sided one, whose shadow ends up to 1 - cos(22.5 degrees) = 0.08 m, in the grazing
  // light 0.11 m, within the true one. Texels of 1 cm have no part in that.
  Scene scene = on_ground({tessellate(Sphere{{-2, 2, 0}, 1}, 8, "ball")});
  World world(std::move(scene), slanted, {.eye = {0, 10, 0}, .target = {0, 0, 0}, .up = {0, 0, -1}}, Truth::shape);
  const RayScene triangles(world.scene, Truth::mesh, RayScene::Which::casters);
  const TestMap map(world.scene, triangles, world.light, {.texel = 0.01, .bias = 0.001, .receiver_plane = true});
  world.take(map, [&](std::uint32_t i, float) { return world.gbuffer.mesh[i] == 0; });
  EXPECT_GT(world.wrong(), 10u);
  EXPECT_EQ(world.causes(map), (Causes{{"edge_resolution", world.wrong()}}));
}

TEST(causes, a_moved_look_up_that_crosses_an_edge_is_a_lookup_shift) {
  // Pixels 0.4 m off the shadow's edge x = 1, looked up 0.8 m away on the other side of it.
  World world = shadow_of_two_by_two();
  const std::uint32_t outside = world.pixel(1.4, 0), inside = world.pixel(0.6, 0);
  const auto looked_up = [&](std::uint32_t i, double offset, double height, bool is_shifted) {
    return world.causes([&](std::uint32_t) {
      Explanation why = tapped(through(world.point(i).x + offset, 0, height), 0.02);
      // Any point of the tap's ray: it meets the plane where the tap does.
      if (is_shifted) why.shifted = world.point(i) + glm::dvec3(offset - 0.1, 0.1, 0);
      return why;
    });
  };
  world.mask[outside] = 0;
  EXPECT_EQ(looked_up(outside, -0.8, 2, true), (Causes{{"lookup_shift", 1}}));
  // The same tap without a shift is one of a map of such texels.
  EXPECT_EQ(looked_up(outside, -0.8, 2, false), (Causes{{"edge_resolution", 1}}));
  world.mask = world.truth;
  world.mask[inside] = 1;
  EXPECT_EQ(looked_up(inside, 0.8, 0, true), (Causes{{"lookup_shift", 1}}));
  EXPECT_EQ(looked_up(inside, 0.8, 0, false), (Causes{{"edge_resolution", 1}}));
  // A shift that stays on its side explains nothing.
  EXPECT_EQ(looked_up(inside, 0.2, 0, true), (Causes{{"leak_representation", 1}}));
}

TEST(causes, without_bias_a_slope_shadows_itself) {
  for (const glm::vec3 direction : {glm::vec3(1, -1, 0), glm::vec3(3, -1, 1), glm::vec3(0.2f, -1, -0.4f)})
    for (const int radius : {0, 1, 2}) {
      World world(on_ground({}), hand_made::sun(direction));
      const TestMap map(world.scene, world.casters, world.light, {.texel = 0.3, .bias = 0, .radius = radius});
      world.take(map);
      EXPECT_GT(world.wrong(), 500u);
      EXPECT_EQ(world.causes(map), (Causes{{"acne", world.wrong()}}));
    }
}

TEST(causes, acne_reaches_two_diagonals_above_the_tap_s_place_on_a_receiver_that_faces_the_light) {
  // The receiver's mesh has a bump beside the point. With the light straight above, texel width w and one tap half a diagonal
  // aside, the reference ignores what is up to 2 sqrt(2) w above the tap's place: the bump at 2.8 w, 0.7 w aside, lies 2.89 w
  // from the point, which is more than the 2.83 w of (k + 1) * 2 sqrt(2) * w / (N.L). A bump of another mesh there is
  // over-dark.
  constexpr double w = 0.1, edge = 1.05, high = 2.8 * w;
  for (const bool is_own : {true, false}) {
    Scene scene = on_ground({});
    const Mesh bump = plate(edge, 2, -1, 1, static_cast<float>(high));
    if (is_own) {
      Mesh& ground = scene.meshes[0];
      for (const glm::uvec3& t : bump.triangles) ground.triangles.push_back(t + static_cast<unsigned>(ground.positions.size()));
      ground.positions.insert(ground.positions.end(), bump.positions.begin(), bump.positions.end());
      finish(ground);
    } else {
      scene.meshes.push_back(bump);
    }
    World world(std::move(scene));
    // One that is no neighbor of the bump's silhouette: two pixels from it.
    const std::uint32_t i = world.pixel(edge - 0.3, 0.3);
    ASSERT_EQ(world.point(i).y, 0);
    ASSERT_EQ(world.classes[i], PixelClass::T);
    world.mask[i] = 0;
    // A texel as wide as to reach below the bump from there.
    const double wide = (edge + 0.02 - world.point(i).x) / 0.7;
    const auto why = [&](std::uint32_t) {
      return tapped({{edge + 0.02, 20, world.point(i).z}, {0, -1, 0}, 1, 20 - high}, wide);
    };
    EXPECT_EQ(world.causes(why), (Causes{{is_own ? "acne" : "over_dark", 1}}));
  }
}

TEST(causes, acne_ends_where_the_filter_does) {
  // One tap, its place on the receiver's own plane. The reach is at most (k + 1/2) sqrt(2) w / (N.L) + 2 sqrt(2) w with k = 0,
  // w = 0.1 and N.L = 1 / sqrt(2): 0.38 m from the point. What a tap holds 2 m away is not the point's own surface.
  World world(on_ground({}), slanted);
  const std::uint32_t i = world.pixel(1.2, 0.3);
  ASSERT_EQ(world.classes[i], PixelClass::T);
  world.mask[i] = 0;
  const auto held_at = [&](double aside) {
    return world.causes([&](std::uint32_t) { return tapped(through(world.point(i).x + aside, world.point(i).z, 0), 0.1); });
  };
  EXPECT_EQ(held_at(0.05), (Causes{{"acne", 1}}));
  EXPECT_EQ(held_at(2), (Causes{{"unexplained", 1}}));
}

TEST(causes, a_stored_surface_is_found_within_the_raster_s_snapping_of_the_tap_s_ray) {
  // Three taps around a lit point. The ray of the first passes the plate's edge at 1/600 texel and holds the plate, the second
  // holds what is nowhere, the third nothing. With the edge snapped over the first a perfect map is still lit by more than
  // half, so that it is what the map holds that is at fault: the plate, another object than the ground.
  World world = shadow_of_two_by_two();
  const std::uint32_t i = world.pixel(1.2, 0);
  world.mask[i] = 0.45f;
  const auto with_first = [&](double texels) {
    return world.causes([&](std::uint32_t) {
      Explanation why = tapped(through(1 + texels * 0.1 * std::sqrt(2.0), 0, 2), 0.1);
      why.taps.push_back(through(1.3, 0, 1));
      why.taps.push_back(through(1.2, 0, -INFINITY));
      for (int j = 0; const double weight : {0.45, 0.1, 0.45}) why.taps[j++].weight = weight;
      return why;
    });
  };
  EXPECT_EQ(with_first(1.0 / 600), (Causes{{"over_dark", 1}}));
  EXPECT_EQ(with_first(10), (Causes{{"unexplained", 1}})) << "nothing is there";
}

TEST(causes, another_object_within_two_diagonals_that_a_texel_smears_is_over_dark) {
  // A plate lower than one texel above the ground: the reference ignores it from the taps' places, the map does not.
  std::uint64_t all = 0;
  for (const float end : {1.0f, 1.1f, 1.2f, 1.3f}) {
    World world(on_ground({plate(-1.03f, end, -0.92f, 1.11f, 0.3f)}), slanted);
    const TestMap map(world.scene, world.casters, world.light, {.texel = 0.4, .bias = 0.01, .receiver_plane = true});
    world.take(map, [&](std::uint32_t i, float answer) { return world.point(i).y == 0 && answer < world.truth[i]; });
    all += world.wrong();
    Causes expected{{"over_dark", world.wrong()}};
    if (world.wrong() == 0) expected.clear();
    EXPECT_EQ(world.causes(map), expected);
  }
  EXPECT_GT(all, 20u);
}

TEST(causes, what_is_nearer_than_the_bias_is_peter_panned) {
  World world = behind_a_screen();
  const TestMap map(world.scene, world.casters, world.light, {.texel = 0.02, .bias = 0.5});
  // Away from the edges of the shadow, and farther than the two diagonals that the reference ignores.
  world.take(map, [&](std::uint32_t i, float) {
    const glm::dvec3 p = world.point(i);
    return p.y == 0 && p.x > 0.1 && p.x < 2.5 && std::abs(p.z) < 2.5;
  });
  EXPECT_GT(world.wrong(), 50u);
  EXPECT_EQ(world.causes(map), (Causes{{"peter_panning", world.wrong()}}));
}

TEST(causes, a_near_caster_skipped_over_a_far_one_that_misses_the_tap_leaks) {
  // A near plate at height 0.5 and a far one at 2: along the ray 0.71 and 2.83 away. The bias is 0.6, two diagonals are 0.28.
  const auto shadows = [](float near_begin, float near_end, float far_begin, float far_end) {
    return World(
        on_ground({plate(near_begin - 0.5f, near_end - 0.5f, -2, 2, 0.5f), plate(far_begin - 2, far_end - 2, -2, 2, 2)}),
        slanted);
  };
  const auto account = [](double x, double bias) {
    return [=](std::uint32_t) { return tapped(through(x, 0.2, 0.5), 0.1, bias); };
  };
  const auto flip = [](World& world) {
    const std::uint32_t i = world.pixel(2.3, 0.2);
    ASSERT_EQ(world.truth[i], 0);
    ASSERT_EQ(world.classes[i], PixelClass::T);
    world.mask[i] = 1;
  };
  // The near one covers point and tap, the far one the point alone.
  World both = shadows(-1, 2.5f, 0, 2.37f);
  flip(both);
  EXPECT_EQ(both.causes(account(2.4, 0.6)), (Causes{{"leak_layered", 1}}));
  // The near one covers the tap alone, the far one the point alone: what covers the tap was skipped, too.
  World apart = shadows(-1, 2.2f, 2.2f, 3);
  flip(apart);
  EXPECT_EQ(apart.causes(account(2.15, 0.6)), (Causes{{"leak_layered", 1}}));
  // With a bias that does not reach the near one, the map held it and did not believe it.
  EXPECT_EQ(apart.causes(account(2.15, 0.1)), (Causes{{"leak_representation", 1}}));
}

TEST(causes, light_where_the_taps_are_in_shadow_is_a_leak_of_the_representation) {
  World world = behind_a_screen();
  const std::uint32_t i = world.pixel(1.5, 0);
  ASSERT_EQ(world.truth[i], 0);
  world.mask[i] = 1;
  const glm::dvec3 p = world.point(i), direction = glm::normalize(glm::dvec3(1, -1, 0));
  // The map holds the screen, 1.5 sqrt(2) before the point; the bias reaches 0.1.
  EXPECT_EQ(world.causes([&](std::uint32_t) {
    return tapped({p - 5.0 * direction, direction, 1, 5 - 1.5 * std::sqrt(2.0)}, 0.02, 0.1);
  }),
            (Causes{{"leak_representation", 1}}));
}

}  // namespace causes_taps_test
