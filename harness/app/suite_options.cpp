#include "app/suite_options.h"

#include <gnomon/error.h>

#include "app/app.h"

namespace gnomon::app {

namespace {

Suite chosen_suite(const SuiteOptions& options, const std::string& command) {
  if (!options.suite.empty()) {
    if (!options.scenes.empty() || !options.techniques.empty())
      throw Error("{} takes a suite or --scene and --technique, not both; --filter picks rows of a suite", command);
    return read_suite(options.suite);
  }
  if (options.scenes.empty() || options.techniques.empty())
    throw Error("{} needs a suite ({}), or --scene and --technique", command, joined(suite_names(), ", "));
  Suite suite;
  suite.name = "adhoc";
  SuiteGroup group{options.scenes, {}, {}, {}};
  for (const std::string& technique : options.techniques)
    for (Contender& contender : parse_contenders(technique)) group.contenders.push_back(std::move(contender));
  suite.groups = {group};
  return suite;
}

}  // namespace

Suite make_suite(const SuiteOptions& options, const std::string& command) {
  Suite suite = chosen_suite(options, command);
  for (SuiteGroup& group : suite.groups)
    if (!options.lights.empty()) group.lights = options.lights;
  if (!options.size.empty()) {
    std::tie(suite.width, suite.height) = parse_size(options.size, "--size");
    for (SuiteGroup& group : suite.groups) group.sizes.clear();
  }
  if (!options.truth.empty()) suite.truth = parse_truth(options.truth);
  if (options.repetitions) suite.repetitions = options.repetitions;
  if (options.processes) suite.processes = options.processes;
  if (options.timeout) suite.timeout = *options.timeout;
  if (options.interval) suite.interval = *options.interval;
  if (options.budget) suite.budget = *options.budget;
  if (options.budget && suite.interval == 0)
    throw Error("--budget = {} is for the processes that --interval asks for: give that too, or neither", *options.budget);
  return suite;
}

}  // namespace gnomon::app
