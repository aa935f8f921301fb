#include <algorithm>

#include "app/app.h"
#include "app/run_tables.h"
#include "measure/record/merge.h"
#include "report/table/table.h"

namespace gnomon::app {

namespace {

namespace fs = std::filesystem;

struct Options {
  std::vector<fs::path> dirs;
  fs::path out;
  bool prefer_last = false;
};

/// Every conflict with what differs, the first few of many.
void print_conflicts(const Merge& merge) {
  constexpr std::size_t most = 6;
  for (const MergeConflict& conflict : merge.conflicts) {
    fmt::print(stderr, "conflict: job {} {}\n  {}\n  {}\n", conflict.job, conflict.title, conflict.first.string(),
               conflict.second.string());
    for (std::size_t k = 0; k < std::min(most, conflict.differences.size()); ++k)
      fmt::print(stderr, "    {}\n", conflict.differences[k]);
    if (conflict.differences.size() > most) fmt::print(stderr, "    and {} more\n", conflict.differences.size() - most);
  }
}

int merge(const Options& options) {
  require_free(options.out);
  std::vector<std::pair<fs::path, std::vector<Record>>> runs;
  for (const fs::path& dir : options.dirs) runs.emplace_back(dir, read_records(dir));
  const Merge merged = merge_records(runs, options.prefer_last);
  print_conflicts(merged);
  if (!merged.conflicts.empty() && !options.prefer_last) {
    fmt::print(stderr, "gnomon: {} of {} jobs have two answers; nothing is written. --prefer-last takes the last one of each\n",
               merged.conflicts.size(), merged.rows.size());
    return 1;
  }
  for (const std::string& note : merged.notes) fmt::print(stderr, "note: {}\n", note);
  if (merged.duplicate_count)
    fmt::print(stderr, "note: {} rows stand in more than one folder with the same answer; each counts once, by its {} one\n",
               merged.duplicate_count, options.prefer_last ? "last" : "first");
  std::vector<Record> records;
  for (const MergedRow& row : merged.rows) records.push_back(row.record);
  const std::size_t missing = write_merge(merged, options.out, [&](const fs::path& folder) { write_tables(folder, records); });
  if (missing) fmt::print(stderr, "note: {} pictures that the records name are in none of the folders\n", missing);
  if (records.empty()) {
    fmt::print("the folders hold no rows\n");
    return 0;
  }
  fmt::print("{}\n{} from {} folders\n\n", render_table(records, Format::terminal, {.width = terminal_width()}),
             count_text(records), options.dirs.size());
  print_contents(options.out);
  return std::ranges::any_of(records, [](const Record& r) { return r.status == Status::failed; }) ? 1 : 0;
}

}  // namespace

void add_merge(Program& program) {
  auto [command, options] =
      program.line.command<Options>("merge", "Runs of shards as one run: records, pictures, tables", merge);
  command.option("dirs", &options.dirs, "Folders of runs").required();
  command.option("--out", &options.out, "Folder to write to; it may not hold records").required();
  command.flag("--prefer-last", &options.prefer_last, "Where folders disagree on a row, take the last one's");
}

}  // namespace gnomon::app
