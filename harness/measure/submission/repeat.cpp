#include "measure/submission/repeat.h"

#include <gnomon/registry.h>

#include "measure/counted.h"
#include "measure/pattern.h"
#include "measure/program/plugin_facts.h"
#include "measure/scene/blob.h"
#include "measure/submission/numbers.h"

namespace gnomon {

namespace fs = std::filesystem;

namespace {

/// Why a row cannot be run here; empty where it can.
std::string obstacle(const Record& record) {
  if (record.status == Status::failed) return "it failed";
  if (!registry().find_technique(record.technique))
    return fmt::format("{} is not here: name it by --plugin or --program", record.technique);
  const Json plugin = plugin_facts(record.technique, record.settings);
  const std::string hash = plugin.is_object() ? plain_text(plugin.value("hash", Json(""))) : "";
  if (hash != plugin_hash(record)) return fmt::format("{} is of other code here", record.technique);
  return {};
}

std::string maker_words(const Record& record) {
  const auto plugin = record.context.find("plugin");
  return plugin != record.context.end() && plugin->is_object() && plugin->contains("maker") ? plain_text((*plugin)["maker"])
                                                                                            : "";
}

/// What drew or made the masks: rows of different ones may differ.
std::string renderer_of(const Record& record) {
  return context_text(record, "gl_renderer") + "\n" + context_text(record, "gl_version") + "\n" + maker_words(record);
}

/// The erratum that names the row; null where none does.
const Erratum* erratum_of(const Record& record, const Edition& edition) {
  for (const Erratum& erratum : edition.errata)
    if (erratum.technique == record.technique && applies(erratum) &&
        (erratum.rows.empty() || Pattern(erratum.rows, "of an erratum is no regular expression").is_in(title(record))))
      return &erratum;
  return nullptr;
}

/// Compares rows with the same rows run again.
class Comparison {
 public:
  Comparison(const fs::path& then, const fs::path& now, const Edition& edition, RepeatSummary& summary)
      : then_(then), now_(now), edition_(edition), summary_(summary) {}

  void compare(const Record& then, const Record& now) {
    if (renderer_of(then) != renderer_of(now)) return compare_drawn(then, now);
    std::vector<NumberDifference> found = number_differences(then, now);
    const bool is_same_processor = context_text(then, "processor") == context_text(now, "processor");
    if (!is_same_processor) found = of_tested_pixels(std::move(found));
    std::string what = found.empty() ? "" : first_of(found);
    if (what.empty() && is_same_processor && then.mask && now.mask)
      if (const std::size_t pixels = pixels_apart(then, then_ / *then.mask, now_ / *now.mask, 0); pixels > 0)
        what = fmt::format("its mask differs in {}", counted(pixels, "pixel{s}"));
    if (what.empty()) {
      ++summary_.equal;
    } else if (const Erratum* const erratum = erratum_of(then, edition_)) {
      ++summary_.not_repeated;
      summary_.notes.push_back(
          fmt::format("not repeated: {}: erratum of {}: {}", title(then), erratum->version, erratum->reason));
    } else {
      summary_.faults.push_back(fmt::format("run again, {} has other numbers: {}", title(then), what));
    }
  }

 private:
  void compare_drawn(const Record& then, const Record& now) {
    std::string what;
    if (then.status != now.status || then.support != now.support) {
      what = fmt::format("its status is {} here, and was {}", name(now.status), name(then.status));
    } else if (then.mask && now.mask) {
      const std::size_t pixels = pixels_apart(then, then_ / *then.mask, now_ / *now.mask, DriverDifferences::threshold);
      if (const std::size_t allowed = drivers_.pixels_of(then); pixels > allowed)
        what = fmt::format("{} of its mask by over 1/256, and {} may", counted(pixels, "pixel{s} differ{s|}"), allowed);
    }
    if (what.empty()) {
      ++summary_.within;
      return;
    }
    ++summary_.not_repeated;
    summary_.notes.push_back(fmt::format("not repeated: {}: drawn by another renderer; {}", title(then), what));
  }

  const fs::path& then_;
  const fs::path& now_;
  const Edition& edition_;
  RepeatSummary& summary_;
  DriverDifferences drivers_ = DriverDifferences::shipped();
};

/// Runs jobs by one process each, which is enough for all that is no time.
std::vector<Record> run_again(const std::vector<Job>& jobs, const Edition& edition, SceneLibrary& library,
                              const WorkerOptions& worker, const fs::path& out, Progress& progress) {
  RunOptions options;
  options.suite = edition.suite;
  options.suite.processes = 1;
  options.suite.repetitions = 1;
  options.suite.warmups = 1;
  options.suite.interval = 0;
  options.suite.pictures = Suite::Pictures::masks;
  options.out = out;
  options.worker = worker;
  OpenRun run(options, library, jobs, jobs, progress);
  run.add_rows(jobs, {options.suite, progress});
  run.close();
  return read_record_file(records_file(out)).records;
}

}  // namespace

std::vector<std::size_t> drawn_rows(std::span<const Record> records, std::size_t most, int seed,
                                    const std::function<bool(const Record&)>& may) {
  std::vector<std::pair<std::string, std::size_t>> mixed;
  for (std::size_t k = 0; k < records.size(); ++k)
    if (may(records[k])) mixed.emplace_back(content_hash(fmt::format("{} {}", seed, records[k].job)), k);
  std::ranges::sort(mixed);
  std::vector<std::size_t> drawn;
  for (const auto& [hash, number] : mixed)
    if (drawn.size() < most) drawn.push_back(number);
  return drawn;
}

RepeatSummary repeat_rows(const Submission& submission, const Edition& edition, const EditionPlaces& places,
                          SceneLibrary& library, const RepeatOptions& options, Progress& progress) {
  RepeatSummary summary;
  Faults obstacles;
  const auto may = [&](const Record& record) {
    const std::string why = obstacle(record);
    if (why.empty()) return true;
    ++summary.unable;
    obstacles.add("cannot be repeated: " + why, record);
    return false;
  };
  std::vector<Job> jobs;
  for (const std::size_t k : drawn_rows(submission.records, options.rows, options.seed, may)) {
    const Record& record = submission.records[k];
    if (const Job* const place = place_of(record, edition, places))
      jobs.push_back(
          with_contender(*place, {.technique = record.technique, .settings = record.settings, .label = {}}, edition.suite));
  }
  summary.notes = obstacles.lines();
  if (jobs.empty()) return summary;
  const ScratchFolder scratch = ScratchFolder::temporary("gnomon-submission");
  const fs::path out = scratch.path() / "again";
  Comparison comparison(submission.folder, out, edition, summary);
  for (const Record& now : run_again(jobs, edition, library, options.worker, out, progress)) {
    const auto then = std::ranges::find(submission.records, now.job, &Record::job);
    if (then != submission.records.end()) comparison.compare(*then, now);
  }
  return summary;
}

}  // namespace gnomon
