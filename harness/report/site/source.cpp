#include "report/site/source.h"

#include <algorithm>
#include <fstream>
#include <iterator>
#include <map>
#include <tuple>

#include "analysis/in_order.h"
#include "measure/part_file.h"
#include "measure/run/run_file.h"
#include "measure/submission/submission.h"
#include "report/site/slug.h"

namespace gnomon::site {

namespace fs = std::filesystem;

namespace {

constexpr std::uintmax_t most_json_bytes = 1 << 20;

/// What a folder says of itself beside its records.
struct FolderFacts {
  bool is_submission = false;
  std::string name, edition_name, edition_hash, division;
  Json system = json_object();
  std::string tuning, notes;
};

std::string text_at(const Json& object, const char* key) {
  const auto found = object.find(key);
  return found != object.end() && found->is_string() ? found->get<std::string>() : "";
}

void read_edition_facts(const Json& object, FolderFacts& facts) {
  const auto found = object.find("edition");
  if (found == object.end() || !found->is_object()) return;
  facts.edition_name = text_at(*found, "name");
  facts.edition_hash = text_at(*found, "hash");
  if (const std::string division = text_at(*found, "division"); !division.empty()) facts.division = division;
}

void read_submission(const fs::path& file, FolderFacts& facts) {
  const Json json = parse_if_json(small_file(file, most_json_bytes));
  if (!json.is_object()) throw Error("{} is no JSON object", file.string());
  if (const std::string schema = text_at(json, "schema"); schema != submission_schema)
    throw Error("{} has schema '{}'; {} is read", file.string(), schema, submission_schema);
  facts.is_submission = true;
  facts.name = text_at(json, "name");
  if (!is_submission_name(facts.name))
    throw Error("{}: name '{}' is not 1 to 40 of a-z, 0-9, _ and -", file.string(), facts.name);
  read_edition_facts(json, facts);
  facts.division = text_at(json, "division");
  if (facts.edition_name.empty()) throw Error("{} names no edition", file.string());
  if (std::ranges::find(division_names, facts.division) == std::end(division_names))
    throw Error("{}: division '{}' is none of: default, tuned, open", file.string(), facts.division);
  if (const auto system = json.find("system"); system != json.end() && system->is_object()) facts.system = *system;
  facts.tuning = text_at(json, "tuning");
  facts.notes = text_at(json, "notes");
}

FolderFacts facts_of(const fs::path& dir) {
  FolderFacts facts;
  if (const fs::path file = dir / "submission.json"; fs::exists(fs::symlink_status(file))) {
    read_submission(file, facts);
    return facts;
  }
  for (const Json& run : run_entries(dir))
    if (run.is_object()) read_edition_facts(run, facts);
  return facts;
}

std::string folder_name(const fs::path& dir) {
  const fs::path path = fs::absolute(dir).lexically_normal();
  return (path.has_filename() ? path : path.parent_path()).filename().string();
}

std::string machine_title(const FolderFacts& facts, std::span<const Record> records) {
  if (facts.is_submission) return facts.name;
  std::vector<std::string> parts;
  for (const char* const key : {"processor", "gl_renderer"}) {
    const std::vector<std::string> values = context_values(records, key);
    if (!values.empty()) parts.push_back(joined(values, "; "));
  }
  return parts.empty() ? "unknown machine" : joined(parts, ", ");
}

void add_facts(Machine& machine, const FolderFacts& facts, std::span<const Record> records) {
  constexpr std::pair<const char*, const char*> topics[] = {
      {"processor", "processor"}, {"cores", "cores"},          {"threads", "threads"}, {"gl_renderer", "OpenGL by"},
      {"gl_version", "OpenGL"},   {"version", "Gnomon"},       {"commit", "commit"},   {"compiler", "compiler"},
      {"flags", "flags"},         {"build_type", "build type"}};
  for (const auto& [key, topic] : topics)
    for (const std::string& value : context_values(records, key)) add_once(machine.facts, {std::string(topic), value});
  for (const auto& [key, value] : facts.system.items())
    if (!value.is_null()) add_once(machine.facts, {key, plain_text(value)});
  if (!facts.tuning.empty()) add_once(machine.remarks, {"how settings were found", facts.tuning});
  if (!facts.notes.empty()) add_once(machine.remarks, {"notes", facts.notes});
}

class Reader {
 public:
  void add(const fs::path& dir) {
    std::error_code code;
    const fs::path whole = fs::canonical(dir, code);
    if (const auto [earlier, is_new] = folders_.try_emplace(code ? fs::absolute(dir) : whole, dir); !is_new)
      throw Error("{} and {} are one folder; each is given once", earlier->second.string(), dir.string());
    const std::vector<Record> records = read_records(dir);
    if (records.empty()) throw Error("{} has no records", dir.string());
    const FolderFacts facts = facts_of(dir);
    if (facts.is_submission) refuse_twins(dir, facts);
    const std::size_t machine = machine_of(machine_title(facts, records));
    add_facts(sources_.machines[machine], facts, records);
    const bool is_edition = !facts.edition_name.empty();
    std::vector<std::pair<std::string, std::vector<Record>>> by_suite;
    for (const Record& record : records) {
      const std::string name = record.suite.empty() ? folder_name(dir) : record.suite;
      value_of_key(by_suite, is_edition ? "edition " + facts.edition_name : name).push_back(record);
    }
    for (auto& [suite, rows] : by_suite)
      sources_.entries.push_back({.suite = suite,
                                  .edition = facts.edition_hash,
                                  .division = facts.division,
                                  .machine = machine,
                                  .title = sources_.machines[machine].title,
                                  .dir = dir,
                                  .records = std::move(rows)});
  }

  Sources finished() {
    gather_suites();
    tell_twins_apart();
    for (Entry& entry : sources_.entries) {
      entry.suite_id = suite_ids_.of(entry.suite);
      entry.id = entry_ids_.of(fmt::format("{} {} {}", entry.suite, entry.division, entry.title));
    }
    return std::move(sources_);
  }

 private:
  void refuse_twins(const fs::path& dir, const FolderFacts& facts) {
    const auto [earlier, is_new] = submissions_.try_emplace({facts.edition_name, facts.division, facts.name}, dir);
    if (!is_new)
      throw Error("{} and {} are both submissions of '{}' to edition {}, division {}; one of each name is shown",
                  earlier->second.string(), dir.string(), facts.name, facts.edition_name, facts.division);
  }

  std::size_t machine_of(const std::string& title) {
    const auto found = std::ranges::find(sources_.machines, title, &Machine::title);
    if (found != sources_.machines.end()) return static_cast<std::size_t>(found - sources_.machines.begin());
    sources_.machines.push_back({.title = title, .id = machine_ids_.of(title)});
    return sources_.machines.size() - 1;
  }

  /// The entries of a suite one after the other.
  void gather_suites() {
    std::vector<std::string> suites;
    for (const Entry& entry : sources_.entries) add_once(suites, entry.suite);
    std::ranges::stable_sort(sources_.entries, {}, [&](const Entry& entry) { return index_of(suites, entry.suite); });
  }

  /// Two folders of one machine with one suite get the names of their folders, and numbers where these are the same.
  void tell_twins_apart() {
    using Key = std::tuple<std::string, std::string, std::string>;
    const auto key = [](const Entry& entry) { return Key{entry.suite, entry.division, entry.title}; };
    const auto count_keys = [&] {
      std::map<Key, int> counts;
      for (const Entry& entry : sources_.entries) ++counts[key(entry)];
      return counts;
    };
    const std::map<Key, int> counts = count_keys();
    for (Entry& entry : sources_.entries)
      if (counts.at(key(entry)) > 1) entry.title += fmt::format(", folder {}", folder_name(entry.dir));
    const std::map<Key, int> left = count_keys();
    std::map<Key, int> numbers;
    for (Entry& entry : sources_.entries)
      if (const Key here = key(entry); left.at(here) > 1) entry.title += fmt::format(" ({})", ++numbers[here]);
  }

  Sources sources_;
  Slugs machine_ids_, suite_ids_, entry_ids_;
  std::map<fs::path, fs::path> folders_;
  std::map<std::tuple<std::string, std::string, std::string>, fs::path> submissions_;
};

}  // namespace

std::string small_file(const fs::path& file, std::uintmax_t most_bytes) {
  if (!is_plain_file(file)) throw Error("{} is no regular file", file.string());
  if (const std::uintmax_t bytes = fs::file_size(file); bytes > most_bytes)
    throw Error("{} has {} bytes; {} are read at most", file.string(), bytes, most_bytes);
  std::ifstream stream(file, std::ios::binary);
  std::string text((std::istreambuf_iterator<char>(stream)), std::istreambuf_iterator<char>());
  if (!stream) throw Error("{} cannot be read", file.string());
  return text;
}

Sources read_sources(std::span<const fs::path> dirs) {
  if (dirs.empty()) throw Error("a site needs the folder of a run or a submission; none is given");
  Reader reader;
  for (const fs::path& dir : dirs) reader.add(dir);
  return reader.finished();
}

std::string full_title(const Entry& entry) {
  const std::string division = entry.division.empty() ? "" : fmt::format(", division {}", entry.division);
  return fmt::format("{}, {}{}", entry.suite, entry.title, division);
}

std::string place_text(const Record& record) {
  std::string text = fmt::format("{}, {}", record.scene, record.light);
  if (!record.view.empty()) text += ", " + record.view;
  if (!record.path.empty()) text += ", path " + record.path;
  if (record.width != 640 || record.height != 360) text += fmt::format(", {} x {}", record.width, record.height);
  return record.truth == Truth::mesh ? text + ", mesh truth" : text;
}

}  // namespace gnomon::site
