// What scoring one mask costs: shadow_map's account of every wrong pixel, the causes of these, and all metrics.
// `wrong` is the share of the tested pixels that are wrong. Settings that are wrong more often or look at more texels cost
// more.
#include <benchmark/benchmark.h>
#include <gnomon/kit/gl/gl.h>
#include <unistd.h>

#include <filesystem>

#include "bench/micro/scenes.h"
#include "device/context.h"
#include "measure/cause/causes.h"
#include "measure/frame/frame.h"
#include "measure/score/score.h"

namespace {
using namespace gnomon;

/// One answer of shadow_map, in a frame cache of its own.
struct Answered {
  Scene scene;
  std::filesystem::path cache = std::filesystem::temp_directory_path() / fmt::format("gnomon_scoring_{}", getpid());
  FrameStore frames;
  std::unique_ptr<Technique> technique;
  Answer answer;

  Answered(const char* reference, const std::string& settings, int width, int height)
      : scene(load_scene(reference)), frames(scene, cache) {
    process_context();
    const FrameKey key{scene.views[0], width, height, Truth::mesh};
    answer.gbuffer = frames.gbuffer(key);
    answer.reference = frames.reference(key, scene.lights[0]);
    frames.casters(Truth::mesh);
    technique = made("shadow_map", settings, scene, scene.lights[0]);
    VisibilityMask mask(width, height);
    technique->resolve(answer.gbuffer, mask);
    const auto pixels = mask.read();
    answer.mask.assign(pixels.begin(), pixels.end());
  }
  ~Answered() { std::filesystem::remove_all(cache); }
};

void score(benchmark::State& state, const char* reference, const char* settings, int width, int height) {
  Answered a(reference, settings, width, height);
  const auto explain = [&](std::span<const std::uint32_t> pixels) {
    std::vector<std::optional<Explanation>> explanations;
    for (const std::uint32_t pixel : pixels) explanations.push_back(a.technique->explain(pixel));
    return explanations;
  };
  const Light& light = a.scene.lights[0];
  double wrong = 0;
  for (auto _ : state) {
    a.answer.causes = find_causes(
        {a.scene, a.frames.casters(Truth::mesh), a.answer.gbuffer, light, a.answer.reference, a.answer.mask, {}, explain});
    const Evidence evidence = a.answer.evidence(a.scene, light);
    const Scoring scoring(evidence);
    benchmark::DoNotOptimize(measure_metrics(scoring));
    wrong = static_cast<double>(scoring.error_counts().wrong) / static_cast<double>(scoring.error_counts().tested);
  }
  state.counters["wrong"] = wrong;
}

void in_real_milliseconds(benchmark::internal::Benchmark* one) { one->Unit(benchmark::kMillisecond)->UseRealTime(); }

BENCHMARK_CAPTURE(score, box_city_256, "box_city", "resolution=256", 1280, 720)->Apply(in_real_milliseconds);
BENCHMARK_CAPTURE(score, fence_512, "fence", "resolution=512", 1280, 720)->Apply(in_real_milliseconds);
BENCHMARK_CAPTURE(score, fence_pcf, "fence", "resolution=512,filter=pcf", 1280, 720)->Apply(in_real_milliseconds);
BENCHMARK_CAPTURE(score, contact_no_bias, "contact", "bias=constant,depth_bias=0", 640, 360)->Apply(in_real_milliseconds);

}  // namespace
