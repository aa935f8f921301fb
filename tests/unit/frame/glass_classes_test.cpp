// Which pixels are uncertain behind casters that let a part of the light through, and that all others are right.
#include <gnomon/kit/geometry/exact_scene.h>
#include <gnomon/kit/rays/gbuffer_maker.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "glass.h"
#include "measure/frame/certify.h"
#include "measure/frame/classify.h"
#include "measure/frame/glass_doubt.h"
#include "small_world.h"

namespace gnomon::glass_classes_test {

using hand_made::Picture;

struct Classified {
  std::vector<float> reference;
  std::vector<PixelClass> classes;
  std::vector<std::uint8_t> surfaces;
};

Classified classified(const Scene& scene, const GBuffer& gbuffer, const Light& light,
                      std::span<const std::uint8_t> silhouettes = {}) {
  const RayScene casters(scene, Truth::mesh, RayScene::Which::casters);
  Classified result;
  result.reference.resize(gbuffer.size());
  result.surfaces.resize(gbuffer.size());
  trace_shadows(casters, scene, gbuffer, light, result.reference, result.surfaces);
  result.classes = classify(scene, casters, gbuffer, light, result.reference, silhouettes);
  return result;
}

std::string letters(std::span<const PixelClass> classes) {
  std::string text;
  for (const PixelClass c : classes) text += class_infos()[std::size_t(c)].letter;
  return text;
}

/// Points of a ground, along x at z = 0.5, below cards of side 2; the light is at (0, 2, 0), cards at height 1, so that a
/// point's way meets a card at half its x.
struct UnderCards {
  Scene scene;
  Light light = hand_made::point_light({0, 2, 0});
  explicit UnderCards(std::vector<Mesh> cards) {
    scene.meshes = {hand_made::square(5, 0)};
    for (Mesh& card : cards) scene.meshes.push_back(std::move(card));
  }
  Classified at(std::span<const float> xs) const {
    Picture picture(static_cast<int>(xs.size()), 1);
    picture.gbuffer.view = {.eye = {0, 8, 0}, .target = {0, 0, 0}, .up = {0, 0, -1}};
    for (std::size_t i = 0; i < xs.size(); ++i) picture.set(i, {xs[i], 0, 0.5f}, {0, 1, 0}, 0, xs[i] > 0.5f ? 1 : 0);
    return classified(scene, picture.gbuffer, light);
  }
};

// The extent is 8, so rho is 16 * 2^-24 * 8. The card is moved by 0.25 m: its ends have their shadows at x = -1.5 and 2.5, its
// diagonal at x = 1. The way is at an angle: its distance to the edge is less than half the distance on the ground.
TEST(glass_classes, what_passes_an_edge_by_rho_is_uncertain) {
  Mesh card = glass::glass_card(1, 1, 0.5f);
  for (glm::vec3& p : card.positions) p.x += 0.25f;
  const UnderCards under({card});
  constexpr float rho = 16 * 0x1p-24f * 8;
  const float xs[] = {-1.6f, -1.4f,          0.9f,           1,   1 + rho, 1 + 8 * rho, 1.1f, 2.5f - 8 * rho, 2.5f - rho / 2,
                      2.5f,  2.5f + rho / 2, 2.5f + 8 * rho, 2.6f};
  const Classified found = under.at(xs);
  EXPECT_EQ(letters(found.classes), "TTTUUTTTUUUTT");
  for (std::size_t i = 0; i < std::size(xs); ++i) {
    if (found.classes[i] != PixelClass::T) continue;
    const bool is_behind = xs[i] > -1.5f && xs[i] < 2.5f;
    EXPECT_EQ(found.reference[i], is_behind ? 0.5f : 1.0f) << xs[i];
    EXPECT_EQ(found.surfaces[i], is_behind ? 1 : 0) << xs[i];
  }
}

// The spec's stack: .5 * .75 * .2, and with an opaque card anywhere nothing.
TEST(glass_classes, surfaces_multiply_and_opaque_ones_end_all) {
  const auto stack = [](std::size_t count) {
    std::vector<Mesh> cards;
    const float shares[] = {0.5f, 0.75f, 0.2f};
    for (std::size_t k = 0; k < count; ++k)
      cards.push_back(glass::glass_card(1, 0.75f + 0.25f * static_cast<float>(k), shares[k]));
    return cards;
  };
  const float xs[] = {-0.7f};
  const float expected[] = {1, 0.5f, 0.375f, static_cast<float>(0.5 * 0.75 * static_cast<double>(0.2f))};
  for (std::size_t count = 0; count <= 3; ++count) {
    const Classified found = UnderCards(stack(count)).at(xs);
    EXPECT_EQ(found.reference[0], expected[count]) << count;
    EXPECT_EQ(found.surfaces[0], count);
    EXPECT_EQ(letters(found.classes), "T");
  }
  for (const float height : {0.5f, 1.1f, 1.5f}) {
    std::vector<Mesh> cards = stack(3);
    cards.push_back(hand_made::square(0.9f, height));
    const Classified found = UnderCards(std::move(cards)).at(xs);
    EXPECT_EQ(found.reference[0], 0) << height;
    EXPECT_EQ(found.surfaces[0], blocked_surfaces);
  }
}

// Two columns of texels: their border has its shadow at x = 0.
TEST(glass_classes, a_border_of_texels_is_uncertain_where_more_than_a_256th_changes) {
  const float xs[] = {-0.5f, 0, 0.3f};
  for (const auto& [left, right, expected] : {std::tuple(0.5f, 0.25f, "TUT"),
                                              {0.5f, 0.5f - 1.0f / 200, "TUT"},
                                              {0.5f, 0.5f - 1.0f / 300, "TTT"},
                                              {1.0f, 0.0f, "TUT"}}) {
    const UnderCards under({glass::glass_card(1, 1, glass::texels(2, 1, {left, right}))});
    EXPECT_EQ(letters(under.at(xs).classes), expected) << left << ' ' << right;
  }
}

// A border, an edge, and behind them glass that is opaque there.
TEST(glass_classes, what_is_opaque_beyond_doubt_decides) {
  const float xs[] = {-0.5f, 0, 0.5f, 2};
  const auto letters_with = [&](Mesh second) {
    return letters(UnderCards({glass::glass_card(1, 1, glass::texels(2, 1, {0.5f, 0.25f})), std::move(second)}).at(xs).classes);
  };
  EXPECT_EQ(letters_with(hand_made::square(0.1f, 3)), "TUUU");
  EXPECT_EQ(letters_with(hand_made::square(3, 1.25f)), "TTTT");
  EXPECT_EQ(letters_with(glass::glass_card(3, 1.25f, 0.5f)), "TUUU");
  // Its own diagonal is met where the first one's is, at x = 0.5: z = 0.5 for both.
  EXPECT_EQ(letters_with(glass::glass_card(3, 1.25f, 0.0f)), "TTUT");
}

TEST(glass_classes, what_lets_all_through_has_no_edges) {
  const float xs[] = {-0.5f, 0, 1, 2.5f};  // as above
  Mesh card = glass::glass_card(1, 1, 1);
  for (glm::vec3& p : card.positions) p.x += 0.25f;
  const Classified found = UnderCards({card}).at(xs);
  EXPECT_EQ(letters(found.classes), "TTTT");
  EXPECT_EQ(found.surfaces, std::vector<std::uint8_t>(4, 0));
}

// A ray starts beside the plane of its receiver and may meet what lies in it; by exact signs that never shades the receiver.
TEST(glass_classes, glass_in_the_plane_of_its_receiver_leaves_it_uncertain) {
  Mesh film = glass::glass_card(1, 0, 0.5f);
  const float xs[] = {-2, -0.3f, 0.2f, 2};
  EXPECT_EQ(letters(UnderCards({film}).at(xs).classes), "TUUT");
  EXPECT_EQ(letters(UnderCards({film, hand_made::square(3, 1)}).at(xs).classes), "TTTT");
}

/// Glass cards and soup of all kinds, as an eye sees the ground, a box and opaque cards through them, in some unit of length.
struct Smoke {
  Scene scene;
  GBuffer gbuffer;
  std::vector<std::uint8_t> silhouettes;
  std::vector<Light> lights;

  Smoke(Random& random, double unit, int width, int height) {
    const auto length = static_cast<float>(unit);
    Mesh masked_glass = masked::random_cards(random, 8, 2 * unit, unit, masked::any_mask(random, 16));
    masked_glass.transmission = glass::constant(glm::vec3(0.5f));
    scene.meshes = {hand_made::square(4 * length, 0), masked::random_cards(random, 6, 2 * unit, 0.6 * unit, nullptr),
                    glass::random_glass_cards(random, 20, 2 * static_cast<float>(unit), static_cast<float>(unit),
                                              glass::any_texels(random, 24)),
                    glass::random_glass_cards(random, 10, 2 * static_cast<float>(unit), static_cast<float>(unit),
                                              glass::constant(glm::vec3(0.9f))),
                    std::move(masked_glass)};
    for (std::size_t m = 2; m < scene.meshes.size(); ++m) scene.meshes[m].seen = false;
    const glm::vec3 eye(unit * random.uniform(glm::dvec3(-4, 2, 4), glm::dvec3(4, 4, 6)));
    const View view{.eye = eye, .target = {0, length / 2, 0}};
    const RayScene everything(scene, Truth::mesh, RayScene::Which::seen);
    gbuffer = make_gbuffer(scene, everything, view, width, height, Truth::mesh);
    silhouettes = find_silhouettes(everything, gbuffer);
    const glm::vec3 lamp(unit * random.uniform(glm::dvec3(-2, 3, -2), glm::dvec3(2, 5, 2)));
    const glm::vec3 between(unit * random.uniform(glm::dvec3(-1, 0.5, -1), glm::dvec3(1, 2, 1)));
    lights = {hand_made::point_light(lamp), hand_made::sun(-lamp / length), hand_made::point_light(between)};
  }
};

// Off by more than a step of float32 at no tested pixel; so many pixels that one in ten thousand would be seen.
TEST(glass_classes, the_reference_is_exact_outside_the_uncertain_class) {
#ifdef __SANITIZE_ADDRESS__
  constexpr int scene_count = 3;
#else
  constexpr int scene_count = 12;
#endif
  Random random(61);
  std::size_t tested = 0, uncertain = 0, between = 0;
  for (int s = 0; s < scene_count; ++s) {
    const Smoke smoke(random, std::array{1.0, 0x1p-14, 0x1p40}[s % 3], 160, 90);
    for (const Light& light : smoke.lights) {
      const Classified found = classified(smoke.scene, smoke.gbuffer, light, smoke.silhouettes);
      std::vector<float> exact(smoke.gbuffer.size());
      ExactScene(smoke.scene).decide(smoke.gbuffer, light, exact);
      std::size_t wrong = 0;
      for (std::size_t i = 0; i < exact.size(); ++i) {
        uncertain += found.classes[i] == PixelClass::U;
        if (found.classes[i] != PixelClass::T) continue;
        ++tested;
        between += exact[i] > 0 && exact[i] < 1;
        wrong += std::abs(exact[i] - found.reference[i]) > 0x1p-24f;
      }
      EXPECT_EQ(wrong, 0u) << s << ' ' << light.name;
    }
  }
  EXPECT_GT(tested, std::size_t(scene_count) * 5'000);
  EXPECT_GT(between, tested / 5);
  EXPECT_LT(uncertain, tested / 10);
}

TEST(glass_classes, a_reference_through_glass_is_certified) {
  Random random(67);
  const Smoke smoke(random, 1, 120, 80);
  for (const Light& light : smoke.lights) {
    const Classified found = classified(smoke.scene, smoke.gbuffer, light, smoke.silhouettes);
    const auto certificate = [&](std::span<const float> reference) {
      return certify(smoke.scene, light, smoke.gbuffer, reference,
                     {.is_uncertain = [&](std::size_t i) { return found.classes[i] == PixelClass::U; }});
    };
    const Certificate holds = certificate(found.reference);
    EXPECT_TRUE(holds.holds()) << text(holds);
    // One that forgets the last hundredth does not hold.
    std::vector<float> off = found.reference;
    for (float& share : off) share = share > 0 && share < 1 ? share * 0.99f : share;
    EXPECT_FALSE(certificate(off).holds());
  }
}

}  // namespace gnomon::glass_classes_test
