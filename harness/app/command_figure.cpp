#include <filesystem>

#include "app/analysis_options.h"
#include "report/figure/figure.h"

namespace gnomon::app {

namespace {

struct Options {
  std::vector<std::string> words;
  std::string filter, cost = "light", out;
  bool script = false;
  FigureOptions figure;
};

void make_figure(Options& options, const Command& command) {
  const std::string kind = take_kind(options.words, command, "figure", figure_kinds());
  if (options.out.empty() && !options.script) throw Error("figure needs --out FILE.svg, .pdf or .png, or --script");
  const std::filesystem::path out = options.out.empty() ? "figure.svg" : options.out;
  options.figure.analysis.cost = cost_named(options.cost);
  const std::vector<Record> records = read_runs(options.words, options.filter);
  const std::string program_text = figure_script(records, kind, options.figure, out);
  if (options.script) {
    fmt::print("{}", program_text);
  } else {
    run_gnuplot(program_text, out);
  }
}

}  // namespace

void add_figure(Program& program) {
  auto [command, options] = program.line.command<Options>(
      "figure", "A figure of a run, by gnuplot: DIR... front|growth|stages|map|causes|motion|sweep --out FILE.svg|.pdf|.png",
      make_figure);
  add_kind_words(command, options.words, "front, growth, stages, map, causes, motion or sweep");
  command.option("--out", &options.out, "File to write; .svg, .pdf or .png");
  command.flag("--script", &options.script, "Print the gnuplot program instead of running it");
  command.option("--filter", &options.filter,
                 "Only rows whose 'SCENE LIGHT [PATH] TECHNIQUE:SETTINGS' matches this expression");
  command.option("--title", &options.figure.title, "Title above the figure; none by default: papers have captions");
  command.option("--width", &options.figure.width_cm, "Width in cm; the height follows")
      .check(number_in(5, 100))
      .shows_default();
  add_analysis_options(command, options.figure.analysis, options.cost);
}

}  // namespace gnomon::app
