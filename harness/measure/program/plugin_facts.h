#pragma once
#include "measure/record/record.h"

namespace gnomon {

/// The techniques that its settings put within one (averaged_hard:of=ID); none where they are not valid.
std::vector<std::string> inner_techniques(const std::string& technique, const std::string& settings);

/// The facts in a record about the plugin or program that a technique comes from: `path` as given, `hash` of the file, of a
/// program that of its description and of the files that its command names; `build_type`, `flags`, `compiler` and `optimized`,
/// left out where the plugin does not state them. Of a technique that is built in they are those of the one within it
/// (inner_techniques); null where that is built in, too. Files are read once for each process.
Json plugin_facts(const std::string& technique, const std::string& settings = "");

/// Whether the row's technique exists now, and comes from other bytes than then: from a plugin that was built anew, a program
/// that was changed, or from one now or then only.
bool has_other_plugin(const Record& record);

}  // namespace gnomon
