// Radiosity of surfaces with holes: what goes through them is not handed on.
#include <gtest/gtest.h>

#include <numbers>

#include "device/context.h"
#include "masked.h"
#include "small_world.h"
#include "techniques/radiosity/lighting.h"

namespace gnomon::radiosity_holes_test {

class RadiosityHoles : public testing::Test {
 protected:
  RadiosityHoles() { process_context(); }
};

/// A closed box 2 m wide around the origin's upper side, with a level card in its middle that hides the most of the floor from
/// a lamp below the ceiling.
Scene room_with_card(std::shared_ptr<const AlphaMask> mask) {
  Scene scene;
  scene.meshes = {small_world::box({-1, 0, -1}, {1, 2, 1}), masked::card(0.75f, 1, std::move(mask))};
  for (Mesh& mesh : scene.meshes) mesh.albedo = glm::vec3(0.7f);
  return scene;
}
const Light lamp{
    .name = "lamp",
    .kind = RectLight{.center = {0.1f, 1.9f, 0.2f}, .half_u = {0.3f, 0, 0}, .half_v = {0, 0, 0.3f}, .emits = Emits::in_front}};

/// Of the card's patches, each half as long as the card.
std::vector<float> solid_shares_of_card(std::shared_ptr<const AlphaMask> mask) {
  const Scene scene = room_with_card(std::move(mask));
  radiosity::Surfaces surfaces;
  surfaces.build(scene, 0.75 / 2);
  std::vector<float> shares;
  for (std::size_t p = 0; p < surfaces.patches->patch_count(); ++p) {
    if (surfaces.patches->face_of(surfaces.patches->elements()[p]).mesh == 1) {
      shares.push_back(static_cast<float>(surfaces.solid_share(p)));
    } else {
      EXPECT_EQ(surfaces.solid_share(p), 1) << "patch " << p << " of the room";
    }
  }
  return shares;
}

TEST_F(RadiosityHoles, a_patch_hands_on_as_much_as_it_is_solid) {
  EXPECT_EQ(solid_shares_of_card(nullptr), (std::vector<float>{1, 1, 1, 1}));
  EXPECT_EQ(solid_shares_of_card(masked::checker(4, 4)), (std::vector<float>{0.5f, 0.5f, 0.5f, 0.5f}));
  std::vector<float> quarters = solid_shares_of_card(masked::mask_of({"#.", ".."}));
  std::ranges::sort(quarters);
  EXPECT_EQ(quarters, (std::vector<float>{0, 0, 0, 1}));
}

// In a closed room all light is absorbed in the end, through holes as well: light that goes through a hole counts where it
// comes to, not at the card. Counted at both, more than 1.1 of it would be absorbed or lost.
TEST_F(RadiosityHoles, no_light_is_made_or_lost_in_a_room) {
  for (const int texels : {1, 2, 4, 16}) {
    const Scene scene = room_with_card(texels == 1 ? nullptr : masked::checker(texels, texels));
    radiosity::Surfaces surfaces;
    surfaces.build(scene, 0.125);
    const radiosity::Lighting lighting(surfaces, lamp,
                                       {.form_factor = radiosity::FormFactor::contour,
                                        .patch_size = 0.25,
                                        .samples = 64,
                                        .levels = 0,
                                        .contrast = 0.05,
                                        .bounces = radiosity::Bounces::all,
                                        .rest = 2e-3},
                                       nullptr);
    const radiosity::Ledger& ledger = lighting.ledger();
    const double emitted = std::numbers::pi * 4 * 0.3 * 0.3;
    EXPECT_NEAR(ledger.emitted.x, emitted, 1e-6);
    EXPECT_EQ(ledger.escaped.x, 0) << texels;
    EXPECT_LT(std::abs(ledger.defect.x) / emitted, 0.06) << texels;
    EXPECT_NEAR(ledger.absorbed.x / emitted, 1, 0.06) << texels;
  }
}

}  // namespace gnomon::radiosity_holes_test
