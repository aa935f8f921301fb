#include "measure/submission/submission.h"

#include <fstream>
#include <set>

#include "measure/foreign_text.h"
#include "measure/run/run_file.h"

namespace gnomon {

namespace fs = std::filesystem;

namespace {

/// Files directly in the folder, and the most bytes of each.
struct KnownFile {
  std::string_view name;
  std::uintmax_t most_bytes;
};
constexpr KnownFile known_files[] = {{facts_file, 16 << 20},
                                     {"records.jsonl", 512 << 20},
                                     {"run.json", 64 << 20},
                                     {"table.md", 64 << 20},
                                     {"README.md", 1 << 20}};
constexpr std::size_t most_line_bytes = std::size_t{16} << 20;
constexpr std::string_view mask_ending = ".exr";

[[noreturn]] void refuse(const fs::path& folder, const std::string& what) {
  throw Error("{} is no submission: {}", folder.string(), what);
}

bool is_mask_name(std::string_view name) {
  if (!name.starts_with(masks_folder) || !name.ends_with(mask_ending)) return false;
  name.remove_prefix(masks_folder.size());
  const auto is_plain = [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' || c == '-' || c == '.';
  };
  return name.size() > mask_ending.size() && name.size() <= 250 && name.front() != '.' && std::ranges::all_of(name, is_plain);
}

/// The most bytes of a file of that name; 0 of a name that a submission does not have.
std::uintmax_t most_bytes_of(std::string_view name) {
  const auto* const known = std::ranges::find(known_files, name, &KnownFile::name);
  if (known != std::end(known_files)) return known->most_bytes;
  return is_mask_name(name) ? most_mask_bytes : 0;
}

/// Looks at all that is in a folder, none of it followed.
class Folder {
 public:
  explicit Folder(const fs::path& folder) : folder_(folder) {
    std::error_code code;
    if (!fs::is_directory(folder, code)) refuse(folder, "it is no folder");
    look("");
    std::ranges::sort(names);
  }
  std::vector<std::string> names;

 private:
  void look(const std::string& below) {
    std::error_code code;
    const fs::directory_iterator entries(folder_ / below, code);
    if (code) refuse(folder_, fmt::format("{} cannot be read: {}", (folder_ / below).string(), code.message()));
    for (const fs::directory_entry& entry : entries) take(entry, below + entry.path().filename().string());
  }

  void take(const fs::directory_entry& entry, const std::string& name) {
    std::error_code code;
    const fs::file_status status = entry.symlink_status(code);
    if (fs::is_symlink(status)) refuse(folder_, fmt::format("{} is a link, and it may hold plain files alone", name));
    if (fs::is_directory(status) && name + "/" == masks_folder) return look(name + "/");
    if (!fs::is_regular_file(status)) refuse(folder_, fmt::format("{} is no plain file", name));
    const std::uintmax_t most = most_bytes_of(name);
    if (most == 0)
      refuse(folder_, fmt::format("{} is none of its files, which are submission.json, records.jsonl, run.json, table.md, "
                                  "README.md and masks/*.exr",
                                  name));
    const std::uintmax_t bytes = entry.file_size(code);
    if (code || bytes > most) refuse(folder_, fmt::format("{} is {} bytes long; at most {} are read", name, bytes, most));
    if ((bytes_ += bytes) > most_folder_bytes) refuse(folder_, fmt::format("it holds more than {} bytes", most_folder_bytes));
    names.push_back(name);
    if (names.size() > most_submitted_rows + std::size(known_files))
      refuse(folder_, fmt::format("it holds more than {} masks", most_submitted_rows));
  }

  const fs::path& folder_;
  std::uintmax_t bytes_ = 0;
};

std::string text_of(const fs::path& folder, const char* name) {
  const fs::path file = folder / name;
  return read_foreign_text(file.string(), file, most_bytes_of(name));
}

void check_facts(const SubmissionFacts& facts) {
  const auto need = [](bool is_good, const char* field, const std::string& value, std::string_view allowed) {
    if (!is_good) throw Error("submission.{} = {} is not {}", field, value, allowed);
  };
  constexpr std::string_view name = "1 to 40 of a..z, 0..9, _ and -";
  need(is_submission_name(facts.name), "name", facts.name, name);
  need(is_submission_name(facts.edition.name), "edition.name", facts.edition.name, name);
  for (const auto& [field, text] : {std::pair("tuning", &facts.tuning), std::pair("notes", &facts.notes)})
    if (*text)
      need((*text)->size() <= most_words_bytes, field, fmt::format("a text of {} bytes", (*text)->size()),
           fmt::format("at most {}", most_words_bytes));
  for (const auto& [file, fact] : facts.files)
    need(most_bytes_of(file) > 0 && file != facts_file, "files", file, "a name in the folder");
}

SubmissionFacts read_facts(const fs::path& folder) {
  const std::string text = text_of(folder, facts_file);
  SubmissionFacts facts;
  try {
    const Json json = parse_json(text);
    if (!json.is_object()) throw Error("it is no object");
    const auto schema = json.find("schema");
    if (schema == json.end() || *schema != submission_schema)
      throw Error("schema = {} is not {}", schema == json.end() ? "null" : json_text(*schema), submission_schema);
    std::set<std::string> known;
    for_each_field(facts, UseFields{[&](const char* key, const auto&) { known.insert(key); }});
    for (const auto& [key, value] : json.items())
      if (!known.contains(key)) throw Error("submission has no field {}", key);
    read_members("submission", json, facts, MissingField::refused);
    check_facts(facts);
  } catch (const Json::exception& problem) {
    refuse(folder, fmt::format("{}: {}", facts_file, complaint(problem)));
  } catch (const Error& problem) {
    refuse(folder, fmt::format("{}: {}", facts_file, problem.what()));
  }
  return facts;
}

/// A record may name its mask, and no other file.
void check_paths(const Record& record) {
  if (record.mask && !is_mask_name(*record.mask)) throw Error("mask = {} is no name in the folder", *record.mask);
  for (const auto& [field, name] :
       {std::pair("error_picture", &record.error_picture), {"shaded_picture", &record.shaded_picture}})
    if (*name) throw Error("{} = {} is not null: masks are the only pictures of a submission", field, **name);
  if (record.kept_frames) throw Error("kept_frames is not null: masks are the only pictures of a submission");
  if (record.context.contains("scene_file"))
    throw Error("context.scene_file = {} names a file: scenes of an edition have names", context_text(record, "scene_file"));
}

std::vector<Record> read_rows(const fs::path& folder) {
  const fs::path file = folder / "records.jsonl";
  std::ifstream stream(file, std::ios::binary);
  if (!stream) refuse(folder, "records.jsonl cannot be read");
  std::vector<Record> records;
  std::string line;
  std::size_t number = 1;
  try {
    for (; next_foreign_line(stream, line, most_line_bytes); ++number) {
      if (records.size() == most_submitted_rows) throw Error("it has more than {} rows", most_submitted_rows);
      if (stream.eof()) throw Error("its last line has no end");
      records.push_back(record_of(parse_json(line)));
      if (!records.back().unknown.empty()) throw Error("a record has no field {}", records.back().unknown.begin().key());
      check_paths(records.back());
    }
  } catch (const Json::exception& problem) {
    refuse(folder, fmt::format("records.jsonl:{}: {}", number, complaint(problem)));
  } catch (const Error& problem) {
    refuse(folder, fmt::format("records.jsonl:{}: {}", number, problem.what()));
  }
  if (stream.bad()) refuse(folder, "records.jsonl cannot be read to its end");
  if (records.empty()) refuse(folder, "records.jsonl has no row");
  return records;
}

}  // namespace

bool is_submission_name(std::string_view text) {
  constexpr std::size_t most = 40;
  const auto is_plain = [](char c) { return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '_' || c == '-'; };
  return !text.empty() && text.size() <= most && std::ranges::all_of(text, is_plain);
}

std::vector<std::string> submitted_files(const fs::path& folder) {
  std::vector<std::string> names = Folder(folder).names;
  std::erase(names, facts_file);
  return names;
}

Submission read_submission(const fs::path& folder) {
  Submission read;
  read.folder = folder;
  const std::vector<std::string> names = Folder(folder).names;
  for (const char* const needed : {facts_file, "records.jsonl", "run.json"})
    if (std::ranges::find(names, needed) == names.end())
      refuse(folder, fmt::format("it has no {}; gnomon submission make writes one", needed));
  read.files = names;
  std::erase(read.files, facts_file);
  read.facts = read_facts(folder);
  read.records = read_rows(folder);
  read.runs = run_entries(folder);
  return read;
}

SubmissionFacts::Code code_of(const Record& record) {
  SubmissionFacts::Code code{.id = record.technique, .title = {}, .source = {}, .hash = plugin_hash(record)};
  if (code.hash.empty()) {
    code.source = "gnomon " + context_text(record, "commit");
    code.hash = context_text(record, "technique_source");
  } else {
    const Json& plugin = record.context["plugin"];
    const fs::path path = plugin.contains("path") ? plain_text(plugin["path"]) : "";
    code.source = (path.extension() == ".toml" ? "program " : "plugin ") + path.filename().string();
  }
  return code;
}

std::vector<SubmissionFacts::Code> codes_of(std::span<const Record> records) {
  std::map<std::string, std::pair<SubmissionFacts::Code, std::set<std::string>>> all;
  for (const Record& record : records) {
    SubmissionFacts::Code code = code_of(record);
    std::string hash = code.hash;
    all.try_emplace(record.technique, std::move(code), std::set<std::string>()).first->second.second.insert(std::move(hash));
  }
  std::vector<SubmissionFacts::Code> codes;
  for (auto& [id, code] : all) {
    code.first.hash = joined(std::vector<std::string>(code.second.begin(), code.second.end()), "+");
    codes.push_back(std::move(code.first));
  }
  return codes;
}

}  // namespace gnomon
