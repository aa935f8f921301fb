#include "analysis/compare_across.h"
#include "app/app.h"
#include "app/suite_options.h"
#include "app/table_options.h"
#include "measure/run/run.h"
#include "report/analysis/compare_table.h"

namespace gnomon::app {

namespace {

struct CompareCommand : SuiteOptions {
  std::string base, contender, across, format = "terminal";
  CompareOptions compare;
  bool all = false, over_all = false, quiet = false;
  TableWidth width;
  RunOptions live;
  std::string base_program;  ///< with --live
};

/// Times both programs side by side; base and contender become their folders.
void run_both(CompareCommand& options, const Program& program) {
  if (!options.base.empty())
    throw Error("compare takes two folders, or --live and a program, not both: {} is one folder too many", options.base);
  RunOptions& live = options.live;
  if (options.suite.empty() && options.scenes.empty() && options.techniques.empty()) options.suite = "quick";
  live.suite = make_suite(options, "compare --live");
  live.filter = options.filter;
  live.command = program.words;
  live.worker = worker_options(program, options.threads);
  if (live.out.empty()) live.out = timed_folder("live");
  SceneLibrary library;
  Progress progress(options.quiet);
  run_live(live, options.base_program, library, progress);
  options.base = (live.out / "base").string();
  options.contender = (live.out / "contender").string();
}

/// The rows of two values of a parameter, of one folder or of two; base and contender become what the comparison calls them.
void read_across(CompareCommand& options, std::vector<Record>& base, std::vector<Record>& contender) {
  const TwoValues across = parse_two_values(options.across);
  base = rows_across(read_records(options.base), across.parameter, across.base);
  contender = rows_across(read_records(options.contender), across.parameter, across.contender);
  const auto named = [&](std::string& folder, const std::string& value) {
    folder = fmt::format("{}, {}={}", folder, across.parameter, value);
  };
  named(options.base, across.base);
  named(options.contender, across.contender);
}

int run(CompareCommand& options, const Program& program) {
  const Format format = format_named(options.format);
  if (format == Format::latex) throw Error("--format tex is none of a comparison's: terminal, md, csv, json");
  if (!options.base_program.empty() && !options.across.empty())
    throw Error("--across {} is of runs that are there, and --live makes two", options.across);
  if (!options.base_program.empty()) run_both(options, program);
  if (!options.across.empty() && options.contender.empty()) options.contender = options.base;
  if (options.base.empty() || options.contender.empty())
    throw Error("compare needs two folders of runs, BASE and CONTENDER, or one and --across, or --live and a program");
  std::vector<Record> base, contender;
  if (options.across.empty()) {
    base = read_records(options.base);
    contender = read_records(options.contender);
  } else {
    read_across(options, base, contender);
  }
  const Comparison comparison = compare(base, contender, options.compare);
  if (comparison.counts().matched == 0)
    throw Error("{} and {} have no row in common: {} and {} rows of other scenes, settings, sizes or truths", options.base,
                options.contender, base.size(), contender.size());
  fmt::print("{}", render_comparison(comparison, format,
                                     {.base = options.base,
                                      .contender = options.contender,
                                      .all = options.all,
                                      .width = options.width.columns(),
                                      .over_all = options.over_all}));
  return comparison.counts().regressions > 0 ? 1 : 0;
}

}  // namespace

void add_compare(Program& program) {
  auto [command, options] =
      program.line.command<CompareCommand>("compare", "Two runs row by row: what became slower, faster, wrong or right",
                                           [&program](CompareCommand& read) { return run(read, program); });
  CompareOptions& compare = options.compare;
  command.option("base", &options.base, "Folder of the run to compare with");
  command.option("contender", &options.contender, "Folder of the run that is judged");
  command.option("--across", &options.across,
                 "PARAMETER=A,B: rows with value A of base against the same rows with value B of contender, of one folder or "
                 "of two, as version=r170,r187",
                 {.check = not_empty()});
  command.option("--floor", &compare.floor, "Share that a time must differ by to be called different",
                 {.check = number_in(0, 10)});
  command.option("--fdr", &compare.fdr, "Rate of false discoveries among all times called different",
                 {.check = number_in(1e-9, 0.5)});
  command.option("--threshold", &compare.threshold, "A time called slower is a regression above this ratio",
                 {.check = number_in(1, 1e6)});
  command.option("--error-threshold", &compare.error_threshold, "An error that rises by more is a regression",
                 {.check = number_in(0, 1)});
  command.option("--format", &options.format, "terminal, md, csv or json");
  command.flag("--all", &options.all, "Also what does not differ");
  command.flag("--over-all", &options.over_all, "For people: only what is over all scenes, no row");
  add_width_options(command, options.width);
  command.flag("--force", &compare.force, "Judge times of different processors, too");
  const auto live =
      command.option("--live", &options.base_program,
                     "Another gnomon: runs both side by side and compares, this one the contender", {.type_name = "PROGRAM"});
  command.option("--suite", &options.suite, "With --live: suite name or .toml file; quick by default", {.needs = live});
  add_suite_options(command, options, "With --live: ", live);
  command.option("--out", &options.live.out, "With --live: folder for the two runs; runs/live-TIME by default",
                 {.needs = live});
  command.flag("--quiet", &options.quiet, "No progress");
}

}  // namespace gnomon::app
