#include "report/analysis/machine_table.h"

#include <optional>

#include "measure/json.h"
#include "measure/part_file.h"
#include "measure/scene/blob.h"
#include "report/analysis/analysis_table_parts.h"

namespace gnomon {

namespace {

using analysis::Cells;

/// "A" for the first run.
std::string letter(std::size_t run) { return fmt::format("{}", static_cast<char>('A' + run)); }

Column percent_column(std::string name, std::string heading) {
  Column column = number_column(std::move(name), "", std::move(heading));
  column.shown_unit = "%";
  column.shown_scale = 100;
  return column;
}

/// What one run says of a row; a column that no row of the run fills is left out.
struct Quantity {
  const char *name, *heading;
  bool is_time;
  std::optional<double> (*of)(const Record&);
};
constexpr Quantity quantities[] = {
    {"frame_ms", "", true, frame_ms},
    {"frame_device_ms", " device", true, frame_device_ms},
    {"floor_share", " bare", false, floor_share},
    {"error", " error", false, [](const Record& r) { return r.metric("error"); }},
};

struct MachineColumn {
  Column column;
  std::function<std::optional<double>(const MachineRow&)> of;
};

std::vector<MachineColumn> columns_of(std::span<const MachineRun> runs) {
  std::vector<MachineColumn> columns;
  for (const Quantity& what : quantities)
    for (std::size_t run = 0; run < runs.size(); ++run) {
      const auto has = [&](const Record& r) { return r.status == Status::ok && what.of(r); };
      if (std::ranges::none_of(runs[run].records, has)) continue;
      const std::string name = fmt::format("{}.{}", letter(run), what.name), heading = letter(run) + what.heading;
      columns.push_back({what.is_time ? number_column(name, "ms", heading) : percent_column(name, heading),
                         [run, of = what.of](const MachineRow& row) {
                           return row[run] && row[run]->status == Status::ok ? of(*row[run]) : std::nullopt;
                         }});
      if (run > 0 && what.is_time && &what == &quantities[0])
        columns.push_back({number_column(fmt::format("{}.ratio", letter(run)), "", fmt::format("A/{}", letter(run))),
                           [run](const MachineRow& row) -> std::optional<double> {
                             if (!row[0] || !row[run]) return std::nullopt;
                             const auto first = frame_ms(*row[0]), here = frame_ms(*row[run]);
                             return first && here && *here > 0 ? std::optional(*first / *here) : std::nullopt;
                           }});
    }
  return columns;
}

/// By row, by run: pixels whose masks differ from the first run's.
using Differing = std::vector<std::vector<std::optional<std::vector<DifferingPixels>>>>;

Differing differing(std::span<const MachineRun> runs, std::span<const MachineRow> rows) {
  Differing all;
  for (const MachineRow& row : rows) {
    auto& of_row = all.emplace_back(runs.size());
    for (std::size_t run = 1; run < runs.size(); ++run)
      if (row[0] && row[run]) of_row[run] = differing_pixels(*row[0], runs[0].dir, *row[run], runs[run].dir);
  }
  return all;
}

std::size_t count(const std::vector<DifferingPixels>& lights) {
  std::size_t sum = 0;
  for (const DifferingPixels& light : lights) sum += light.pixels.size();
  return sum;
}

void write_pixels(const std::filesystem::path& file, std::span<const MachineRun> runs, std::span<const MachineRow> rows,
                  const Differing& all) {
  std::string text;
  for (std::size_t k = 0; k < rows.size(); ++k)
    for (std::size_t run = 1; run < runs.size(); ++run) {
      if (!all[k][run]) continue;
      const Record& record = *rows[k][run];
      for (const DifferingPixels& light : *all[k][run]) {
        Json line = json_object({{"runs", {runs[0].dir.string(), runs[run].dir.string()}},
                                 {"scene", record.scene},
                                 {"light", light.light},
                                 {"view", record.view},
                                 {"technique", record.technique},
                                 {"settings", record.settings},
                                 {"width", record.width},
                                 {"height", record.height},
                                 {"count", light.pixels.size()}});
        line["pixels"] = Json::array();
        for (const DifferingPixel& pixel : std::span(light.pixels).first(std::min(light.pixels.size(), most_listed_pixels)))
          line["pixels"].push_back({pixel.x, pixel.y, pixel.first, pixel.second});
        text += json_text(line) + '\n';
      }
    }
  write_file(replaced_file(file), text);
}

/// "A: runs/a, llvmpipe (LLVM 15.0.6, 256 bits), AMD EPYC, 2 threads, 1.0.0 (4f3a142)".
std::string machine_note(std::size_t run, const MachineRun& of) {
  std::vector<std::string> facts(1, of.dir.string());
  for (const char* key : {"trial", "gl_renderer", "processor", "version", "commit"}) {
    const std::vector<std::string> values = context_values(of.records, key);
    if (values.empty()) continue;
    facts.push_back((std::string_view(key) == "trial" ? "a trial with " : "") + joined(values, "; "));
  }
  return fmt::format("{}: {}", letter(run), joined(facts, ", "));
}

/// Rows that one machine did and another did not, with why.
std::vector<std::string> undone_notes(std::span<const MachineRow> rows) {
  std::vector<std::string> notes;
  for (const MachineRow& row : rows)
    for (std::size_t run = 0; run < row.size(); ++run)
      if (row[run] && row[run]->status != Status::ok)
        notes.push_back(fmt::format("{}: {} {}: {}", letter(run), title(*row[run]), name(row[run]->status), row[run]->reason));
  return notes;
}

}  // namespace

std::string render_machines(std::span<const MachineRun> runs, Format format, const MachineTableOptions& options) {
  constexpr std::size_t most_runs = 26;
  if (runs.size() < 2 || runs.size() > most_runs)
    throw Error("--by machine takes 2 .. {} folders of runs; {} are given", most_runs, runs.size());
  std::vector<MachineRow> rows = rows_by_machine(runs);
  std::erase_if(
      rows, [](const MachineRow& row) { return std::ranges::count_if(row, [](const Record* r) { return r != nullptr; }) < 2; });
  if (rows.empty())
    throw Error("no row is in two of the folders: scene, light, view, size, truth, technique and settings differ");
  const std::size_t all_rows = rows.size();
  std::erase_if(rows, [](const MachineRow& row) {
    return std::ranges::none_of(row, [](const Record* r) { return r && r->status == Status::ok; });
  });
  const std::size_t undone = all_rows - rows.size();
  const Differing pixels = differing(runs, rows);
  if (!options.pixels.empty()) write_pixels(options.pixels, runs, rows, pixels);

  std::vector<MachineColumn> columns = columns_of(runs);
  std::vector<std::size_t> with_masks;
  for (std::size_t run = 1; run < runs.size(); ++run)
    if (std::ranges::any_of(pixels, [run](const auto& row) { return row[run].has_value(); })) with_masks.push_back(run);

  const auto lay_out = [&] {
    Layout table;
    table.columns = analysis::place_columns();
    table.columns.push_back(text_column("setting", "technique"));
    for (const MachineColumn& column : columns) table.columns.push_back(column.column);
    for (const std::size_t run : with_masks)
      table.columns.push_back(
          whole_column(fmt::format("{}.differing", letter(run)), "px", fmt::format("{} differs", letter(run))));
    const auto first = [](const MachineRow& row) -> const Record& {
      return **std::ranges::find_if(row, [](const Record* r) { return r != nullptr; });
    };
    std::vector<std::size_t> indices(rows.size());
    for (std::size_t k = 0; k < rows.size(); ++k) indices[k] = k;
    const auto place = [&](std::size_t k) { return place_of(first(rows[k])); };
    analysis::add_groups(table, indices, place, [&](std::size_t k) {
      Cells cells = analysis::place_cells(place(k));
      cells.push_back(text_cell(setting_name(first(rows[k]))));
      for (const MachineColumn& column : columns) {
        const std::optional<double> value = column.of(rows[k]);
        cells.push_back(value ? Cell{.value = *value} : Cell{});
      }
      for (const std::size_t run : with_masks)
        cells.push_back(pixels[k][run] ? Cell{.value = static_cast<double>(count(*pixels[k][run]))} : Cell{});
      return cells;
    });
    table.title = "What a frame (relight and resolve) costs and how far it errs, by machine";
    table.notes.push_back(
        "ms: median of the medians of the processes by the host's clock; device: by the clock of the "
        "OpenGL device");
    table.notes.push_back("A/B: how many times faster than A; bare: what part of the frame the technique's bare pass takes");
    if (!with_masks.empty())
      table.notes.push_back("differs: pixels whose visibility is another than A's, by more than half a step of eight bits");
    if (undone > 0)
      table.notes.push_back(fmt::format("left out: {} row{} that no machine did", undone, undone == 1 ? "" : "s"));
    for (std::string& note : undone_notes(rows)) table.notes.push_back(std::move(note));
    for (std::size_t run = 0; run < runs.size(); ++run) table.notes.push_back(machine_note(run, runs[run]));
    return table;
  };
  TableOptions here;
  here.width = options.width;
  std::string text = render_layout(lay_out(), format, here);
  if (format != Format::terminal || options.width == 0) return text;
  // A terminal that is too narrow for all does without some.
  std::vector<std::string> left_out;
  for (const std::string_view kind : {"floor_share", "ratio", "frame_device_ms"}) {
    if (terminal_width_of(text) <= options.width) break;
    const auto is_of_kind = [&](const MachineColumn& column) { return column.column.name.substr(2) == kind; };
    if (std::erase_if(columns, is_of_kind) == 0) continue;
    left_out.emplace_back(kind);
    text = render_layout(lay_out(), format, here);
  }
  if (!left_out.empty()) text += fmt::format("left out for want of room: {}\n", joined(left_out, ", "));
  return text;
}

}  // namespace gnomon
