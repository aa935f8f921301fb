#include <gnomon/kit/gl.h>
#include <gnomon/kit/light_objects.h>
#include <gnomon/kit/progress.h>
#include <gnomon/kit/surface_detail.h>
#include <gnomon/registry.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <cmath>
#include <deque>
#include <map>
#include <utility>

#include "device/context.h"
#include "measure/cause/causes.h"
#include "measure/picture/detail_export.h"
#include "measure/process_memory.h"
#include "measure/program/elsewhere.h"
#include "measure/run/shared_count.h"
#include "measure/run/worker.h"
#include "measure/run/worker_device.h"
#include "measure/run/worker_frame.h"
#include "measure/run/worker_roll.h"
#include "measure/run/worker_words.h"

namespace gnomon {

namespace {

using Clock = std::chrono::steady_clock;

/// Serves requests for one technique: it has the scene and the frame, and knows which stages are up to date.
class TechniqueServer {
 public:
  Json handle(const Json& request) {
    const std::string what = request.at("do");
    if (what == "protocol")
      return json_object({{"protocol", worker_protocol}, {"takes_iterations", true}, {"context", machine_context(0)}});
    if (what == "open") return open(request);
    if (what == "trace") return trace(request);
    if (const auto answer = answer_of_roll(request)) return *answer;
    if (!objects_) throw Error("a worker cannot {} before it has a technique", what);
    if (what == "set") return set(request.at("settings"));
    if (what == "frame") return frame(request);
    if (what == "time") return time_stage(stage_named(request.at("stage")), request.value("iterations", 1.0));
    if (what == "floor") return floor(request.at("times"));
    if (what == "card") return json_object({{"card", uses_gl_ ? card_json(process_context().info()) : Json()}});
    if (what == "bring_up") return bring_up(stage_named(request.at("stage")));
    if (what == "answer") return answer(request.at("mask"));
    if (what == "mask") return write_mask(request.at("mask"));
    if (what == "explain") return explain(request);
    if (what == "debug") return debug(request);
    if (what == "global") return global(request);
    if (what == "detail") return detail(request);
    throw Error("a worker cannot {}", what);
  }

 private:
  Json open(const Json& request) {
    if (tracer_) throw Error("a worker that traces serves no technique");
    scene_ = scene_in(request.at("scene"));
    entry_ = &registry().technique(request.at("technique").get<std::string>());
    objects_.emplace(*entry_, request.at("settings").get<std::string>());
    settings_ = request.at("settings").get<std::string>();
    fresh_ = -1;
    masks_.clear();
    lights_.reset();
    if (request.contains("progress")) {
      watch_progress(nullptr);
      progress_.emplace(request.at("progress").get<std::string>());
      watch_progress(&progress_->value());
    }
    uses_gl_ = entry_->about.needs_gl;
    if (!uses_gl_) return json_object({{"gl", nullptr}});
    const GlInfo& info = process_context().info();
    // llvmpipe's marks are not in order with its work: 0.2 ms for a resolve of 5, 2.6 for a build of 0.03.
    if (info.driver != GlChoice::software) stopwatch_.emplace();
    return json_object({{"gl", json_object({{"renderer", info.renderer},
                                            {"version", info.version},
                                            {"subpixel_bits", gl_limits()->subpixel_bits},
                                            {"card", card_json(info)}})}});
  }

  /// What a parameter spoils is out of date from then on; the rest stays.
  Json set(const std::string& settings) {
    settings_ = settings;
    if (const auto spoiled = objects_->set(settings)) fresh_ = std::min(fresh_, static_cast<int>(*spoiled) - 1);
    return json_object({{"fresh", fresh_ + 1}});
  }

  Json frame(const Json& request) {
    const AskedFrame asked = asked_frame(request, scene_);
    // A viewer makes a new G-buffer with every move of the camera and does not come back to an old one.
    if (asked.is_free) std::erase_if(gbuffers_, [&](const auto& known) { return known.first != request.at("gbuffer"); });
    fresh_ = std::min(fresh_, static_cast<int>(asked.lit_by == lit_by_ ? Stage::relight : Stage::build));
    if (!lights_ || asked.lit_by != lit_by_) lights_ = std::make_unique<std::vector<Light>>(asked.lights);
    lit_by_ = asked.lit_by;
    // The same G-buffer under another light stays mapped, and uploaded.
    const std::string file = request.at("gbuffer");
    GBuffer& known = gbuffers_[file];
    if (known.width != asked.key.width || known.height != asked.key.height) known = map_gbuffer(file, asked.key);
    bare_pass_.reset();
    gbuffer_ = known;
    const std::vector<Support> supports = hold_objects(asked.key);
    const Support support = support_together(*lights_, supports);
    Json result = support_json(support);
    result["fresh"] = fresh_ + 1;
    if (supports.size() > 1) {
      for (const Support& one : supports) result["lights"].push_back(support_json(one));
      if (const auto shares = objects_->shares()) result["shares"] = *shares;
    }
    if (uses_gl_ && support) {
      const SceneBuffers& buffers = scene_buffers(scene_);
      const GBufferTextures& textures = gbuffer_textures(gbuffer_, scene_);
      const DepthStencil& depth = depth_stencil(scene_, gbuffer_, entry_->about.sees);
      result["input_bytes"] = buffers.bytes + textures.bytes + depth.bytes;
      result["upload_ms"] = buffers.upload_ms + textures.upload_ms + depth.upload_ms;
      if (entry_->about.floor != Floor::none) result["floor"] = name(entry_->about.floor);
    }
    return result;
  }

  /// A mask for each light, and an object for each that the technique supports. What it says of each.
  std::vector<Support> hold_objects(const FrameKey& key) {
    const auto technique = fresh_technique();
    const Support inputs = uses_gl_ ? within_limits(inputs_need(scene_, key.width, key.height)) : Support::full();
    std::vector<Support> supports;
    masks_.clear();
    const std::vector<std::size_t> before = std::exchange(lit_, {});
    for (std::size_t k = 0; k < lights_->size(); ++k) {
      supports.push_back(inputs ? technique->supports(scene_, (*lights_)[k], key.view) : inputs);
      masks_.emplace_back(key.width, key.height);
      if (supports.back()) lit_.push_back(k);
      // A light without shadows, of several: lit everywhere.
      if (!supports.back()) std::ranges::fill(masks_.back().pixels(), 1.0f);
    }
    if (objects_->hold(lit_.size())) fresh_ = -1;
    // What a technique supports may depend on the view: an object then stands for another light, or is new.
    if (lit_ != before) fresh_ = std::min(fresh_, static_cast<int>(Stage::build));
    return supports;
  }

  /// Serves the reference instead of a technique; all requests are of one scene.
  Json trace(const Json& request) {
    if (objects_) throw Error("a worker that serves a technique does not trace");
    if (!tracer_) {
      scene_ = scene_in(request.at("scene"));
      tracer_.emplace(scene_);
    }
    const Scene holder = scene_in(request.at("stand"));
    MissingFrame missing{.scene_file = {}, .key = {.view = holder.views.at(0)}, .light = {}, .gbuffer_file = {}};
    set_size_and_truth(missing.key, request);
    if (!holder.lights.empty()) missing.light = holder.lights[0];
    missing.gbuffer_file = request.at("gbuffer").get<std::string>();
    missing.target = {.error = request.at("error"), .cap = request.at("cap")};
    if (!(missing.target.error >= 1e-6)) throw Error("a reference's error = {} is below 1e-6", missing.target.error);
    missing.subpixel_bits = request.value("subpixel_bits", usual_subpixel_bits);
    missing.global_samples = request.value("global_samples", 0);
    SharedCount done(request.value("done", ""));
    missing.done = &done.value();
    write_file(request.at("out").get<std::string>(), tracer_->make(missing));
    return Json::object();
  }

  Json time_stage(int stage, double iterations) {
    if (!(iterations >= 1)) throw Error("iterations = {} is below 1", iterations);
    bring_up(stage - 1);
    double own_sum = 0, harness_sum = 0;
    bool is_own = false;
    std::optional<double> device_sum = 0;
    int done = 0;
    const auto start = Clock::now();
    const std::chrono::duration<double> longest(longest_portion_seconds);
    do {
      const StageTime time = this->time(static_cast<Stage>(stage));
      harness_sum += time.harness_ms;
      own_sum += time.own_ms.value_or(time.harness_ms);
      is_own = is_own || time.own_ms;
      const auto device_ms = stopwatch_ ? stopwatch_->milliseconds() : std::nullopt;
      device_sum = device_sum && device_ms ? std::optional(*device_sum + *device_ms) : std::nullopt;
      ++done;
    } while (done < iterations && Clock::now() - start < longest);
    Json result = json_object({{"ms", own_sum}, {"iterations", done}});
    if (is_own) result["harness_ms"] = harness_sum;
    if (device_sum) result["device_ms"] = *device_sum;
    return result;
  }

  /// The bare pass that the technique names, so many times in a row.
  Json floor(double times) {
    if (!bare_pass_) bare_pass_.emplace(entry_->about.floor, scene_, gbuffer_);
    return bare_pass_->time(times, stopwatch_ ? &*stopwatch_ : nullptr);
  }

  Json bring_up(int stage) {
    for (int s = fresh_ + 1; s <= stage; ++s) time(static_cast<Stage>(s));
    return Json::object();
  }

  struct StageTime {
    double harness_ms;
    std::optional<double> own_ms;  ///< by the technique's own clock, where it has one
  };
  /// Does one stage; what follows it is out of date then.
  StageTime time(Stage stage) {
    if (stage >= Stage::relight && masks_.empty()) throw Error("a worker cannot {} before it has a frame", name(stage));
    if (stage >= Stage::relight && lit_.empty())
      throw Error("a worker cannot {} lights that its technique refuses", name(stage));
    if (uses_gl_) glFinish();
    std::optional<double> own_ms;
    const auto start = Clock::now();
    if (stopwatch_) stopwatch_->start();
    objects_->each(stage, [&](Technique& technique, std::size_t k) {
      switch (stage) {
        case Stage::setup:
          technique.setup();
          break;
        case Stage::build:
          technique.build(scene_);
          break;
        case Stage::relight:
          technique.relight((*lights_)[lit_[k]]);
          break;
        case Stage::resolve:
          technique.resolve(gbuffer_, masks_[lit_[k]]);
          break;
      }
      if (const WorksElsewhere* const there = elsewhere(technique))
        if (const auto ms = there->own_ms()) own_ms = own_ms.value_or(0) + *ms;
    });
    if (stopwatch_) stopwatch_->stop();
    if (uses_gl_) glFinish();
    const double ms = std::chrono::duration<double, std::milli>(Clock::now() - start).count();
    if (uses_gl_)
      if (const GLenum code = glGetError(); code != GL_NO_ERROR) throw Error("OpenGL error {:#x}", code);
    fresh_ = static_cast<int>(stage);
    if (own_ms && !(*own_ms >= 0 && *own_ms <= ms))
      throw Error("{} took {:g} ms by the technique's own clock, {:g} ms by the harness's", name(stage), *own_ms, ms);
    return {.harness_ms = ms, .own_ms = own_ms};
  }

  Json write_mask(const std::string& path) {
    bring_up(static_cast<int>(Stage::resolve));
    std::vector<float> all;
    for (VisibilityMask& mask : masks_) all.insert(all.end(), mask.read().begin(), mask.read().end());
    write_file(path, std::as_bytes(std::span(all)));
    return Json::object();
  }

  Json answer(const std::string& path) {
    write_mask(path);
    const double peak = peak_bytes();  // counting may build or draw once more
    Json counts = Json::array();
    for (const Count& c : objects_->counts()) {
      if (!std::isfinite(c.value)) throw Error("count {} is {}", c.name, c.value);
      counts.push_back(json_object({{"name", c.name}, {"value", c.value}, {"unit", c.unit}}));
    }
    const WorksElsewhere* const there = elsewhere((*objects_)[0]);
    return json_object({{"counts", counts}, {"peak_bytes", peak}, {"maker", there ? there->maker() : ""}});
  }

  /// Asks the technique about the listed pixels (uint32 indices) and writes its explanations.
  Json explain(const Json& request) {
    Technique* const technique = object_of(request);
    const std::string pixels = request.at("pixels"), out = request.at("out");
    bring_up(static_cast<int>(Stage::resolve));
    const auto file = MappedFile::open(pixels);
    const std::size_t count = file->bytes().size() / sizeof(std::uint32_t);
    const auto* index = reinterpret_cast<const std::uint32_t*>(file->bytes().data());
    for (std::size_t k = 0; k < count; ++k)
      if (index[k] >= gbuffer_.size()) throw Error("there is no pixel {}: the picture has {}", index[k], gbuffer_.size());
    const Explanation not_covered{.covered = false, .taps = {}, .shifted = {}, .element = {}};
    const auto explanations =
        technique ? explain_all(*technique, {index, count}) : std::vector<std::optional<Explanation>>(count, not_covered);
    if (explanations.size() != count) throw Error("{} explanations came for {} pixels", explanations.size(), count);
    write_file(out, explanation_bytes(explanations));
    const bool explained = std::ranges::any_of(explanations, [](const auto& why) { return why.has_value(); });
    return json_object({{"explained", explained}});
  }

  Json debug(const Json& request) {
    bring_up(static_cast<int>(Stage::resolve));
    const std::vector<float> rgb = must_have(object_of(request)).draw_debug(request.at("layer").get<std::string>());
    write_file(request.at("out").get<std::string>(), std::as_bytes(std::span(rgb)));
    return Json::object();
  }

  Json global(const Json& request) {
    bring_up(static_cast<int>(Stage::resolve));
    const std::optional<std::vector<float>> rgb = must_have(object_of(request)).global_picture();
    if (rgb) write_file(request.at("out").get<std::string>(), std::as_bytes(std::span(*rgb)));
    return json_object({{"has_picture", rgb.has_value()}});
  }

  Json detail(const Json& request) {
    bring_up(static_cast<int>(Stage::relight));
    const std::optional<SurfaceDetail> detail = must_have(object_of(request)).surface_detail();
    if (!detail) throw Error("{} gave no surface detail, though a fresh one does", entry_->id);
    check_detail(scene_, *detail);
    write_file(request.at("out").get<std::string>(), detail_bytes(*detail));
    return Json::object();
  }

  /// Of the light that a request asks about, the first by default; null where that casts no shadows.
  Technique* object_of(const Json& request) {
    const std::size_t light = request.value("light", std::size_t{0});
    if (light >= masks_.size()) throw Error("there is no light {}: the frame has {}", light, masks_.size());
    const auto found = std::ranges::find(lit_, light);
    return found == lit_.end() ? nullptr : &(*objects_)[static_cast<std::size_t>(found - lit_.begin())];
  }
  static Technique& must_have(Technique* object) {
    if (!object) throw Error("the technique does not support this light");
    return *object;
  }

  std::unique_ptr<Technique> fresh_technique() const {
    auto technique = entry_->make();
    technique->apply(settings_);
    return technique;
  }

  Scene scene_;
  const TechniqueEntry* entry_ = nullptr;
  std::string settings_;
  std::optional<LightObjects> objects_;
  bool uses_gl_ = false;
  std::optional<SharedCount> progress_;         ///< what techniques tell of a stage under way
  std::optional<DeviceStopwatch> stopwatch_;    ///< with GL, where the device's clock can be believed
  std::string lit_by_;                          ///< of the lights that the technique was given last
  std::unique_ptr<std::vector<Light>> lights_;  ///< those lights
  std::deque<VisibilityMask> masks_;            ///< of each
  std::vector<std::size_t> lit_;                ///< the light of each object
  std::map<std::string, GBuffer> gbuffers_;     ///< by file: one for each view and truth
  GBuffer gbuffer_;
  std::optional<TimedBarePass> bare_pass_;  ///< of the frame
  std::optional<FrameTracer> tracer_;
  int fresh_ = -1;  ///< last stage that is up to date
};

}  // namespace

int worker_main(int socket, int threads) {
  std::optional<tbb::global_control> limit;
  if (threads > 0) limit.emplace(tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(threads));
  // Leaked on purpose: the process ends by being killed, and a technique's destructor is no part of a measurement.
  TechniqueServer& server = *new TechniqueServer;
  answer_lines(socket, [&](const Json& request) { return server.handle(request); });
}

}  // namespace gnomon
