#pragma once
#include "analysis/in_order.h"

namespace gnomon {

/// A line for each of these places that some of the settings lack, the first few of many: the lead, the place, a setting that
/// lacks it and why.
std::vector<std::string> missing_places(std::span<const Record> records, const RowsBySetting& settings,
                                        std::span<const Place> all, std::string_view lead);

}  // namespace gnomon
