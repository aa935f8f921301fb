// What the reference under lights with area adds to Embree: sample_shares beside a bare loop of the same packed rays with the
// same filter, on the same number of threads, by turns. Target: at least 0.8 of the bare loop's rays a second. Then what a
// whole picture takes: the reference, read back from the cache, and the exact shares of every pixel.
//
// The contender draws places, sorts them, makes packets, traces them and adds up what they find. The bare loop finds its
// packets filled, in the same order; it stores 16 constants into each, because rtcOccluded16 overwrites them.
#include <benchmark/benchmark.h>
#include <gnomon/kit/area/area_rays.h>
#include <gnomon/kit/random.h>
#include <tbb/blocked_range.h>
#include <tbb/global_control.h>
#include <tbb/parallel_for.h>

#include <bit>
#include <cmath>

#include "bench/micro/alternate.h"
#include "bench/micro/scenes.h"
#include "kit/rays/embree.h"
#include "measure/frame/frame.h"
#include "measure/scratch_folder.h"

namespace {
using namespace gnomon;

constexpr int width = 640, height = 360;

/// A scene under a light with area at the place of its light `point`.
struct Place {
  const char* scene;
  LightKind kind;
};

const Place& place(std::int64_t index) {
  static const Place places[] = {{"bunny", DiscLight{{-2.6f, 3.6f, 2.0f}, {0.3f, -1, 0.2f}, 0.3f}},
                                 {"fence", DiscLight{{-1.5f, 2.6f, -3.5f}, {0.3f, -1, 0.2f}, 0.25f}},
                                 {"box_city", RectLight{{-7, 10, 5}, {1, 0.3f, 0}, {0, 0.2f, 0.7f}}}};
  return places[index];
}

Light light_of(const LightKind& kind) { return {.name = "lamp", .kind = kind}; }

/// One packet as the bare loop requires it, with lanes as Embree takes them: -1 is on.
struct Question {
  ShadowPacket packet;
  alignas(64) std::array<int, 16> valid;
  std::uint32_t mesh, triangle;
};

struct Context {
  embree::Context embree;
  const Question* question;
};

void exclude_receiver(const RTCFilterFunctionNArguments* args) {
  const Question& question = *reinterpret_cast<const Context*>(args->context)->question;
  for (unsigned lane = 0; lane < args->N; ++lane)
    if (args->valid[lane] != 0 && RTCHitN_geomID(args->hit, args->N, lane) == question.mesh &&
        RTCHitN_primID(args->hit, args->N, lane) == question.triangle)
      args->valid[lane] = 0;
}

/// Pixels of a picture, drawn at random, and the packets that sample_shares traces for each.
class Rig {
 public:
  /// A target that nothing meets: after the pilot of 64 rays, or 256 where they differ, 512 rays for every pixel.
  static constexpr AreaTarget target{.error = 1e-9, .cap = 512};

  Rig(const Scene& scene, const Light& light) : casters_(scene, Truth::mesh, RayScene::Which::casters) {
    const GBuffer gbuffer = seen(scene, scene.views[0], width, height);
    Random random(1);
    constexpr std::size_t pixel_count = 800;
    while (pixels_.size() < pixel_count) {
      const auto i = static_cast<std::size_t>(random.uniform(0, 1) * static_cast<double>(gbuffer.size()));
      if (gbuffer.is_background(i)) continue;
      const LightFigure figure(light, gbuffer.position(i), gbuffer.normal(i));
      if (!figure.is_seen()) continue;
      pixels_.push_back({FaceRays(casters_, gbuffer, i, figure), i, {}});
      Pixel& pixel = pixels_.back();
      pixel.shares = sample_shares(pixel.rays, i, target);
      add_packets(pixel, gbuffer);
    }
  }

  std::size_t ray_count() const { return ray_count_; }

  void sample() {
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, pixels_.size(), 4), [&](const auto& range) {
      for (std::size_t k = range.begin(); k < range.end(); ++k)
        pixels_[k].shares = sample_shares(pixels_[k].rays, pixels_[k].seed, target);
    });
  }

  void trace_bare() {
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, questions_.size(), 64), [&](const auto& range) {
      Context context;
      for (std::size_t i = range.begin(); i < range.end(); ++i) {
        context.question = &questions_[i];
        questions_[i].packet.tfar.fill(1.0f);
        embree::occlude(questions_[i].valid.data(), casters_.handle(), reinterpret_cast<RTCRay16*>(&questions_[i].packet),
                        context.embree, exclude_receiver);
      }
    });
  }

  /// Whether both found the same: of every pixel the share of blocked rays, without the pilot.
  bool agrees() const {
    for (const Pixel& pixel : pixels_) {
      std::size_t blocked = 0, asked = 0;
      for (std::size_t i = pixel.first; i < pixel.end; ++i)
        for (int k = 0; k < 16; ++k) {
          asked += questions_[i].valid[k] != 0;
          blocked += questions_[i].valid[k] != 0 && questions_[i].packet.tfar[k] < 0;
        }
      const double share = 1 - static_cast<double>(blocked) / static_cast<double>(asked);
      if (asked != pixel.shares.rays || std::abs(share - pixel.shares.area) > 1e-12) return false;
    }
    return true;
  }

 private:
  struct Pixel {
    FaceRays rays;
    std::uint64_t seed;
    SampledShares shares;
    std::size_t first = 0, end = 0;  ///< of the packets after the pilot
  };

  void add_packets(Pixel& pixel, const GBuffer& gbuffer) {
    const auto add = [&](const Scramble& scramble, std::uint32_t from, std::uint32_t to) {
      SortedRounds sorted;
      sorted.sort(scramble, from, to);
      for (std::uint32_t packet = 0; packet < sorted.packet_count(); ++packet) {
        Question question{
            .packet = {}, .valid = {}, .mesh = gbuffer.mesh[pixel.seed], .triangle = gbuffer.triangle[pixel.seed]};
        const std::uint32_t lanes = pixel.rays.aim_at(sorted.squares(packet), question.packet);
        for (int k = 0; k < 16; ++k) question.valid[k] = -static_cast<int>(lanes >> k & 1);
        if (lanes) questions_.push_back(question);
        ray_count_ += static_cast<std::size_t>(std::popcount(lanes));
      }
    };
    const Scramble pilot(2 * pixel.seed);
    add(pilot, 0, 4);
    if (pixel.shares.pilot_rays > 64) add(pilot, 4, 16);
    pixel.first = questions_.size();
    add(Scramble(2 * pixel.seed + 1), 0, 32);
    pixel.end = questions_.size();
  }

  RayScene casters_;
  std::vector<Pixel> pixels_;
  std::vector<Question> questions_;
  std::size_t ray_count_ = 0;
};

void rays(benchmark::State& state) {
  const Place& of = place(state.range(0));
  const Scene* scene = loaded(state, of.scene);
  if (!scene) return;
  Rig rig(*scene, light_of(of.kind));
  const tbb::global_control threads(tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(state.range(1)));
  rig.sample();
  rig.trace_bare();
  if (!rig.agrees()) return state.SkipWithError("the bare loop and sample_shares disagree");
  alternate(
      state, [&] { rig.sample(); }, [&] { rig.trace_bare(); });
  const double mega_rays = 1e-6 * static_cast<double>(rig.ray_count());
  state.counters["Mray/s"] = 1000 * mega_rays / state.counters["median_ms"];
  state.counters["bare_Mray/s"] = 1000 * mega_rays / state.counters["floor_ms"];
  state.counters["of_bare_rate"] = 1 / state.counters["ratio"];
  state.counters["of_bare_rate_cpu"] = 1 / state.counters["cpu_ratio"];
  state.SetLabel(of.scene);
}

/// The bunny under a disc of 0.3 m: from nothing, and read back.
void picture(benchmark::State& state) {
  const Scene* scene = loaded(state, "bunny");
  if (!scene) return;
  const Light light = light_of(place(0).kind);
  const FrameKey key{scene->views[0], width, height, Truth::shape};
  const ScratchFolder folder = ScratchFolder::temporary("gnomon_bench");
  FrameStore first(*scene, folder.path());
  first.gbuffer(key);
  Timings traced, read;
  double rays = 0;
  for (auto _ : state) {
    FrameStore frames(*scene, folder.path());
    for (const auto& entry : std::filesystem::directory_iterator(folder.path()))
      if (entry.path().extension() == ".reference") std::filesystem::remove(entry.path());
    state.SetIterationTime(traced.add([&] { frames.reference(key, light); }));
    FrameStore others(*scene, folder.path());
    rays = 0;
    read.add([&] {
      for (const std::uint32_t of_pixel : others.reference(key, light).rays) rays += of_pixel;
    });
  }
  state.counters["cpu_s"] = traced.cpu_median();
  state.counters["read_ms"] = 1000 * read.median();
  state.counters["Mray"] = 1e-6 * rays;
}

/// exact_area on the bunny under a rectangle of 0.6 x 0.6 m.
void exact(benchmark::State& state) {
  const Scene* scene = loaded(state, "bunny");
  if (!scene) return;
  const ScratchFolder folder = ScratchFolder::temporary("gnomon_bench");
  FrameStore frames(*scene, folder.path());
  const GBuffer gbuffer = frames.gbuffer({scene->views[0], width, height, Truth::mesh});
  const Light light = light_of(RectLight{{-2.6f, 3.6f, 2.0f}, {0.3f, 0, 0}, {0, 0, 0.3f}});
  const auto technique = made("exact_area", "", *scene, light);
  VisibilityMask mask(width, height);
  Timings timings;
  for (auto _ : state) state.SetIterationTime(timings.add([&] { technique->resolve(gbuffer, mask); }));
  state.counters["cpu_s"] = timings.cpu_median();
  for (const Count& count : technique->counts()) state.counters[count.name] = count.value;
}

[[maybe_unused]] const bool is_registered = [] {
  add_timed("soft_reference/rays", rays)->ArgNames({"scene", "threads"})->ArgsProduct({{0, 1, 2}, {1, 2}});
  add_timed("soft_reference/picture", picture)->Iterations(1);
  add_timed("soft_reference/exact_area", exact)->Iterations(1);
  return true;
}();

}  // namespace
