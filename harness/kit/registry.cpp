#include <dlfcn.h>
#include <gnomon/plugins.h>
#include <gnomon/registry.h>

#include <algorithm>

namespace gnomon {

namespace {

std::string source(const std::string& origin) { return origin.empty() ? "that is built in" : fmt::format("of {}", origin); }

template <class Entry>
void insert(std::vector<Entry>& entries, Entry entry, const std::string& origin, std::string_view what) {
  if (entry.origin.empty()) entry.origin = origin;
  const auto place = std::ranges::lower_bound(entries, entry.id, {}, &Entry::id);
  if (place != entries.end() && place->id == entry.id)
    throw Error("{} {} {} is there already: {}", what, entry.id, source(entry.origin), source(place->origin));
  entries.insert(place, std::move(entry));
}

template <class Entry>
const Entry* find(const std::vector<Entry>& entries, std::string_view id) {
  const auto found = std::ranges::find(entries, id, &Entry::id);
  return found == entries.end() ? nullptr : &*found;
}

template <class Entry>
const Entry& default_of(const std::vector<Entry>& entries, std::string_view what) {
  if (entries.empty()) throw Error("no {} is registered", what);
  const auto found = std::ranges::find_if(entries, [](const Entry& e) { return e.about.is_default; });
  return found == entries.end() ? entries.front() : *found;
}

}  // namespace

std::string_view name(Device device) {
  switch (device) {
    case Device::processor:
      return "processor";
    case Device::opengl:
      return "opengl";
    case Device::vulkan:
      return "vulkan";
  }
  return "";
}

std::string_view name(Floor floor) {
  static constexpr std::string_view names[] = {"none", "depth_draw", "fetch", "copy"};
  return names[static_cast<int>(floor)];
}

std::string_view name(Support::Kind kind) {
  static constexpr std::string_view names[] = {"full", "approximate", "unsupported"};
  return names[static_cast<int>(kind)];
}

Support Support::approximate(std::string why, const Approximation& promise) {
  if (!promise.most_wrong) return Support(Kind::approximate, std::move(why));
  const double most = *promise.most_wrong;
  if (!(most >= 0 && most <= 1)) throw Error("most_wrong = {} is outside 0 .. 1, as a promise of: {}", most, why);
  Support support(Kind::approximate, fmt::format("{}; promises at most {:.3g} % wrong", why, 100 * most));
  support.most_wrong_ = static_cast<float>(most);
  return support;
}

std::vector<float> Technique::draw_debug(std::string_view layer) const {
  std::vector<std::string> layers;
  for (const DebugLayer& known : debug_layers()) layers.push_back(known.name);
  if (layers.empty()) throw Error("{} has no debug layer {}; it has none at all", id(), layer);
  throw Error("{} has no debug layer {}; it has: {}", id(), layer, joined(layers, ", "));
}

void Registry::add(TechniqueEntry entry) { insert(techniques_, std::move(entry), origin_, "technique"); }
void Registry::add(SceneEntry entry) { insert(scenes_, std::move(entry), origin_, "scene"); }

const TechniqueEntry& Registry::technique(std::string_view id) const {
  if (const TechniqueEntry* entry = find_technique(id)) return *entry;
  std::vector<std::string> ids;
  for (const TechniqueEntry& entry : techniques_) ids.push_back(entry.id);
  throw Error("there is no technique {}; did you mean {}? There are: {}", id, nearest_word(id, ids), joined(ids, ", "));
}

const TechniqueEntry* Registry::find_technique(std::string_view id) const { return find(techniques_, id); }
const SceneEntry* Registry::find_scene(std::string_view id) const { return find(scenes_, id); }

const TechniqueEntry& Registry::default_technique() const { return default_of(techniques_, "technique"); }
const SceneEntry& Registry::default_scene() const { return default_of(scenes_, "scene"); }

const TechniqueEntry& Registry::reference() const {
  for (const TechniqueEntry& entry : techniques_)
    if (entry.about.role == Role::reference) return entry;
  throw Error("no technique has the role of the reference");
}

Registry& registry() {
  static Registry the_registry;
  return the_registry;
}

namespace {

std::vector<PluginFacts>& plugins() {
  static std::vector<PluginFacts> all;
  return all;
}

/// What the roll of gnomon_add_plugin says of its build.
PluginFacts facts_of(void* library, const std::string& path, const std::string& file) {
  const auto text = [&](const char* name) -> std::string {
    const auto* const found = static_cast<const char*>(dlsym(library, name));
    return found ? found : "";
  };
  const std::string flags = text("gnomon_plugin_flags");
  PluginFacts facts{.path = path,
                    .file = file,
                    .build_type = text("gnomon_plugin_build_type"),
                    .flags = flags.substr(std::min(flags.find_first_not_of(' '), flags.size())),
                    .compiler = text("gnomon_plugin_compiler")};
  if (const auto* const is_optimized = static_cast<const bool*>(dlsym(library, "gnomon_plugin_is_optimized")))
    facts.is_optimized = *is_optimized;
  return facts;
}

}  // namespace

const std::vector<PluginFacts>& loaded_plugins() { return plugins(); }
void note_plugin(PluginFacts facts) { plugins().push_back(std::move(facts)); }

void load_plugin(const std::string& path) {
  // dlopen looks for a bare name in the system's folders.
  const std::string file = path.find('/') == path.npos ? "./" + path : path;
  void* library = dlopen(file.c_str(), RTLD_NOW | RTLD_LOCAL);
  if (!library) throw Error("plugin {} cannot be loaded: {}", path, dlerror());
  static std::vector<void*> libraries;
  if (std::ranges::find(libraries, library) != libraries.end()) return;  // the same file, also by another way to it
  const auto* abi = static_cast<const int*>(dlsym(library, "gnomon_plugin_abi"));
  if (!abi) throw Error("plugin {} is not a Gnomon plugin: it has no symbol gnomon_plugin_abi", path);
  if (*abi != abi_version)
    throw Error("plugin {} was built for contract {}; this program speaks {}: build it again", path, *abi, abi_version);
  const auto roll_call = reinterpret_cast<void (*)(Registry&)>(dlsym(library, "gnomon_plugin_roll_call"));
  if (!roll_call) throw Error("plugin {} is not a Gnomon plugin: it has no symbol gnomon_plugin_roll_call", path);
  registry().set_origin(path);
  roll_call(registry());
  registry().set_origin("");
  libraries.push_back(library);
  note_plugin(facts_of(library, path, file));
}

}  // namespace gnomon
