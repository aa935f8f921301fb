// Whether a technique holds as many bytes as it reports, and uploads its geometry in build.
#include <gnomon/kit/geometry/shapes.h>
#include <malloc.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <fstream>
#include <map>
#include <optional>

#include "measure/conformance/motion_world.h"
#include "measure/conformance/trial.h"
#include "measure/program/elsewhere.h"

namespace gnomon::conformance {
namespace {

constexpr double MiB = 1 << 20;

/// Resident memory of this process, without what the driver and the allocator keep of freed memory.
double resident_bytes(TechniqueDevice& device) {
  device.settle();
  malloc_trim(0);
  std::ifstream statm("/proc/self/statm");
  double size = 0, resident = 0;
  statm >> size >> resident;
  return resident * static_cast<double>(sysconf(_SC_PAGESIZE));
}

/// A sphere of segments^2 triangles over a ground.
Scene ball(int segments) {
  Scene scene = generated_scene("sphere_over_plane:segments=4");
  scene.meshes[1] = tessellate(*scene.meshes[1].shape, segments, "sphere");
  return scene;
}

struct Figures {
  double reported = 0, growth = 0, seconds = 0;
  bool is_elsewhere = false;  ///< the technique works, and so holds its memory, in another process
  std::string text;
};

class Scales {
 public:
  explicit Scales(Trial& trial) : trial_(trial) {}

  /// From before setup to after resolve, under the first light that is supported; nothing when none is.
  std::optional<Figures> measure(int segments) {
    auto& w = worlds_[segments];
    if (!w) w = trial_.world(ball(segments));
    const std::vector<Light> lights = lights_of_all_kinds(w->scene);
    const auto light = std::ranges::find_if(lights, [&](const Light& l) { return bool(trial_.support(w->scene, l)); });
    if (light == lights.end()) return std::nullopt;
    trial_.at(fmt::format("sphere_over_plane:segments={}", segments));
    trial_.at(*light);
    const GBuffer gbuffer = w->gbuffer(w->scene.views[0], 320, 180);
    VisibilityMask mask(gbuffer.width, gbuffer.height);
    trial_.device().upload(w->scene, gbuffer, mask);
    Figures f;
    const double before = resident_bytes(trial_.device());
    const auto start = std::chrono::steady_clock::now();
    techniques_.push_back(trial_.set_up());  // it may keep what it warmed up with
    Technique* const technique = techniques_.back().get();
    technique->build(w->scene);
    technique->relight(*light);
    trial_.begin(*technique);
    technique->resolve(gbuffer, mask);
    f.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    f.growth = resident_bytes(trial_.device()) - before;
    f.is_elsewhere = elsewhere(*technique) != nullptr;
    f.reported = counted_bytes(technique->counts());
    f.text = fmt::format("{:.1f} MiB reported, resident memory grew by {:.1f} MiB", f.reported / MiB, f.growth / MiB);
    return f;
  }

 private:
  Trial& trial_;
  // All live to the end: what the driver frees late would change the next measurement.
  std::map<int, std::unique_ptr<World>> worlds_;
  std::vector<std::unique_ptr<Technique>> techniques_;
};

// From 6 thousand triangles to 400 thousand, until it takes half a second or holds 64 MiB. Both figures may be off by 8 MiB:
// arenas, drivers and libraries keep memory of their own. A software driver also keeps the memory of a draw, and frees it at
// any later time: the median of three measurements has to agree. Where each of them holds or frees such memory, 40 MiB of a
// picture that is blended, the mean of eight does: in their sum only the first and the last are left.
void reported_bytes(Trial& trial) {
  if (is_sanitized) return trial.does_not_apply("the sanitizer multiplies memory");
  if (trial.device().has_own_memory()) return trial.does_not_apply("textures lie in the memory of the device");
  mallopt(M_MMAP_THRESHOLD, 128 << 10);  // a constant one: what is large goes back when it is freed
  Scales scales(trial);
  // Threads, shaders and libraries come up.
  if (const auto first = scales.measure(40); first && first->is_elsewhere)
    return trial.does_not_apply("it holds its memory in a process of its own");
  for (const int segments : {80, 160, 320, 640}) {
    const double floor = 8 * MiB + (draws(trial.entry().about) ? 64.0 * segments * segments : 0);
    std::vector<Figures> measured;
    std::string texts;
    double growth = 0;
    const auto holds_more = [&] { return growth > 2 * measured.front().reported + floor; };
    const auto holds_less = [&] { return measured.front().reported > 2 * growth + floor; };
    for (const int times : {3, 8}) {
      while (std::ssize(measured) < times) {
        const auto figures = scales.measure(segments);
        if (!figures) return;
        texts += (measured.empty() ? "" : "; ") + figures->text;
        measured.push_back(*figures);
      }
      std::ranges::sort(measured, {}, &Figures::growth);
      double sum = 0;
      for (const Figures& figures : measured) sum += figures.growth;
      growth = times == 3 ? measured[1].growth : sum / times;
      if (!holds_more() && !holds_less()) break;
    }
    trial.expect(!holds_more(), "it holds more than it reports: " + texts);
    trial.expect(!holds_less(), "it reports more than it holds: " + texts);
    std::ranges::sort(measured, {}, &Figures::seconds);
    if (measured[measured.size() / 2].seconds > 0.5 || measured.front().reported > 64 * MiB) break;
  }
}

/// Where the scene moves, update uploads what moved, and no stage after it.
void geometry_in_update(Trial& trial) {
  MovingWorld world(moving_things(true), trial.entry().about.sees);
  trial.at(world.scene().name);
  for (const Light& light : trial.supported_lights(world.scene())) {
    trial.at(light);
    world.go_to(0);
    world.take_changes();
    const auto technique = trial.set_up();
    trial.answer(*technique, world.scene(), light, world.gbuffer());
    world.go_to(5);
    if (!trial.support(world.scene(), light)) continue;
    technique->update(world.scene(), world.take_changes());
    const std::uint64_t updated = uploaded_scene_bytes();
    technique->relight(light);
    trial.expect(uploaded_scene_bytes() == updated, "relight uploads the scene, which moved");
    trial.resolve(*technique, world.gbuffer());
    trial.expect(uploaded_scene_bytes() == updated, "resolve uploads the scene, which moved");
  }
}

// Twice: in a process that has seen nothing, and after the geometry changed.
void geometry_in_build(Trial& trial) {
  trial.under_each_light("box_city:count=12", [&](const World& w, const GBuffer& gbuffer, const Light& light) {
    const auto technique = trial.set_up();
    for (const char* when : {"", ", which changed"}) {
      forget_scene(w.scene);
      technique->build(w.scene);
      const std::uint64_t built = uploaded_scene_bytes();
      technique->relight(light);
      trial.expect(uploaded_scene_bytes() == built, fmt::format("relight uploads the scene{}", when));
      VisibilityMask mask(gbuffer.width, gbuffer.height);
      trial.begin(*technique);
      technique->resolve(gbuffer, mask);
      trial.expect(uploaded_scene_bytes() == built, fmt::format("resolve uploads the scene{}", when));
    }
  });
  geometry_in_update(trial);
}

}  // namespace

std::vector<Rule> memory_rules() {
  return {Rule("geometry_in_build", geometry_in_build,
               {.applies_to = AppliesTo::drawing, .has_small_pictures = true, .sanitized = Sanitized::nothing},
               "Build uploads the scene's triangles to OpenGL, so that its time includes the upload, and update those that "
               "moved. No later stage uploads them.",
               "Call scene_buffers(scene) in build and in update, also where only depth_stencil or a later stage needs "
               "them."),
          Rule("reported_bytes", reported_bytes, {.sanitized = Sanitized::nothing},
               "From 6 thousand to 400 thousand triangles, the count bytes grows as resident memory does, within a factor of "
               "two and 8 MiB.",
               "Count everything that the object holds after resolve, textures and buffers of OpenGL included: those of the "
               "kit return their bytes. What scene_buffers and gbuffer_textures hold is counted by the harness. What is only "
               "needed within a stage is freed at its end.",
               "Count everything that the program holds after resolve as bytes, or leave bytes out: then it is the growth "
               "of the process. What is only needed within a stage is freed at its end.")};
}

}  // namespace gnomon::conformance
