// The second half of a search: finalists, the decision, and what is said of it.
#include "analysis/in_order.h"
#include "app/tune_run.h"
#include "measure/scene/time_reference.h"

namespace gnomon::app {

namespace {

/// Of finalists: from fewer processes no interval covers much, and where five leave a tie fifteen may end it.
constexpr int final_processes = 5, tied_processes = 15;

/// Settings whose time in one process is within this factor of the least may be the fastest.
constexpr double near_least = 1.25;
constexpr std::size_t most_timed = 8, most_exact = 3;  ///< finalists

}  // namespace

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
    const bool is_runner_up = chosen.size() < 2 && standing.keeps_limits() == best.keeps_limits();
    if (is_runner_up || (is_near && chosen.size() < (is_timed ? most_timed : most_exact))) chosen.push_back(entrant);
  }
  for (const Entrant& entrant : best_of_each) add_once(chosen, entrant);
  return chosen;
}

/// Runs rows that have fewer processes, or no picture where the run has some.
void Tuning::measure(std::span<const Contender> contenders, int processes) {
  Suite suite = plan_.run.suite;
  suite.processes = processes;
  std::vector<Job> jobs;
  for (const std::vector<Job>* places : {&places_, &held_})
    for (const Job& place : *places)
      for (const Contender& contender : contenders) {
        const Record* record = record_of(contender, place);
        const bool is_done = record && (record->status != Status::ok ||
                                        record->times(Stage::resolve).size() >= static_cast<std::size_t>(processes));
        if (!is_done) jobs.push_back(job_of(contender, place));
      }
  run_jobs(jobs, suite, false);
}

TuneDecision Tuning::decide_among(std::span<const Entrant> entrants) {
  std::vector<TuneFinalist> finalists;
  for (const Entrant& entrant : entrants) {
    TuneFinalist& finalist = finalists.emplace_back();
    const TuneSpace& space = plan_.spaces[entrant.space];
    for (std::size_t k = 0; k < space.parameters.size(); ++k)
      finalist.changes += space.grid.has_effect(k, entrant.setting) &&
                          space.parameters[k].values[entrant.setting[k]] != space.parameters[k].base;
    for (const Record* record : records_at(contender_of(entrant), places_)) {
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
  // Where a search begins, most often the default, is there however little of a grid was asked: an answer is no worse.
  for (const std::size_t space : active_) add_once(finalists, Entrant{space, plan_.spaces[space].grid.base()});
  std::vector<Contender> measured;
  for (const Entrant& entrant : finalists) measured.push_back(contender_of(entrant));
  const auto is_measured = [&](const Contender& contender) {
    return std::ranges::any_of(measured, [&](const Contender& one) { return one.name() == contender.name(); });
  };
  for (const std::size_t space : active_)
    if (const Contender base = default_of(space); !is_measured(base)) measured.push_back(base);
  measure(measured, plan_.processes ? plan_.processes : final_processes);
  TuneDecision decision = decide_among(finalists);
  if (decision.tied.size() > 1 && plan_.goal.least.is_time() && !plan_.processes) {
    measured.clear();
    for (const std::size_t k : decision.tied) measured.push_back(contender_of(finalists[k]));
    measure(measured, tied_processes);
    decision = decide_among(finalists);
  }
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
  const auto add = [&](const std::string& what, const Contender& contender) {
    const std::string name = contender.name();
    if (std::ranges::find(report.rows, name, &TuneRow::name) != report.rows.end()) return;
    std::vector<const Record*> rows = records_at(contender, places_);
    if (std::ranges::any_of(rows, [](const Record* row) { return row != nullptr; }))
      report.rows.push_back({what, name, std::move(rows)});
  };
  add("answer", contender_of(answer));
  if (decision.runner_up) add("runner-up", contender_of(entrants[*decision.runner_up]));
  add("default", default_of(answer.space));
  for (const std::size_t k : decision.tied) add("tied", contender_of(entrants[k]));
  for (const Entrant& entrant : entrants)
    if (entrant.space != answer.space) add("best " + plan_.spaces[entrant.space].technique, contender_of(entrant));
  for (const TuneSetting& next : space.grid.steps(answer.setting, 1)) add("one step", contender_of({answer.space, next}));
  std::vector<TuneAnswer> answers;
  for (const Record* record : report.rows.front().rows) answers.push_back(tune_answer(*record, plan_.goal));
  report.is_feasible = standing(answers, places_.size(), plan_.goal.over).keeps_limits();
  for (const std::size_t k : decision.tied)
    if (k != decision.answer) report.tied.push_back(plan_.spaces[entrants[k].space].name(entrants[k].setting));
  if (plan_.goal.least.is_time() && report.is_feasible) report.chances = decision.chances;
  for (const Record* record : report.rows.front().rows) report.places.push_back(place_of(*record));
  report.answer_held = records_at(contender_of(answer), held_);
  report.default_held = records_at(default_of(answer.space), held_);
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
    std::vector<std::string> skipped = space.skipped;
    for (const TuneSpace::Parameter& parameter : space.parameters)
      if (!parameter.condition.empty()) skipped.push_back(fmt::format("{} (for {})", parameter.name, parameter.condition));
    if (!skipped.empty())
      report.notes.push_back(fmt::format("{}: skipped where it has no effect: {}", space.technique, joined(skipped, ", ")));
  }
  for (const Status status : {Status::unsupported, Status::failed}) {
    std::size_t count = 0;
    const Record* first = nullptr;
    const auto see = [&](const Record& record) {
      if (record.status == status && count++ == 0) first = &record;
    };
    for (const auto& [job, record] : records_) see(record);
    for (const auto& [job, probed] : probed_) see(probed.record);
    if (first)
      report.notes.push_back(fmt::format("{} {} evaluation{}, for example {}: {}", count, name(status), count == 1 ? "" : "s",
                                         title(*first), first->reason));
  }
}

}  // namespace gnomon::app
