#include "app/suite_options.h"

#include <gnomon/error.h>

#include "app/app.h"
#include "measure/scene/time_reference.h"

namespace gnomon::app {

namespace {

constexpr const char* picture_words[] = {"all", "masks", "none"};  // in the order of Suite::Pictures

/// The animation of the stills that the options request; empty: the first of each scene, or the suite's.
std::string animation_of_stills(const SuiteOptions& options) {
  if (options.times.empty()) return {};
  if (options.animations.size() > 1)
    throw Error("--time {} is of stills of one animation; --animation names {}: {}", options.times.front(),
                options.animations.size(), joined(options.animations, ", "));
  return options.animations.empty() ? "" : options.animations.front();
}

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
  group.scenes = at_times(options.scenes, animation_of_stills(options), options.times);
  for (const std::string& technique : options.techniques)
    for (Contender& contender : parse_contenders(technique)) group.contenders.push_back(std::move(contender));
  return suite;
}

/// A suite's scenes at the times of the options, each once, in place of the suite's own times and of rows that follow its
/// animations. Their animations stay unless the options name one.
void put_times(SuiteGroup& group, const SuiteOptions& options) {
  std::string animation = animation_of_stills(options);
  if (animation.empty() && !group.animations.empty()) {
    if (group.animations.size() > 1 || group.animations.front() == every_animation)
      throw Error("--time {} is of stills of one animation, and the suite has {}: --animation names the one",
                  options.times.front(), joined(group.animations, ", "));
    animation = group.animations.front();
  }
  std::vector<std::string> stills;
  for (const std::string& scene : group.scenes) {
    const TimedReference timed = split_time(scene);
    const std::string own = timed.at ? timed.at->animation : "";
    for (std::string& still : at_times({timed.scene}, animation.empty() ? own : animation, options.times))
      if (std::ranges::find(stills, still) == stills.end()) stills.push_back(std::move(still));
  }
  group.scenes = std::move(stills);
  group.animations.clear();
  group.times = {};
}

/// The option of frames that is given, as the user wrote it; empty without one.
std::string given_frames(const SuiteOptions& options) {
  if (options.frames) return fmt::format("--frames {}", options.frames);
  if (options.frame_rate) return fmt::format("--frame-rate {}", *options.frame_rate);
  return options.start ? fmt::format("--start {}", *options.start) : "";
}

/// Paths and animations of the options, and which frames rows on these have.
void put_motion(Suite& suite, const SuiteOptions& options) {
  const std::string frames = given_frames(options);
  if (!frames.empty() && !options.times.empty())
    throw Error("{} is for rows that follow an animation, and --time {} is of stills: give one of both", frames,
                options.times.front());
  bool follows = false;
  for (SuiteGroup& group : suite.groups) {
    const bool names_animations = options.times.empty() && !options.animations.empty();
    if (names_animations || !options.paths.empty()) {
      group.paths = options.paths;
      group.animations = names_animations ? options.animations : std::vector<std::string>();
    }
    if (group.animations.empty()) continue;
    follows = true;
    if (options.frames) group.times.frames = options.frames;
    if (options.frame_rate) group.times.frame_rate = options.frame_rate;
    if (options.start) group.times.start = *options.start + 0.0;  // minus zero is zero
  }
  if (!frames.empty() && !follows)
    throw Error("{} is for rows that follow an animation, and none does: name one by --animation, not by --path", frames);
}

}  // namespace

void put_pictures_and_timeout(Suite& suite, const SuiteOptions& options) {
  if (!options.pictures.empty())
    suite.pictures =
        static_cast<Suite::Pictures>(std::ranges::find(picture_words, options.pictures) - std::begin(picture_words));
  if (options.timeout) suite.timeout = *options.timeout;
}

Suite make_suite(const SuiteOptions& options, const std::string& command) {
  Suite suite = chosen_suite(options, command);
  for (SuiteGroup& group : suite.groups) {
    if (!options.lights.empty()) group.lights = options.lights;
    if (!options.views.empty()) group.views = options.views;
    if (!options.suite.empty() && !options.times.empty()) put_times(group, options);
    if (options.global_samples) group.global_samples = options.global_samples;
  }
  put_motion(suite, options);
  if (!options.size.empty()) {
    std::tie(suite.width, suite.height) = parse_size(options.size, "--size");
    for (SuiteGroup& group : suite.groups) group.sizes.clear();
  }
  if (!options.truth.empty()) suite.truth = parse_truth(options.truth);
  if (!options.truth_over.empty())
    suite.truth_over =
        static_cast<TruthOver>(std::ranges::find(truth_over_names, options.truth_over) - std::begin(truth_over_names));
  put_pictures_and_timeout(suite, options);
  if (options.repetitions) suite.repetitions = options.repetitions;
  if (options.warmups) suite.warmups = options.warmups;
  if (options.processes) suite.processes = options.processes;
  if (options.interval) suite.interval = *options.interval;
  if (options.budget) suite.budget = *options.budget;
  if (options.budget && suite.interval == 0)
    throw Error("--budget = {} is for the processes that --interval requests: give that too, or neither", *options.budget);
  return suite;
}

void add_suite_options(Command& command, SuiteOptions& options, const std::string& when, CLI::Option* needed) {
  const auto add = [&](const char* name, OptionTarget target, const std::string& sentence, OptionRules rules = {}) {
    rules.needs = needed;
    return command.option(name, target, when + sentence, rules);
  };
  add("--scene", &options.scenes, "Scene ids or files, instead of a suite");
  add("--time", &options.times,
      "Seconds at which scenes that move are shown, each a still; the suite's by default, or as files have them",
      {.check = not_negative(), .delimiter = ','});
  add("--animation", &options.animations,
      "Animations of the scenes, * for each: rows follow them frame by frame. With --time: the one of the stills, each scene's "
      "first by default",
      {.check = not_empty(), .delimiter = ','});
  add("--frames", &options.frames, "Frames of rows that follow an animation; up to its last key by default",
      {.check = whole_in(least_frames, most_frames)});
  add("--frame-rate", &options.frame_rate, "Their frames per second; 60 by default", {.check = above_zero()});
  add("--start", &options.start, "Seconds of the animation at their first frame; 0 by default", {.check = not_negative()});
  add("--path", &options.paths,
      "Paths of camera or light that rows follow: of the scene, or camera_slide, light_slide, camera_jump, light_jump; the "
      "suite's by default",
      {.check = not_empty(), .delimiter = ','});
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
