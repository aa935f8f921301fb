// What a row's masks are worth: metrics, causes and classes, frame by frame and light by light.
#include <gnomon/kit/path_light.h>
#include <gnomon/registry.h>

#include "measure/cause/own_causes.h"
#include "measure/run/row.h"

namespace gnomon {

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

/// Whether the mask is right at a pixel, under a light with area within four standard errors of the reference.
bool is_right(const Evidence& evidence, std::size_t i) {
  if (evidence.reference_error.empty()) return !evidence.is_wrong(i);
  return std::abs(evidence.mask[i] - evidence.reference[i]) <= 4 * evidence.reference_error[i];
}

/// Adds up by name.
template <class Number>
void add_to(std::map<std::string, Number>& sums, const std::map<std::string, Number>& more, Number weight = 1) {
  for (const auto& [name, number] : more) sums[name] += weight * number;
}

/// Measures a row frame by frame.
class RowMeasurement {
 public:
  RowMeasurement(Record& record, SceneRun& run, ContenderWorker& worker)
      : record_(record),
        run_(run),
        worker_(worker),
        truth_(record.truth),
        other_truth_(truth_ == Truth::shape ? Truth::mesh : Truth::shape),
        light_means_(record.lights.size()) {
    record.classes.clear();
    record.causes.emplace();
    record.cause_errors.reset();
    record.frames.clear();
    for (Record::LightFacts& light : record.lights) {
      light.classes.clear();
      light.causes.emplace();
      light.cause_errors.reset();
    }
  }

  /// Answers false, with the reason in the record, when the frame is unsupported.
  bool add(const RowFrame& frame) {
    before_ = std::move(now_);
    now_ = MeasuredRow();
    for (Light& light : run_.lights(frame)) now_.lights.push_back({std::move(light), {}, {}});
    std::vector<std::vector<std::uint8_t>> right_on_mesh(now_.lights.size());
    if (run_.scene.has_curved_shapes()) {
      if (!take_support(record_, worker_.go(frame, other_truth_), frame)) return false;
      right_on_mesh = add_other_truth();
    }
    if (!take_support(record_, worker_.go(frame, truth_), frame)) return false;
    if (frame.number == 0) worker_.note_lights(record_);
    add_headline_truth(frame, right_on_mesh);
    return true;
  }

  MeasuredRow finish() {
    record_.metrics[truth_] = means_[truth_].means();
    record_.metrics[other_truth_] = run_.scene.has_curved_shapes() ? means_[other_truth_].means() : record_.metrics[truth_];
    for (std::size_t k = 0; k < record_.lights.size(); ++k) record_.lights[k].metrics = light_means_[k].means();
    record_.status = Status::ok;
    return std::move(now_);
  }

 private:
  /// By light the pixels that are right on the mesh, for causes; empty where the technique does not see the mesh or it is the
  /// headline.
  std::vector<std::vector<std::uint8_t>> add_other_truth() {
    std::vector<std::vector<std::uint8_t>> right_on_mesh(now_.lights.size());
    MeasuredRow other = now_;
    take_answers(other, nullptr);
    for (std::size_t k = 0; k < other.lights.size(); ++k) {
      const Evidence evidence = other.lights[k].answer.evidence(run_.scene, other.lights[k].light);
      if (other_truth_ == Truth::mesh && about().sees == Truth::mesh)
        for (std::size_t i = 0; i < evidence.mask.size(); ++i) right_on_mesh[k].push_back(is_right(evidence, i));
    }
    put_together(other, run_.scene);
    const Evidence evidence = other.evidence(run_.scene);
    means_[other_truth_].add(measure_metrics(Scoring(evidence)));
    for (std::size_t k = 0; k < other.lights.size(); ++k) now_.lights[k].other_mask = std::move(other.lights[k].answer.mask);
    return right_on_mesh;
  }

  void add_headline_truth(const RowFrame& frame, std::span<const std::vector<std::uint8_t>> right_on_mesh) {
    take_answers(now_, &record_);
    const double share = 1 / static_cast<double>(frame.count());
    for (std::size_t k = 0; k < now_.lights.size(); ++k) add_light(k, share, right_on_mesh[k]);
    put_together(now_, run_.scene);
    Evidence evidence = now_.evidence(run_.scene), previous;
    if (frame.number > 0) {
      previous = before_.evidence(run_.scene);
      evidence.previous = &previous;
    }
    const Scoring scoring(evidence);
    now_.errors = scoring.error_counts();
    const Metrics metrics = measure_metrics(scoring);
    means_[truth_].add(metrics);
    add_to(record_.classes, class_counts(evidence.classes));
    if (!evidence.reference_error.empty() || now_.together) {
      if (!record_.cause_errors) record_.cause_errors.emplace();
      add_to(*record_.cause_errors, cause_errors(evidence), share);
    }
    if (frame.path)
      for (const auto& [metric, value] : metrics) record_.frames[metric].push_back(value);
  }

  void take_answers(MeasuredRow& row, Record* record) {
    std::vector<Answer> answers = worker_.answers(record);
    for (std::size_t k = 0; k < answers.size(); ++k) {
      answers[k].estimates = about().estimates;
      answers[k].own_causes = own_causes(about());
      row.lights[k].answer = std::move(answers[k]);
    }
    row.global = worker_.global_answer();
  }

  /// The causes under one light; of several lights also what its own mask is worth.
  void add_light(std::size_t k, double share, std::span<const std::uint8_t> right_on_mesh) {
    const Light& light = now_.lights[k].light;
    Answer& answer = now_.lights[k].answer;
    answer.causes =
        find_causes({run_.scene, run_.frames.casters(truth_), answer.gbuffer, light, answer.reference, answer.mask,
                     right_on_mesh, [&](std::span<const std::uint32_t> pixels) { return worker_.client().explain(pixels, k); },
                     answer.estimates, answer.own_causes, about().rasterizes});
    const std::map<std::string, std::uint64_t> counts = count_causes(answer.causes, answer.own_causes);
    add_to(*record_.causes, counts);
    std::optional<Record::ReferenceFacts> facts;
    if (has_area(light)) {
      facts = reference_facts(answer.reference, answer.estimates, run_.suite.target);
      if (now_.global) facts->global = now_.global->facts[k];
    }
    if (record_.lights.empty()) {
      record_.reference = facts;
      return;
    }
    Record::LightFacts& of = record_.lights[k];
    of.reference = facts;
    add_to(of.classes, class_counts(answer.reference.classes));
    add_to(*of.causes, counts);
    const Evidence evidence = answer.evidence(run_.scene, light);
    light_means_[k].add(measure_metrics(Scoring(evidence)));
    if (!facts) return;
    if (!of.cause_errors) of.cause_errors.emplace();
    add_to(*of.cause_errors, cause_errors(evidence), share);
  }

  const About& about() const { return registry().technique(record_.technique).about; }

  Record& record_;
  SceneRun& run_;
  ContenderWorker& worker_;
  const Truth truth_, other_truth_;
  std::map<Truth, FrameMeans> means_;
  std::vector<FrameMeans> light_means_;  ///< of several lights, each
  MeasuredRow now_, before_;
};

}  // namespace

Record::ReferenceFacts reference_facts(const Reference& reference, LightShareKind estimates, const AreaTarget& target) {
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

void put_together(MeasuredRow& row, const Scene& scene) {
  if (row.lights.size() < 2) return;
  std::vector<Evidence> lights;
  for (const MeasuredLight& light : row.lights) lights.push_back(light.answer.evidence(scene, light.light));
  row.together = together(lights);
}

std::optional<MeasuredRow> measure(Record& record, SceneRun& run, ContenderWorker& worker, const RowFrame& first) {
  worker.note_gl(record);
  if (first.global_samples > 0)
    if (const auto why = endless_bounces(run.scene)) record.notes.push_back(fmt::format("no radiosity_error: {}", *why));
  RowMeasurement measurement(record, run, worker);
  for (RowFrame frame = first; frame.number < first.count(); ++frame.number)
    if (!measurement.add(frame)) return std::nullopt;
  if (first.path) worker.go(first, record.truth);
  return measurement.finish();
}

}  // namespace gnomon
