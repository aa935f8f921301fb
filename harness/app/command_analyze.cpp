#include "app/analysis_options.h"

namespace gnomon::app {

void add_analysis_options(CLI::App* command, AnalysisOptions& options, std::string& cost) {
  command->add_option("--x", options.x, "growth: triangles, pixels, lights or a numeric parameter; map: a parameter");
  command->add_option("--y", options.y, "map: the second parameter");
  command->add_option("--facet", options.facet, "map: the third parameter, one map for each of its values");
  command->add_option("--error,--metric", options.metric, "What is compared: a metric, cause.NAME, STAGE_ms, bytes")
      ->capture_default_str();
  command->add_option("--cost", cost, "resolve, light (relight + resolve), geometry (with build) or bytes")
      ->capture_default_str();
}

std::vector<Record> read_runs(const std::vector<std::string>& dirs, const std::string& filter) {
  std::vector<Record> all;
  for (const std::string& dir : dirs)
    for (Record& record : read_records(dir)) all.push_back(std::move(record));
  all = matching(std::move(all), filter);
  if (all.empty())
    throw Error("{} hold{} no record{}", fmt::join(dirs, ", "), dirs.size() == 1 ? "s" : "",
                filter.empty() ? "" : fmt::format(" that matches {}", filter));
  return all;
}

void add_analyze(Program& program) {
  struct Options {
    std::vector<std::string> words;
    std::string format = "terminal", filter, cost = "light";
    AnalysisOptions analysis;
    TableOptions table;
  };
  CLI::App* command = program.cli.add_subcommand(
      "analyze", "What a run says of growth, fronts, budgets, parameters and motion: DIR... growth|front|best|map|motion");
  auto options = std::make_shared<Options>();
  command->add_option("words", options->words, "Folders of runs, then the kind: growth, front, best, map or motion")
      ->required()
      ->type_name("DIR... KIND");
  command->add_option("--format", options->format, "terminal, md, csv, tex or json")->capture_default_str();
  command->add_option("--filter", options->filter, "Only rows whose 'SCENE LIGHT TECHNIQUE:SETTINGS' matches this expression");
  add_analysis_options(command, options->analysis, options->cost);
  command->add_option("--times", options->analysis.times, "best: budgets in ms")->delimiter(',');
  command->add_option("--memories", options->analysis.memories, "best: budgets in MiB")->delimiter(',');
  command->add_option("--errors", options->analysis.errors, "best: budgets in the unit that tables show")->delimiter(',');
  command->add_flag("--all", options->analysis.all, "front: beaten settings too");
  command->add_option("--caption", options->table.caption, "Caption of the LaTeX table");
  command->callback([&program, options] {
    program.chosen = [options] {
      const Format format = format_named(options->format);
      const std::string kind = options->words.back();
      options->words.pop_back();
      if (options->words.empty())
        throw Error("analyze takes a run's folder and a kind; kinds are: {}", fmt::join(analysis_kinds(), ", "));
      options->analysis.cost = cost_named(options->cost);
      const std::vector<Record> records = read_runs(options->words, options->filter);
      options->table.width = terminal_width();
      fmt::print("{}", analyze(records, kind, options->analysis, format, options->table));
      return 0;
    };
  });
}

}  // namespace gnomon::app
