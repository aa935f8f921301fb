#pragma once
#include <string_view>

namespace gnomon {

/// The page without its data, made from harness/report/html/web by the build: it holds each slot once. Empty when the program
/// was built without it (GNOMON_REPORT=OFF).
std::string_view page_template();

// What stands in the template where data belongs.
inline constexpr std::string_view title_slot = "@GNOMON_TITLE@";
inline constexpr std::string_view data_slot = "@GNOMON_DATA@";
inline constexpr std::string_view pictures_slot = "@GNOMON_PICTURES@";

}  // namespace gnomon
