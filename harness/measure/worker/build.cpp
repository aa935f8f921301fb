#include "measure/worker/build.h"

#include <gnomon/registry.h>

#include "gnomon_commit.h"
#include "measure/program/plugin_facts.h"
#include "measure/scene/blob.h"

#ifdef __clang__
#define GNOMON_COMPILER __VERSION__
#else
#define GNOMON_COMPILER "g++ " __VERSION__
#endif

namespace gnomon {

namespace {

constexpr std::pair<std::string_view, std::string_view> built_in[] = {GNOMON_TECHNIQUE_SOURCES};
constexpr unsigned char changes[] = {GNOMON_CHANGES 0};

std::string build_hash() {
  return content_hash(joined(std::vector<std::string>{GNOMON_SOURCES, GNOMON_BUILD_TYPE, GNOMON_COMPILER, GNOMON_FLAGS}, "\n"))
      .substr(0, 16);
}

std::string_view source_of(std::string_view technique) {
  const TechniqueEntry* const entry = registry().find_technique(std::string(technique));
  if (!entry || !entry->origin.empty()) return {};
  const auto* const found = std::ranges::find(built_in, technique, &std::pair<std::string_view, std::string_view>::first);
  return found == std::end(built_in) ? std::string_view() : found->second;
}

}  // namespace

Json build_context() {
  return json_object({{"version", GNOMON_VERSION},
                      {"commit", GNOMON_COMMIT},
                      {"build", build_hash()},
                      {"build_type", GNOMON_BUILD_TYPE},
                      {"compiler", GNOMON_COMPILER},
                      {"flags", GNOMON_FLAGS}});
}

std::string technique_source(const std::string& technique, const std::string& settings) {
  std::string source(source_of(technique)), inner;
  if (source.empty()) return source;
  for (const std::string& id : inner_techniques(technique, settings)) inner += source_of(id);
  return inner.empty() ? source : content_hash(source + inner).substr(0, 16);
}

Json technique_sources() {
  Json sources = Json::object();
  for (const auto& [id, hash] : built_in) sources[std::string(id)] = hash;
  return sources;
}

std::string build_text() { return fmt::format("{} (commit {}, build {})", GNOMON_VERSION, GNOMON_COMMIT, build_hash()); }

std::string_view tree_changes() { return {reinterpret_cast<const char*>(changes), sizeof changes - 1}; }

}  // namespace gnomon
