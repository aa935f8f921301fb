#include "measure/worker/technique_frame.h"

#include <gnomon/kit/progress.h>

#include "device/stopwatch.h"
#include "measure/program/elsewhere.h"
#include "measure/progress.h"
#include "measure/worker/counted_stage.h"

namespace gnomon {

TechniqueFrame::~TechniqueFrame() {
  if (progress_) watch_progress(nullptr);
}

OpenRequest::Reply TechniqueFrame::open(const TechniqueEntry& entry, const OpenRequest& request) {
  forget_frame();
  posed_.reset();
  scene_ = scene_in(request.scene);
  posed_.emplace(scene_);
  channels_.emplace(scene_);
  entry_ = &entry;
  objects_.emplace(*entry_, request.settings);
  settings_ = request.settings;
  watch_progress(nullptr);
  progress_.emplace(request.progress);
  watch_progress(&progress_->value());
  device_ = device_of(entry_->about);
  return {device_->description()};
}

void TechniqueFrame::forget_frame() {
  device_->forget(scenes());
  fresh_ = -1;
  masks_.clear();
  lit_.clear();
  lit_by_.clear();
  lights_.reset();
  gbuffers_.clear();
  gbuffer_ = {};
}

SetRequest::Reply TechniqueFrame::set(const std::string& settings) {
  settings_ = settings;
  if (const auto spoiled = objects_->set(settings)) {
    fresh_ = std::min(fresh_, static_cast<int>(*spoiled) - 1);
    objects_->forget();
  }
  return {fresh_ + 1};
}

void TechniqueFrame::pose(const std::optional<WantedPose>& wanted) {
  const std::uint64_t before = scene_.pose_number;
  // Meshes of another row have another reach, which a build reads.
  if (!posed_->go_to(row_pose(wanted))) keep_up_to(Stage::setup);
  if (scene_.pose_number != before) keep_up_to(Stage::build);
  require_hash(*posed_, wanted, scene_.name);
}

GoRequest::Reply TechniqueFrame::go_to(const GoRequest& request) {
  pose(request.pose);
  const RequestedFrame requested = requested_frame(request, scene_);
  // A viewer makes a new G-buffer with every move of the camera and does not come back to an old one; of a row that moves there
  // may be thousands.
  if (requested.is_free || request.pose)
    std::erase_if(gbuffers_, [&](const auto& known) { return known.first != request.gbuffer; });
  keep_up_to(requested.lit_by == lit_by_ ? Stage::relight : Stage::update);
  if (!lights_ || requested.lit_by != lit_by_) lights_ = std::make_unique<std::vector<Light>>(requested.lights);
  lit_by_ = requested.lit_by;
  // The same G-buffer under another light stays mapped, and uploaded.
  GBuffer& known = gbuffers_[request.gbuffer];
  if (known.width != requested.key.width || known.height != requested.key.height)
    known = map_gbuffer(request.gbuffer, requested.key);
  device_->forget_floor();
  const bool is_other_picture =
      known.width != gbuffer_.width || known.height != gbuffer_.height || known.truth != gbuffer_.truth;
  gbuffer_ = known;
  const std::vector<Support> supports = hold_objects(requested.key);
  if (request.begins_sequence || is_other_picture) objects_->forget();
  const Support support = support_of_row(*lights_, supports);
  GoRequest::Reply reply{.support = reply_of(support), .fresh = fresh_ + 1};
  for (const Support& one : supports) reply.lights.push_back(reply_of(one));
  if (supports.size() > 1) reply.shares = objects_->shares();
  if (support && draws(entry_->about) && entry_->about.floor != Floor::none) reply.floor = name(entry_->about.floor);
  return reply;
}

std::vector<Support> TechniqueFrame::hold_objects(const FrameKey& key) {
  const auto technique = entry_->make();
  technique->apply(settings_);
  const Support inputs = device_->within_limits(scene_, key.width, key.height);
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
  if (lit_ != before) keep_up_to(Stage::update);
  return supports;
}

void TechniqueFrame::bring_up(Stage last) {
  for (const Stage stage : all_stages)
    if (stage <= last && static_cast<int>(stage) > fresh_) time(stage);
}

TimeRequest::Reply TechniqueFrame::time_stage(const TimeRequest& request) {
  if (request.iterations < 1) throw Error("iterations = {} is below 1", request.iterations);
  if (request.stage > Stage::setup) bring_up(static_cast<Stage>(static_cast<int>(request.stage) - 1));
  double harness_sum = 0;
  bool is_own = false;
  const DeviceStopwatch* const stopwatch = device_->stopwatch();
  TimeRequest::Reply reply{.device_ms = 0};
  const auto start = std::chrono::steady_clock::now();
  do {
    const StageTime time = this->time(request.stage);
    harness_sum += time.harness_ms;
    reply.ms += time.own_ms.value_or(time.harness_ms);
    is_own = is_own || time.own_ms;
    const auto device_ms = stopwatch ? stopwatch->milliseconds() : std::nullopt;
    reply.device_ms = reply.device_ms && device_ms ? std::optional(*reply.device_ms + *device_ms) : std::nullopt;
    ++reply.iterations;
  } while (reply.iterations < request.iterations && seconds_since(start) < longest_portion_seconds);
  if (is_own) reply.harness_ms = harness_sum;
  return reply;
}

FloorRequest::Reply TechniqueFrame::floor(int times) {
  // Else the pass would find positions that no stage has uploaded.
  if (fresh_ == static_cast<int>(Stage::build)) time(Stage::update);
  return device_->draw_floor(entry_->about.floor, **scenes().begin(), gbuffer_, times);
}

TechniqueFrame::StageTime TechniqueFrame::time(Stage stage) {
  if (stage >= Stage::relight && masks_.empty()) throw Error("a worker cannot {} before it has a frame", name(stage));
  if (stage >= Stage::relight && lit_.empty()) throw Error("a worker cannot {} lights that its technique refuses", name(stage));
  // A build reads all positions: for it what moved is taken and forgotten.
  const bool sees_meshes = stage == Stage::build || stage == Stage::update;
  const Changes changes = sees_meshes ? posed_->take_changes() : Changes();
  // A stage that throws is due again; what moved is taken, so that only a build would see it.
  fresh_ = std::min(fresh_, sees_meshes ? static_cast<int>(Stage::setup) : static_cast<int>(stage) - 1);
  device_->prepare(stage, scenes(), gbuffer_);
  std::optional<CountedStage> counted(std::in_place, name(stage).data());
  if (stage <= Stage::build) objects_->forget();
  const auto start = std::chrono::steady_clock::now();
  DeviceStopwatch* const stopwatch = device_->stopwatch();
  if (stopwatch) stopwatch->start();
  const std::optional<double> own_ms = call(stage, changes);
  if (stopwatch) stopwatch->stop();
  device_->finish();
  const double ms = std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
  counted.reset();
  device_->end_stage();
  fresh_ = static_cast<int>(fresh_after(stage));
  if (own_ms && !(*own_ms >= 0 && *own_ms <= ms))
    throw Error("{} took {:g} ms by the technique's own clock, {:g} ms by the harness's", name(stage), *own_ms, ms);
  return {.harness_ms = ms, .own_ms = own_ms};
}

std::optional<double> TechniqueFrame::call(Stage stage, const Changes& changes) {
  std::optional<double> own_ms;
  objects_->each(stage, [&](Technique& technique, std::size_t k) {
    const auto built_on = [&]() -> const Scene& { return lit_.empty() ? scene_ : channels_->of((*lights_)[lit_[k]]); };
    if (stage == Stage::setup) technique.setup();
    if (stage == Stage::build) technique.build(built_on());
    if (stage == Stage::update) technique.update(built_on(), changes);
    if (stage == Stage::relight) technique.relight((*lights_)[lit_[k]]);
    if (stage == Stage::resolve) technique.resolve(gbuffer_, masks_[lit_[k]]);
    if (const WorksElsewhere* const there = elsewhere(technique))
      if (const auto ms = there->own_ms()) own_ms = own_ms.value_or(0) + *ms;
  });
  return own_ms;
}

Technique* TechniqueFrame::object_of(std::size_t light) {
  if (light >= masks_.size()) throw Error("there is no light {}: the frame has {}", light, masks_.size());
  const auto found = std::ranges::find(lit_, light);
  return found == lit_.end() ? nullptr : &(*objects_)[static_cast<std::size_t>(found - lit_.begin())];
}

void TechniqueFrame::require_pixel(std::uint32_t pixel) const {
  if (pixel >= gbuffer_.size()) throw Error("there is no pixel {}: the picture has {}", pixel, gbuffer_.size());
}

TechniqueDevice::Scenes TechniqueFrame::scenes() {
  TechniqueDevice::Scenes scenes;
  for (const std::size_t k : lit_) scenes.insert(&channels_->of((*lights_)[k]));
  return scenes.empty() ? TechniqueDevice::Scenes{&scene_} : scenes;
}

}  // namespace gnomon
