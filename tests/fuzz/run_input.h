#pragma once
#include "fuzz.h"

namespace fuzz {

// What one input may cost: processor time, that of its children included, and memory beyond what the process had before. Code
// with the sanitizers, compiled without optimization, takes ten times as long.
#ifdef __SANITIZE_ADDRESS__
inline constexpr double most_seconds = 20, most_megabytes = 1000;
#else
inline constexpr double most_seconds = 2, most_megabytes = 500;
#endif

/// Writes the input to a file below `scratch` and has it read. Throws Problem when a bound is broken, or when what is thrown is
/// no complaint: an Error, in words that are ours.
Answer run_input(const Kind& kind, const Input& input, const std::filesystem::path& scratch);

}  // namespace fuzz
