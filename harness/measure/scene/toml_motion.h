#pragma once
// Private to the reader of described scenes: its tables [[path]], and the time at which a description stands still.
#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "measure/scene/toml_table.h"

namespace gnomon {

/// The meshes that the paths of a description may name: those of the scene that it starts from and its own shapes by their
/// names, and those of its tables [[mesh]] by the `name` of these.
class MeshNames {
 public:
  /// `base` are the meshes of the scene that the description starts from. Several of one name share it.
  explicit MeshNames(const std::vector<Mesh>& base);
  /// The meshes from `first` to before `end` come from one table and have this name together.
  void add(const std::string& name, std::size_t first, std::size_t end);
  /// Null where no mesh has the name. Throws Error where several tables gave it, or one and the scene to start from.
  const std::vector<std::uint32_t>* find(const std::string& name) const;
  std::vector<std::string> all() const;

 private:
  struct Named {
    std::vector<std::uint32_t> meshes;
    int giver_count = 1;
  };
  std::map<std::string, Named> named_;
};

/// Adds a path of camera or light. A path that moves meshes is left to `read_mesh_paths`, for which all meshes must be there.
/// Without a name it is called after what it moves.
void read_path(const toml::table& toml, const std::filesystem::path& file, Scene& scene);

/// Adds what the paths among `tables` that move meshes say to the scene's motion. Paths of one name are one animation. Throws
/// Error, also where a path of camera or light has the name of any animation.
void read_mesh_paths(const std::vector<const toml::table*>& tables, const std::filesystem::path& file, const MeshNames& names,
                     Scene& scene);

/// Poses the scene for good where the description has the keys `time` and `animation`. One that others start from is not
/// framed. Throws Error.
void read_time(const Table& top, bool is_base, Scene& scene);

}  // namespace gnomon
