#include "measure/row/rescore.h"

#include "measure/record/scene_place.h"
#include "measure/row/current_scene.h"
#include "measure/row/kept_row.h"
#include "measure/row/score_row.h"

namespace gnomon {

namespace fs = std::filesystem;

namespace {

std::string full_title(const Record& record) { return fmt::format("{} ({})", title(record), record.job); }

/// Rewrites what one record has of its mask.
class Row {
 public:
  Row(Record& record, const fs::path& dir, CurrentScene& today) : record_(record), current_(today) {
    if (!record.mask) throw Error("the row has no mask");
    file_ = dir / *record.mask;
    if (!fs::exists(file_)) throw Error("its mask {} is not there", file_.string());
    channels_ = image_files().exr_channels(file_);
  }

  /// Why the row keeps what it has; empty when it can be measured anew.
  std::string obstacle() { return current_.obstacle(record_); }

  /// Returns why the row lost its causes; empty when it did not.
  std::string measure() {
    const Truth truth = record_.truth, other = truth == Truth::shape ? Truth::mesh : Truth::shape;
    MeasuredRow row = read_row(truth, "V");
    const std::string lost = take_causes(row);
    put_together(row, *current_.scene);
    RowScore fresh = score(row, *current_.scene);
    keep_others(fresh.whole.metrics, truth);
    if (!row.together) fresh.lights = {fresh.whole};
    auto before = record_.lights.begin();
    for (Score& light : fresh.lights) keep_seams(light.metrics, (before++)->metrics);
    put_score(record_, fresh);
    if (!current_.scene->has_curved_shapes()) {
      record_.metrics[other] = record_.metrics[truth];
    } else if (has(record_.lights.front(), name(other))) {
      MeasuredRow on_other = read_row(other, name(other));
      put_together(on_other, *current_.scene);
      const Evidence evidence = on_other.evidence(*current_.scene);
      Metrics metrics = measure_metrics(Scoring(evidence));
      keep_others(metrics, other);
      record_.metrics[other] = std::move(metrics);
    }
    return lost;
  }

 private:
  /// Whether the file has the channel LIGHT.WHAT.
  bool has(const Record::LightFacts& light, std::string_view what) const {
    return std::ranges::find(channels_, fmt::format("{}.{}", light.name, what)) != channels_.end();
  }

  /// The row's masks in the channels LIGHT.WHAT.
  MeasuredRow read_row(Truth truth, std::string_view what) const {
    const KeptPlace place = kept_place(record_, *current_.scene, truth);
    MeasuredRow row = kept_row(record_, file_, what, place, *current_.frames);
    for (auto& [light, answer, other_mask, right_on_mesh] : row.lights)
      if (record_.truth_over && !has_area(light)) answer.pixel_truth = current_.frames->pixel_truth(place.key, light);
    return row;
  }

  /// One mask alone is kept: metrics of the picture of all light, of seams and of further frames stay.
  void keep_others(Metrics& metrics, Truth truth) const {
    metrics["radiosity_error"] = record_.metric(truth, "radiosity_error");
    for (const auto& [name, value] : record_.metrics[truth])
      if (metric_is_of(name) == MetricInfo::Of::sequence) metrics[name] = value;
    keep_seams(metrics, record_.metrics[truth]);
  }
  static void keep_seams(Metrics& metrics, const Metrics& before) {
    for (const auto& [name, value] : before)
      if (is_of_seams(name)) metrics[name] = value;
  }

  /// Puts the causes of the file into the row's lights, unless they belong to other frames: then none has any. Returns why the
  /// row lost its causes.
  std::string take_causes(MeasuredRow& row) const {
    std::string obstacle = causes_obstacle(record_);
    for (const Record::LightFacts& light : record_.lights)
      if (obstacle.empty() && light.causes && !has(light, "cause")) obstacle = "the file of its mask does not hold them";
    if (!obstacle.empty()) return record_.causes ? obstacle : "";
    auto measured = row.lights.begin();
    for (const Record::LightFacts& light : record_.lights) {
      Answer& answer = (measured++)->answer;
      if (has(light, "cause")) answer.causes = kept_causes(record_, file_, light);
    }
    return {};
  }

  Record& record_;
  CurrentScene& current_;
  fs::path file_;
  std::vector<std::string> channels_;
};

}  // namespace

RescoreSummary rescore(std::vector<Record>& records, const fs::path& dir, Progress& progress) {
  RescoreSummary result;
  std::map<std::string, std::vector<Record*>> scenes;
  std::size_t count = 0, on_path = 0, without_mask = 0;
  for (Record& record : records) {
    if (record.status != Status::ok) continue;
    const bool is_on_path = !record.path.empty(), has_mask = !pictures(record).empty();
    ++(is_on_path ? on_path : has_mask ? count : without_mask);
    if (!is_on_path && has_mask) scenes[record.scene].push_back(&record);
  }
  const auto rows = [](std::size_t n) { return fmt::format("{} row{}", n, n == 1 ? " keeps its" : "s keep their"); };
  if (on_path) result.notes.push_back(rows(on_path) + " metrics: on a path, only the mask of the last frame is kept");
  if (without_mask) result.notes.push_back(rows(without_mask) + " metrics: they were run with --pictures none");

  progress.expect(static_cast<double>(count));
  for (auto& [scene, scene_records] : scenes) {
    CurrentScene today(scene, scene_reference(*scene_records.front(), dir), progress);
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
