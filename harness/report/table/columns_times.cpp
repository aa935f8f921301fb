#include <memory>

#include "analysis/analysis.h"
#include "report/table/columns.h"

namespace gnomon {

namespace {

/// Intervals by times, each computed once: the columns of both ends need the same one.
using Intervals = std::map<ProcessTimes, std::optional<Estimate>>;

std::optional<Estimate> interval_of(const ProcessTimes& times, Intervals& known) {
  constexpr std::size_t most_known = 1000;  // those of a group of rows
  if (known.size() >= most_known) known.clear();
  const auto [found, is_new] = known.try_emplace(times);
  if (is_new) found->second = bootstrap(times);
  return found->second;
}

/// Median absolute deviation of the process medians: how far one process is from another.
std::optional<double> spread(const ProcessTimes& times) {
  std::vector<double> medians;
  for (const std::vector<double>& process : times)
    if (!process.empty()) medians.push_back(median(process));
  return medians.size() < 2 ? std::nullopt : std::optional(median_absolute_deviation(medians));
}

/// The median of a time with the ends of its interval and how far processes are from one another.
void add_part(std::vector<Column>& columns, TimedPart part) {
  const std::string column_name(name(part));
  const auto add = [&](const char* suffix, const char* heading) -> Column& {
    columns.push_back(number_column(column_name + "_ms" + suffix, "ms", with_blanks(column_name) + heading));
    return columns.back();
  };
  const auto intervals = std::make_shared<Intervals>();
  const auto add_end = [&](const char* suffix, const char* heading, double Estimate::*end) {
    add(suffix, heading).cell = [intervals, part, end](const Record& r) {
      const std::optional<Estimate> estimate = interval_of(times_of(r, part), *intervals);
      return estimate ? Cell{.value = (*estimate).*end} : Cell{};
    };
  };
  Column& median = add("", "");
  median.better = "lower";
  median.cell = [part](const Record& r) { return number(median_of_medians(times_of(r, part))); };
  median.log_time = [part](const Record& r) { return log_time(times_of(r, part)); };
  add_end("_low", " low", &Estimate::low);
  add_end("_high", " high", &Estimate::high);
  add("_mad", " MAD").cell = [part](const Record& r) { return number(spread(times_of(r, part))); };
}

/// The cost of geometry that moves, with the ends of its interval: the sum of three parts.
void add_motion(std::vector<Column>& columns) {
  columns.push_back(number_column("motion_ms", "ms", "motion"));
  Column& sum = columns.back();
  sum.better = "lower";
  sum.sentence = fmt::format("What moved geometry costs: {}, in the frames of an animation.", sentence(Cost::motion));
  sum.cell = [](const Record& r) { return number(quantity(r, "motion_ms")); };
  sum.log_time = [](const Record& r) { return sample_of(r, parts_of(Cost::motion)).log_time(); };
  const auto add_end = [&](const char* suffix, const char* heading, double ValueWithInterval::*end) {
    columns.push_back(number_column(fmt::format("motion_ms{}", suffix), "ms", fmt::format("motion{}", heading)));
    columns.back().cell = [end](const Record& r) {
      const std::optional<ValueWithInterval> cost = cost_of(r, Cost::motion);
      return cost && cost->has_interval ? Cell{.value = (*cost).*end} : Cell{};
    };
  };
  add_end("_low", " low", &ValueWithInterval::low);
  add_end("_high", " high", &ValueWithInterval::high);
}

}  // namespace

void add_times(std::vector<Column>& columns) {
  for (const TimedPart part : all_parts) add_part(columns, part);
  add_motion(columns);
  for (const Stage stage : all_stages) {
    columns.push_back(number_column(fmt::format("{}_device_ms", name(stage)), "ms", fmt::format("{} on device", name(stage))));
    columns.back().cell = [stage](const Record& r) { return number(median_of_medians(r.device_times(stage))); };
  }
  for (const Stage stage : all_stages) {
    columns.push_back(
        number_column(fmt::format("{}_harness_ms", name(stage)), "ms", fmt::format("{} by harness", name(stage))));
    columns.back().cell = [stage](const Record& r) { return number(median_of_medians(r.harness_times(stage))); };
  }
  columns.push_back(text_column("floor", "bare pass", [](const Record& r) { return text_cell(r.floor ? r.floor->pass : ""); }));
  columns.back().sentence = "The barest pass that the technique cannot do without, as its data sheet says.";
  columns.push_back(number_column("floor_ms", "ms", "bare pass",
                                  [](const Record& r) { return r.floor ? number(median_of_medians(r.floor->ms)) : Cell{}; }));
  columns.push_back(number_column("floor_device_ms", "ms", "bare pass on device", [](const Record& r) {
    return r.floor ? number(median_of_medians(r.floor->device_ms)) : Cell{};
  }));
  columns.push_back(share_column("floor_share", "bare share", [](const Record& r) { return number(floor_share(r)); }));
  columns.back().sentence =
      "What part of a frame (relight and resolve) its bare pass takes, by the device's clock where there is one.";
  columns.push_back(ray_column("rays_per_second", "rays", [](const Record& r) { return number(rays_per_second(r)); }));
  columns.back().sentence =
      "Count rays over the time of a frame (relight and resolve), by the device's clock where there is one.";
  columns.push_back(text_column("clocks", "clocks", [](const Record& r) {
    const std::optional<bool> agree = clocks_agree(r);
    return text_cell(!agree ? "" : *agree ? "agree" : "disagree");
  }));
  columns.back().sentence =
      "Whether the device's clock and the host's can both be right: nothing takes longer by the device's, and a bare pass not "
      "half as long.";
  columns.push_back(
      whole_column("processes", "", "processes", [](const Record& r) { return count_cell(r.times(Stage::resolve).size()); }));
  columns.push_back(whole_column("repetitions", "", "repetitions", [](const Record& r) {
    std::size_t most = 0;
    for (const std::vector<double>& process : r.times(Stage::resolve)) most = std::max(most, process.size());
    return count_cell(most);
  }));
  columns.push_back(text_column("stop", "stopped by", [](const Record& r) { return text_cell(r.stop); }));
}

}  // namespace gnomon
