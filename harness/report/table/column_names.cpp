// Columns by the words that people have for them: names, and headings as tables print them.
#include <cctype>

#include "analysis/in_order.h"
#include "report/table/columns.h"

namespace gnomon {

namespace {

/// In small letters, with one blank for blanks and line breaks between words.
std::string folded(std::string_view text) {
  std::string words;
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    if (!std::isspace(byte))
      words += static_cast<char>(std::tolower(byte));
    else if (!words.empty() && words.back() != ' ')
      words += ' ';
  }
  if (words.ends_with(' ')) words.pop_back();
  return words;
}

/// Whether the folded word is the column's heading, alone or with the unit as one of the formats prints it.
bool is_heading(const Column& column, std::string_view word) {
  for (const char* form : {"{}", "{} {}", "{} ({})", "{} [{}]"})
    if (folded(fmt::format(fmt::runtime(form), column.heading, column.shown_unit)) == word) return true;
  return false;
}

/// The names of the columns whose name or heading is nearest to the word.
std::vector<std::string> nearest_names(std::span<const Column> columns, std::string_view word) {
  constexpr std::size_t most = 5;
  std::vector<std::string> words, names;
  std::map<std::string, std::string> name_of;  // by name or heading
  for (const Column& column : columns) {
    for (const std::string& one : {column.name, folded(column.heading)})
      if (name_of.try_emplace(one, column.name).second) words.push_back(one);
  }
  for (const std::string& one : nearest_words(word, words, words.size()))
    if (names.size() < most) add_once(names, name_of.at(one));
  return names;
}

}  // namespace

std::vector<std::string> names_with_heading(std::span<const Column> columns, std::string_view heading) {
  const std::string words = folded(heading);
  std::vector<std::string> names;
  for (const Column& column : columns)
    if (is_heading(column, words)) names.push_back(column.name);
  return names;
}

std::vector<Column> select(const std::vector<Column>& columns, std::span<const std::string> names) {
  std::vector<Column> selected;
  for (const std::string& word : names) {
    std::vector<std::string> named{word};
    if (std::ranges::find(columns, word, &Column::name) == columns.end()) named = names_with_heading(columns, word);
    if (named.size() > 1)
      throw Error("{} is the heading of {} columns; name one of them: {}", word, named.size(), joined(named));
    if (named.empty()) {
      named = nearest_names(columns, word);
      throw Error("there is no column {}; did you mean {}? Near are also: {}", word, named.front(),
                  joined(std::span(named).subspan(1)));
    }
    selected.push_back(*std::ranges::find(columns, named.front(), &Column::name));
  }
  return selected;
}

}  // namespace gnomon
