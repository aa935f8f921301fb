#include "measure/run/plugin_facts.h"

#include <gnomon/plugins.h>
#include <gnomon/registry.h>

#include <algorithm>
#include <map>

#include "measure/record/origin.h"
#include "measure/scene/blob.h"

namespace gnomon {

namespace {

const PluginFacts* plugin_of(const std::string& technique) {
  const auto entry = std::ranges::find(registry().techniques(), technique, &TechniqueEntry::id);
  if (entry == registry().techniques().end() || entry->origin.empty()) return nullptr;
  const auto found = std::ranges::find(loaded_plugins(), entry->origin, &PluginFacts::path);
  return found == loaded_plugins().end() ? nullptr : &*found;
}

const std::string& file_hash(const PluginFacts& plugin) {
  static std::map<std::string, std::string> hashes;
  const auto [found, is_new] = hashes.try_emplace(plugin.path);
  if (is_new) found->second = content_hash(MappedFile::open(plugin.file)->bytes());
  return found->second;
}

}  // namespace

Json plugin_facts(const std::string& technique) {
  const PluginFacts* const plugin = plugin_of(technique);
  if (!plugin) return nullptr;
  Json facts = json_object({{"path", plugin->path}, {"hash", file_hash(*plugin)}});
  if (plugin->compiler.empty()) return facts;  // built by other means than gnomon_add_plugin
  facts["build_type"] = plugin->build_type;
  facts["flags"] = plugin->flags;
  facts["compiler"] = plugin->compiler;
  facts["optimized"] = plugin->is_optimized;
  return facts;
}

bool has_other_plugin(const Record& record) {
  const auto& all = registry().techniques();
  if (std::ranges::find(all, record.technique, &TechniqueEntry::id) == all.end()) return false;
  const PluginFacts* const plugin = plugin_of(record.technique);
  return plugin_hash(record) != (plugin ? file_hash(*plugin) : "");
}

}  // namespace gnomon
