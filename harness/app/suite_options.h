#pragma once
#include <optional>
#include <string>
#include <vector>

#include "measure/run/suite.h"

namespace gnomon::app {

/// What `run` and `compare --live` are told alike: a suite, or scenes and techniques, and what to change of it for this run.
struct SuiteOptions {
  std::string suite, size, truth, filter;
  std::vector<std::string> scenes, techniques, lights;
  int repetitions = 0, processes = 0, threads = 0;  ///< 0: as the suite says; of threads, all
  std::optional<double> timeout, interval, budget;
};

/// The suite that is asked for. Options come before what the suite says, also of its groups. Throws Error, which begins with
/// `command`, when it is neither a suite nor scenes and techniques.
Suite make_suite(const SuiteOptions& options, const std::string& command);

}  // namespace gnomon::app
