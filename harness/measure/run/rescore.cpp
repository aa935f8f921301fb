#include "measure/run/rescore.h"

#include <gnomon/error.h>

#include <algorithm>
#include <map>
#include <memory>

#include "measure/paths.h"
#include "measure/picture/picture.h"
#include "measure/run/frame_worker.h"
#include "measure/run/jobs.h"
#include "measure/run/kept_row.h"
#include "measure/scene/load.h"
#include "measure/score/score.h"

namespace gnomon {

namespace fs = std::filesystem;

namespace {

/// A scene of today, or why there is none.
struct SceneToday {
  std::optional<Scene> scene;
  std::unique_ptr<FrameStore> frames;
  std::string missing;

  SceneToday(const std::string& reference, Progress& progress) {
    try {
      scene = load_scene(reference);
      frames = std::make_unique<FrameStore>(*scene, cache_root() / "frames",
                                            std::make_unique<FrameWorker>(fs::path(), "", shown_on(progress, reference)));
    } catch (const Error& problem) {
      // A scene that is not fetched, or whose file moved since, costs its own rows only.
      missing = problem.what();
    }
  }
};

std::string full_title(const Record& record) { return fmt::format("{} ({})", title(record), record.job); }

/// Rewrites what one record says of its mask.
class Row {
 public:
  Row(Record& record, const fs::path& dir, SceneToday& today) : record_(record), today_(today) {
    if (!record.mask) throw Error("the row has no mask");
    file_ = dir / *record.mask;
    if (!fs::exists(file_)) throw Error("its mask {} is not there", file_.string());
    channels_ = image_files().exr_channels(file_);
  }

  /// Why the row keeps what it has; empty when it can be measured anew.
  std::string obstacle() {
    if (!today_.scene) return today_.missing;
    const std::vector<std::string> names = light_names(record_);
    for (const std::string& name : names)
      if (const Light* light = find_named(today_.scene->lights, name)) lights_.push_back(light);
    view_ = find_named(today_.scene->views, record_.view);
    const bool has_hash = record_.context.contains("scene_hash"), has_lights = lights_.size() == names.size();
    if (has_hash && has_lights && !today_.frames->is_scene(record_.context["scene_hash"], names))
      return "the scene is not the one that was measured";
    if (!has_lights) return fmt::format("the scene has no light {} any more", record_.light);
    if (!view_) return fmt::format("the scene has no view {} any more", record_.view);
    // An old row of a light that the reference does not know; reading withdraws those that say what kind of light it was.
    for (const Light* light : lights_)
      if (const Support support = reference_support(*today_.scene, *light, *view_); !support) {
        withdraw(record_, support.why());
        return {};
      }
    // Without a hash the classes vouch for the scene: they depend on scene, light, view and truth alone.
    if (!has_hash && !record_.classes.empty() && lights_.size() == 1 &&
        class_counts(read_row(record_.truth, "V").lights[0].answer.reference.classes) != record_.classes)
      return "the scene is not the one that was measured: its pixel classes differ";
    return {};
  }

  /// Answers why the row lost its causes; empty when it did not.
  std::string measure() {
    if (record_.status != Status::ok) return {};  // withdrawn
    const Truth truth = record_.truth, other = truth == Truth::shape ? Truth::mesh : Truth::shape;
    MeasuredRow row = read_row(truth, "V");
    const std::string lost = take_causes(row);
    score(truth, row);
    if (!today_.scene->has_curved_shapes())
      record_.metrics[other] = record_.metrics[truth];
    else if (has(lights_.front()->name + "." + std::string(name(other))))
      score(other, read_row(other, name(other)));
    return lost;
  }

 private:
  bool has(const std::string& channel) const { return std::ranges::find(channels_, channel) != channels_.end(); }

  /// The row's masks in the channels LIGHT.WHAT.
  MeasuredRow read_row(Truth truth, std::string_view what) const {
    return kept_row(record_, file_, what, kept_place(record_, *today_.scene, truth), *today_.frames);
  }

  /// Puts metrics and classes of the row, and of each of several lights, into the record.
  void score(Truth truth, MeasuredRow row) {
    put_together(row, *today_.scene);
    const Evidence evidence = row.evidence(*today_.scene);
    // Masks alone are kept: what was found of the picture of all light stays.
    const std::optional<double> of_all_light = record_.metric(truth, "radiosity_error");
    record_.metrics[truth] = measure_metrics(Scoring(evidence));
    record_.metrics[truth]["radiosity_error"] = of_all_light;
    if (truth != record_.truth) return;
    record_.classes = class_counts(evidence.classes);
    if (row.together && record_.cause_errors) record_.cause_errors = cause_errors(evidence);
    for (std::size_t k = 0; k < record_.lights.size(); ++k) {
      const Evidence one = row.lights[k].answer.evidence(*today_.scene, *lights_[k]);
      record_.lights[k].metrics = measure_metrics(Scoring(one));
      record_.lights[k].classes = class_counts(one.classes);
    }
  }

  /// Where a record keeps the causes under one light.
  struct KnownCauses {
    std::optional<std::map<std::string, std::uint64_t>>& causes;
    std::optional<std::map<std::string, double>>& errors;
  };
  KnownCauses causes_of(std::size_t light) {
    if (record_.lights.empty()) return {record_.causes, record_.cause_errors};
    return {record_.lights[light].causes, record_.lights[light].cause_errors};
  }

  /// Answers why the row lost its causes.
  std::string take_causes(MeasuredRow& row) {
    std::string obstacle;
    for (std::size_t k = 0; k < row.lights.size() && obstacle.empty(); ++k) obstacle = take_causes(row.lights[k].answer, k);
    if (record_.lights.empty()) return obstacle;
    record_.causes.reset();
    if (!obstacle.empty()) record_.cause_errors.reset();
    for (std::size_t k = 0; k < row.lights.size(); ++k) {
      Record::LightFacts& light = record_.lights[k];
      if (!obstacle.empty()) {
        light.causes.reset();
        light.cause_errors.reset();
        row.lights[k].answer.causes.clear();
      } else if (light.causes) {
        if (!record_.causes) record_.causes.emplace();
        for (const auto& [cause, pixels] : *light.causes) (*record_.causes)[cause] += pixels;
      }
    }
    return obstacle;
  }

  /// The causes of the mask go into answer and record, unless they belong to other frames: then neither has any. Without a
  /// channel the record's own counts stay if they can.
  std::string take_causes(Answer& answer, std::size_t number) {
    const Light& light = *lights_[number];
    KnownCauses known = causes_of(number);
    std::vector<Cause> causes;
    bool fit = true;
    if (has(light.name + ".cause")) {
      causes = kept_causes(record_, file_, number);
      fit = causes_fit(answer, causes);
    } else if (known.causes) {
      const Evidence evidence = answer.evidence(*today_.scene, light);
      std::uint64_t wrong = 0, with_cause = 0;
      for (std::size_t i = 0; i < answer.mask.size(); ++i) wrong += evidence.wants_cause(i);
      for (const auto& [cause, pixels] : *known.causes) with_cause += pixels;
      fit = wrong == with_cause;
    } else {
      return {};
    }
    std::string obstacle = causes_obstacle(record_, fit);
    if (!obstacle.empty()) {
      known.causes.reset();
      known.errors.reset();
    } else if (!causes.empty()) {
      known.causes = count_causes(causes, answer.own_causes);
      answer.causes = std::move(causes);
      if (has_area(light)) known.errors = cause_errors(answer.evidence());
    }
    return obstacle;
  }

  Record& record_;
  SceneToday& today_;
  fs::path file_;
  std::vector<std::string> channels_;
  std::vector<const Light*> lights_;  ///< of today's scene
  const View* view_ = nullptr;
};

}  // namespace

RescoreSummary rescore(std::vector<Record>& records, const fs::path& dir, Progress& progress) {
  RescoreSummary result;
  std::map<std::string, std::vector<Record*>> scenes;
  std::size_t count = 0, on_path = 0, without_mask = 0;
  for (Record& record : records) {
    if (record.status != Status::ok) continue;
    if (!record.path.empty()) {
      ++on_path;
      continue;
    }
    if (pictures(record).empty()) {
      ++without_mask;
      continue;
    }
    scenes[record.scene].push_back(&record);
    ++count;
  }
  const auto rows = [](std::size_t n) { return fmt::format("{} row{}", n, n == 1 ? " keeps its" : "s keep their"); };
  if (on_path) result.notes.push_back(rows(on_path) + " metrics: on a path, only the mask of the last frame is kept");
  if (without_mask) result.notes.push_back(rows(without_mask) + " metrics: they were run with --pictures none");

  progress.expect(static_cast<double>(count));
  for (auto& [scene, scene_records] : scenes) {
    SceneToday today(scene, progress);
    std::map<std::string, std::size_t> obstacles, losses;
    for (Record* record : scene_records) {
      progress.step(full_title(*record));
      try {
        Row row(*record, dir, today);
        if (const std::string obstacle = row.obstacle(); !obstacle.empty()) {
          ++obstacles[obstacle];
        } else {
          if (const std::string lost = row.measure(); !lost.empty()) ++losses[lost];
          ++result.rows;
        }
      } catch (const std::exception& problem) {
        throw Error("{} cannot be rescored: {}", full_title(*record), problem.what());
      }
      progress.advance(1);
    }
    for (const auto& [why, n] : obstacles) result.notes.push_back(fmt::format("{}: {} metrics: {}", scene, rows(n), why));
    for (const auto& [why, n] : losses)
      result.notes.push_back(fmt::format("{}: {} row{} causes: {}", scene, n, n == 1 ? " loses its" : "s lose their", why));
  }
  return result;
}

}  // namespace gnomon
