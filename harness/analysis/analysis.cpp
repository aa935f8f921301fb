#include "analysis/analysis.h"

#include <gnomon/registry.h>

#include <charconv>

#include "analysis/in_order.h"
#include "measure/counted.h"
#include "measure/pattern.h"
#include "measure/record/title.h"
#include "measure/scene/time_reference.h"
#include "measure/score/metrics.h"
#include "measure/statistics/resample.h"

namespace gnomon {

namespace {

constexpr std::string_view cost_names[] = {"resolve", "light", "geometry", "motion", "bytes"};

/// Reorders the values.
double median_in_place(std::span<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  if (values.size() % 2 == 1) return *middle;
  return (*middle + *std::max_element(values.begin(), middle)) / 2;
}

/// The names of the quantities that these records have.
std::vector<std::string> quantity_names(std::span<const Record> records) {
  std::vector<std::string> names;
  const auto add = [&](const std::string& one) { add_once(names, one); };
  for (const Record& r : records) {
    if (const auto found = r.metrics.find(r.truth); found != r.metrics.end())
      for (const auto& [metric, value] : found->second) add(metric);
    for (const TimedPart part : all_parts)
      if (!times_of(r, part).empty()) add(fmt::format("{}_ms", name(part)));
    if (sample_of(r, parts_of(Cost::motion)).is_timed()) add("motion_ms");
    if (r.bytes) add("bytes");
    if (r.peak_bytes) add("peak_bytes");
    if (r.causes)
      for (const auto& [cause, pixels] : *r.causes) add("cause." + cause);
  }
  return names;
}

}  // namespace

Sample::Sample(std::vector<ProcessTimes> stages) : stages_(std::move(stages)) {
  for (ProcessTimes& stage : stages_) {
    std::erase_if(stage, [](const std::vector<double>& process) { return process.empty(); });
    order_long_processes(stage);
  }
}

bool Sample::is_timed() const {
  return !stages_.empty() && std::ranges::none_of(stages_, [](const auto& stage) { return stage.empty(); });
}

bool Sample::has_processes() const {
  return is_timed() && std::ranges::all_of(stages_, [](const auto& stage) { return stage.size() >= 2; });
}

double Sample::value() const {
  double sum = 0;
  for (const ProcessTimes& stage : stages_) sum += median_of_medians(stage).value_or(0);
  return sum;
}

double Sample::draw(Random& random) const {
  std::size_t most = 0;
  for (const ProcessTimes& stage : stages_) most = std::max(most, stage.size());
  // One stream of draws for all stages: with equal numbers of processes these are the same processes.
  static thread_local std::vector<std::uint32_t> drawn;
  static thread_local std::vector<double> medians, scratch;
  drawn.resize(most);
  for (std::uint32_t& one : drawn) one = random.next();
  double sum = 0;
  for (const ProcessTimes& stage : stages_) {
    medians.resize(stage.size());
    for (std::size_t k = 0; k < stage.size(); ++k) {
      const std::vector<double>& process = stage[static_cast<std::size_t>(std::uint64_t{drawn[k]} * stage.size() >> 32)];
      medians[k] = median_in_place(draw_repetitions(process, random, scratch));
    }
    sum += median_in_place(medians);
  }
  return sum;
}

ValueWithInterval Sample::estimate() const {
  return bootstrap({this, 1}, [](std::span<const double> values) { return values[0]; });
}

std::optional<LogTime> Sample::log_time() const {
  if (!has_processes()) return std::nullopt;
  std::size_t processes = stages_.front().size();
  for (const ProcessTimes& stage : stages_) processes = std::min(processes, stage.size());
  ProcessTimes sums(processes, {0.0});
  for (const ProcessTimes& stage : stages_)
    for (std::size_t k = 0; k < processes; ++k) sums[k].front() += median(stage[k]);
  return gnomon::log_time(sums);
}

ValueWithInterval bootstrap(std::span<const Sample> samples, const std::function<double(std::span<const double>)>& statistic) {
  std::vector<double> values;
  for (const Sample& sample : samples) values.push_back(sample.value());
  const double value = statistic(values);
  const bool has_interval = std::ranges::all_of(samples, [](const Sample& s) { return s.has_processes(); });
  if (!has_interval || samples.empty()) return ValueWithInterval(value);
  Random random(1);
  std::vector<double> resamples(resample_count);
  for (double& resample : resamples) {
    for (std::size_t i = 0; i < samples.size(); ++i) values[i] = samples[i].draw(random);
    resample = statistic(values);
  }
  return {value, quantile(resamples, 0.025), quantile(resamples, 0.975)};
}

std::string_view name(Cost cost) { return cost_names[static_cast<int>(cost)]; }

std::string_view sentence(Cost cost) {
  static constexpr std::string_view sentences[] = {"resolve", "relight + resolve", "build + relight + resolve",
                                                   "update + relight + resolve", "memory"};
  return sentences[static_cast<int>(cost)];
}

Cost cost_named(std::string_view wanted) {
  const auto found = std::ranges::find(cost_names, wanted);
  if (found == std::end(cost_names)) throw Error("there is no cost {}; there are: {}", wanted, joined(cost_names, ", "));
  return static_cast<Cost>(found - cost_names);
}

std::span<const TimedPart> parts_of(Cost cost) {
  static constexpr TimedPart geometry[] = {Stage::build, Stage::relight, Stage::resolve};
  static constexpr TimedPart motion[] = {Stage::update, {Stage::relight, true}, {Stage::resolve, true}};
  switch (cost) {
    case Cost::resolve:
      return std::span(geometry).last(1);
    case Cost::light:
      return std::span(geometry).last(2);
    case Cost::geometry:
      return geometry;
    case Cost::motion:
      return motion;
    case Cost::bytes:
      break;
  }
  return {};
}

Sample sample_of(const Record& record, std::span<const TimedPart> parts) {
  std::vector<ProcessTimes> times;
  for (const TimedPart part : parts) times.push_back(times_of(record, part));
  return Sample(std::move(times));
}

std::optional<ValueWithInterval> cost_of(const Record& record, Cost cost) {
  if (cost == Cost::bytes)
    return record.bytes ? std::optional(ValueWithInterval(static_cast<double>(*record.bytes))) : std::nullopt;
  const Sample sample = sample_of(record, parts_of(cost));
  return sample.is_timed() ? std::optional(sample.estimate()) : std::nullopt;
}

Place place_of(const Record& r) {
  return {r.scene,
          r.light,
          r.view,
          r.path,
          r.width,
          r.height,
          r.truth,
          r.start.value_or(0),
          r.frame_rate.value_or(0),
          r.frame_count.value_or(0)};
}

std::string title(const Place& place, std::span<const Place> all) {
  const auto varies = [&](auto member) {
    return std::ranges::any_of(all, [&](const Place& other) { return other.*member != place.*member; });
  };
  std::string text = place.scene;
  if (!place.light.empty()) text += ", " + place.light;
  if (!place.view.empty() && varies(&Place::view)) text += ", view " + place.view;
  if (!place.path.empty()) text += ", path " + place.path;
  if (place.frame_rate > 0 && varies(&Place::start)) text += fmt::format(" from {} s", place.start);
  if (place.frame_rate > 0 && varies(&Place::frame_rate)) text += fmt::format(" at {} Hz", place.frame_rate);
  if (place.frame_rate > 0 && varies(&Place::frame_count)) text += ", " + counted(place.frame_count, "frame{s}");
  if (varies(&Place::width) || varies(&Place::height)) text += fmt::format(", {} x {}", place.width, place.height);
  if (varies(&Place::truth)) text += fmt::format(", {} truth", name(place.truth));
  return text;
}

std::vector<std::string> context_values(std::span<const Record> records, const char* key) {
  std::vector<std::string> values;
  for (const Record& r : records)
    if (const auto found = r.context.find(key); found != r.context.end() && !found->is_null())
      add_once(values, plain_text(*found));
  return values;
}

std::optional<double> number_from(std::string_view text) {
  double value = 0;
  const auto [end, code] = std::from_chars(text.data(), text.data() + text.size(), value);
  return code == std::errc{} && end == text.data() + text.size() ? std::optional(value) : std::nullopt;
}

std::vector<std::pair<std::string, std::string>> split_settings(std::string_view settings) {
  std::vector<std::pair<std::string, std::string>> pairs;
  while (!settings.empty()) {
    const std::size_t comma = settings.find(',');
    const std::string_view one = settings.substr(0, comma);
    const std::size_t equals = one.find('=');
    if (equals != one.npos) pairs.emplace_back(one.substr(0, equals), one.substr(equals + 1));
    settings.remove_prefix(comma == settings.npos ? settings.size() : comma + 1);
  }
  return pairs;
}

std::pair<std::string, std::string> split_reference(const std::string& reference) {
  const std::string scene = without_time(reference);
  const std::size_t colon = scene.find(':');
  if (colon == scene.npos || scene.find('=', colon) == scene.npos) return {scene, ""};
  return {scene.substr(0, colon), scene.substr(colon + 1)};
}

std::optional<double> scene_parameter(const std::string& scene, std::string_view parameter) {
  const auto [id, settings] = split_reference(scene);
  for (const auto& [key, value] : split_settings(settings))
    if (key == parameter) return number_from(value);
  const SceneEntry* entry = registry().find_scene(id);
  if (!entry) return std::nullopt;
  const auto generator = entry->make();
  for (const Parameter* one : generator->parameters())
    if (one->name() == parameter) return number_from(one->default_text());
  return std::nullopt;
}

std::span<const TimedPart> parts_of_time(std::string_view quantity) {
  if (quantity == "motion_ms") return parts_of(Cost::motion);
  for (const TimedPart& part : all_parts)
    if (quantity.starts_with(name(part)) && quantity.substr(name(part).size()) == "_ms") return {&part, 1};
  return {};
}

std::optional<double> quantity(const Record& r, std::string_view wanted) {
  if (wanted.starts_with("cause.")) {
    const auto shares = cause_shares(r);
    if (!shares) return std::nullopt;
    const auto found = shares->find(std::string(wanted.substr(6)));
    return found == shares->end() ? std::nullopt : std::optional(found->second);
  }
  if (const std::span<const TimedPart> parts = parts_of_time(wanted); !parts.empty()) {
    const Sample sample = sample_of(r, parts);
    return sample.is_timed() ? std::optional(sample.value()) : std::nullopt;
  }
  if (wanted == "bytes" && r.bytes) return static_cast<double>(*r.bytes);
  if (wanted == "peak_bytes" && r.peak_bytes) return static_cast<double>(*r.peak_bytes);
  return r.metric(wanted);
}

std::optional<double> noise_floor(const Record& r, std::string_view wanted) {
  return r.metric(fmt::format("{}_floor", wanted));
}

static constexpr std::string_view error_over_pixel = "coverage_error_mean";

/// Whether it is compared with the truth over the pixel.
static bool is_over_pixel(std::string_view quantity) {
  return quantity == error_over_pixel || quantity == "coverage_error_rms";
}

std::string_view judging_metric(std::span<const Record> records) {
  const auto is_done = [](const Record& r) { return r.status == Status::ok; };
  const auto is_other = [&](const Record& r) {
    return is_done(r) && (r.truth_over != TruthOver::pixel || !r.metric(error_over_pixel));
  };
  return std::ranges::any_of(records, is_done) && std::ranges::none_of(records, is_other) ? error_over_pixel : "error";
}

std::string_view constant_metric(std::string_view quantity) {
  return is_over_pixel(quantity) ? "coverage_constant_error" : "constant_error";
}

std::optional<double> gain_over_constant(const Record& r, std::string_view quantity) {
  const std::optional<double> error = r.metric(is_over_pixel(quantity) ? error_over_pixel : "error"),
                              constant = r.metric(constant_metric(quantity));
  return error && constant ? std::optional(*constant - *error) : std::nullopt;
}

std::string_view lights_text(AnswerKind answer) {
  static constexpr std::string_view texts[] = {"lights without area", "lights with area", "several lights together",
                                               "lights without area behind glass"};
  return texts[static_cast<std::size_t>(answer)];
}

void require_quantity(std::span<const Record> records, std::string_view wanted) {
  const std::vector<std::string> names = quantity_names(records);
  if (names.empty()) throw Error("there is no {}: no row of these records was measured", wanted);
  require_word("there is no", wanted, names);
}

std::string_view better(std::string_view wanted) {
  for (const MetricInfo& info : metric_infos())
    if (info.name == wanted) return info.better;
  return "lower";
}

void require_word(std::string_view lead, std::string_view word, std::span<const std::string> names) {
  if (std::ranges::find(names, word) == names.end())
    throw Error("{} {}; did you mean {}? There are: {}", lead, word, nearest_word(word, names), joined(names, ", "));
}

std::string how_to_sweep(std::string_view parameter) {
  return fmt::format("request a sweep with ID:{}={{A,B,C}} as scene or technique of a run", parameter);
}

std::vector<Record> matching(std::vector<Record> records, const std::string& expression) {
  if (expression.empty()) return records;
  const Pattern pattern(expression, "is not a regular expression");
  std::erase_if(records, [&](const Record& r) {
    const std::string where = title_of_place(r.scene, r.light, r.view, r.path);
    // All parameters too: settings lack those at their defaults.
    std::string full = where + r.technique + ":";
    for (const auto& [parameter, value] : r.parameters.items()) full += fmt::format("{}={},", parameter, plain_text(value));
    return !pattern.is_in(title(r)) && !pattern.is_in(where + setting_name(r)) && !pattern.is_in(full);
  });
  return records;
}

}  // namespace gnomon
