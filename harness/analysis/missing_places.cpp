#include "analysis/missing_places.h"

#include "measure/counted.h"

namespace gnomon {

namespace {

/// "fails: failed, it crashed": a setting that has no value at a place, and why.
std::string why_missing(std::span<const Record> records, const Record& setting, const Place& place) {
  const auto is_there = [&](const Record& r) { return setting_key(r) == setting_key(setting) && place_of(r) == place; };
  const auto found = std::ranges::find_if(records, is_there);
  if (found == records.end()) return fmt::format("{}: not in the run", setting_name(setting));
  if (found->status == Status::ok) return fmt::format("{}: not defined", setting_name(setting));
  return fmt::format("{}: {}{}", setting_name(setting), name(found->status), found->reason.empty() ? "" : ", " + found->reason);
}

}  // namespace

std::vector<std::string> missing_places(std::span<const Record> records, const RowsBySetting& settings,
                                        std::span<const Place> all, std::string_view lead) {
  constexpr std::size_t most = 6;
  std::vector<std::string> lines;
  std::size_t missing = 0;
  for (const Place& place : all) {
    std::size_t lacking = 0;
    std::string why;
    for (const auto& [key, rows] : settings)
      if (!rows.contains(place) && lacking++ == 0 && missing < most) why = why_missing(records, *rows.begin()->second, place);
    if (lacking == 0 || ++missing > most) continue;
    if (lacking > 1) why += ", and " + counted(lacking - 1, "more setting{s}");
    lines.push_back(fmt::format("{}: {} ({})", lead, title(place, all), why));
  }
  if (missing > most) lines.push_back("and " + counted(missing - most, "more place{s}"));
  return lines;
}

}  // namespace gnomon
