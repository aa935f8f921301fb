#include "measure/run/rows.h"

#include <chrono>
#include <map>
#include <optional>

#include "measure/paths.h"

namespace gnomon {

void run_rows(std::vector<PendingRow> rows, const RowsPlan& plan, Progress& progress) {
  using Clock = std::chrono::steady_clock;
  std::size_t rows_left = rows.size();
  double budget = plan.suite.budget;
  progress.expect(static_cast<double>(rows_left) * plan.suite.processes);
  std::vector<std::string> scenes;
  std::map<std::string, std::vector<PendingRow>> by_scene;
  for (PendingRow& row : rows) {
    const std::string scene = row.job.scene;
    if (!by_scene.contains(scene)) scenes.push_back(scene);
    by_scene[scene].push_back(std::move(row));
  }
  for (const std::string& scene : scenes) {
    const SceneLibrary::Entry& entry = plan.library.get(scene);
    std::optional<SceneRun> run;
    if (entry.scene) run.emplace(scene, *entry.scene, plan.suite, cache_root() / "frames", plan.scratch);
    for (std::vector<PendingRow>& batch : split(std::move(by_scene[scene]))) {
      const std::vector<Json> contexts = plan.contexts();
      for (PendingRow& row : batch) {
        row.record = start_record(row.job, plan.suite, run ? &*entry.scene : nullptr, contexts[row.side]);
        if (run) {
          row.record.context["scene_hash"] = run->frames.scene_hash();
          row.record.context["frames"] = frame_version();
        } else {
          row.record.status = Status::unsupported;
          row.record.reason = entry.missing;
          progress.advance(plan.suite.processes);
        }
      }
      double opening = 0;
      if (run) {
        const auto opened = Clock::now();
        const double allowance = budget * static_cast<double>(batch.size()) / static_cast<double>(rows_left);
        budget -= run_batch(*run, plan.sides, batch, progress, allowance);
        opening = share_overhead(batch, std::chrono::duration<double>(Clock::now() - opened).count());
      }
      rows_left -= batch.size();
      plan.done({batch, run.has_value(), opening});
    }
    plan.library.forget(scene);
  }
}

}  // namespace gnomon
