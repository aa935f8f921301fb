#pragma once
#include <gnomon/scene.h>

#include <string>

#include "measure/json.h"

namespace gnomon {

// What `gnomon describe SCENE` prints: geometry, and every number of lights and views under the keys that scene files have.
// `reference` is what `--scene` named.

std::string describe_text(const std::string& reference, const Scene& scene, std::size_t width = 0);
Json describe_json(const std::string& reference, const Scene& scene);

}  // namespace gnomon
