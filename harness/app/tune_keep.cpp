// gnomon tune --keep: errors and bytes of every setting, without times, and so without a process for each.
#include "app/app.h"
#include "app/tune_run.h"
#include "measure/counted.h"
#include "measure/run/jobs.h"
#include "measure/scene/blob.h"

namespace gnomon::app {

void keep_grid(TunePlan plan, SceneLibrary& library, const std::filesystem::path& file) {
  if (plan.spaces.size() > 1) throw Error("--keep takes one technique, for its table has a column for each parameter");
  KeptGrid kept{.name = file.string(), .space = plan.spaces.front()};
  Suite& suite = plan.run.suite;
  suite.groups.front().contenders.push_back({kept.space.technique, kept.space.settings(kept.space.grid.base()), "", false});
  const std::vector<Job> places = expand_jobs(suite, library, plan.run.worker).jobs;
  TuneProbe probe(plan, kept.space, library);
  std::vector<TuneQuestion> questions;
  for (const TuneSetting& setting : kept.space.grid.all()) {
    questions.push_back({setting});
    kept.numbers[setting].resize(places.size());
  }
  put_by_stages(kept.space, questions);
  for (std::size_t k = 0; k < places.size(); ++k) {
    const Job& place = places[k];
    kept.places.push_back(fmt::format("{} {} {}", place.scene, place.light, place.view));
    for (const TuneQuestion& question : questions)
      if (const TuneProbe::Answer answer = probe.ask(kept.space.settings(question.setting), place); answer.support)
        kept.numbers[question.setting][k] = answer.numbers;
  }
  write_file(file, kept_grid_text(kept));
  fmt::print("{}  {:.0f} settings of {} at {}: {:.0f} evaluations\n", file.string(), kept.space.grid.count(),
             kept.space.technique, counted(places.size(), "place{s}"), kept.possible());
}

}  // namespace gnomon::app
