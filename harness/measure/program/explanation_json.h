#pragma once
#include <gnomon/technique.h>

#include <optional>
#include <vector>

#include "measure/json.h"

namespace gnomon {

/// A program's account of some pixels: a list of objects with the keys of Explanation, null where it has none. Keys that are
/// left out keep their defaults; `stored` null is infinity. Throws Error with the pixel's place in the list, the key and what
/// is allowed.
std::vector<std::optional<Explanation>> explanations_from_json(const Json& list);

}  // namespace gnomon
