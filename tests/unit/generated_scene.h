#pragma once
// Generated scenes, and their meshes by name.
#include <gnomon/error.h>
#include <gnomon/registry.h>

#include <algorithm>
#include <string_view>

namespace gnomon::generated {

inline Scene make(std::string_view id, std::string_view settings = "") {
  const SceneEntry* entry = registry().find_scene(id);
  if (!entry) throw Error("there is no generated scene {}", id);
  const auto generator = entry->make();
  generator->apply(settings);
  return generator->make();
}

inline const Mesh& mesh(const Scene& scene, std::string_view name) {
  const auto found = std::ranges::find(scene.meshes, name, &Mesh::name);
  if (found == scene.meshes.end()) throw Error("scene {} has no mesh {}", scene.name, name);
  return *found;
}

template <class Kind>
const Kind& shape(const Scene& scene, std::string_view name) {
  return std::get<Kind>(mesh(scene, name).shape.value());
}

}  // namespace gnomon::generated
