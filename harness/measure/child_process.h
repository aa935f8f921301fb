#pragma once
#include <functional>
#include <utility>
#include <vector>

#include "measure/json.h"

namespace gnomon {

// For programs that this one starts, and for the lines that pass between them.

/// Arguments and environment are prepared before the fork: between fork and exec only plain system calls are safe.
struct Launch {
  using Variables = std::vector<std::pair<std::string, std::string>>;
  /// The environment of this process with these variables in it; one with an empty value is left out.
  Launch(std::vector<std::string> command, const Variables& variables);
  Launch(const Launch&) = delete;
  Launch& operator=(const Launch&) = delete;

  std::vector<std::string> words, environment;
  std::vector<char*> argv, envp;  ///< the same as exec takes them
};

/// Whether `is_over` becomes true within so many milliseconds.
bool comes_within(int milliseconds, const std::function<bool()>& is_over);

/// Writes the line and its end; whether the other side is there to take it.
bool write_line(int socket, const std::string& line);

/// Waits for bytes and appends them, some of them or none; false at the end and on an error.
bool read_more(int descriptor, std::string& pending);

/// Answers each line of JSON on `socket` by what `handle` makes of it, an exception by {"error": text}; ends the process when
/// the other side is gone.
[[noreturn]] void answer_lines(int socket, const std::function<Json(const Json&)>& handle);

}  // namespace gnomon
