#pragma once
#include <filesystem>
#include <string>
#include <vector>

namespace gnomon {

/// A file that a scene reads.
struct SceneFile {
  std::filesystem::path file;      ///< absolute, without . and ..
  std::filesystem::path in_cache;  ///< of a fetched scene: the path below the folder of fetched scenes; else empty
  bool is_description = false;     ///< a scene file in TOML; else a model, what belongs to it, or an image
  /// Where it comes from, as the description that names it says: what its opening comment has from "Source:" or "License:" on,
  /// in one line. Empty where no description names it, or that has neither.
  std::string source;
};

/// The files that loading a scene opens, each once, descriptions before what they name; none of a scene that is generated.
/// What a model names (materials, buffers, images) is found by reading it, in a child process. Throws Error, SceneNotFetched.
std::vector<SceneFile> scene_files(const std::string& reference);

}  // namespace gnomon
