#include "measure/submission/rules.h"

#include <set>

#include "measure/counted.h"
#include "measure/scene/blob.h"

namespace gnomon {

namespace {

/// The values of a fact of the context over all rows, but the empty one.
std::set<std::string> values_of(std::span<const Record> records, std::string_view key) {
  std::set<std::string> values;
  for (const Record& record : records)
    if (std::string value = context_text(record, key); !value.empty()) values.insert(std::move(value));
  return values;
}

std::string joined_values(const std::set<std::string>& values) {
  return joined(std::vector<std::string>(values.begin(), values.end()), ", ");
}

bool is_clean(const std::string& commit) { return !commit.empty() && commit != "unknown" && !commit.ends_with("-dirty"); }

std::string text_in(const Json& object, std::string_view key) {
  const auto found = object.is_object() ? object.find(key) : object.end();
  return object.is_object() && found != object.end() && !found->is_null() ? plain_text(*found) : "";
}

/// One entry of run.json.
void check_run(const Json& run, const SubmissionFacts& facts, std::size_t number, Faults& faults) {
  const auto add = [&](const std::string& what) { faults.add(fmt::format("run.json: run {} {}", number, what)); };
  if (!run.is_object()) return add("is no object");
  const Json edition = run.value("edition", Json());
  if (!edition.is_object()) return add("is not of an edition");
  if (text_in(edition, "name") != facts.edition.name || text_in(edition, "hash") != facts.edition.hash)
    add(fmt::format("is of edition {} with the hash {}, and the submission of {} with {}", text_in(edition, "name"),
                    text_in(edition, "hash"), facts.edition.name, facts.edition.hash));
  if (text_in(edition, "division") != name(facts.division))
    add(fmt::format("is of division {}, and the submission of {}", text_in(edition, "division"), name(facts.division)));
  const Json changes = run.value("changes", Json());
  if (!changes.is_string())
    add("does not say that its program was built of a commit without changes");
  else if (!changes.get<std::string>().empty())
    add("is by a program that was built of changed sources: it has their differences");
  if (const std::string commit = text_in(run.value("context", Json()), "commit"); !is_clean(commit))
    add(fmt::format("is by a program of commit '{}', and a clean one is wanted", commit));
}

void check_codes(const Submission& submission, Faults& faults) {
  std::map<std::string, SubmissionFacts::Code> stated;
  for (const SubmissionFacts::Code& code : submission.facts.techniques)
    if (!stated.emplace(code.id, code).second) faults.add(fmt::format("technique {} is named twice", code.id));
  for (const SubmissionFacts::Code& code : codes_of(submission.records)) {
    const auto found = stated.find(code.id);
    if (found == stated.end()) {
      faults.add(fmt::format("technique {} has rows, and submission.json does not name it", code.id));
      continue;
    }
    if (code.hash.empty()) faults.add(fmt::format("rows of {} do not say which code made them", code.id));
    if (found->second.source != code.source || found->second.hash != code.hash)
      faults.add(fmt::format("technique {} is of {} ({}), and its rows are of {} ({})", code.id, found->second.source,
                             found->second.hash, code.source, code.hash));
    stated.erase(found);
  }
  for (const auto& [id, code] : stated) faults.add(fmt::format("technique {} has no rows", id));
}

}  // namespace

void Faults::add(const std::string& what) {
  const decltype(lines_)::value_type line(what, {});
  if (std::ranges::find(lines_, line) == lines_.end()) lines_.push_back(line);
}

void Faults::add(const std::string& what, const Record& row) {
  const auto known = std::ranges::find_if(lines_, [&](const auto& line) { return line.first == what && !line.second.empty(); });
  if (known == lines_.end())
    lines_.emplace_back(what, std::vector{title(row)});
  else
    known->second.push_back(title(row));
}

std::vector<std::string> Faults::lines() const {
  std::vector<std::string> result;
  for (const auto& [what, rows] : lines_) {
    if (rows.empty())
      result.push_back(what);
    else
      result.push_back(fmt::format("{}: {}{}", what, rows.front(),
                                   rows.size() == 1 ? "" : " and " + counted(rows.size() - 1, "more row{s}")));
  }
  return result;
}

std::vector<std::string> file_faults(const Submission& submission) {
  Faults faults;
  for (const auto& [name, stated] : submission.facts.files) {
    if (!std::ranges::binary_search(submission.files, name)) {
      faults.add(fmt::format("{} is missing", name));
      continue;
    }
    const std::filesystem::path file = submission.folder / name;
    const std::uintmax_t bytes = std::filesystem::file_size(file);
    if (bytes != stated.bytes || (bytes > 0 ? content_hash(MappedFile::open(file)->bytes()) : content_hash("")) != stated.hash)
      faults.add(fmt::format("{} is not the file that submission.json names: it was changed", name));
  }
  for (const std::string& name : submission.files)
    if (!submission.facts.files.contains(name)) faults.add(fmt::format("{} is not named in submission.json", name));
  for (const Record& record : submission.records)
    if (record.mask && !submission.facts.files.contains(*record.mask)) faults.add("its mask is not in the folder", record);
  std::set<std::string> masks;
  for (const Record& record : submission.records)
    if (record.mask && !masks.insert(*record.mask).second) faults.add("another row has the same mask file", record);
  for (const std::string& name : submission.files)
    if (name.starts_with(masks_folder) && !masks.contains(name)) faults.add(fmt::format("{} is the mask of no row", name));
  return faults.lines();
}

std::vector<std::string> origin_faults(const Submission& submission) {
  Faults faults;
  if (submission.runs.empty()) faults.add("run.json has no run");
  std::set<std::string> commits;
  for (std::size_t k = 0; k < submission.runs.size(); ++k) {
    check_run(submission.runs[k], submission.facts, k + 1, faults);
    if (submission.runs[k].is_object()) commits.insert(text_in(submission.runs[k].value("context", Json()), "commit"));
  }
  for (const Record& record : submission.records) {
    const std::string commit = context_text(record, "commit");
    if (!is_clean(commit))
      faults.add(fmt::format("a program of commit '{}' made it, and a clean one is wanted", commit), record);
    else if (!commits.contains(commit))
      faults.add(fmt::format("a program of commit {} made it, of which run.json has no run", commit), record);
    if (is_foreign(record)) faults.add("it is of a mask that another program made (gnomon score)", record);
    for (const auto& [key, what] : {std::pair("trial", "it is a trial of another driver"),
                                    std::pair("shaders", "shaders were kept from earlier runs (GNOMON_SHADERS)"),
                                    std::pair("side_by_side", "it was run side by side with another program")})
      if (!context_text(record, key).empty()) faults.add(what, record);
  }
  for (const char* const key : {"commit", "build"})
    if (const auto values = values_of(submission.records, key); values.size() > 1)
      faults.add(fmt::format("rows are of several {}s: {}", key, joined_values(values)));
  check_codes(submission, faults);
  return faults.lines();
}

std::vector<std::string> system_faults(const Submission& submission) {
  Faults faults;
  const Json& system = submission.facts.system;
  const auto value = [&](const char* key) { return system.value(key, Json()); };
  const bool is_drawn =
      std::ranges::any_of(submission.records, [](const Record& row) { return !context_text(row, "gl_renderer").empty(); });
  constexpr std::string_view of_gl[] = {"gl_renderer", "gl_version", "driver"};
  for (const char* const key : {"processor", "os", "kernel", "compiler", "embree", "gl_renderer", "gl_version", "driver"}) {
    const bool is_of_gl = std::ranges::find(of_gl, key) != std::end(of_gl);
    const bool is_text = value(key).is_string() && !value(key).get<std::string>().empty() && value(key) != "unknown";
    if (!is_text && !(is_of_gl && !is_drawn && value(key).is_null()))
      faults.add(fmt::format("the system lacks {}: it is {}, and a text is wanted", key, json_text(value(key))));
  }
  for (const char* const key : {"cores", "memory_bytes", "load_average", "clock_mhz"}) {
    const double least = std::string_view(key) == "load_average" ? 0 : 1e-9;
    const bool is_number = value(key).is_number() && value(key).get<double>() >= least;
    if (!is_number && !(std::string_view(key) == "clock_mhz" && system.contains(key) && value(key).is_null()))
      faults.add(fmt::format("the system lacks {}: it is {}, and a number is wanted", key, json_text(value(key))));
  }
  for (const char* const key : {"processor", "cores", "compiler", "gl_renderer", "gl_version"}) {
    const std::set<std::string> values = values_of(submission.records, key);
    if (values.size() > 1)
      faults.add(fmt::format("rows have several values of {}: {}; a submission is of one machine", key, joined_values(values)));
    else if (!values.empty() && *values.begin() != text_in(system, key))
      faults.add(fmt::format("{} of the system is {}, and of the rows {}", key, text_in(system, key), *values.begin()));
  }
  return faults.lines();
}

}  // namespace gnomon
