#pragma once
#include <string>
#include <vector>

#include "fuzz.h"

namespace fuzz {

/// Runs the program with these words within this process: accepted by exit status 0; Problem where it is none of those for bad
/// input. A build that lacks the program (the sanitizers' of every check) accepts all words.
Outcome run_words(std::vector<std::string> words);

}  // namespace fuzz
