#pragma once
#include <gnomon/registry.h>

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "measure/record/record.h"

namespace gnomon {

std::string_view name(Promise promise);

// Pages of the documentation: all they say comes from the registry, so a technique's file is its only source.

/// docs/techniques/ID.md.
std::string technique_page(const TechniqueEntry& entry);
/// docs/techniques/README.md: one line for each technique.
std::string technique_index(std::span<const TechniqueEntry> entries);
/// Writes the index and every page into `dir` and removes generated pages of techniques that are gone. Throws Error.
void write_pages(const std::filesystem::path& dir, std::span<const TechniqueEntry> entries = registry().techniques());
/// Names of files in `dir` that `write_pages` would change, make or remove.
std::vector<std::string> stale_pages(const std::filesystem::path& dir,
                                     std::span<const TechniqueEntry> entries = registry().techniques());

/// Opens every generated page, and says what to edit instead of it.
std::string generated_header(const std::string& source);
/// Whether a file is not there or holds something else.
bool is_stale(const std::filesystem::path& file, const std::string& text);

}  // namespace gnomon
