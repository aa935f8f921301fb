#include "measure/record/record_members.h"

#include <algorithm>

namespace gnomon {

namespace {

constexpr std::size_t nowhere = std::string_view::npos;

/// After the text that begins there; nowhere if it does not end.
std::size_t after_text(std::string_view line, std::size_t at) {
  for (++at; at < line.size(); ++at)
    if (line[at] == '\\')
      ++at;
    else if (line[at] == '"')
      return at + 1;
  return nowhere;
}

/// Where the value that begins there ends: at the comma or the bracket behind it.
std::size_t after_value(std::string_view line, std::size_t at) {
  for (int depth = 0; at < line.size(); ++at) {
    const char c = line[at];
    if (c == '"') {
      at = after_text(line, at);
      if (at == nowhere) return nowhere;
      --at;
    } else if (c == '{' || c == '[') {
      ++depth;
    } else if (c == '}' || c == ']') {
      if (depth-- == 0) return at;
    } else if (c == ',' && depth == 0) {
      return at;
    }
  }
  return nowhere;
}

}  // namespace

std::string without_members(std::string_view line, std::span<const std::string_view> keys) {
  std::string kept = "{";
  if (!line.starts_with("{\"")) return std::string(line);
  for (std::size_t at = 1;;) {
    const std::size_t colon = at < line.size() && line[at] == '"' ? after_text(line, at) : nowhere;
    if (colon == nowhere || colon >= line.size() || line[colon] != ':') return std::string(line);
    const std::size_t end = after_value(line, colon + 1);
    if (end == nowhere || line[end] == ']') return std::string(line);
    if (std::ranges::find(keys, line.substr(at + 1, colon - at - 2)) == keys.end()) {
      if (kept.size() > 1) kept += ',';
      kept += line.substr(at, end - at);
    }
    if (line[end] == '}') return kept.append(line.substr(end));
    at = end + 1;
  }
}

}  // namespace gnomon
