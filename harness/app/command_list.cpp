#include <gnomon/registry.h>

#include "app/app.h"
#include "measure/run/suite.h"
#include "measure/scene/load.h"
#include "measure/score/metrics.h"
#include "report/listing.h"
#include "report/table/text_table.h"

namespace gnomon::app {

namespace {

void print(const std::string& text, const Json& json, bool as_json) {
  fmt::print("{}", as_json ? json_text(json, 2) + "\n" : text);
}

void print_scenes(bool as_json) {
  Json list = Json::array();
  TextTable table({{"scene", ""}, {"kind", ""}, {"what it is", ""}});
  for (const SceneListing& scene : list_scenes()) {
    list.push_back({{"id", scene.id},
                    {"title", scene.title},
                    {"summary", scene.summary},
                    {"generated", scene.generated},
                    {"available", scene.available}});
    const std::string kind = scene.generated ? "generated" : scene.available ? "described" : "not fetched";
    table.add_row({scene.id, kind, scene.summary.empty() ? scene.title : scene.summary});
  }
  print(table.text(terminal_width()), list, as_json);
}

void print_suites(bool as_json) {
  Json list = Json::array();
  TextTable table({{"suite", ""}, {"rows", "", Align::right}, {"what it is", ""}});
  for (const std::string& id : suite_names()) {
    const Suite suite = read_suite(id);
    std::size_t rows = 0;
    for (const SuiteGroup& g : suite.groups)
      rows += g.scenes.size() * g.contenders.size() * std::max<std::size_t>(1, g.lights.size()) *
              std::max<std::size_t>(1, g.views.size()) * std::max<std::size_t>(1, g.paths.size()) *
              std::max<std::size_t>(1, g.sizes.size());
    list.push_back({{"id", id}, {"title", suite.title}, {"rows", rows}});
    table.add_row({id, std::to_string(rows), suite.title});
  }
  print(table.text(terminal_width()), list, as_json);
}

struct Options {
  std::string what = "techniques";
  bool json = false;
};

void list(const Options& options) {
  const auto techniques = std::span(registry().techniques());
  if (options.what == "techniques")
    print(list_text(techniques, terminal_width()), list_json(techniques), options.json);
  else if (options.what == "metrics")
    print(list_text(metric_infos(), terminal_width()), list_json(metric_infos()), options.json);
  else if (options.what == "causes")
    print(list_text(cause_infos(), terminal_width()), list_json(cause_infos()), options.json);
  else if (options.what == "scenes")
    print_scenes(options.json);
  else if (options.what == "suites")
    print_suites(options.json);
  else {
    const std::vector<std::string> lists = {"techniques", "scenes", "suites", "metrics", "causes"};
    throw Error("there is no list {}; did you mean {}? There are: {}", options.what, nearest_word(options.what, lists),
                joined(lists, ", "));
  }
}

}  // namespace

void add_list(Program& program) {
  auto [command, options] =
      program.line.command<Options>("list", "What there is: techniques, scenes, suites, metrics or causes", list);
  command.option("what", &options.what, "techniques, scenes, suites, metrics or causes").shows_default();
  command.flag("--json", &options.json, "As JSON");
}

}  // namespace gnomon::app
