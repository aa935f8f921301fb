#include "report/table/columns.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <regex>

#include "analysis/analysis.h"
#include "measure/cause/causes.h"
#include "measure/score/metrics.h"
#include "report/table/digits.h"

namespace gnomon {

namespace {

constexpr double mebibyte = 1024 * 1024;

/// Nothing, NaN and infinity are null.
template <class T>
Cell number(const std::optional<T>& value) {
  return value && std::isfinite(static_cast<double>(*value)) ? Cell{.value = static_cast<double>(*value)} : Cell{};
}

/// Empty text is null: nobody gave it.
Cell text(const std::string& value) { return value.empty() ? Cell{} : Cell{.value = value}; }

Column text_column(std::string name, std::string heading, std::function<Cell(const Record&)> cell) {
  return {.name = std::move(name),
          .unit = "",
          .heading = std::move(heading),
          .shown_unit = "",
          .alignment = Align::left,
          .cell = std::move(cell)};
}

Column whole_column(std::string name, std::string unit, std::string heading, std::function<Cell(const Record&)> cell) {
  return {.name = std::move(name),
          .unit = unit,
          .heading = std::move(heading),
          .shown_unit = unit,
          .is_exact = true,
          .cell = std::move(cell)};
}

Column bytes_column(std::string name, std::string heading, std::string better, std::function<Cell(const Record&)> cell) {
  return {.name = std::move(name),
          .unit = "byte",
          .heading = std::move(heading),
          .shown_unit = "MiB",
          .shown_scale = 1 / mebibyte,
          .better = std::move(better),
          .cell = std::move(cell)};
}

/// Label, else id with settings: what tells two rows of a group apart.
Cell technique_cell(const Record& r) {
  return {.value = r.technique, .shown = r.label ? *r.label : r.technique + (r.settings.empty() ? "" : ":" + r.settings)};
}

Cell support_cell(const Record& r) {
  Cell cell;
  if (r.support) cell.value = std::string(name(*r.support));
  if (r.status == Status::failed)
    cell.shown = "failed";
  else if (r.status == Status::unsupported)
    cell.shown = "no";
  else if (r.support)
    cell.shown = *r.support == Support::Kind::approximate ? "approx." : "full";
  return cell;
}

void add_identity(std::vector<Column>& columns) {
  columns.push_back(text_column("job", "job", [](const Record& r) { return text(r.job); }));
  columns.push_back(text_column("suite", "suite", [](const Record& r) { return text(r.suite); }));
  columns.push_back(text_column("scene", "scene", [](const Record& r) { return text(r.scene); }));
  columns.push_back(text_column("light", "light", [](const Record& r) { return text(r.light); }));
  columns.push_back(text_column("light_kind", "light kind", [](const Record& r) { return text(r.light_kind); }));
  columns.push_back(text_column("view", "view", [](const Record& r) { return text(r.view); }));
  columns.push_back(text_column("path", "path", [](const Record& r) { return text(r.path); }));
  columns.push_back(whole_column("frames", "", "frames", [](const Record& r) {
    std::size_t most = 0;
    for (const auto& [metric, values] : r.frames) most = std::max(most, values.size());
    return most > 0 ? Cell{.value = static_cast<double>(most)} : Cell{};
  }));
  columns.push_back(text_column("technique", "technique", technique_cell));
  columns.push_back(text_column("settings", "settings", [](const Record& r) { return text(r.settings); }));
  columns.push_back(text_column("label", "label", [](const Record& r) { return text(r.label.value_or("")); }));
  columns.push_back(text_column("role", "role", [](const Record& r) { return text(std::string(name(r.role))); }));
  columns.push_back(whole_column("width", "px", "width", [](const Record& r) { return Cell{.value = double(r.width)}; }));
  columns.push_back(whole_column("height", "px", "height", [](const Record& r) { return Cell{.value = double(r.height)}; }));
  columns.push_back(text_column("truth", "truth", [](const Record& r) { return text(std::string(name(r.truth))); }));
  columns.push_back(text_column("status", "status", [](const Record& r) { return text(std::string(name(r.status))); }));
  columns.push_back(text_column("support", "support", support_cell));
  columns.push_back(text_column("reason", "reason", [](const Record& r) { return text(r.reason); }));
}

/// Intervals of one stage, made once for each record that is asked about: both ends and the best mark want the same one.
class Intervals {
 public:
  explicit Intervals(Stage stage) : stage_(stage) {}
  std::optional<Estimate> of(const Record& record) {
    const ProcessTimes& times = record.times(stage_);
    Known& known = known_[&record];
    // Another record may stand where one stood before.
    if (!known.is_made || known.times != times) known = {true, times, bootstrap(times)};
    return known.interval;
  }

 private:
  struct Known {
    bool is_made = false;
    ProcessTimes times = {};
    std::optional<Estimate> interval = {};
  };
  Stage stage_;
  std::map<const Record*, Known> known_;
};

/// Median absolute deviation of the process medians: how far one process is from another.
std::optional<double> spread(const ProcessTimes& times) {
  std::vector<double> medians;
  for (const std::vector<double>& process : times)
    if (!process.empty()) medians.push_back(median(process));
  return medians.size() < 2 ? std::nullopt : std::optional(median_absolute_deviation(medians));
}

void add_times(std::vector<Column>& columns) {
  for (const Stage stage : {Stage::setup, Stage::build, Stage::relight, Stage::resolve}) {
    const std::string stage_name(name(stage));
    const auto add = [&](const char* suffix, const char* heading, const char* better, std::function<Cell(const Record&)> cell) {
      columns.push_back({.name = stage_name + "_ms" + suffix,
                         .unit = "ms",
                         .heading = stage_name + heading,
                         .shown_unit = "ms",
                         .better = better,
                         .cell = std::move(cell)});
    };
    const auto intervals = std::make_shared<Intervals>(stage);
    add("", "", "lower", [stage](const Record& r) { return number(median_of_medians(r.times(stage))); });
    columns.back().interval = [intervals](const Record& r) { return intervals->of(r); };
    add("_low", " low", "", [intervals](const Record& r) {
      const std::optional<Estimate> estimate = intervals->of(r);
      return estimate ? Cell{.value = estimate->low} : Cell{};
    });
    add("_high", " high", "", [intervals](const Record& r) {
      const std::optional<Estimate> estimate = intervals->of(r);
      return estimate ? Cell{.value = estimate->high} : Cell{};
    });
    add("_mad", " MAD", "", [stage](const Record& r) { return number(spread(r.times(stage))); });
  }
  columns.push_back(whole_column("processes", "", "processes", [](const Record& r) {
    const std::size_t count = r.times(Stage::resolve).size();
    return count > 0 ? Cell{.value = static_cast<double>(count)} : Cell{};
  }));
  columns.push_back(whole_column("repetitions", "", "repetitions", [](const Record& r) {
    std::size_t most = 0;
    for (const std::vector<double>& process : r.times(Stage::resolve)) most = std::max(most, process.size());
    return most > 0 ? Cell{.value = static_cast<double>(most)} : Cell{};
  }));
  columns.push_back(text_column("stop", "stopped by", [](const Record& r) { return text(r.stop); }));
}

void add_memory(std::vector<Column>& columns) {
  columns.push_back(bytes_column("bytes", "memory", "lower", [](const Record& r) { return number(r.bytes); }));
  columns.push_back(bytes_column("peak_bytes", "peak", "", [](const Record& r) { return number(r.peak_bytes); }));
  columns.push_back(bytes_column("gl_input_bytes", "GL inputs", "", [](const Record& r) {
    return r.gl ? Cell{.value = static_cast<double>(r.gl->input_bytes)} : Cell{};
  }));
  columns.push_back(
      {.name = "gl_upload_ms", .unit = "ms", .heading = "GL upload", .shown_unit = "ms", .cell = [](const Record& r) {
         return r.gl ? Cell{.value = r.gl->upload_ms} : Cell{};
       }});
}

/// "false_dark_rate" -> "false dark": the unit says that it is a rate. "displacement" is too wide for two columns of a table.
std::string heading_of(std::string metric) {
  if (metric.ends_with("_rate")) metric.resize(metric.size() - 5);
  if (const std::size_t rate = metric.find("_rate_"); rate != metric.npos) metric.erase(rate, 5);
  if (metric.starts_with("displacement")) metric.replace(0, 12, "displ.");
  // "wrong_rate_edge_0_1" -> "wrong edge 0..1".
  static const std::regex bounds("_([0-9]+)_([0-9]+|up)$");
  metric = std::regex_replace(metric, bounds, " $1..$2");
  std::replace(metric.begin(), metric.end(), '_', ' ');
  return metric;
}

/// A metric without unit is a share of 1 and shown in percent.
Column metric_column(const MetricInfo& info, const std::string& prefix, std::function<Truth(const Record&)> truth) {
  const std::string metric(info.name);
  const bool is_share = info.unit.empty();
  return {.name = prefix + metric,
          .unit = std::string(info.unit),
          .heading = heading_of(metric),
          .shown_unit = is_share ? "%" : std::string(info.unit),
          .shown_scale = is_share ? 100.0 : 1.0,
          .better = std::string(info.better),
          .sentence = std::string(info.sentence),
          .cell = [metric, truth = std::move(truth)](const Record& r) {
            Cell cell = number(r.metric(truth(r), metric));
            cell.is_flagged = metric == "tested_share" && cell.number() && *cell.number() < least_tested_share;
            return cell;
          }};
}

void add_metrics(std::vector<Column>& columns) {
  for (const MetricInfo& info : metric_infos())
    columns.push_back(metric_column(info, "", [](const Record& r) { return r.truth; }));
  for (const Truth truth : {Truth::shape, Truth::mesh})
    for (const MetricInfo& info : metric_infos()) {
      Column column = metric_column(info, std::string(name(truth)) + ".", [truth](const Record&) { return truth; });
      column.heading += fmt::format(" ({})", name(truth));
      columns.push_back(std::move(column));
    }
}

/// "edge_resolution" -> "edge resolution".
std::string words_of(std::string_view cause) {
  std::string words(cause);
  std::replace(words.begin(), words.end(), '_', ' ');
  return words;
}

void add_causes(std::vector<Column>& columns) {
  columns.push_back(text_column("causes", "causes", [](const Record& r) { return text(top_causes(r)); }));
  columns.back().sentence = "The most frequent causes of the wrong pixels, with their shares of them.";
  for (const CauseInfo& info : cause_infos()) {
    const std::string quantity_name = fmt::format("cause.{}", info.name);
    columns.push_back({.name = quantity_name,
                       .unit = "",
                       .heading = words_of(info.name),
                       .shown_unit = "%",
                       .shown_scale = 100,
                       .better = "lower",
                       .sentence = std::string(info.sentence),
                       .cell = [quantity_name](const Record& r) { return number(quantity(r, quantity_name)); }});
  }
}

void add_facts(std::vector<Column>& columns) {
  for (const ClassInfo& info : class_infos())
    columns.push_back(whole_column(fmt::format("class.{}", info.letter), "px", fmt::format("class {}", info.letter),
                                   [letter = std::string(info.letter)](const Record& r) {
                                     const auto found = r.classes.find(letter);
                                     return found == r.classes.end() ? Cell{}
                                                                     : Cell{.value = static_cast<double>(found->second)};
                                   }));
  columns.push_back(whole_column("triangles", "", "triangles", [](const Record& r) {
    return r.scene_facts ? Cell{.value = static_cast<double>(r.scene_facts->triangles)} : Cell{};
  }));
  columns.push_back(text_column("closed", "closed", [](const Record& r) {
    return r.scene_facts ? text(r.scene_facts->closed ? "true" : "false") : Cell{};
  }));
  columns.push_back({.name = "seconds", .unit = "s", .heading = "took", .shown_unit = "s", .cell = [](const Record& r) {
                       return number(r.seconds);
                     }});
  columns.push_back(text_column("mask", "mask", [](const Record& r) { return text(r.mask.value_or("")); }));
}

Cell parameter_cell(const Record& record, const std::string& parameter) {
  const auto found = record.parameters.find(parameter);
  if (found == record.parameters.end() || found->is_null()) return {};
  if (found->is_number()) return {.value = found->get<double>()};
  return {.value = plain_text(*found)};
}

void add_parameters(std::vector<Column>& columns, std::span<const Record> records) {
  std::map<std::string, bool> are_numbers;  // by parameter, in alphabetical order
  for (const Record& record : records)
    for (const auto& [parameter, value] : record.parameters.items()) {
      const auto [place, is_new] = are_numbers.try_emplace(parameter, true);
      place->second = place->second && value.is_number();
    }
  for (const auto& [parameter, is_number] : are_numbers) {
    const auto cell = [parameter = parameter](const Record& r) { return parameter_cell(r, parameter); };
    columns.push_back(is_number ? whole_column("parameter." + parameter, "", parameter, cell)
                                : text_column("parameter." + parameter, parameter, cell));
  }
}

void add_counts(std::vector<Column>& columns, std::span<const Record> records) {
  std::map<std::string, std::string> units;  // by count, in alphabetical order
  for (const Record& record : records)
    for (const Count& count : record.counts) units.try_emplace(count.name, count.unit);
  for (const auto& [count, unit] : units)
    columns.push_back(whole_column("count." + count, unit, count, [count = count](const Record& r) {
      for (const Count& candidate : r.counts)
        if (candidate.name == count) return number(std::optional(candidate.value));
      return Cell{};
    }));
}

}  // namespace

std::vector<Column> all_columns(std::span<const Record> records) {
  std::vector<Column> columns;
  add_identity(columns);
  add_times(columns);
  add_memory(columns);
  add_metrics(columns);
  add_causes(columns);
  add_facts(columns);
  add_parameters(columns, records);
  add_counts(columns, records);
  return columns;
}

std::string top_causes(const Record& record, std::size_t most) {
  if (!record.causes) return "";
  std::uint64_t wrong = 0;
  std::vector<std::pair<std::uint64_t, std::string>> counted;
  for (const auto& [cause, pixels] : *record.causes) {
    wrong += pixels;
    if (pixels > 0) counted.emplace_back(pixels, words_of(cause));
  }
  std::stable_sort(counted.begin(), counted.end(), [](const auto& a, const auto& b) { return a.first > b.first; });
  std::vector<std::string> parts;
  for (const auto& [pixels, cause] : counted) {
    const double percent = 100 * static_cast<double>(pixels) / static_cast<double>(wrong);
    if (parts.size() == most || percent < 0.5) break;
    parts.push_back(fmt::format("{} {:.0f} %", cause, percent));
  }
  return joined(parts, ", ");
}

std::string shown(const Column& column, const Cell& cell) {
  if (!cell.shown.empty()) return cell.shown;
  if (const double* value = cell.number()) {
    const double scaled = *value * column.shown_scale;
    if (column.is_exact) return exact(scaled);
    // Indices are read by their distance to 0 or 1.
    if (column.unit == "index") return fmt::format("{:.4f}", scaled);
    return column.unit == "ms" ? milliseconds(scaled) : measured(scaled);
  }
  const auto* text = std::get_if<std::string>(&cell.value);
  return text ? *text : "-";
}

std::vector<Column> select(const std::vector<Column>& columns, std::span<const std::string> names) {
  std::vector<std::string> known;
  for (const Column& column : columns) known.push_back(column.name);
  std::vector<Column> selected;
  for (const std::string& name : names) {
    const auto found = std::find(known.begin(), known.end(), name);
    if (found == known.end())
      throw Error("there is no column {}; did you mean {}? There are: {}", name, nearest_word(name, known),
                  joined(known, ", "));
    selected.push_back(columns[static_cast<std::size_t>(found - known.begin())]);
  }
  return selected;
}

}  // namespace gnomon
