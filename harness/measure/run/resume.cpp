#include <gnomon/error.h>

#include "measure/counted.h"
#include "measure/part_file.h"
#include "measure/program/plugin_facts.h"
#include "measure/record/scene_place.h"
#include "measure/run/run.h"
#include "measure/run/run_file.h"
#include "measure/scene/load.h"
#include "measure/scene/time_reference.h"
#include "measure/worker/build.h"
#include "measure/worker/machine_context.h"

namespace gnomon {

namespace fs = std::filesystem;

namespace {

[[noreturn]] void refuse(const fs::path& out, const std::string& what) {
  throw Error("{} cannot go on: {}; run it as before, or into another --out", out.string(), what);
}

/// Repetitions that the row was run with; nothing where it was never timed, or no stage is short: those are timed once.
std::optional<int> repetitions_of(const Record& record) {
  constexpr double surely_short = 100;  // milliseconds; stages over 500 are timed once per process
  std::size_t most = 0;
  bool has_short = false;
  for (const Stage stage : timed_stages) {
    const ProcessTimes& times = record.times(stage);
    for (const std::vector<double>& process : times) most = std::max(most, process.size());
    has_short = has_short || median_of_medians(times).value_or(surely_short) < surely_short;
  }
  if (most < 2 && !has_short) return std::nullopt;
  return static_cast<int>(most);
}

/// Throws Error when a row that counts as done was not done as the suite now requires.
void require_effort(const fs::path& out, const Record& record, const Suite& suite) {
  if (record.status != Status::ok) return;
  const auto processes = static_cast<int>(record.times(Stage::resolve).size());
  const bool has_more = record.stop == "target" || record.stop == "budget";  // than were fixed
  if (has_more ? processes < suite.processes : processes != suite.processes)
    refuse(out, fmt::format("{} was run with {}, not {}", title(record), counted(processes, "process{es}"), suite.processes));
  if (const auto repetitions = repetitions_of(record); repetitions && *repetitions != suite.repetitions)
    refuse(out,
           fmt::format("{} was run with {}, not {}", title(record), counted(*repetitions, "repetition{s}"), suite.repetitions));
}

/// How the code that measured a row differs from this program's; "" where it does not. Rows without a hash have their commit.
std::string other_code(const Record& record, const Record& now) {
  const std::string commit = context_text(record, "commit"), build = context_text(record, "build");
  if (build.empty() ? commit.empty() || commit == context_text(now, "commit") : build == context_text(now, "build")) {
    const std::string source = context_text(record, "technique_source");
    if (build.empty() || is_foreign(record) || source == technique_source(record.technique, record.settings)) return "";
    return fmt::format("of {} as its source was", record.technique);
  }
  if (commit != context_text(now, "commit"))
    return fmt::format("of commit {}, and this program is {}", commit, context_text(now, "commit"));
  return fmt::format("of build {}, and this program is {}", build, context_text(now, "build"));
}

/// A line for each fact of the machine that is not what it was.
std::vector<std::string> changes(std::span<const Record> kept, const Record& now) {
  std::vector<std::string> notes;
  for (const auto& [key, what] : {std::pair("processor", "processor"), std::pair("threads", "number of threads")}) {
    std::set<std::string> before;
    for (const Record& record : kept)
      if (std::string value = context_text(record, key); !value.empty() && value != context_text(now, key))
        before.insert(std::move(value));
    if (!before.empty())
      notes.push_back(fmt::format("note: rows that are done had another {}: {}, now {}; their times are not comparable", what,
                                  joined(before, ", "), context_text(now, key)));
  }
  return notes;
}

}  // namespace

void use_recorded_scenes(const fs::path& out, Suite& suite, SceneLibrary& library) {
  if (!is_plain_file(records_file(out))) return;  // its writer will report it
  std::map<std::string, std::string> recorded;    // name as written then, by the path of the file, both without a time
  std::error_code code;
  const auto path_of = [&](const std::string& scene) { return fs::weakly_canonical(scene, code).string(); };
  for (const Record& record : read_records(out))
    if (!context_text(record, "scene_file").empty())
      recorded.emplace(path_of(without_time(scene_reference(record, out))), without_time(record.scene));
  for (SuiteGroup& group : suite.groups)
    for (std::string& scene : group.scenes) {
      if (!names_file(scene)) continue;
      const std::string file = without_time(scene);
      const auto known = recorded.find(path_of(file));
      if (known == recorded.end() || known->second == file) continue;
      const std::string name = known->second + scene.substr(file.size());
      library.read_from(name, scene);
      scene = name;
    }
}

Earlier earlier_rows(const RunOptions& options, SceneLibrary& library, std::span<const Job> suite, std::span<const Job> jobs) {
  Earlier earlier;
  require_edition_of_folder(options.out, options.edition);
  if (!fs::exists(records_file(options.out))) return earlier;
  std::size_t foreign_count = 0;
  std::map<std::string, std::size_t> places;
  for (const Job& job : suite) places.emplace(job.hash, job.place);
  std::set<std::string> wanted;
  for (const Job& job : jobs) wanted.insert(job.hash);
  Record now;
  now.context = machine_context(options.worker.threads);
  std::map<std::tuple<std::string, std::string, bool>, std::string> hashes;  // by scene, light, and whether geometry moves
  for (Record& record : read_records(options.out)) {
    const bool is_of_run = !is_foreign(record);
    library.read_from(record.scene, scene_reference(record, options.out));
    const SceneLibrary::Entry& entry = library.get(record.scene);
    const std::string then = context_text(record, "scene_hash");
    const bool is_of_other_plugin = is_of_run && has_other_plugin(record);
    if (is_of_other_plugin && !wanted.contains(record.job))
      throw Error("{} holds rows of {} from another plugin than now: run them, too, or name another --out",
                  options.out.string(), title(record));
    const std::string code = other_code(record, now);
    if (!code.empty() && !options.rebuilt)
      throw Error("{} holds rows {}: continue them with that one, run them again with --rebuilt, or name another --out",
                  options.out.string(), code);
    if (!code.empty() && !wanted.contains(record.job))
      throw Error("{} holds rows {}, and {} is not run again: {}, or name another --out", options.out.string(), code,
                  title(record), is_foreign(record) ? "score its mask again" : "run it, too");
    const bool is_retried = options.retry_failed && record.status == Status::failed && wanted.contains(record.job);
    if ((entry.scene && then.empty()) || is_retried || is_of_other_plugin || !code.empty()) {
      earlier.is_changed = true;
      earlier.dropped.push_back(std::move(record));
      continue;
    }
    if (entry.scene) {
      const bool moves = record.start.has_value();
      std::string& hash = hashes[{record.scene, record.light, moves}];
      if (hash.empty()) hash = scene_hash(*entry.scene, light_names(record), moves ? WithMotion::yes : WithMotion::no);
      if (then != hash)
        throw Error("{} has changed since {} was run: run it into another --out", scene_in_words(record.scene),
                    options.out.string());
    }
    if (is_of_run && record.suite != options.suite.name)
      refuse(options.out, fmt::format("it holds rows of suite {}, not {}", record.suite, options.suite.name));
    if (record.truth != options.suite.truth)
      refuse(options.out, fmt::format("its rows have the truth {}, not {}", name(record.truth), name(options.suite.truth)));
    if (wanted.contains(record.job) && !options.any_effort) require_effort(options.out, record, options.suite);
    if (const auto place = places.find(record.job); place != places.end()) {
      earlier.is_changed = earlier.is_changed || record.place != place->second;
      record.place = place->second;
    } else if (entry.scene && is_of_run) {  // the rows of a scene that is not here now are not known
      ++foreign_count;
    }
    earlier.done.insert(record.job);
    earlier.kept.push_back(std::move(record));
  }
  if (foreign_count > 0 && foreign_count == earlier.kept.size())
    refuse(options.out, fmt::format("none of its {} rows is in suite {} as it is now, with its scenes, settings and sizes",
                                    foreign_count, options.suite.name));
  earlier.notes = changes(earlier.kept, now);
  if (foreign_count > 0)
    earlier.notes.push_back(fmt::format("note: {} of the rows in {} are not in suite {} as it is now; they stay in its tables",
                                        foreign_count, options.out.string(), options.suite.name));
  return earlier;
}

}  // namespace gnomon
