#pragma once
#include <gnomon/technique.h>

#include "measure/json.h"

namespace gnomon {

// What both sides of a worker's socket say and read alike.

/// "support" and "why".
Json support_json(const Support& support);
/// Throws Error on a support that there is not, Json::exception where there is none.
Support support_from(const Json& json);

/// Its place in stage_names. Throws Error on a stage that there is not.
int stage_named(const std::string& name);

}  // namespace gnomon
