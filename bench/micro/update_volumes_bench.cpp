// What shadow volumes of a scene that moves cost: update and relight of an object that follows, beside build and relight. Both
// alternate inside one run, each at the next pose; `ratio` is the ratio of their medians.
//
// 64 balls of together 33,792 triangles stand in rows over a ground, and so many of them move: one, eight, half of them, all,
// or none. Wanted: of stencil_volume at most 0.3 where one moves. The follower comes first and uploads what moved for both, so
// that the ratio is a little too high.
//
// crow_counting's relight makes no picture: its polygons are made in resolve. Both run on two threads.
#include <benchmark/benchmark.h>
#include <gnomon/kit/geometry/circling.h>
#include <tbb/global_control.h>

#include "bench/micro/alternate.h"
#include "bench/micro/scenes.h"
#include "device/context.h"
#include "measure/scene/posed_scene.h"

namespace {
using namespace gnomon;

constexpr int side = 8, frames = 60;

/// Balls in rows of 2 m; the first `moving` walk by 1 m along x in a second.
Scene rows_of_balls(int moving) {
  constexpr int segments = 24;  // 528 triangles each
  Scene scene = ball_over_ground("rows_of_balls", 0.75f, segments);
  scene.lights[0].kind = PointLight{{-6, 14, 5}};
  const Mesh ball = scene.meshes.back();
  scene.meshes.pop_back();
  auto motion = std::make_shared<Motion>();
  motion->nodes.resize(1);
  motion->animations = {{"walk", {{.node = 0, .times = {0, 1}, .values = {0, 0, 0, 1, 0, 0}}}}};
  for (int i = 0; i < side * side; ++i) {
    scene.meshes.push_back(ball);
    for (glm::vec3& p : scene.meshes.back().positions) p += glm::vec3(2 * (i % side) - side, 0, 2 * (i / side) - side);
    if (i < std::max(moving, 1))
      motion->rigs.push_back(rig_at_rest(scene, static_cast<std::uint32_t>(scene.meshes.size() - 1), 0));
  }
  scene.motion = std::move(motion);
  return scene;
}

void update(benchmark::State& state, const char* id) {
  process_context();
  const tbb::global_control threads(tbb::global_control::max_allowed_parallelism, 2);
  const auto moving = static_cast<int>(state.range(0));
  Scene scene = rows_of_balls(moving);
  const Light& light = scene.lights[0];
  PosedScene posed(scene);
  int frame = 0;
  // A pose forth and back again, without its time.
  const auto next = [&] {
    frame = (frame + 1) % (2 * frames - 2);
    const int at = frame < frames ? frame : 2 * frames - 2 - frame;
    const double seconds = moving > 0 ? at / 60.0 : 0;  // a row may rest for some frames
    posed.go_to(RowPose{.animation = "walk", .seconds = seconds, .start = 0, .frame_rate = 60, .frames = frames});
    return posed.take_changes();
  };
  next();
  const auto follower = made(id, "", scene, light), builder = made(id, "", scene, light);
  Timings of_follower;
  Timings of_builder;
  for (auto _ : state) {
    const Changes changes = next();
    state.SetIterationTime(of_follower.add([&] {
      follower->update(scene, changes);
      follower->relight(light);
    }));
    of_builder.add([&] {
      builder->build(scene);
      builder->relight(light);
    });
  }
  state.counters["triangles"] = static_cast<double>(scene.triangle_count());
  state.counters["floor_ms"] = 1000 * of_builder.median();
  state.counters["median_ms"] = 1000 * of_follower.median();
  state.counters["ratio"] = of_follower.median() / of_builder.median();
  state.counters["cpu_ratio"] = of_follower.cpu_median() / of_builder.cpu_median();
}

[[maybe_unused]] const bool registered = [] {
  for (const char* id : {"stencil_volume", "crow_counting"})
    add_timed(fmt::format("update_volumes/{}", id), update, id)
        ->ArgName("moving")
        ->ArgsProduct({{0, 1, 8, 32, 64}})
        ->Iterations(60);
  return true;
}();

}  // namespace
