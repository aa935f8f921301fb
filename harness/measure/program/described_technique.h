#pragma once
#include <gnomon/registry.h>

#include "measure/json.h"

namespace gnomon {

// A technique or a scene of a plugin as this process knows it: what a worker, which has the plugin's library, says of it.
// Nothing of it runs here.

/// What the roll says of an entry, without making an object: id and data sheet.
Json sheet_json(const TechniqueEntry& entry);
Json sheet_json(const SceneEntry& entry);
/// What a fresh object says of itself: parameters, layers.
Json object_json(const TechniqueEntry& entry);
Json object_json(const SceneEntry& entry);

/// How a scene of a plugin is made, somewhere else: id and settings.
using MakeScene = std::function<Scene(const std::string&, const std::string&)>;

/// Entries made of both. `broken` says why there is no object, whose JSON is null then; it is what such a technique says to
/// whatever it is asked. `lights` are the kinds of light that it knows; all of them where there are none, for nobody may ask it
/// here. Throws Error, or Json::exception, on what is no description.
TechniqueEntry described_technique(const Json& sheet, const Json& object, const std::vector<std::string>& lights,
                                   const std::string& broken);
SceneEntry described_scene(const Json& sheet, const Json& object, const std::string& broken, const MakeScene& make);

}  // namespace gnomon
