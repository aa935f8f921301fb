#include "measure/run/estimate.h"

#include <fcntl.h>
#include <gnomon/error.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <map>
#include <set>

#include "measure/part_file.h"
#include "measure/paths.h"
#include "measure/progress.h"
#include "measure/run/timing.h"
#include "measure/scene/blob.h"

namespace gnomon {

namespace fs = std::filesystem;

namespace {

/// Seconds that one process spends on warm-ups and repetitions of a stage of `ms`, as a batch times it: fewer warm-ups when
/// they take long, one repetition when it does, and several calls for a sample of a short one.
double stage_seconds(double ms, const Effort& effort) {
  double spent = 0;
  for (int k = 0; k < effort.warmups && spent < 300; ++k) spent += ms;
  const int repetitions = ms > 500 ? 1 : effort.repetitions;
  return (spent + ms * repetitions * iterations_for(ms)) / 1000;
}

double timed_seconds(const std::array<double, 3>& stages, const Effort& effort) {
  double sum = 0;
  for (const double ms : stages) sum += stage_seconds(ms, effort);
  return sum;
}

/// Calls use(key, member) for every field, for writing and for reading.
void for_each_field(auto& cost, const auto& use) {
  use("job", cost.job);
  use("scene", cost.scene);
  use("technique", cost.technique);
  use("settings", cost.settings);
  use("path", cost.path);
  use("width", cost.width);
  use("height", cost.height);
  use("machine", cost.machine);
  use("once", cost.once);
  use("process", cost.process);
  use("stages", cost.stages);
  use("measured", cost.is_measured);
}

double pixels(int width, int height) { return static_cast<double>(width) * height; }

/// The cost of a row as it would be in another picture size: what is done for each pixel scales, the rest stays.
RowCost scaled_to(RowCost cost, int width, int height) {
  const double ratio = pixels(width, height) / std::max(1.0, pixels(cost.width, cost.height));
  cost.once *= ratio;
  cost.stages[2] *= ratio;
  return cost;
}

/// Of a file of costs: some times what ours have. A larger one is not ours.
constexpr std::uintmax_t most_bytes = 64 << 20;

/// Lines that are no costs are left out.
std::vector<RowCost> costs_in(std::istream& lines) {
  std::vector<RowCost> costs;
  for (std::string line; std::getline(lines, line);) try {
      const Json fields = parse_json(line);
      RowCost cost;
      for_each_field(cost, [&](const char* key, auto& value) { fields.at(key).get_to(value); });
      costs.push_back(std::move(cost));
    } catch (const Json::exception&) {  // of another version, or damaged: it is learned again
    }
  return costs;
}

std::string lines_of(std::span<const RowCost> costs) {
  std::string text;
  for (const RowCost& cost : costs) {
    Json fields;
    for_each_field(cost, [&](const char* key, const auto& value) { fields[key] = value; });
    text += json_text(fields) + '\n';
  }
  return text;
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
  // An unsupported row asks once and is over.
  return is_measured ? once + effort.processes * (process + timed_seconds(stages, effort)) : once;
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
               .machine = machine_name(record.context),
               .is_measured = record.status == Status::ok,
               .once = record.seconds.value_or(0),
               .stages = {}};
  if (!cost.is_measured) return cost;
  Effort effort{.processes = static_cast<int>(record.times(Stage::resolve).size()), .warmups = warmups, .repetitions = 0};
  for (std::size_t k = 0; k < std::size(timed_stages); ++k) {
    const ProcessTimes& times = record.times(timed_stages[k]);
    cost.stages[k] = median_of_medians(times).value_or(0);
    for (const std::vector<double>& process : times)
      effort.repetitions = std::max(effort.repetitions, static_cast<int>(process.size()));
  }
  // Build is timed once per process and stands in the records of all lights: what cannot have been spent is taken off it.
  const double total = cost.once, processes = std::max(1, effort.processes);
  if (processes * timed_seconds(cost.stages, effort) > total) cost.stages[0] = 0;
  const double setup = median_of_medians(record.times(Stage::setup)).value_or(0) / 1000;
  const double rest = std::max(0.0, total - processes * timed_seconds(cost.stages, effort));
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
  std::string stamp = "costs 1";  // one more when cost_of says something else of a record
  std::error_code none;
  for (const fs::directory_entry& entry : fs::directory_iterator(data_root() / "results", none)) {
    const fs::path file = records_file(entry.path());
    const auto size = fs::file_size(file, none);
    if (none) continue;
    files.push_back(file);
    stamp += fmt::format("|{} {} {}", file.string(), size, fs::last_write_time(file, none).time_since_epoch().count());
  }
  // All records take a second to read, their costs a tenth of that: they are kept.
  const fs::path kept = cache_root() / "shipped_costs.jsonl";
  std::ifstream lines(is_plain_file(kept) && fs::file_size(kept) <= most_bytes ? kept : fs::path(), std::ios::binary);
  if (std::string known; std::getline(lines, known) && known == stamp) return costs_in(lines);

  std::vector<RowCost> costs;
  for (const fs::path& file : files) try {
      for (const Record& record : read_record_file(file).records) {
        costs.push_back(cost_of(record));
        // A machine of the same make is another one.
        costs.back().machine = fmt::format("results/{}: {}", file.parent_path().filename().string(), costs.back().machine);
      }
    } catch (const Error&) {  // of another version: an estimate can do without
    }
  if (fs::is_directory(kept.parent_path(), none) && !is_of_another_user(kept.parent_path()))
    try {  // who only asks for a price leaves no folder behind
      write_file(kept, stamp + '\n' + lines_of(costs));
    } catch (const Error&) {  // it is read again
    }
  return costs;
}

Estimator::Estimator(std::vector<RowCost> costs, std::string machine) {
  std::map<std::string, std::vector<double>> ratios;
  std::map<std::string, double> own_seconds;
  for (const RowCost& cost : costs)
    if (cost.machine == machine && cost.is_measured) own_seconds[cost.job] = cost.seconds({});
  for (const RowCost& cost : costs) {
    if (cost.machine == machine || !cost.is_measured) continue;
    const auto own = own_seconds.find(cost.job);
    if (own != own_seconds.end() && cost.seconds({}) > 0) ratios[cost.machine].push_back(own->second / cost.seconds({}));
  }
  for (RowCost& cost : costs) {
    if (cost.machine == machine) {
      here_.push_back(std::move(cost));
      continue;
    }
    const std::vector<double>& known = ratios[cost.machine];
    const double ratio = known.size() < 5 ? 1 : median(known);
    cost.once *= ratio;
    cost.process *= ratio;
    for (double& ms : cost.stages) ms *= ratio;
    elsewhere_.push_back(std::move(cost));
  }
}

TimeEstimate Estimator::operator()(std::span<const Job> jobs, const Effort& effort) const {
  using Near = bool (*)(const RowCost&, const Job&);
  static constexpr auto technique = [](const RowCost& c, const Job& j) { return c.technique == j.contender.technique; };
  static constexpr auto contender = [](const RowCost& c, const Job& j) {
    return technique(c, j) && c.settings == j.contender.settings;
  };
  static constexpr auto scene = [](const RowCost& c, const Job& j) { return c.scene == j.scene && c.path == j.path; };
  static constexpr Near levels[] = {
      [](const RowCost& c, const Job& j) { return c.job == j.hash; },
      [](const RowCost& c, const Job& j) {
        return scene(c, j) && contender(c, j) && c.width == j.width && c.height == j.height;
      },
      [](const RowCost& c, const Job& j) { return scene(c, j) && contender(c, j); },
      [](const RowCost& c, const Job& j) { return scene(c, j) && technique(c, j); },
      [](const RowCost& c, const Job& j) { return contender(c, j); },
      [](const RowCost& c, const Job& j) { return technique(c, j); },
      [](const RowCost&, const Job&) { return true; },
  };
  TimeEstimate result;
  for (const Job& job : jobs) {
    std::vector<double> found;
    const auto look = [&](const std::vector<RowCost>& costs, std::size_t level) {
      for (const RowCost& cost : costs)
        if ((level == 0 || cost.is_measured) && levels[level](cost, job))
          found.push_back(scaled_to(cost, job.width, job.height).seconds(effort));
      return !found.empty();
    };
    for (std::size_t level = 0; level < std::size(levels) && found.empty(); ++level)
      if (look(here_, level))
        ++(level == 0 ? result.here : result.similar);
      else if (look(elsewhere_, level))
        ++(level == 0 ? result.elsewhere : result.similar);
    if (found.empty())
      ++result.unknown;
    else
      result.seconds += median(found);
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
