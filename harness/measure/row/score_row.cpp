// The score of a row's masks: metrics, classes and causes, of each light and of all together.
#include "measure/row/score_row.h"

#include "measure/picture/shading.h"

namespace gnomon {

namespace {

/// Adds up by name.
template <class Number>
void add_to(std::map<std::string, Number>& sums, const std::map<std::string, Number>& more, Number weight = 1) {
  for (const auto& [name, number] : more) sums[name] += weight * number;
}
/// The same where there is something to add.
template <class Number>
void add_to(std::optional<std::map<std::string, Number>>& sums, const std::optional<std::map<std::string, Number>>& more,
            Number weight = 1) {
  if (more) add_to(sums ? *sums : sums.emplace(), *more, weight);
}

Score score_of(const Evidence& evidence, const Scoring& scoring) {
  Score score{.kind = evidence.kind,
              .metrics = measure_metrics(scoring),
              .classes = class_counts(evidence.classes),
              .causes = {},
              .cause_errors = {}};
  if (evidence.causes.empty()) return score;
  score.causes = count_causes(evidence.causes, evidence.own_causes);
  if (has_cause_errors(evidence.kind)) score.cause_errors = cause_errors(evidence);
  return score;
}

}  // namespace

RowScore score(const MeasuredRow& row, const Scene& scene, const MeasuredRow* before) {
  Evidence evidence = row.evidence(scene), previous;
  if (before) {
    previous = before->evidence(scene);
    evidence.previous = &previous;
    for (std::size_t k = 0; k < evidence.channels.size(); ++k) evidence.channels[k].previous = &previous.channels[k];
  }
  const Scoring scoring(evidence);
  RowScore result{.lights = {},
                  .whole = score_of(evidence, scoring),
                  .errors = scoring.error_counts(),
                  .exposure = exposure_of(scene, row.gbuffer(), scoring.received())};
  if (!row.together) {
    result.lights = {result.whole};
    return result;
  }
  // A pixel may be wrong under several lights: their causes are counted under each.
  result.whole.causes.reset();
  for (const MeasuredLight& light : row.lights) {
    const Evidence one = light.answer.evidence(scene, light.light);
    result.lights.push_back(score_of(one, Scoring(one)));
    add_to(result.whole.causes, result.lights.back().causes);
  }
  return result;
}

std::optional<Record::ReferenceFacts> reference_facts(const Answer& answer, const AreaTarget& target) {
  const Reference& reference = answer.reference;
  if (reference.kind != AnswerKind::fraction) return std::nullopt;
  Record::ReferenceFacts facts{.estimates = answer.estimates, .target = target.error, .cap = target.cap};
  const std::span<const float> errors = answer.estimates == LightShareKind::area ? reference.error : reference.irradiance_error;
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

std::optional<Record::PixelFacts> pixel_facts(const Answer& answer) {
  const PixelTruth& truth = answer.pixel_truth;
  if (truth.kept.empty()) return std::nullopt;
  const Evidence e = answer.evidence();
  Record::PixelFacts facts{.rays = pixel_rays};
  std::size_t of_t = 0;
  for (std::size_t i = 0; i < truth.kept.size(); ++i) {
    if (e.classes[i] != PixelClass::T) continue;
    ++of_t;
    facts.kept += truth.kept[i];
    if (!e.is_tested_over_pixel(i)) continue;
    ++facts.tested;
    facts.error_mean += truth.error[i];
    facts.error_max = std::max<double>(facts.error_max, truth.error[i]);
  }
  if (of_t > 0) facts.kept /= static_cast<double>(of_t) * pixel_rays;
  if (facts.tested > 0) facts.error_mean /= static_cast<double>(facts.tested);
  return facts;
}

void put_score(Record& record, std::span<const Score> lights, const Score& whole) {
  const auto put = [](auto& into, const Score& from) {
    into.answer = from.kind;
    into.classes = from.classes;
    into.causes = from.causes;
    into.cause_errors = from.cause_errors;
  };
  put(record, whole);
  record.metrics[record.truth] = whole.metrics;
  auto from = lights.begin();
  for (Record::LightFacts& light : record.lights) {
    put(light, *from);
    light.metrics = (from++)->metrics;
  }
}

void put_score(Record& record, const RowScore& score) {
  put_score(record, score.lights, score.whole);
  record.exposure = score.exposure;
}

void PathScore::add(const Score& score) {
  ++frames_;
  sum_.kind = score.kind;
  add_to(sum_.classes, score.classes);
  add_to(sum_.causes, score.causes);
  add_to(sum_.cause_errors, score.cause_errors, share_);
  for (const auto& [metric, value] : score.metrics) {
    auto& [total, count] = metrics_[metric];
    if (!value) continue;
    total += *value;
    ++count;
  }
}

Score PathScore::score() const {
  Score mean = sum_;
  for (const auto& [metric, total] : metrics_) {
    const auto& [value, count] = total;
    // One between two frames has no value at the first.
    const int due = metric_is_of(metric) == MetricInfo::Of::two_frames && frames_ > 1 ? frames_ - 1 : frames_;
    mean.metrics[metric] = count == due ? std::optional(value / count) : std::nullopt;
  }
  return mean;
}

}  // namespace gnomon
