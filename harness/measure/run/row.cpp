#include "measure/run/row.h"

#include <gnomon/error.h>
#include <gnomon/registry.h>

#include "measure/cause/causes.h"
#include "measure/scene/motion.h"

namespace gnomon {

namespace {

template <class Item>
std::size_t index_of(const std::vector<Item>& items, const std::string& name) {
  const Item* found = find_named(items, name);
  if (!found) throw Error("there is no {}", name);
  return static_cast<std::size_t>(found - items.data());
}

}  // namespace

RowFrame SceneRun::first_frame(const Job& job) const {
  RowFrame frame{.light = index_of(scene.lights, job.light),
                 .view = index_of(scene.views, job.view),
                 .width = job.width,
                 .height = job.height,
                 .path = {}};
  if (!job.path.empty()) frame.path = find_path(scene, job.path, scene.lights[frame.light], scene.views[frame.view]);
  return frame;
}

Light SceneRun::light(const RowFrame& frame) const {
  const Light& still = scene.lights[frame.light];
  return frame.path ? light_at(*frame.path, still, frame.number) : still;
}

FrameKey SceneRun::key(const RowFrame& frame, Truth truth) const {
  const View& still = scene.views[frame.view];
  return {frame.path ? view_at(*frame.path, still, frame.number) : still, frame.width, frame.height,
          scene.has_curved_shapes() ? truth : Truth::shape};
}

FrameRequest SceneRun::request(const RowFrame& frame, Truth truth) {
  const FrameKey of = key(frame, truth);
  return {
      .gbuffer_file = frames.gbuffer_file(of),
      .width = of.width,
      .height = of.height,
      .truth = of.truth,
      .seen = SceneLightAndView{
          .light = frame.light, .view = frame.view, .path = frame.path ? frame.path->name : "", .path_frame = frame.number}};
}

ContenderWorker::ContenderWorker(SceneRun& run, const Contender& contender, const WorkerOptions& options)
    : run_(run), contender_(contender), client_(options, run.scratch / "worker", run.suite.timeout) {}

void ContenderWorker::begin_load() {
  client_.begin_load(
      {.scene_file = run_.frames.scene_file(), .technique = contender_.technique, .settings = contender_.settings});
}

Support ContenderWorker::go(const RowFrame& frame, Truth truth) {
  frame_ = frame;
  truth_ = truth;
  const FrameReply reply = client_.frame(run_.request(frame, truth));
  upload_ = reply.upload;
  if (!reply.support) return reply.support;
  const Support reference = reference_support(run_.scene, run_.light(frame), run_.key(frame, truth).view);
  return reference ? reply.support : reference;
}

double ContenderWorker::setup_ms() {
  if (!setup_ms_) setup_ms_ = client_.time(Stage::setup);
  return *setup_ms_;
}

Answer ContenderWorker::answer(Record* record) {
  MaskReply reply = client_.answer();
  const FrameKey key = run_.key(frame_, truth_);
  Answer answer{run_.frames.gbuffer(key), run_.frames.reference(key, run_.light(frame_)), std::move(reply.mask), {}};
  if (!record) return answer;
  record->counts = std::move(reply.counts);
  for (const Count& c : record->counts)
    if (c.name == "bytes") record->bytes = static_cast<std::uint64_t>(c.value);
  record->peak_bytes = reply.peak_bytes;
  return answer;
}

void ContenderWorker::note_gl(Record& record) const {
  if (!client_.gl()) return;
  record.context["gl_renderer"] = client_.gl()->renderer;
  record.context["gl_version"] = client_.gl()->version;
  if (upload_) record.gl = {upload_->bytes, upload_->ms};
}

namespace {

/// Means of metrics over the frames of a path. A mean over some of the frames would be another quantity in every row, so there
/// is none unless all frames have a value.
class FrameMeans {
 public:
  void add(const Metrics& metrics) {
    ++frames_;
    for (const auto& [metric, value] : metrics) {
      auto& [sum, count] = sums_[metric];
      if (!value) continue;
      sum += *value;
      ++count;
    }
  }
  Metrics means() const {
    Metrics result;
    for (const auto& [metric, total] : sums_) {
      const auto& [sum, count] = total;
      const int due = metric == between_frames && frames_ > 1 ? frames_ - 1 : frames_;
      result[metric] = count == due ? std::optional(sum / count) : std::nullopt;
    }
    return result;
  }

 private:
  static constexpr std::string_view between_frames = "instability";  ///< has no value at the first frame
  int frames_ = 0;
  std::map<std::string, std::pair<double, int>> sums_;
};

/// Adds what is said of the support of a frame to the record; answers whether the frame can be measured.
bool take_support(Record& record, const Support& support, const RowFrame& frame) {
  if (support.kind() == Support::Kind::full) return true;
  if (support && record.support == Support::Kind::approximate) return true;  // by an earlier frame, which said why
  record.support = support.kind();
  record.reason = frame.path ? fmt::format("at frame {}: {}", frame.number, support.why()) : support.why();
  return static_cast<bool>(support);
}

/// Pixels where the answer is not wrong.
std::vector<std::uint8_t> right_pixels(const Evidence& evidence) {
  std::vector<std::uint8_t> right(evidence.mask.size());
  for (std::size_t i = 0; i < right.size(); ++i) right[i] = !evidence.is_wrong(i);
  return right;
}

/// Measures a row frame by frame.
class RowMeasurement {
 public:
  RowMeasurement(Record& record, SceneRun& run, ContenderWorker& worker)
      : record_(record),
        run_(run),
        worker_(worker),
        truth_(record.truth),
        other_truth_(truth_ == Truth::shape ? Truth::mesh : Truth::shape) {
    record.classes.clear();
    record.causes.emplace();
    record.frames.clear();
  }

  /// Answers false, with the reason in the record, when the frame is unsupported.
  bool add(const RowFrame& frame) {
    before_ = std::move(now_);
    now_ = MeasuredRow{.light = run_.light(frame), .answer = {}, .errors = {}, .other_mask = {}};
    std::vector<std::uint8_t> right_on_mesh;
    if (run_.scene.has_curved_shapes()) {
      if (!take_support(record_, worker_.go(frame, other_truth_), frame)) return false;
      right_on_mesh = add_other_truth();
    }
    if (!take_support(record_, worker_.go(frame, truth_), frame)) return false;
    add_headline_truth(frame, right_on_mesh);
    return true;
  }

  MeasuredRow finish() {
    record_.metrics[truth_] = means_[truth_].means();
    record_.metrics[other_truth_] = run_.scene.has_curved_shapes() ? means_[other_truth_].means() : record_.metrics[truth_];
    record_.status = Status::ok;
    return std::move(now_);
  }

 private:
  /// The pixels that are right on the mesh, for causes; empty where the technique does not see the mesh or it is the headline.
  std::vector<std::uint8_t> add_other_truth() {
    Answer answer = worker_.answer(nullptr);
    const Evidence evidence = answer.evidence(run_.scene, now_.light);
    means_[other_truth_].add(measure_metrics(Scoring(evidence)));
    std::vector<std::uint8_t> right_on_mesh;
    if (other_truth_ == Truth::mesh && registry().technique(record_.technique).about.sees == Truth::mesh)
      right_on_mesh = right_pixels(evidence);
    now_.other_mask = std::move(answer.mask);
    return right_on_mesh;
  }

  void add_headline_truth(const RowFrame& frame, std::span<const std::uint8_t> right_on_mesh) {
    Answer& answer = now_.answer;
    answer = worker_.answer(&record_);
    answer.causes =
        find_causes({run_.scene, run_.frames.casters(truth_), answer.gbuffer, now_.light, answer.reference, answer.mask,
                     right_on_mesh, [&](std::span<const std::uint32_t> pixels) { return worker_.client().explain(pixels); }});
    Evidence evidence = answer.evidence(run_.scene, now_.light), previous;
    if (frame.number > 0) {
      previous = before_.answer.evidence(run_.scene, before_.light);
      evidence.previous = &previous;
    }
    const Scoring scoring(evidence);
    now_.errors = scoring.error_counts();
    const Metrics metrics = measure_metrics(scoring);
    means_[truth_].add(metrics);
    for (const auto& [name, count] : class_counts(answer.reference.classes)) record_.classes[name] += count;
    for (const auto& [name, count] : count_causes(answer.causes)) (*record_.causes)[name] += count;
    if (frame.path)
      for (const auto& [metric, value] : metrics) record_.frames[metric].push_back(value);
  }

  Record& record_;
  SceneRun& run_;
  ContenderWorker& worker_;
  const Truth truth_, other_truth_;
  std::map<Truth, FrameMeans> means_;
  MeasuredRow now_, before_;
};

}  // namespace

std::optional<MeasuredRow> measure(Record& record, SceneRun& run, ContenderWorker& worker, const RowFrame& first) {
  worker.note_gl(record);
  RowMeasurement measurement(record, run, worker);
  for (RowFrame frame = first; frame.number < first.count(); ++frame.number)
    if (!measurement.add(frame)) return std::nullopt;
  if (first.path) worker.go(first, record.truth);
  return measurement.finish();
}

}  // namespace gnomon
