#pragma once
#include <span>
#include <string>
#include <string_view>

namespace gnomon {

/// The line of a record without these of its members. What is not read is then not parsed, which takes most of the time that
/// reading takes. A line that is no object is as it was.
std::string without_members(std::string_view line, std::span<const std::string_view> keys);

}  // namespace gnomon
