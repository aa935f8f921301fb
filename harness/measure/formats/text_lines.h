#pragma once
// Private to formats: the lines of a text, their words, and numbers that are nothing else.
#include <cstddef>
#include <string>
#include <string_view>

namespace gnomon::importing {

/// The text of a file without its byte order mark. Throws Error where the mark is that of UTF-16.
std::string_view without_byte_order_mark(const std::string& name, std::string_view bytes);
/// Lower-case ASCII.
std::string lower(std::string_view text);
/// Whether two words are the same but for the case of their ASCII letters.
bool same_word(std::string_view a, std::string_view b);

/// Walks the lines of a text, which end in \n, \r\n or \r, and the words of a line. `name` opens all errors: "FILE:LINE".
class TextLines {
 public:
  /// `comment` opens a remark to the end of the line where it begins a word; 0 for none. `continued`: \ at the end of a line
  /// goes on in the next one.
  TextLines(const std::string& name, std::string_view text, char comment, bool continued = false);

  /// Goes to the next line that has a word in it; false when there is none.
  bool next();
  /// The same for the line of this element, counted from 0, of so many; throws Error when there is none.
  void begin(std::string_view element, std::size_t place, std::size_t count);
  /// The next word of the line, empty at its end.
  std::string_view word();
  /// The next word; throws Error at the end of the line.
  std::string_view need_word();
  /// The next word as a number; throws Error when it is none.
  double number() { return number(need_word()); }
  float real() { return static_cast<float>(number()); }
  double number(std::string_view word) const;
  /// The next word as a whole number, 0 or more.
  std::size_t count(std::string_view what);
  /// What is left of the line, without blanks around it.
  std::string_view rest();
  /// How many words are left in the line.
  std::size_t words_left();

  long line_number() const { return number_; }
  std::string where() const;  ///< "FILE:LINE"
  /// Where the line that comes next begins in the text.
  std::size_t offset() const { return next_; }
  /// How many lines with words are left.
  std::size_t lines_left();

 private:
  const std::string& name_;
  std::string_view text_, line_;
  char comment_;
  bool continued_;
  std::string joined_;
  std::size_t next_ = 0, at_ = 0, words_ = 0;
  long number_ = 0;
  std::string_view element_;
  std::size_t place_ = 0;

  std::string_view raw_line();
};

}  // namespace gnomon::importing
