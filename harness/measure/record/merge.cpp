#include "measure/record/merge.h"

#include <set>
#include <unordered_map>

#include "measure/part_file.h"
#include "measure/paths.h"
#include "measure/record/scene_place.h"
#include "measure/scene/blob.h"
#include "measure/scene/load.h"

namespace gnomon {

namespace fs = std::filesystem;

namespace {

/// What must be the same whenever the job is run, as a flat list of paths and values. A failed row's reason may name a process
/// or a time, so it is left out.
Json content(const Record& record) {
  const Json all = record;
  Json part = Json::object();
  for (const char* key :
       {"status", "support", "parameters", "width", "height", "truth", "path", "classes", "metrics", "causes", "frames"})
    part[key] = all[key];
  if (record.status != Status::failed) part["reason"] = record.reason;
  for (const char* key : {"scene_hash", "commit", "technique_source"}) part["context"][key] = context_text(record, key);
  if (const std::string hash = plugin_hash(record); !hash.empty()) part["context"]["plugin"]["hash"] = hash;
  return part.flatten();
}

/// "/metrics/shape/wrong_rate" as "metrics.shape.wrong_rate".
std::string dotted(std::string path) {
  path.erase(0, 1);
  std::ranges::replace(path, '/', '.');
  return path;
}

/// A path in a record may not lead out of its folder: neither by its name nor by a link.
void require_inside(const fs::path& path, const MergedRow& row) {
  const bool is_inside = path.is_relative() && !path.empty() && std::ranges::find(path, fs::path("..")) == path.end();
  if (!is_inside)
    throw Error("picture {} is not a path below the run's folder ({}, job {})", path.string(), row.folder.string(),
                row.record.job);
  std::error_code code;
  const fs::path file = fs::canonical(row.folder / path, code);
  if (!code && file != (fs::canonical(row.folder) / path).lexically_normal())
    throw Error("picture {} of {} is a link or lies behind one, to {}: merge takes the files of a folder only (job {})",
                path.string(), row.folder.string(), file.string(), row.record.job);
}

/// Copies a picture of a row into a folder. Returns whether there is one.
bool copy_picture(const std::string& name, const MergedRow& row, const fs::path& into) {
  if (!fs::is_regular_file(row.folder / name)) return false;
  fs::create_directories((into / name).parent_path());
  fs::copy_file(row.folder / name, into / name);
  return true;
}

/// A note for each fact that should be one for all rows and is not.
void note_mixture(Merge& merge) {
  constexpr std::string_view times = "their times are not comparable", rows = "their rows may not be comparable";
  struct Fact {
    std::string_view name, consequence, key;  ///< key in the context; empty: the suite
  };
  constexpr Fact facts[] = {
      {"suites", "the table holds all of them", ""},
      {"versions", rows, "version"},
      {"commits", rows, "commit"},
      {"builds", rows, "build"},
      {"build types", times, "build_type"},
      {"processors", times, "processor"},
      {"numbers of threads", times, "threads"},
      {"OpenGL renderers", times, "gl_renderer"},
  };
  for (const auto& [name, consequence, key] : facts) {
    std::map<std::string, std::size_t> counts;
    for (const MergedRow& row : merge.rows)
      if (const std::string value = key.empty() ? row.record.suite : context_text(row.record, key); !value.empty())
        ++counts[value];
    if (counts.size() < 2) continue;
    std::vector<std::string> values;
    for (const auto& [value, count] : counts)
      values.push_back(fmt::format("{} ({} row{})", value, count, count == 1 ? "" : "s"));
    merge.notes.push_back(fmt::format("different {}: {}; {}", name, joined(values), consequence));
  }
}

/// Scenes that changed between rows. Where a machine had not fetched a scene, it has a row without a scene, and the real rows
/// of its shard are missing.
void note_scenes(Merge& merge) {
  // Under different lights a scene has different hashes (scene_hash), and one more where a row's geometry moves.
  std::map<std::string, std::map<std::string, std::set<std::string>>> hashes;
  std::map<std::string, std::set<std::string>> missing;
  for (const MergedRow& row : merge.rows) {
    if (const std::string hash = context_text(row.record, "scene_hash"); hash.empty())
      missing[row.record.scene].insert(row.folder.string());
    else
      hashes[row.record.scene][row.record.light + (row.record.start ? " in motion" : "")].insert(hash);
  }
  for (const auto& [scene, lights] : hashes) {
    std::size_t most = 0;
    for (const auto& [light, all] : lights) most = std::max(most, all.size());
    if (most > 1)
      merge.notes.push_back(fmt::format("{} has {} contents: its rows are not comparable", scene_in_words(scene), most));
  }
  for (const auto& [scene, folders] : missing)
    if (hashes.contains(scene))
      merge.notes.push_back(fmt::format("{} was there for some rows and not for {}: fetch it there and --resume that run",
                                        scene_in_words(scene), joined(folders, ", ")));
}

/// A hole in the numbering of a suite's rows. Rows missing after the last one cannot be detected.
void note_holes(Merge& merge) {
  std::map<std::string, std::set<std::uint64_t>> places;
  for (const MergedRow& row : merge.rows) places[row.record.suite].insert(row.record.place);
  for (const auto& [suite, there] : places)
    if (const std::uint64_t expected = *there.rbegin() + 1; there.size() < expected)
      merge.notes.push_back(fmt::format(
          "{} of the first {} rows of suite {} are not there: a shard is missing or unfinished, or the run was filtered",
          expected - there.size(), expected, suite));
}

}  // namespace

std::vector<std::string> differences(const Record& a, const Record& b) {
  const Json left = content(a), right = content(b);
  std::vector<std::string> result;
  for (const auto& [key, value] : left.items())
    if (!right.contains(key) || right[key] != value)
      result.push_back(
          fmt::format("{}: {}, {}", dotted(key), json_text(value), right.contains(key) ? json_text(right[key]) : "nothing"));
  for (const auto& [key, value] : right.items())
    if (!left.contains(key)) result.push_back(fmt::format("{}: nothing, {}", dotted(key), json_text(value)));
  return result;
}

Merge merge_records(std::span<const std::pair<fs::path, std::vector<Record>>> runs, bool prefer_last) {
  Merge merge;
  std::unordered_map<std::string, std::size_t> place_of_job;
  std::map<std::string, std::size_t> suites;
  for (const auto& [folder, records] : runs)
    for (const Record& record : records) {
      suites.try_emplace(record.suite, suites.size());
      const auto [found, is_new] = place_of_job.try_emplace(record.job, merge.rows.size());
      if (is_new || record.job.empty()) {
        merge.rows.push_back({record, folder});
        continue;
      }
      MergedRow& kept = merge.rows[found->second];
      std::vector<std::string> different = differences(kept.record, record);
      if (different.empty())
        ++merge.duplicate_count;
      else
        merge.conflicts.push_back({record.job, title(record), kept.folder, folder, std::move(different)});
      if (prefer_last) kept = {record, folder};
    }
  std::ranges::stable_sort(merge.rows, [&](const MergedRow& a, const MergedRow& b) {
    return std::pair(suites[a.record.suite], a.record.place) < std::pair(suites[b.record.suite], b.record.place);
  });
  note_mixture(merge);
  note_scenes(merge);
  note_holes(merge);
  return merge;
}

void require_free(const fs::path& out) {
  if (!fs::exists(fs::symlink_status(out))) return;
  if (!fs::is_directory(out)) throw Error("--out {} is a file; name a folder that is not there yet", out.string());
  if (fs::exists(records_file(out))) throw Error("output folder {} holds records already: name another --out", out.string());
  if (!fs::is_empty(out)) throw Error("output folder {} is not empty: name another --out", out.string());
}

std::size_t write_merge(const Merge& merge, const fs::path& out, const std::function<void(const fs::path&)>& finish) {
  fs::path target = out.lexically_normal();
  if (!target.has_filename()) target = target.parent_path();
  require_free(target);
  make_folder(target.has_parent_path() ? target.parent_path() : fs::path("."), "output folder");
  const fs::path staged = part_of(target);
  try {
    fs::create_directory(staged);
    std::string lines;
    using Owner = std::pair<const MergedRow*, bool>;  // whether other rows may name it, too
    std::map<std::string, Owner> owners;
    std::size_t missing = 0;
    for (const MergedRow& row : merge.rows) {
      Record record = row.record;
      if (!context_text(record, "scene_file").empty()) {  // a path from another folder
        const auto path = path_to_scene(target, scene_reference(record, row.folder));
        record.context["scene_file"] = path ? Json(*path) : Json();
      }
      lines += record_line(record);
      for (const bool is_shared : {false, true})
        for (const std::string& name : is_shared ? shared_pictures(row.record) : pictures(row.record)) {
          require_inside(name, row);
          const auto [known, is_new] = owners.try_emplace(name, Owner{&row, is_shared});
          const auto& [owner, was_shared] = known->second;
          if (!is_new && !(is_shared && was_shared))
            throw Error("picture {} is named by two rows: job {} of {} and job {} of {}", name, owner->record.job,
                        owner->folder.string(), row.record.job, row.folder.string());
          // The name of a shared one says what it shows: whichever folder has it.
          if (is_shared && fs::exists(staged / name)) continue;
          if (!copy_picture(name, row, staged)) ++missing;
        }
    }
    write_file(records_file(staged), lines, Durable::yes);
    finish(staged);
    fs::rename(staged, target);
    sync_folder_of(target);
    return missing;
  } catch (...) {
    std::error_code ignored;
    fs::remove_all(staged, ignored);
    throw;
  }
}

}  // namespace gnomon
