#include "app/submission/make.h"

#include <gnomon/registry.h>

#include "measure/counted.h"
#include "measure/part_file.h"
#include "measure/paths.h"
#include "measure/run/run_file.h"
#include "measure/scene/blob.h"
#include "measure/score/metrics.h"
#include "measure/submission/system.h"
#include "measure/worker/build.h"
#include "report/table/table.h"

namespace gnomon::app {

namespace fs = std::filesystem;

namespace {

/// A path of this machine as its last name, which says enough and nothing of the machine.
std::string without_folders(const std::string& text) {
  const std::size_t equal = text.starts_with("--") ? text.find('=') : text.npos;
  const std::string option = equal == text.npos ? "" : text.substr(0, equal + 1), value = text.substr(option.size());
  const fs::path path = value;
  if (!path.is_absolute()) return text;
  return option + (path.has_filename() ? path.filename() : path.parent_path().filename()).string();
}

/// Of a submission: without pictures that it does not hold, and without this machine's paths.
Record submitted(Record record) {
  record.error_picture.reset();
  record.shaded_picture.reset();
  record.kept_frames.reset();
  record.context.erase("scene_file");
  if (const auto plugin = record.context.find("plugin");
      plugin != record.context.end() && plugin->is_object() && plugin->contains("path"))
    (*plugin)["path"] = without_folders(plain_text((*plugin)["path"]));
  return record;
}

Json submitted_runs(Json runs) {
  for (Json& run : runs)
    if (run.is_object() && run.contains("command") && run["command"].is_array())
      for (Json& word : run["command"]) word = without_folders(plain_text(word));
  return runs;
}

void copy_mask(const Record& record, const fs::path& run, const fs::path& folder) {
  if (!record.mask) return;
  const fs::path from = run / *record.mask, to = folder / *record.mask;
  if (!is_plain_file(from))
    throw Error("{} is not there, or is a link: the mask of {} belongs to the submission", from.string(), title(record));
  make_folder(to.parent_path());
  std::error_code code;
  fs::copy_file(from, to, code);
  if (code) throw Error("{} cannot be copied: {}", from.string(), code.message());
}

/// What the last run of the folder was of.
void read_edition_of(const Json& runs, const fs::path& run, SubmissionFacts& facts) {
  const std::optional<RunEdition> edition = runs.empty() ? std::nullopt : edition_of(runs.back(), run);
  if (!edition) throw Error("{} is no run of an edition: gnomon run --edition NAME makes one", run.string());
  facts.edition = {edition->name, edition->hash};
  facts.division = parse_division(edition->division);
}

/// The versions of metrics are those of this program, so it must be the one that made the rows.
void require_own_build(const std::vector<Record>& records) {
  const std::string own = plain_text(build_context()["build"]);
  for (const Record& record : records)
    if (const std::string build = context_text(record, "build"); build != own)
      throw Error("{} was made by build {}, and this program is build {}: make the submission by the program that ran it",
                  title(record), build, own);
}

std::string readme_of(const SubmissionFacts& facts, std::size_t rows) {
  std::string techniques;
  for (const SubmissionFacts::Code& code : facts.techniques)
    techniques += fmt::format("| `{}` | {} | {} | `{}` |\n", code.id, code.title, code.source, code.hash);
  const auto told = [](const std::optional<std::string>& text) { return text ? *text : std::string("-"); };
  return fmt::format(
      "# {0}: edition {1}, division {2}\n\nA run of edition {1} of Gnomon, a testbed for shadow techniques: {3}. Edition and "
      "division say what was measured, and by which rules.\n\n"
      "```sh\ngnomon submission check .      # the rules, the masks, and a sample of rows run again\n```\n\n"
      "| file | holds |\n|---|---|\n| `submission.json` | what this submission states, and the hash of each file |\n"
      "| `records.jsonl` | every row with all repetitions and metrics |\n| `run.json` | how the rows were made |\n"
      "| `masks/` | visibility masks, EXR |\n| `table.md` | the table |\n\n"
      "## Techniques\n\n| id | title | source | hash |\n|---|---|---|---|\n{4}\n"
      "## Settings\n\n{5}\n\n## Notes\n\n{6}\n",
      facts.name, facts.edition.name, name(facts.division), counted(rows, "row{s}"), techniques, told(facts.tuning),
      told(facts.notes));
}

void state_files(SubmissionFacts& facts, const fs::path& folder) {
  for (const std::string& name : submitted_files(folder)) {
    const auto mapped = MappedFile::open(folder / name);
    facts.files[name] = {mapped->bytes().size(), content_hash(mapped->bytes())};
  }
}

}  // namespace

void write_submission(const fs::path& run, const SubmissionWords& words, const fs::path& folder) {
  if (!fs::exists(records_file(run))) throw Error("{} is not the folder of a run: it has no records.jsonl", run.string());
  const Json runs = run_entries(run);
  SubmissionFacts facts;
  facts.schema = submission_schema;
  facts.name = words.name;
  facts.tuning = words.tuning;
  facts.notes = words.notes;
  read_edition_of(runs, run, facts);
  std::vector<Record> records;
  std::string lines;
  for (Record& record : read_records(run)) {
    copy_mask(record, run, folder);
    records.push_back(submitted(std::move(record)));
    lines += record_line(records.back());
  }
  require_own_build(records);
  facts.program = plain_text(build_context()["commit"]);
  facts.system = describe_system(records);
  facts.techniques = codes_of(records);
  for (SubmissionFacts::Code& code : facts.techniques) {
    const TechniqueEntry* const entry = registry().find_technique(code.id);
    code.title = entry ? std::string(entry->about.title) : code.id;
  }
  for (const MetricInfo& metric : metric_infos()) facts.metrics[std::string(metric.name)] = metric.version;
  write_file(folder / "records.jsonl", lines);
  write_file(folder / "run.json",
             json_text(json_object({{"schema", "gnomon-run-1"}, {"runs", submitted_runs(runs)}}), 1) + "\n");
  write_file(folder / "table.md", render_table(records, Format::markdown));
  write_file(folder / "README.md", readme_of(facts, records.size()));
  state_files(facts, folder);
  write_file(folder / facts_file, json_text(written(facts), 1) + "\n");
}

std::string submission_table(const Submission& submission) { return render_table(submission.records, Format::markdown); }

}  // namespace gnomon::app
