#include "measure/run/rescore.h"

#include <gnomon/error.h>

#include <algorithm>
#include <map>
#include <memory>

#include "measure/paths.h"
#include "measure/picture/picture.h"
#include "measure/run/frame_worker.h"
#include "measure/run/jobs.h"
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
    light_ = find_named(today_.scene->lights, record_.light);
    view_ = find_named(today_.scene->views, record_.view);
    const bool has_hash = record_.context.contains("scene_hash");
    if (has_hash && light_ && !today_.frames->is_scene(record_.context["scene_hash"], *light_))
      return "the scene is not the one that was measured";
    if (!light_) return fmt::format("the scene has no light {} any more", record_.light);
    if (!view_) return fmt::format("the scene has no view {} any more", record_.view);
    // An old row of a light that the reference does not know; reading withdraws those that say what kind of light it was.
    if (const Support support = reference_support(*today_.scene, *light_, *view_); !support) {
      withdraw(record_, support.why());
      return {};
    }
    // Without a hash the classes vouch for the scene: they depend on scene, light, view and truth alone.
    if (!has_hash && !record_.classes.empty() && class_counts(reference(record_.truth).classes) != record_.classes)
      return "the scene is not the one that was measured: its pixel classes differ";
    return {};
  }

  /// Answers why the row lost its causes; empty when it did not.
  std::string measure() {
    if (record_.status != Status::ok) return {};  // withdrawn
    const Truth truth = record_.truth, other = truth == Truth::shape ? Truth::mesh : Truth::shape;
    Answer answer = read_answer(truth, record_.light + ".V");
    const std::string lost = take_causes(answer);
    score(truth, answer);
    record_.classes = class_counts(answer.reference.classes);
    if (!today_.scene->has_curved_shapes())
      record_.metrics[other] = record_.metrics[truth];
    else if (const std::string channel = fmt::format("{}.{}", record_.light, name(other)); has(channel))
      score(other, read_answer(other, channel));
    return lost;
  }

 private:
  bool has(const std::string& channel) const { return std::ranges::find(channels_, channel) != channels_.end(); }

  FrameKey key(Truth truth) const {
    return {*view_, record_.width, record_.height, today_.scene->has_curved_shapes() ? truth : Truth::shape};
  }
  Reference reference(Truth truth) const { return today_.frames->reference(key(truth), *light_, target_of(record_)); }

  std::vector<float> read(const std::string& channel) const { return read_exr(file_, channel, record_.width, record_.height); }

  Answer read_answer(Truth truth, const std::string& channel) const {
    Answer answer{today_.frames->gbuffer(key(truth)), reference(truth), read(channel), {}, estimates_of(record_)};
    const auto is_wild = [](float v) { return !(v >= 0 && v <= 1); };
    if (const auto wild = std::ranges::find_if(answer.mask, is_wild); wild != answer.mask.end())
      throw Error("{}: {} at pixel {} is {}; a visibility is 0 .. 1", file_.string(), channel, wild - answer.mask.begin(),
                  *wild);
    return answer;
  }

  void score(Truth truth, const Answer& answer) {
    record_.metrics[truth] = measure_metrics(Scoring(answer.evidence(*today_.scene, *light_)));
  }

  /// The causes of the mask go into answer and record, unless they belong to other frames: then neither has any. Without a
  /// channel the record's own counts stay if they can.
  std::string take_causes(Answer& answer) {
    const std::string channel = record_.light + ".cause";
    std::vector<Cause> causes;
    bool fit = true;
    if (has(channel)) {
      causes = read_causes(channel);
      fit = causes_fit(answer, causes);
    } else if (record_.causes) {
      const Evidence evidence = answer.evidence(*today_.scene, *light_);
      std::uint64_t wrong = 0, with_cause = 0;
      for (std::size_t i = 0; i < answer.mask.size(); ++i) wrong += evidence.wants_cause(i);
      for (const auto& [cause, pixels] : *record_.causes) with_cause += pixels;
      fit = wrong == with_cause;
    } else {
      return {};
    }
    std::string obstacle = causes_obstacle(record_, fit);
    if (!obstacle.empty()) {
      record_.causes.reset();
      record_.cause_errors.reset();
    } else if (!causes.empty()) {
      record_.causes = count_causes(causes);
      answer.causes = std::move(causes);
      if (has_area(*light_)) record_.cause_errors = cause_errors(answer.evidence());
    }
    return obstacle;
  }

  std::vector<Cause> read_causes(const std::string& channel) const {
    const std::vector<float> numbers = read(channel);
    try {
      return causes_from_numbers(numbers, record_.causes);
    } catch (const Error& error) {
      throw Error("{}: channel {}: {}", file_.string(), channel, error.what());
    }
  }

  Record& record_;
  SceneToday& today_;
  fs::path file_;
  std::vector<std::string> channels_;
  const Light* light_ = nullptr;
  const View* view_ = nullptr;
};

}  // namespace

RescoreSummary rescore(std::vector<Record>& records, const fs::path& dir, Progress& progress) {
  RescoreSummary result;
  std::map<std::string, std::vector<Record*>> scenes;
  std::size_t count = 0, on_path = 0;
  for (Record& record : records) {
    if (record.status != Status::ok) continue;
    if (!record.path.empty()) {
      ++on_path;
      continue;
    }
    scenes[record.scene].push_back(&record);
    ++count;
  }
  const auto rows = [](std::size_t n) { return fmt::format("{} row{}", n, n == 1 ? " keeps its" : "s keep their"); };
  if (on_path) result.notes.push_back(rows(on_path) + " metrics: on a path, only the mask of the last frame is kept");

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
