#pragma once
#include <gnomon/technique.h>

#include <functional>

namespace gnomon {

/// Version of the contract: a plugin built for another number is refused.
inline constexpr int abi_version = 26;

/// A scene made by a program instead of a file; one per file in scenes/. Gives lights `point` and `sun` and at least one view.
class SceneGenerator : public Parametrized {
 public:
  virtual Scene make() const = 0;
};

/// A key of `gnomon view` that a scene brings along: it sets one of the scene's parameters. From another scene it goes to its
/// own.
struct SceneKey {
  char letter;                 ///< 'A' .. 'Z', as on the key's cap; one that the viewer does not use itself
  std::string_view parameter;  ///< of the generator: "object"
  std::string_view value;      ///< that it is set to, as the command line writes it: "circle"
  std::string_view sentence;   ///< for the help: "Shadowed object: circle."
};

struct SceneAbout {
  std::string_view title;
  std::string_view summary;  ///< one sentence: what it is and what it brings out
  bool is_default = false;   ///< the scene that `gnomon view` opens when none is named
  std::vector<SceneKey> keys = {};
};

struct TechniqueEntry {
  std::string id;
  About about;
  std::function<std::unique_ptr<Technique>()> make;  ///< fresh object, id set
  std::string origin = {};  ///< file that it was loaded from, as given: of a plugin or of a program; empty: built in
  std::string broken =
      {};  ///< what a worker could not do with a fresh object of it: "crashed in describe: ..."; empty: nothing
};
struct SceneEntry {
  std::string id;
  SceneAbout about;
  std::function<std::unique_ptr<SceneGenerator>()> make;
  std::string origin = {};
};

/// All that was called in the roll: techniques and generated scenes in alphabetical order of their ids.
class Registry {
 public:
  void add(TechniqueEntry entry);  ///< throws Error on an id that is taken, with where both come from
  void add(SceneEntry entry);
  /// Where what is added from now on comes from; empty: built in.
  void set_origin(std::string origin) { origin_ = std::move(origin); }
  const std::vector<TechniqueEntry>& techniques() const { return techniques_; }
  const std::vector<SceneEntry>& scenes() const { return scenes_; }
  /// Throws Error with the nearest id and the list.
  const TechniqueEntry& technique(std::string_view id) const;
  const TechniqueEntry* find_technique(std::string_view id) const;
  const SceneEntry* find_scene(std::string_view id) const;
  /// The first whose data sheet says `is_default`, else the first of all. Throws Error when there is none at all.
  const TechniqueEntry& default_technique() const;
  const SceneEntry& default_scene() const;
  /// The technique whose role it is to be the reference. Throws Error when there is none.
  const TechniqueEntry& reference() const;

 private:
  std::vector<TechniqueEntry> techniques_;
  std::vector<SceneEntry> scenes_;
  std::string origin_;
};

/// The registry of this process.
Registry& registry();

/// Loads a plugin and calls its roll. Throws Error when it cannot be loaded or was built for another contract.
void load_plugin(const std::string& path);

template <class Base, class Class>
std::unique_ptr<Base> made(const char* id) {
  auto object = std::make_unique<Class>();
  object->set_id(id);
  return object;
}

}  // namespace gnomon

/// Registers the technique of this file. `id` is the file's stem; the build writes the roll that calls it. The rest is its data
/// sheet: an About, by name or in braces.
#define GNOMON_TECHNIQUE(id, Class, ...)                                              \
  extern "C" void gnomon_technique_##id(gnomon::Registry& registry) {                 \
    constexpr auto make = [] { return gnomon::made<gnomon::Technique, Class>(#id); }; \
    registry.add(gnomon::TechniqueEntry{#id, gnomon::About(__VA_ARGS__), make});      \
  }

/// Registers the generated scene of this file, the same way.
#define GNOMON_SCENE(id, Class, ...)                                                       \
  extern "C" void gnomon_scene_##id(gnomon::Registry& registry) {                          \
    constexpr auto make = [] { return gnomon::made<gnomon::SceneGenerator, Class>(#id); }; \
    registry.add(gnomon::SceneEntry{#id, gnomon::SceneAbout(__VA_ARGS__), make});          \
  }
