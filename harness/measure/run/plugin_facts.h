#pragma once
#include <string>

#include "measure/record/record.h"

namespace gnomon {

/// What a record says of the plugin that a technique comes from: `path` as given, `hash` of the file, `build_type`, `flags`,
/// `compiler` and `optimized`, those of the program's own where the plugin says nothing of them left out. Null for a technique
/// that comes from no plugin. The file is read once for each process.
Json plugin_facts(const std::string& technique);

/// Whether the row's technique is there now, and comes from other bytes than then: from a plugin that was built anew, or from
/// one now or then only.
bool has_other_plugin(const Record& record);

}  // namespace gnomon
