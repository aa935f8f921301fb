#pragma once
#include <string>
#include <vector>

#include "fuzz.h"

namespace fuzz {

/// Whether the program is in this build: in that of the sanitizers of every check it is not.
extern const bool has_program;

/// Runs the program with these words within this process: accepted by exit status 0; Problem where it is none of those for bad
/// input. Without the program nothing is run.
Outcome run_words(std::vector<std::string> words);

}  // namespace fuzz
