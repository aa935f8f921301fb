// Techniques for lights with area that see polygons alone, on casters with holes that are cut into polygons.
#include <gtest/gtest.h>

#include <cmath>

#include "area_lights.h"
#include "masked.h"

extern "C" {
void gnomon_technique_area_svbsp(gnomon::Registry& registry);
void gnomon_technique_penumbra_wedge(gnomon::Registry& registry);
void gnomon_technique_soft_volume(gnomon::Registry& registry);
}

namespace gnomon::soft_cut_test {

using hand_made::Picture;

struct Contender {
  const char* id;
  void (*roll)(Registry&);
  const char* settings;
  double most_off;  ///< from what is derived on paper
};
void PrintTo(const Contender& contender, std::ostream* out) { *out << contender.id; }

class SoftCut : public testing::TestWithParam<Contender> {
 protected:
  static std::vector<float> mask(const std::string& more, const Scene& scene, const Light& light, const GBuffer& gbuffer) {
    const std::string settings = GetParam().settings;
    return small_world::run(GetParam().roll, settings + (settings.empty() || more.empty() ? "" : ",") + more, scene, light,
                            gbuffer)
        .mask;
  }
  static Support support(const std::string& settings, const Scene& scene, const Light& light) {
    Registry registry;
    GetParam().roll(registry);
    const auto technique = registry.techniques()[0].make();
    technique->apply(settings);
    return technique->supports(scene, light, {});
  }
};

INSTANTIATE_TEST_SUITE_P(All, SoftCut,
                         testing::Values(Contender{"area_svbsp", gnomon_technique_area_svbsp, "", 1e-4},
                                         Contender{"penumbra_wedge", gnomon_technique_penumbra_wedge, "", 1e-4},
                                         Contender{"soft_volume", gnomon_technique_soft_volume, "samples=1024", 0.02}),
                         [](const auto& info) { return std::string(info.param.id); });

/// 16 x 12 points of the floor, mesh 0.
struct Floor : Picture {
  Floor() : Picture(16, 12) {
    for (int r = 0; r < 12; ++r)
      for (int c = 0; c < 16; ++c) {
        const auto x = static_cast<float>(-2 + (c + 0.37) / 4), z = static_cast<float>(-2 + (r + 0.61) / 3);
        set(static_cast<std::size_t>(16 * r + c), {x, 0, z}, {0, 1, 0}, 0, z > x ? 0 : 1);
      }
  }
};

const Light lamp = rect({0.1f, 3, 0.2f}, {0.4f, 0, 0}, {0, 0, 0.3f});

/// A square for each solid texel of a card that lies as masked::card does.
Mesh solid_texels(float half, float height, const AlphaMask& mask) {
  std::vector<glm::vec3> positions;
  std::vector<glm::uvec3> triangles;
  const auto at = [&](int x, int y) {
    return glm::vec3(half * (2.0f * static_cast<float>(x) / static_cast<float>(mask.width()) - 1), height,
                     half * (2.0f * static_cast<float>(y) / static_cast<float>(mask.height()) - 1));
  };
  for (int y = 0; y < mask.height(); ++y)
    for (int x = 0; x < mask.width(); ++x) {
      if (!mask.is_solid(x, y)) continue;
      const auto first = static_cast<std::uint32_t>(positions.size());
      positions.insert(positions.end(), {at(x, y), at(x, y + 1), at(x + 1, y + 1), at(x + 1, y)});
      triangles.push_back({first, first + 1, first + 2});
      triangles.push_back({first, first + 2, first + 3});
    }
  return hand_made::mesh_of(positions, triangles);
}

// The way from a floor point at x to a place of the lamp at s meets a card half as high at (x + s) / 2: solid where that is
// below 0. The lamp is from -0.3 to 0.5 along x, so what is seen of it is (0.5 + x) / 0.8, cut off at 0 and 1.
TEST_P(SoftCut, the_share_behind_half_a_card_is_that_derived_on_paper) {
  Scene scene;
  scene.meshes = {small_world::ground(3), masked::card(3, 1.5f, masked::mask_of({"#."}))};
  const Floor floor;
  const std::vector<float> found = mask("", scene, lamp, floor.gbuffer);
  for (std::size_t i = 0; i < found.size(); ++i)
    EXPECT_NEAR(found[i], std::clamp((0.5 + floor.gbuffer.px[i]) / 0.8, 0.0, 1.0), GetParam().most_off) << "pixel " << i;
}

TEST_P(SoftCut, a_card_casts_what_its_solid_texels_cast) {
  Random random(17);
  for (int round = 0; round < 4; ++round) {
    const auto holes = masked::random_mask(random, 4, 4);
    Scene scene, texels;
    scene.meshes = {small_world::ground(3), masked::card(1, 1, holes)};
    texels.meshes = {small_world::ground(3), solid_texels(1, 1, *holes)};
    const Floor floor;
    const std::vector<float> found = mask("", scene, lamp, floor.gbuffer), expected = mask("", texels, lamp, floor.gbuffer);
    int shaded = 0;
    for (std::size_t i = 0; i < found.size(); ++i) {
      EXPECT_NEAR(found[i], expected[i], GetParam().most_off) << "round " << round << ", pixel " << i;
      shaded += found[i] < 0.9f;
    }
    EXPECT_GT(shaded, 5);
  }
}

// Two cards of one mesh, the one over the other: points of the lower one see the lamp past the upper one alone, and points of
// the upper one all of it.
TEST_P(SoftCut, a_card_shades_another_one_of_its_mesh_and_never_itself) {
  Random random(19);
  const auto holes = masked::mask_of({"####", "#..#", "####"});
  Mesh low = masked::card(1, 0.5f, holes);
  const Mesh high = masked::card(1, 1, holes);
  const auto count = static_cast<std::uint32_t>(low.positions.size());
  low.positions.insert(low.positions.end(), high.positions.begin(), high.positions.end());
  low.uv.insert(low.uv.end(), high.uv.begin(), high.uv.end());
  for (const glm::uvec3& t : high.triangles) low.triangles.push_back(t + count);
  // Off the grid of float32.
  for (glm::vec3& p : low.positions) p = glm::vec3(1.1 * glm::dvec3(p) + 0.3);
  Scene scene;
  scene.meshes = {low};
  Picture picture(2, 40);
  for (std::size_t i = 0; i < 40; ++i) {
    const float x = static_cast<float>(random.uniform(-0.75, 1.35)), z = static_cast<float>(random.uniform(-0.75, 1.35));
    const std::uint32_t triangle = z > x ? 0 : 1;
    picture.set(2 * i, {x, low.positions[0].y, z}, {0, 1, 0}, 0, triangle);
    picture.set(2 * i + 1, {x, low.positions[count].y, z}, {0, 1, 0}, 0, 2 + triangle);
  }
  const std::vector<float> found = mask("", scene, lamp, picture.gbuffer);
  int shaded = 0;
  for (std::size_t i = 0; i < 40; ++i) {
    shaded += found[2 * i] < 0.5f;
    EXPECT_NEAR(found[2 * i + 1], 1, 1e-4) << "point " << i;
  }
  EXPECT_GT(shaded, 10);
}

TEST_P(SoftCut, filled_cards_and_too_many_pieces_say_so) {
  Scene scene;
  scene.meshes = {small_world::ground(3), masked::card(1, 1, masked::checker(4, 4))};
  const Support cut = support("", scene, lamp), filled = support("mask=filled", scene, lamp);
  EXPECT_TRUE(cut);
  EXPECT_EQ(cut.why().find("holes"), std::string::npos) << cut.why();
  EXPECT_EQ(filled.kind(), Support::Kind::approximate);
  EXPECT_EQ(filled.why().find("holes are filled"), 0u) << filled.why();
  EXPECT_EQ(support("mask_limit=3", scene, lamp).kind(), Support::Kind::unsupported);
}

}  // namespace gnomon::soft_cut_test
