#include "measure/row/contender_worker.h"

#include <gnomon/kit/area/path_light.h>

#include <cassert>

#include "measure/scene/channels.h"
#include "measure/scene/motion.h"

namespace gnomon {

namespace {

/// Adds the picture under one light to what is there; variances add up.
void add(GlobalAnswer& sum, std::span<const float> picture, const GlobalReference& reference) {
  for (std::vector<float>* const values : {&sum.picture, &sum.reference, &sum.error}) values->resize(picture.size());
  for (std::size_t k = 0; k < picture.size(); ++k) {
    sum.picture[k] += picture[k];
    sum.reference[k] += reference.radiance[k];
    sum.error[k] = std::hypot(sum.error[k], reference.error[k]);
  }
}

Record::ReferenceFacts::GlobalFacts facts_of(const GlobalReference& reference, int samples) {
  double errors = 0, whole = 0;
  for (std::size_t k = 0; k < reference.radiance.size(); ++k) {
    errors += static_cast<double>(reference.error[k]) * reference.error[k];
    whole += static_cast<double>(reference.radiance[k]) * reference.radiance[k];
  }
  return {.samples = samples, .rays = reference.rays, .error = whole > 0 ? std::sqrt(errors / whole) : 0};
}

}  // namespace

void SceneRun::go_to(const RowFrame& frame) { posed.go_to(frame.path ? pose_at(*frame.path, frame.number) : std::nullopt); }

std::vector<Light> SceneRun::lights(const RowFrame& frame) const {
  std::vector<Light> lights;
  for (const std::size_t index : frame.lights)
    lights.push_back(frame.path ? light_at(*frame.path, scene.lights[index], frame.number) : scene.lights[index]);
  return lights;
}

FrameKey SceneRun::key(const RowFrame& frame, Truth truth) {
  assert(posed.now() == (frame.path ? pose_at(*frame.path, frame.number) : std::nullopt));
  const View& still = scene.views[frame.view];
  FrameKey of{frame.path ? view_at(*frame.path, still, frame.number) : still, frame.width, frame.height,
              scene.has_curved_shapes() ? truth : Truth::shape};
  if (posed.now()) of.pose = WantedPose{*posed.now(), posed.hash()};
  return of;
}

FrameRequest SceneRun::request(const RowFrame& frame, Truth truth) {
  const FrameKey of = key(frame, truth);
  SceneLightAndView seen{.lights = frame.lights, .view = frame.view, .path_frame = frame.number};
  if (frame.path) seen.path = frame.path->name;
  return {frames.gbuffer_file(of), of.width, of.height, of.truth, std::move(seen), of.pose};
}

std::string SceneRun::shown(const RowFrame& frame, Truth truth) {
  const FrameKey of = key(frame, truth);
  return content_hash(light_and_view_bytes(lights(frame), of.view)) + (of.pose ? of.pose->hash : "");
}

ContenderWorker::ContenderWorker(SceneRun& run, std::string technique, std::string settings, const WorkerOptions& options)
    : run_(run),
      technique_(std::move(technique)),
      settings_(std::move(settings)),
      client_(options, run.options.scratch / "worker", run.options.timeout) {}

void ContenderWorker::begin_load() {
  client_.begin_load({.scene_file = run_.frames.scene_file(), .technique = technique_, .settings = settings_});
}

Support ContenderWorker::go(const RowFrame& frame, Truth truth, bool begins_sequence) {
  frame_ = frame;
  truth_ = truth;
  run_.go_to(frame);
  FrameRequest request = run_.request(frame, truth);
  request.begins_sequence = begins_sequence;
  reply_ = client_.frame(request);
  if (!reply_.support) return reply_.support;
  const View view = run_.key(frame, truth).view;
  for (const Light& light : run_.lights(frame))
    if (const Support reference = reference_support(run_.frames.scene(light), light, view); !reference) return reference;
  return reply_.support;
}

std::size_t ContenderWorker::object_count() const {
  std::set<std::optional<Channel>> channels;  // objects of one share
  std::size_t lights = 0;
  for (std::size_t k = 0; k < frame_.lights.size(); ++k) {
    if (!supports_light(k)) continue;
    channels.insert(channel_of(run_.scene.lights[frame_.lights[k]].name));
    ++lights;
  }
  return reply_.shares.value_or(true) ? std::max<std::size_t>(channels.size(), 1) : lights;
}

ContenderWorker::SetupTime ContenderWorker::setup_time() {
  const auto [found, is_new] = setup_times_.try_emplace(object_count());
  auto& [ms, other_clocks] = found->second;
  if (is_new) ms = client_.time(Stage::setup);
  if (is_new) other_clocks = client_.other_clocks();
  return found->second;
}

std::vector<Answer> ContenderWorker::answers(Record* record) {
  const MaskReply reply = client_.answer();
  const FrameKey key = run_.key(frame_, truth_);
  const int bits = client_.gl() ? client_.gl()->subpixel_bits : usual_subpixel_bits;
  const GBuffer gbuffer = run_.frames.gbuffer(key);
  std::vector<Answer> answers;
  auto next = reply.mask.begin();
  for (const Light& light : run_.lights(frame_)) {
    const auto end = next + static_cast<std::ptrdiff_t>(gbuffer.size());
    answers.push_back({gbuffer, run_.frames.reference(key, light, run_.options.target, bits), {next, end}, {}});
    if (run_.options.truth_over != TruthOver::center && !has_area(light))
      answers.back().pixel_truth = run_.frames.pixel_truth(key, light);
    next = end;
  }
  if (!record) return answers;
  record->counts = reply.counts;
  for (const Count& c : record->counts)
    if (c.name == "bytes") record->bytes = static_cast<std::uint64_t>(c.value);
  record->peak_bytes = reply.peak_bytes;
  record->gl = reply.gl;
  if (!reply.maker.empty()) record->context["plugin"]["maker"] = reply.maker;
  return answers;
}

bool ContenderWorker::check_error_terms(std::span<const Answer> answers) {
  constexpr double rounding = 1e-6;
  bool has_any = false;
  for (std::size_t light = 0; light < answers.size(); ++light) {
    if (!supports_light(light)) continue;
    const Evidence e = answers[light].evidence();
    const ErrorParts parts = client_.error_terms(e.reference, light);
    if (parts.causes.empty()) continue;
    has_any = true;
    for (std::size_t i = 0; i < e.mask.size(); ++i) {
      if (!e.faces_light(i)) continue;
      double sum = 0;
      for (const std::vector<float>& values : parts.values) sum += values[i];
      if (const double off = static_cast<double>(e.mask[i]) - e.reference[i]; !(std::abs(sum - off) <= rounding))
        throw Error("{}'s error terms add up to {} at pixel {}, where its mask is off by {}", technique_, sum, i, off);
    }
  }
  return has_any;
}

void ContenderWorker::count_times_again(Record& record) {
  if (!record.context.contains("plugin") || !record.context["plugin"].contains("maker")) return;
  for (const Count& now : client_.answer().counts)
    for (Count& before : record.counts)
      if (before.name == now.name && now.unit == "ms") before = now;
}

std::optional<GlobalAnswer> ContenderWorker::global_answer() {
  if (frame_.global_samples == 0 || untraceable_light(run_.scene)) return std::nullopt;
  GlobalAnswer sum;
  const std::vector<Light> lights = run_.lights(frame_);
  for (std::size_t k = 0; k < lights.size(); ++k) {
    sum.facts.emplace_back();
    if (!has_radiance(lights[k])) continue;
    if (!supports_light(k)) return std::nullopt;
    const auto picture = client_.global_picture(k);
    if (!picture) return std::nullopt;
    const GlobalReference reference = run_.frames.global_reference(run_.key(frame_, truth_), lights[k], frame_.global_samples);
    add(sum, *picture, reference);
    sum.facts.back() = facts_of(reference, frame_.global_samples);
  }
  return sum.picture.empty() ? std::nullopt : std::optional(std::move(sum));
}

void ContenderWorker::note_lights(Record& record) const {
  record.shares_build = reply_.shares;
  auto said = reply_.lights.begin();
  for (Record::LightFacts& light : record.lights) {
    light.support = said->kind();
    light.reason = (said++)->why();
  }
}

void ContenderWorker::note_gl(Record& record) const {
  if (!client_.gl()) return;
  record.context["gl_renderer"] = client_.gl()->renderer;
  record.context["gl_version"] = client_.gl()->version;
  record.context["gl_subpixel_bits"] = client_.gl()->subpixel_bits;
}

void ContenderWorker::note_card(Record& record) {
  if (const std::optional<Json> now = client_.card())
    record.context["card"] = json_object({{"before", *client_.gl()->card}, {"after", *now}});
}

}  // namespace gnomon
