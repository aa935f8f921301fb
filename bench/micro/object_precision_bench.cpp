// What object precision costs, and beside what. All but `resolve` run on two threads; each line ends in what it measured.
//
// stages   Build, relight and resolve of every way of the family on the bunny's scene, and what they hold.
// facing   Relight where the casters are the triangles of a mesh that face the light, over one ground square. Target for
//          svbsp: at most 80 ms for the bunny, and for the dragon 1200 ms and 1536 MiB.
// soup     N triangles of size 3 / sqrt(N) over a ground. Target for svbsp: build and relight of N = 512,000 in at most 1000
// ms,
//          and an exponent of relight over N of at most 1.1: the slope of log time over log N, least squares.
// resolve  Point locations on one thread, on the bunny's scene, beside a floor: a bare loop that reads the G-buffer, tests
//          which pixels face the light, and writes the mask. Target: at least 5 million a second; embree_rays is timed, too.
#include <benchmark/benchmark.h>
#include <gnomon/kit/geometry/exact.h>
#include <tbb/global_control.h>

#include <cmath>
#include <fstream>
#include <map>

#include "bench/micro/alternate.h"
#include "bench/micro/scenes.h"

namespace {
using namespace gnomon;

constexpr int width = 960, height = 540;
constexpr int soup_counts[] = {2000, 8000, 32000, 128000, 512000};

/// `way` is a technique with its settings, as on the command line.
std::unique_ptr<Technique> made(const std::string& way) {
  const std::size_t colon = way.find(':');
  auto technique = registry().technique(way.substr(0, colon)).make();
  if (colon != std::string::npos) technique->apply(way.substr(colon + 1));
  technique->setup();
  return technique;
}

tbb::global_control threads(std::size_t count) { return {tbb::global_control::max_allowed_parallelism, count}; }

double value(const Counts& counts, std::string_view name) {
  const auto found = std::ranges::find(counts, name, &Count::name);
  return found == counts.end() ? NAN : found->value;
}

/// "3.21 fragments/polygon" of techniques that count fragments, as wide as that for the others.
std::string fragments_of(const Counts& counts) {
  const double fragments = value(counts, "fragments_per_polygon");
  return std::isnan(fragments) ? fmt::format("{:23}", "") : fmt::format("{:6.2f} fragments/polygon", fragments);
}

double mib(double bytes) { return bytes / (1 << 20); }

/// Most memory that the process has held since `forget_peak`, MiB.
double peak() {
  std::ifstream status("/proc/self/status");
  for (std::string line; std::getline(status, line);)
    if (line.starts_with("VmHWM:")) return std::stod(line.substr(6)) / 1024;
  return NAN;
}
void forget_peak() { std::ofstream("/proc/self/clear_refs") << 5; }

std::size_t facing_count(const Scene& scene, const GBuffer& gbuffer, const Light& light) {
  std::size_t count = 0;
  for (std::size_t i = 0; i < gbuffer.size(); ++i) count += faces_light(scene, gbuffer, light, i);
  return count;
}

/// Every stage in turn, iteration by iteration; the time of an iteration is that of all three.
void stages(benchmark::State& state, const std::string& way) {
  const Scene* scene = loaded(state, "bunny");
  if (!scene) return;
  const auto limit = threads(2);
  const GBuffer gbuffer = seen(*scene, scene->views[0], width, height);
  const auto technique = made(way);
  VisibilityMask mask(width, height);
  Timings build, relight, resolve;
  const auto once = [&] {
    double seconds = build.add([&] { technique->build(*scene); });
    seconds += relight.add([&] { technique->relight(scene->lights[0]); });
    return seconds + resolve.add([&] { technique->resolve(gbuffer, mask); });
  };
  once(), build = relight = resolve = {};
  for (auto _ : state) state.SetIterationTime(once());
  state.SetLabel(fmt::format("build {:8.2f} ms   relight {:8.2f} ms   resolve {:8.2f} ms   {:7.1f} MiB", 1e3 * build.median(),
                             1e3 * relight.median(), 1e3 * resolve.median(), mib(value(technique->counts(), "bytes"))));
}

/// The triangles of the largest mesh of a scene that face its first light, over one square.
Scene facing_over_ground(const Scene& from) {
  const Light& light = from.lights[0];
  const Mesh& mesh = *std::ranges::max_element(from.meshes, {}, [](const Mesh& m) { return m.triangles.size(); });
  Mesh casters;
  casters.name = "casters";
  for (const glm::uvec3& t : mesh.triangles) {
    const glm::vec3 p[3] = {mesh.positions[t.x], mesh.positions[t.y], mesh.positions[t.z]};
    if (orient3d_sign(p[0], p[1], p[2], homogeneous(light)) <= 0) continue;
    const auto first = static_cast<std::uint32_t>(casters.positions.size());
    casters.positions.insert(casters.positions.end(), p, p + 3);
    casters.triangles.push_back({first, first + 1, first + 2});
  }
  finish(casters);
  Scene scene;
  scene.name = "facing";
  scene.meshes = {tessellate(ground_plane(10), default_segments, "ground"), std::move(casters)};
  scene.lights = {light};
  scene.views = from.views;
  return scene;
}

void facing(benchmark::State& state, const std::string& way, const std::string& reference) {
  const Scene* whole = loaded(state, reference);
  if (!whole) return;
  const auto limit = threads(2);
  const Scene scene = facing_over_ground(*whole);
  const auto technique = made(way);
  Timings build, relight;
  build.add([&] { technique->build(scene); });
  technique->relight(scene.lights[0]);
  forget_peak();
  for (auto _ : state) state.SetIterationTime(relight.add([&] { technique->relight(scene.lights[0]); }));
  const Counts counts = technique->counts();
  state.SetLabel(
      fmt::format("{:7} polygons   build {:8.2f} ms   relight {:8.2f} ms   {}   {:7.1f} MiB   process at most {:7.1f} MiB",
                  scene.triangle_count(), 1e3 * build.median(), 1e3 * relight.median(), fragments_of(counts),
                  mib(value(counts, "bytes")), peak()));
}

struct Point {
  double count, seconds;
};
/// Relight of the soups measured so far, by way.
std::map<std::string, std::vector<Point>>& sweep() {
  static std::map<std::string, std::vector<Point>> points;
  return points;
}

void soup(benchmark::State& state, const std::string& way) {
  const int count = static_cast<int>(state.range(0));
  const auto limit = threads(2);
  const Scene scene = load_scene(fmt::format("soup:count={},size={}", count, 3 / std::sqrt(count)));
  const auto technique = made(way);
  Timings build, relight;
  const auto once = [&] {
    const double seconds = build.add([&] { technique->build(scene); });
    return seconds + relight.add([&] { technique->relight(scene.lights[0]); });
  };
  once(), build = relight = {};
  for (auto _ : state) state.SetIterationTime(once());
  sweep()[way].push_back({static_cast<double>(count), relight.median()});
  const Counts counts = technique->counts();
  state.SetLabel(fmt::format("build {:8.2f} ms   relight {:8.2f} ms   {}   {:7.1f} MiB", 1e3 * build.median(),
                             1e3 * relight.median(), fragments_of(counts), mib(value(counts, "bytes"))));
}

/// Slope of log seconds over log count, least squares.
double exponent(const std::vector<Point>& points) {
  double x = 0, y = 0, xx = 0, xy = 0;
  const auto n = static_cast<double>(points.size());
  for (const Point& p : points) {
    const double u = std::log(p.count), v = std::log(p.seconds);
    x += u, y += v, xx += u * u, xy += u * v;
  }
  return (n * xy - x * y) / (n * xx - x * x);
}

/// After `soup`, whose times it reads.
void growth(benchmark::State& state, const std::string& way) {
  for (auto _ : state) state.SetIterationTime(1e-9);
  const std::vector<Point>& points = sweep()[way];
  if (points.size() < 2) return state.SkipWithError("select soup too: there are no times to fit");
  state.SetLabel(fmt::format("exponent of relight {:5.3f} over {:.0f} .. {:.0f} triangles", exponent(points),
                             points.front().count, points.back().count));
}

void resolve(benchmark::State& state, const std::string& way) {
  const Scene* scene = loaded(state, "bunny");
  if (!scene) return;
  const Light& light = scene->lights[0];
  const GBuffer gbuffer = seen(*scene, scene->views[0], width, height);
  const auto technique = made(way);
  technique->build(*scene);
  technique->relight(light);
  const auto limit = threads(1);
  VisibilityMask mask(width, height), other(width, height);
  const std::span<float> pixels = other.pixels();
  alternate(
      state, [&] { technique->resolve(gbuffer, mask); },
      [&] {
        for (std::size_t i = 0; i < pixels.size(); ++i) pixels[i] = faces_light(*scene, gbuffer, light, i) ? 0.5f : 1.0f;
        benchmark::ClobberMemory();
      });
  const double points = 1e-3 * static_cast<double>(facing_count(*scene, gbuffer, light));
  const double ms = state.counters["median_ms"], floor_ms = state.counters["floor_ms"];
  state.counters.clear();
  state.SetLabel(fmt::format("{:6.2f} Mpoint/s/core   floor {:6.2f} Mpoint/s/core   {:5.1f} times the floor's time",
                             points / ms, points / floor_ms, ms / floor_ms));
}

const std::string family[] = {"svbsp",           "svbsp:order=face_planes", "svbsp:order=bsp",
                              "two_pass_object", "shadow_volume_tree",      "alias_free_map"};

[[maybe_unused]] const bool registered = [] {
  const auto add = [](const std::string& name, const auto&... arguments) {
    return add_timed("object_precision/" + name, arguments...);
  };
  for (const std::string& way : family) add("stages/" + way, stages, way)->Iterations(5);
  for (const char* scene : {"bunny", "dragon"})
    for (const char* way : {"svbsp", "svbsp:order=face_planes", "two_pass_object", "shadow_volume_tree"})
      add(fmt::format("facing/{}/{}", scene, way), facing, std::string(way), std::string(scene))->Iterations(5);
  for (const char* way : {"svbsp", "svbsp:order=face_planes", "svbsp:order=bsp", "two_pass_object", "shadow_volume_tree"}) {
    for (const int count : soup_counts)
      add(fmt::format("soup/{}", way), soup, std::string(way))
          ->ArgName("triangles")
          ->Arg(count)
          ->Iterations(count > 100'000 ? 3 : 15);
    add(fmt::format("soup/{}/growth", way), growth, std::string(way))->Iterations(1);
  }
  for (const std::string& way : family) add("resolve/" + way, resolve, way)->Iterations(9);
  add("resolve/embree_rays", resolve, std::string("embree_rays"))->Iterations(9);
  return true;
}();

}  // namespace
