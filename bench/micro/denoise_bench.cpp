// What filters of few rays cost at 640x360 on two cores, beside a bare loop that adds up the same planes under the same taps,
// all of fixed weight. Target: five levels by value and geometry within 30 ms (median_ms).
#include <benchmark/benchmark.h>
#include <gnomon/kit/denoise/ray_places.h>
#include <gnomon/kit/denoise/tiles.h>
#include <gnomon/kit/parallel.h>
#include <gnomon/kit/random.h>
#include <gnomon/kit/vectorized.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <array>

#include "bench/micro/alternate.h"
#include "bench/micro/scenes.h"

namespace {
using namespace gnomon;

constexpr int width = 640, height = 360;
constexpr std::size_t size = static_cast<std::size_t>(width) * height;

/// One ray a pixel, half of them lit, on a ball over a ground.
struct Picture {
  FilterGuides guides;
  std::vector<float> noisy, numerators, denominators, variance, sigma;

  Picture() : noisy(size), numerators(size), denominators(size), variance(size), sigma(size) {
    const Scene scene = ball_over_ground("ball_over_ground", 1, 60);
    const GBuffer gbuffer = seen(scene, scene.views[0], width, height);
    guides.make(gbuffer, std::vector<std::uint8_t>(size, 1));
    Random random(1);
    for (float& value : noisy) value = random.below(2) == 0 ? 0.0f : 1.0f;
    for (float& value : sigma) value = static_cast<float>(random.uniform(0, 10));
    restore();
  }
  void restore() {
    std::copy(noisy.begin(), noisy.end(), numerators.begin());
    std::fill(denominators.begin(), denominators.end(), 1.0f);
    std::fill(variance.begin(), variance.end(), 0.25f);
  }
  template <class Work>
  void with_planes(const Work& work) {
    const std::span<float> planes[] = {numerators};
    work(FilterPlanes{.denominators = denominators, .numerators = planes, .variance = variance});
  }
};

Picture& picture() {
  static Picture made;
  return made;
}

GNOMON_VECTORIZED void add(const float* from, float weight, std::size_t count, float* __restrict to) {
  for (std::size_t i = 0; i < count; ++i) to[i] += weight * from[i];
}

/// Three planes under 25 taps of five levels; taps beside the picture are those at its border.
class BareLevels {
 public:
  void run(int levels) {
    for (int level = 0; level < levels; ++level) {
      for_blocks(height, 8, [&](std::size_t begin, std::size_t end) {
        for (std::size_t y = begin; y < end; ++y)
          for (std::size_t k = 0; k < from_.size(); ++k) row(from_[k], to_[k], static_cast<int>(y), 1 << level);
      });
      from_.swap(to_);
    }
    benchmark::ClobberMemory();
  }

 private:
  static constexpr int stride = width + 2 * filter_margin;
  using Plane = std::vector<float>;

  static void row(const Plane& from, Plane& to, int y, int step) {
    constexpr float taps[] = {1.0f / 16, 4.0f / 16, 6.0f / 16, 4.0f / 16, 1.0f / 16};
    float* target = &to[static_cast<std::size_t>(y) * stride + filter_margin];
    std::fill_n(target, width, 0.0f);
    for (int j = 0; j < 5; ++j) {
      const int other = std::clamp(y + (j - 2) * step, 0, height - 1);
      const float* source = &from[static_cast<std::size_t>(other) * stride + filter_margin];
      for (int i = 0; i < 5; ++i) add(source + (i - 2) * step, taps[i] * taps[j], width, target);
    }
  }

  std::array<Plane, 3> from_{Plane(stride * height, 1), Plane(stride* height, 1), Plane(stride* height, 1)};
  std::array<Plane, 3> to_ = from_;
};

enum class Way { by_value, by_geometry, by_sigma, tiles };

void levels(benchmark::State& state, Way way) {
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, 2);
  Picture& p = picture();
  GuidedFilter filter;
  TileMap map;
  BareLevels bare;
  const int count = way == Way::tiles ? 3 : most_filter_levels;
  const auto contender = [&] {
    p.restore();
    p.with_planes([&](const FilterPlanes& planes) {
      if (way == Way::by_value) filter.run(p.guides, svgf_rule, 0, count, planes);
      if (way == Way::by_geometry) filter.run(p.guides, atrous_rule, 0, count, planes);
      if (way == Way::by_sigma) filter.run_by_sigma(p.guides, p.sigma, planes);
      if (way != Way::tiles) return;
      map.make(p.guides, p.numerators, p.denominators);
      filter.run(p.guides, tile_rule, 0, count, planes, map.strength());
    });
  };
  alternate(state, contender, [&] { bare.run(count); });
}

/// Variance from 7x7 pixels, of every pixel, as after a cut.
void variance(benchmark::State& state) {
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, 2);
  Picture& p = picture();
  p.restore();
  Timings timings;
  for (auto _ : state)
    state.SetIterationTime(timings.add([&] { spread_variance(p.guides, p.numerators, p.denominators, p.variance); }));
  state.counters["median_ms"] = 1000 * timings.median();
}

/// Tables of the blue-noise mask, once in a process.
void blue_noise(benchmark::State& state) {
  Timings timings;
  for (auto _ : state) state.SetIterationTime(timings.add([] { benchmark::DoNotOptimize(RayPlaces(RayPattern::blue, 1)); }));
  state.counters["median_ms"] = 1000 * timings.median();
}

[[maybe_unused]] const bool is_registered = [] {
  add_timed("denoise/svgf_5_levels", levels, Way::by_value);
  add_timed("denoise/atrous_5_levels", levels, Way::by_geometry);
  add_timed("denoise/by_sigma", levels, Way::by_sigma);
  add_timed("denoise/tiles", levels, Way::tiles);
  add_timed("denoise/variance_7x7", variance);
  add_timed("denoise/blue_noise_mask", blue_noise);
  return true;
}();

}  // namespace
