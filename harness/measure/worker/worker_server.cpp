#include "measure/worker/worker_server.h"

#include <gnomon/kit/bases/light_objects.h>
#include <gnomon/kit/pictures/surface_detail.h>
#include <gnomon/kit/progress.h>
#include <gnomon/registry.h>
#include <tbb/global_control.h>

#include <deque>
#include <set>

#include "measure/cause/causes.h"
#include "measure/picture/detail_export.h"
#include "measure/process_memory.h"
#include "measure/program/elsewhere.h"
#include "measure/progress.h"
#include "measure/scene/channels.h"
#include "measure/worker/counted_stage.h"
#include "measure/worker/machine_context.h"
#include "measure/worker/requested_frame.h"
#include "measure/worker/shared_count.h"
#include "measure/worker/worker_device.h"

namespace gnomon {

namespace {

/// Serves requests for one technique: it has the scene, the frame, and the number of stages that are up to date.
class TechniqueServer {
 public:
  TechniqueServer() {
    answers_.on<ProtocolRequest>([](const ProtocolRequest&) {
      return ProtocolRequest::Reply{.protocol = worker_protocol, .context = program_context()};
    });
    answers_.on<OpenRequest>([this](const auto& request) { return open(request); });
    answers_.on<TraceRequest>([this](const auto& request) {
      if (objects_) throw Error("a worker that serves a technique does not trace");
      return traces_.make(request);
    });
    answer_roll(answers_);
    on<SetRequest>([this](const auto& request) { return set(request.settings); });
    on<GoRequest>([this](const auto& request) { return frame(request); });
    on<TimeRequest>([this](const auto& request) { return time_stage(request); });
    on<FloorRequest>([this](const auto& request) { return floor(request.times); });
    on<CardRequest>(
        [this](const auto&) { return CardRequest::Reply{uses_gl_ ? card_json(process_context().info()) : std::nullopt}; });
    on<BringUpRequest>([this](const auto& request) { return bring_up(request.stage); });
    on<AnswerRequest>([this](const auto& request) { return answer(request.mask); });
    on<MaskRequest>([this](const auto& request) { return write_mask(request.mask); });
    on<ExplainRequest>([this](const auto& request) { return explain(request); });
    on<DepthCurveRequest>([this](const auto& request) { return depth_curve(request); });
    on<DebugRequest>([this](const auto& request) { return debug(request); });
    on<GlobalRequest>([this](const auto& request) { return global(request); });
    on<DetailRequest>([this](const auto& request) { return detail(request); });
  }

  Json handle(const Json& request) const { return answers_(request); }

 private:
  /// Of a request that requires a technique.
  template <class Request, class Answer>
  void on(Answer answer) {
    answers_.on<Request>([this, answer](const Request& request) {
      if (!objects_) throw Error("a worker cannot {} before it has a technique", Request::verb);
      return answer(request);
    });
  }

  OpenRequest::Reply open(const OpenRequest& request) {
    if (!traces_.is_empty()) throw Error("a worker that traces serves no technique");
    forget_frame();
    scene_ = scene_in(request.scene);
    channels_.emplace(scene_);
    entry_ = &registry().technique(request.technique);
    objects_.emplace(*entry_, request.settings);
    settings_ = request.settings;
    watch_progress(nullptr);
    progress_.emplace(request.progress);
    watch_progress(&progress_->value());
    uses_gl_ = entry_->about.needs_gl;
    if (!uses_gl_) return {};
    const GlInfo& info = process_context().info();
    // llvmpipe's marks are not in order with its work: 0.2 ms for a resolve of 5, 2.6 for a build of 0.03.
    if (info.driver != GlChoice::software) stopwatch_.emplace();
    return {WorkerGl{.renderer = info.renderer,
                     .version = info.version,
                     .subpixel_bits = static_cast<int>(gl_limits()->subpixel_bits),
                     .card = card_json(info)}};
  }

  /// All that is of the scene before.
  void forget_frame() {
    if (uses_gl_) inputs_.forget(scenes());
    fresh_ = -1;
    masks_.clear();
    lit_.clear();
    lit_by_.clear();
    lights_.reset();
    gbuffers_.clear();
    gbuffer_ = {};
    bare_pass_.reset();
  }

  /// What a parameter spoils is out of date from then on; the rest stays.
  SetRequest::Reply set(const std::string& settings) {
    settings_ = settings;
    if (const auto spoiled = objects_->set(settings)) fresh_ = std::min(fresh_, static_cast<int>(*spoiled) - 1);
    return {fresh_ + 1};
  }

  GoRequest::Reply frame(const GoRequest& request) {
    const RequestedFrame requested = requested_frame(request, scene_);
    // A viewer makes a new G-buffer with every move of the camera and does not come back to an old one.
    if (requested.is_free) std::erase_if(gbuffers_, [&](const auto& known) { return known.first != request.gbuffer; });
    fresh_ = std::min(fresh_, static_cast<int>(requested.lit_by == lit_by_ ? Stage::relight : Stage::build));
    if (!lights_ || requested.lit_by != lit_by_) lights_ = std::make_unique<std::vector<Light>>(requested.lights);
    lit_by_ = requested.lit_by;
    // The same G-buffer under another light stays mapped, and uploaded.
    GBuffer& known = gbuffers_[request.gbuffer];
    if (known.width != requested.key.width || known.height != requested.key.height)
      known = map_gbuffer(request.gbuffer, requested.key);
    bare_pass_.reset();
    gbuffer_ = known;
    const std::vector<Support> supports = hold_objects(requested.key);
    const Support support = support_of_row(*lights_, supports);
    GoRequest::Reply reply{.support = reply_of(support), .fresh = fresh_ + 1};
    for (const Support& one : supports) reply.lights.push_back(reply_of(one));
    if (supports.size() > 1) reply.shares = objects_->shares();
    if (uses_gl_ && support && entry_->about.floor != Floor::none) reply.floor = name(entry_->about.floor);
    return reply;
  }

  /// Makes a mask for each light, and an object for each that the technique supports. Returns its support of each.
  std::vector<Support> hold_objects(const FrameKey& key) {
    const auto technique = entry_->make();
    technique->apply(settings_);
    const Support inputs = uses_gl_ ? within_limits(inputs_need(scene_, key.width, key.height)) : Support::full();
    std::vector<Support> supports;
    std::vector<std::size_t> scenes;  // by number, of the lights that are supported
    masks_.clear();
    const std::vector<std::size_t> before = std::exchange(lit_, {});
    for (std::size_t k = 0; k < lights_->size(); ++k) {
      const Light& light = (*lights_)[k];
      supports.push_back(inputs ? support_of(entry_->about, *technique, channels_->of(light), light, key.view) : inputs);
      masks_.emplace_back(key.width, key.height);
      if (supports.back()) lit_.push_back(k);
      if (supports.back()) scenes.push_back(static_cast<std::size_t>(channel_of(light.name).value_or(Channel::red)));
      // A light without shadows, of several: lit everywhere.
      if (!supports.back()) std::ranges::fill(masks_.back().pixels(), 1.0f);
    }
    if (scenes.empty() ? objects_->hold(1) : objects_->hold_by_scene(scenes)) fresh_ = -1;
    // What a technique supports may depend on the view: an object then belongs to another light, or is new.
    if (lit_ != before) fresh_ = std::min(fresh_, static_cast<int>(Stage::build));
    return supports;
  }

  TimeRequest::Reply time_stage(const TimeRequest& request) {
    if (request.iterations < 1) throw Error("iterations = {} is below 1", request.iterations);
    if (request.stage > Stage::setup) bring_up(static_cast<Stage>(static_cast<int>(request.stage) - 1));
    double harness_sum = 0;
    bool is_own = false;
    TimeRequest::Reply reply{.device_ms = 0};
    const auto start = std::chrono::steady_clock::now();
    do {
      const StageTime time = this->time(request.stage);
      harness_sum += time.harness_ms;
      reply.ms += time.own_ms.value_or(time.harness_ms);
      is_own = is_own || time.own_ms;
      const auto device_ms = stopwatch_ ? stopwatch_->milliseconds() : std::nullopt;
      reply.device_ms = reply.device_ms && device_ms ? std::optional(*reply.device_ms + *device_ms) : std::nullopt;
      ++reply.iterations;
    } while (reply.iterations < request.iterations && seconds_since(start) < longest_portion_seconds);
    if (is_own) reply.harness_ms = harness_sum;
    return reply;
  }

  /// The bare pass of the data sheet, so many times in a row.
  FloorRequest::Reply floor(int times) {
    const Scene& scene = **scenes().begin();
    return inputs_.beside(scene, [&] {
      if (!bare_pass_) bare_pass_.emplace(entry_->about.floor, scene, gbuffer_);
      return bare_pass_->time(times, stopwatch_ ? &*stopwatch_ : nullptr);
    });
  }

  Done bring_up(Stage last) {
    for (const Stage stage : all_stages)
      if (stage <= last && static_cast<int>(stage) > fresh_) time(stage);
    return {};
  }

  struct StageTime {
    double harness_ms;
    std::optional<double> own_ms;  ///< by the technique's own clock, where it has one
  };
  /// Does one stage; the later ones are out of date then.
  StageTime time(Stage stage) {
    if (stage >= Stage::relight && masks_.empty()) throw Error("a worker cannot {} before it has a frame", name(stage));
    if (stage >= Stage::relight && lit_.empty())
      throw Error("a worker cannot {} lights that its technique refuses", name(stage));
    if (uses_gl_) inputs_.prepare(stage, scenes(), gbuffer_);
    std::optional<double> own_ms;
    std::optional<CountedStage> counted(std::in_place, name(stage).data());
    const auto start = std::chrono::steady_clock::now();
    if (stopwatch_) stopwatch_->start();
    objects_->each(stage, [&](Technique& technique, std::size_t k) {
      if (stage == Stage::setup) technique.setup();
      if (stage == Stage::build) technique.build(lit_.empty() ? scene_ : channels_->of((*lights_)[lit_[k]]));
      if (stage == Stage::relight) technique.relight((*lights_)[lit_[k]]);
      if (stage == Stage::resolve) technique.resolve(gbuffer_, masks_[lit_[k]]);
      if (const WorksElsewhere* const there = elsewhere(technique))
        if (const auto ms = there->own_ms()) own_ms = own_ms.value_or(0) + *ms;
    });
    if (stopwatch_) stopwatch_->stop();
    if (uses_gl_) glFinish();
    const double ms = std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
    counted.reset();
    if (const GLenum code = uses_gl_ ? glGetError() : GLenum{GL_NO_ERROR}; code != GL_NO_ERROR)
      throw Error("OpenGL error {:#x}", code);
    fresh_ = static_cast<int>(stage);
    if (uses_gl_) inputs_.end_stage();
    if (own_ms && !(*own_ms >= 0 && *own_ms <= ms))
      throw Error("{} took {:g} ms by the technique's own clock, {:g} ms by the harness's", name(stage), *own_ms, ms);
    return {.harness_ms = ms, .own_ms = own_ms};
  }

  Done write_mask(const std::string& path) {
    bring_up(Stage::resolve);
    std::vector<float> all;
    for (VisibilityMask& mask : masks_) all.insert(all.end(), mask.read().begin(), mask.read().end());
    write_file(path, std::as_bytes(std::span(all)));
    return {};
  }

  AnswerRequest::Reply answer(const std::string& path) {
    write_mask(path);
    const auto peak = static_cast<std::uint64_t>(peak_bytes());  // first: counting may build or draw once more
    AnswerRequest::Reply reply{.counts = objects_->counts(), .peak_bytes = peak};
    if (uses_gl_) {
      reply.gl = inputs_.facts(scenes(), gbuffer_);
      for (Count& count : reply.counts)
        if (count.name == "bytes") count.value += static_cast<double>(*reply.gl->geometry_bytes);
    }
    for (const Count& c : reply.counts)
      if (!std::isfinite(c.value)) throw Error("count {} is {}", c.name, c.value);
    if (const WorksElsewhere* const there = elsewhere((*objects_)[0])) reply.maker = there->maker();
    return reply;
  }

  /// Writes the technique's explanations of the listed pixels (uint32 indices).
  ExplainRequest::Reply explain(const ExplainRequest& request) {
    Technique* const technique = object_of(request.light);
    bring_up(Stage::resolve);
    const auto file = MappedFile::open(request.pixels);
    const std::span pixels(reinterpret_cast<const std::uint32_t*>(file->bytes().data()),
                           file->bytes().size() / sizeof(std::uint32_t));
    for (const std::uint32_t pixel : pixels) require_pixel(pixel);
    const Explanation not_covered{.covered = false, .taps = {}, .shifted = {}, .element = {}};
    const auto explanations =
        technique ? explain_all(*technique, pixels) : std::vector<std::optional<Explanation>>(pixels.size(), not_covered);
    if (explanations.size() != pixels.size())
      throw Error("{} explanations came for {} pixels", explanations.size(), pixels.size());
    write_file(request.out, explanation_bytes(explanations));
    return {std::ranges::any_of(explanations, [](const auto& why) { return why.has_value(); })};
  }

  DepthCurveRequest::Reply depth_curve(const DepthCurveRequest& request) {
    bring_up(Stage::resolve);
    require_pixel(request.pixel);
    const Technique* const technique = object_of(request.light);
    return {technique ? technique->depth_curve(request.pixel) : std::nullopt};
  }

  Done debug(const DebugRequest& request) {
    bring_up(Stage::resolve);
    const std::vector<float> rgb = must_have(object_of(request.light)).draw_debug(request.layer);
    write_file(request.out, std::as_bytes(std::span(rgb)));
    return {};
  }

  GlobalRequest::Reply global(const GlobalRequest& request) {
    bring_up(Stage::resolve);
    const std::optional<std::vector<float>> rgb = must_have(object_of(request.light)).global_picture();
    if (rgb) write_file(request.out, std::as_bytes(std::span(*rgb)));
    return {rgb.has_value()};
  }

  Done detail(const DetailRequest& request) {
    bring_up(Stage::relight);
    const std::optional<SurfaceDetail> detail = must_have(object_of(request.light)).surface_detail();
    if (!detail) throw Error("{} gave no surface detail, though a fresh one does", entry_->id);
    check_detail(scene_, *detail);
    write_file(request.out, detail_bytes(*detail));
    return {};
  }

  /// The object of one of the frame's lights; null where that casts no shadows.
  Technique* object_of(std::size_t light) {
    if (light >= masks_.size()) throw Error("there is no light {}: the frame has {}", light, masks_.size());
    const auto found = std::ranges::find(lit_, light);
    return found == lit_.end() ? nullptr : &(*objects_)[static_cast<std::size_t>(found - lit_.begin())];
  }
  static Technique& must_have(Technique* object) {
    if (!object) throw Error("the technique does not support this light");
    return *object;
  }

  void require_pixel(std::uint32_t pixel) const {
    if (pixel >= gbuffer_.size()) throw Error("there is no pixel {}: the picture has {}", pixel, gbuffer_.size());
  }
  /// Those that objects are built on; before there is a frame the scene itself.
  std::set<const Scene*> scenes() {
    std::set<const Scene*> scenes;
    for (const std::size_t k : lit_) scenes.insert(&channels_->of((*lights_)[k]));
    return scenes.empty() ? std::set<const Scene*>{&scene_} : scenes;
  }

  Answers answers_;
  Scene scene_;
  std::optional<ChannelScenes> channels_;
  const TechniqueEntry* entry_ = nullptr;
  std::string settings_;
  std::optional<LightObjects> objects_;
  bool uses_gl_ = false;
  std::optional<SharedCount> progress_;         ///< of the stage under way
  std::optional<DeviceStopwatch> stopwatch_;    ///< with GL, where the device's clock is reliable
  std::string lit_by_;                          ///< of the lights that the technique was given last
  std::unique_ptr<std::vector<Light>> lights_;  ///< those lights
  std::deque<VisibilityMask> masks_;            ///< of each
  std::vector<std::size_t> lit_;                ///< the light of each object
  std::map<std::string, GBuffer> gbuffers_;     ///< by file: one for each view and truth
  GBuffer gbuffer_;
  std::optional<TimedBarePass> bare_pass_;  ///< of the frame
  RequestedTraces traces_;
  int fresh_ = -1;       ///< last stage that is up to date
  StagedInputs inputs_;  ///< with GL
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
