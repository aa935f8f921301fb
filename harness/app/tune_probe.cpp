#include "app/tune_probe.h"

#include <gnomon/registry.h>

#include <algorithm>

#include "measure/paths.h"
#include "measure/run/jobs.h"
#include "measure/score/score.h"

namespace gnomon::app {

TuneProbe::TuneProbe(const TunePlan& plan, const TuneSpace& space, SceneLibrary& library)
    : plan_(plan),
      space_(space),
      library_(library),
      scratch_(ScratchFolder::in(std::filesystem::temp_directory_path(), "gnomon-tune")) {}

TuneProbe::Answer TuneProbe::ask(const std::string& settings, const Job& place) {
  if (scene_ != place.scene || !on_scene_) {
    on_scene_.reset();
    const SceneLibrary::Entry& entry = library_.get(place.scene);
    if (!entry.scene) throw Error("{}", entry.missing);
    scene_ = place.scene;
    const SceneRun::Options options{.cache = cache_root() / "frames",
                                    .scratch = scratch_.path(),
                                    .target = plan_.run.suite.target,
                                    .timeout = plan_.run.suite.timeout};
    WorkerOptions workers = plan_.run.worker;
    workers.keeps_shaders = true;  // no setup is timed
    on_scene_ = std::make_unique<OnScene>(*entry.scene, options, space_.technique, settings, workers);
  }
  SceneRun& run = on_scene_->run;
  ContenderWorker& worker = on_scene_->worker;
  const About& about = registry().technique(space_.technique).about;
  const RowFrame frame = first_frame(place, run.scene);
  worker.client().set(settings);
  if (const Support support = worker.go(frame, plan_.run.suite.truth, about.remembers); !support) return {.support = support};
  constexpr int with_relight = static_cast<int>(Stage::relight) + 1;
  if (worker.client().fresh_count() < with_relight) times_.relight_ms = worker.client().time(Stage::relight);
  times_.resolve_ms = worker.client().time(Stage::resolve);
  Record record;
  MeasuredRow row;
  std::vector<gnomon::Answer> answers = worker.answers(&record);
  const std::vector<Light> lights = run.lights(frame);
  for (std::size_t k = 0; k < answers.size(); ++k) {
    answers[k].estimates = about.estimates;
    row.lights.push_back({lights[k], std::move(answers[k])});
  }
  put_together(row, run.scene);
  const Evidence evidence = row.evidence(run.scene);
  const Scoring scoring(evidence);
  return {.numbers = {measure_metric(scoring, "error").value_or(0), static_cast<double>(record.bytes.value_or(0))},
          .constant_error = measure_metric(scoring, "constant_error").value_or(1)};
}

TuneProbe::Times TuneProbe::times() {
  times_.resolve_ms = std::min(times_.resolve_ms, on_scene_->worker.client().time(Stage::resolve));
  return times_;
}

TuneProbe::Times TuneProbe::times_again() {
  times_.relight_ms = std::min(times_.relight_ms, on_scene_->worker.client().time(Stage::relight));
  return times();
}

}  // namespace gnomon::app
