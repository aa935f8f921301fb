#pragma once
#include <fstream>

#include "app/tune_probe.h"
#include "report/analysis/tune_table.h"

namespace gnomon::app {

/// `gnomon tune --keep`: asks every setting at every place for its error and bytes, and writes the table that --replay reads.
/// The plan has one technique. Throws Error on scenes that are not fetched, and as WorkerClient does.
void keep_grid(TunePlan plan, SceneLibrary& library, const std::filesystem::path& file);

/// `gnomon tune --replay`: searches each of these kept grids (analysis/tune_replay.h) and prints a row for it: evaluations
/// asked of possible, and how far what was found is from the best.
void print_replays(std::span<const std::string> files, const TuneGoal& goal, std::uint64_t seed, std::size_t width);

/// One search in one folder: every evaluation is a row of it. The search asks one process for each; finalists are measured by
/// several.
class Tuning {
 public:
  /// Throws Error on scenes that are not fetched, and on lights and views that they lack.
  Tuning(TunePlan plan, SceneLibrary& library);
  std::size_t place_count() const { return places_.size(); }
  double possible() const;  ///< evaluations
  bool is_whole() const { return possible() <= most_evaluations; }
  /// The rows of the settings at which the searches begin.
  std::vector<Job> first_jobs();
  /// How a row of the search is run.
  const Suite& search_suite() const { return search_suite_; }

  /// Searches. Throws Error where no technique has an answer at any place, and as OpenRun does.
  void search();
  /// Whether the rows of all shards are there, as far as the search has got.
  bool is_shard() const { return plan_.run.shard_count > 1; }
  std::size_t row_count() const { return records_.size(); }
  /// Measures the finalists and decides. The records in the report live as long as this.
  TuneReport decided();

 private:
  struct Entrant {
    std::size_t space;
    TuneSetting setting;
    bool operator==(const Entrant&) const = default;
  };
  Contender contender_of(const Entrant& entrant) const;
  /// The technique's defaults with what is fixed.
  Contender default_of(std::size_t space) const;
  Job job_of(const Contender& contender, const Job& place);
  const Record* record_of(const Contender& contender, const Job& place);
  std::vector<const Record*> records_at(const Contender& contender, const std::vector<Job>& places);
  std::vector<Job> earlier_jobs();
  void run_jobs(std::span<const Job> jobs, const Suite& suite, bool is_limited);
  /// Whether times decide among settings whose masks must keep limits, and there are too many for a row of each.
  bool has_probes() const;
  void keep_probed(std::size_t space, const Job& job, const TuneProbe::Answer& said, double goal);
  void read_probes();
  void write_probe(const std::string& job, const TuneProbe::Answer& said);
  void drop_probed(std::size_t space, std::vector<Job>& unknown);
  double least_ms(const Job& job);
  bool is_over() const { return plan_.budget && seconds_since(start_) > *plan_.budget; }
  void drop_unanswered();
  void hold_out();
  bool answers(std::size_t space, const Job& place);
  std::vector<std::optional<TuneAnswer>> ask(std::size_t space, std::span<const TuneQuestion> questions);
  std::vector<Entrant> entrants();
  void measure(std::span<const Contender> contenders, int processes);
  TuneDecision decide_among(std::span<const Entrant> entrants);
  void add_rows(TuneReport& report, std::span<const Entrant> entrants, const TuneDecision& decision);
  void add_scenes_left_out(TuneReport& report);
  void add_notes(TuneReport& report);

  TunePlan plan_;
  SceneLibrary& library_;
  Suite search_suite_;
  std::vector<Job> places_, held_;  ///< rows of the first base; `place` is their number
  std::size_t all_places_ = 0;
  std::vector<std::size_t> active_;              ///< spaces that have an answer at every place
  std::map<std::size_t, TuneSearch> searches_;   ///< of active spaces
  std::map<std::string, std::size_t> ordinals_;  ///< of settings, by name, in the order in which they were asked
  std::map<std::string, Record> records_;        ///< by job
  /// By job, what a probe says of settings that are unsupported, break a limit, or are several times too slow: they need no
  /// row.
  struct Probed {
    TuneAnswer answer;
    Record record;  ///< with error and bytes, or why there are none; it is not in the folder
  };
  std::map<std::string, Probed> probed_;
  std::map<std::string, TuneProbe::Answer> earlier_probes_;  ///< by job, of the folder, where a search was stopped
  std::ofstream probes_;
  std::optional<TuneProbe> probe_;          ///< of the space that is searched
  std::map<std::string, double> least_ms_;  ///< of what it asked and keeps the limits, by place
  std::optional<OpenRun> folder_;
  std::vector<std::string> notes_;
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

}  // namespace gnomon::app
