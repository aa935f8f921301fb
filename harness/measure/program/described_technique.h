#pragma once
#include <gnomon/registry.h>

#include "measure/json.h"

namespace gnomon {

// A technique or a scene of a plugin in this process: a description by a worker that has loaded the plugin's library. None of
// its code runs here.

/// An entry of the roll, without making an object: id and data sheet.
Json sheet_json(const TechniqueEntry& entry);
Json sheet_json(const SceneEntry& entry);
/// Facts of a fresh object: parameters, layers.
Json object_json(const TechniqueEntry& entry);
Json object_json(const SceneEntry& entry);

/// How a scene of a plugin is made, somewhere else: id and settings.
using MakeScene = std::function<Scene(const std::string&, const std::string&)>;

/// Entries made of both. `broken` says why there is no object, whose JSON is null then; every call of such a technique throws
/// it. `lights` are the kinds of light that it supports; empty: all of them, because nothing here may query it. Throws Error,
/// or Json::exception, on what is no description.
TechniqueEntry described_technique(const Json& sheet, const Json& object, const std::vector<std::string>& lights,
                                   const std::string& broken);
SceneEntry described_scene(const Json& sheet, const Json& object, const std::string& broken, const MakeScene& make);

}  // namespace gnomon
