#include "app/tune_run.h"

#include <gnomon/registry.h>

#include "analysis/in_order.h"
#include "measure/scene/time_reference.h"

namespace gnomon::app {

namespace {

/// Of finalists: from fewer processes no interval covers much, and where five leave a tie fifteen may end it.
constexpr int final_processes = 5, most_processes = 15;

/// Settings whose time in one process is within this factor of the least may be the fastest.
constexpr double near_least = 1.25;
constexpr std::size_t most_timed = 8, most_exact = 3;  ///< finalists

Suite with_effort(Suite suite, int processes, int repetitions, Suite::Pictures pictures) {
  suite.processes = processes;
  if (repetitions) suite.repetitions = repetitions;
  suite.pictures = pictures;
  return suite;
}

}  // namespace

Tuning::Tuning(TunePlan plan, SceneLibrary& library) : plan_(std::move(plan)), library_(library) {
  Suite& suite = plan_.run.suite;
  plan_.run.any_effort = true;
  SuiteGroup& group = suite.groups.front();
  for (const std::string& scene : group.scenes)
    if (const std::string missing = library.get(scene).missing; !missing.empty()) throw Error("{}", missing);
  const TuneSpace& first = plan_.spaces.front();
  group.contenders = {{first.technique, first.settings(first.grid.base()), "", false}};
  places_ = expand_jobs(suite, library, plan_.run.worker).jobs;
  all_places_ = places_.size();
  // Times of the search are compared with one another; where none decides, one repetition is enough.
  search_suite_ = with_effort(suite, 1, plan_.goal.is_timed() ? suite.repetitions : 1, Suite::Pictures::none);
  search_suite_.warmups = plan_.goal.is_timed() ? suite.warmups : 1;
  constexpr std::size_t least_places = 3;
  if (!plan_.holds_out_places || all_places_ < least_places) return;
  std::vector<std::size_t> order(all_places_);
  for (std::size_t k = 0; k < order.size(); ++k) order[k] = k;
  Random(plan_.seed).shuffle(order);
  order.resize(std::max<std::size_t>(1, all_places_ / 4));
  std::erase_if(places_, [&](const Job& job) {
    const bool is_held = std::ranges::find(order, job.place) != order.end();
    if (is_held) held_.push_back(job);
    return is_held;
  });
}

double Tuning::possible() const {
  double count = 0;
  for (const TuneSpace& space : plan_.spaces) count += space.grid.count() * static_cast<double>(places_.size());
  return count;
}

Job Tuning::job_of(const std::string& technique, const std::string& settings, const Job& place) {
  Job job = with_contender(place, {technique, settings, "", false}, plan_.run.suite);
  const std::size_t ordinal = ordinals_.try_emplace(job.contender.name(), ordinals_.size()).first->second;
  job.place = ordinal * all_places_ + place.place;
  return job;
}

Job Tuning::job_of(const Entrant& entrant, const Job& place) {
  const TuneSpace& space = plan_.spaces[entrant.space];
  return job_of(space.technique, space.settings(entrant.setting), place);
}

const Record* Tuning::record_of(const Entrant& entrant, const Job& place) {
  const auto found = records_.find(job_of(entrant, place).hash);
  return found == records_.end() ? nullptr : &found->second;
}

std::vector<const Record*> Tuning::records_at(const Entrant& entrant, const std::vector<Job>& places) {
  std::vector<const Record*> rows;
  for (const Job& place : places) rows.push_back(record_of(entrant, place));
  return rows;
}

std::vector<Job> Tuning::first_jobs() {
  std::vector<Job> jobs;
  for (std::size_t space = 0; space < plan_.spaces.size(); ++space)
    for (const Job& place : places_) jobs.push_back(job_of({space, plan_.spaces[space].grid.base()}, place));
  return jobs;
}

/// The jobs of the rows that the folder has of these places.
std::vector<Job> Tuning::earlier_jobs() {
  std::vector<Job> jobs;
  if (!plan_.run.resume || !std::filesystem::exists(records_file(plan_.run.out))) return jobs;
  for (const Record& record : read_records(plan_.run.out)) {
    if (!registry().find_technique(record.technique)) continue;
    for (const std::vector<Job>* places : {&places_, &held_})
      for (const Job& place : *places) {
        if (place.scene != record.scene || place.light != record.light || place.view != record.view) continue;
        if (Job job = job_of(record.technique, record.settings, place); job.hash == record.job) jobs.push_back(std::move(job));
      }
  }
  return jobs;
}

void Tuning::run_jobs(std::span<const Job> jobs, const Suite& suite, bool is_limited) {
  if (jobs.empty()) return;
  Progress progress(plan_.is_quiet);
  const auto seen = [&](const Record& record) { records_.insert_or_assign(record.job, record); };
  const auto is_over = [&] { return is_limited && plan_.budget && seconds_since(start_) > *plan_.budget; };
  folder_->add_rows(jobs, {suite, progress, seen, is_over});
}

bool Tuning::answers(std::size_t space, const Job& place) {
  const Record* record = record_of({space, plan_.spaces[space].grid.base()}, place);
  return record && tune_answer(*record, plan_.goal).is_there;
}

/// Leaves out places where nobody has an answer, and then whoever has none at another one.
void Tuning::drop_unanswered() {
  const auto why = [&](std::size_t space, const Job& place) {
    const Record* record = record_of({space, plan_.spaces[space].grid.base()}, place);
    if (!record) return std::string("not measured");
    if (record->status == Status::ok) return fmt::format("it has no {} there", plan_.goal.least.name);
    return fmt::format("{}: {}", name(record->status), record->reason);
  };
  std::string reason;
  std::erase_if(places_, [&](const Job& place) {
    for (std::size_t space = 0; space < plan_.spaces.size(); ++space)
      if (answers(space, place)) return false;
    reason = why(0, place);
    notes_.push_back(fmt::format("left out: {} {} {}: {}", place.scene, place.light, place.view, reason));
    return true;
  });
  if (places_.empty()) throw Error("there is nothing to tune: {} has no answer: {}", plan_.spaces.front().technique, reason);
  for (std::size_t space = 0; space < plan_.spaces.size(); ++space) {
    const auto lacks = [&](const Job& place) { return !answers(space, place); };
    const auto missing = std::ranges::find_if(places_, lacks);
    if (missing == places_.end()) {
      active_.push_back(space);
      continue;
    }
    reason = fmt::format("{}: {} {} {}: {}", plan_.spaces[space].technique, missing->scene, missing->light, missing->view,
                         why(space, *missing));
    notes_.push_back("left out: " + reason);
  }
  if (active_.empty()) throw Error("there is nothing to tune: no technique has an answer at every place: {}", reason);
}

std::vector<std::optional<TuneAnswer>> Tuning::ask(std::size_t space, std::span<const TuneQuestion> questions) {
  std::vector<Job> jobs, unknown;
  for (const TuneQuestion& question : questions) {
    jobs.push_back(job_of({space, question.setting}, places_[question.place]));
    if (!records_.contains(jobs.back().hash)) unknown.push_back(jobs.back());
  }
  run_jobs(select_jobs(plan_.run, std::move(unknown)), search_suite_, true);
  std::vector<std::optional<TuneAnswer>> answers;
  for (const Job& job : jobs) {
    const auto found = records_.find(job.hash);
    answers.push_back(found == records_.end() ? std::nullopt : std::optional(tune_answer(found->second, plan_.goal)));
  }
  return answers;
}

void Tuning::search() {
  std::vector<Job> known = earlier_jobs(), first = first_jobs();
  const std::size_t base_count = first.size();
  first.insert(first.end(), known.begin(), known.end());
  {
    Progress progress(plan_.is_quiet);
    folder_.emplace(plan_.run, library_, first, first, progress);
  }
  for (const Record& record : folder_->earlier().kept) records_.insert_or_assign(record.job, record);
  first.resize(base_count);
  std::erase_if(first, [&](const Job& job) { return records_.contains(job.hash); });
  run_jobs(first, search_suite_, false);
  drop_unanswered();
  const double share = most_evaluations / static_cast<double>(active_.size());
  for (const std::size_t space : active_) {
    const double count = plan_.spaces[space].grid.count() * static_cast<double>(places_.size());
    const TuneSearchOptions options{.places = places_.size(),
                                    .over = plan_.goal.over,
                                    .whole = is_whole() || count <= share,
                                    .most_asked = static_cast<std::size_t>(std::min(share, count / 5)),
                                    .seed = plan_.seed};
    searches_[space] = search_grid(plan_.spaces[space].grid, options,
                                   [&](std::span<const TuneQuestion> questions) { return ask(space, questions); });
  }
}

/// Who may be the answer, best first, and the best of each technique.
std::vector<Tuning::Entrant> Tuning::entrants() {
  std::vector<std::pair<TuneStanding, Entrant>> all;
  std::vector<Entrant> best_of_each;
  for (const auto& [space, search] : searches_) {
    const std::vector<TuneSetting> order = ranked(search, places_.size(), plan_.goal.over);
    if (!order.empty()) best_of_each.push_back({space, order.front()});
    for (const TuneSetting& setting : order) {
      std::vector<TuneAnswer> answers;
      for (const std::optional<TuneAnswer>& answer : search.answers.at(setting)) answers.push_back(*answer);
      all.emplace_back(standing(answers, places_.size(), plan_.goal.over), Entrant{space, setting});
    }
  }
  std::ranges::stable_sort(all, [](const auto& a, const auto& b) { return is_better(a.first, b.first); });
  std::vector<Entrant> chosen;
  const bool is_timed = plan_.goal.least.is_time();
  for (const auto& [standing, entrant] : all) {
    const TuneStanding& best = all.front().first;
    const bool is_near = standing.keeps_limits() && standing.goal <= (is_timed ? near_least : 1) * best.goal;
    const bool is_runner_up = chosen.size() < 2;
    if (is_runner_up || (is_near && chosen.size() < (is_timed ? most_timed : most_exact))) chosen.push_back(entrant);
  }
  for (const Entrant& entrant : best_of_each) add_once(chosen, entrant);
  return chosen;
}

/// Runs rows that have fewer processes, or no picture where the run has some.
void Tuning::measure(std::span<const Entrant> entrants, int processes) {
  const Suite suite = with_effort(plan_.run.suite, processes, 0, plan_.run.suite.pictures);
  std::vector<Job> jobs;
  for (const std::vector<Job>* places : {&places_, &held_})
    for (const Job& place : *places)
      for (const Entrant& entrant : entrants) {
        const Record* record = record_of(entrant, place);
        const bool is_done = record && (record->status != Status::ok ||
                                        record->times(Stage::resolve).size() >= static_cast<std::size_t>(processes));
        if (!is_done) jobs.push_back(job_of(entrant, place));
      }
  run_jobs(jobs, suite, false);
}

TuneDecision Tuning::decide_among(std::span<const Entrant> entrants) {
  std::vector<TuneFinalist> finalists;
  for (const Entrant& entrant : entrants) {
    TuneFinalist& finalist = finalists.emplace_back();
    const TuneSpace& space = plan_.spaces[entrant.space];
    for (std::size_t k = 0; k < space.parameters.size(); ++k)
      finalist.changes += space.parameters[k].values[entrant.setting[k]] != space.parameters[k].base;
    for (const Record* record : records_at(entrant, places_)) {
      finalist.answers.push_back(record ? tune_answer(*record, plan_.goal) : TuneAnswer{.is_there = false});
      if (!record || !finalist.answers.back().is_there) continue;
      finalist.error = std::max(finalist.error, record->metric("error").value_or(0));
      if (!plan_.goal.least.is_time()) continue;
      const TuneNumber& least = plan_.goal.least;
      finalist.times.push_back(sample_of(*record, least.cost ? parts_of(*least.cost) : parts_of_time(least.name)));
    }
  }
  return decide(finalists, plan_.goal.over);
}

TuneReport Tuning::decided() {
  std::vector<Entrant> finalists = entrants();
  if (finalists.empty())
    throw Error("no setting was measured at every place{}", plan_.budget ? ": give a larger --budget, or --resume" : "");
  std::vector<Entrant> measured = finalists;
  add_once(measured, Entrant{finalists.front().space, plan_.spaces[finalists.front().space].grid.base()});
  measure(measured, plan_.processes ? plan_.processes : final_processes);
  TuneDecision decision = decide_among(finalists);
  if (decision.tied.size() > 1 && plan_.goal.least.is_time() && !plan_.processes) {
    std::vector<Entrant> tied;
    for (const std::size_t k : decision.tied) tied.push_back(finalists[k]);
    measure(tied, most_processes);
    decision = decide_among(finalists);
  }
  const Entrant base{finalists[decision.answer].space, plan_.spaces[finalists[decision.answer].space].grid.base()};
  measure({&base, 1}, plan_.processes ? plan_.processes : final_processes);
  TuneReport report{.goal = plan_.goal};
  add_rows(report, finalists, decision);
  add_scenes_left_out(report);
  add_notes(report);
  folder_->close();
  return report;
}

void Tuning::add_rows(TuneReport& report, std::span<const Entrant> entrants, const TuneDecision& decision) {
  const Entrant& answer = entrants[decision.answer];
  const TuneSpace& space = plan_.spaces[answer.space];
  const Entrant base{answer.space, space.grid.base()};
  std::vector<Entrant> shown;
  const auto add = [&](const std::string& what, const Entrant& entrant) {
    if (std::ranges::find(shown, entrant) != shown.end()) return;
    shown.push_back(entrant);
    report.rows.push_back({what, plan_.spaces[entrant.space].name(entrant.setting), records_at(entrant, places_)});
  };
  add("answer", answer);
  if (decision.runner_up) add("runner-up", entrants[*decision.runner_up]);
  add("default", base);
  for (const std::size_t k : decision.tied) add("tied", entrants[k]);
  for (const Entrant& entrant : entrants)
    if (entrant.space != answer.space) add("best of its own", entrant);
  for (const TuneSetting& next : space.grid.steps(answer.setting, 1)) {
    const std::vector<const Record*> rows = records_at({answer.space, next}, places_);
    if (std::ranges::any_of(rows, [](const Record* row) { return row != nullptr; })) add("one step", {answer.space, next});
  }
  std::vector<TuneAnswer> answers;
  for (const Record* record : report.rows.front().rows) answers.push_back(tune_answer(*record, plan_.goal));
  report.is_feasible = standing(answers, places_.size(), plan_.goal.over).keeps_limits();
  for (const std::size_t k : decision.tied)
    if (k != decision.answer) report.tied.push_back(plan_.spaces[entrants[k].space].name(entrants[k].setting));
  if (plan_.goal.least.is_time() && report.is_feasible) report.chances = decision.chances;
  for (const Record* record : report.rows.front().rows) report.places.push_back(place_of(*record));
  report.answer_held = records_at(answer, held_);
  report.default_held = records_at(base, held_);
  for (const Record* record : report.answer_held) report.held.push_back(place_of(*record));
  report.effects = tune_effects(space, searches_.at(answer.space), answer.setting, places_.size(), plan_.goal.over);
}

void Tuning::add_scenes_left_out(TuneReport& report) {
  std::vector<std::vector<TuneAnswer>> settings;
  std::vector<std::string> scenes;
  for (const Job& place : places_) scenes.push_back(without_time(place.scene));
  for (const auto& [space, search] : searches_)
    for (const TuneSetting& setting : ranked(search, places_.size(), plan_.goal.over)) {
      settings.emplace_back();
      for (const std::optional<TuneAnswer>& answer : search.answers.at(setting)) settings.back().push_back(*answer);
      report.compared.push_back(plan_.spaces[space].name(setting));
    }
  report.scenes_left_out = leave_scenes_out(settings, scenes, plan_.goal.over);
}

void Tuning::add_notes(TuneReport& report) {
  report.seed = plan_.seed;
  for (const auto& [space, search] : searches_) {
    report.asked += search.asked;
    report.possible += plan_.spaces[space].grid.count() * static_cast<double>(places_.size());
    report.is_cut_short = report.is_cut_short || search.is_cut_short;
  }
  report.notes = notes_;
  for (const std::size_t number : active_) {
    const TuneSpace& space = plan_.spaces[number];
    if (!space.left_out.empty())
      report.notes.push_back(fmt::format("{}: not tuned: {}", space.technique, joined(space.left_out, ", ")));
    for (const TuneSpace::Parameter& parameter : space.parameters)
      if (!parameter.condition.empty())
        report.notes.push_back(fmt::format("{}: {} is skipped where it has no effect: it is for {}", space.technique,
                                           parameter.name, parameter.condition));
  }
  for (const Status status : {Status::unsupported, Status::failed}) {
    std::size_t count = 0;
    const Record* first = nullptr;
    for (const auto& [job, record] : records_) {
      if (record.status != status) continue;
      if (count++ == 0) first = &record;
    }
    if (first)
      report.notes.push_back(fmt::format("{} {} row{}, for example {}: {}", count, name(status), count == 1 ? "" : "s",
                                         title(*first), first->reason));
  }
}

}  // namespace gnomon::app
