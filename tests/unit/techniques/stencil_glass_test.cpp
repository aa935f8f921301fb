// Stencil volumes of glass: a power for each transmission, against the exact product, on paper, and at the limits.
#include <gnomon/kit/volumes/gl_volumes.h>

#include "glass_masks.h"
#include "stencil_rig.h"

namespace stencil_glass_test {
using namespace glass_masks;
using stencil_rig::TestRig;

class StencilGlass : public TestRig {};

const Light down = hand_made::sun({0, -1, 0});

float at(const std::vector<float>& mask, const GBuffer& g, const glm::vec3& place) {
  std::size_t nearest = 0;
  for (std::size_t i = 0; i < g.size(); ++i)
    if (glm::distance(g.position(i), place) < glm::distance(g.position(nearest), place)) nearest = i;
  return mask[nearest];
}

/// `count` cards of one transmission between the heights 0.5 and 2.5, larger than the view is wide at any of them.
Scene stack(int count, float transmission) {
  Scene scene = scene_of({hand_made::square(3, 0)});
  for (int k = 0; k < count; ++k)
    scene.meshes.push_back(
        unseen(glass::glass_card(1.5f, 0.5f + 2 * static_cast<float>(k) / static_cast<float>(count), transmission)));
  return scene;
}

TEST_F(StencilGlass, every_way_of_counting_agrees_with_the_exact_product_but_at_edges) {
  Random random(3);
  Agreement sum;
  for (int round = 0; round < 3; ++round) {
    Scene scene = stacks_and_nests(random, true);
    scene.meshes.push_back(
        unseen(glass::with_transmission(small_world::box({-1.6f, 0.2f, 0.4f}, {-0.4f, 0.9f, 1.6f}), glm::vec3(0.9f))));
    scene.meshes.push_back(small_world::box({-1.3f, 0.3f, 0.7f}, {-0.7f, 0.8f, 1.3f}));  // receives inside of it
    scene.meshes.push_back(unseen(glass::random_glass_cards(random, 3, 1.5f, 1, glass::constant(glm::vec3(0.5f)))));
    const GBuffer g = seen_of(scene, from_above, 120, 90);
    for (const Light& light : lights)
      for (const char* settings : {"", "extrusion=per_triangle", "finder=gpu", "finder=gpu,extrusion=per_triangle",
                                   "counter=wide", "count=zpass", "count=zpass_plus"})
        if (supports(settings, scene, light, from_above).kind() == Support::Kind::full)
          sum.add(scene, light, g, mask(settings, scene, light, g), 6);
  }
  EXPECT_GT(sum.shaded_inside, sum.tested / 20);
  EXPECT_GT(sum.dark, sum.tested / 200);
  EXPECT_EQ(sum.wrong_inside, 0);
  EXPECT_LE(sum.wrong, sum.tested / 100);
}

// Volumes around the eye are counted from there on: it looks from under two cards and a box of glass.
TEST_F(StencilGlass, the_eye_may_be_behind_glass) {
  Scene scene = scene_of({hand_made::square(3, 0), unseen(glass::glass_card(2.5f, 2, 0.5f)),
                          unseen(glass::glass_card(2.5f, 2.25f, 0.9f)), unseen(glass::glass_card(0.5f, 0.5f, 0.5f))});
  scene.meshes.push_back(unseen(glass::with_transmission(small_world::box({-1, 1, -1}, {1, 3, 1}), glm::vec3(0.75f))));
  const View view{.eye = {0.3f, 1.4f, 0.6f}, .target = {0.1f, 0, 0.1f}, .fov_y_degrees = 80};
  const GBuffer g = seen_of(scene, view, 120, 90);
  const Light light = hand_made::sun({0.1f, -1, 0.15f});
  EXPECT_EQ(supports("count=zpass", scene, light, view).why(), "the eye is inside a shadow volume, which zpass does not count");
  for (const char* settings : {"", "count=zpass_plus", "count=zpass_plus,counter=wide"}) {
    EXPECT_EQ(supports(settings, scene, light, view).kind(), Support::Kind::full) << settings;
    Agreement sum;
    sum.add(scene, light, g, mask(settings, scene, light, g));
    EXPECT_GT(sum.shaded_inside, sum.tested / 2) << settings;
    EXPECT_EQ(sum.wrong_inside, 0) << settings;
  }
}

// 0.5, 0.75 and 0.2 of the light: 0.075 behind all three, 0.375 between the last two, 0 with an opaque card before.
TEST_F(StencilGlass, a_stack_on_paper) {
  Mesh shelf = hand_made::square(0.5f, 1.5f);
  for (glm::vec3& p : shelf.positions) p.x += 1.25f;
  shelf.casts = false;
  finish(shelf);
  Scene scene = scene_of({hand_made::square(3, 0), shelf, unseen(glass::glass_card(2, 1, 0.2f)),
                          unseen(glass::glass_card(2, 2, 0.75f)), unseen(glass::glass_card(2, 3, 0.5f))});
  const GBuffer g = seen_of(scene, from_above, 120, 90);
  const std::vector<float> found = mask("", scene, down, g);
  EXPECT_LE(steps(at(found, g, {-0.5f, 0, 0.2f}), 0.075f), 4);
  EXPECT_EQ(at(found, g, {1.25f, 1.5f, 0}), 0.375f);
  scene.meshes.push_back(unseen(hand_made::square(0.75f, 2.5f)));
  const std::vector<float> blocked = mask("", scene, down, g);
  EXPECT_EQ(at(blocked, g, {-0.5f, 0, 0.2f}), 0);
  EXPECT_EQ(at(blocked, g, {1.25f, 1.5f, 0}), 0.375f);
}

// Both boxes are closed, and all of their surfaces count: 0.9^2 * 0.5^2 = 0.2025 below, 0.9 * 0.5 = 0.45 on a card inside.
TEST_F(StencilGlass, a_box_in_a_box_counts_four_surfaces) {
  Mesh card = hand_made::square(0.3f, 2);
  for (glm::vec3& p : card.positions) p.x += 0.2f;
  card.casts = false;
  finish(card);
  const Scene scene =
      scene_of({hand_made::square(3, 0), card,
                unseen(glass::with_transmission(small_world::box({-1, 1, -1}, {1, 3, 1}), glm::vec3(0.9f))),
                unseen(glass::with_transmission(small_world::box({-0.6f, 1.5f, -0.6f}, {0.6f, 2.5f, 0.6f}), glm::vec3(0.5f)))});
  const GBuffer g = seen_of(scene, from_above, 160, 120);
  const std::vector<float> found = mask("", scene, down, g);
  EXPECT_LE(steps(at(found, g, {-0.35f, 0, 0}), 0.2025f), 4);
  EXPECT_LE(steps(at(found, g, {0.2f, 2, 0}), 0.45f), 4);
  EXPECT_EQ(count("closed_parts"), 0) << "glass has no inside";
}

// A seen card of glass receives what the cards above it leave; its own triangles never count.
TEST_F(StencilGlass, glass_receives_without_its_own_triangle) {
  const Scene scene = scene_of({hand_made::square(3, 0), glass::glass_card(1.2f, 0.5f, 0.25f),
                                unseen(glass::glass_card(0.8f, 1, 0.25f)), unseen(glass::glass_card(0.5f, 2, 0.5f))});
  const GBuffer g = seen_of(scene, from_above, 160, 120);
  Agreement sum;
  for (const Light& light : lights)
    for (const char* settings : {"", "count=zpass"}) sum.add(scene, light, g, mask(settings, scene, light, g));
  EXPECT_EQ(sum.wrong_inside, 0);
  EXPECT_GT(sum.shaded_inside, sum.tested / 20);
  EXPECT_EQ(at(mask("", scene, down, g), g, {0.2f, 0.5f, 0.1f}), 0.125f);
  EXPECT_EQ(at(mask("", scene, down, g), g, {1, 0.5f, 0.1f}), 1);
}

TEST_F(StencilGlass, the_diagonal_of_a_card_counts_once) {
  const Scene scene = scene_of({hand_made::square(3, 0), unseen(glass::glass_card(1.5f, 1, 0.5f))});
  const GBuffer g = seen_of(scene, from_above, 240, 180);
  for (const Light& light : lights)
    for (const char* settings : {"", "extrusion=per_triangle"}) {
      const std::vector<float> found = mask(settings, scene, light, g);
      EXPECT_EQ(std::ranges::count(found, 0.5f) + std::ranges::count(found, 1.0f), std::ssize(found)) << settings;
      EXPECT_GT(std::ranges::count(found, 0.5f), std::ssize(found) / 20) << settings;
    }
}

// The power is rounded once, however many surfaces it counts. From 256 on eight bits would wrap.
TEST_F(StencilGlass, counts_beyond_eight_bits_are_wide) {
  for (const int surfaces : {100, 255, 256, 600}) {
    const Scene scene = stack(surfaces, 0.99f);
    const GBuffer g = seen_of(scene, from_above, 60, 45);
    const std::vector<float> found = mask("", scene, down, g);
    EXPECT_LE(steps(at(found, g, {0.2f, 0, 0.1f}), static_cast<float>(std::pow(double(0.99f), surfaces))), 1) << surfaces;
    EXPECT_EQ(count("counter_bits"), count("depth_bound") > 255 ? 32 : 8) << surfaces;
    EXPECT_GE(count("depth_bound"), surfaces);
    EXPECT_EQ(count("deepest"), surfaces);
  }
}

TEST_F(StencilGlass, powers_end_where_nothing_is_left) {
  EXPECT_EQ(powers_of(0.5f, 3), (std::vector<float>{1, 0.5f, 0.25f, 0.125f}));
  EXPECT_EQ(powers_of(0.5f, 0), std::vector<float>{1});
  // 2^-149 is the least number; half of it is rounded to even, which is 0.
  const std::vector<float> all = powers_of(0.5f, 1000);
  ASSERT_EQ(all.size(), 151u);
  EXPECT_EQ(all[149], 0x1p-149f);
  EXPECT_EQ(all[150], 0);
}

TEST_F(StencilGlass, clear_glass_is_not_there_and_black_glass_is_opaque) {
  Random random(4);
  for (int round = 0; round < 3; ++round) {
    Scene clear = stacks_and_nests(random, false);
    const Scene without = clear;
    Scene black = without, opaque = without;
    clear.meshes.push_back(unseen(glass::glass_card(1.1f, 1.7f, 1)));
    black.meshes.push_back(unseen(glass::glass_card(1.1f, 1.7f, 0)));
    opaque.meshes.push_back(unseen(hand_made::square(1.1f, 1.7f)));
    const GBuffer g = seen_of(without, from_above, 120, 90);
    for (const Light& light : lights) {
      EXPECT_EQ(mask("", clear, light, g), mask("", without, light, g)) << light.name;
      EXPECT_EQ(mask("", black, light, g), mask("", opaque, light, g)) << light.name;
    }
  }
}

// With glass out of the light's way the opaque casters are drawn as without: the same mask, and one pass more.
TEST_F(StencilGlass, glass_out_of_the_way_changes_nothing) {
  const Scene opaque =
      scene_of({hand_made::square(3, 0), small_world::box({-1, 0.5f, -1}, {0, 1, 0}), hand_made::square(0.5f, 1.5f)});
  Scene beside = opaque;
  Mesh away = glass::glass_card(0.5f, 1, 0.5f);
  for (glm::vec3& p : away.positions) p.x += 40;
  finish(away);
  beside.meshes.push_back(unseen(away));
  const GBuffer g = seen_of(opaque, from_above, 120, 90);
  for (const char* settings : {"", "finder=gpu", "counter=wide", "count=zpass"})
    for (const Light& light : lights) {
      const std::vector<float> found = mask(settings, opaque, light, g);
      const double triangles = count("triangles"), deepest = count("deepest");
      EXPECT_EQ(mask(settings, beside, light, g), found) << settings << ' ' << light.name;
      EXPECT_GT(count("triangles"), triangles);
      EXPECT_EQ(count("deepest"), deepest);
      EXPECT_GT(std::ranges::count(found, 0.0f), 50);
    }
}

// The lists of faces are those of a light: two lights that share a scene keep each its own.
TEST_F(StencilGlass, two_lights_share_a_scene) {
  Random random(6);
  const Scene scene = stacks_and_nests(random, true);
  const GBuffer g = seen_of(scene, from_above, 120, 90);
  const std::vector<float> first = mask("", scene, lights[0], g), second = mask("", scene, lights[1], g);
  Technique& owner = technique("");
  owner.build(scene);
  owner.relight(lights[0]);
  const auto guest = owner.for_another_light();
  guest->relight(lights[1]);
  VisibilityMask of_guest(g.width, g.height), of_owner(g.width, g.height);
  guest->resolve(g, of_guest);
  owner.resolve(g, of_owner);
  EXPECT_TRUE(std::ranges::equal(of_owner.read(), first));
  EXPECT_TRUE(std::ranges::equal(of_guest.read(), second));
}

TEST_F(StencilGlass, explain_names_the_glass_on_the_way) {
  const Scene scene = scene_of({hand_made::square(3, 0), unseen(glass::glass_card(1, 1, 0.5f))});
  const GBuffer g = seen_of(scene, from_above, 60, 45);
  const std::vector<float> found = mask("", scene, down, g);
  int named = 0;
  for (std::size_t i = 0; i < found.size(); ++i) {
    const auto why = technique_->explain(i);
    ASSERT_TRUE(why);
    EXPECT_EQ(why->element.has_value(), found[i] == 0.5f);
    if (why->element) named += *why->element == 2 || *why->element == 3;
  }
  EXPECT_EQ(named, std::ranges::count(found, 0.5f));
  EXPECT_GT(named, 50);
}

TEST_F(StencilGlass, what_it_cannot_count_is_refused_with_numbers) {
  Scene scene = scene_of({hand_made::square(3, 0)});
  for (int k = 1; k <= 8; ++k)
    for (int twice = 0; twice < 2; ++twice)
      scene.meshes.push_back(unseen(glass::glass_card(1, static_cast<float>(k + 10 * twice), static_cast<float>(k) / 16)));
  for (const float share : {0.0f, 1.0f}) scene.meshes.push_back(unseen(glass::glass_card(1, 9, share)));
  EXPECT_EQ(supports("", scene, down, from_above).kind(), Support::Kind::full);
  scene.meshes.push_back(unseen(glass::glass_card(1, 9.5f, 0.9f)));
  EXPECT_EQ(supports("", scene, down, from_above).why(),
            "casters have 9 transmissions, each with a count of its own; at most 8");
  Scene with_texels = scene_of({hand_made::square(3, 0), unseen(glass::glass_card(1, 1, glass::texels(2, 1, {0.25f, 0.5f})))});
  with_texels.meshes[1].name = "window";
  const Support refused = supports("", with_texels, down, from_above);
  EXPECT_EQ(refused.kind(), Support::Kind::unsupported);
  EXPECT_EQ(refused.why(), "the transmission of mesh window has texels: a stencil count is a power of one number");
  with_texels.meshes[1].casts = false;
  EXPECT_EQ(supports("", with_texels, down, from_above).kind(), Support::Kind::full);
}

}  // namespace stencil_glass_test
