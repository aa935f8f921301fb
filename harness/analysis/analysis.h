#pragma once
#include <gnomon/kit/random.h>

#include <compare>
#include <functional>
#include <string>
#include <string_view>

#include "analysis/timed_part.h"
#include "analysis/told_apart.h"
#include "measure/record/record.h"

namespace gnomon {

// What every analysis of a run starts from. All of it reads records and runs nothing.

/// A number with the ends of its 95 % interval; both ends are the value where there is none.
struct ValueWithInterval {
  double value = 0, low = 0, high = 0;
  bool has_interval = false;
  ValueWithInterval() = default;
  explicit ValueWithInterval(double only) : value(only), low(only), high(only) {}
  ValueWithInterval(double value, double low, double high) : value(value), low(low), high(high), has_interval(true) {}
};

/// Times that the bootstrap draws together, because the same processes took them: stages of one row. Their value is the sum of
/// the stages' medians of process medians.
class Sample {
 public:
  explicit Sample(std::vector<ProcessTimes> stages);
  bool is_timed() const;       ///< every stage has a time
  bool has_processes() const;  ///< every stage has at least two processes: there is an interval
  double value() const;
  ValueWithInterval estimate() const;       ///< see `bootstrap`
  std::optional<LogTime> log_time() const;  ///< of the stages' sum, process by process
  /// Processes are drawn with replacement, the same ones for all stages; then the repetitions within each.
  double draw(Random& random) const;

 private:
  std::vector<ProcessTimes> stages_;
};

/// The statistic of the samples' values with its 95 % percentile interval over `resample_count` draws of them all; no interval
/// where a sample has too few processes. The statistic takes one value per sample, in their order. Same samples, same interval.
ValueWithInterval bootstrap(std::span<const Sample> samples, const std::function<double(std::span<const double>)>& statistic);

/// What a row costs after an event: milliseconds of stages, or bytes.
enum class Cost {
  resolve,   ///< the camera moved: resolve
  light,     ///< the light moved: relight, resolve
  geometry,  ///< another scene: build, relight, resolve
  motion,    ///< the geometry of the scene moved: update, and relight and resolve in the frames after it
  bytes,     ///< what the technique says it holds
};
std::string_view name(Cost cost);
std::string_view sentence(Cost cost);  ///< "relight + resolve"
/// Throws Error with the list.
Cost cost_named(std::string_view name);
/// None of `bytes`.
std::span<const TimedPart> parts_of(Cost cost);
/// The parts of a row, to be drawn together.
Sample sample_of(const Record& record, std::span<const TimedPart> parts);
/// Nothing where the row did not measure it.
std::optional<ValueWithInterval> cost_of(const Record& record, Cost cost);

/// Where a row was measured, all but the technique: what makes rows comparable.
struct Place {
  std::string scene, light, view, path;
  int width = 0, height = 0;
  Truth truth = Truth::shape;
  double start = 0, frame_rate = 0;  ///< of a row whose geometry moves: seconds, and frames per second; else 0
  int frame_count = 0;               ///< of such a row
  auto operator<=>(const Place&) const = default;
};
Place place_of(const Record& record);
/// "bunny, point", the path, and of view, times of an animation, size and truth what varies among `all`.
std::string title(const Place& place, std::span<const Place> all);

/// The different values of a key of the context, as text, in order of appearance.
std::vector<std::string> context_values(std::span<const Record> records, const char* key);

/// The number that the whole text is, if it is one.
std::optional<double> number_from(std::string_view text);
/// "a=1,b=2" into pairs.
std::vector<std::pair<std::string, std::string>> split_settings(std::string_view settings);
/// "soup:count=5,seed=2" is "soup" and "count=5,seed=2"; a file's path has no settings. A time is left out.
std::pair<std::string, std::string> split_reference(const std::string& reference);
/// The value of a scene's parameter: as its reference writes it, else the default of the registered scene of that id; nothing
/// when it has no such parameter or its value is no number.
std::optional<double> scene_parameter(const std::string& scene, std::string_view parameter);

/// The parts whose time the quantity is: resolve of "resolve_ms", those of Cost::motion of "motion_ms"; none of another one.
std::span<const TimedPart> parts_of_time(std::string_view quantity);
/// Anything in a record that has one number: a metric (headline truth), `cause.NAME` (share of T), STAGE_ms,
/// moving_relight_ms, moving_resolve_ms, motion_ms, bytes, peak_bytes.
std::optional<double> quantity(const Record& record, std::string_view name);
/// Of a metric under a light with area what the reference's own noise makes of it, METRIC_floor: a smaller one cannot be
/// distinguished from that of a right mask. Nothing of other quantities and lights.
std::optional<double> noise_floor(const Record& record, std::string_view quantity);
/// The metric that rows are judged by where nobody names one: the error, or where every finished row asks to be judged by the
/// truth over the pixel, and has it, that error.
std::string_view judging_metric(std::span<const Record> records);
/// The error of the best constant mask that belongs to a quantity: of errors over the pixel it is another one.
std::string_view constant_metric(std::string_view quantity);
/// How far the row's error lies below that of the best constant mask at its place; nothing where the record does not say. By
/// the truth over the pixel where that is what the quantity is compared with.
std::optional<double> gain_over_constant(const Record& record, std::string_view quantity = "error");
/// Whether a row may be called best in a quantity: its error is below that of the best constant mask, or the record does not
/// say.
inline bool beats_constant(const Record& record, std::string_view quantity = "error") {
  return gain_over_constant(record, quantity).value_or(1) > 0;
}
/// "lights with area".
std::string_view lights_text(AnswerKind answer);
/// Throws Error with the nearest name when no record has it.
void require_quantity(std::span<const Record> records, std::string_view name);
/// "lower" or "higher"; "lower" for times, sizes and causes, "" where a metric has no direction.
std::string_view better(std::string_view quantity);
/// Whether a is better than b in a quantity of this direction.
inline bool is_better(std::string_view direction, double a, double b) { return direction == "higher" ? a > b : a < b; }

/// Throws Error unless the word is one of these: "there is no axis X; did you mean Y? There are: Y, Z" with the `lead` "there
/// is no axis".
void require_word(std::string_view lead, std::string_view word, std::span<const std::string> names);
/// What an error says to do where a parameter has one value only.
std::string how_to_sweep(std::string_view parameter);

/// The records whose title, "SCENE LIGHT [VIEW] [PATH] TECHNIQUE:SETTINGS" as in `gnomon run`, matches the expression, which
/// may be empty; the label may replace technique and settings, and all parameters those that differ from their defaults.
/// Throws Error.
std::vector<Record> matching(std::vector<Record> records, const std::string& expression);

}  // namespace gnomon
