#pragma once
#include <string>
#include <string_view>

#include "measure/json.h"

namespace gnomon {

/// What this program was built of, as records say it: `version`, `commit` ("-dirty" where the tree held something else),
/// `build_type`, `compiler`, `flags`, and `build`, a hash of the last three and of all sources by which rows are measured but
/// those of techniques. Two programs of one `build` measure alike, whatever their commits.
Json build_context();

/// Hash of the sources that a technique was built of, and of those that its settings put within it; "" of one that comes from a
/// plugin or is a program, which has a hash of its own (plugin_facts).
std::string technique_source(const std::string& technique, const std::string& settings);

/// By id of each technique that is built in.
Json technique_sources();

/// "1.2.3 (commit 0123456789, build 0123456789abcdef)".
std::string build_text();

/// What the tree that this program was built of differed by from its commit, as `git diff` has it; "" where it did not.
std::string_view tree_changes();

}  // namespace gnomon
