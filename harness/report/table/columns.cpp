#include "report/table/columns.h"

#include "analysis/in_order.h"
#include "measure/frame/classify.h"
#include "measure/json.h"
#include "measure/score/metrics.h"
#include "measure/score/record_causes.h"
#include "report/table/digits.h"

namespace gnomon {

namespace {

constexpr double mebibyte = 1024 * 1024;

Column bytes_column(std::string name, std::string heading, CellOf cell) {
  Column column = number_column(std::move(name), "byte", std::move(heading), cell);
  column.shown_unit = "MiB";
  column.shown_scale = 1 / mebibyte;
  return column;
}

/// Label, else id with settings: what distinguishes two rows of a group.
Cell technique_cell(const Record& r) { return {.value = r.technique, .shown = setting_name(r)}; }

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
  columns.push_back(text_column("job", "job", [](const Record& r) { return text_cell(r.job); }));
  columns.push_back(text_column("suite", "suite", [](const Record& r) { return text_cell(r.suite); }));
  columns.push_back(text_column("scene", "scene", [](const Record& r) { return text_cell(r.scene); }));
  columns.push_back(text_column("light", "light", [](const Record& r) { return text_cell(r.light); }));
  columns.push_back(text_column("light_kind", "light kind", [](const Record& r) { return text_cell(r.light_kind); }));
  columns.push_back(whole_column("light_count", "", "lights", [](const Record& r) { return count_cell(light_count(r)); }));
  columns.push_back(text_column("view", "view", [](const Record& r) { return text_cell(r.view); }));
  columns.push_back(text_column("path", "path", [](const Record& r) { return text_cell(r.path); }));
  columns.push_back(number_column("start", "s", "start", [](const Record& r) { return number(r.start); }));
  columns.push_back(number_column("frame_rate", "Hz", "frame rate", [](const Record& r) { return number(r.frame_rate); }));
  columns.push_back(whole_column("frames", "", "frames", [](const Record& r) {
    std::size_t most = 0;
    for (const auto& [metric, values] : r.frames) most = std::max(most, values.size());
    return count_cell(most);
  }));
  columns.push_back(text_column("technique", "technique", technique_cell));
  columns.push_back(text_column("settings", "settings", [](const Record& r) { return text_cell(r.settings); }));
  columns.push_back(text_column("label", "label", [](const Record& r) { return text_cell(r.label.value_or("")); }));
  columns.push_back(text_column("role", "role", [](const Record& r) { return text_cell(name(r.role)); }));
  columns.push_back(whole_column("width", "px", "width", [](const Record& r) { return Cell{.value = double(r.width)}; }));
  columns.push_back(whole_column("height", "px", "height", [](const Record& r) { return Cell{.value = double(r.height)}; }));
  columns.push_back(text_column("truth", "truth", [](const Record& r) { return text_cell(name(r.truth)); }));
  columns.push_back(text_column("status", "status", [](const Record& r) { return text_cell(name(r.status)); }));
  columns.push_back(text_column("support", "support", support_cell));
  columns.push_back(text_column("reason", "reason", [](const Record& r) { return text_cell(r.reason); }));
}

void add_memory(std::vector<Column>& columns) {
  columns.push_back(bytes_column("bytes", "memory", [](const Record& r) { return number(r.bytes); }));
  columns.back().better = "lower";
  columns.push_back(bytes_column("peak_bytes", "peak", [](const Record& r) { return number(r.peak_bytes); }));
  columns.push_back(bytes_column("gl_input_bytes", "GL inputs", [](const Record& r) {
    return r.gl ? Cell{.value = static_cast<double>(r.gl->input_bytes)} : Cell{};
  }));
  columns.push_back(number_column("gl_upload_ms", "ms", "GL upload",
                                  [](const Record& r) { return r.gl ? Cell{.value = r.gl->upload_ms} : Cell{}; }));
}

void add_causes(std::vector<Column>& columns, std::span<const Record> records) {
  columns.push_back(text_column("causes", "causes", [](const Record& r) { return text_cell(top_causes(r)); }));
  columns.back().sentence =
      "What made most of the wrong pixels wrong, under a light with area most of the error, with shares of them.";
  for (const CauseInfo& info : causes_of(records)) {
    Column column = share_column(fmt::format("cause.{}", info.name), with_blanks(info.name));
    column.better = "lower";
    column.sentence = info.sentence;
    column.cell = [share = column.name](const Record& r) { return number(quantity(r, share)); };
    columns.push_back(std::move(column));
  }
}

void add_facts(std::vector<Column>& columns) {
  for (const ClassInfo& info : class_infos()) {
    if (info.letter != "S" && info.letter != "G" && info.letter != "U") continue;
    Column& column = columns.emplace_back(share_column(fmt::format("{}_share", info.word), std::string(info.letter)));
    column.sentence = fmt::format("Share of the pixels facing the light that is of class {}. {}", info.letter, info.sentence);
    column.cell = [letter = std::string(info.letter)](const Record& r) { return number(class_share(r, letter)); };
  }
  for (const ClassInfo& info : class_infos()) {
    columns.push_back(whole_column(fmt::format("class.{}", info.letter), "px", fmt::format("class {}", info.letter)));
    columns.back().cell = [letter = std::string(info.letter)](const Record& r) {
      const auto found = r.classes.find(letter);
      return found == r.classes.end() ? Cell{} : Cell{.value = static_cast<double>(found->second)};
    };
  }
  columns.push_back(whole_column("triangles", "", "triangles", [](const Record& r) {
    return r.scene_facts ? Cell{.value = static_cast<double>(r.scene_facts->triangles)} : Cell{};
  }));
  columns.push_back(text_column("closed", "closed", [](const Record& r) {
    return r.scene_facts ? text_cell(r.scene_facts->closed ? "true" : "false") : Cell{};
  }));
  columns.push_back(number_column("seconds", "s", "took", [](const Record& r) { return number(r.seconds); }));
  columns.push_back(text_column("mask", "mask", [](const Record& r) { return text_cell(r.mask.value_or("")); }));
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
    const std::string name = "parameter." + parameter;
    columns.push_back(is_number ? whole_column(name, "", parameter) : text_column(name, parameter));
    columns.back().cell = [parameter = parameter](const Record& r) { return parameter_cell(r, parameter); };
  }
}

void add_counts(std::vector<Column>& columns, std::span<const Record> records) {
  std::map<std::string, std::string> units;  // by count, in alphabetical order
  for (const Record& record : records)
    for (const Count& count : record.counts) units.try_emplace(count.name, count.unit);
  for (const auto& [count, unit] : units) {
    columns.push_back(whole_column("count." + count, unit, count));
    columns.back().cell = [count = count](const Record& r) {
      const auto found = std::ranges::find(r.counts, count, &Count::name);
      return found == r.counts.end() ? Cell{} : number(std::optional(found->value));
    };
  }
}

}  // namespace

Column text_column(std::string name, std::string heading, CellOf cell) {
  Column column = number_column(std::move(name), "", std::move(heading), cell);
  column.alignment = Align::left;
  return column;
}

Column number_column(std::string name, const std::string& unit, std::string heading, CellOf cell) {
  return {.name = std::move(name), .unit = unit, .heading = std::move(heading), .shown_unit = unit, .cell = cell};
}

Column share_column(std::string name, std::string heading, CellOf cell) {
  Column column = number_column(std::move(name), "", std::move(heading), cell);
  column.shown_unit = "%";
  column.shown_scale = 100;
  return column;
}

Column ray_column(std::string name, std::string heading, CellOf cell) {
  Column column = number_column(std::move(name), "ray/s", std::move(heading), cell);
  column.shown_unit = "Mray/s";
  column.shown_scale = 1e-6;
  return column;
}

Column whole_column(std::string name, const std::string& unit, std::string heading, CellOf cell) {
  Column column = number_column(std::move(name), unit, std::move(heading), cell);
  column.is_exact = true;
  return column;
}

Column for_people(Column column) {
  column.audience = Audience::people;
  return column;
}

Column for_programs(Column column) {
  column.audience = Audience::programs;
  return column;
}

Column spare(Column column, int rank) {
  column.spare = rank;
  return column;
}

Cell text_cell(std::string_view text) { return text.empty() ? Cell{} : Cell{.value = std::string(text)}; }

Cell count_cell(std::size_t count) { return count > 0 ? Cell{.value = static_cast<double>(count)} : Cell{}; }

std::vector<Column> all_columns(std::span<const Record> records) {
  std::vector<Column> columns;
  add_identity(columns);
  add_times(columns);
  add_memory(columns);
  add_metrics(columns);
  add_worst_light(columns);
  add_causes(columns, records);
  add_facts(columns);
  add_parameters(columns, records);
  add_counts(columns, records);
  return columns;
}

std::string with_blanks(std::string_view name) {
  std::string words(name);
  std::replace(words.begin(), words.end(), '_', ' ');
  return words;
}

std::string top_causes(const Record& record, std::size_t most) {
  const auto shares = cause_shares(record);
  if (!shares) return "";
  double all = 0;
  std::vector<std::pair<double, std::string>> counted;
  for (const auto& [cause, share] : *shares) {
    all += share;
    if (share > 0) counted.emplace_back(share, with_blanks(cause));
  }
  std::stable_sort(counted.begin(), counted.end(), [](const auto& a, const auto& b) { return a.first > b.first; });
  std::vector<std::string> parts;
  for (const auto& [share, cause] : counted) {
    const double percent = 100 * share / all;
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

}  // namespace gnomon
