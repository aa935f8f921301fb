// Stencil volumes of casters with holes, cut into polygons, against the exact oracle, which looks up masks.
#include <gnomon/kit/rays/gbuffer_maker.h>

#include "masked.h"
#include "stencil_rig.h"

namespace stencil_cut_test {
using namespace stencil_rig;

class StencilCut : public TestRig {
 protected:
  static GBuffer seen_of(const Scene& scene, const View& view) {
    return gnomon::make_gbuffer(scene, RayScene(scene, Truth::mesh, RayScene::Which::seen), view, 120, 80, Truth::mesh);
  }
  static Scene random_scene(Random& random) {
    const int width = 1 + static_cast<int>(random.below(16)), height = 1 + static_cast<int>(random.below(16));
    const auto wrap = [&] { return masked::wraps[random.below(3)]; };
    const auto wrap_u = wrap(), wrap_v = wrap();
    return scene_of({small_world::ground(5, -2),
                     masked::random_cards(random, 3, 2, 2, masked::random_mask(random, width, height, wrap_u, wrap_v)),
                     masked::card(1, 1.5f, masked::random_mask(random, 16, 16))});
  }
};

const View from_aside{.eye = {5, 6, 7}, .target = {0, 0.5f, 0}};

TEST_F(StencilCut, every_way_of_counting_is_wrong_by_the_rasterizers_rounding_alone) {
  Random random(13);
  Tally tally;
  for (int round = 0; round < 6; ++round) {
    const Scene scene = random_scene(random);
    const GBuffer g = seen_of(scene, from_aside);
    const Light light = round % 2 ? Light{.name = "sun", .kind = DirectionalLight{{0.4f, -1, 0.3f}}}
                                  : Light{.name = "point", .kind = PointLight{{1.1f, 5, 0.6f}}};
    const Exact exact(scene, g, light);
    for (const char* settings : {"", "extrusion=per_triangle", "finder=gpu", "count=zpass"})
      if (supports(settings, scene, light, from_aside).kind() == Support::Kind::full)
        tally.add(exact, mask(settings, scene, light, g));
  }
  EXPECT_GT(tally.dark, tally.tested / 20);
  EXPECT_LE(tally.wrong, tally.tested / 50);
  // A pixel beside a hole may show what is behind the card, whose answer is that of no neighbor.
  EXPECT_LE(tally.unexplained, 3);
}

// The depth of the picture is that of the pieces, which tie with their own light caps. At the border of a hole the rasterizer's
// rounding decides whether the depth of the card is there.
TEST_F(StencilCut, a_flat_card_is_lit_all_over) {
  Random random(7);
  for (int round = 0; round < 4; ++round) {
    Scene scene = scene_of({masked::card(2, 0.125f, masked::random_mask(random, 24, 24))});
    for (glm::vec3& p : scene.meshes[0].positions) p.y += 0.25f * p.x - 0.125f * p.z;
    const GBuffer g = seen_of(scene, from_aside);
    const std::vector<float> found = mask("", scene, {.name = "sun", .kind = DirectionalLight{{-0.3f, -1, 0.2f}}}, g);
    EXPECT_LE(std::ranges::count(found, 0.0f), std::ssize(found) / 100) << "round " << round;
  }
}

TEST_F(StencilCut, explain_names_a_triangle_of_the_scene) {
  const Scene scene =
      scene_of({small_world::ground(4), masked::card(1, 1, masked::checker(8, 8)), hand_made::square(0.25f, 2)});
  const GBuffer g = seen_of(scene, from_aside);
  const Light light{.name = "sun", .kind = DirectionalLight{{0, -1, 0}}};
  const std::vector<float> found = mask("", scene, light, g);
  int by_card = 0;
  for (std::size_t i = 0; i < found.size(); ++i) {
    if (found[i] != 0) continue;
    const auto why = technique_->explain(i);
    if (!why || !why->element) continue;
    ASSERT_LT(*why->element, 6u);
    by_card += *why->element == 2 || *why->element == 3;
  }
  EXPECT_GT(by_card, 50);
}

TEST_F(StencilCut, filled_cards_and_too_many_pieces_say_so) {
  const Scene scene = scene_of({small_world::ground(4), masked::card(1, 1, masked::checker(8, 8))});
  const Light light{.name = "sun", .kind = DirectionalLight{{0, -1, 0}}};
  const Support filled = supports("mask=filled", scene, light, from_aside);
  EXPECT_EQ(filled.kind(), Support::Kind::approximate);
  EXPECT_EQ(filled.why(), "holes are filled");
  EXPECT_EQ(supports("mask_limit=3", scene, light, from_aside).kind(), Support::Kind::unsupported);
  EXPECT_EQ(supports("", scene, light, from_aside).kind(), Support::Kind::full);
}

}  // namespace stencil_cut_test
