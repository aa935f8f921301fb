#pragma once
#include <optional>

#include "measure/json.h"

namespace gnomon {

/// Answers what a worker is asked of techniques and scenes before any of them is opened; nothing on other requests:
///
///   {"do": "load", "plugin": FILE}            -> {"techniques": [...], "scenes": [...], "facts": {...}}, or {"refused": why}
///   {"do": "describe", "technique": ID}       -> {"object": {...}}      also "scene": ID
///   {"do": "known_lights", "technique": ID}   -> {"lights": ["point", ...]}
///   {"do": "make_scene", "scene": ID, "settings": "a=1", "out": FILE}   -> {}
///   {"do": "supports", "scene": FILE, "technique": ID, "settings": "a=1"} -> {"lights": [{"support", "why"}, ...]}
///
/// `load` loads the plugin and says what it has, by data sheets alone; `describe` makes an object. `supports` is about every
/// light of the scene under its first view.
std::optional<Json> answer_of_roll(const Json& request);

}  // namespace gnomon
