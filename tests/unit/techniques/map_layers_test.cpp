// Where casters move, maps keep the depth of those that stand still: what is drawn after an update, and that it is what a
// fresh map draws.
#include <gnomon/kit/gl/gl.h>
#include <gtest/gtest.h>

#include "area_lights.h"
#include "drawing_test.h"
#include "glass.h"
#include "walking_world.h"

namespace map_layers_test {

using namespace walking_world;
using small_world::mask_of;

class MapLayers : public DrawingTest {};

constexpr double still_triangles = 14, moving_triangles = 12, all_triangles = still_triangles + moving_triangles;

std::vector<float> fresh_mask(const std::string& id, const std::string& settings, const Scene& scene, const Light& light,
                              const GBuffer& gbuffer, const std::string& more = "") {
  const auto technique = made(id, settings, scene, more);
  technique->relight(light);
  return mask_of(*technique, gbuffer);
}

double triangles(const Technique& technique) { return small_world::value(technique.counts(), "triangles"); }
double bytes(const Technique& technique) { return small_world::value(technique.counts(), "bytes"); }

TEST_F(MapLayers, the_first_relight_after_an_update_draws_what_moves_and_the_next_one_all) {
  Row row;
  const auto map = made("shadow_map", "", row.scene);
  map->relight(row.sun());
  EXPECT_EQ(triangles(*map), all_triangles);
  for (const int frame : {1, 7, 7, 3}) {
    row.go_to(frame);
    const GBuffer gbuffer = row.picture();
    map->update(row.scene, row.posed.take_changes());
    map->relight(row.sun());
    EXPECT_EQ(triangles(*map), moving_triangles) << frame;
    const std::vector<float> fresh = fresh_mask("shadow_map", "", row.scene, row.sun(), gbuffer);
    EXPECT_EQ(mask_of(*map, gbuffer), fresh) << frame;
    map->relight(row.sun());
    EXPECT_EQ(triangles(*map), all_triangles) << frame;
    EXPECT_EQ(mask_of(*map, gbuffer), fresh) << frame;
  }
}

TEST_F(MapLayers, several_updates_before_a_relight_spoil_nothing) {
  Row row;
  const auto map = made("shadow_map", "", row.scene);
  map->relight(row.sun());
  for (const int frame : {2, 5}) {
    row.go_to(frame);
    map->update(row.scene, row.posed.take_changes());
  }
  map->relight(row.sun());
  EXPECT_EQ(triangles(*map), moving_triangles);
  const GBuffer gbuffer = row.picture();
  EXPECT_EQ(mask_of(*map, gbuffer), fresh_mask("shadow_map", "", row.scene, row.sun(), gbuffer));
}

// The first box has holes, so that the rule about them counts.
TEST_F(MapLayers, whatever_changes_an_image_spoils_its_layer) {
  const std::string settings = "resolution=128,filter=pcf";
  for (const std::string change : {"resolution=256", "filter_radius=2", "alpha=mips", "update=redraw"}) {
    Scene with_holes = walking_scene();
    Mesh& box = with_holes.meshes[1];
    box.alpha_mask = masked::checker(4, 4);
    for (const glm::vec3& p : box.positions) box.uv.emplace_back(p.x, p.z);
    Row row("lift", std::move(with_holes));
    const auto map = made("shadow_map", settings, row.scene);
    map->relight(row.sun());
    row.go_to(2);
    map->update(row.scene, row.posed.take_changes());
    map->apply(change);
    map->relight(row.sun());
    EXPECT_EQ(triangles(*map), all_triangles) << change;
    const GBuffer gbuffer = row.picture();
    EXPECT_EQ(mask_of(*map, gbuffer), fresh_mask("shadow_map", settings, row.scene, row.sun(), gbuffer, change)) << change;
  }
}

TEST_F(MapLayers, another_light_and_another_build_spoil_the_layer) {
  Row row;
  const auto map = made("shadow_map", "", row.scene);
  map->relight(row.sun());
  row.go_to(1);
  map->update(row.scene, row.posed.take_changes());
  for (const Light& light : {row.point(), row.sun()}) {
    map->relight(light);
    EXPECT_EQ(triangles(*map), all_triangles) << light.name;
  }
  map->build(row.scene);
  map->relight(row.sun());
  EXPECT_EQ(triangles(*map), all_triangles);
  const GBuffer gbuffer = row.picture();
  EXPECT_EQ(mask_of(*map, gbuffer), fresh_mask("shadow_map", "", row.scene, row.sun(), gbuffer));
}

// In the row of `lift` the first box stands still; in that of `walk`, to which the scene goes without a build, it moves.
TEST_F(MapLayers, a_mesh_that_begins_to_move_spoils_the_layer) {
  Row row;
  const auto map = made("shadow_map", "", row.scene);
  map->relight(row.sun());
  row.animation = "walk";
  for (const int frame : {1, 2}) {
    row.go_to(frame);
    map->update(row.scene, row.posed.take_changes());
    map->relight(row.sun());
    EXPECT_EQ(triangles(*map), frame == 1 ? all_triangles : 2 * moving_triangles);
    const GBuffer gbuffer = row.picture();
    EXPECT_EQ(mask_of(*map, gbuffer), fresh_mask("shadow_map", "", row.scene, row.sun(), gbuffer)) << frame;
  }
}

// Nobody says where it will be.
TEST_F(MapLayers, a_mesh_that_moves_and_has_no_reach_is_built_anew) {
  Scene scene = walking_scene();
  const auto map = made("shadow_map", "", scene);
  map->relight(scene.lights[1]);
  Changes changes;
  changes.meshes.resize(scene.meshes.size());
  changes.meshes[2].kind = MeshChange::Kind::rigid;
  for (glm::vec3& p : scene.meshes[2].positions) p.x += 3;
  ++scene.pose_number;
  map->update(scene, changes);
  map->relight(scene.lights[1]);
  EXPECT_EQ(triangles(*map), all_triangles);
  const GBuffer gbuffer = small_world::make_gbuffer(scene, scene.views[0], 64, 48);
  EXPECT_EQ(mask_of(*map, gbuffer), fresh_mask("shadow_map", "", scene, scene.lights[1], gbuffer));
}

// The picture of frame 0 serves all frames, so that the images that are fitted to it stay where they are.
TEST_F(MapLayers, images_of_the_view_keep_their_layer_in_the_first_resolve_alone) {
  const std::pair<const char*, const char*> maps[] = {
      {"shadow_map", "fit=view"}, {"cascaded_map", "cascades=1"}, {"warped_map", ""}, {"variance_map", "fit=view"}};
  for (const auto& [id, settings] : maps) {
    Row row;
    const GBuffer gbuffer = row.picture();
    const auto map = made(id, settings, row.scene);
    map->relight(row.sun());
    mask_of(*map, gbuffer);
    EXPECT_EQ(triangles(*map), all_triangles) << id;
    row.go_to(1);
    map->update(row.scene, row.posed.take_changes());
    map->relight(row.sun());
    const std::vector<float> fresh = fresh_mask(id, settings, row.scene, row.sun(), gbuffer);
    EXPECT_EQ(mask_of(*map, gbuffer), fresh) << id;
    EXPECT_EQ(triangles(*map), moving_triangles) << id;
    EXPECT_EQ(mask_of(*map, gbuffer), fresh) << id;
    EXPECT_EQ(triangles(*map), all_triangles) << id;
    row.go_to(2);
    map->update(row.scene, row.posed.take_changes());
    map->relight(row.point());  // which is no relight under the light before
    map->relight(row.sun());
    EXPECT_EQ(mask_of(*map, gbuffer), fresh_mask(id, settings, row.scene, row.sun(), gbuffer)) << id;
    EXPECT_EQ(triangles(*map), all_triangles) << id;
  }
}

// Only the first of two objects is told of the update.
TEST_F(MapLayers, each_light_has_a_layer_of_its_own) {
  Row row;
  const Light evening{.name = "evening", .kind = DirectionalLight{{-2, -1, 0.25f}}};
  const auto first = made("shadow_map", "", row.scene);
  const auto guest = first->for_another_light();
  first->relight(row.sun());
  guest->relight(evening);
  for (const int frame : {1, 4}) {
    row.go_to(frame);
    first->update(row.scene, row.posed.take_changes());
    first->relight(row.sun());
    guest->relight(evening);
    EXPECT_EQ(triangles(*first), moving_triangles) << frame;
    EXPECT_EQ(triangles(*guest), moving_triangles) << frame;
    const GBuffer gbuffer = row.picture();
    EXPECT_EQ(mask_of(*first, gbuffer), fresh_mask("shadow_map", "", row.scene, row.sun(), gbuffer)) << frame;
    EXPECT_EQ(mask_of(*guest, gbuffer), fresh_mask("shadow_map", "", row.scene, evening, gbuffer)) << frame;
  }
  guest->relight(row.sun());
  EXPECT_EQ(triangles(*guest), all_triangles);
}

// One image of 256 x 256 texels of four bytes. Where all casters move, and where none does, there is nothing to keep.
TEST_F(MapLayers, a_second_image_is_held_from_the_build_on_where_some_casters_move) {
  const auto held = [](const Row& row, const std::string& update) {
    const auto map = made("shadow_map", "resolution=256,update=" + update, row.scene);
    map->relight(row.sun());
    return bytes(*map);
  };
  const Row some;
  EXPECT_EQ(held(some, "layers"), held(some, "redraw") + 4 * 256 * 256);
  Scene boxes = walking_scene();
  boxes.meshes[0].casts = false;
  const Row all("walk", std::move(boxes));
  EXPECT_EQ(held(all, "layers"), held(all, "redraw"));
  Row none;
  none.posed.go_to(std::nullopt);
  EXPECT_EQ(held(none, "layers"), held(none, "redraw"));
}

struct Case {
  const char *id, *settings;
  const char* animation = "lift";
};

/// After updates a map answers as one that builds there does, in the same passes and in one pass, and holds as much.
void expect_as_built(const Case& map, const Scene& with, const std::vector<Light>& lights) {
  Row row(map.animation, with);
  const bool has_layers = map.id != std::string("virtual_map");
  const auto used = made(map.id, map.settings, row.scene), built = made(map.id, map.settings, row.scene);
  const auto one_pass = made(map.id, map.settings, row.scene, has_layers ? "update=redraw" : "");
  for (const Light& light : lights) {
    used->build(row.scene);
    used->relight(light);
    std::vector<float> first;
    for (const int frame : {0, 3, 8, 5, 0}) {
      row.go_to(frame);
      used->update(row.scene, row.posed.take_changes());
      used->relight(light);
      const GBuffer gbuffer = row.picture();
      const std::vector<float> mask = mask_of(*used, gbuffer);
      const std::string where = fmt::format("{}:{} under {} at frame {}", map.id, map.settings, light.name, frame);
      for (Technique* const whole : {built.get(), one_pass.get()}) {
        whole->build(row.scene);
        whole->relight(light);
        EXPECT_EQ(mask, mask_of(*whole, gbuffer)) << where << (whole == built.get() ? "" : ", in one pass");
      }
      EXPECT_EQ(bytes(*used), bytes(*built)) << where;
      if (first.empty()) first = mask;
      if (frame == 0) {
        EXPECT_EQ(mask, first) << where;
      }
    }
  }
}

// From the low point light four faces of the cube see the ground, and the boxes move from face to face.
TEST_F(MapLayers, after_updates_maps_answer_as_after_a_build_and_as_in_one_pass) {
  const Scene scene = walking_scene();
  const std::vector<Light> lights = {scene.lights[1],
                                     {.name = "low", .kind = PointLight{{0.25f, 1.75f, 2}}},
                                     {.name = "spot", .kind = SpotLight{{1, 6, 1}, {-0.1f, -1, 0}, 20, 30}}};
  for (const Case& map : {Case{"shadow_map", "resolution=128"}, Case{"shadow_map", "resolution=128", "walk"},
                          Case{"shadow_map", "resolution=128,stored=second"},
                          Case{"shadow_map", "resolution=128,stored=dual,filter=disc,fit=view"},
                          Case{"variance_map", "resolution=128"}, Case{"exponential_map", "resolution=128,fit=view"},
                          Case{"moment_map", "resolution=128,bits=16"}, Case{"virtual_map", "", "walk"}})
    expect_as_built(map, scene, lights);
  for (const Case& map : {Case{"cascaded_map", "resolution=128", "walk"},
                          Case{"cascaded_map", "resolution=128,placement=stable"}, Case{"warped_map", "resolution=128"}})
    expect_as_built(map, scene, {scene.lights[1]});
}

TEST_F(MapLayers, after_updates_maps_of_lamps_answer_as_after_a_build_and_as_in_one_pass) {
  const Light lamp = rect({1, 6, 1}, {0.5f, 0, 0}, {0, 0, 0.5f});
  for (const Case& map : {Case{"percentage_closer_soft", "resolution=256,most_radius=16"},
                          Case{"backprojected_map", "resolution=256,most_radius=16,fit=view"}})
    expect_as_built(map, walking_scene(), {lamp});
}

// The first box is of glass with texels that let nothing through, which are drawn over the depth of opaque casters: it moves,
// and so does the second one, over a ground that stands still.
TEST_F(MapLayers, what_is_drawn_over_a_layer_does_not_stay) {
  Scene scene = walking_scene();
  std::vector<glm::vec2> uv;
  for (const glm::vec3& p : scene.meshes[1].positions) uv.emplace_back(p.x, p.y + p.z);
  scene.meshes[1] = glass::with_transmission(std::move(scene.meshes[1]), glass::texels(2, 2, {0, 0.5f, 0.75f, 0.25f}), uv);
  for (const char* const id : {"transmittance_map", "moment_transmittance", "fourier_opacity", "stochastic_map"})
    expect_as_built({id, "resolution=128", "walk"}, scene, scene.lights);
}

}  // namespace map_layers_test
