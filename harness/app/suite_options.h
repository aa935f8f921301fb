#pragma once
#include "app/command_line.h"
#include "measure/run/suite.h"

namespace gnomon::app {

/// Options that `run` and `compare --live` share: a suite, or scenes and techniques, and what to change of it for this run.
struct SuiteOptions {
  std::string suite, size, truth, truth_over, filter, pictures;
  std::vector<std::string> scenes, techniques, lights, views, paths;
  /// That rows follow frame by frame; with times the one of their stills.
  std::vector<std::string> animations;
  std::vector<double> times;                                            ///< of the scenes; none: as the suite says
  int frames = 0;                                                       ///< of these rows; 0: as the suite says
  std::optional<double> frame_rate, start;                              ///< of them, too
  int processes = 0, repetitions = 0, warmups = 0, global_samples = 0;  ///< 0: as the suite says
  int threads = 0;                                                      ///< 0: all cores
  std::optional<double> timeout, interval, budget;
};

/// Adds what both commands take; `when`, "With --live: ", begins the help of each. Where they require another option,
/// `needed` is that one.
void add_suite_options(Command& command, SuiteOptions& options, const std::string& when = "", CLI::Option* needed = nullptr);

/// The suite with what the options change of it; a light, a view, a path, an animation, a time, a size or a truth that is given
/// replaces those of all its groups. Throws Error when the options do not go together, and, with `command` at its beginning,
/// when they name neither a suite nor scenes and techniques.
Suite make_suite(const SuiteOptions& options, const std::string& command);

/// What rows leave and how long their steps may take, which changes no number of a row.
void put_pictures_and_timeout(Suite& suite, const SuiteOptions& options);

}  // namespace gnomon::app
