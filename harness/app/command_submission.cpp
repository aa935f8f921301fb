// gnomon submission: a run of an edition as a folder that others check. docs/submissions.md describes both ways.
#include "app/app.h"
#include "app/submission/make.h"
#include "measure/counted.h"
#include "measure/notice.h"
#include "measure/paths.h"
#include "measure/printable.h"
#include "measure/record/merge.h"
#include "measure/scene/load.h"
#include "measure/scratch_folder.h"
#include "measure/submission/check_masks.h"
#include "measure/submission/repeat.h"
#include "measure/worker/build.h"

namespace gnomon::app {

namespace {

namespace fs = std::filesystem;

struct SubmissionOptions {
  std::string what;
  std::vector<fs::path> folders;
  fs::path out;
  SubmissionWords words;
  std::string tuning, notes;
  int rows = 12, seed = 1, threads = 0;
  bool quiet = false;
};

/// The rules that need no technique and no scene.
std::vector<std::string> stated_faults(const Submission& submission) {
  std::vector<std::string> faults = file_faults(submission);
  for (auto* rule : {origin_faults, system_faults})
    for (std::string& fault : rule(submission)) faults.push_back(std::move(fault));
  for (std::string& fault : time_faults(submission.records)) faults.push_back(std::move(fault));
  return faults;
}

/// Medians are in the table alone. Another program may lay it out otherwise, and records have no medians.
void check_table(const Submission& submission, RowFaults& found) {
  if (!submission.facts.files.contains("table.md")) return;
  if (submission.facts.program != plain_text(build_context()["commit"])) {
    found.notes.push_back(fmt::format("table.md is by commit {}, and this program is of another: its medians are not compared",
                                      submission.facts.program));
    return;
  }
  if (file_text(submission.folder / "table.md") != submission_table(submission))
    found.faults.push_back("table.md is not the table of the records: its medians are those of other repetitions");
}

/// All rules of a submission: what is against them, and what could not be checked. `edition` is that of its name.
RowFaults rule_faults(const Submission& submission, const Edition& edition, const EditionPlaces& places, SceneLibrary& library,
                      const WorkerOptions& worker) {
  RowFaults found = row_faults(submission, edition, places, supports_nothing(edition, library, worker));
  std::vector<std::string> scenes;
  for (const SceneListing& scene : list_scenes()) scenes.push_back(scene.id);
  for (std::string& fault : tuning_faults(submission.facts, edition, scenes)) found.faults.push_back(std::move(fault));
  check_table(submission, found);
  return found;
}

/// The edition of a submission, if it is that one.
Edition edition_of(const Submission& submission) {
  const std::string& name = submission.facts.edition.name;
  if (const auto known = edition_names(); std::ranges::find(known, name) == known.end())
    throw Error("{} is of edition {}, which is not known: {}", submission.folder.string(), name, joined(known, ", "));
  return read_edition(name);
}

/// Rules are those of the edition, so the program must give it.
void require_edition(const Edition& edition, SceneLibrary& library) {
  const std::vector<std::string> differences = edition_differences(edition, library);
  for (const std::string& line : differences) print_notice("edition {}: {}\n", edition.name, printable(line, true));
  if (!differences.empty())
    throw Error("this program does not give edition {} ({}): {}; nothing can be checked by it", edition.name, edition.hash,
                counted(differences.size(), "difference{s}"));
}

std::string other_edition(const Submission& submission, const Edition& edition) {
  if (submission.facts.edition.hash == edition.hash) return {};
  return fmt::format("it is of an edition {} with the hash {}, and the edition's is {}", edition.name,
                     submission.facts.edition.hash, edition.hash);
}

/// What is said of one submission, line by line.
class SubmissionVerdict {
 public:
  explicit SubmissionVerdict(const Submission& submission) : folder_(printable(submission.folder.string(), true)) {
    const SubmissionFacts& facts = submission.facts;
    say(fmt::format("edition {} ({}), division {}, by {}: {} of {}", facts.edition.name, printable(facts.edition.hash, true),
                    name(facts.division), facts.name, counted(submission.records.size(), "row{s}"),
                    counted(facts.techniques.size(), "technique{s}")));
  }
  void say(const std::string& line) const { fmt::print("{}: {}\n", folder_, printable(line, true)); }
  void add(const std::vector<std::string>& faults, const std::vector<std::string>& notes) {
    for (const std::string& note : notes) say("note: " + note);
    constexpr std::size_t most = 40;
    for (const std::string& fault : std::span(faults).first(std::min(most, faults.size()))) say("WRONG: " + fault);
    if (faults.size() > most) say(fmt::format("and {} more", faults.size() - most));
    count_ += faults.size();
  }
  bool is_wrong() const { return count_ > 0; }
  /// Exit status.
  int refused(std::string_view left_out) const {
    say(fmt::format("not accepted: {}{}", counted(count_, "reason{s}"), left_out));
    return 1;
  }

 private:
  std::string folder_;
  std::size_t count_ = 0;
};

/// Returns the exit status.
int check_one(const Submission& submission, const SubmissionOptions& options, const WorkerOptions& worker) {
  const Edition edition = edition_of(submission);
  const std::string other = other_edition(submission, edition);
  SceneLibrary library;
  if (other.empty()) require_edition(edition, library);
  SubmissionVerdict verdict(submission);
  verdict.add(stated_faults(submission), {});
  if (!other.empty()) {
    verdict.add({other}, {});
    return verdict.refused("; its rows are not looked at");
  }
  const EditionPlaces places = edition_places(edition, library);
  const RowFaults found = rule_faults(submission, edition, places, library, worker);
  verdict.add(found.faults, found.notes);
  if (verdict.is_wrong()) return verdict.refused("; its masks are not looked at, and no row is run again");
  const MaskCheck masks = [&] {
    Progress progress(options.quiet);
    return check_masks(submission, progress);
  }();
  verdict.add(masks.faults, masks.notes);
  if (verdict.is_wrong()) return verdict.refused("; no row is run again");
  const RepeatSummary again = [&] {
    Progress progress(options.quiet);
    return repeat_rows(submission, edition, places, library,
                       {.rows = static_cast<std::size_t>(options.rows), .seed = options.seed, .worker = worker}, progress);
  }();
  verdict.add(again.faults, again.notes);
  const std::string counts = fmt::format(
      "{} scored from their masks; run again: {} the same to the last digit, {} within what another renderer may do, "
      "{} not repeated{}",
      counted(masks.rows, "row{s}"), again.equal, again.within, again.not_repeated,
      again.unable > 0 ? fmt::format("; {} cannot be repeated here", counted(again.unable, "row{s}")) : "");
  if (verdict.is_wrong()) return verdict.refused("; " + counts);
  verdict.say("accepted: " + counts);
  return 0;
}

/// Two of one name are two tries of one machine, or two machines that a table cannot tell apart.
void tell_apart(std::span<const Submission> all) {
  for (std::size_t b = 1; b < all.size(); ++b)
    for (std::size_t a = 0; a < b; ++a) {
      if (all[a].facts.name != all[b].facts.name) continue;
      const auto machine = [](const Submission& of) {
        std::vector<std::string> facts;
        for (const char* const key : {"processor", "cores", "memory_bytes", "gl_renderer"})
          facts.push_back(json_text(of.facts.system.value(key, Json())));
        return facts;
      };
      const auto records = [](const Submission& of) {
        const auto file = of.facts.files.find("records.jsonl");
        return file == of.facts.files.end() ? "" : file->second.hash;
      };
      std::string how = "and of different machines: give them different names";
      if (machine(all[a]) == machine(all[b]))
        how = records(all[a]) == records(all[b]) ? "and hold the same records: they are one submission"
                                                 : "and of one machine: they are two runs of it";
      fmt::print("{} and {} are both by {}, {}\n", printable(all[a].folder.string(), true),
                 printable(all[b].folder.string(), true), all[a].facts.name, how);
    }
}

int check_submissions(const SubmissionOptions& options, const Program& program) {
  const WorkerOptions worker = worker_options(program, options.threads);
  std::vector<Submission> all;  // all are read before a word is printed: what is hostile is an error
  for (const fs::path& folder : options.folders) all.push_back(read_submission(folder));
  int status = 0;
  for (const Submission& submission : all) status = std::max(status, check_one(submission, options, worker));
  tell_apart(all);
  return status;
}

int make_submission(const SubmissionOptions& options, const Program& program) {
  const fs::path& run = options.folders.front();
  if (options.folders.size() > 1) throw Error("a submission is of one run, and {} are given", options.folders.size());
  if (options.out.empty()) throw Error("--out is missing: the folder of the submission");
  if (options.words.name.empty()) throw Error("--name is missing: who or which machine, 1 to 40 of a..z, 0..9, _ and -");
  if (!is_submission_name(options.words.name))
    throw Error("--name {} is not 1 to 40 of a..z, 0..9, _ and -", options.words.name);
  require_free(options.out);
  const fs::path out = fs::absolute(options.out).lexically_normal();
  const fs::path target = out.has_filename() ? out : out.parent_path();
  const ScratchFolder scratch = ScratchFolder::in(target.parent_path(), ".gnomon-submission");
  const fs::path folder = scratch.path() / target.filename();
  make_folder(folder);
  SubmissionWords words = options.words;
  if (!options.tuning.empty()) words.tuning = options.tuning;
  if (!options.notes.empty()) words.notes = options.notes;
  write_submission(run, words, folder);
  const Submission made = read_submission(folder);
  const Edition edition = edition_of(made);
  std::vector<std::string> faults = stated_faults(made);
  RowFaults rows;
  if (const std::string other = other_edition(made, edition); !other.empty()) {
    faults.push_back(other);
  } else {
    SceneLibrary library;
    require_edition(edition, library);
    rows = rule_faults(made, edition, edition_places(edition, library), library, worker_options(program, options.threads));
  }
  for (const std::string& note : rows.notes) print_notice("note: {}\n", printable(note, true));
  for (std::string& fault : rows.faults) faults.push_back(std::move(fault));
  for (const std::string& fault : faults) print_notice("WRONG: {}\n", printable(fault, true));
  if (!faults.empty()) {
    print_notice("gnomon: nothing is written: check would refuse the submission for {}\n", counted(faults.size(), "reason{s}"));
    return 1;
  }
  std::error_code code;
  fs::rename(folder, target, code);
  if (code) throw Error("{} cannot be written: {}", options.out.string(), code.message());
  fmt::print("{}: edition {}, division {}, {}\ncheck it: gnomon submission check {}", options.out.string(), edition.name,
             name(made.facts.division), counted(made.records.size(), "row{s}"), options.out.string());
  for (const std::string& file : program.plugins)
    fmt::print(" {} {}", file.ends_with(".toml") ? "--program" : "--plugin", file);
  fmt::print("\n");
  return 0;
}

int run_submission(const SubmissionOptions& options, const Command& command, const Program& program) {
  const auto refuse = [&](std::initializer_list<const char*> names, const char* word) {
    for (const char* const name : names)
      if (command.is_given(name)) throw Error("{} is for gnomon submission {}", name, word);
  };
  if (options.what == "make") {
    refuse({"--rows", "--seed"}, "check");
    return make_submission(options, program);
  }
  refuse({"--out", "--name", "--tuning", "--notes"}, "make");
  return check_submissions(options, program);
}

}  // namespace

void add_submission(Program& program) {
  auto [command, options] = program.line.command<SubmissionOptions>(
      "submission", "A run of an edition as a folder that others check: make it of a run, or check it",
      [&program](const SubmissionOptions& read, const Command& of) { return run_submission(read, of, program); });
  command.option("what", &options.what, "make: of a run; check: rules, masks, and a sample of rows run again",
                 {.is_required = true, .check = one_of({"make", "check"})});
  command.option("folders", &options.folders, "The run, or the submissions", {.is_required = true});
  command.option("--out", &options.out, "make: the folder to write; it may not be there", {.check = not_empty()});
  command.option("--name", &options.words.name, "make: who or which machine, 1 to 40 of a..z, 0..9, _ and -",
                 {.check = not_empty()});
  command.option("--tuning", &options.tuning, "make: how settings were found, and on which training scenes",
                 {.check = not_empty()});
  command.option("--notes", &options.notes, "make: what else readers must know", {.check = not_empty()});
  command.option("--rows", &options.rows, "check: how many rows are run again", {.check = whole_in(0, 10'000)});
  command.option("--seed", &options.seed, "check: another one draws other rows", {.check = whole_in(0, 1'000'000'000)});
  command.option("--threads", &options.threads, "Pin workers to this many cores; all by default");
  command.flag("--quiet", &options.quiet, "No progress");
}

}  // namespace gnomon::app
