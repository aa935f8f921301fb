#pragma once
#include <string>

#include "app/viewer/session.h"

namespace gnomon::viewer {

/// The settings that a side is named with, "resolution=512, filter=pcf": those that are not the default, and, beside the same
/// technique, those in which the two differ. Empty where there are none.
std::string told_settings(const Parametrized& side, const Parametrized& other);

/// The name of a side's technique: "Shadow map".
std::string technique_title(const Session& session, int side);
/// With its settings: "Shadow map, resolution=512".
std::string title_of(const Session& session, int side);

}  // namespace gnomon::viewer
