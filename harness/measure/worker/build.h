#pragma once
#include "measure/json.h"

namespace gnomon {

/// The build of this program, as records store it: `version`, `commit` ("-dirty" where the tree differed from it),
/// `build_type`, `compiler`, `flags`, and `build`, a hash of the last three and of all sources by which rows are measured but
/// those of techniques. Two programs of one `build` measure alike, whatever their commits.
Json build_context();

/// Hash of the sources of a technique, and of those that its settings put within it; "" of one that comes from a plugin or is a
/// program, which has a hash of its own (plugin_facts).
std::string technique_source(const std::string& technique, const std::string& settings);

/// By id of each technique that is built in.
Json technique_sources();

/// "1.2.3 (commit 0123456789, build 0123456789abcdef)".
std::string build_text();

/// How the tree of this build differed from its commit, as `git diff` prints it; "" where it did not.
std::string_view tree_changes();

}  // namespace gnomon
