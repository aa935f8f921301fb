// Parameter glass of the techniques that draw depth maps: at which pixels it is the cause of an error.
#include <gnomon/kit/area/light_points.h>
#include <gnomon/kit/maps/map_causes.h>

#include "glass_maps_rig.h"
#include "measure/cause/own_causes.h"

namespace glass_maps_causes_test {
using namespace glass_maps_rig;

class GlassMapsCauses : public TestRig {};

// By the oracle of the scene and of what the rule makes of it. A map that answers what is taken is wrong at just these pixels;
// those of its own edges are few.
TEST_F(GlassMapsCauses, the_cause_holds_where_the_product_differs_from_what_is_taken) {
  const Scene scene = glass_over_ground();
  const GBuffer gbuffer = picture(scene);
  for (const Light& light : {sun, point}) {
    const std::vector<float> truth = decided(scene, light, gbuffer);
    for (const Rule& rule : rules) {
      const std::vector<float> taken = decided(taken_for(rule.as, scene), light, gbuffer);
      for (const char* id : hard_homes) {
        const auto map = run(id, rule.setting(), scene, light, gbuffer);
        int named = 0, misnamed = 0, unnamed_glass = 0, wrong = 0;
        for (std::size_t i = 0; i < gbuffer.size(); ++i) {
          if (!faces_light(scene, gbuffer, light, i)) continue;
          const bool differs = std::abs(truth[i] - taken[i]) > 1.0f / 20;
          misnamed += cause(*map.technique, i) != (differs ? "no_product" : "");
          named += differs;
          unnamed_glass += !differs && truth[i] != taken[i];
          wrong += differs && std::abs(map.mask[i] - truth[i]) > 1.0f / 20;
        }
        EXPECT_EQ(misnamed, 0) << id << ' ' << rule.value << ' ' << light.name;
        EXPECT_GT(named, 300) << id << ' ' << rule.value << ' ' << light.name;
        EXPECT_GT(wrong, 0.8 * named) << id << ' ' << rule.value << ' ' << light.name;
        EXPECT_GT(unnamed_glass, 20) << id << ' ' << rule.value << ' ' << light.name;
      }
    }
  }
}

// Images hold what casts: none is drawn where glass is the only caster, and a small one where a card casts elsewhere. Pixels
// behind glass that is left out count as covered all the same.
TEST_F(GlassMapsCauses, a_pixel_behind_glass_that_is_left_out_is_covered) {
  for (const bool has_card : {false, true}) {
    Scene scene = sheet_over_ground(0.5f);
    scene.meshes[0].casts = false;
    if (has_card) scene.meshes.push_back(moved(hand_made::square(0.2f, 0.5f), {-2.5f, 0, -2.5f}));
    const GBuffer gbuffer = picture(scene);
    const std::vector<float> truth = decided(scene, sun, gbuffer);
    for (const char* id : hard_homes) {
      const auto map = run(id, "glass=none", scene, sun, gbuffer);
      int behind = 0, wrong = 0;
      for (std::size_t i = 0; i < gbuffer.size(); ++i) {
        if (truth[i] != 0.5f) continue;
        const auto why = map.technique->explain(i);
        wrong += !why || !why->covered || why->cause != "no_product";
        ++behind;
      }
      EXPECT_EQ(wrong, 0) << id << ' ' << has_card;
      EXPECT_GT(behind, 500);
    }
  }
}

// The rule about holes comes second, and has a part where it changes the answer by more than 1/16, as truths have shares.
TEST_F(GlassMapsCauses, causes_of_holes_come_after_those_of_glass) {
  Random random(5);
  std::vector<std::uint8_t> alpha;
  for (int i = 0; i < 256; ++i) alpha.push_back(static_cast<std::uint8_t>(random.below(256)));
  Scene scene = sheet_over_ground(0.5f);
  scene.meshes.push_back(moved(masked::card(1, 0.5f, std::make_shared<const AlphaMask>(16, 16, alpha)), {0.8f, 0, 0.2f}));
  const GBuffer gbuffer = picture(scene);
  const std::vector<float> truth = decided(scene, sun, gbuffer), taken = decided(taken_for(GlassAs::none, scene), sun, gbuffer);
  for (const char* id : {"shadow_map", "variance_map"}) {
    const std::string filter = id == std::string_view("shadow_map") ? ",filter=pcf" : "";
    const auto hashed = run(id, "glass=none,alpha=hashed" + filter, scene, sun, gbuffer),
               by_texel = run(id, "glass=none" + filter, scene, sun, gbuffer);
    int misnamed = 0, of_holes = 0, on_one_side = 0;
    for (std::size_t i = 0; i < gbuffer.size(); ++i) {
      if (!faces_light(scene, gbuffer, sun, i)) continue;
      const float a = hashed.mask[i], b = by_texel.mask[i];
      const bool differs = std::abs(a - b) > 1.0f / 16;
      const std::string found = cause(*hashed.technique, i);
      if (std::abs(truth[i] - taken[i]) > 1.0f / 20) {
        misnamed += found != "no_product";
      } else {
        misnamed += found != (differs ? "hashed_threshold" : "");
        of_holes += differs;
        on_one_side += differs && (a > 0.5f) == (b > 0.5f);
      }
    }
    EXPECT_EQ(misnamed, 0) << id;
    EXPECT_GT(of_holes, 100) << id;
    EXPECT_GT(on_one_side, 20) << id;
  }
}

// Means over the lamp: of 256 points here and of sixteen there. Where they differ by 1/5 both tell; where none of the 256 meets
// glass, one of the sixteen may, which is less than 1/20 of the light with 0.5 / 16.
TEST_F(GlassMapsCauses, under_a_lamp_means_over_its_points_count) {
  const Scene scene = sheet_over_ground(0.5f);
  const GBuffer gbuffer = picture(scene);
  const ExactScene exact(scene);
  const std::vector<glm::vec3> points = light_points(lamp, "stratified", 256, 1);
  for (const Rule& rule : rules) {
    const auto search = run(soft_maps[0], rule.setting(), scene, lamp, gbuffer),
               patches = run(soft_maps[1], rule.setting(), scene, lamp, gbuffer);
    int far_off = 0, right = 0;
    for (std::size_t i = 0; i < gbuffer.size(); i += 7) {
      if (!faces_light(scene, gbuffer, lamp, i)) continue;
      ExactTally tally;
      int behind = 0;
      for (const glm::vec3& p : points)
        behind += exact.transmitted(receiver_at(scene, gbuffer, i), glm::dvec4(p, 1), tally).light.surfaces;
      const double error = 0.5 * behind / double(points.size());  // of both rules
      if (error > 0 && error < 0.2) continue;
      (error > 0 ? far_off : right) += 1;
      for (const auto* map : {&search, &patches})
        EXPECT_EQ(cause(*map->technique, i), error > 0 ? "no_product" : "") << rule.value << ' ' << i;
    }
    EXPECT_GT(far_off, 100);
    EXPECT_GT(right, 100);
  }
}

TEST_F(GlassMapsCauses, the_next_scene_and_another_light_are_explained_by_themselves) {
  const Scene glass = glass_over_ground(), opaque = taken_for(GlassAs::opaque, glass);
  const GBuffer with_glass = picture(glass), without = picture(opaque);
  const auto named = [&](const Technique& technique) {
    int count = 0;
    for (std::size_t i = 0; i < with_glass.size(); i += 5) count += cause(technique, i) == "no_product";
    return count;
  };
  for (const char* id : hard_homes) {
    auto map = run(id, "", glass, sun, with_glass);
    const int of_sun = named(*map.technique);
    EXPECT_GT(of_sun, 50) << id;
    small_world::Run other{map.technique->for_another_light(), {}};
    answer(other, point, with_glass);
    EXPECT_EQ(named(*other.technique), named(*run(id, "", glass, point, with_glass).technique)) << id;
    EXPECT_EQ(named(*map.technique), of_sun) << id;
    map.technique->build(opaque);
    answer(map, sun, without);
    EXPECT_EQ(named(*map.technique), 0) << id;
    map.technique->build(glass);
    answer(map, sun, with_glass);
    EXPECT_EQ(named(*map.technique), of_sun) << id;
  }
}

TEST_F(GlassMapsCauses, all_causes_are_allowed_in_every_data_sheet) {
  EXPECT_NO_THROW(check_own_causes(registry().techniques()));
  for (const char* id : maps) EXPECT_EQ(registry().technique(id).about.causes.size(), std::size(map_causes)) << id;
}

}  // namespace glass_maps_causes_test
