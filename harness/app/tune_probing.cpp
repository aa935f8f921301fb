// Which settings need no row of their own: a probe of their masks says that they break a limit, or are far too slow.
#include "app/tune_run.h"

namespace gnomon::app {

namespace {

namespace fs = std::filesystem;

/// Calls of a probe are few, and other work on the machine delays some of them.
constexpr double far_too_slow = 4;

/// A number that a mask has without noise, as a probe answers it.
bool is_probed(const TuneNumber& number) { return number.name == "error" || number.name == "bytes"; }

/// By the limits that a probe can judge.
double beyond(const TuneGoal& goal, const KeptGrid::Numbers& numbers) {
  double most = -1;
  for (const TuneLimit& limit : goal.each)
    if (is_probed(limit.number))
      most = std::max(most, limit.beyond(limit.number.name == "error" ? numbers.error : numbers.bytes));
  return most;
}

/// Whether a setting needs no row, however fast it is.
bool is_out(const TuneGoal& goal, const TuneProbe::Answer& said) { return !said.support || beyond(goal, said.numbers) > 0; }

Support support_in(const Json& said) {
  const std::string kind = said.value("support", ""), why = said.value("reason", "");
  if (kind == name(Support::Kind::unsupported)) return Support::unsupported(why);
  return kind == name(Support::Kind::approximate) ? Support::approximate(why) : Support::full();
}

/// The file of a search's folder with what probes answered of settings that have no row.
fs::path probes_file(const fs::path& folder) { return folder / "probes.jsonl"; }

/// Of a job, but for its contender.
std::string place_title(const Job& job) { return fmt::format("{} {} {}", job.scene, job.light, job.view); }

/// Whether relight and resolve tell how slow a setting is, and all limits are judged by its mask.
bool is_told_by_light(const TuneGoal& goal) {
  const bool is_judged = std::ranges::all_of(goal.each, [](const TuneLimit& limit) { return is_probed(limit.number); });
  return is_judged && (goal.least.cost == Cost::light || goal.least.name == "resolve_ms");
}

}  // namespace

bool Tuning::has_probes() const {
  return !is_whole() && !is_shard() && plan_.goal.least.is_time() &&
         std::ranges::any_of(plan_.goal.each, [](const TuneLimit& limit) { return is_probed(limit.number); });
}

void Tuning::keep_probed(std::size_t space, const Job& job, const TuneProbe::Answer& said, double goal) {
  const TuneAnswer answer{.is_there = static_cast<bool>(said.support),
                          .goal = goal,
                          .beyond = beyond(plan_.goal, said.numbers),
                          .gain = said.constant_error - said.numbers.error};
  Record record = *record_of(contender_of({space, plan_.spaces[space].grid.base()}), job);
  record.job = job.hash;
  record.settings = job.contender.settings;
  record.parameters = json_object();
  record.stages = record.device_stages = record.harness_stages = {};
  record.metrics.clear();
  record.bytes.reset();
  record.support = said.support.kind();
  record.reason = said.support.why();
  if (said.support) {
    record.metrics[record.truth] = {{"error", said.numbers.error}, {"constant_error", said.constant_error}};
    record.bytes = static_cast<std::uint64_t>(said.numbers.bytes);
  } else {
    record.status = Status::unsupported;
  }
  probed_.insert_or_assign(job.hash, Probed{answer, std::move(record)});
}

/// What the folder knows of a search that was stopped; a line that was cut off ends it.
void Tuning::read_probes() {
  if (!has_probes()) return;
  std::string line, known;
  for (std::ifstream file(probes_file(plan_.run.out)); std::getline(file, line);) {
    const Json said = Json::parse(line, nullptr, false);
    if (said.is_discarded()) break;
    known += line + "\n";
    TuneProbe::Answer answer{.support = support_in(said),
                             .numbers = {.error = said.value("error", 0.0), .bytes = said.value("bytes", 0.0)},
                             .constant_error = said.value("constant_error", 0.0)};
    earlier_probes_.insert_or_assign(said.value("job", ""), std::move(answer));
  }
  probes_.open(probes_file(plan_.run.out));
  probes_ << known << std::flush;
}

void Tuning::write_probe(const std::string& job, const TuneProbe::Answer& said) {
  Json line = json_object({{"job", job}, {"support", name(said.support.kind())}, {"reason", said.support.why()}});
  if (said.support)
    line.update({{"error", said.numbers.error}, {"bytes", said.numbers.bytes}, {"constant_error", said.constant_error}});
  probes_ << line.dump() << "\n" << std::flush;
}

/// Asks the probe for these jobs, and takes out those that it answers well enough.
void Tuning::drop_probed(std::size_t space, std::vector<Job>& unknown) {
  if (!probe_) return;
  struct Kept {
    TuneProbe::Answer said;
    double ms;
  };
  std::map<std::string, Kept> kept;  // those that keep the limits, by job
  const bool has_times = is_told_by_light(plan_.goal);
  Progress progress(plan_.is_quiet);
  progress.expect(static_cast<double>(unknown.size()));
  std::erase_if(unknown, [&](const Job& job) {
    progress.advance(1);
    if (probed_.contains(job.hash)) return true;
    if (const auto earlier = earlier_probes_.find(job.hash);
        earlier != earlier_probes_.end() && is_out(plan_.goal, earlier->second)) {
      keep_probed(space, job, earlier->second, INFINITY);
      return true;
    }
    if (is_over()) return true;
    try {
      const TuneProbe::Answer said = probe_->ask(job.contender.settings, job);
      if (is_out(plan_.goal, said)) {
        write_probe(job.hash, said);
        keep_probed(space, job, said, INFINITY);
        return true;
      }
      if (has_times) kept.emplace(job.hash, Kept{said, least_ms(job)});
    } catch (const WorkerFailure&) {  // its row says why
      probe_->forget();
    }
    return false;
  });
  std::erase_if(unknown, [&](const Job& job) {
    const auto found = kept.find(job.hash);
    if (found == kept.end() || found->second.ms <= far_too_slow * least_ms_.at(place_title(job))) return false;
    keep_probed(space, job, found->second.said, found->second.ms);
    return true;
  });
}

/// How long the probe took for what it answered last, the least that it takes; of a setting that seems too slow by more calls.
double Tuning::least_ms(const Job& job) {
  const auto sum = [&](const TuneProbe::Times& times) {
    return (plan_.goal.least.cost == Cost::light ? times.relight_ms : 0) + times.resolve_ms;
  };
  double ms = sum(probe_->times());
  double& least = least_ms_.try_emplace(place_title(job), ms).first->second;
  if (ms > far_too_slow * least) ms = sum(probe_->times_again());
  least = std::min(least, ms);
  return ms;
}

}  // namespace gnomon::app
