// Which pixels are uncertain behind casters with holes, and that all others are right.
#include <gnomon/error.h>
#include <gnomon/kit/geometry/exact_scene.h>
#include <gnomon/kit/geometry/holes.h>
#include <gnomon/kit/rays/gbuffer_maker.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "masked.h"
#include "measure/frame/certify.h"
#include "measure/frame/certify_soft.h"
#include "measure/frame/classify.h"
#include "small_world.h"

namespace gnomon::holes_classes_test {

using hand_made::Picture;
using masked::mask_of;

struct Classified {
  std::vector<float> reference;
  std::vector<PixelClass> classes;
};

Classified classified(const Scene& scene, const GBuffer& gbuffer, const Light& light,
                      std::span<const std::uint8_t> silhouettes = {}) {
  const RayScene casters(scene, Truth::mesh, RayScene::Which::casters);
  Classified result;
  result.reference.resize(gbuffer.size());
  trace_shadows(casters, scene, gbuffer, light, result.reference);
  result.classes = classify(scene, casters, gbuffer, light, result.reference, silhouettes);
  return result;
}

/// Points of a ground under a card, along x at z = 0.5; the light is at (0, 2, 0) above the card at height 1, so that a point's
/// way meets the card at half its x. Half the card's side is 1: of a mask of 4 columns, texels are 0.5 m wide.
struct UnderACard {
  Scene scene;
  Light light = hand_made::point_light({0, 2, 0});
  View view{.eye = {0, 8, 0}, .target = {0, 0, 0}, .up = {0, 0, -1}};

  explicit UnderACard(std::shared_ptr<const AlphaMask> mask) {
    scene.meshes = {hand_made::square(5, 0), masked::card(1, 1, std::move(mask))};
  }

  Classified at(std::span<const float> xs) const {
    Picture picture(static_cast<int>(xs.size()), 1);
    picture.gbuffer.view = view;
    for (std::size_t i = 0; i < xs.size(); ++i) picture.set(i, {xs[i], 0, 0.5f}, {0, 1, 0}, 0, xs[i] > 0.5f ? 1 : 0);
    return classified(scene, picture.gbuffer, light);
  }

  /// How far from the shadow of a texel's edge a point on the ground is uncertain, meters: the rounding in texels, a half meter
  /// each, twice as far on the ground.
  double band_at(float x) const {
    const glm::dvec3 way = glm::dvec3(0, 2, 0) - glm::dvec3(x, 0, 0.5);
    return texel_rounding(scene.meshes[1], x / 2 > 0.25f ? 1 : 0, way, extent(scene, light, view)) * 0.5 * 2;
  }
};

std::string letters(std::span<const PixelClass> classes) {
  std::string text;
  for (const PixelClass c : classes) text += class_infos()[std::size_t(c)].letter;
  return text;
}

// Columns 0 and 1 are solid, 2 and 3 are holes: of the three edges between them only the middle one has a shadow.
TEST(holes_classes, only_a_thin_band_around_the_shadow_of_an_edge_of_two_bits_is_uncertain) {
  const UnderACard card(mask_of({"##..", "##..", "##..", "##.."}));
  for (const float edge : {-1.0f, 0.0f, 1.0f}) {
    const auto band = static_cast<float>(card.band_at(edge));
    EXPECT_GT(band, 4 * 16 * 0x1p-24f * 8);  // the extent is 8
    EXPECT_LT(band, 1e-3f);
    const float xs[] = {edge - 0.3f,         edge - 1.02f * band, edge - 0.98f * band, edge,
                        edge + 0.98f * band, edge + 1.02f * band, edge + 0.3f};
    EXPECT_EQ(letters(card.at(xs).classes), edge == 0 ? "TTUUUTT" : "TTTTTTT") << edge;
  }
}

TEST(holes_classes, the_answer_changes_across_the_band) {
  const UnderACard card(mask_of({"##..", "##..", "##..", "##.."}));
  const float xs[] = {-1.5f, -0.01f, 0.01f, 1.5f};
  EXPECT_EQ(card.at(xs).reference, (std::vector<float>{0, 0, 1, 1}));
}

TEST(holes_classes, texels_of_equal_bits_make_nothing_uncertain) {
  for (const char* row : {"####", "...."}) {
    const UnderACard card(mask_of({row, row, row, row}));
    std::vector<float> xs;
    for (int k = -15; k <= 15; ++k) xs.push_back(static_cast<float>(k) / 10);
    // (0.5, 0.5) lies below the card's diagonal, which is an edge of two solid triangles.
    std::erase(xs, 0.5f);
    const Classified found = card.at(xs);
    EXPECT_EQ(letters(found.classes), std::string(xs.size(), 'T')) << row;
    EXPECT_EQ(found.reference, std::vector<float>(xs.size(), row[0] == '#' ? 0.0f : 1.0f)) << row;
  }
}

// A second card over the border, solid and wide: its answer is certain, and so is that of the pixel.
TEST(holes_classes, what_is_solid_beyond_doubt_decides) {
  UnderACard card(mask_of({"##..", "##..", "##..", "##.."}));
  const float xs[] = {-0.1f, 0, 0.1f};
  EXPECT_EQ(letters(card.at(xs).classes), "TUT");
  card.scene.meshes.push_back(hand_made::square(3, 1.5f));
  EXPECT_EQ(letters(card.at(xs).classes), "TTT");
  card.scene.meshes.back() = masked::card(3, 1.5f, mask_of({"#"}));
  EXPECT_EQ(letters(card.at(xs).classes), "TTT");
  card.scene.meshes.back() = masked::card(3, 1.5f, mask_of({"."}));
  EXPECT_EQ(letters(card.at(xs).classes), "TUT");
}

// The way from (1.5, 0, 1) to (3, 6, 2) meets the edge between columns 3 and 4 exactly.
TEST(holes_classes, the_vector_on_paper_is_uncertain_where_the_bits_differ) {
  for (const auto& [row, letter] : {std::pair("...#....", "U"), {"....#...", "U"}, {"...##...", "T"}, {"###..###", "T"}}) {
    Scene scene;
    scene.meshes = {hand_made::square(5, 0), masked::triangle_on_paper(mask_of({row}))};
    Picture picture(1, 1);
    picture.gbuffer.view.eye = {0, 6, 0};
    picture.set(0, {1.5f, 0, 1}, {0, 1, 0}, 0, 1);
    EXPECT_EQ(letters(classified(scene, picture.gbuffer, hand_made::point_light({3, 6, 2})).classes), letter) << row;
  }
}

/// A scene of cards with holes as an eye sees it, in some unit of length.
struct Grove {
  Scene scene;
  GBuffer gbuffer;
  std::vector<std::uint8_t> silhouettes;
  std::vector<Light> lights;

  Grove(Random& random, double unit, int width, int height) {
    const auto mask = masked::any_mask(random, 32);
    const auto length = static_cast<float>(unit);
    scene.meshes = {hand_made::square(4 * length, 0), masked::random_cards(random, 25, 2 * unit, unit, mask),
                    masked::card(2 * length, 2.5f * length, masked::checker(16, 16), 3)};
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

// So many pixels that one in ten thousand would be seen.
TEST(holes_classes, the_reference_is_exact_outside_the_uncertain_class) {
#ifdef __SANITIZE_ADDRESS__
  constexpr int scene_count = 3;
#else
  constexpr int scene_count = 12;
#endif
  Random random(31);
  std::size_t tested = 0, uncertain = 0, dark = 0;
  for (int s = 0; s < scene_count; ++s) {
    const Grove grove(random, std::array{1.0, 0x1p-14, 0x1p40}[s % 3], 160, 90);
    for (const Light& light : grove.lights) {
      const Classified found = classified(grove.scene, grove.gbuffer, light, grove.silhouettes);
      std::vector<float> exact(grove.gbuffer.size());
      ExactScene(grove.scene).decide(grove.gbuffer, light, exact);
      std::size_t wrong = 0;
      for (std::size_t i = 0; i < exact.size(); ++i) {
        uncertain += found.classes[i] == PixelClass::U;
        if (found.classes[i] != PixelClass::T) continue;
        ++tested;
        dark += exact[i] == 0;
        wrong += exact[i] != found.reference[i];
      }
      EXPECT_EQ(wrong, 0u) << s << ' ' << light.name;
    }
  }
  EXPECT_GT(tested, std::size_t(scene_count) * 5'000);
  EXPECT_GT(dark, tested / 20);
  EXPECT_LT(uncertain, tested / 20);
}

TEST(holes_classes, a_reference_through_holes_is_certified) {
  Random random(37);
  const Grove grove(random, 1, 120, 80);
  for (const Light& light : grove.lights) {
    const Classified found = classified(grove.scene, grove.gbuffer, light, grove.silhouettes);
    const Certificate certificate = certify(grove.scene, light, grove.gbuffer, found.reference,
                                            {.is_uncertain = [&](std::size_t i) { return found.classes[i] == PixelClass::U; }});
    EXPECT_TRUE(certificate.holds()) << text(certificate);
  }
}

// Half a card by its mask, or by its corners: the same rays are blocked.
TEST(holes_classes, a_light_with_area_is_seen_through_holes) {
  const auto soft = [](Mesh card) {
    Scene scene;
    scene.meshes = {hand_made::square(4, 0), std::move(card)};
    const Light lamp{.name = "lamp", .kind = RectLight{{0.2f, 3, 0}, {0.5f, 0, 0}, {0, 0, 0.3f}}};
    const View view{.eye = {0, 8, 0.5f}, .target = {0, 0, 0}, .up = {0, 0, -1}};
    const GBuffer gbuffer = make_gbuffer(scene, RayScene(scene, Truth::mesh, RayScene::Which::seen), view, 32, 32, Truth::mesh);
    return trace_soft(scene, RayScene(scene, Truth::mesh, RayScene::Which::casters), gbuffer, lamp, {}, {.error = 0.01});
  };
  const SoftReference by_mask = soft(masked::card(1, 1, mask_of({"#."})));
  const SoftReference by_corners =
      soft(hand_made::mesh_of({{-1, 1, -1}, {-1, 1, 1}, {0, 1, 1}, {0, 1, -1}}, {{0, 1, 2}, {0, 2, 3}}));
  int penumbra = 0;
  for (std::size_t i = 0; i < by_mask.area.size(); ++i) {
    penumbra += by_mask.area[i] > 0.05f && by_mask.area[i] < 0.95f;
    if (by_mask.classes[i] != PixelClass::T || by_corners.classes[i] != PixelClass::T) continue;
    EXPECT_NEAR(by_mask.area[i], by_corners.area[i], 0.02) << i;
  }
  EXPECT_GT(penumbra, 20);
}

// The second way of the certificate clips a light by whole triangles.
TEST(holes_classes, a_light_with_area_through_holes_is_not_certified) {
  Random random(41);
  const Grove grove(random, 1, 8, 8);
  const Light lamp{.name = "lamp", .kind = RectLight{}};
  try {
    certify_soft(grove.scene, lamp, grove.gbuffer, {});
    FAIL() << "it was certified";
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("holes"), std::string::npos) << error.what();
  }
}

}  // namespace gnomon::holes_classes_test
