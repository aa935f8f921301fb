#include "report/table/table.h"

#include "analysis/in_order.h"
#include "report/table/layout.h"

namespace gnomon {

Format format_named(std::string_view name) {
  static const std::vector<std::string> names = {"terminal", "md", "csv", "tex", "json"};  // in the order of Format
  require_word("there is no format", name, names);
  return static_cast<Format>(std::ranges::find(names, name) - names.begin());
}

std::vector<std::string> column_names(std::span<const Record> records) { return names_in(all_columns(records)); }

namespace {

/// Headline columns that a narrow terminal can do without, the least missed first.
constexpr std::string_view dispensable[] = {"displacement_p95",
                                            "displacement_mean",
                                            "wrong_rate_all",
                                            "snapping_floor",
                                            "peak_bytes",
                                            "setup_ms",
                                            "floor_share",
                                            "rays_per_second",
                                            "penumbra_noise",
                                            "other_error_mean",
                                            "penumbra_shift",
                                            "causes",
                                            "build_ms",
                                            "bytes",
                                            "contact_hardening",
                                            "received_error_rms",
                                            "ghost_frames",
                                            "ghost_half_life",
                                            "penumbra_width_ratio",
                                            "uncertain_share",
                                            "silhouette_share",
                                            "grazing_share",
                                            "false_lit_rate",
                                            "false_dark_rate",
                                            "error_settled",
                                            "update_ms"};

/// The rows of one kind of answer, and the lines below their table that say where they were made.
struct Part {
  std::vector<Record> records;
  Remarks provenance = {};
};

/// Rows of each kind of answer have other columns: people read them in tables of their own. The last one says where all were
/// made.
std::vector<Part> parts_of(std::span<const Record> records) {
  std::vector<Part> parts;
  for (const AnswerKind of : all_answer_kinds) {
    Part part;
    std::ranges::copy_if(records, std::back_inserter(part.records), [&](const Record& r) { return r.answer == of; });
    if (!part.records.empty()) parts.push_back(std::move(part));
  }
  if (parts.empty()) parts.emplace_back();
  parts.back().provenance = provenance(records);
  return parts;
}

/// The headline table, without some columns where the terminal is too narrow for all; says which.
std::string fitted_table(const Part& part, std::size_t width) {
  std::vector<std::string> names = headline_columns(part.records, false), left_out;
  const auto table = [&] {
    Layout layout = lay_out(part.records, names);
    layout.provenance = part.provenance;
    return terminal_table(layout, width);
  };
  std::string text = table();
  for (const std::string_view name : dispensable) {
    if (width == 0 || terminal_width_of(text) <= width) break;
    if (std::erase(names, name) == 0) continue;
    left_out.emplace_back(name);
    text = table();
  }
  if (!left_out.empty()) text += fmt::format("left out for want of room: {}\n", joined(left_out, ", "));
  return text;
}

/// In Markdown and LaTeX, and on a terminal when columns are named.
std::string chosen_table(const Part& part, const std::vector<std::string>& names, Format format, const TableOptions& options) {
  Layout layout = lay_out(part.records, names);
  layout.provenance = part.provenance;
  if (format == Format::markdown) {
    // Scene and light are columns: one table.
    Layout::Group all;
    for (Layout::Group& group : layout.groups) std::ranges::move(group.rows, std::back_inserter(all.rows));
    layout.groups = {std::move(all)};
  }
  if (format == Format::latex && index_of(names, std::string("scene")) < names.size())
    for (Layout::Group& group : layout.groups) group.heading.clear();
  return render_layout(std::move(layout), format, options);
}

}  // namespace

std::string render_layout(Layout layout, Format format, const TableOptions& options) {
  const Audience hidden = format == Format::csv || format == Format::json ? Audience::people : Audience::programs;
  for (std::ptrdiff_t i = std::ssize(layout.columns) - 1; i >= 0; --i) {
    if ((layout.columns.begin() + i)->audience != hidden) continue;
    layout.columns.erase(layout.columns.begin() + i);
    for (Layout::Group& group : layout.groups)
      for (Layout::Row& row : group.rows) row.cells.erase(row.cells.begin() + i);
  }
  if (format == Format::terminal) return terminal_table(layout, options.width);
  if (format == Format::markdown) return markdown_table(layout);
  if (format == Format::latex) return latex_table(layout, options);
  return format == Format::csv ? csv_table(layout) : json_table(layout);
}

std::string render_table(std::span<const Record> records, Format format, const TableOptions& options) {
  if (format == Format::csv || format == Format::json) {
    Layout table{.columns = all_columns(records), .provenance = provenance(records)};
    if (!options.columns.empty()) table.columns = select(table.columns, options.columns);
    Layout::Group& group = table.groups.emplace_back();
    for (const Record& record : records) group.rows.push_back(row_of(record, table.columns));
    return render_layout(std::move(table), format, options);
  }
  TableOptions here = options;
  const std::string caption = "Cost and error of shadow techniques, by scene, light and view";
  if (format == Format::latex && here.caption.empty()) here.caption = caption + ".";
  if (!options.columns.empty())
    return chosen_table({{records.begin(), records.end()}, provenance(records)}, options.columns, format, here);
  std::string text;
  const std::vector<Part> parts = parts_of(records);
  for (const Part& part : parts) {
    const bool is_last = &part == &parts.back();
    if (parts.size() > 1 && options.caption.empty())
      here.caption = fmt::format("{}: {}.", caption, lights_text(part.records.front().answer));
    if (const auto number = &part - parts.data() + 1; number > 1) here.label = fmt::format("{}:{}", options.label, number);
    text += format == Format::terminal ? fitted_table(part, options.width)
            : format == Format::latex  ? chosen_table(part, paper_columns(part.records), format, here)
                                       : chosen_table(part, headline_columns(part.records, true), format, here);
    if (!is_last) text += '\n';
  }
  return text;
}

}  // namespace gnomon
