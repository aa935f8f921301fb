#include "measure/run/row.h"

#include <gnomon/error.h>
#include <gnomon/registry.h>

#include "measure/cause/causes.h"
#include "measure/scene/motion.h"
#include "measure/score/error_picture.h"

namespace gnomon {

namespace fs = std::filesystem;

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
  Answer answer{
      run_.frames.gbuffer(key), run_.frames.reference(key, run_.light(frame_), run_.suite.target), std::move(reply.mask), {}};
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

/// How well the reference of a light with area is known, over all pixels that it was asked for.
Record::ReferenceFacts facts_of(const Reference& reference, LightShareKind estimates, const AreaTarget& target) {
  Record::ReferenceFacts facts{.estimates = estimates, .target = target.error, .cap = target.cap};
  const auto errors = estimates == LightShareKind::area ? reference.error : reference.irradiance_error;
  std::size_t asked = 0;
  for (std::size_t i = 0; i < reference.rays.size(); ++i) {
    if (reference.classes[i] <= PixelClass::F) continue;
    ++asked;
    facts.rays += reference.rays[i];
    facts.error_mean += errors[i];
    facts.error_max = std::max<double>(facts.error_max, errors[i]);
  }
  if (asked > 0) facts.error_mean /= static_cast<double>(asked);
  return facts;
}

/// Whether the mask is right at a pixel, under a light with area within four standard errors of the reference.
bool is_right(const Evidence& evidence, std::size_t i) {
  if (evidence.reference_error.empty()) return !evidence.is_wrong(i);
  return std::abs(evidence.mask[i] - evidence.reference[i]) <= 4 * evidence.reference_error[i];
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
    record.cause_errors.reset();
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
    answer.estimates = about().estimates;
    const Evidence evidence = answer.evidence(run_.scene, now_.light);
    means_[other_truth_].add(measure_metrics(Scoring(evidence)));
    std::vector<std::uint8_t> right_on_mesh;
    if (other_truth_ == Truth::mesh && about().sees == Truth::mesh)
      for (std::size_t i = 0; i < evidence.mask.size(); ++i) right_on_mesh.push_back(is_right(evidence, i));
    now_.other_mask = std::move(answer.mask);
    return right_on_mesh;
  }

  void add_headline_truth(const RowFrame& frame, std::span<const std::uint8_t> right_on_mesh) {
    Answer& answer = now_.answer;
    answer = worker_.answer(&record_);
    answer.estimates = about().estimates;
    answer.causes = find_causes(
        {run_.scene, run_.frames.casters(truth_), answer.gbuffer, now_.light, answer.reference, answer.mask, right_on_mesh,
         [&](std::span<const std::uint32_t> pixels) { return worker_.client().explain(pixels); }, answer.estimates});
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
    if (has_area(now_.light)) {
      record_.reference = facts_of(answer.reference, answer.estimates, run_.suite.target);
      if (!record_.cause_errors) record_.cause_errors.emplace();
      for (const auto& [name, error] : cause_errors(evidence))
        (*record_.cause_errors)[name] += error / static_cast<double>(frame.count());
    }
    if (frame.path)
      for (const auto& [metric, value] : metrics) record_.frames[metric].push_back(value);
  }

  const About& about() const { return registry().technique(record_.technique).about; }

  Record& record_;
  SceneRun& run_;
  ContenderWorker& worker_;
  const Truth truth_, other_truth_;
  std::map<Truth, FrameMeans> means_;
  MeasuredRow now_, before_;
};

/// Letters, digits, dots and dashes of the job's title, and its hash: readable, unique, and no longer than a file's name may
/// be.
std::string file_stem(const Record& record) {
  std::string stem;
  for (const char c : fmt::format("{}-{}-{}", fs::path(record.scene).stem().string(), record.light, record.technique))
    stem += std::isalnum(static_cast<unsigned char>(c)) || c == '.' || c == '-' || c == '_' ? c : '-';
  constexpr std::size_t most = 180;
  return stem.substr(0, most) + "-" + record.job.substr(0, 8);
}

Record::SceneFacts facts_of(const Scene& scene) {
  Record::SceneFacts facts;
  facts.meshes = scene.meshes.size();
  facts.triangles = scene.triangle_count();
  facts.closed = true;
  for (const Mesh& mesh : scene.meshes) {
    facts.closed = facts.closed && mesh.facts.closed();
    facts.boundary_edges += mesh.facts.boundary_edge_count;
    facts.nonmanifold_edges += mesh.facts.nonmanifold_edge_count;
    facts.misoriented_edges += mesh.facts.misoriented_edge_count;
    facts.degenerate += mesh.facts.degenerate_count;
  }
  return facts;
}

}  // namespace

std::optional<MeasuredRow> measure(Record& record, SceneRun& run, ContenderWorker& worker, const RowFrame& first) {
  worker.note_gl(record);
  RowMeasurement measurement(record, run, worker);
  for (RowFrame frame = first; frame.number < first.count(); ++frame.number)
    if (!measurement.add(frame)) return std::nullopt;
  if (first.path) worker.go(first, record.truth);
  return measurement.finish();
}

Record start_record(const Job& job, const Suite& suite, const Scene* scene, const Json& context) {
  Record record;
  record.job = job.hash;
  record.suite = suite.name;
  record.scene = job.scene;
  record.light = job.light;
  record.view = job.view;
  record.technique = job.contender.technique;
  record.settings = job.contender.settings;
  if (!job.contender.label.empty()) record.label = job.contender.label;
  const TechniqueEntry& entry = registry().technique(job.contender.technique);
  record.role = entry.about.role;
  const auto technique = entry.make();
  technique->apply(job.contender.settings);
  for (const Parameter* row : technique->parameters()) {
    const Json number = parse_if_json(row->text());
    record.parameters[std::string(row->name())] = number.is_number() ? number : Json(row->text());
  }
  record.width = job.width;
  record.height = job.height;
  record.path = job.path;
  record.place = job.place;
  record.truth = suite.truth;
  record.context = context;
  if (scene) {
    if (const Light* light = find_named(scene->lights, job.light)) record.light_kind = kind_name(*light);
    record.scene_facts = facts_of(*scene);
    record.notes = scene->notes;
  }
  return record;
}

void remove_pictures(const Record& record, const fs::path& out) {
  std::error_code ignored;
  for (const std::string& picture : pictures(record)) fs::remove(out / picture, ignored);
}

void write_pictures(Record& record, const SceneRun& run, const MeasuredRow& measured, const fs::path& out) {
  const Answer& answer = measured.answer;
  const std::string stem = file_stem(record);
  // What `--rescore` and the report need: the mask, the cause of each pixel, and the mask under the other truth.
  std::vector<std::string> names = {record.light + ".V"};
  std::vector<float> causes;
  for (const Cause cause : answer.causes) causes.push_back(static_cast<float>(cause));
  std::vector<std::span<const float>> channels = {answer.mask};
  if (!causes.empty()) {
    names.push_back(record.light + ".cause");
    channels.push_back(causes);
  }
  if (measured.other_mask) {
    names.push_back(fmt::format("{}.{}", record.light, name(record.truth == Truth::shape ? Truth::mesh : Truth::shape)));
    channels.push_back(*measured.other_mask);
  }
  record.mask = "masks/" + stem + ".exr";
  record.error_picture = "errors/" + stem + ".png";
  record.shaded_picture = "shaded/" + stem + ".png";
  write_exr(out / *record.mask, record.width, record.height, names, channels);
  const std::string title =
      record.label.value_or(record.settings.empty() ? record.technique : record.technique + ":" + record.settings);
  write_png(out / *record.error_picture, draw_errors(answer.evidence(run.scene, measured.light), title));
  write_png(out / *record.shaded_picture, shade(run.scene, answer.gbuffer, measured.light, answer.mask));
}

}  // namespace gnomon
