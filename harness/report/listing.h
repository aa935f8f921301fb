#pragma once
#include <gnomon/registry.h>

#include <span>
#include <string>
#include <vector>

#include "measure/record/record.h"
#include "measure/score/metrics.h"

namespace gnomon {

// What `gnomon list` and `gnomon describe` print: text for a terminal `width` columns wide (0: no limit), or JSON.

/// The names of the features of scenes that a technique handles: "alpha_masks".
std::vector<std::string> handled(const About& about);

std::string list_text(std::span<const TechniqueEntry> entries, std::size_t width = 0);
Json list_json(std::span<const TechniqueEntry> entries);

std::string list_text(std::span<const MetricInfo> metrics, std::size_t width = 0);
Json list_json(std::span<const MetricInfo> metrics);

/// The causes, then those that the techniques have of their own.
std::string list_text(std::span<const CauseInfo> causes, std::span<const TechniqueEntry> entries, std::size_t width = 0);
Json list_json(std::span<const CauseInfo> causes, std::span<const TechniqueEntry> entries);

/// With settings "of=stencil_volume" the rows of the object that they put within the technique. Throws Error on bad settings.
std::string describe_text(const TechniqueEntry& entry, std::size_t width = 0, std::string_view settings = "");
Json describe_json(const TechniqueEntry& entry, std::string_view settings = "");

/// Parameter rows of anything that has them: techniques and scene generators.
std::string parameters_text(const Parametrized& object, std::size_t width = 0);
Json parameters_json(const Parametrized& object);

}  // namespace gnomon
