// Rows against the places of an edition.
#include <gnomon/registry.h>

#include <cctype>
#include <set>

#include "measure/counted.h"
#include "measure/submission/rules.h"

namespace gnomon {

namespace {

Contender contender_of(const Record& record) {
  return {.technique = record.technique, .settings = record.settings, .label = {}};
}

bool is_same(const Contender& a, const Contender& b) { return a.technique == b.technique && a.settings == b.settings; }

/// Whether a group of the edition names it.
bool is_named(const SuiteGroup& group, const Contender& contender) {
  return std::ranges::any_of(group.contenders, [&](const Contender& own) { return is_same(own, contender); });
}

bool is_named(const Edition& edition, const Contender& contender) {
  return std::ranges::any_of(edition.suite.groups, [&](const SuiteGroup& group) { return is_named(group, contender); });
}

/// What a record and its job say differently; empty where they agree.
std::string contradiction(const Record& record, const Job& job, const Suite& suite) {
  const std::string size = fmt::format("{}x{}", record.width, record.height),
                    job_size = fmt::format("{}x{}", job.width, job.height);
  std::string lights = joined(light_names(record), "+"), job_lights = joined(job.lights, "+");
  struct Pair {
    const char* what;
    std::string has, wanted;
  };
  const Pair pairs[] = {{"scene", record.scene, job.scene},
                        {"light", record.light, job.light},
                        {"lights", std::move(lights), std::move(job_lights)},
                        {"view", record.view, job.view},
                        {"path", record.path, job.path},
                        {"size", size, job_size},
                        {"truth", std::string(name(record.truth)), std::string(name(suite.truth))}};
  for (const Pair& pair : pairs)
    if (pair.has != pair.wanted) return fmt::format("its {} is {}, and the edition's is {}", pair.what, pair.has, pair.wanted);
  const FrameTimes has{record.frame_count, record.frame_rate, record.start};
  if (has != job.times.value_or(FrameTimes{})) return "its frames are not those of the edition";
  return record.truth_over.value_or(TruthOver::center) == suite.truth_over ? "" : "its truth is over something else";
}

/// All rows of one contender.
struct Rows {
  Contender contender;
  std::map<std::string, const Record*> by_job;
};

class RowRules {
 public:
  RowRules(const Submission& submission, const Edition& edition, const EditionPlaces& places, const SupportsNothing& nothing)
      : submission_(submission), edition_(edition), places_(places), nothing_(nothing) {}

  RowFaults check() {
    for (const Record& record : submission_.records) check_row(record);
    check_metrics();
    check_settings();
    for (const Rows& rows : contenders_) check_complete(rows);
    return {faults_.lines(), notes_.lines()};
  }

 private:
  void check_row(const Record& record) {
    const Contender contender = contender_of(record);
    auto rows = std::ranges::find_if(contenders_, [&](const Rows& known) { return is_same(known.contender, contender); });
    if (rows == contenders_.end()) rows = contenders_.insert(contenders_.end(), Rows{contender, {}});
    if (!rows->by_job.emplace(record.job, &record).second) return faults_.add("it is there twice", record);
    if (record.suite != edition_.suite.name)
      faults_.add(fmt::format("it is of suite {}, and not of the edition", record.suite), record);
    const Job* const job = place_of(record, edition_, places_);
    if (!job) return faults_.add("it is no row of the edition", record);
    if (const std::string what = contradiction(record, *job, edition_.suite); !what.empty()) return faults_.add(what, record);
    const auto scene = edition_.scenes.find(scene_key(record));
    if (const std::string hash = context_text(record, "scene_hash"); scene == edition_.scenes.end() || hash != scene->second)
      faults_.add("its scene is not that of the edition: it has another hash", record);
    check_parameters(record);
    if (record.status == Status::ok) {
      check_effort(record);
      if (!record.mask) faults_.add("it has no mask (gnomon run --pictures none)", record);
    }
  }

  void check_effort(const Record& record) {
    const Suite& suite = edition_.suite;
    const auto processes = static_cast<int>(record.times(Stage::resolve).size());
    const bool has_more = suite.interval > 0 && record.stop != "fixed";
    if (has_more ? processes < suite.processes : processes != suite.processes)
      faults_.add(
          fmt::format("it was run with {}, and the edition asks for {}", counted(processes, "process{es}"), suite.processes),
          record);
    const auto repetitions = static_cast<std::size_t>(suite.repetitions);
    for (const Stage stage : {Stage::relight, Stage::resolve})
      for (const std::vector<double>& process : record.times(stage))
        if (process.size() != repetitions && process.size() != 1)
          return faults_.add(fmt::format("it was run with {}, and the edition asks for {}",
                                         counted(process.size(), "repetition{s}"), repetitions),
                             record);
  }

  /// The edition has the defaults of its own techniques. A parameter that came later is at its default where no setting says
  /// so.
  void check_parameters(const Record& record) {
    if (const TechniqueEntry* const entry = registry().find_technique(record.technique)) try {
        entry->make()->apply(record.settings);
      } catch (const Error& problem) {
        return faults_.add(fmt::format("its settings are none of the technique: {}", problem.what()), record);
      }
    auto own = edition_.techniques.find(contender_of(record).name());
    const bool is_listed = own != edition_.techniques.end();
    if (!is_listed) own = edition_.techniques.find(record.technique);
    if (own == edition_.techniques.end()) return;
    std::map<std::string, std::string> set;
    for (const std::string& part : parts_outside_braces(is_listed ? "" : record.settings))
      if (const std::size_t equal = part.find('='); equal != part.npos) set[part.substr(0, equal)] = part.substr(equal + 1);
    for (const auto& [key, value] : own->second.items()) {
      const auto has = record.parameters.find(key);
      if (has == record.parameters.end()) return faults_.add(fmt::format("it does not state its parameter {}", key), record);
      const auto wanted = set.find(key);
      if (wanted == set.end() && *has != value)
        return faults_.add(fmt::format("its {} = {} is not the default {}, and its settings do not say so", key,
                                       plain_text(*has), plain_text(value)),
                           record);
      if (wanted != set.end() && plain_text(*has) != wanted->second && *has == value)
        return faults_.add(fmt::format("its {} = {} is not that of its settings", key, plain_text(*has)), record);
    }
  }

  void check_metrics() {
    for (const auto& [metric, version] : edition_.metrics) {
      const auto has = submission_.facts.metrics.find(metric);
      if (has == submission_.facts.metrics.end())
        faults_.add(fmt::format("metric {} has no version, and the edition's is {}", metric, version));
      else if (has->second != version)
        faults_.add(fmt::format("metric {} is of version {}, and the edition's of {}", metric, has->second, version));
    }
    for (const Record& record : submission_.records)
      for (const auto& [truth, metrics] : record.metrics)
        for (const auto& [metric, value] : metrics)
          if (!submission_.facts.metrics.contains(metric))
            faults_.add(fmt::format("its metric {} has no version", metric), record);
  }

  void check_settings() {
    std::map<std::string, std::set<std::string>> settings;
    for (const Rows& rows : contenders_) {
      if (is_named(edition_, rows.contender)) continue;
      settings[rows.contender.technique].insert(rows.contender.settings);
      if (submission_.facts.division == Division::default_settings && !rows.contender.settings.empty())
        faults_.add(fmt::format("division default has the settings as they are shipped, and {} is set", rows.contender.name()));
    }
    if (submission_.facts.division != Division::tuned) return;
    for (const auto& [technique, all] : settings)
      if (all.size() > 1)
        faults_.add(fmt::format("division tuned has one setting of a technique at all places, and {} has {}: {}", technique,
                                all.size(), joined(std::vector<std::string>(all.begin(), all.end()), "; ")));
  }

  /// A group of the edition for one contender.
  struct Group {
    std::vector<std::string> there;    ///< jobs that have a row
    std::vector<std::string> missing;  ///< titles of those that have none
  };

  /// A group is there as a whole, or need not be there: then the contender has rows at places of other groups alone.
  void check_complete(const Rows& rows) {
    if (submission_.facts.division == Division::open) return;
    const bool is_own = is_named(edition_, rows.contender);
    std::vector<Group> groups(places_.size());
    std::set<std::string> covered;  // jobs that other groups account for: those that name the contender, or else whole ones
    for (std::size_t g = 0; g < places_.size(); ++g) {
      std::vector<std::string> jobs;
      for (const Job& place : places_[g]) {
        const Job job = with_contender(place, rows.contender, edition_.suite);
        jobs.push_back(job.hash);
        if (rows.by_job.contains(job.hash))
          groups[g].there.push_back(job.hash);
        else
          groups[g].missing.push_back(job.title());
      }
      if (is_own ? is_named(edition_.suite.groups[g], rows.contender) : groups[g].missing.empty())
        covered.insert(jobs.begin(), jobs.end());
    }
    for (std::size_t g = 0; g < groups.size(); ++g) {
      const std::vector<std::string>& missing = groups[g].missing;
      if (missing.empty()) continue;
      const bool is_begun =
          !std::ranges::all_of(groups[g].there, [&](const std::string& job) { return covered.contains(job); });
      if (!is_begun && !is_required(rows.contender, g, is_own)) continue;
      faults_.add(fmt::format("{} of the edition {} missing: {}{}", counted(missing.size(), "row{s}"),
                              missing.size() == 1 ? "is" : "are", missing.front(), missing.size() == 1 ? "" : ", ..."));
    }
  }

  bool is_required(const Contender& contender, std::size_t group, bool is_own) {
    if (is_own) return is_named(edition_.suite.groups[group], contender);
    const std::optional<bool> is_nothing = nothing_(contender, group);
    if (!is_nothing)
      notes_.add(
          fmt::format("{} has no row at some places of the edition, and is not here to be asked what it supports: name it by "
                      "--plugin or --program",
                      contender.name()));
    return is_nothing == false;
  }

  const Submission& submission_;
  const Edition& edition_;
  const EditionPlaces& places_;
  const SupportsNothing& nothing_;
  std::vector<Rows> contenders_;
  Faults faults_, notes_;
};

}  // namespace

EditionPlaces edition_places(const Edition& edition, SceneLibrary& library) {
  EditionPlaces places;
  for (const SuiteGroup& group : edition.suite.groups) {
    Suite one = edition.suite;
    one.groups = {group};
    one.groups.front().contenders = {Contender{}};
    places.push_back(expand_jobs(one, library, {}).jobs);
  }
  return places;
}

SupportsNothing supports_nothing(const Edition& edition, SceneLibrary& library, const WorkerOptions& worker) {
  return [&edition, &library, worker](const Contender& contender, std::size_t group) -> std::optional<bool> {
    if (!registry().find_technique(contender.technique)) return std::nullopt;
    Suite one = edition.suite;
    one.groups = {edition.suite.groups[group]};
    one.groups.front().contenders = {contender};
    one.groups.front().contenders.front().is_from_wildcard = true;
    return expand_jobs(one, library, worker).jobs.empty();
  };
}

RowFaults row_faults(const Submission& submission, const Edition& edition, const EditionPlaces& places,
                     const SupportsNothing& supports_nothing) {
  return RowRules(submission, edition, places, supports_nothing).check();
}

const Job* place_of(const Record& record, const Edition& edition, const EditionPlaces& places) {
  const Contender contender = contender_of(record);
  for (const std::vector<Job>& group : places)
    for (const Job& place : group)
      if (place.scene == record.scene && with_contender(place, contender, edition.suite).hash == record.job) return &place;
  return nullptr;
}

std::vector<std::string> tuning_faults(const SubmissionFacts& facts, const Edition& edition,
                                       const std::vector<std::string>& scenes) {
  Faults faults;
  if (facts.division != Division::tuned) {
    if (facts.division == Division::default_settings && facts.tuning)
      faults.add("division default has no tuning, and submission.json tells of one");
    return faults.lines();
  }
  if (!facts.tuning) {
    faults.add("division tuned says how settings were found, and tuning is null");
    return faults.lines();
  }
  std::set<std::string> words;
  std::string word;
  for (const char c : *facts.tuning + " ") {
    if (std::isalnum(static_cast<unsigned char>(c)) || c == '_') {
      word += c;
    } else {
      words.insert(word);
      word.clear();
    }
  }
  // A scene with settings is one of its family: "soup:ground=false" of soup.
  const auto is_named = [&](const std::string& scene) { return words.contains(scene.substr(0, scene.find_first_of(":@"))); };
  const auto is_training = [&](const std::string& scene) {
    const auto is_of_family = [&](const std::string& known) { return known.substr(0, known.find_first_of(":@")) == scene; };
    return std::ranges::any_of(edition.training, is_of_family);
  };
  if (std::ranges::none_of(edition.training, is_named))
    faults.add(fmt::format("tuning names no training scene; they are {}", joined(edition.training, ", ")));
  for (const std::string& scene : scenes)
    if (is_named(scene) && !is_training(scene))
      faults.add(fmt::format("tuning names {}, which is a scene and none to find settings on; those are {}", scene,
                             joined(edition.training, ", ")));
  return faults.lines();
}

}  // namespace gnomon
