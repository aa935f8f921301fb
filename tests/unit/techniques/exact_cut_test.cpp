// Techniques that see polygons alone, on casters with holes that are cut into polygons: lights without area, against the exact
// oracle, which looks up masks.
#include <gnomon/kit/geometry/cut_masks.h>
#include <gnomon/kit/geometry/exact_scene.h>
#include <gnomon/kit/rays/gbuffer_maker.h>
#include <gtest/gtest.h>

#include "masked.h"
#include "measure/frame/classify.h"
#include "small_world.h"

extern "C" {
void gnomon_technique_svbsp(gnomon::Registry& registry);
void gnomon_technique_two_pass_object(gnomon::Registry& registry);
}

namespace gnomon::exact_cut_test {

using hand_made::Picture;

struct Contender {
  const char* id;
  void (*roll)(Registry&);
  std::vector<std::string> settings;
};
void PrintTo(const Contender& contender, std::ostream* out) { *out << contender.id; }

class ExactCut : public testing::TestWithParam<Contender> {
 protected:
  static std::unique_ptr<Technique> made(const std::string& settings) {
    Registry registry;
    GetParam().roll(registry);
    auto technique = registry.techniques()[0].make();
    technique->apply(settings);
    return technique;
  }
  static std::vector<float> mask(const std::string& settings, const Scene& scene, const Light& light, const GBuffer& gbuffer) {
    return small_world::run(GetParam().roll, settings, scene, light, gbuffer).mask;
  }
};

INSTANTIATE_TEST_SUITE_P(All, ExactCut,
                         testing::Values(Contender{"svbsp", gnomon_technique_svbsp, {"", "order=face_planes"}},
                                         Contender{"two_pass_object", gnomon_technique_two_pass_object, {""}}),
                         [](const auto& info) { return std::string(info.param.id); });

const View from_aside{.eye = {5, 6, 7}, .target = {0, 0.5f, 0}};

GBuffer seen_of(const Scene& scene, int width, int height) {
  return make_gbuffer(scene, RayScene(scene, Truth::mesh, RayScene::Which::seen), from_aside, width, height, Truth::mesh);
}

// The point (1,0,1) sees the light (3,6,2) through (5/3, 2, 4/3) of the triangle: 8 x 8 texels a hole, 4 x 4 solid.
TEST_P(ExactCut, the_texel_is_that_derived_on_paper) {
  Picture picture(1, 1);
  picture.set(0, {1, 0, 1}, {0, 1, 0}, 0, 1);
  for (const int side : {8, 4}) {
    Scene scene;
    scene.meshes = {hand_made::square(6, 0), masked::triangle_on_paper(masked::checker(side, side))};
    for (const std::string& settings : GetParam().settings)
      EXPECT_EQ(mask(settings, scene, hand_made::point_light({3, 6, 2}), picture.gbuffer)[0], side == 8 ? 1 : 0) << settings;
  }
}

// A card casts on other triangles, never on itself or on what lies in its plane: rounding of its pieces makes no shadow.
TEST_P(ExactCut, a_flat_card_is_lit_all_over) {
  Random random(7);
  for (int round = 0; round < 8; ++round) {
    Scene scene;
    scene.meshes = {masked::card(2, 0.125f, masked::random_mask(random, 24, 24))};
    for (glm::vec3& p : scene.meshes[0].positions) p.y += 0.25f * p.x - 0.125f * p.z;
    const GBuffer seen = seen_of(scene, 96, 64);
    for (const Light& light : {hand_made::sun({-0.3f, -1, 0.2f}), hand_made::point_light({1.3f, 3, 0.7f})})
      for (const std::string& settings : GetParam().settings) {
        const std::vector<float> found = mask(settings, scene, light, seen);
        EXPECT_EQ(std::ranges::count(found, 1.0f), std::ssize(found)) << "round " << round << ", " << light.name << settings;
      }
  }
}

TEST_P(ExactCut, random_cards_are_wrong_at_no_tested_pixel) {
  Random random(11);
  std::size_t asked = 0, tested = 0, dark = 0, differing = 0, wrong = 0;
  for (int round = 0; round < 12; ++round) {
    const int width = 1 + static_cast<int>(random.below(24)), height = 1 + static_cast<int>(random.below(24));
    Scene scene;
    scene.meshes = {hand_made::square(5, -2),
                    masked::random_cards(random, 3, 2, 2,
                                         masked::random_mask(random, width, height, masked::wraps[random.below(3)],
                                                             masked::wraps[random.below(3)])),
                    masked::card(1, 1.5f, masked::random_mask(random, 32, 32), 2)};
    const GBuffer seen = seen_of(scene, 120, 80);
    const Light light = round % 2 ? hand_made::sun({0.4f, -1, 0.3f}) : hand_made::point_light({1.1f, 5, 0.6f});
    const RayScene casters(scene, Truth::mesh, RayScene::Which::casters);
    std::vector<float> truth(seen.size());
    ExactScene(scene).decide(seen, light, truth);
    const std::vector<PixelClass> classes = classify(scene, casters, seen, light, truth, {});
    for (const std::string& settings : GetParam().settings) {
      const std::vector<float> found = mask(settings, scene, light, seen);
      for (std::size_t i = 0; i < found.size(); ++i) {
        if (!faces_light(scene, seen, light, i)) continue;
        ++asked;
        dark += truth[i] == 0;
        differing += found[i] != truth[i];
        if (classes[i] != PixelClass::T) continue;
        ++tested;
        if (found[i] != truth[i] && wrong++ == 0) ADD_FAILURE() << "round " << round << ", pixel " << i << ' ' << settings;
      }
    }
  }
  EXPECT_EQ(wrong, 0u);
  EXPECT_LE(differing, asked / 1000);
  EXPECT_GT(tested, asked / 4);
  EXPECT_GT(dark, asked / 20);
  RecordProperty("seen", fmt::format("{} pixels, {} of T, {} dark, {} differ, {} of T", asked, tested, dark, differing, wrong));
}

TEST_P(ExactCut, what_explain_names_is_a_triangle_of_the_scene) {
  Scene scene;
  scene.meshes = {hand_made::square(4, 0), masked::card(1, 1, masked::checker(8, 8)), hand_made::square(0.25f, 2)};
  const GBuffer seen = seen_of(scene, 96, 64);
  const small_world::Run run = small_world::run(GetParam().roll, "", scene, hand_made::sun({0, -1, 0}), seen);
  int by_card = 0;
  for (std::size_t i = 0; i < run.mask.size(); ++i) {
    const auto why = run.technique->explain(i);
    if (!why || !why->element) continue;
    ASSERT_LT(*why->element, 6u);
    EXPECT_GE(*why->element, 2u);
    by_card += *why->element < 4;
  }
  EXPECT_GT(by_card, 50);
}

TEST_P(ExactCut, a_filled_card_casts_its_outline_and_says_so) {
  Scene scene;
  scene.meshes = {hand_made::square(4, 0), masked::card(1, 1, masked::checker(8, 8))};
  const Light light = hand_made::sun({0, -1, 0});
  Picture picture(8, 1);
  for (std::size_t i = 0; i < 8; ++i) {
    const float x = -0.9f + 0.25f * static_cast<float>(i);
    picture.set(i, {x, 0, 0.1f}, {0, 1, 0}, 0, 0.1f > x ? 0 : 1);
  }
  const std::vector<float> filled = mask("mask=filled", scene, light, picture.gbuffer);
  EXPECT_EQ(filled, std::vector<float>(8, 0));
  const std::vector<float> cut = mask("", scene, light, picture.gbuffer);
  for (std::size_t i = 0; i < 8; ++i) EXPECT_EQ(cut[i], i % 2 == 0 ? 0 : 1) << i;
  const Support support = made("mask=filled")->supports(scene, light, from_aside);
  EXPECT_EQ(support.kind(), Support::Kind::approximate);
  EXPECT_EQ(support.why(), "holes are filled");
  EXPECT_EQ(made("")->supports(scene, light, from_aside).kind(), Support::Kind::full);
}

TEST_P(ExactCut, more_pieces_than_the_limit_are_unsupported_with_their_number) {
  Scene scene;
  scene.meshes = {hand_made::square(4, 0), masked::card(1, 1, masked::checker(8, 8), 10)};
  const auto support = [&](const std::string& settings) {
    return made(settings)->supports(scene, hand_made::sun({0, -1, 0}), from_aside);
  };
  const std::size_t pieces = cut_count(scene, 1'000'000).pieces;
  EXPECT_EQ(support(fmt::format("mask_limit={}", pieces)).kind(), Support::Kind::full);
  const Support refused = support(fmt::format("mask_limit={}", pieces - 1));
  EXPECT_EQ(refused.kind(), Support::Kind::unsupported);
  EXPECT_NE(refused.why().find(fmt::format("{} polygons; mask_limit allows {}", pieces, pieces - 1)), std::string::npos)
      << refused.why();
  EXPECT_TRUE(support("mask=filled,mask_limit=1"));
}

}  // namespace gnomon::exact_cut_test
