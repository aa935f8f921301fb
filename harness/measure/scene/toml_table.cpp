#include "measure/scene/toml_table.h"

#include "measure/foreign_text.h"

namespace gnomon {

namespace {

constexpr std::size_t most_bytes = 16 << 20;
constexpr std::size_t most_dots = 100;  // in one key; tables are freed table within table

/// The line, counted from 1, with a key of too many parts, or 0. Texts and comments are passed over.
std::size_t line_of_deep_key(std::string_view text) {
  std::size_t line = 1, dots = 0;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (c == '"' || c == '\'') {
      const bool is_long = text.substr(i, 3) == std::string(3, c);
      const std::string end(is_long ? 3 : 1, c);
      for (i += end.size(); i < text.size() && text.substr(i, end.size()) != end && (is_long || text[i] != '\n'); ++i) {
        if (c == '"' && text[i] == '\\' && i + 1 < text.size()) ++i;
        line += text[i] == '\n';
      }
      if (i < text.size() && text[i] == '\n')
        --i;  // a text without an end: the parser reports it
      else
        i += end.size() - 1;
    } else if (c == '#') {
      while (i + 1 < text.size() && text[i + 1] != '\n') ++i;
    } else if (c == '.') {
      if (++dots > most_dots) return line;
    } else if (c == '\n' || c == '=' || c == ',' || c == '[' || c == '{') {
      dots = 0;
      line += c == '\n';
    }
  }
  return 0;
}

}  // namespace

toml::table read_toml(const std::string& what, const std::filesystem::path& file) {
  const std::string text = read_foreign_text(what, file, most_bytes);
  if (const std::size_t line = line_of_deep_key(text); line > 0)
    throw Error("a key has more than {} parts ({}:{})", most_dots + 1, file.string(), line);
  try {
    return toml::parse(text, file.string());
  } catch (const toml::parse_error& error) {
    throw Error("{} ({}:{})", error.description(), file.string(), error.source().begin.line);
  }
}

}  // namespace gnomon
