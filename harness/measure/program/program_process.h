#pragma once
#include <filesystem>

#include "measure/child_process.h"

namespace gnomon {

/// Whether a command, whose output goes nowhere, ends with 0 within ten seconds.
bool ends_well(const std::vector<std::string>& command, const std::filesystem::path& folder);

/// A program that answers each line of JSON on its standard input by one on its standard output. Its standard error is that of
/// this process. It ends with this object, and with the process that holds it.
class ProgramProcess {
 public:
  /// Starts it in a folder, with some variables more than this process has. Throws Error when it cannot be started.
  ProgramProcess(const std::vector<std::string>& command, const std::filesystem::path& folder,
                 const Launch::Variables& variables);
  ~ProgramProcess();
  ProgramProcess(const ProgramProcess&) = delete;
  ProgramProcess& operator=(const ProgramProcess&) = delete;

  /// Waits for the answer as long as it takes: the owner of this process sets the time limit. Throws Error when the program
  /// ended, answered with something else than one line with an object, or answered {"error": text}.
  Json ask(const Json& request);
  /// Bytes of memory that it has written and holds; 0 when it has ended.
  double resident_bytes() const;

 private:
  [[noreturn]] void fail_as_it_ended(const std::string& doing);

  std::string name_, pending_;
  int process_ = -1, input_ = -1, output_ = -1;
};

}  // namespace gnomon
