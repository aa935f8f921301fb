#include "measure/program/plugin_facts.h"

#include <gnomon/plugins.h>
#include <gnomon/registry.h>

#include "measure/paths.h"
#include "measure/program/description.h"
#include "measure/scene/blob.h"

namespace gnomon {

namespace {

std::string origin_of(const std::string& technique) {
  const TechniqueEntry* const entry = registry().find_technique(technique);
  return entry ? entry->origin : "";
}

const PluginFacts* plugin_of(const std::string& technique) {
  const std::string origin = origin_of(technique);
  const auto found = std::ranges::find(loaded_plugins(), origin, &PluginFacts::path);
  return origin.empty() || found == loaded_plugins().end() ? nullptr : &*found;
}

/// The files of a technique from outside: a plugin's library; a program's description, and what of its command is a file.
std::vector<std::filesystem::path> files_of(const std::string& technique) {
  if (const PluginFacts* const plugin = plugin_of(technique)) return {plugin->file};
  const std::string origin = origin_of(technique);
  return origin.ends_with(".toml") ? program_files(*read_program(origin)) : std::vector<std::filesystem::path>();
}

/// Empty for a technique that is built in.
const std::string& hash_of_files(const std::string& technique) {
  static std::map<std::string, std::string> hashes;  // of this process: files are read once
  const auto [found, is_new] = hashes.try_emplace(technique);
  if (!is_new) return found->second;
  const std::vector<std::filesystem::path> files = files_of(technique);
  std::string together;
  for (const std::filesystem::path& file : files) together += content_hash(MappedFile::open(file)->bytes());
  return found->second = files.size() > 1 ? content_hash(together) : together;
}

/// The technique itself or one that its settings put within it, the first that comes from outside; itself where none does.
std::string from_outside(const std::string& technique, const std::string& settings) {
  const TechniqueEntry* const entry = registry().find_technique(technique);
  if (!entry || !entry->origin.empty()) return technique;
  const std::vector<std::string> inner = inner_techniques(technique, settings);
  const auto found = std::ranges::find_if(inner, [](const std::string& id) { return !origin_of(id).empty(); });
  return found == inner.end() ? technique : *found;
}

/// A program that comes with the testbed by its path within the testbed, wherever that is installed: "techniques/pov_ray.toml".
std::string path_of(const std::string& origin) {
  const std::string root = find_data_root().string() + "/";
  return root.size() > 1 && origin.starts_with(root) ? origin.substr(root.size()) : origin;
}

}  // namespace

std::vector<std::string> inner_techniques(const std::string& technique, const std::string& settings) {
  std::vector<std::string> inner;
  const auto object = registry().technique(technique).make();
  try {
    object->apply(settings);
  } catch (const Error&) {
    return inner;  // of a record whose settings are not valid any more
  }
  for (const Parameter* const row : object->parameters())
    if (dynamic_cast<const ObjectParameter*>(&typed(*row))) inner.push_back(row->text());
  return inner;
}

Json plugin_facts(const std::string& contender, const std::string& settings) {
  const std::string technique = from_outside(contender, settings);
  const std::string& hash = hash_of_files(technique);
  if (hash.empty()) return nullptr;
  Json facts = json_object({{"path", path_of(origin_of(technique))}, {"hash", hash}});
  const PluginFacts* const plugin = plugin_of(technique);
  if (!plugin || plugin->compiler.empty()) return facts;  // a program, or built by other means than gnomon_add_plugin
  facts["build_type"] = plugin->build_type;
  facts["flags"] = plugin->flags;
  facts["compiler"] = plugin->compiler;
  facts["optimized"] = plugin->is_optimized;
  return facts;
}

bool has_other_plugin(const Record& record) {
  return registry().find_technique(record.technique) &&
         plugin_hash(record) != hash_of_files(from_outside(record.technique, record.settings));
}

}  // namespace gnomon
