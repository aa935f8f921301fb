#pragma once
#include "measure/edition/edition.h"
#include "measure/fields.h"

namespace gnomon {

constexpr int enumerator_count(Division) { return std::size(division_names); }

inline constexpr const char* submission_schema = "gnomon-submission-1";

/// FOLDER/submission.json: what the maker of a submission states of it. docs/submissions.md describes the folder.
struct SubmissionFacts {
  struct OfEdition {
    std::string name, hash;
    bool operator==(const OfEdition&) const = default;
  };
  /// Where the code of a technique comes from.
  struct Code {
    std::string id, title;
    std::string source;  ///< "gnomon COMMIT", "plugin FILE" or "program FILE"
    std::string hash;    ///< of the technique's source, of the plugin, or of the program's files
  };
  struct File {
    std::uint64_t bytes = 0;
    std::string hash;  ///< content_hash
  };
  std::string schema;
  OfEdition edition;
  Division division = Division::default_settings;
  std::string name;     ///< who or which machine: is_submission_name
  std::string program;  ///< commit of the program that wrote the folder
  Json system = json_object();
  std::optional<std::string> tuning, notes;
  std::vector<Code> techniques;        ///< by id
  std::map<std::string, int> metrics;  ///< versions, by name
  std::map<std::string, File> files;   ///< all of the folder but this one, by name in it: "masks/a.exr"
};
void for_each_field(MaybeConst<SubmissionFacts::OfEdition> auto& f, const auto& use) { use("name", f.name, "hash", f.hash); }
void for_each_field(MaybeConst<SubmissionFacts::Code> auto& f, const auto& use) {
  use("id", f.id, "title", f.title, "source", f.source, "hash", f.hash);
}
void for_each_field(MaybeConst<SubmissionFacts::File> auto& f, const auto& use) { use("bytes", f.bytes, "hash", f.hash); }
void for_each_field(MaybeConst<SubmissionFacts> auto& f, const auto& use) {
  use("schema", f.schema, "edition", f.edition, "division", f.division, "name", f.name, "program", f.program);
  use("system", f.system, "tuning", f.tuning, "notes", f.notes, "techniques", f.techniques, "metrics", f.metrics);
  use("files", f.files);
}

/// A run of an edition as a folder that others check.
struct Submission {
  std::filesystem::path folder;
  SubmissionFacts facts;
  std::vector<Record> records;     ///< in the order of the file
  Json runs = Json::array();       ///< the entries of run.json
  std::vector<std::string> files;  ///< names in the folder, sorted, without submission.json
};

/// Names of files in the folder.
inline constexpr const char* facts_file = "submission.json";
inline constexpr std::string_view masks_folder = "masks/";

/// What a folder may hold: a larger one is refused before it is read.
inline constexpr std::size_t most_submitted_rows = 10'000;
inline constexpr std::uintmax_t most_mask_bytes = std::uintmax_t{64} << 20;
inline constexpr std::uintmax_t most_folder_bytes = std::uintmax_t{8} << 30;
inline constexpr std::size_t most_words_bytes = 20'000;  ///< of `tuning` and of `notes`

/// 1 to 40 of a..z, 0..9, _ and -.
bool is_submission_name(std::string_view text);

/// Reads a folder from outside; nothing in it is followed, loaded or run. Throws Error on links and what else is no plain file,
/// on names that a submission does not have or that lead out of it, on sizes and numbers of rows over the limits, and on
/// another schema. What it says may still be untrue: see rules.h.
Submission read_submission(const std::filesystem::path& folder);

/// The names of the files of a folder, with the checks of read_submission.
std::vector<std::string> submitted_files(const std::filesystem::path& folder);

/// Where the code of a row comes from: `id`, `source` and `hash`; the title stays empty.
SubmissionFacts::Code code_of(const Record& record);
/// Of all rows, one for each technique, by id; where rows of one differ, its hashes with "+" between.
std::vector<SubmissionFacts::Code> codes_of(std::span<const Record> records);

}  // namespace gnomon
