// gnomon list, describe and docs: what there is, for the terminal, for programs and as pages.
#include <gnomon/registry.h>

#include "analysis/analysis.h"
#include "app/app.h"
#include "app/table_options.h"
#include "measure/part_file.h"
#include "measure/paths.h"
#include "measure/run/suite.h"
#include "measure/scene/blob.h"
#include "measure/scene/load.h"
#include "measure/scene/time_reference.h"
#include "measure/score/metrics.h"
#include "report/conformance.h"
#include "report/listing.h"
#include "report/pages.h"
#include "report/scene_description.h"
#include "report/table/text_table.h"

namespace gnomon::app {

namespace {

void print(const std::string& text, const Json& json, bool as_json) {
  fmt::print("{}", as_json ? json_text(json, 2) + "\n" : text);
}

void print_scenes(bool as_json, std::size_t width) {
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
  print(table.text(width), list, as_json);
}

void print_suites(bool as_json, std::size_t width) {
  Json list = Json::array();
  TextTable table({{"suite", ""}, {"rows", "", Align::right}, {"what it is", ""}});
  for (const std::string& id : suite_names()) {
    const Suite suite = read_suite(id);
    std::size_t rows = 0;
    for (const SuiteGroup& g : suite.groups)
      rows += g.scenes.size() * g.contenders.size() * std::max<std::size_t>(1, g.lights.size()) *
              std::max<std::size_t>(1, g.views.size()) * std::max<std::size_t>(1, g.paths.size() + g.animations.size()) *
              std::max<std::size_t>(1, g.sizes.size());
    list.push_back({{"id", id}, {"title", suite.title}, {"rows", rows}});
    table.add_row({id, std::to_string(rows), suite.title});
  }
  print(table.text(width), list, as_json);
}

struct ListOptions {
  std::string what = "techniques";
  bool json = false;
  TableWidth width;
};

void list_content(const ListOptions& options) {
  const auto techniques = std::span(registry().techniques());
  const std::size_t width = options.width.columns();
  const auto print_all = [&](const auto&... infos) { print(list_text(infos..., width), list_json(infos...), options.json); };
  if (options.what == "techniques") return print_all(techniques);
  if (options.what == "metrics") return print_all(metric_infos());
  if (options.what == "causes") return print_all(cause_infos(), techniques);
  if (options.what == "rules") return print_all(conformance::rules());
  if (options.what == "scenes") return print_scenes(options.json, width);
  if (options.what == "suites") return print_suites(options.json, width);
  require_word("there is no list", options.what,
               std::vector<std::string>{"techniques", "scenes", "suites", "metrics", "causes", "rules"});
}

struct DescribeOptions {
  std::string id;
  bool json = false;
  TableWidth width;
};

void describe(const DescribeOptions& options) {
  std::vector<std::string> names;
  const std::string scene_part = without_time(options.id), stem = scene_part.substr(0, scene_part.find(':'));
  const std::string settings = options.id.substr(std::min(options.id.size(), stem.size() + 1));
  for (const TechniqueEntry& entry : registry().techniques()) {
    if (entry.id == stem && scene_part == options.id) {
      fmt::print("{}", options.json ? json_text(describe_json(entry, settings), 2) + "\n"
                                    : describe_text(entry, options.width.columns(), settings));
      return;
    }
    names.push_back(entry.id);
  }
  for (const SceneListing& scene : list_scenes()) names.push_back(scene.id);
  const bool is_file = options.id.find_first_of("./") != std::string::npos;
  if (!is_file && std::ranges::find(names, stem) == names.end())
    throw Error("there is no technique or scene {}; did you mean {}? There are: {}", options.id, nearest_word(stem, names),
                joined(names, ", "));
  const Scene scene = load_scene(options.id);
  fmt::print("{}", options.json ? json_text(describe_json(options.id, scene), 2) + "\n"
                                : describe_text(options.id, scene, options.width.columns()));
}

struct DocsOptions {
  std::filesystem::path out, rules;
  bool check = false;
};

int write_docs(DocsOptions options) {
  if (options.out.empty() && options.rules.empty())
    options = {.out = data_root() / "docs/techniques", .rules = data_root() / "docs/conformance.md", .check = options.check};
  if (options.check) {
    std::vector<std::string> stale;
    if (!options.out.empty())
      for (const std::string& page : stale_pages(options.out)) stale.push_back((options.out / page).string());
    if (!options.rules.empty() && is_stale(options.rules, conformance::rules_page())) stale.push_back(options.rules.string());
    for (const std::string& page : stale) fmt::print("stale: {}\n", page);
    return stale.empty() ? 0 : 1;
  }
  if (!options.out.empty()) {
    write_pages(options.out);
    fmt::print("{}\n", options.out.string());
  }
  if (!options.rules.empty()) {
    write_file(replaced_file(options.rules), conformance::rules_page());
    fmt::print("{}\n", options.rules.string());
  }
  return 0;
}

}  // namespace

void add_list(Program& program) {
  auto [command, options] = program.line.command<ListOptions>(
      "list", "What there is: techniques, scenes, suites, metrics, causes or rules", list_content);
  command.option("what", &options.what, "techniques, scenes, suites, metrics, causes or rules");
  command.flag("--json", &options.json, "As JSON");
  add_width_options(command, options.width);
}

void add_describe(Program& program) {
  auto [command, options] = program.line.command<DescribeOptions>("describe", "All about one technique or scene", describe);
  command.option("id", &options.id, "Technique or scene, with settings or without (ID, ID:of=ID), or a scene file",
                 {.is_required = true});
  command.flag("--json", &options.json, "As JSON");
  add_width_options(command, options.width);
}

void add_docs(Program& program) {
  auto [command, options] = program.line.command<DocsOptions>(
      "docs", "Write docs/techniques and docs/conformance.md from techniques and rules", write_docs);
  command.flag("--check", &options.check, "Write nothing; exit 1 when a page is stale");
  command.option("--out", &options.out, "Folder of the techniques' pages; docs/techniques where neither is named");
  command.option("--rules", &options.rules, "Page of the rules; docs/conformance.md where neither is named");
}

}  // namespace gnomon::app
