#include "app/edition_options.h"

#include <gnomon/error.h>

#include "measure/counted.h"
#include "measure/notice.h"
#include "measure/printable.h"

namespace gnomon::app {

namespace {

/// Throws Error on an option that changes places, pixels, truth or repetitions: what an edition has frozen.
void require_frozen(const std::string& edition, const SuiteOptions& options) {
  const std::pair<const char*, bool> refused[] = {{"--scene", !options.scenes.empty()},
                                                  {"--light", !options.lights.empty()},
                                                  {"--view", !options.views.empty()},
                                                  {"--path", !options.paths.empty()},
                                                  {"--animation", !options.animations.empty()},
                                                  {"--time", !options.times.empty()},
                                                  {"--frames", options.frames != 0},
                                                  {"--frame-rate", options.frame_rate.has_value()},
                                                  {"--start", options.start.has_value()},
                                                  {"--size", !options.size.empty()},
                                                  {"--truth", !options.truth.empty()},
                                                  {"--truth-over", !options.truth_over.empty()},
                                                  {"--global-samples", options.global_samples != 0},
                                                  {"--processes", options.processes != 0},
                                                  {"--repetitions", options.repetitions != 0},
                                                  {"--warmups", options.warmups != 0},
                                                  {"--interval", options.interval.has_value()},
                                                  {"--budget", options.budget.has_value()}};
  for (const auto& [name, is_given] : refused)
    if (is_given)
      throw Error(
          "{} changes rows of edition {}, which stay as they are; a run of its file, bench/editions/{}.toml, takes it "
          "and is of no edition",
          name, edition, edition);
  if (!options.suite.empty())
    throw Error("--edition {} is a suite of its own: run takes it or suite {}, not both", edition, options.suite);
}

std::vector<Contender> contenders_of(const SuiteOptions& options) {
  std::vector<Contender> contenders;
  for (const std::string& technique : options.techniques)
    for (Contender& contender : parse_contenders(technique)) contenders.push_back(std::move(contender));
  return contenders;
}

}  // namespace

std::pair<Suite, RunEdition> edition_to_run(const EditionOptions& chosen, const SuiteOptions& options, SceneLibrary& library) {
  require_frozen(chosen.edition, options);
  const Division division = chosen.division.empty() ? Division::default_settings : parse_division(chosen.division);
  const Edition edition = read_edition(chosen.edition);
  const std::vector<Contender> contenders = contenders_of(options);
  require_division(edition, division, contenders);
  const std::vector<std::string> differences = edition_differences(edition, library);
  for (const std::string& line : differences) print_notice("edition {}: {}\n", edition.name, printable(line, true));
  if (!differences.empty())
    throw Error("this program does not give edition {} ({}): {}; nothing was run", edition.name, edition.hash,
                counted(differences.size(), "difference{s}"));
  Suite suite = contenders.empty() ? edition.suite : with_contenders(edition, contenders);
  put_pictures_and_timeout(suite, options);
  return {std::move(suite), RunEdition{edition.name, edition.hash, name(division)}};
}

void add_edition_options(Command& command, EditionOptions& options) {
  CLI::Option* const edition = command.option(
      "--edition", &options.edition,
      "Rows of an edition as it was frozen, instead of a suite; with --technique those techniques at its places (docs/editions.md)",
      {.check = not_empty()});
  command.option("--division", &options.division,
                 "Of an edition: default, techniques as they are; tuned, settings found on training scenes alone; open, any",
                 {.check = one_of({std::begin(division_names), std::end(division_names)}), .needs = edition});
}

}  // namespace gnomon::app
