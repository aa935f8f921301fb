// What embree_rays adds to Embree: its resolve beside a bare loop of the same packed rays with the same filter, on the same
// number of threads. Both alternate inside one run, so that a busy machine slows both; `ratio` is the ratio of the medians.
// Target: resolve reaches at least 0.85 of the bare loop's throughput.
//
// The bare loop finds its packets filled (fill_packet, before the clock starts). rtcOccluded16 overwrites tfar, so the bare
// loop stores 16 constants into each packet before it traces it: 64 of 768 bytes, charged to it. It leaves its answers in tfar;
// resolve fills its packets from the G-buffer, traces the same rays and writes the mask, all on the clock.
#include <benchmark/benchmark.h>
#include <gnomon/kit/rays/rays.h>
#include <tbb/blocked_range.h>
#include <tbb/global_control.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <bit>

#include "bench/micro/alternate.h"
#include "bench/micro/scenes.h"
#include "kit/rays/embree.h"

namespace {
using namespace gnomon;

constexpr int width = 960, height = 540;

/// One packet as the bare loop requires it, with lanes as Embree takes them: -1 is on.
struct Question {
  ShadowPacket packet;
  alignas(64) std::array<int, 16> valid;
  std::array<std::uint32_t, 16> mesh, triangle;
};

/// Embree's context and the packet's question, for the filter.
struct Context {
  embree::Context embree;
  const Question* question;
};

void exclude_receiver(const RTCFilterFunctionNArguments* args) {
  const Question& question = *reinterpret_cast<const Context*>(args->context)->question;
  for (unsigned lane = 0; lane < args->N; ++lane) {
    if (args->valid[lane] == 0) continue;
    const unsigned id = RTCRayN_id(args->ray, args->N, lane);
    if (RTCHitN_geomID(args->hit, args->N, lane) == question.mesh[id] &&
        RTCHitN_primID(args->hit, args->N, lane) == question.triangle[id])
      args->valid[lane] = 0;
  }
}

struct Rig {
  Scene scene;
  GBuffer gbuffer;
  std::unique_ptr<Technique> technique;
  RayScene casters;
  std::vector<Question> questions;
  std::size_t ray_count = 0;

  explicit Rig(Scene of) : scene(std::move(of)), casters(scene, Truth::mesh, RayScene::Which::casters) {
    gbuffer = seen(scene, scene.views[0], width, height);
    technique = made("embree_rays", "", scene, scene.lights[0]);
    for (std::size_t first = 0; first < gbuffer.size(); first += 16) {
      Question question;
      const std::uint32_t lanes = fill_packet(scene, gbuffer, scene.lights[0], first, question.packet);
      if (lanes == 0) continue;
      ray_count += static_cast<std::size_t>(std::popcount(lanes));
      for (int k = 0; k < 16; ++k) question.valid[k] = -static_cast<int>(lanes >> k & 1);
      std::copy_n(&gbuffer.mesh[first], 16, question.mesh.begin());
      std::copy_n(&gbuffer.triangle[first], 16, question.triangle.begin());
      questions.push_back(question);
    }
  }

  void trace_bare() {
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, questions.size(), 16), [&](const auto& range) {
      Context context;
      for (std::size_t i = range.begin(); i < range.end(); ++i) {
        context.question = &questions[i];
        questions[i].packet.tfar.fill(1.0f);
        embree::occlude(questions[i].valid.data(), casters.handle(), reinterpret_cast<RTCRay16*>(&questions[i].packet),
                        context.embree, exclude_receiver);
      }
    });
  }

  std::size_t bare_blocked_count() const {
    std::size_t blocked = 0;
    for (const Question& q : questions)
      for (int k = 0; k < 16; ++k) blocked += q.valid[k] != 0 && q.packet.tfar[k] < 0;
    return blocked;
  }
};

Rig& rig(int index) {
  // The ball has 100 488 triangles: 318 around, 159 from pole to pole.
  static Rig rigs[] = {Rig(load_scene("soup:count=10000")), Rig(load_scene("box_city")),
                       Rig(ball_over_ground("sphere_mesh", 1.5f, 318))};
  return rigs[index];
}

void resolve(benchmark::State& state) {
  Rig& r = rig(static_cast<int>(state.range(0)));
  const tbb::global_control threads(tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(state.range(1)));
  VisibilityMask mask(width, height);
  const auto ours = [&] { r.technique->resolve(r.gbuffer, mask); };
  const auto bare = [&] { r.trace_bare(); };
  ours();
  bare();
  if (r.bare_blocked_count() != static_cast<std::size_t>(std::ranges::count(mask.read(), 0.0f)))
    return state.SkipWithError("the bare loop and resolve disagree");
  Timings our_times, bare_times;
  for (auto _ : state) {
    bare_times.add(bare);
    state.SetIterationTime(our_times.add(ours));
  }
  const double mega_rays = 1e-6 * static_cast<double>(r.ray_count);
  state.counters["Mray/s"] = mega_rays / our_times.median();
  state.counters["bare_Mray/s"] = mega_rays / bare_times.median();
  state.counters["ratio"] = bare_times.median() / our_times.median();
  state.SetLabel(r.scene.name);
}

[[maybe_unused]] const auto* const registered =
    add_timed("embree_rays/resolve", resolve) -> ArgNames({"scene", "threads"}) -> ArgsProduct({{0, 1, 2}, {1, 2}});

}  // namespace
