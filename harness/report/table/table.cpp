#include "report/table/table.h"

#include "analysis/in_order.h"
#include "report/table/layout.h"

namespace gnomon {

Format format_named(std::string_view name) {
  static const std::vector<std::string> names = {"terminal", "md", "csv", "tex", "json"};  // in the order of Format
  require_word("there is no format", name, names);
  return static_cast<Format>(std::ranges::find(names, name) - names.begin());
}

Paper paper_named(std::string_view name) {
  static const std::vector<std::string> names = {"landscape", "page", "column"};  // in the order of Paper
  require_word("a table does not fit", name, names);
  return static_cast<Paper>(std::ranges::find(names, name) - names.begin());
}

std::vector<std::string> column_names(std::span<const Record> records) { return names_in(all_columns(records)); }

namespace {

/// Headline columns that a table can do without where it has little room, the least missed first.
constexpr std::string_view dispensable[] = {"displacement_p95",
                                            "displacement_mean",
                                            "coverage_error_mean_floor",
                                            "coverage_error_rms",
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
                                            "update_ms",
                                            "relight_device_ms",
                                            "flip",
                                            "ssim",
                                            "transmittance_error_p95",
                                            "transmittance_error_rms",
                                            "hue_error",
                                            "light_error_max",
                                            "tested_share",
                                            "error_floor",
                                            "resolve_device_ms",
                                            "wrong_rate",
                                            "support",
                                            "motion_ms",
                                            "relight_ms"};

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

Layout lay_out_part(const Part& part, std::span<const std::string> names) {
  Layout layout = lay_out(part.records, names);
  layout.provenance = part.provenance;
  return layout;
}

/// The headline columns of `names` for which there is room, and the names of the others.
struct Fitted {
  Layout layout;
  std::vector<std::string> left_out;
};

/// `left_out_of` gives the names of the spare columns for which a table has no room.
Fitted fitted_part(const Part& part, std::vector<std::string> names,
                   const std::function<std::vector<std::string>(const Layout&)>& left_out_of) {
  Layout layout = lay_out_part(part, names);
  for (std::size_t k = 0; k < std::size(dispensable); ++k)
    for (Column& column : layout.columns)
      if (column.name == dispensable[k]) column.spare = static_cast<int>(std::size(dispensable) - k);
  const std::vector<std::string> left_out = left_out_of(layout);
  if (left_out.empty()) return {std::move(layout), {}};
  std::erase_if(names, [&](const std::string& name) { return std::ranges::find(left_out, name) != left_out.end(); });
  return {lay_out_part(part, names), left_out};  // anew: the lines below explain only what is there
}

std::string terminal_part(const Part& part, std::size_t width) {
  const Fitted table = fitted_part(part, headline_columns(part.records, false),
                                   [&](const Layout& layout) { return left_out_on_terminal(layout, width); });
  std::string text = terminal_table(table.layout, width);
  if (!table.left_out.empty())
    text += wrapped_line(
        fmt::format("left out for want of room: {}; gnomon table --columns chooses, --wide shows all", joined(table.left_out)),
        width);
  return text;
}

std::string paper_part(const Part& part, const TableOptions& options) {
  Fitted table = fitted_part(part, paper_columns(part.records),
                             [&](const Layout& layout) { return left_out_on_paper(layout, options.paper); });
  const std::string remark =
      table.left_out.empty() ? "" : fmt::format("% Left out for want of room: {}.\n", joined(table.left_out));
  return remark + render_layout(std::move(table.layout), Format::latex, options);
}

/// In Markdown, and in every form for people when columns are named.
std::string chosen_table(const Part& part, const std::vector<std::string>& names, Format format, const TableOptions& options) {
  Layout layout = lay_out_part(part, names);
  if (format == Format::markdown) {
    // Scene and light are columns: one table.
    Layout::Group all;
    for (Layout::Group& group : layout.groups) std::ranges::move(group.rows, std::back_inserter(all.rows));
    layout.groups = {std::move(all)};
  }
  if (format == Format::latex && std::ranges::find(layout.columns, "scene", &Column::name) != layout.columns.end())
    for (Layout::Group& group : layout.groups) group.heading.clear();
  return render_layout(std::move(layout), format, options);
}

}  // namespace

void remove_columns(Layout& layout, const std::function<bool(const Column&)>& is_removed) {
  for (std::ptrdiff_t i = std::ssize(layout.columns) - 1; i >= 0; --i) {
    if (!is_removed(*(layout.columns.begin() + i))) continue;
    layout.columns.erase(layout.columns.begin() + i);
    for (Layout::Group& group : layout.groups)
      for (Layout::Row& row : group.rows) row.cells.erase(row.cells.begin() + i);
  }
}

std::string render_layout(Layout layout, Format format, const TableOptions& options) {
  const Audience hidden = format == Format::csv || format == Format::json ? Audience::people : Audience::programs;
  remove_columns(layout, [&](const Column& column) { return column.audience == hidden; });
  if (format == Format::terminal) return terminal_table(layout, options.width);
  if (format == Format::markdown) return markdown_table(layout);
  if (format == Format::csv) return csv_table(layout);
  if (format == Format::json) return json_table(layout);
  const std::vector<std::string> left_out = left_out_on_paper(layout, options.paper);
  remove_columns(layout, [&](const Column& column) { return std::ranges::find(left_out, column.name) != left_out.end(); });
  return latex_table(layout, options);
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
    text += format == Format::terminal ? terminal_part(part, options.width)
            : format == Format::latex  ? paper_part(part, here)
                                       : chosen_table(part, headline_columns(part.records, true), format, here);
    if (!is_last) text += '\n';
  }
  return text;
}

}  // namespace gnomon
