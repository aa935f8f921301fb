#include "report/analysis/machine_table.h"

#include "measure/json.h"
#include "measure/part_file.h"
#include "measure/scene/blob.h"
#include "report/analysis/analysis_table_parts.h"

namespace gnomon {

namespace {

using analysis::Cells;

/// "A" for the first run.
std::string letter(std::size_t run) { return fmt::format("{}", static_cast<char>('A' + run)); }

/// What one run says of a row; a column that no row of the run fills is left out.
struct Quantity {
  enum class Kind { time, share, rays };
  const char *name, *heading;
  Kind kind;
  int spare;
  std::optional<double> (*of)(const Record&);
  Column column(const std::string& full_name, const std::string& full_heading) const {
    if (kind == Kind::time) return number_column(full_name, "ms", full_heading);
    return kind == Kind::share ? share_column(full_name, full_heading) : ray_column(full_name, full_heading);
  }
};
constexpr Quantity quantities[] = {
    {"frame_ms", "", Quantity::Kind::time, 0, frame_ms},
    {"frame_device_ms", " device", Quantity::Kind::time, 1, frame_device_ms},
    {"floor_share", " bare", Quantity::Kind::share, 3, floor_share},
    {"rays_per_second", " rays", Quantity::Kind::rays, 4, rays_per_second},
    {"error", " error", Quantity::Kind::share, 0, [](const Record& r) { return r.metric("error"); }},
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
      columns.push_back({spare(what.column(name, heading), what.spare), [run, of = what.of](const MachineRow& row) {
                           return row[run] && row[run]->status == Status::ok ? of(*row[run]) : std::nullopt;
                         }});
      if (run > 0 && &what == &quantities[0])
        columns.push_back({spare(number_column(fmt::format("{}.ratio", letter(run)), "", fmt::format("A/{}", letter(run))), 2),
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

/// What a frame costs on each machine, beside how far it errs.
class MachineTable {
 public:
  MachineTable(std::span<const MachineRun> runs, const MachineTableOptions& options);
  Layout layout() const;

 private:
  Cells cells(const MachineRow& row) const;
  std::vector<std::string> notes() const;

  std::span<const MachineRun> runs_;
  std::vector<MachineRow> rows_;
  std::size_t undone_ = 0;  // rows that no machine did
  Differing pixels_;
  std::vector<MachineColumn> columns_;
  std::vector<std::size_t> with_masks_;  // runs whose masks are compared with those of the first
};

MachineTable::MachineTable(std::span<const MachineRun> runs, const MachineTableOptions& options)
    : runs_(runs), rows_(rows_by_machine(runs)) {
  std::erase_if(rows_, [](const MachineRow& row) {
    return std::ranges::count_if(row, [](const Record* r) { return r != nullptr; }) < 2;
  });
  if (rows_.empty())
    throw Error("no row is in two of the folders: scene, light, view, size, truth, technique and settings differ");
  undone_ = std::erase_if(rows_, [](const MachineRow& row) {
    return std::ranges::none_of(row, [](const Record* r) { return r && r->status == Status::ok; });
  });
  pixels_ = differing(runs, rows_);
  if (!options.pixels.empty()) write_pixels(options.pixels, runs, rows_, pixels_);
  columns_ = columns_of(runs);
  for (std::size_t run = 1; run < runs.size(); ++run)
    if (std::ranges::any_of(pixels_, [run](const auto& row) { return row[run].has_value(); })) with_masks_.push_back(run);
}

const Record& first(const MachineRow& row) {
  return **std::ranges::find_if(row, [](const Record* r) { return r != nullptr; });
}

Cells MachineTable::cells(const MachineRow& row) const {
  Cells cells = analysis::place_cells(place_of(first(row)));
  cells.push_back(text_cell(setting_name(first(row))));
  for (const MachineColumn& column : columns_) {
    const std::optional<double> value = column.of(row);
    cells.push_back(value ? Cell{.value = *value} : Cell{});
  }
  const auto& pixels_of_row = pixels_[static_cast<std::size_t>(&row - rows_.data())];
  for (const std::size_t run : with_masks_)
    cells.push_back(pixels_of_row[run] ? Cell{.value = static_cast<double>(count(*pixels_of_row[run]))} : Cell{});
  return cells;
}

std::vector<std::string> MachineTable::notes() const {
  std::vector<std::string> notes{
      "ms: median of the medians of the processes by the host's clock; device: by the clock of the device",
      "A/B: how many times faster than A; bare: what part of the frame the technique's bare pass takes"};
  const auto has_rays = [](const MachineColumn& column) { return column.column.name.ends_with(".rays_per_second"); };
  if (std::ranges::any_of(columns_, has_rays))
    notes.emplace_back("rays: count rays over the time of a frame, by the device's clock where there is one");
  if (!with_masks_.empty())
    notes.emplace_back("differs: pixels whose visibility is another than A's, by more than half a step of eight bits");
  if (undone_ > 0) notes.push_back(fmt::format("left out: {} row{} that no machine did", undone_, undone_ == 1 ? "" : "s"));
  std::ranges::copy(undone_notes(rows_), std::back_inserter(notes));
  for (std::size_t run = 0; run < runs_.size(); ++run) notes.push_back(machine_note(run, runs_[run]));
  return notes;
}

Layout MachineTable::layout() const {
  Layout table;
  table.columns = analysis::place_columns();
  table.columns.push_back(text_column("setting", "technique"));
  for (const MachineColumn& column : columns_) table.columns.push_back(column.column);
  for (const std::size_t run : with_masks_)
    table.columns.push_back(
        whole_column(fmt::format("{}.differing", letter(run)), "px", fmt::format("{} differs", letter(run))));
  analysis::add_groups(
      table, rows_, [](const MachineRow& row) { return place_of(first(row)); },
      [&](const MachineRow& row) { return cells(row); });
  table.title = "What a frame (relight and resolve) costs and how far it errs, by machine";
  table.notes = notes();
  return table;
}

}  // namespace

std::string render_machines(std::span<const MachineRun> runs, Format format, const MachineTableOptions& options) {
  constexpr std::size_t most_runs = 26;
  if (runs.size() < 2 || runs.size() > most_runs)
    throw Error("--by machine takes 2 .. {} folders of runs; {} are given", most_runs, runs.size());
  TableOptions here;
  here.width = options.width;
  return render_layout(MachineTable(runs, options).layout(), format, here);
}

}  // namespace gnomon
