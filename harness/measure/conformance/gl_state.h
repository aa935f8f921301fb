#pragma once
#include <string>
#include <vector>

namespace gnomon {

/// What differs from the house state, one line each ("blend is on"); empty where nothing does. The viewport is not part of it:
/// every pass sets its own.
std::vector<std::string> state_differences();

}  // namespace gnomon
