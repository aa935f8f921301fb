#pragma once
// Suites as files, and what is wrong with them.
#include <unistd.h>

#include <fstream>

#include "error_words.h"
#include "measure/run/suite.h"

namespace gnomon::suite_files {
using error_words::error_of;

/// A suite file that is there as long as the object.
struct File {
  std::filesystem::path path = std::filesystem::temp_directory_path() / fmt::format("gnomon_suite_{}.toml", getpid());
  explicit File(const std::string& text) { std::ofstream(path) << text; }
  ~File() { std::filesystem::remove(path); }
};

/// The error of reading a suite of this text, with FILE for its path.
inline std::string trouble(const std::string& text) {
  const File file(text);
  std::string what = error_of([&] { read_suite(file.path); });
  for (std::size_t at; (at = what.find(file.path.string())) != std::string::npos;)
    what.replace(at, file.path.string().size(), "FILE");
  return what;
}

/// A group of one row; further keys may follow.
inline const std::string group = "[[group]]\nscenes = [\"contact\"]\ntechniques = [\"unshadowed\"]\n";

}  // namespace gnomon::suite_files
