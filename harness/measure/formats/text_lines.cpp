#include "measure/formats/text_lines.h"

#include <gnomon/error.h>

#include <algorithm>
#include <charconv>
#include <cstdlib>

namespace gnomon::importing {
namespace {

constexpr std::string_view blanks = " \t\v\f";

/// Whether a \ is the last of a line but blanks.
bool goes_on(std::string_view line) {
  const std::size_t last = line.find_last_not_of(blanks);
  return last != line.npos && line[last] == '\\';
}

char small(char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; }

}  // namespace

std::string_view without_byte_order_mark(const std::string& name, std::string_view bytes) {
  if (bytes.starts_with("\xFE\xFF") || bytes.starts_with("\xFF\xFE")) throw Error("{}: is UTF-16 text; UTF-8 is read", name);
  if (bytes.starts_with("\xEF\xBB\xBF")) bytes.remove_prefix(3);
  return bytes;
}

std::string lower(std::string_view text) {
  std::string small_text(text);
  std::ranges::transform(small_text, small_text.begin(), small);
  return small_text;
}

bool same_word(std::string_view a, std::string_view b) { return std::ranges::equal(a, b, {}, small, small); }

TextLines::TextLines(const std::string& name, std::string_view text, char comment, bool continued)
    : name_(name), text_(text), comment_(comment), continued_(continued) {}

std::string_view TextLines::raw_line() {
  const std::size_t end = std::min(text_.find_first_of("\r\n", next_), text_.size());
  const std::string_view line = text_.substr(next_, end - next_);
  next_ = end + (text_.substr(end).starts_with("\r\n") ? 2 : end < text_.size() ? 1 : 0);
  ++number_;
  return line;
}

bool TextLines::next() {
  // Within a word it is a letter: Material_#25, or 1.#QNAN, which is no number.
  const auto stripped = [&](std::string_view line) {
    std::size_t at = comment_ ? line.find(comment_) : line.npos;
    while (at != line.npos && at > 0 && blanks.find(line[at - 1]) == blanks.npos) at = line.find(comment_, at + 1);
    return line.substr(0, at);
  };
  while (next_ < text_.size()) {
    line_ = stripped(raw_line());
    if (continued_ && goes_on(line_)) {
      joined_.clear();
      while (goes_on(line_) && next_ < text_.size()) {
        joined_.append(line_.substr(0, line_.rfind('\\'))).append(" ");
        line_ = stripped(raw_line());
      }
      joined_.append(line_.substr(0, goes_on(line_) ? line_.rfind('\\') : line_.npos));
      line_ = joined_;
    }
    at_ = words_ = 0;
    element_ = {};
    if (line_.find_first_not_of(blanks) != line_.npos) return true;
  }
  line_ = {};
  at_ = 0;
  return false;
}

void TextLines::begin(std::string_view element, std::size_t place, std::size_t count) {
  if (!next())
    throw Error("{}: holds {} of {} {} lines; it is truncated, or has more than one {} on a line", name_, place, count, element,
                element);
  element_ = element;
  place_ = place;
}

std::string_view TextLines::word() {
  const std::size_t begin = line_.find_first_not_of(blanks, at_);
  if (begin == line_.npos) return {};
  at_ = std::min(line_.find_first_of(blanks, begin), line_.size());
  ++words_;
  return line_.substr(begin, at_ - begin);
}

std::string_view TextLines::need_word() {
  const std::string_view next_word = word();
  if (!next_word.empty()) return next_word;
  if (element_.empty()) throw Error("{}: ends after {} words", where(), words_);
  throw Error("{}: {} {} ends after {} numbers; it is truncated", where(), element_, place_, words_);
}

double TextLines::number(std::string_view text) const {
  const std::string_view digits = text.substr(text.starts_with('+') && !text.starts_with("+-") ? 1 : 0);
  double value = 0;
  const auto [end, code] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  if (code == std::errc::result_out_of_range) return std::strtod(std::string(digits).c_str(), nullptr);  // 0 or infinite
  if (code != std::errc{} || end != digits.data() + digits.size()) {
    if (element_.empty()) throw Error("{}: '{}' is not a number", where(), text);
    throw Error("{}: '{}' of {} {} is not a number", where(), text, element_, place_);
  }
  return value;
}

std::size_t TextLines::count(std::string_view what) {
  const std::string_view text = need_word();
  std::size_t value = 0;
  const auto [end, code] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (code != std::errc{} || end != text.data() + text.size())
    throw Error("{}: {} = '{}' is not a whole number, 0 or more", where(), what, text);
  return value;
}

std::string_view TextLines::rest() {
  const std::size_t begin = line_.find_first_not_of(blanks, at_);
  at_ = line_.size();
  if (begin == line_.npos) return {};
  return line_.substr(begin, line_.find_last_not_of(blanks) - begin + 1);
}

std::size_t TextLines::words_left() {
  const auto [at, words] = std::pair(at_, words_);
  std::size_t left = 0;
  while (!word().empty()) ++left;
  at_ = at;
  words_ = words;
  return left;
}

std::string TextLines::where() const { return fmt::format("{}:{}", name_, number_); }

std::size_t TextLines::lines_left() {
  std::size_t left = 0;
  while (next()) ++left;
  return left;
}

}  // namespace gnomon::importing
