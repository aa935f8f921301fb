#include <map>
#include <unordered_map>

#include "app/analysis_options.h"
#include "measure/record/merge.h"

namespace gnomon::app {

namespace {

/// For each kind of analysis or figure: the options that it takes beside those that every kind takes.
const std::map<std::string, std::vector<std::string>> taken_options{
    {"growth", {"--x"}},
    {"front", {"--error", "--cost", "--all"}},
    {"best", {"--error", "--cost", "--times", "--memories", "--errors"}},
    {"map", {"--x", "--y", "--facet", "--error"}},
    {"motion", {"--error"}},
    {"sweep", {"--x", "--error"}},
    {"stages", {}},
    {"causes", {}},
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
      std::vector<std::string> takers;
      for (const std::string& one : kinds)
        if (takes(one, name)) takers.push_back(one);
      const std::string last = takers.back();
      takers.pop_back();
      throw Error("{} is for {}{}{}; {} does not take it", name, joined(takers, ", "), takers.empty() ? "" : " and ", last,
                  kind);
    }
}

}  // namespace

void add_kind_words(Command& command, std::vector<std::string>& words, const std::string& kinds) {
  command.option("words", &words, "Folders of runs, then the kind: " + kinds).required().type_name("DIR... KIND");
}

std::string take_kind(std::vector<std::string>& words, const Command& command, const std::string& name,
                      const std::vector<std::string>& kinds) {
  const std::string kind = words.back();
  words.pop_back();
  if (words.empty()) throw Error("{} takes a run's folder and a kind; kinds are: {}", name, joined(kinds, ", "));
  require_taken(command, kind, kinds);
  return kind;
}

void add_analysis_options(Command& command, AnalysisOptions& options, std::string& cost) {
  command.option("--x", &options.x,
                 "growth: triangles, pixels, lights or a numeric parameter; map: a parameter; sweep: a numeric one");
  command.option("--y", &options.y, "map: the second parameter");
  command.option("--facet", &options.facet, "map: the third parameter, one map for each of its values");
  command.option("--error,--metric", &options.metric, "What is compared: a metric, cause.NAME, STAGE_ms, bytes")
      .shows_default();
  command.option("--cost", &cost, "resolve, light (relight + resolve), geometry (with build) or bytes").shows_default();
}

std::vector<Record> read_runs(const std::vector<std::string>& dirs, const std::string& filter) {
  std::vector<Record> all;
  std::unordered_map<std::string, std::pair<std::size_t, std::string>>
      first;  // by job: index into `all`, and the folder it came from
  std::size_t twice = 0;
  for (const std::string& dir : dirs)
    for (Record& record : matching(read_records(dir), filter)) {
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
      all.push_back(std::move(record));
    }
  if (twice)
    fmt::print(stderr, "note: {} row{} in more than one folder with the same answer; each counts once, by its first folder\n",
               twice, twice == 1 ? " stands" : "s stand");
  if (all.empty())
    throw Error("{} hold{} no record{}", joined(dirs, ", "), dirs.size() == 1 ? "s" : "",
                filter.empty() ? "" : fmt::format(" that matches {}", filter));
  return all;
}

namespace {

struct Options {
  std::vector<std::string> words;
  std::string format = "terminal", filter, cost = "light";
  AnalysisOptions analysis;
  TableOptions table;
};

void print_analysis(Options& options, const Command& command) {
  const Format format = format_named(options.format);
  const std::string kind = take_kind(options.words, command, "analyze", analysis_kinds());
  options.analysis.cost = cost_named(options.cost);
  const std::vector<Record> records = read_runs(options.words, options.filter);
  options.table.width = terminal_width();
  fmt::print("{}", analyze(records, kind, options.analysis, format, options.table));
}

}  // namespace

void add_analyze(Program& program) {
  auto [command, options] = program.line.command<Options>(
      "analyze", "What a run says of growth, fronts, budgets, parameters and motion: DIR... growth|front|best|map|motion|sweep",
      print_analysis);
  add_kind_words(command, options.words, "growth, front, best, map, motion or sweep");
  command.option("--format", &options.format, "terminal, md, csv, tex or json").shows_default();
  command.option("--filter", &options.filter,
                 "Only rows whose 'SCENE LIGHT [PATH] TECHNIQUE:SETTINGS' matches this expression");
  add_analysis_options(command, options.analysis, options.cost);
  command.option("--times", &options.analysis.times, "best: budgets in ms").delimiter(',').check(above_zero());
  command.option("--memories", &options.analysis.memories, "best: budgets in MiB").delimiter(',').check(above_zero());
  command.option("--errors", &options.analysis.errors, "best: budgets in the unit that tables show")
      .delimiter(',')
      .check(above_zero());
  command.flag("--all", &options.analysis.all, "front: beaten settings too");
  command.option("--caption", &options.table.caption, "Caption of the LaTeX table");
}

}  // namespace gnomon::app
