// Where casters move, filtered maps filter again what these may have changed, and have the bits of a map that filters all.
#include <gnomon/kit/gl/gl.h>
#include <gtest/gtest.h>

#include "drawing_test.h"
#include "walking_world.h"

namespace filtered_tiles_test {

using namespace walking_world;
using small_world::mask_of;

class FilteredTiles : public DrawingTest {};

double value(const Technique& technique, const std::string& count) { return small_world::value(technique.counts(), count); }
double filtered(const Technique& technique) { return value(technique, "filtered"); }
double texels(const Technique& technique) { return value(technique, "texels"); }

/// Follows the row under a light, and is compared at every frame with a map that builds there, and with one that draws and
/// filters all. Returns how much of its texels it filtered in the mean, where something moved.
double expect_as_built(const std::string& id, const std::string& settings, const Light& light, const std::string& animation) {
  Row row(animation);
  const auto used = made(id, settings, row.scene), fresh = made(id, settings, row.scene);
  const auto redraw = made(id, settings + ",update=redraw", row.scene);
  used->relight(light);
  double share = 0;
  const int frames[] = {1, 2, 6, 6, 8, 3, 0};
  for (const int frame : frames) {
    const std::string where = fmt::format("{}:{} under {} at frame {}", id, settings, light.name, frame);
    row.go_to(frame);
    const GBuffer gbuffer = row.picture();
    used->update(row.scene, row.posed.take_changes());
    used->relight(light);
    const std::vector<float> mask = mask_of(*used, gbuffer);
    share += filtered(*used) / texels(*used) / static_cast<double>(std::size(frames));
    fresh->build(row.scene);
    fresh->relight(light);
    EXPECT_EQ(mask, mask_of(*fresh, gbuffer)) << where;
    EXPECT_EQ(filtered(*fresh), texels(*fresh)) << where;
    EXPECT_EQ(value(*used, "bytes"), value(*fresh, "bytes")) << where;
    redraw->build(row.scene);
    redraw->relight(light);
    EXPECT_EQ(mask, mask_of(*redraw, gbuffer)) << where << ", in one pass";
    if (frame % 3 != 0) continue;  // else the next one follows what filtered tiles
    used->relight(light);
    EXPECT_EQ(filtered(*used), texels(*used)) << where << ", relit once more";
    EXPECT_EQ(mask_of(*used, gbuffer), mask) << where << ", relit once more";
  }
  return share;
}

// From the low point light the boxes lie across several faces of the cube.
TEST_F(FilteredTiles, at_many_poses_maps_answer_as_after_a_build_and_filter_less) {
  const Light lights[] = {{.name = "sun", .kind = DirectionalLight{{0.5f, -2, 0.25f}}},
                          {.name = "low", .kind = PointLight{{0.25f, 1.75f, 2}}},
                          {.name = "spot", .kind = SpotLight{{1, 6, 1}, {-0.1f, -1, 0}, 20, 30}}};
  const std::pair<const char*, const char*> maps[] = {{"variance_map", "resolution=512"},
                                                      {"variance_map", "resolution=500,blur_radius=0"},
                                                      {"variance_map", "resolution=512,prefilter=mips"},
                                                      {"moment_map", "resolution=512,bits=16,blur_radius=7"},
                                                      {"exponential_map", "resolution=500,blur_weights=gaussian"},
                                                      {"exponential_variance_map", "resolution=512"}};
  for (const auto& [id, settings] : maps)
    for (const Light& light : lights)
      EXPECT_LT(expect_as_built(id, settings, light, "lift"), 0.75) << id << ":" << settings << " under " << light.name;
  for (const Light& light : lights)
    EXPECT_LT(expect_as_built("variance_map", "resolution=512", light, "walk"), 0.75) << "both boxes, under " << light.name;
}

TEST_F(FilteredTiles, tables_are_made_as_a_whole) {
  EXPECT_NEAR(expect_as_built("variance_map", "resolution=256,prefilter=table", Row().sun(), "lift"), 1, 1e-12);
}

TEST_F(FilteredTiles, where_nothing_moved_nothing_is_filtered) {
  Row row;
  const auto map = made("variance_map", "resolution=256", row.scene);
  map->relight(row.sun());
  row.go_to(0);
  map->update(row.scene, row.posed.take_changes());
  map->relight(row.sun());
  const GBuffer gbuffer = row.picture();
  const std::vector<float> mask = mask_of(*map, gbuffer);
  EXPECT_EQ(filtered(*map), 0);
  const auto fresh = made("variance_map", "resolution=256", row.scene);
  fresh->relight(row.sun());
  EXPECT_EQ(mask, mask_of(*fresh, gbuffer));
}

// What means are taken of may change while the layer of depths stays.
TEST_F(FilteredTiles, a_parameter_of_what_a_texel_holds_spoils_all_tiles) {
  Row row;
  const auto map = made("exponential_map", "resolution=256", row.scene);
  map->relight(row.sun());
  const double exponents[] = {40, 40, 20};
  for (int k = 0; k < 3; ++k) {
    const std::string setting = fmt::format("exponent={}", exponents[k]);
    row.go_to(k + 1);
    map->update(row.scene, row.posed.take_changes());
    map->apply(setting);
    map->relight(row.sun());
    const GBuffer gbuffer = row.picture();
    const auto fresh = made("exponential_map", "resolution=256," + setting, row.scene);
    fresh->relight(row.sun());
    EXPECT_EQ(mask_of(*map, gbuffer), mask_of(*fresh, gbuffer)) << k;
    if (k == 1)
      EXPECT_LT(filtered(*map), texels(*map));
    else
      EXPECT_EQ(filtered(*map), texels(*map)) << k;
  }
}

// Each of two lights filters what moved since it was drawn, of which the one misses an update.
TEST_F(FilteredTiles, each_light_filters_what_moved_since_its_own_drawing) {
  Row row;
  const Light evening{.name = "evening", .kind = DirectionalLight{{-2, -1, 0.25f}}};
  const auto first = made("variance_map", "resolution=512", row.scene);
  const auto guest = first->for_another_light();
  first->relight(row.sun());
  guest->relight(evening);
  for (const int frame : {2, 3, 7, 8}) {
    row.go_to(frame);
    first->update(row.scene, row.posed.take_changes());
    first->relight(row.sun());
    EXPECT_LT(filtered(*first), texels(*first)) << frame;
    if (frame == 3 || frame == 7) continue;
    guest->relight(evening);
    EXPECT_LT(filtered(*guest), texels(*guest)) << frame;
    const GBuffer gbuffer = row.picture();
    for (const auto& [map, light] : {std::pair(first.get(), &row.sun()), std::pair(guest.get(), &evening)}) {
      const auto fresh = made("variance_map", "resolution=512", row.scene);
      fresh->relight(*light);
      EXPECT_EQ(mask_of(*map, gbuffer), mask_of(*fresh, gbuffer)) << frame << " under " << light->name;
    }
  }
}

TEST_F(FilteredTiles, scenes_that_stand_still_count_nothing_of_it) {
  Row row;
  row.posed.go_to(std::nullopt);
  const auto map = made("variance_map", "resolution=256", row.scene);
  map->relight(row.sun());
  mask_of(*map, row.picture());
  for (const Count& count : map->counts()) EXPECT_NE(count.name, "filtered");
}

}  // namespace filtered_tiles_test
