// gnomon tune --keep: errors and bytes of every setting, without times, and so without a process for each.
#include <gnomon/registry.h>

#include "app/app.h"
#include "app/tune_run.h"
#include "measure/run/jobs.h"
#include "measure/scene/blob.h"

namespace gnomon::app {

namespace {

/// All settings of the grid, in an order in which what spoils early stages changes the least often.
std::vector<TuneSetting> by_stages(const TuneSpace& space) {
  const std::unique_ptr<Technique> technique = registry().technique(space.technique).make();
  technique->apply(space.fixed);
  std::vector<std::pair<Stage, std::size_t>> order;
  for (std::size_t k = 0; k < space.parameters.size(); ++k)
    order.emplace_back(technique->parameter(space.parameters[k].name).spoils(), k);
  std::ranges::sort(order);
  std::vector<TuneSetting> settings = space.grid.all();
  std::ranges::stable_sort(settings, {}, [&](const TuneSetting& setting) {
    TuneSetting key;
    for (const auto& [stage, k] : order) key.push_back(setting[k]);
    return key;
  });
  return settings;
}

}  // namespace

void keep_grid(TunePlan plan, SceneLibrary& library, const std::filesystem::path& file) {
  if (plan.spaces.size() > 1) throw Error("--keep takes one technique, for its table has a column for each parameter");
  KeptGrid kept{.name = file.string(), .space = plan.spaces.front()};
  Suite& suite = plan.run.suite;
  suite.groups.front().contenders.push_back({kept.space.technique, kept.space.settings(kept.space.grid.base()), "", false});
  const std::vector<Job> places = expand_jobs(suite, library, plan.run.worker).jobs;
  const std::vector<TuneSetting> settings = by_stages(kept.space);
  for (const TuneSetting& setting : settings) kept.numbers[setting].resize(places.size());
  TuneProbe probe(plan, kept.space, library);
  for (std::size_t k = 0; k < places.size(); ++k) {
    const Job& place = places[k];
    kept.places.push_back(fmt::format("{} {} {}", place.scene, place.light, place.view));
    for (const TuneSetting& setting : settings)
      if (const auto answer = probe.ask(kept.space.settings(setting), place)) kept.numbers[setting][k] = answer->numbers;
  }
  write_file(file, kept_grid_text(kept));
  fmt::print("{}  {:.0f} settings of {} at {} places: {:.0f} evaluations\n", file.string(), kept.space.grid.count(),
             kept.space.technique, places.size(), kept.possible());
}

}  // namespace gnomon::app
