#pragma once
#include <fmt/format.h>

#include <iterator>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

namespace gnomon {

/// Bad input. The text says what, which value, what is allowed and where, in that order.
/// Bugs are `assert`; an expected no is `Support`; nothing is both logged and thrown.
class Error : public std::runtime_error {
 public:
  explicit Error(std::string text) : std::runtime_error(whole(text)) {}
  template <class... Args>
  explicit Error(fmt::format_string<Args...> format, Args&&... args)
      : Error(fmt::format(format, std::forward<Args>(args)...)) {}

 private:
  /// what() ends at a zero byte; a quoted one is shown as another.
  static const std::string& whole(std::string& text) {
    for (char& c : text)
      if (c == '\0') c = '?';
    return text;
  }
};

/// Words as one text: "a, b, c". fmt::join does the same and is compiled anew wherever it is used.
std::string joined(std::span<const std::string> words, std::string_view between = ", ");
/// Of anything else that holds texts.
template <class Texts>
requires(!std::is_convertible_v<const Texts&, std::span<const std::string>>) std::string
    joined(const Texts& texts, std::string_view between = ", ") {
  return joined(std::vector<std::string>(std::begin(texts), std::end(texts)), between);
}

}  // namespace gnomon
