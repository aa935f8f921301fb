#pragma once
#include "measure/scratch_folder.h"
#include "measure/worker/worker_process.h"

namespace gnomon {

// Code of a technique from outside, and `supports` of any technique, runs in a worker, once, never in the program itself. A
// failure there costs that technique.

/// Registers the entries of a plugin as a worker describes them. Throws Error when it cannot be loaded, is no plugin, was built
/// for another contract, has ids that are taken, or ends or hangs the worker while it is loaded. An object of it that cannot be
/// made or described costs its entry alone: TechniqueEntry::broken.
void register_plugin(const std::string& path);

/// Queries what techniques support before anything runs.
class SupportQuestions {
 public:
  SupportQuestions(WorkerOptions worker, double timeout_seconds)
      : worker_(std::move(worker)), timeout_seconds_(timeout_seconds) {}
  /// By light of the scene, under its first view. Throws WorkerFailure when the technique, with default settings, does not
  /// answer.
  const std::vector<Support>& ask(const std::string& reference, const Scene& scene, const std::string& technique);

 private:
  WorkerOptions worker_;
  double timeout_seconds_;
  std::optional<ScratchFolder> folder_;       ///< nothing before the first question
  std::unique_ptr<WorkerProcess> process_;    ///< null before the first question, and after one that was not answered
  std::map<std::string, std::string> files_;  ///< of scenes, by reference
  struct Answer {
    std::vector<Support> supports;       ///< by light
    std::optional<std::string> failure;  ///< why there is no answer
  };
  std::map<std::pair<std::string, std::string>, Answer> answers_;  ///< by scene and technique
};

}  // namespace gnomon
