#include "app/suite_options.h"

#include <gnomon/error.h>

#include "app/app.h"
#include "measure/scene/time_reference.h"

namespace gnomon::app {

namespace {

constexpr const char* picture_words[] = {"all", "masks", "none"};  // in the order of Suite::Pictures

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
  SuiteGroup& group = suite.groups.emplace_back();
  group.scenes = at_times(options.scenes, options.animation, options.times);
  for (const std::string& technique : options.techniques)
    for (Contender& contender : parse_contenders(technique)) group.contenders.push_back(std::move(contender));
  return suite;
}

/// A suite's scenes at the times of the options, each once, in place of the suite's own times. Their animations stay unless the
/// options name one.
std::vector<std::string> retimed(const std::vector<std::string>& scenes, const SuiteOptions& options) {
  std::vector<std::string> stills;
  for (const std::string& scene : scenes) {
    const TimedReference timed = split_time(scene);
    const std::string own = timed.at ? timed.at->animation : "";
    for (std::string& still : at_times({timed.scene}, options.animation.empty() ? own : options.animation, options.times))
      if (std::ranges::find(stills, still) == stills.end()) stills.push_back(std::move(still));
  }
  return stills;
}

}  // namespace

Suite make_suite(const SuiteOptions& options, const std::string& command) {
  Suite suite = chosen_suite(options, command);
  for (SuiteGroup& group : suite.groups) {
    if (!options.lights.empty()) group.lights = options.lights;
    if (!options.views.empty()) group.views = options.views;
    if (!options.suite.empty() && !options.times.empty()) group.scenes = retimed(group.scenes, options);
    if (options.global_samples) group.global_samples = options.global_samples;
  }
  if (!options.size.empty()) {
    std::tie(suite.width, suite.height) = parse_size(options.size, "--size");
    for (SuiteGroup& group : suite.groups) group.sizes.clear();
  }
  if (!options.truth.empty()) suite.truth = parse_truth(options.truth);
  if (!options.pictures.empty())
    suite.pictures =
        static_cast<Suite::Pictures>(std::ranges::find(picture_words, options.pictures) - std::begin(picture_words));
  if (options.repetitions) suite.repetitions = options.repetitions;
  if (options.warmups) suite.warmups = options.warmups;
  if (options.processes) suite.processes = options.processes;
  if (options.timeout) suite.timeout = *options.timeout;
  if (options.interval) suite.interval = *options.interval;
  if (options.budget) suite.budget = *options.budget;
  if (options.budget && suite.interval == 0)
    throw Error("--budget = {} is for the processes that --interval asks for: give that too, or neither", *options.budget);
  return suite;
}

void add_suite_options(Command& command, SuiteOptions& options, const std::string& when, CLI::Option* needed) {
  const auto add = [&](const char* name, OptionTarget target, const std::string& sentence, OptionRules rules = {}) {
    rules.needs = needed;
    return command.option(name, target, when + sentence, rules);
  };
  add("--scene", &options.scenes, "Scene ids or files, instead of a suite");
  const auto time =
      add("--time", &options.times,
          "Seconds at which scenes that move are shown, each a still; the suite's by default, or as files have them",
          {.check = not_negative(), .delimiter = ','});
  command.option("--animation", &options.animation, when + "With --time: animation of the scenes; each one's first by default",
                 {.check = not_empty(), .needs = time});
  add("--technique", &options.techniques, "ID:param=value,...; {a,b} sweeps a value", {.delimiter = ';'});
  add("--light", &options.lights, "Light names; the suite's, or all of each scene, by default", {.delimiter = ','});
  add("--view", &options.views, "View names, * in one stands for any letters; the suite's, or each scene's first, by default",
      {.check = not_empty(), .delimiter = ','});
  add("--filter", &options.filter, "Only rows whose 'SCENE LIGHT [VIEW] [PATH] TECHNIQUE:SETTINGS' matches this expression");
  add("--size", &options.size, "Picture size in pixels, WxH", {.check = not_empty()});
  add("--pictures", &options.pictures, "all: each row leaves its mask and two pictures; masks; none: numbers alone",
      {.check = one_of({std::begin(picture_words), std::end(picture_words)})});
  add("--processes", &options.processes, needed ? "Fresh processes per contender and program" : "Fresh processes per contender",
      {.check = whole_in(1, 1000)});
  add("--repetitions", &options.repetitions, "Timed repetitions per process", {.check = whole_in(1, 1000)});
  add("--warmups", &options.warmups, "Untimed repetitions before the timed ones; fewer where they take 0.3 s",
      {.check = whole_in(1, 100)});
  add("--interval", &options.interval, "More processes until intervals are this share of the time wide",
      {.check = number_in(0.001, 10)});
  add("--budget", &options.budget, "Seconds that those processes may take", {.check = seconds()});
  add("--global-samples", &options.global_samples,
      "Light paths of a pixel of the reference that global pictures are compared with (radiosity_error); not compared by "
      "default",
      {.check = whole_in(least_global_samples, most_global_samples)});
  add("--threads", &options.threads, "Pin workers to this many cores; all by default");
  add("--timeout", &options.timeout, "Seconds that one step of a worker may take", {.check = seconds()});
}

}  // namespace gnomon::app
