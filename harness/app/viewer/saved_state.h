#pragma once
#include <gnomon/scene.h>

#include <filesystem>
#include <string>
#include <vector>

namespace gnomon::viewer {

/// What the viewer shows, as files can say it.
struct SavedState {
  std::string scene;  ///< as `--scene` names it
  Light light;
  View view;
  std::vector<std::string> plugins;  ///< as `--plugin` names them
  std::string technique, settings;   ///< settings as `Parametrized::settings` writes them
  int width = 0, height = 0;
  Truth truth = Truth::shape;
};

/// A scene TOML: the geometry of the scene that it names, and this light and view alone. Reading it gives the very floats.
/// `file` is where it will be: a scene that is a file is named relative to its folder, which need not be there yet. Throws
/// Error when that name is not UTF-8, as TOML must be.
std::string state_toml(const SavedState& state, const std::filesystem::path& file);

/// One line for a POSIX shell that renders `scene_file`, where the state was saved, into `out`; no newline at its end unless a
/// name has one. Paths are as given, relative ones for the folder in which the line will be used.
std::string render_command(const SavedState& state, const std::filesystem::path& scene_file, const std::filesystem::path& out);

}  // namespace gnomon::viewer
