#pragma once
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "measure/scratch_folder.h"
#include "measure/worker/worker_process.h"

namespace gnomon {

// Nothing of a technique from outside, and no `supports` of any, runs in the program itself: it is asked in a worker, once, and
// what goes wrong there costs that technique.

/// Registers what a plugin has, by what a worker tells of it. Throws Error when it cannot be loaded, is none, was built for
/// another contract, has ids that are taken, or ends or hangs the worker while it is loaded. An object of it that cannot be
/// made or does not tell of itself costs its entry alone: TechniqueEntry::broken.
void register_plugin(const std::string& path);

/// Asks what techniques support before anything runs.
class SupportQuestions {
 public:
  SupportQuestions(WorkerOptions worker, double timeout_seconds);
  /// By light of the scene, under its first view. Throws WorkerFailure when the technique, with default settings, does not
  /// answer.
  const std::vector<Support>& ask(const std::string& reference, const Scene& scene, const std::string& technique);

 private:
  WorkerOptions worker_;
  double timeout_seconds_;
  std::optional<ScratchFolder> folder_;       ///< nothing before the first question
  std::unique_ptr<WorkerProcess> process_;    ///< null before the first question, and after one that was not answered
  std::map<std::string, std::string> files_;  ///< of scenes, by reference
  std::map<std::pair<std::string, std::string>, std::vector<Support>> known_;  ///< by scene and technique
  std::map<std::pair<std::string, std::string>, std::string> failures_;
};

}  // namespace gnomon
