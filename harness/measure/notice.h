#pragma once
#include <fmt/format.h>

#include <cstdio>
#include <exception>
#include <new>
#include <string>

namespace gnomon {

/// Writes to standard error. What cannot be written is lost: a full disk below a log does not stop the work.
template <class... Args>
void print_notice(fmt::format_string<Args...> format, Args&&... args) {
  const std::string text = fmt::format(format, std::forward<Args>(args)...);
  std::fwrite(text.data(), 1, text.size(), stderr);
}

/// The problem in words; a lack of memory has only the name of its type in C++.
inline std::string message_of(const std::exception& problem) {
  return dynamic_cast<const std::bad_alloc*>(&problem) ? "not enough memory" : problem.what();
}

}  // namespace gnomon
