// gnomon run and merge: the folder of a run, measured, or put together of several.
#include <charconv>
#include <set>

#include "app/app.h"
#include "app/edition_options.h"
#include "app/suite_options.h"
#include "app/table_options.h"
#include "measure/counted.h"
#include "measure/notice.h"
#include "measure/paths.h"
#include "measure/record/merge.h"
#include "measure/run/estimate.h"
#include "measure/run/run.h"
#include "measure/run/run_file.h"
#include "measure/scene/blob.h"
#include "measure/worker/machine_context.h"
#include "report/table/table.h"
#include "report/table/text_table.h"

namespace gnomon::app {

namespace {

namespace fs = std::filesystem;

struct RunCommand : SuiteOptions {
  RunOptions run;
  EditionOptions edition;
  std::string shard;
  bool dry_run = false, quiet = false;
  TableWidth width;
};

struct MergeOptions {
  std::vector<fs::path> dirs;
  fs::path out;
  bool prefer_last = false;
  TableWidth width;
};

/// What a folder of a run holds, for the terminal.
void print_contents(const fs::path& folder, std::size_t width) {
  const auto line = [&](std::string_view name, std::string_view what) {
    fmt::print("{}", wrapped_line(fmt::format("{}/{:<15}{}", folder.string(), name, what), width));
  };
  line("records.jsonl", "every raw repetition and metric");
  line("run.json", "command, suite, scenes and build that made them");
  static constexpr std::pair<const char*, const char*> rooms[] = {
      {"masks/", "visibility masks, EXR"},
      {"errors/", "error pictures, PNG"},
      {"shaded/", "shaded pictures, PNG"},
      {"frames/", "masks and references of the frames of rows on a path, PNG"}};
  for (const auto& [room, what] : rooms)
    if (fs::exists(folder / room)) line(room, what);
  line("table.*", "this table as md, csv, tex, json");
}

std::size_t count(std::span<const Record> records, Status status) {
  return static_cast<std::size_t>(std::ranges::count(records, status, &Record::status));
}

/// The rows that would be run, without those that are done, and how long they would take, estimated from earlier ones.
void print_rows(const RunOptions& options, SceneLibrary& library) {
  const std::vector<Job> suite_jobs = expand_jobs(options.suite, library, options.worker).jobs;
  std::vector<Job> jobs = select_jobs(options, suite_jobs);
  const Earlier earlier = options.resume ? earlier_rows(options, library, suite_jobs, jobs) : Earlier{};
  const std::size_t requested = jobs.size();
  std::erase_if(jobs, [&](const Job& job) { return earlier.done.contains(job.hash); });
  std::vector<std::string> sizes;
  for (const Job& job : jobs) {
    if (std::string size = fmt::format("{}x{}", job.width, job.height); std::ranges::find(sizes, size) == sizes.end())
      sizes.push_back(std::move(size));
    const std::string& missing = library.get(job.scene).missing;
    std::vector<std::string> also;
    for (const std::string& text : {job.contender.label, job.motion()})
      if (!text.empty()) also.push_back(text);
    fmt::print("{}  {}{}{}\n", job.hash, job.title(), also.empty() ? "" : "  (" + joined(also, ", ") + ")",
               missing.empty() ? "" : "  unsupported: " + missing);
  }
  const Suite& suite = options.suite;
  if (const std::size_t done = requested - jobs.size(); done > 0) fmt::print("{} {} done\n", done, done == 1 ? "is" : "are");
  fmt::print("{}, {} x {} each", counted(jobs.size(), "row{s}"), counted(suite.processes, "process{es}"),
             counted(suite.repetitions, "repetition{s}"));
  fmt::print("{}\n", sizes.empty() ? "" : fmt::format(", {} pixels", joined(sizes, ", ")));
  std::erase_if(jobs, [&](const Job& job) { return !library.get(job.scene).missing.empty(); });
  if (jobs.empty()) return;
  std::vector<RowCost> costs = own_history().read();
  for (RowCost& cost : shipped_costs()) costs.push_back(std::move(cost));
  const Estimator estimate(std::move(costs), machine_name(machine_context(options.worker.threads)));
  fmt::print("{}\n", text(estimate(jobs, {suite.processes, suite.warmups, suite.repetitions})));
  if (suite.interval > 0) fmt::print("and up to {} more for narrow intervals\n", duration_text(suite.budget));
}

/// Whether any row has an answer. Says on stderr which scenes are not fetched: their rows have none.
bool has_answers(std::span<const Record> records) {
  std::set<std::string> missing;
  const auto is_answered = [&](const Record& record) {
    if (!context_text(record, "scene_hash").empty()) return true;
    missing.insert(record.scene);
    return false;
  };
  const auto answered = std::ranges::count_if(records, is_answered);
  if (!missing.empty())
    print_notice("{}: {} of {} measured; not fetched: {}. {} --all fetches them\n", answered > 0 ? "note" : "gnomon", answered,
                 counted(records.size(), "row{s}"), joined(missing, ", "), fetch_command());
  return answered > 0;
}

int run(RunCommand& options, const Program& program) {
  RunOptions& run_options = options.run;
  SceneLibrary library;
  if (options.edition.edition.empty()) {
    run_options.suite = make_suite(options, "run");
  } else {
    std::tie(run_options.suite, run_options.edition) = edition_to_run(options.edition, options, library);
  }
  run_options.filter = options.filter;
  run_options.command = program.words;
  run_options.worker = worker_options(program, options.threads);
  if (!options.shard.empty()) std::tie(run_options.shard_index, run_options.shard_count) = parse_shard(options.shard);
  if (run_options.out.empty()) {
    if (run_options.resume) throw Error("--resume needs --out: which folder to continue");
    run_options.out = timed_folder(run_options.suite.name);
  }
  if (run_options.resume) use_recorded_scenes(run_options.out, run_options.suite, library);
  if (options.dry_run) {
    print_rows(run_options, library);
    return 0;
  }
  const RunSummary summary = [&] {
    Progress progress(options.quiet);  // gone from the terminal before the table comes
    return run_suite(run_options, library, progress);
  }();
  const std::vector<Record> records = read_records(run_options.out);
  if (records.empty()) {
    if (summary.left_out.empty())
      fmt::print("shard {}/{} has no rows\n", run_options.shard_index, run_options.shard_count);
    else
      fmt::print("no rows: they support nothing of any group: {}\n", joined(summary.left_out, "; "));
    return 0;
  }
  write_tables(run_options.out, records);
  const std::size_t width = options.width.columns();
  fmt::print("{}\n", render_table(records, Format::terminal, {.width = width}));
  if (!summary.left_out.empty())
    fmt::print(
        "{}\n",
        wrapped_line(fmt::format("left out, for they support nothing of a group: {}", joined(summary.left_out, "; ")), width));
  fmt::print("{}: {} ok, {} unsupported, {} failed", counted(summary.ok + summary.unsupported + summary.failed, "row{s}"),
             summary.ok, summary.unsupported, summary.failed);
  if (summary.done_before) fmt::print("; {} done before", counted(summary.done_before, "{was|were}"));
  fmt::print("; {}\n\n", duration_text(summary.seconds));
  print_contents(run_options.out, width);
  if (!has_answers(records) && run_options.shard_count == 1) return 1;  // of a shard, the others may have what it lacks
  // Failed rows of an earlier, resumed run count too.
  return count(records, Status::failed) > 0 ? 1 : 0;
}

/// Every conflict with what differs, the first few of many.
void print_conflicts(const Merge& merge) {
  constexpr std::size_t most = 6;
  for (const MergeConflict& conflict : merge.conflicts) {
    print_notice("conflict: job {} {}\n  {}\n  {}\n", conflict.job, conflict.title, conflict.first.string(),
                 conflict.second.string());
    for (std::size_t k = 0; k < std::min(most, conflict.differences.size()); ++k)
      print_notice("    {}\n", conflict.differences[k]);
    if (conflict.differences.size() > most) print_notice("    and {} more\n", conflict.differences.size() - most);
  }
}

int merge(const MergeOptions& options) {
  require_free(options.out);
  require_one_edition(options.dirs);
  std::vector<std::pair<fs::path, std::vector<Record>>> runs;
  for (const fs::path& dir : options.dirs) runs.emplace_back(dir, read_records(dir));
  const Merge merged = merge_records(runs, options.prefer_last);
  print_conflicts(merged);
  if (!merged.conflicts.empty() && !options.prefer_last) {
    print_notice("gnomon: {} of {} {} two answers; nothing is written. --prefer-last takes the last one of each\n",
                 merged.conflicts.size(), counted(merged.rows.size(), "job{s}"), merged.conflicts.size() == 1 ? "has" : "have");
    return 1;
  }
  for (const std::string& note : merged.notes) print_notice("note: {}\n", note);
  if (merged.duplicate_count)
    print_notice("note: {} in more than one folder with the same answer; each counts once, by its {} one\n",
                 counted(merged.duplicate_count, "row{s} {stands|stand}"), options.prefer_last ? "last" : "first");
  std::vector<Record> records;
  for (const MergedRow& row : merged.rows) records.push_back(row.record);
  const std::size_t missing = write_merge(merged, options.out, [&](const fs::path& folder) {
    join_run_files(options.dirs, folder);
    write_tables(folder, records);
  });
  if (missing) print_notice("note: {} in none of the folders\n", counted(missing, "picture{s} that the records name {is|are}"));
  if (records.empty()) {
    fmt::print("the folders hold no rows\n");
    return 0;
  }
  const std::size_t failed = count(records, Status::failed);
  fmt::print("{}\n{}: {} ok, {} unsupported, {} failed from {}\n\n",
             render_table(records, Format::terminal, {.width = options.width.columns()}), counted(records.size(), "row{s}"),
             count(records, Status::ok), count(records, Status::unsupported), failed,
             counted(options.dirs.size(), "folder{s}"));
  print_contents(options.out, options.width.columns());
  return failed > 0 ? 1 : 0;
}

}  // namespace

std::pair<int, int> parse_shard(const std::string& text) {
  int index = 0, count = 0;
  const auto is_whole = [](std::string_view part, int& number) {
    const auto [rest, code] = std::from_chars(part.data(), part.data() + part.size(), number);
    return code == std::errc{} && rest == part.data() + part.size();
  };
  const std::size_t slash = std::min(text.find('/'), text.size());
  const std::string_view all(text), after = all.substr(std::min(slash + 1, text.size()));
  if (!is_whole(all.substr(0, slash), index) || !is_whole(after, count) || count < 1 || index < 0 || index >= count)
    throw Error("--shard {} is not I/N with 0 <= I < N", text);
  return {index, count};
}

void write_tables(const fs::path& folder, std::span<const Record> records) {
  if (records.empty()) return;
  for (const auto& [format, file] : {std::pair(Format::markdown, "table.md"), std::pair(Format::csv, "table.csv"),
                                     std::pair(Format::latex, "table.tex"), std::pair(Format::json, "table.json")})
    write_file(folder / file, render_table(records, format));
}

void add_run(Program& program) {
  auto [command, options] =
      program.line.command<RunCommand>("run", "A suite, or any scenes and techniques: costs, errors, tables",
                                       [&program](RunCommand& read) { return run(read, program); });
  command.option("suite", &options.suite, "Suite name, or a .toml file");
  add_edition_options(command, options.edition);
  add_suite_options(command, options);
  command.option("--out", &options.run.out, "Folder to write to; runs/NAME-TIME by default", {.check = not_empty()});
  command.option("--truth", &options.truth, "What counts in the headline: shape | mesh", {.check = not_empty()});
  command.option(
      "--truth-over", &options.truth_over,
      "Under lights without area: center, or pixel or both, which add coverage_error_mean and _rms against the mean of "
      "the truth over each pixel; analyses of rows of pixel rank by it",
      {.check = one_of({std::begin(truth_over_names), std::end(truth_over_names)})});
  command.option("--shard", &options.shard, "I/N: part I of N of the rows, 0 <= I < N; gnomon merge joins them",
                 {.check = not_empty()});
  const auto resume = command.flag("--resume", &options.run.resume, "Continue in --out; rows that are there are not run again");
  command.flag("--retry-failed", &options.run.retry_failed, "With --resume: rows that failed are run again", resume);
  command.flag("--rebuilt", &options.run.rebuilt, "With --resume: rows that other code measured are run again", resume);
  command.flag("--dry-run", &options.dry_run, "Print the rows and how long they may take; run nothing");
  command.flag("--quiet", &options.quiet, "No progress");
  add_width_options(command, options.width);
}

void add_merge(Program& program) {
  auto [command, options] =
      program.line.command<MergeOptions>("merge", "Runs of shards as one run: records, pictures, tables", merge);
  command.option("dirs", &options.dirs, "Folders of runs", {.is_required = true});
  command.option("--out", &options.out, "Folder to write to; it may not hold records",
                 {.is_required = true, .check = not_empty()});
  command.flag("--prefer-last", &options.prefer_last, "Where folders disagree on a row, take the last one's");
  add_width_options(command, options.width);
}

}  // namespace gnomon::app
