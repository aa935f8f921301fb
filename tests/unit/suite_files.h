#pragma once
// Suites as files, and what is wrong with them.
#include <gnomon/error.h>
#include <unistd.h>

#include <fstream>

#include "measure/run/suite.h"

namespace gnomon::suite_files {

/// What some work throws; empty where it does not.
template <class Work>
std::string complaint(Work work) {
  try {
    work();
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

/// A suite file that is there as long as the object.
struct File {
  std::filesystem::path path = std::filesystem::temp_directory_path() / fmt::format("gnomon_suite_{}.toml", getpid());
  explicit File(const std::string& text) { std::ofstream(path) << text; }
  ~File() { std::filesystem::remove(path); }
};

/// The error of reading a suite of this text, with FILE for its path.
inline std::string trouble(const std::string& text) {
  const File file(text);
  std::string what = complaint([&] { read_suite(file.path); });
  for (std::size_t at; (at = what.find(file.path.string())) != std::string::npos;)
    what.replace(at, file.path.string().size(), "FILE");
  return what;
}

/// A group of one row; further keys may follow.
inline const std::string group = "[[group]]\nscenes = [\"contact\"]\ntechniques = [\"unshadowed\"]\n";

}  // namespace gnomon::suite_files
