// Where some casters move, a virtual map keeps pages that none of these touches: which it draws after an update, and that its
// answers are those of a fresh one.
#include <gnomon/kit/gl/gl.h>
#include <gtest/gtest.h>

#include "drawing_test.h"
#include "masked.h"
#include "walking_world.h"

namespace virtual_map_update_test {
using namespace walking_world;
using small_world::mask_of;
using small_world::value;

class VirtualMapUpdate : public DrawingTest {};

/// With pictures of 160 pixels across: how many pages are needed depends on them.
struct Row : walking_world::Row {
  explicit Row(std::string animation = "lift", Scene with = walking_scene(), int width = 160)
      : walking_world::Row(std::move(animation), std::move(with), width) {}
};

constexpr const char* plain = "texels_per_pixel=4,page_size=64";

double drawn(const Technique& technique) { return value(technique.counts(), "pages_drawn"); }
double pages(const Technique& technique) { return value(technique.counts(), "pages"); }
/// A scene in which pages stay counts them.
bool counts_drawn(const Technique& technique) {
  return std::ranges::any_of(technique.counts(), [](const Count& count) { return count.name == "pages_drawn"; });
}

/// What a fresh object answers and counts.
struct Fresh {
  std::unique_ptr<Technique> technique;
  std::vector<float> mask;
  Fresh(const std::string& settings, const Scene& scene, const Light& light, const GBuffer& gbuffer)
      : technique(made("virtual_map", settings, scene)) {
    technique->relight(light);
    mask = mask_of(*technique, gbuffer);
  }
};

/// All counts of two objects are the same.
void expect_same_counts(const Technique& a, const Technique& b, const std::string& where) {
  const Counts mine = a.counts(), others = b.counts();
  ASSERT_EQ(mine.size(), others.size()) << where;
  for (std::size_t k = 0; k < mine.size(); ++k) EXPECT_EQ(mine[k].value, others[k].value) << where << ' ' << mine[k].name;
}

/// Every picture after an update has the bits of a fresh object's; the first resolve keeps pages, the second one none.
/// Answers the mean share of pages that the first ones drew.
double expect_as_built(const std::string& settings, const Light& light, Row row,
                       const std::vector<int>& frames = {1, 2, 3, 8, 8, 4, 0}) {
  double share = 0;
  const auto map = made("virtual_map", settings, row.scene);
  map->relight(light);
  mask_of(*map, row.picture());
  for (const int frame : frames) {
    const std::string where = fmt::format("{} under {} at frame {} of {}", settings, light.name, frame, row.animation);
    row.go_to(frame);
    const GBuffer gbuffer = row.picture();
    map->update(row.scene, row.posed.take_changes());
    map->relight(light);
    const Fresh fresh(settings, row.scene, light, gbuffer);
    EXPECT_EQ(mask_of(*map, gbuffer), fresh.mask) << where;
    EXPECT_EQ(value(map->counts(), "bytes"), value(fresh.technique->counts(), "bytes")) << where;
    EXPECT_EQ(pages(*map), pages(*fresh.technique)) << where;
    share += drawn(*map) / pages(*map) / double(frames.size());
    if (frame % 2 == 0) continue;
    EXPECT_EQ(mask_of(*map, gbuffer), fresh.mask) << where << ", once more";
    expect_same_counts(*map, *fresh.technique, where);
    map->relight(light);
    EXPECT_EQ(mask_of(*map, gbuffer), fresh.mask) << where << ", relit once more";
    expect_same_counts(*map, *fresh.technique, where);
  }
  return share;
}

TEST_F(VirtualMapUpdate, after_updates_its_answers_have_the_bits_of_a_fresh_object) {
  const Scene scene = walking_scene();
  std::vector<Light> lights = scene.lights;
  lights.push_back({.name = "low", .kind = PointLight{{0.25f, 1.75f, 2}}});
  lights.push_back({.name = "spot", .kind = SpotLight{{1, 6, 1}, {-0.1f, -1, 0}, 20, 30}});
  for (const Light& light : lights)
    for (const std::string& animation : {std::string("lift"), std::string("walk")}) {
      const double share = expect_as_built(plain, light, Row(animation));
      EXPECT_LT(share, 0.9) << light.name << ' ' << animation;
      expect_as_built("texels_per_pixel=8,page_size=256", light, Row(animation), {1, 4});
    }
}

// Of more pages than there is room for levels are raised, in some frames.
TEST_F(VirtualMapUpdate, where_there_is_little_room_too) {
  for (const int room : {6, 40, 100})
    expect_as_built(fmt::format("{},pages={}", plain, room), walking_scene().lights[1], Row("walk"));
}

// A layer has room for 256 pages of 256 texels.
TEST_F(VirtualMapUpdate, in_a_pool_of_several_layers_too) {
  const std::string settings = "texels_per_pixel=16,page_size=256";
  const Row first("walk", walking_scene(), 224);
  EXPECT_GT(pages(*Fresh(settings, first.scene, first.sun(), first.picture()).technique), 256);
  EXPECT_LT(expect_as_built(settings, first.sun(), Row("walk", walking_scene(), 224), {1, 2}), 1);
}

TEST_F(VirtualMapUpdate, a_caster_that_moves_out_of_sight_of_pages_spoils_few) {
  Row row;
  const GBuffer gbuffer = row.picture();
  const auto map = made("virtual_map", plain, row.scene);
  map->relight(row.sun());
  mask_of(*map, gbuffer);
  EXPECT_EQ(drawn(*map), pages(*map)) << "at first all are drawn";
  row.go_to(1);
  map->update(row.scene, row.posed.take_changes());
  map->relight(row.sun());
  mask_of(*map, gbuffer);
  EXPECT_GT(drawn(*map), 0);
  EXPECT_LT(drawn(*map), 0.5 * pages(*map));
}

TEST_F(VirtualMapUpdate, another_light_another_rule_and_another_build_draw_all_pages) {
  Scene with_holes = walking_scene();
  Mesh& box = with_holes.meshes[1];
  box.alpha_mask = masked::checker(4, 4);
  for (const glm::vec3& p : box.positions) box.uv.emplace_back(p.x, p.z);
  Row row("lift", std::move(with_holes));
  const GBuffer gbuffer = row.picture();
  const auto map = made("virtual_map", plain, row.scene);
  int frame = 0;
  const auto step = [&](const std::function<void()>& between) {
    map->relight(row.sun());
    mask_of(*map, gbuffer);
    row.go_to(++frame % 9);
    map->update(row.scene, row.posed.take_changes());
    between();
    map->relight(row.sun());
    EXPECT_EQ(mask_of(*map, gbuffer), Fresh(map->settings(), row.scene, row.sun(), gbuffer).mask) << frame;
    return drawn(*map) == pages(*map);
  };
  EXPECT_FALSE(step([] {}));
  EXPECT_TRUE(step([&] { map->relight(row.scene.lights[0]); }));
  EXPECT_TRUE(step([&] { map->relight(row.sun()); })) << "the relight that repeats one does its whole work";
  EXPECT_TRUE(step([&] { map->build(row.scene); }));
  EXPECT_TRUE(step([&] { map->apply("alpha=mips"); }));
  EXPECT_FALSE(step([] {}));
}

// What was drawn before two updates is still right where no caster moves.
TEST_F(VirtualMapUpdate, several_updates_before_a_resolve_spoil_nothing) {
  Row row("walk");
  const auto map = made("virtual_map", plain, row.scene);
  map->relight(row.sun());
  mask_of(*map, row.picture());
  for (const int frame : {3, 5}) {
    row.go_to(frame);
    map->update(row.scene, row.posed.take_changes());
    map->relight(row.sun());
  }
  const GBuffer gbuffer = row.picture();
  EXPECT_EQ(mask_of(*map, gbuffer), Fresh(plain, row.scene, row.sun(), gbuffer).mask);
  EXPECT_LT(drawn(*map), pages(*map));
}

// Only the first of two objects is told of the update. At frame 0 the point light's pages fill a row of the pool less.
TEST_F(VirtualMapUpdate, each_light_keeps_pages_of_its_own) {
  Row row;
  const auto first = made("virtual_map", plain, row.scene);
  const auto guest = first->for_another_light();
  const auto answer = [&](Technique& technique, const Light& light) {
    const GBuffer gbuffer = row.picture();
    technique.relight(light);
    EXPECT_EQ(mask_of(technique, gbuffer), Fresh(plain, row.scene, light, gbuffer).mask) << light.name;
  };
  for (const int frame : {0, 1, 2, 4}) {
    row.go_to(frame);
    first->update(row.scene, row.posed.take_changes());
    answer(*first, row.sun());
    answer(*guest, row.scene.lights[0]);
    EXPECT_EQ(drawn(*first) < pages(*first), frame > 0);
    EXPECT_EQ(drawn(*guest) < pages(*guest), frame > 1);
  }
}

TEST_F(VirtualMapUpdate, where_nothing_moves_and_where_all_does_there_is_nothing_to_keep) {
  Row none;
  none.posed.go_to(std::nullopt);
  EXPECT_FALSE(counts_drawn(*Fresh(plain, none.scene, none.sun(), none.picture()).technique));
  Scene boxes = walking_scene();
  boxes.meshes[0].casts = false;
  const Row all("walk", std::move(boxes));
  EXPECT_FALSE(counts_drawn(*Fresh(plain, all.scene, all.sun(), all.picture()).technique));
  const Row some;
  EXPECT_TRUE(counts_drawn(*Fresh(plain, some.scene, some.sun(), some.picture()).technique));
}

// Questions about a picture draw no pages into the pool that the next picture keeps.
TEST_F(VirtualMapUpdate, questions_spoil_nothing) {
  Row row;
  const auto map = made("virtual_map", plain, row.scene);
  for (const int frame : {0, 2, 4}) {
    row.go_to(frame);
    map->update(row.scene, row.posed.take_changes());
    map->relight(row.sun());
    const GBuffer gbuffer = row.picture();
    const Fresh fresh(plain, row.scene, row.sun(), gbuffer);
    EXPECT_EQ(mask_of(*map, gbuffer), fresh.mask) << frame;
    for (const DebugLayer& layer : map->debug_layers())
      EXPECT_EQ(map->draw_debug(layer.name), fresh.technique->draw_debug(layer.name)) << frame << ' ' << layer.name;
    for (std::size_t i = 0; i < gbuffer.size(); i += 97) {
      const Explanation mine = *map->explain(i), others = *fresh.technique->explain(i);
      ASSERT_EQ(mine.taps.size(), others.taps.size());
      for (std::size_t k = 0; k < mine.taps.size(); ++k) EXPECT_EQ(mine.taps[k].stored, others.taps[k].stored);
    }
  }
}

}  // namespace virtual_map_update_test
