#include "app/tune_run.h"

#include <gnomon/registry.h>

namespace gnomon::app {

Tuning::Tuning(TunePlan plan, SceneLibrary& library) : plan_(std::move(plan)), library_(library) {
  Suite& suite = plan_.run.suite;
  plan_.run.any_effort = true;
  SuiteGroup& group = suite.groups.front();
  for (const std::string& scene : group.scenes)
    if (const std::string missing = library.get(scene).missing; !missing.empty()) throw Error("{}", missing);
  group.contenders.push_back(contender_of({0, plan_.spaces.front().grid.base()}));
  places_ = expand_jobs(suite, library, plan_.run.worker).jobs;
  all_places_ = places_.size();
  // Times of the search are compared with one another; where none decides, one repetition is enough.
  search_suite_ = suite;
  search_suite_.processes = search_suite_.warmups = 1;
  if (!plan_.goal.is_timed()) search_suite_.repetitions = 1;
  search_suite_.pictures = Suite::Pictures::none;
}

double Tuning::possible() const {
  double count = 0;
  for (const TuneSpace& space : plan_.spaces) count += space.grid.count() * static_cast<double>(places_.size());
  return count;
}

Contender Tuning::contender_of(const Entrant& entrant) const {
  const TuneSpace& space = plan_.spaces[entrant.space];
  return {space.technique, space.settings(entrant.setting), "", false};
}

Contender Tuning::default_of(std::size_t space) const {
  return {plan_.spaces[space].technique, plan_.spaces[space].defaults(), "", false};
}

Job Tuning::job_of(const Contender& contender, const Job& place) {
  Job job = with_contender(place, contender, plan_.run.suite);
  const std::size_t ordinal = ordinals_.try_emplace(contender.name(), ordinals_.size()).first->second;
  job.place = ordinal * all_places_ + place.place;
  return job;
}

const Record* Tuning::record_of(const Contender& contender, const Job& place) {
  const std::string hash = job_of(contender, place).hash;
  if (const auto found = records_.find(hash); found != records_.end()) return &found->second;
  const auto probed = probed_.find(hash);
  return probed == probed_.end() ? nullptr : &probed->second.record;
}

std::vector<const Record*> Tuning::records_at(const Contender& contender, const std::vector<Job>& places) {
  std::vector<const Record*> rows;
  for (const Job& place : places) rows.push_back(record_of(contender, place));
  return rows;
}

std::vector<Job> Tuning::first_jobs() {
  std::vector<Job> jobs;
  for (std::size_t space = 0; space < plan_.spaces.size(); ++space)
    for (const Job& place : places_) jobs.push_back(job_of(contender_of({space, plan_.spaces[space].grid.base()}), place));
  return jobs;
}

/// The jobs of the rows that the folder has of these places.
std::vector<Job> Tuning::earlier_jobs() {
  std::vector<Job> jobs;
  if (!plan_.run.resume || !std::filesystem::exists(records_file(plan_.run.out))) return jobs;
  for (const Record& record : read_records(plan_.run.out)) {
    if (!registry().find_technique(record.technique)) continue;
    for (const Job& place : places_) {
      if (place.scene != record.scene || place.light != record.light || place.view != record.view) continue;
      if (Job job = job_of({record.technique, record.settings, "", false}, place); job.hash == record.job)
        jobs.push_back(std::move(job));
    }
  }
  return jobs;
}

void Tuning::run_jobs(std::span<const Job> jobs, const Suite& suite, bool is_limited) {
  if (jobs.empty()) return;
  Progress progress(plan_.is_quiet);
  const auto seen = [&](const Record& record) { records_.insert_or_assign(record.job, record); };
  folder_->add_rows(jobs, {suite, progress, seen, [&] { return is_limited && is_over(); }});
}

bool Tuning::answers(std::size_t space, const Job& place) {
  const Record* record = record_of(contender_of({space, plan_.spaces[space].grid.base()}), place);
  return record && tune_answer(*record, plan_.goal).is_there;
}

/// Leaves out places where nobody has an answer, and then whoever has none at another one.
void Tuning::drop_unanswered() {
  const auto why = [&](std::size_t space, const Job& place) {
    const Record* record = record_of(contender_of({space, plan_.spaces[space].grid.base()}), place);
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

/// Takes a quarter of the places out of the choice.
void Tuning::hold_out() {
  constexpr std::size_t least_places = 3;
  if (!plan_.holds_out_places || places_.size() < least_places) return;
  std::vector<Job> drawn = places_;
  Random(plan_.seed).shuffle(drawn);
  drawn.resize(places_.size() / 4 + (places_.size() < 4));
  for (const Job& job : drawn) {
    std::erase_if(places_, [&](const Job& place) { return place.place == job.place; });
    held_.push_back(job);
  }
}

std::vector<std::optional<TuneAnswer>> Tuning::ask(std::size_t space, std::span<const TuneQuestion> questions) {
  const auto job = [&](const TuneQuestion& question) {
    return job_of(contender_of({space, question.setting}), places_[question.place]);
  };
  std::vector<Job> jobs, unknown;
  for (const TuneQuestion& question : questions) jobs.push_back(job(question));
  std::vector<TuneQuestion> ordered(questions.begin(), questions.end());
  if (probe_) put_by_stages(plan_.spaces[space], ordered);
  for (const TuneQuestion& question : ordered)
    if (Job one = job(question); !records_.contains(one.hash)) unknown.push_back(std::move(one));
  drop_probed(space, unknown);
  run_jobs(select_jobs(plan_.run, std::move(unknown)), search_suite_, true);
  std::vector<std::optional<TuneAnswer>> answers;
  for (const Job& one : jobs) {
    const auto found = records_.find(one.hash);
    const auto probed = probed_.find(one.hash);
    if (found != records_.end())
      answers.emplace_back(tune_answer(found->second, plan_.goal));
    else
      answers.push_back(probed == probed_.end() ? std::nullopt : std::optional(probed->second.answer));
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
  read_probes();
  for (const Record& record : folder_->earlier().kept) records_.insert_or_assign(record.job, record);
  first.resize(base_count);
  std::erase_if(first, [&](const Job& job) { return records_.contains(job.hash); });
  run_jobs(first, search_suite_, false);
  drop_unanswered();
  hold_out();
  const double share = most_evaluations / static_cast<double>(active_.size());
  for (const std::size_t space : active_) {
    const double count = plan_.spaces[space].grid.count() * static_cast<double>(places_.size());
    const TuneSearchOptions options{.places = places_.size(),
                                    .over = plan_.goal.over,
                                    .whole = is_whole() || count <= share,
                                    .most_asked = most_asked(count, share),
                                    .seed = plan_.seed};
    if (has_probes()) probe_.emplace(plan_, plan_.spaces[space], library_);
    searches_[space] = search_grid(plan_.spaces[space].grid, options,
                                   [&](std::span<const TuneQuestion> questions) { return ask(space, questions); });
    probe_.reset();
  }
}

}  // namespace gnomon::app
