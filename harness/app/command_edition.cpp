// gnomon edition: suites that stay as they are, and whether this program gives them. docs/editions.md has the rules.
#include "app/app.h"
#include "app/table_options.h"
#include "measure/counted.h"
#include "measure/edition/edition.h"
#include "measure/part_file.h"
#include "measure/printable.h"
#include "measure/scene/blob.h"
#include "measure/worker/build.h"
#include "report/table/text_table.h"

namespace gnomon::app {

namespace {

struct EditionCommand {
  std::string name;
  bool freeze = false, json = false;
  TableWidth width;
};

/// Names of contenders, each once, in the order of the groups.
std::vector<std::string> techniques_of(const Edition& edition) {
  std::vector<std::string> names;
  for (const SuiteGroup& group : edition.suite.groups)
    for (const Contender& contender : group.contenders)
      if (std::ranges::find(names, contender.name()) == names.end()) names.push_back(contender.name());
  return names;
}

/// "2 rows" of each place, in order.
std::vector<std::pair<std::string, std::size_t>> places_of(std::span<const Job> jobs) {
  std::vector<std::pair<std::string, std::size_t>> places;
  for (const Job& job : jobs) {
    const std::string title = job.title();
    const std::string place = title.substr(0, title.size() - job.contender.name().size() - 1);
    const auto known = std::ranges::find(places, place, &std::pair<std::string, std::size_t>::first);
    if (known == places.end())
      places.emplace_back(place, 1);
    else
      ++known->second;
  }
  return places;
}

/// One edition with all that is said of it.
struct Described {
  Edition edition;
  std::vector<std::string> differences;
  std::vector<Job> jobs;  ///< none where a scene lacks what the edition names
};

Described described(const std::string& name) {
  Described found{read_edition(name), {}, {}};
  SceneLibrary library;
  found.differences = edition_differences(found.edition, library);
  try {
    found.jobs = expand_jobs(found.edition.suite, library, {}).jobs;
  } catch (const Error&) {  // a difference says why
  }
  return found;
}

Json json_of(const Described& found) {
  const Edition& edition = found.edition;
  Json errata = Json::array(), places = Json::array();
  for (const Erratum& erratum : edition.errata)
    errata.push_back(json_object({{"technique", erratum.technique},
                                  {"version", erratum.version},
                                  {"reason", erratum.reason},
                                  {"rows", erratum.rows.empty() ? Json() : Json(erratum.rows)},
                                  {"applies", applies(erratum)}}));
  for (const auto& [place, rows] : places_of(found.jobs)) places.push_back(json_object({{"place", place}, {"rows", rows}}));
  return json_object({{"name", edition.name},
                      {"file", edition_file(edition.name).string()},
                      {"title", edition.title},
                      {"hash", edition.hash},
                      {"program", build_context()["version"]},
                      {"differences", found.differences},
                      {"rows", found.jobs.size()},
                      {"places", places},
                      {"techniques", techniques_of(edition)},
                      {"training", edition.training},
                      {"errata", errata}});
}

void print(const Described& found, std::size_t width) {
  const Edition& edition = found.edition;
  const auto line = [&](const std::string& text) { fmt::print("{}", wrapped_line(printable(text, true), width)); };
  line(fmt::format("edition     {}", edition.name));
  line(fmt::format("title       {}", edition.title));
  line(fmt::format("hash        {}", edition.hash));
  line(fmt::format("rows        {} at {}, {}x{} pixels, {} x {}", found.jobs.size(),
                   counted(places_of(found.jobs).size(), "place{s}"), edition.suite.width, edition.suite.height,
                   counted(edition.suite.processes, "process{es}"), counted(edition.suite.repetitions, "repetition{s}")));
  for (const auto& [place, rows] : places_of(found.jobs))
    line(fmt::format("place       {}: {}", place, counted(rows, "row{s}")));
  line(fmt::format("techniques  {}", joined(techniques_of(edition), ", ")));
  line(fmt::format("training    {}", joined(edition.training, ", ")));
  for (const Erratum& erratum : edition.errata)
    line(fmt::format("erratum     {}{}, from version {}{}: {}", erratum.technique,
                     erratum.rows.empty() ? "" : " (" + erratum.rows + ")", erratum.version,
                     applies(erratum) ? "" : ", not yet of this program", erratum.reason));
  line(fmt::format("to cite     Gnomon edition {}, hash {}", edition.name, edition.hash));
  for (const std::string& difference : found.differences) line(fmt::format("DIFFERS     {}", difference));
  line(found.differences.empty() ? fmt::format("this program, {}, gives this edition", build_text())
                                 : fmt::format("this program, {}, does not give this edition", build_text()));
}

/// One that cannot be read is in the table with its reason, beside the others; then 2 is returned.
int print_all(const EditionCommand& options) {
  int status = 0;
  Json list = Json::array();
  TextTable table({{"edition", ""}, {"hash", ""}, {"what it is", ""}});
  for (const std::string& name : edition_names()) try {
      const Edition edition = read_edition(name);
      list.push_back(json_object({{"name", edition.name}, {"hash", edition.hash}, {"title", edition.title}}));
      table.add_row({edition.name, edition.hash, edition.title});
    } catch (const Error& error) {
      list.push_back(json_object({{"name", name}, {"reason", error.what()}}));
      table.add_row({name, "", fmt::format("cannot be read: {}", error.what())});
      status = 2;
    }
  fmt::print("{}", options.json ? json_text(list, 2) + "\n" : table.text(options.width.columns()));
  return status;
}

/// Writes the frozen part of the file. One that is frozen may not become another.
int freeze(const std::string& name) {
  const std::filesystem::path file = edition_file(name);
  SceneLibrary library;
  const std::string text = frozen_edition(file, library), before = file_text(file);
  const bool is_frozen = before.size() > hand_written_part(before).size();
  if (is_frozen && before != text)
    throw Error(
        "edition {} is frozen and would become another one: an edition stays as it is. One that nobody has used is frozen "
        "again when its frozen part is removed from {}",
        name, file.string());
  if (!is_frozen) write_file(replaced_file(file), text);
  fmt::print("{}  {}\n", file.string(), read_edition(name).hash);
  return 0;
}

int edition(const EditionCommand& options) {
  if (options.name.empty()) {
    if (options.freeze) throw Error("--freeze needs the name of an edition: {}", joined(edition_names(), ", "));
    return print_all(options);
  }
  if (options.freeze) return freeze(options.name);
  const Described found = described(options.name);
  if (options.json)
    fmt::print("{}\n", json_text(json_of(found), 2));
  else
    print(found, options.width.columns());
  return found.differences.empty() ? 0 : 1;
}

}  // namespace

void add_edition(Program& program) {
  auto [command, options] = program.line.command<EditionCommand>(
      "edition", "Suites that stay as they are: which there are, and whether this program gives one",
      [](const EditionCommand& read) { return edition(read); });
  command.option("name", &options.name, "Which one; all by default");
  command.flag("--json", &options.json, "As JSON");
  command.flag("--freeze", &options.freeze, "Write hashes, versions and defaults of today into its file");
  add_width_options(command, options.width);
}

}  // namespace gnomon::app
