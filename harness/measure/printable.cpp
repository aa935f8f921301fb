#include "measure/printable.h"

#include <fmt/format.h>

namespace gnomon {
namespace {

/// How many bytes the control character at `at` has; 0 for any other.
std::size_t control_size(std::string_view text, std::size_t at, bool on_one_line) {
  const auto byte = static_cast<unsigned char>(text[at]);
  if (byte == '\n' || byte == '\t') return on_one_line ? 1 : 0;
  if (byte < 0x20 || byte == 0x7f) return 1;
  const bool is_high = byte == 0xc2 && at + 1 < text.size() && static_cast<unsigned char>(text[at + 1]) - 0x80u < 0x20u;
  return is_high ? 2 : 0;
}

/// How many bytes the character at `at` has in UTF-8; 0 where that is none.
std::size_t utf8_size(std::string_view text, std::size_t at) {
  const auto byte = static_cast<unsigned char>(text[at]);
  const std::size_t size = byte < 0x80                   ? 1
                           : byte >= 0xc2 && byte < 0xe0 ? 2
                           : byte >= 0xe0 && byte < 0xf0 ? 3
                           : byte >= 0xf0 && byte < 0xf5 ? 4
                                                         : 0;
  if (size > text.size() - at) return 0;
  for (std::size_t k = 1; k < size; ++k)
    if ((static_cast<unsigned char>(text[at + k]) & 0xc0) != 0x80) return 0;
  return size;
}

}  // namespace

bool has_control_characters(std::string_view text) {
  for (std::size_t at = 0; at < text.size(); ++at)
    if (control_size(text, at, false) > 0) return true;
  return false;
}

std::string printable(std::string_view text, bool on_one_line) {
  std::string result;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t control = control_size(text, at, on_one_line), whole = utf8_size(text, at);
    const std::size_t size = control > 0 ? control : whole > 0 ? whole : 1;
    if (control == 0 && whole > 0)
      result += text.substr(at, size);
    else
      for (std::size_t k = 0; k < size; ++k) result += fmt::format("\\x{:02x}", static_cast<unsigned char>(text[at + k]));
    at += size;
  }
  return result;
}

}  // namespace gnomon
