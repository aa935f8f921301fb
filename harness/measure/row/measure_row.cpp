// Masks and causes of a row by its worker, frame by frame.
#include "measure/row/measure_row.h"

#include <gnomon/kit/area/path_light.h>
#include <gnomon/registry.h>

#include <deque>

#include "measure/cause/own_causes.h"
#include "measure/row/score_row.h"
#include "measure/score/memory_score.h"
#include "measure/score/over_time.h"

namespace gnomon {

namespace {

/// Adds the support of a frame to the record. Returns whether the frame can be measured.
bool take_support(Record& record, const Support& support, const RowFrame& frame) {
  if (support.kind() == Support::Kind::full) return true;
  if (support && record.support == Support::Kind::approximate) return true;  // by an earlier frame, which said why
  record.support = support.kind();
  record.reason = frame.path ? fmt::format("at frame {}: {}", frame.number, support.why()) : support.why();
  return static_cast<bool>(support);
}

/// Whether the mask is right at a pixel: where the answer is a fraction, within four standard errors of the reference.
bool is_right(const Evidence& evidence, std::size_t i) {
  if (evidence.reference_error.empty()) return !evidence.is_wrong(i);
  return std::abs(evidence.mask[i] - evidence.reference[i]) <= 4 * evidence.reference_error[i];
}

/// Of a row on a path.
std::optional<TimeScore> time_score(const std::optional<Path>& path) {
  if (!path) return std::nullopt;
  return TimeScore(path->frame_count, path->frame_rate, path->moves);
}

/// Measures a row frame by frame.
class RowMeasurement {
 public:
  RowMeasurement(Record& record, SceneRun& run, ContenderWorker& worker, const RowFrame& first)
      : record_(record),
        run_(run),
        worker_(worker),
        about_(registry().technique(record.technique).about),
        truth_(record.truth),
        other_truth_(truth_ == Truth::shape ? Truth::mesh : Truth::shape),
        follows_path_(first.path.has_value()),
        score_(first.count()),
        light_scores_(std::size(record.lights), PathScore(first.count())),
        other_score_(first.count()),
        time_score_(time_score(first.path)) {
    record.frames.clear();
  }

  /// Every frame in its order. Returns false, with the reason in the record, when one is unsupported. `each` is called after
  /// each.
  bool add_all(const RowFrame& first, const std::function<void(int)>& each) {
    const bool has_two_truths = run_.scene.has_curved_shapes();
    // Frames of one truth are no history of those of the other.
    std::deque<MeasuredRow> others;
    const auto at = [&](const RowFrame& frame, const auto& add) { return frame.path ? at_frame(frame.number, add) : add(); };
    if (about_.remembers && has_two_truths)
      for (RowFrame frame = first; frame.number < first.count(); ++frame.number) {
        if (!at(frame, [&] { return add_other_truth(frame); })) return false;
        others.push_back(std::move(now_));
      }
    for (RowFrame frame = first; frame.number < first.count(); ++frame.number) {
      before_ = std::move(now_);
      const bool is_there = at(frame, [&] {
        if (!others.empty()) {
          now_ = std::move(others.front());
          others.pop_front();
        } else if (has_two_truths) {
          if (!add_other_truth(frame)) return false;
        } else {
          start(frame);
        }
        return add_headline_truth(frame);
      });
      if (!is_there) return false;
      each(frame.number);
    }
    return true;
  }
  /// The frame that was added last.
  const MeasuredRow& now() const { return now_; }

  MeasuredRow finish() {
    std::vector<Score> lights;
    for (const PathScore& light : light_scores_) lights.push_back(light.score());
    Score whole = score_.score(), other = other_score_.score();
    if (follows_path_) put_over_time(whole, lights, other);
    if (!follows_path_ && about_.remembers) put_memory(whole, lights);
    put_score(record_, lights, whole);
    record_.metrics[other_truth_] = run_.scene.has_curved_shapes() ? other.metrics : record_.metrics[truth_];
    if (std::size(record_.lights) == 1) {  // the worst of all frames
      record_.lights.front().support = record_.support;
      record_.lights.front().reason = record_.reason;
    }
    record_.status = Status::ok;
    return std::move(now_);
  }

 private:
  /// Metrics over all frames, of the row as a whole against its headline truth; like instability none of one of several lights.
  void put_over_time(Score& whole, std::vector<Score>& lights, Score& other) const {
    const Metrics over_time = time_score_ ? time_score_->metrics() : no_metrics_over_time(), none = no_metrics_over_time();
    put(whole.metrics, over_time);
    for (Score& light : lights) put(light.metrics, std::size(lights) == 1 ? over_time : none);
    put(other.metrics, none);
    put_memory(whole, lights);
  }
  void put_memory(Score& whole, std::vector<Score>& lights) const {
    put(whole.metrics, memory_score_.metrics());
    if (std::size(lights) == 1) put(lights.front().metrics, memory_score_.metrics());
  }
  static void put(Metrics& metrics, const Metrics& more) {
    for (const auto& [name, value] : more) metrics[name] = value;
  }

  void start(const RowFrame& frame) {
    now_ = MeasuredRow();
    for (Light& light : run_.lights(frame)) now_.lights.push_back({std::move(light), {}});
  }

  /// Metrics against the other truth, its masks, and which of their pixels are right, for causes. Returns whether the frame is
  /// supported.
  bool add_other_truth(const RowFrame& frame) {
    start(frame);
    if (!take_support(record_, go(frame, other_truth_), frame)) return false;
    if (settles_before(frame))
      for (int k = 1; k < still_frames; ++k) at_frame("still frame", k, [&] { worker_.client().time(Stage::resolve); });
    MeasuredRow other = now_;
    take_answers(other, nullptr);
    put_together(other, run_.scene);
    const Evidence whole = other.evidence(run_.scene);
    other_score_.add(
        {.kind = whole.kind, .metrics = measure_metrics(Scoring(whole)), .classes = {}, .causes = {}, .cause_errors = {}});
    auto now = now_.lights.begin();
    for (MeasuredLight& light : other.lights) {
      const Evidence evidence = light.answer.evidence(run_.scene, light.light);
      if (other_truth_ == Truth::mesh && about_.sees == Truth::mesh)
        for (std::size_t i = 0; i < evidence.mask.size(); ++i) now->right_on_mesh.push_back(is_right(evidence, i));
      (now++)->other_mask = std::move(light.answer.mask);
    }
    return true;
  }

  bool add_headline_truth(const RowFrame& frame) {
    if (!take_support(record_, go(frame, truth_), frame)) return false;
    if (frame.number == 0) worker_.note_lights(record_);
    if (settles_before(frame)) settle();
    take_answers(now_, &record_);
    take_error_terms(now_);
    std::size_t number = 0;
    for (MeasuredLight& light : now_.lights) find_causes_under(light, number++);
    put_together(now_, run_.scene);
    const RowScore score = gnomon::score(now_, run_.scene, frame.number > 0 ? &before_ : nullptr);
    record_.exposure = score.exposure;
    score_.add(score.whole);
    if (time_score_) time_score_->add(now_.evidence(run_.scene));
    auto sum = light_scores_.begin();
    for (const Score& light : score.lights) (sum++)->add(light);
    if (frame.path) {
      for (const auto& [metric, value] : score.whole.metrics) record_.frames[metric].push_back(value);
      memory_score_.add_frame(score.whole.metrics.find("error")->second, run_.shown(frame, truth_));
    } else if (about_.remembers) {
      settle();
    }
    return true;
  }

  Support go(const RowFrame& frame, Truth truth) { return worker_.go(frame, truth, about_.remembers && frame.number == 0); }
  /// A path begins when what the technique remembers has settled; a still is scored cold.
  bool settles_before(const RowFrame& frame) const { return about_.remembers && frame.path && frame.number == 0; }

  /// Resolves until still_frames of the frame's first picture are there, those that are included.
  void settle() {
    for (int k = 0; k < still_frames; ++k) at_frame("still frame", k, [&] { add_still(k); });
  }

  void add_still(int number) {
    if (number > 0) worker_.client().time(Stage::resolve);
    if (number > 0 && number < still_frames - settled_frames && !has_error_terms_) return;
    MeasuredRow still;
    for (const MeasuredLight& light : now_.lights) still.lights.push_back({light.light, {}});
    take_answers(still, nullptr);
    // Of a still the first is measured by now; of a path the last will be.
    if (follows_path_ ? number + 1 < still_frames : number > 0) take_error_terms(still);
    put_together(still, run_.scene);
    memory_score_.add_still(number, measure_metric(Scoring(still.evidence(run_.scene)), "error"));
  }

  void take_error_terms(const MeasuredRow& row) {
    if (!has_error_terms_) return;
    std::vector<Answer> answers;
    for (const MeasuredLight& light : row.lights) answers.push_back(light.answer);
    has_error_terms_ = worker_.check_error_terms(answers);
  }

  void take_answers(MeasuredRow& row, Record* record) {
    std::vector<Answer> answers = worker_.answers(record);
    bool has_parts = false;
    for (std::size_t k = 0; k < answers.size(); ++k) {
      answers[k].estimates = about_.estimates;
      answers[k].own_causes = own_causes(about_);
      if (has_parts_ && worker_.supports_light(k)) answers[k].parts = worker_.client().parts(k);
      has_parts = has_parts || !answers[k].parts.empty();
      row.lights[k].answer = std::move(answers[k]);
    }
    has_parts_ = has_parts;
    row.global = worker_.global_answer();
  }

  void find_causes_under(MeasuredLight& measured, std::size_t number) {
    Answer& answer = measured.answer;
    const auto explain = [&](std::span<const std::uint32_t> pixels) { return worker_.client().explain(pixels, number); };
    answer.causes = find_causes({run_.frames.scene(measured.light), run_.frames.casters(truth_, measured.light), answer.gbuffer,
                                 measured.light, answer.reference, answer.mask, measured.right_on_mesh, explain,
                                 answer.estimates, answer.own_causes, about_.rasterizes});
    std::optional<Record::ReferenceFacts>& facts = record_.lights[number].reference;
    facts = reference_facts(answer, run_.options.target);
    if (facts && now_.global) facts->global = now_.global->facts[number];
    record_.lights[number].pixel_truth = pixel_facts(answer);
  }

  Record& record_;
  SceneRun& run_;
  ContenderWorker& worker_;
  const About& about_;
  const Truth truth_, other_truth_;
  const bool follows_path_;
  PathScore score_;
  std::vector<PathScore> light_scores_;
  PathScore other_score_;
  std::optional<TimeScore> time_score_;
  MemoryScore memory_score_;
  bool has_error_terms_ = true, has_parts_ = true;  ///< as far as is known
  MeasuredRow now_, before_;
};

/// What a row of lights with area that asks for the truth over the pixel has to say; empty of others.
std::string area_note(const std::vector<Light>& lights) {
  std::vector<std::string> with_area;
  for (const Light& light : lights)
    if (has_area(light)) with_area.push_back(light.name);
  if (with_area.empty()) return {};
  const std::string names = fmt::format("{} {} area", joined(with_area, ", "), with_area.size() == 1 ? "has" : "have");
  return with_area.size() == lights.size()
             ? fmt::format("no coverage_error_mean: {}, and the truth over the pixel is of lights without", names)
             : fmt::format("coverage_error_mean: {} and counts by the truth at pixel centers", names);
}

}  // namespace

std::optional<MeasuredRow> measure(Record& record, SceneRun& run, ContenderWorker& worker, const RowFrame& first,
                                   RowFrames* kept) {
  worker.note_gl(record);
  if (first.global_samples > 0)
    if (const auto why = untraceable_light(run.scene)) record.notes.push_back(fmt::format("no radiosity_error: {}", *why));
  if (run.options.truth_over != TruthOver::center)
    if (std::string note = area_note(run.lights(first)); !note.empty()) record.notes.push_back(std::move(note));
  if (first.path)
    if (const std::string why = flicker_obstacle(first.path->frame_rate); !why.empty())
      record.notes.push_back(fmt::format("no flicker: {}", why));
  // What a row counts does not depend on the rows before it, which leave updates behind.
  if (first.path && first.path->moves == Path::Moves::geometry && worker.go(first, record.truth))
    worker.client().time(Stage::build);
  RowMeasurement measurement(record, run, worker, first);
  const auto keep = [&](int number) {
    if (kept) kept->add(number, measurement.now(), run.scene);
  };
  if (!measurement.add_all(first, keep)) return std::nullopt;
  if (kept) kept->finish();
  if (first.path) worker.go(first, record.truth);
  return measurement.finish();
}

}  // namespace gnomon
