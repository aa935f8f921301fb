#pragma once
#include <string>
#include <string_view>

namespace gnomon {

/// Whether a text holds control characters beside tabs and ends of lines: those of ASCII, and U+0080 .. U+009F in UTF-8.
bool has_control_characters(std::string_view text);

/// A text from outside as people may see it: control characters, and bytes that are no UTF-8, are shown as \x1b, so that they
/// do nothing to a terminal. On one line, tabs and ends of lines are such, too.
std::string printable(std::string_view text, bool on_one_line = false);

}  // namespace gnomon
