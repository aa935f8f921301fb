#pragma once
#include <filesystem>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "measure/record/record.h"

namespace gnomon::site {

/// Where rows were measured: by the name that a submission gives itself, else by processor and renderer of OpenGL.
struct Machine {
  std::string title = {}, id = {};                                ///< `id` names its page
  std::vector<std::pair<std::string, std::string>> facts = {};    ///< topic and text, of all its folders
  std::vector<std::pair<std::string, std::string>> remarks = {};  ///< what its submissions say of themselves: tuning, notes
};

/// The rows of one suite that one machine did in one division.
struct Entry {
  std::string suite = {};            ///< title of the suite: "standard", "edition 2027"
  std::string suite_id = {};         ///< names its page
  std::string edition = {};          ///< hash; empty where the rows are of no edition
  std::string division = {};         ///< "default", "tuned", "open"; empty where the folder does not say
  std::size_t machine = 0;           ///< of Sources::machines
  std::string title = {};            ///< its machine, and the folder where a machine has the suite twice
  std::string id = {};               ///< names its page and its downloads
  std::filesystem::path dir = {};    ///< of masks and pictures
  std::vector<Record> records = {};  ///< in the order of tables, one at least
};

struct Sources {
  std::vector<Machine> machines;
  std::vector<Entry> entries;  ///< suites in order of appearance, their entries together
};

/// Reads folders of runs, of kept results and of submissions. Throws Error where a folder has no records, or such as this
/// program does not read, where one is given twice, where a submission.json is none, and where two submissions have the same
/// edition, division and name.
Sources read_sources(std::span<const std::filesystem::path> dirs);

/// "standard, AMD EPYC, llvmpipe", with its division where there is one.
std::string full_title(const Entry& entry);

/// The place of a row for people, in full: "bunny, point, main", with path, size where it is not 640 x 360, and truth.
std::string place_text(const Record& record);

/// The whole of a regular file. Throws Error where it is none, where it is a link, and where it has more bytes.
std::string small_file(const std::filesystem::path& file, std::uintmax_t most_bytes);

}  // namespace gnomon::site
