// What a map with a layer of still casters takes where others move, beside one that draws all casters again: update and relight
// after each step of an animation. The positions are uploaded before, for both.
//
// virtual_map   The first resolve after an update, which keeps pages, beside one that repeats it, which draws all of them.
//               `drawn` is the share of pages that the first one draws.
#include <benchmark/benchmark.h>
#include <gnomon/kit/geometry/circling.h>
#include <gnomon/kit/gl/gl.h>

#include "bench/micro/alternate.h"
#include "bench/micro/scenes.h"
#include "device/context.h"
#include "measure/scene/posed_scene.h"

namespace {
using namespace gnomon;

constexpr int side = 8;            // balls along a row
constexpr double frame_rate = 16;  // a second
constexpr int frame_count = 17;    // of an animation of one second

/// 64 balls of about 512 triangles over a ground, of which so many go up and down by half a meter.
Scene balls(int moving) {
  Scene scene;
  scene.name = fmt::format("balls_{}", moving);
  scene.meshes = {tessellate(ground_plane(side + 2), default_segments, "ground")};
  auto motion = std::make_shared<Motion>();
  motion->animations = {{"lift", {}}};
  for (int i = 0; i < side * side; ++i) {
    const glm::dvec3 center(2 * (i % side) + 1 - side, 1, 2 * (i / side) + 1 - side);
    Mesh ball = tessellate(Sphere{center, 0.5f}, 16, fmt::format("ball_{}", i + 1));
    ball.shape.reset();
    scene.meshes.push_back(std::move(ball));
    // Those that move are spread over all of them.
    if (i * moving / (side * side) == (i + 1) * moving / (side * side)) continue;
    const auto node = static_cast<std::uint32_t>(motion->nodes.size());
    motion->nodes.emplace_back();
    motion->animations[0].tracks.push_back({.node = node, .times = {0, 0.5, 1}, .values = {0, 0, 0, 0, 0.5, 0, 0, 0, 0}});
    motion->rigs.push_back(rig_at_rest(scene, static_cast<std::uint32_t>(scene.meshes.size() - 1), node));
  }
  scene.motion = std::move(motion);
  scene.lights = {{.name = "sun", .kind = DirectionalLight{{0.4f, -1, 0.3f}}},
                  {.name = "point", .kind = PointLight{{0.5f, 3, 0.25f}}}};
  scene.views = {{.eye = {2, 9, 16}, .target = {0, 0.5f, 0}}};
  return scene;
}

/// `id` with layers, and the same with `update=redraw`, frame after frame and by turns.
void update_and_relight(benchmark::State& state, Scene scene, const std::string& id, const std::string& settings,
                        std::size_t light) {
  process_context();
  PosedScene posed(scene);
  const std::string animation = scene.motion->animations[0].name;
  const auto go_to = [&](int frame) {
    posed.go_to(RowPose{animation, frame / frame_rate, 0, frame_rate, frame_count});
    scene_buffers(scene);
    return posed.take_changes();
  };
  go_to(0);
  const auto layers = made(id, settings + ",update=layers", scene, scene.lights[light]);
  const auto redraw = made(id, settings + ",update=redraw", scene, scene.lights[light]);
  Timings of_layers, of_redraw;
  int frame = 0;
  const auto follow = [&](Technique& technique, const Changes& changes) {
    technique.update(scene, changes);
    technique.relight(scene.lights[light]);
  };
  for (auto _ : state) {
    frame = (frame + 1) % (frame_count - 1);
    const Changes changes = go_to(frame);
    state.SetIterationTime(of_layers.add([&] { follow(*layers, changes); }));
    of_redraw.add([&] { follow(*redraw, changes); });
  }
  state.counters["floor_ms"] = 1000 * of_redraw.median();
  state.counters["median_ms"] = 1000 * of_layers.median();
  state.counters["ratio"] = of_layers.median() / of_redraw.median();
  for (const Count& count : layers->counts())
    if (count.name == "filtered") state.counters["filtered_texels"] = count.value;  // of the last frame
  state.counters["cpu_ratio"] = of_layers.cpu_median() / of_redraw.cpu_median();
  state.SetLabel(scene.lights[light].name);
  release_inputs();
}

void map_of_balls(benchmark::State& state, const std::string& id) {
  const std::string settings = fmt::format("resolution={}", state.range(2));
  update_and_relight(state, balls(static_cast<int>(state.range(0))), id, settings, static_cast<std::size_t>(state.range(1)));
}

void map_of_walking_boxes(benchmark::State& state, const std::string& id) {
  const Scene* const scene = loaded(state, fmt::format("walking_boxes:count={}", state.range(0)));
  if (!scene) return;
  const std::string settings = fmt::format("resolution={}", state.range(2));
  update_and_relight(state, *scene, id, settings, static_cast<std::size_t>(state.range(1)));
}

double count(const Technique& technique, std::string_view name) {
  const Counts counts = technique.counts();
  return std::ranges::find(counts, name, &Count::name)->value;
}

void pages_of_balls(benchmark::State& state) {
  process_context();
  Scene scene = balls(static_cast<int>(state.range(0)));
  const Light& light = scene.lights[static_cast<std::size_t>(state.range(1))];
  PosedScene posed(scene);
  const auto go_to = [&](int frame) {
    posed.go_to(RowPose{"lift", frame / frame_rate, 0, frame_rate, frame_count});
    scene_buffers(scene);
    return posed.take_changes();
  };
  go_to(0);
  const auto map = made("virtual_map", "", scene, light);
  VisibilityMask mask(640, 360);
  map->resolve(seen(scene, scene.views[0], mask.width(), mask.height()), mask);
  Timings of_first, of_whole;
  double drawn = 0, pages = 0;
  int frame = 0;
  for (auto _ : state) {
    frame = (frame + 1) % (frame_count - 1);
    const Changes changes = go_to(frame);
    const GBuffer gbuffer = seen(scene, scene.views[0], mask.width(), mask.height());
    map->update(scene, changes);
    map->relight(light);
    state.SetIterationTime(of_first.add([&] { map->resolve(gbuffer, mask); }));
    drawn += count(*map, "pages_drawn");
    pages += count(*map, "pages");
    of_whole.add([&] { map->resolve(gbuffer, mask); });
  }
  state.counters["floor_ms"] = 1000 * of_whole.median();
  state.counters["median_ms"] = 1000 * of_first.median();
  state.counters["ratio"] = of_first.median() / of_whole.median();
  state.counters["cpu_ratio"] = of_first.cpu_median() / of_whole.cpu_median();
  state.counters["drawn"] = drawn / pages;
  state.SetLabel(light.name);
  release_inputs();
}

[[maybe_unused]] const bool is_registered = [] {
  for (const std::string id : {"shadow_map", "variance_map"}) {
    add_timed("update_maps/balls/" + id, map_of_balls, id)
        ->ArgNames({"moving", "light", "resolution"})
        ->ArgsProduct({{1, 8, 32}, {0, 1}, {1024}});
    add_timed("update_maps/walking_boxes/" + id, map_of_walking_boxes, id)
        ->ArgNames({"count", "light", "resolution"})
        ->ArgsProduct({{12, 64}, {0, 1}, {1024, 2048}});
  }
  add_timed("update_maps/balls/virtual_map", pages_of_balls)->ArgNames({"moving", "light"})->ArgsProduct({{1, 8, 32}, {0, 1}});
  return true;
}();

}  // namespace
