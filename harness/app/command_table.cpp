// gnomon table and report: a run as a table and as a page.
#include "analysis/analysis.h"
#include "app/app.h"
#include "app/table_options.h"
#include "measure/notice.h"
#include "measure/part_file.h"
#include "measure/row/rescore.h"
#include "measure/scene/blob.h"
#include "measure/score/over_time.h"
#include "report/analysis/machine_table.h"
#include "report/html/html.h"

namespace gnomon::app {

namespace {

/// The records of this folder that match --filter. Throws Error where none does.
std::vector<Record> filtered(std::vector<Record> records, const std::string& dir, const std::string& filter) {
  records = matching(std::move(records), filter);
  if (records.empty() && !filter.empty()) throw Error("{} holds no record that matches {}", dir, filter);
  return records;
}

constexpr const char* filter_sentence =
    "Only rows whose 'SCENE LIGHT [VIEW] [PATH] TECHNIQUE:SETTINGS' matches this expression";

struct TableCommand {
  std::vector<std::string> dirs;
  std::string format = "terminal", paper = "landscape", by, filter;
  std::filesystem::path pixels;
  bool is_rescored = false, is_saved = false;
  TableOptions table;
  TableWidth width;

  std::vector<Record> records() const {
    if (dirs.size() > 1)
      throw Error(
          "a table is of one run, and '{}' are given; several stand side by side with --by machine; gnomon table --help says "
          "how",
          joined(dirs, "', '"));
    const std::string& dir = dirs.front();
    if (is_saved && !is_rescored) throw Error("--save keeps what --rescore finds; give both");
    if (!is_rescored) return filtered(read_records(dir), dir, filter);
    // The writer locks the folder, so that no other program writes between reading and replacing.
    std::optional<RecordWriter> writer;
    if (is_saved) {
      if (!std::filesystem::exists(records_file(dir))) read_records(dir);  // throws the Error that says so
      writer.emplace(dir);
    }
    std::vector<Record> records = read_records(dir);
    RescoreSummary result;
    {
      Progress progress;
      result = rescore(records, dir, progress);
    }
    for (const std::string& note : result.notes) print_notice("{}\n", note);
    if (writer) writer->replace(records);
    print_notice("{} row{} rescored{}\n", result.rows, result.rows == 1 ? "" : "s",
                 writer ? fmt::format(", {} rewritten", records_file(dir).string()) : "");
    return filtered(std::move(records), dir, filter);
  }
};

void print_machines(const TableCommand& options, Format format) {
  if (format == Format::latex) throw Error("--format tex is none of --by machine: terminal, md, csv, json");
  if (options.is_rescored || !options.table.columns.empty() || !options.table.caption.empty())
    throw Error("--by machine goes with --format, --filter, --pixels, --width and --wide alone");
  std::vector<MachineRun> runs;
  for (const std::string& dir : options.dirs) runs.push_back({dir, filtered(read_records(dir), dir, options.filter)});
  fmt::print("{}", render_machines(runs, format, {.width = options.width.columns(), .pixels = options.pixels}));
}

/// A mask that never changes has no flicker, however wrong it is: no flicker is shown without the error.
void add_error_of_flicker(std::vector<std::string>& columns) {
  const auto has = [&](std::string_view metric) {
    return std::ranges::any_of(columns, [&](const std::string& column) {
      return column == metric || column.ends_with(fmt::format(".{}", metric));  // of one truth
    });
  };
  if (std::ranges::any_of(flicker_metrics, has, &FlickerMetric::name) && !has("error")) {
    columns.emplace_back("error");
    print_notice("note: flicker says nothing of quality without error, which is the last column\n");
  }
}

void print_table(TableCommand& options) {
  const Format format = format_named(options.format);
  if (!options.by.empty()) return print_machines(options, format);
  const bool is_list = options.table.columns == std::vector<std::string>{"list"};
  add_error_of_flicker(options.table.columns);
  if (format == Format::csv && !is_list && !options.is_rescored && !options.is_saved && options.filter.empty() &&
      options.dirs.size() == 1)
    return write_csv(options.dirs.front(), options.table, [](const std::string& text) { fmt::print("{}", text); });
  const std::vector<Record> records = options.records();
  if (is_list) {
    for (const std::string& name : column_names(records)) fmt::print("{}\n", name);
    return;
  }
  options.table.width = options.width.columns();
  options.table.paper = paper_named(options.paper);
  fmt::print("{}", render_table(records, format, options.table));
}

struct PageOptions {
  std::string dir, out, filter;
  bool without_pictures = false, with_all_frames = false;
};

void make_page(const PageOptions& options) {
  const std::filesystem::path out =
      options.out.empty() ? std::filesystem::path(options.dir) / "report.html" : std::filesystem::path(options.out);
  if (std::filesystem::is_directory(out)) throw Error("--out {} is a folder; the name of a file is required", out.string());
  const std::vector<Record> records = filtered(read_records(options.dir), options.dir, options.filter);
  const Report report = make_report(options.dir, records, !options.without_pictures, options.with_all_frames);
  write_file(replaced_file(out), report.html);
  for (const std::string& note : report.notes) print_notice("{}\n", note);
  fmt::print("{}\n", out.string());
}

}  // namespace

void add_table(Program& program) {
  auto [command, options] =
      program.line.command<TableCommand>("table", "The comparison table of a run, in any format, on stdout", print_table);
  command.option("dir", &options.dirs, "Folder of the run; with --by machine of several", {.is_required = true});
  const auto by = command.option("--by", &options.by, "Several runs side by side: times, errors, differing pixels of masks",
                                 {.check = one_of({"machine"})});
  command.option("--pixels", &options.pixels, "With --by: lists of the differing pixels, JSON lines",
                 {.check = not_empty(), .type_name = "FILE", .needs = by});
  command.option("--format", &options.format, "terminal, md, csv, tex or json");
  command.option("--columns", &options.table.columns,
                 "Names of columns in their order, or their headings; 'list' prints the names", {.delimiter = ','});
  command.option("--filter", &options.filter, filter_sentence);
  add_paper_options(command, options.table, options.paper);
  add_width_options(command, options.width);
  command.flag("--rescore", &options.is_rescored, "Compute today's metrics from the masks of the run; nothing runs again");
  command.flag("--save", &options.is_saved, "With --rescore: keep the new metrics in the run's records");
}

void add_report(Program& program) {
  auto [command, options] =
      program.line.command<PageOptions>("report", "One HTML page of a run: table, plots and pictures to compare", make_page);
  command.option("dir", &options.dir, "Folder of the run", {.is_required = true});
  command.option("--out", &options.out, "The page; report.html in the run's folder unless given",
                 {.check = not_empty(), .type_name = "FILE"});
  command.option("--filter", &options.filter, filter_sentence);
  command.flag("--no-pictures", &options.without_pictures, "Leave out the pictures: a small page without the comparer");
  command.flag("--all-frames", &options.with_all_frames,
               "Play the frames of every row on a path, however large the page gets; else of those that fit into 8 MB");
}

}  // namespace gnomon::app
