// Projected shadows of glass: products against the exact ones, each surface once, and what the artefacts make of them.
#include "glass_masks.h"
#include "planar_rig.h"

namespace planar_glass_test {
using namespace glass_masks;

class PlanarGlass : public planar_rig::PlanarProjected {
 protected:
  static std::vector<float> mask(const Scene& scene, const Light& light, const GBuffer& g, const std::string& settings = "") {
    return run(scene, light, g, settings).mask;
  }
  /// At the pixel that shows the ground nearest to a place.
  static float at(const std::vector<float>& mask, const GBuffer& g, const glm::dvec2& place) {
    std::size_t nearest = 0;
    const auto apart = [&](std::size_t i) { return glm::distance(glm::dvec2(g.px[i], g.pz[i]), place); };
    for (std::size_t i = 0; i < g.size(); ++i)
      if (g.mesh[i] == 0 && apart(i) < apart(nearest)) nearest = i;
    return mask[nearest];
  }
};

std::shared_ptr<const Transmission> random_texels(Random& random) {
  std::vector<float> values;
  for (int i = 0; i < 16; ++i) values.push_back(glass::shares[random.below(glass::shares.size() - 1)]);
  const masked::Wrap wrap = masked::wraps[random.below(3)];
  return glass::texels(4, 4, std::move(values), wrap, wrap);
}

const Light down = hand_made::sun({0, -1, 0});

TEST_F(PlanarGlass, stacks_and_nests_agree_with_the_exact_product_but_at_edges) {
  Random random(5);
  Agreement sum;
  for (int round = 0; round < 6; ++round) {
    Scene scene = stacks_and_nests(random, true);
    Mesh outer = small_world::box({-1.6f, 0.2f, 0.4f}, {-0.4f, 0.9f, 1.6f}),
         inner = small_world::box({-1.3f, 0.3f, 0.7f}, {-0.7f, 0.8f, 1.3f});
    scene.meshes.push_back(unseen(glass::with_transmission(outer, glm::vec3(0.9f))));
    scene.meshes.push_back(unseen(glass::with_transmission(inner, glm::vec3(0.5f))));
    const GBuffer g = seen_of(scene, from_above, 160, 120);
    for (const Light& light : lights) sum.add(scene, light, g, mask(scene, light, g));
  }
  EXPECT_GT(sum.shaded_inside, sum.tested / 20);
  EXPECT_GT(sum.dark, sum.tested / 200);
  EXPECT_EQ(sum.wrong_inside, 0);
  EXPECT_LE(sum.wrong, sum.tested / 500);
}

// u and v are seen in perspective: a leaning card is nearer to the light at one end. Texels of 4 x 4 over 2.4 m, of which none
// is clear: the card's border, where rounding may take the texel of the other end, is a jump all around.
TEST_F(PlanarGlass, texels_lie_where_the_card_has_them) {
  Random random(8);
  for (const char* settings : {"", "unclipped=true"}) {
    Agreement sum;
    for (int round = 0; round < 4; ++round) {
      Mesh card = glass::glass_card(1.2f, 1.3f, random_texels(random), round % 2 ? 1.0f : -1.5f);
      for (glm::vec3& p : card.positions) p.y += 0.6f * p.x - 0.2f * p.z;
      finish(card);
      const Scene scene = scene_of({hand_made::square(4, 0), unseen(card)});
      const GBuffer g = seen_of(scene, from_above, 160, 120);
      for (const Light& light : lights) sum.add(scene, light, g, mask(scene, light, g, settings));
    }
    EXPECT_GT(sum.shaded_inside, sum.tested / 20) << settings;
    EXPECT_EQ(sum.wrong_inside, 0) << settings;
    EXPECT_LE(sum.wrong, sum.tested / 500) << settings;
  }
}

// Depths 0.2, 0.5, 0.7 of the way let 0.5, 0.75, 0.2 through: 0.075 of all three, 0.375 of the first two.
TEST_F(PlanarGlass, a_stack_on_paper) {
  const Scene scene = scene_of({hand_made::square(3, 0), unseen(glass::glass_card(1, 1, 0.2f)),
                                unseen(glass::glass_card(1.5f, 2, 0.75f)), unseen(glass::glass_card(1.5f, 3, 0.5f))});
  const GBuffer g = seen_of(scene, from_above, 120, 90);
  const std::vector<float> found = mask(scene, down, g);
  EXPECT_LE(steps(at(found, g, {0.3, 0.2}), 0.075f), 3);
  EXPECT_EQ(at(found, g, {1.25, 0.2}), 0.375f);
  EXPECT_EQ(at(found, g, {1.8, 0.2}), 1);
  Scene blocked = scene;
  blocked.meshes.push_back(unseen(hand_made::square(0.5f, 1.5f)));
  EXPECT_EQ(at(mask(blocked, down, g), g, {0.3, 0.2}), 0);
}

// Two surfaces of 0.9 and two of 0.5: 0.9^2 * 0.5^2 = 0.2025. Beside the inner box 0.81.
TEST_F(PlanarGlass, a_box_in_a_box_counts_four_surfaces) {
  const Scene scene = scene_of(
      {hand_made::square(3, 0), unseen(glass::with_transmission(small_world::box({-1, 1, -1}, {1, 3, 1}), glm::vec3(0.9f))),
       unseen(glass::with_transmission(small_world::box({-0.5f, 1.5f, -0.5f}, {0.5f, 2.5f, 0.5f}), glm::vec3(0.5f)))});
  const GBuffer g = seen_of(scene, from_above, 120, 90);
  const std::vector<float> found = mask(scene, down, g);
  EXPECT_LE(steps(at(found, g, {0.1, 0.2}), 0.2025f), 4);
  EXPECT_LE(steps(at(found, g, {0.75, 0.2}), 0.81f), 2);
}

// Of 0.5 and a quarter where a pixel were drawn twice. The card dips into the ground, so that it is clipped, and is cut into
// many triangles.
TEST_F(PlanarGlass, a_pixel_on_the_edge_of_two_triangles_counts_once) {
  std::vector<glm::vec3> positions;
  std::vector<glm::uvec3> triangles;
  constexpr std::uint32_t count = 12;
  for (std::uint32_t i = 0; i <= count; ++i)
    for (std::uint32_t k = 0; k <= count; ++k) {
      const float x = 3 * (float(i) / count - 0.5f), z = 3 * (float(k) / count - 0.5f);
      positions.emplace_back(x, 0.7f + 0.7f * x - 0.1f * z, z);
      const std::uint32_t first = i * (count + 1) + k;
      if (i == count || k == count) continue;
      triangles.push_back({first, first + 1, first + count + 2});
      triangles.push_back({first, first + count + 2, first + count + 1});
    }
  const Mesh card = unseen(glass::with_transmission(hand_made::mesh_of(positions, triangles), glm::vec3(0.5f)));
  const Scene scene = scene_of({hand_made::square(4, 0), card});
  const GBuffer g = seen_of(scene, from_above, 320, 240);
  for (const Light& light : lights) {
    const std::vector<float> found = mask(scene, light, g);
    EXPECT_EQ(std::ranges::count(found, 0.5f) + std::ranges::count(found, 1.0f), std::ssize(found)) << light.name;
    EXPECT_GT(std::ranges::count(found, 0.5f), std::ssize(found) / 20) << light.name;
  }
}

TEST_F(PlanarGlass, clear_glass_is_not_there_and_black_glass_is_opaque) {
  Random random(9);
  for (int round = 0; round < 3; ++round) {
    Scene scene = stacks_and_nests(random, false), without = scene, black = scene, opaque = scene;
    scene.meshes.push_back(unseen(glass::glass_card(1.1f, 1.7f, 1)));
    black.meshes.push_back(unseen(glass::glass_card(1.1f, 1.7f, 0)));
    opaque.meshes.push_back(unseen(hand_made::square(1.1f, 1.7f)));
    const GBuffer g = seen_of(without, from_above, 120, 90);
    for (const Light& light : lights) {
      EXPECT_EQ(mask(scene, light, g), mask(without, light, g)) << light.name;
      EXPECT_EQ(mask(black, light, g), mask(opaque, light, g)) << light.name;
    }
  }
}

// A scene without glass is drawn with and without the artefacts as ever: its masks are those of opaque casters beside which
// glass lies out of the light's way.
TEST_F(PlanarGlass, glass_out_of_the_way_changes_nothing) {
  const Scene opaque = scene_of(
      {hand_made::square(3, 0), unseen(small_world::box({-1, 0.5f, -1}, {0, 1, 0})), unseen(hand_made::square(0.5f, 1.5f))});
  Scene beside = opaque;
  beside.meshes.push_back(unseen(glass::glass_card(0.5f, 1, 0.5f)));
  for (glm::vec3& p : beside.meshes.back().positions) p.x += 40;
  finish(beside.meshes.back());
  const GBuffer g = seen_of(opaque, from_above, 120, 90);
  for (const char* settings : {"", "double_blend=true", "unclipped=true"})
    for (const Light& light : lights) {
      const std::vector<float> found = mask(opaque, light, g, settings);
      EXPECT_EQ(found, mask(beside, light, g, settings)) << settings << ' ' << light.name;
      EXPECT_LT(std::ranges::count(found, 1.0f), std::ssize(found) * 97 / 100);
    }
}

// Under the plate and the glass of 0.25: 0.5 * 0.25, where the truth is 0. Under glass alone the two agree.
TEST_F(PlanarGlass, double_blend_halves_opaque_triangles_alone) {
  const Scene scene =
      scene_of({hand_made::square(3, 0), unseen(hand_made::square(0.5f, 1)), unseen(glass::glass_card(1, 2, 0.25f))});
  const GBuffer g = seen_of(scene, from_above, 120, 90);
  const small_world::Run blended = run(scene, down, g, "double_blend=true");
  EXPECT_EQ(at(blended.mask, g, {0.2, 0.1}), 0.125f);
  EXPECT_EQ(at(blended.mask, g, {0.8, 0.1}), 0.25f);
  int differs = 0;
  for (std::size_t i = 0; i < g.size(); ++i) {
    const auto why = blended.technique->explain(i);
    if (!why->formula_differs) continue;
    ++differs;
    EXPECT_EQ(blended.mask[i], 0.125f);
  }
  EXPECT_GT(differs, 100);
}

}  // namespace planar_glass_test
