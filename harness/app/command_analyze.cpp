// gnomon analyze and gnomon figure: the results of a run as a table and as a picture.
#include <map>
#include <unordered_map>

#include "app/app.h"
#include "app/table_options.h"
#include "measure/notice.h"
#include "measure/record/merge.h"
#include "report/analysis/analysis_table.h"
#include "report/figure/figure.h"

namespace gnomon::app {

namespace {

/// For each kind of analysis or figure: the options that it takes beside those that every kind takes.
const std::map<std::string, std::vector<std::string>> taken_options{
    {"growth", {"--x", "--error"}},
    {"forecast", {"--x", "--to", "--cost"}},
    {"front", {"--error", "--cost", "--all", "--over-all"}},
    {"best", {"--error", "--cost", "--times", "--memories", "--errors", "--over-all"}},
    {"enough", {"--error", "--cost", "--errors", "--over-all"}},
    {"rank", {"--error", "--cost", "--all-pairs"}},
    {"map", {"--x", "--y", "--facet", "--error"}},
    {"motion", {"--error"}},
    {"sweep", {"--x", "--error"}},
    {"seams", {}},
    {"masks", {}},
    {"parameters", {"--error"}},
    {"stages", {"--cost"}},
    {"causes", {}},
    {"sheet", {}},
};

bool takes(const std::string& kind, const std::string& option) {
  const auto found = taken_options.find(kind);
  return found != taken_options.end() && std::ranges::find(found->second, option) != found->second.end();
}

/// Throws Error when an option of analyses was given that this kind does not take.
void require_taken(const Command& command, const std::string& kind, const std::vector<std::string>& kinds) {
  if (!taken_options.contains(kind)) return;  // an unknown kind: analyze() and figure_script() say which there are
  for (const auto& [other, options] : taken_options)
    for (const std::string& name : options) {
      if (!command.is_given(name) || takes(kind, name)) continue;
      std::vector<std::string> takers = kinds;
      std::erase_if(takers, [&](const std::string& one) { return !takes(one, name); });
      const std::string last = takers.back();
      takers.pop_back();
      throw Error("{} is for {}{}{}; {} does not take it", name, joined(takers, ", "), takers.empty() ? "" : " and ", last,
                  kind);
    }
}

/// What both commands take.
struct Options {
  std::vector<std::string> words;
  std::string filter, cost = "light";
  AnalysisOptions analysis;
};
struct AnalyzeOptions : Options {
  std::string format = "terminal", paper = "landscape";
  TableWidth width;
  TableOptions table;
};
struct PictureOptions : Options {
  std::string out;
  bool script = false;
  FigureOptions figure;
};

void add_shared_options(Command& command, const std::string& kinds, Options& options) {
  AnalysisOptions& analysis = options.analysis;
  command.option("words", &options.words, "Folders of runs, then the kind: " + kinds,
                 {.is_required = true, .type_name = "DIR... KIND"});
  command.option("--filter", &options.filter,
                 "Only rows whose 'SCENE LIGHT [VIEW] [PATH] TECHNIQUE:SETTINGS' matches this expression");
  command.option("--x", &analysis.x,
                 "growth, forecast: triangles, pixels, lights or a numeric parameter; map: a parameter; sweep: a numeric one");
  command.option("--y", &analysis.y, "map: the second parameter");
  command.option("--facet", &analysis.facet, "map: the third parameter, one map for each of its values");
  command.option("--error,--metric", &analysis.metric,
                 "What is compared, and what grows: a metric, cause.NAME, STAGE_ms, bytes");
  command.option("--cost", &options.cost,
                 "resolve, light (relight + resolve), geometry (another scene: build too), motion (the geometry moves: update "
                 "+ relight + resolve) or bytes");
}

/// Takes the kind of analysis or figure, the last of the words, off the folders before it. Throws Error, which begins with
/// `name` of the command, when there is no folder or the words hold an option that this kind does not take; `kinds` are the
/// command's.
std::string take_kind(Options& options, const Command& command, const std::string& name,
                      const std::vector<std::string>& kinds) {
  const std::string kind = options.words.back();
  options.words.pop_back();
  if (options.words.empty()) throw Error("{} takes a run's folder and a kind; kinds are: {}", name, joined(kinds, ", "));
  require_taken(command, kind, kinds);
  options.analysis.cost = cost_named(options.cost);
  if (command.is_given("--cost")) options.analysis.only_cost = options.analysis.cost;
  if (command.is_given("--error")) options.analysis.growing = options.analysis.metric;
  return kind;
}

/// Sets what nobody named of the analysis.
void set_metric(AnalysisOptions& analysis, const Command& command, std::span<const Record> records) {
  if (!command.is_given("--error")) analysis.metric = judging_metric(records);
}

/// The records of these folders, in order, that match --filter, with pictures by their path from here. A row that several
/// folders contain counts once, by its first record, and stderr says how many do. Throws Error when two folders answer a job
/// differently, and when there is no record.
std::vector<Record> read_runs(const Options& options) {
  std::vector<Record> all;
  std::unordered_map<std::string, std::pair<std::size_t, std::string>>
      first;  // by job: index into `all`, and the folder it came from
  std::size_t twice = 0;
  for (const std::string& dir : options.words)
    for (Record& record : matching(read_records(dir), options.filter)) {
      if (!record.job.empty()) {
        const auto [known, is_new] = first.try_emplace(record.job, all.size(), dir);
        if (!is_new) {
          const auto& [index, folder] = known->second;
          if (const std::vector<std::string> different = differences(all[index], record); !different.empty())
            throw Error("{} and {} answer {} differently: {}{}; analyze one of them, or compare them", folder, dir,
                        title(record), different.front(),
                        different.size() > 1 ? fmt::format(" and {} more", different.size() - 1) : "");
          ++twice;
          continue;
        }
      }
      if (record.error_picture) record.error_picture = (std::filesystem::path(dir) / *record.error_picture).string();
      all.push_back(std::move(record));
    }
  if (twice)
    print_notice("note: {} row{} in more than one folder with the same answer; each counts once, by its first folder\n", twice,
                 twice == 1 ? " stands" : "s stand");
  if (all.empty())
    throw Error("{} hold{} no record{}", joined(options.words, ", "), options.words.size() == 1 ? "s" : "",
                options.filter.empty() ? "" : fmt::format(" that matches {}", options.filter));
  return all;
}

/// The quantities of --error, which a figure of a sweep takes several of, at most one of each color.
std::vector<std::string> quantities_of(const std::string& words, const std::string& kind) {
  std::vector<std::string> all;
  for (std::size_t from = 0, to = 0; to != words.npos; from = to + 1) {
    to = words.find(',', from);
    all.push_back(words.substr(from, to == words.npos ? to : to - from));
    if (all.back().empty()) throw Error("--error {} has an empty name", words);
    if (std::ranges::count(all, all.back()) > 1) throw Error("--error {} names {} twice", words, all.back());
  }
  constexpr std::size_t most = 8;
  if (all.size() > 1 && kind != "sweep")
    throw Error("--error {}: figure {} takes one quantity; sweep takes several", words, kind);
  if (all.size() > most) throw Error("--error names {} quantities; a figure holds at most {}", all.size(), most);
  return all;
}

/// Replaces headings as tables print them by the names of the quantities.
void name_quantities(AnalysisOptions& options, std::span<const Record> records) {
  options.metric = quantity_named(records, options.metric);
  if (!options.growing.empty()) options.growing = options.metric;
}

void print_analysis(AnalyzeOptions& options, const Command& command) {
  const Format format = format_named(options.format);
  const std::string kind = take_kind(options, command, "analyze", analysis_kinds());
  options.table.width = options.width.columns();
  options.table.paper = paper_named(options.paper);
  if (kind == "masks" && options.words.size() > 1)
    throw Error("masks are compared within one run, and {} are given", joined(options.words, ", "));
  options.analysis.folder = options.words.front();
  const std::vector<Record> records = read_runs(options);
  set_metric(options.analysis, command, records);
  name_quantities(options.analysis, records);
  fmt::print("{}", analyze(records, kind, options.analysis, format, options.table));
}

void make_figure(PictureOptions& options, const Command& command) {
  const std::string kind = take_kind(options, command, "figure", figure_kinds());
  if (options.out.empty() && !options.script) throw Error("figure needs --out FILE.svg, .pdf or .png, or --script");
  const std::filesystem::path out = options.out.empty() ? "figure.svg" : options.out;
  const std::vector<Record> records = read_runs(options);
  set_metric(options.analysis, command, records);
  options.figure.metrics = quantities_of(options.analysis.metric, kind);
  for (std::string& metric : options.figure.metrics) metric = quantity_named(records, metric);
  options.analysis.metric = options.figure.metrics.front();
  name_quantities(options.analysis, records);
  options.figure.analysis = options.analysis;
  if (command.is_given("--cost")) options.figure.bars = options.analysis.cost;
  const std::string program_text = figure_script(records, kind, options.figure, out);
  if (options.script)
    fmt::print("{}", program_text);
  else
    run_gnuplot(program_text, out);
}

}  // namespace

void add_analyze(Program& program) {
  auto [command, options] = program.line.command<AnalyzeOptions>(
      "analyze",
      "What a run says of growth, fronts, budgets, pairs, parameters, motion, seams and masks: DIR... "
      "growth|forecast|front|best|enough|rank|map|motion|sweep|seams|masks",
      print_analysis);
  add_shared_options(command, "growth, forecast, front, best, enough, rank, map, motion, sweep, seams or masks", options);
  command.option("--format", &options.format, "terminal, md, csv, tex or json");
  command.option("--times", &options.analysis.times, "best: budgets in ms", {.check = above_zero(), .delimiter = ','});
  command.option("--memories", &options.analysis.memories, "best: budgets in MiB", {.check = above_zero(), .delimiter = ','});
  command.option("--to", &options.analysis.to, "forecast: where on the axis; four times the greatest that was measured",
                 {.check = above_zero()});
  command.option("--errors", &options.analysis.errors, "best, enough: budgets in the unit that tables show",
                 {.check = above_zero(), .delimiter = ','});
  command.flag("--all", &options.analysis.all, "front: beaten settings too");
  command.flag("--all-pairs", &options.analysis.all_pairs, "rank: every pair, not only the best against each");
  command.flag("--over-all", &options.analysis.over_all, "front, best, enough: only what is over all places");
  add_paper_options(command, options.table, options.paper);
  add_width_options(command, options.width);
}

void add_figure(Program& program) {
  auto [command, options] = program.line.command<PictureOptions>(
      "figure",
      "A figure of a run, by gnuplot: DIR... front|growth|stages|map|causes|motion|sweep|parameters|sheet --out "
      "FILE.svg|.pdf|.png",
      make_figure);
  add_shared_options(command, "front, growth, stages, map, causes, motion, sweep, parameters or sheet", options);
  command.option("--out", &options.out, "File to write; .svg, .pdf or .png", {.check = not_empty()});
  command.flag("--script", &options.script, "Print the gnuplot program instead of running it");
  command.option("--title", &options.figure.title, "Title above the figure; none by default: papers have captions");
  command.option("--width", &options.figure.width_cm, "Width in cm; the height follows", {.check = number_in(5, 100)});
}

}  // namespace gnomon::app
