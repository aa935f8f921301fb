// What an update saves: update and relight beside build and relight at the same pose, by turns, one object each.
//
// part     A ball of 32,760 triangles stands still and one of 528 moves, one of 63. Target for embree_rays: at most 0.15.
// still    Nothing moved: update(no changes) and relight. Target: at most 0.02, or 0.05 ms.
// swarm    32,768 triangles that each go their own way, frame by frame, so that trees are built anew now and then.
//
// `ratio` is the ratio of the medians, of which a build now and then is no part; `mean_ms` of swarm has it.
#include <benchmark/benchmark.h>
#include <gnomon/changes.h>

#include <cmath>

#include "bench/micro/alternate.h"
#include "bench/micro/scenes.h"
#include "measure/scene/posed_scene.h"

namespace {
using namespace gnomon;

constexpr int frame_count = 120;

/// A point light where the technique has no use for an area, else a disc of 0.5 m.
Light light_for(const std::string& id) {
  const glm::vec3 place(-4, 6, 3);
  if (id == "exact_area") return {.name = "disc", .kind = DiscLight{place, -place, 0.5f}};
  return {.name = "point", .kind = PointLight{place}};
}

/// The technique twice on one scene that moves in place: one object follows by update, the other one is built.
class Pair {
 public:
  Pair(const std::string& id, const Scene& scene)
      : scene_(scene), light_(light_for(id)), updated_(made(id, "", scene, light_)), built_(made(id, "", scene, light_)) {}

  void update(const Changes& changes) {
    updated_->update(scene_, changes);
    updated_->relight(light_);
  }
  void build() {
    built_->build(scene_);
    built_->relight(light_);
  }

 private:
  const Scene& scene_;
  Light light_;
  std::unique_ptr<Technique> updated_, built_;
};

Changes nothing_moved(const Scene& scene) {
  Changes changes;
  changes.meshes.resize(scene.meshes.size());
  return changes;
}

/// The small ball is the last mesh and goes around the large one.
Scene two_balls() {
  Scene scene = ball_over_ground("two_balls", 1.5f, 182);
  Mesh small = tessellate(Sphere{{0, 0, 0}, 0.3f}, 24, "small");
  small.shape.reset();
  scene.meshes.push_back(std::move(small));
  scene.meshes.back().reach = {{-3, 1, -3}, {3, 2, 3}};
  return scene;
}

void part(benchmark::State& state, const std::string& id) {
  Scene scene = two_balls();
  Mesh& small = scene.meshes.back();
  const std::vector<glm::vec3> base = small.positions;
  Changes changes = nothing_moved(scene);
  changes.meshes.back().kind = MeshChange::Kind::deformed;
  changes.meshes.back().count = static_cast<std::uint32_t>(base.size());
  Pair pair(id, scene);
  int frame = 0;
  const auto move = [&] {
    const double turn = 0.05 * ++frame;
    for (std::size_t v = 0; v < base.size(); ++v)
      small.positions[v] = base[v] + glm::vec3(2.2 * std::cos(turn), 1.5, 2.2 * std::sin(turn));
    ++scene.pose_number;
  };
  Timings of_update, of_build;
  for (auto _ : state) {
    move();
    state.SetIterationTime(of_update.add([&] { pair.update(changes); }));
    of_build.add([&] { pair.build(); });
  }
  state.counters["median_ms"] = 1000 * of_update.median();
  state.counters["floor_ms"] = 1000 * of_build.median();
  state.counters["ratio"] = of_update.median() / of_build.median();
}

void still(benchmark::State& state, const std::string& id) {
  const Scene scene = two_balls();
  const Changes changes = nothing_moved(scene);
  Pair pair(id, scene);
  alternate(
      state, [&] { pair.update(changes); }, [&] { pair.build(); });
}

void swarm(benchmark::State& state, const std::string& id) {
  Scene scene = load_scene("swarm:count=32768,reach=0.2");
  PosedScene posed(scene);
  const auto go_to = [&](int frame) {
    posed.go_to(RowPose{.animation = "fly", .seconds = frame / 60.0, .start = 0, .frame_rate = 60, .frames = frame_count});
    return posed.take_changes();
  };
  go_to(0);
  Pair pair(id, scene);
  int frame = 0;
  double sum = 0;
  Timings of_update, of_build;
  for (auto _ : state) {
    const Changes changes = go_to(++frame % frame_count);
    const double seconds = of_update.add([&] { pair.update(changes); });
    state.SetIterationTime(seconds);
    sum += seconds;
    of_build.add([&] { pair.build(); });
  }
  state.counters["median_ms"] = 1000 * of_update.median();
  state.counters["mean_ms"] = 1000 * sum / frame;
  state.counters["floor_ms"] = 1000 * of_build.median();
  state.counters["ratio"] = of_update.median() / of_build.median();
}

[[maybe_unused]] const bool is_registered = [] {
  for (const std::string id : {"embree_rays", "exact_rays", "exact_area"}) {
    add_timed("update/" + id + "/part", part, id);
    add_timed("update/" + id + "/still", still, id)->Iterations(60);  // else a million, each beside a build
    add_timed("update/" + id + "/swarm", swarm, id);
  }
  return true;
}();

}  // namespace
