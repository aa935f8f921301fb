#include "measure/run/estimate.h"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <numeric>

#include "measure/part_file.h"
#include "measure/paths.h"
#include "measure/record/record_members.h"
#include "measure/row/kept_row.h"
#include "measure/run/motion_walk.h"
#include "measure/run/timing.h"

namespace gnomon {

namespace fs = std::filesystem;

namespace {

/// Seconds that one process spends on warm-ups and repetitions of a stage of `ms`, as a batch times it: fewer warm-ups when
/// they take long, one repetition when it does, and several calls for a sample of a short one.
double stage_seconds(double ms, int iterations, const Effort& effort) {
  double spent = 0;
  for (int k = 0; k < effort.warmups && spent < 300; ++k) spent += ms;
  const int repetitions = ms > 500 ? 1 : effort.repetitions;
  return (spent + ms * repetitions * iterations) / 1000;
}

double timed_seconds(const RowCost& cost, const Effort& effort) {
  double sum =
      cost.motion > 0 ? stage_seconds(cost.motion, motion_iterations(cost.motion, std::max(cost.frames, 2) - 1), effort) : 0;
  for (const double ms : cost.stages) sum += stage_seconds(ms, iterations_for(ms), effort);
  return sum;
}

void for_each_field(MaybeConst<RowCost> auto& r, const auto& use) {
  use("job", r.job, "scene", r.scene, "technique", r.technique, "settings", r.settings, "path", r.path);
  use("width", r.width, "height", r.height, "machine", r.machine);
  use("once", r.once, "process", r.process, "stages", r.stages, "measured", r.is_measured);
  use("frames", r.frames, "motion", r.motion);
}

double pixels(int width, int height) { return static_cast<double>(width) * height; }

/// The cost of a row as it would be for the job, in another picture size and with more or fewer frames: what is done for each
/// pixel and frame scales, the rest stays. Where the job's geometry moves and the row's does not, its frames are taken to cost
/// what another scene costs, by the default of update.
RowCost scaled_to(RowCost cost, const Job& job) {
  const double ratio = pixels(job.width, job.height) / std::max(1.0, pixels(cost.width, cost.height));
  cost.once *= ratio;
  if (cost.is_measured && cost.frames > 0) cost.once *= static_cast<double>(job.frame_count) / cost.frames;
  cost.stages[2] *= ratio;
  if (!job.times)
    cost.motion = 0;
  else if (cost.motion <= 0)
    cost.motion = std::accumulate(cost.stages.begin(), cost.stages.end(), 0.0);
  return cost;
}

/// Size of a file of costs: several times that of ours. A larger one is not ours.
constexpr std::uintmax_t most_bytes = 64 << 20;

/// Members of a record that its cost does not depend on, and that are most of its line.
constexpr std::string_view costless[] = {"metrics", "causes",     "cause_errors", "own_causes",
                                         "counts",  "parameters", "scene_facts",  "floor"};

/// Lines that are no costs are left out.
std::vector<RowCost> costs_in(std::istream& lines) {
  std::vector<RowCost> costs;
  for (std::string line; std::getline(lines, line);) try {
      const Json fields = parse_json(line);
      RowCost cost;
      // Lines of earlier versions have neither: of stills they are known all the same.
      const auto may_lack = [](std::string_view key) { return key == "frames" || key == "motion"; };
      for_each_field(cost, UseFields{[&](const char* key, auto& value) {
                       if (fields.contains(key) || !may_lack(key)) fields.at(key).get_to(value);
                     }});
      if (!fields.contains("frames") && !cost.path.empty()) cost.frames = 0;
      costs.push_back(std::move(cost));
    } catch (const Json::exception&) {  // of another version, or damaged: it is learned again
    }
  return costs;
}

std::string lines_of(std::span<const RowCost> costs) {
  std::string text;
  for (const RowCost& cost : costs) {
    Json fields;
    for_each_field(cost, UseFields{[&](const char* key, const auto& value) { fields[key] = value; }});
    text += json_text(fields) + '\n';
  }
  return text;
}

/// From 0, the same job, to 6, nothing in common.
int distance(const RowCost& cost, const Job& job) {
  if (cost.job == job.hash) return 0;
  const bool same_technique = cost.technique == job.contender.technique;
  const bool same_contender = same_technique && cost.settings == job.contender.settings;
  const bool same_scene = cost.scene == job.scene && cost.path == job.path;
  if (same_scene && same_contender) return cost.width == job.width && cost.height == job.height ? 1 : 2;
  if (same_scene && same_technique) return 3;
  return same_contender ? 4 : same_technique ? 5 : 6;
}

/// One writer at a time, for as long as it lives.
class WriterLock {
 public:
  explicit WriterLock(const fs::path& file) {
    if (file.has_parent_path()) make_folder(file.parent_path());
    try {
      make_way(file);
    } catch (const Error& error) {
      throw Error("{} cannot be locked: {}", file.string(), error.what());
    }
    descriptor_ = open(file.c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK, 0666);
    int locked = -1;
    while (descriptor_ >= 0 && (locked = flock(descriptor_, LOCK_EX)) != 0 && errno == EINTR) {
    }
    if (locked == 0) return;
    const int why = errno;
    if (descriptor_ >= 0) close(descriptor_);
    throw Error("{} cannot be locked: {}", file.string(), std::strerror(why));
  }
  WriterLock(const WriterLock&) = delete;
  WriterLock& operator=(const WriterLock&) = delete;
  ~WriterLock() { close(descriptor_); }

 private:
  int descriptor_ = -1;
};

}  // namespace

double RowCost::seconds(const Effort& effort) const {
  // An unsupported row is over after its first answer.
  return is_measured ? once + effort.processes * (process + timed_seconds(*this, effort)) : once;
}

std::string machine_name(const Json& context) {
  const auto text = [&](const char* key) { return context.contains(key) ? json_text(context[key]) : "null"; };
  return fmt::format("{} cores {} threads {}", text("processor"), text("cores"), text("threads"));
}

RowCost cost_of(const Record& record, int warmups, double opening) {
  RowCost cost{.job = record.job,
               .scene = record.scene,
               .technique = record.technique,
               .settings = record.settings,
               .path = record.path,
               .width = record.width,
               .height = record.height,
               .frames = frame_count(record),
               .machine = machine_name(record.context),
               .is_measured = record.status == Status::ok,
               .once = record.seconds.value_or(0),
               .stages = {}};
  if (!cost.is_measured) return cost;
  cost.motion = median_of_medians(record.times(Stage::update)).value_or(0);
  for (const Stage stage : frame_stages) cost.motion += median_of_medians(record.moving_times(stage)).value_or(0);
  Effort effort{.processes = static_cast<int>(record.times(Stage::resolve).size()), .warmups = warmups, .repetitions = 0};
  for (std::size_t k = 0; k < std::size(timed_stages); ++k) {
    const ProcessTimes& times = record.times(timed_stages[k]);
    cost.stages[k] = median_of_medians(times).value_or(0);
    for (const std::vector<double>& process : times)
      effort.repetitions = std::max(effort.repetitions, static_cast<int>(process.size()));
  }
  // Build is timed once per process and is in the records of all lights: what cannot have been spent is taken off it.
  const double total = cost.once, processes = std::max(1, effort.processes);
  if (processes * timed_seconds(cost, effort) > total) cost.stages[0] = 0;
  const double setup = median_of_medians(record.times(Stage::setup)).value_or(0) / 1000;
  const double rest = std::max(0.0, total - processes * timed_seconds(cost, effort));
  cost.process = std::min(opening + setup, rest / processes);
  cost.once = rest - processes * cost.process;
  return cost;
}

std::vector<RowCost> History::read() const {
  if (!is_plain_file(file_) || fs::file_size(file_) > most_bytes) return {};
  std::ifstream stream(file_, std::ios::binary);
  return costs_in(stream);
}

void History::add(std::span<const RowCost> costs) const {
  if (costs.empty() || is_of_another_user(file_.parent_path())) return;
  const WriterLock lock(fs::path(file_) += ".lock");
  std::vector<RowCost> all = read();
  std::set<std::pair<std::string, std::string>> fresh;
  for (const RowCost& cost : costs) fresh.emplace(cost.job, cost.machine);
  std::erase_if(all, [&](const RowCost& cost) { return fresh.contains({cost.job, cost.machine}); });
  all.insert(all.end(), costs.begin(), costs.end());
  if (all.size() > most_rows) all.erase(all.begin(), all.end() - static_cast<std::ptrdiff_t>(most_rows));
  write_file(file_, lines_of(all));
}

History own_history() { return History(cache_root() / "history.jsonl"); }

std::vector<RowCost> shipped_costs() {
  std::vector<fs::path> files;
  std::string stamp = "costs 2";  // one more when cost_of computes something else from a record
  std::error_code none;
  for (const fs::directory_entry& entry : fs::directory_iterator(data_root() / "results", none)) {
    const fs::path file = records_file(entry.path());
    const auto size = fs::file_size(file, none);
    if (none) continue;
    files.push_back(file);
    stamp += fmt::format("|{} {} {}", file.string(), size, fs::last_write_time(file, none).time_since_epoch().count());
  }
  // Reading what costs depend on takes a second of all records, reading their costs a tenth of that: the costs are kept.
  const fs::path kept = cache_root() / "shipped_costs.jsonl";
  std::ifstream lines(is_plain_file(kept) && fs::file_size(kept) <= most_bytes ? kept : fs::path(), std::ios::binary);
  if (std::string known; std::getline(lines, known) && known == stamp) return costs_in(lines);

  std::vector<RowCost> costs;
  for (const fs::path& file : files) try {
      std::ifstream records(file, std::ios::binary);
      for (std::string line; std::getline(records, line);) {
        costs.push_back(cost_of(record_of(parse_json(without_members(line, costless)))));
        // A machine of the same make is another one.
        costs.back().machine = fmt::format("results/{}: {}", file.parent_path().filename().string(), costs.back().machine);
      }
    } catch (const Error&) {  // of another version: an estimate can do without
    } catch (const Json::exception&) {
    }
  if (fs::is_directory(kept.parent_path(), none) && !is_of_another_user(kept.parent_path()))
    try {  // an estimate alone creates no folder
      write_file(kept, stamp + '\n' + lines_of(costs));
    } catch (const Error&) {  // it is read again
    }
  return costs;
}

Estimator::Estimator(std::vector<RowCost> costs, std::string machine) : costs_(std::move(costs)), machine_(std::move(machine)) {
  std::map<std::string, std::vector<double>> ratios;
  std::map<std::string, double> own_seconds;
  for (const RowCost& cost : costs_)
    if (cost.machine == machine_ && cost.is_measured) own_seconds[cost.job] = cost.seconds({});
  for (const RowCost& cost : costs_) {
    if (cost.machine == machine_ || !cost.is_measured) continue;
    const auto own = own_seconds.find(cost.job);
    if (own != own_seconds.end() && cost.seconds({}) > 0) ratios[cost.machine].push_back(own->second / cost.seconds({}));
  }
  for (RowCost& cost : costs_) {
    if (cost.machine == machine_) continue;
    const std::vector<double>& known = ratios[cost.machine];
    const double ratio = known.size() < 5 ? 1 : median(known);
    cost.once *= ratio;
    cost.process *= ratio;
    for (double& ms : cost.stages) ms *= ratio;
  }
}

TimeEstimate Estimator::operator()(std::span<const Job> jobs, const Effort& effort) const {
  TimeEstimate result;
  for (const Job& job : jobs) {
    std::vector<double> found;  // seconds by the nearest rows; at one distance, those of this machine come first
    int nearest = std::numeric_limits<int>::max();
    for (const RowCost& cost : costs_) {
      const int rank = 2 * distance(cost, job) + (cost.machine == machine_ ? 0 : 1);
      if (rank > nearest || (rank > 1 && !cost.is_measured)) continue;
      if (rank < nearest) found.clear();
      nearest = rank;
      found.push_back(scaled_to(cost, job).seconds(effort));
    }
    if (!found.empty()) result.seconds += median(found);
    ++(found.empty() ? result.unknown : nearest == 0 ? result.here : nearest == 1 ? result.elsewhere : result.similar);
  }
  return result;
}

std::string text(const TimeEstimate& estimate) {
  std::vector<std::string> parts;
  const auto part = [&](std::size_t count, const char* what) {
    if (count) parts.push_back(fmt::format("{} {}", count, what));
  };
  part(estimate.here, "measured on this machine");
  part(estimate.elsewhere, "measured elsewhere");
  part(estimate.similar, "guessed from similar rows");
  if (parts.empty()) return "estimated time: nothing is known yet; a run that ends here is remembered";
  const std::size_t space = parts.front().find(' ');
  parts.front().insert(space, parts.front().starts_with("1 ") ? " row" : " rows");
  return fmt::format("estimated time: {} (from {})", duration_text(estimate.seconds), joined(parts, ", "));
}

}  // namespace gnomon
